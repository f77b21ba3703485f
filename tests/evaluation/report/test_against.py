"""Where policies lose, sectors of wave headings, profiles."""

import numpy as np
import pytest

from ship_gym.evaluation.report import against, judge
from ship_gym.reports.page import Grid, Row

from .conftest import made_up


def grids(section):
    return [block for block in section.blocks if isinstance(block, Grid)]


def test_a_policy_that_loses_is_listed(many):
    found = judge(many)
    counts, lost = grids(against.where_policies_lose(found))
    assert [row[0] for row in counts.rows] == ["mine", "ppo_kcs"]
    rows = {(str(row[0]), row[2]) for row in lost.rows}
    assert ("heading_keeping/kcs", "ppo_kcs") in rows
    assert {str(row[-1]) for row in lost.rows} == {"worse"}
    judged = sum(int(count) for count in counts.rows[1][1:])
    assert judged == 1  # one cell, one verdict


def test_without_a_policy_it_says_so():
    found = judge(made_up(("constant", "pid", "lqg")))
    (text,) = against.where_policies_lose(found).blocks
    assert "no policy" in text.text


def test_waves_come_from_where_the_table_says():
    encounter = np.array([0.0, 45.0, -90.0, 135.0, 180.0])
    assert against.coming_from(encounter).tolist() == [180.0, 135.0, 90.0, 45.0, 0.0]


def test_means_of_sectors_with_enough_episodes():
    angles = np.array([0.0, 10.0, 22.0, 23.0, 90.0, 91.0, 92.0, 180.0, 170.0, 158.0])
    values = np.array([1.0, 2.0, 3.0, 99.0, 4.0, 4.0, 4.0, 5.0, 6.0, 7.0])
    middles, means = against.by_sector(angles, values)
    assert middles.tolist() == [0.0, 45.0, 90.0, 135.0, 180.0]
    np.testing.assert_array_equal(means, [2.0, np.nan, 4.0, np.nan, 6.0])


@pytest.mark.parametrize("section", [against.profiles, against.wave_headings])
def test_pictures_of_suite_and_ship(many, section):
    pictures = [b for b in section(judge(many)).blocks if isinstance(b, Row)]
    assert [p.name.rsplit("_", 1)[1] for p in pictures[0].pictures] == ["kcs", "kvlcc2"]
