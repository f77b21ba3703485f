"""Best, median and worst episode, their commands, and which of them are drawn."""

import numpy as np
import pytest

from ship_gym.evaluation.report import judge
from ship_gym.evaluation.report.episodes import Episode, blocks, episode, extremes, shown


@pytest.fixture(scope="module")
def found(results):
    return judge(results)


def test_extremes_by_the_measure(found):
    event = found.events[1]
    run = event.runs["mine"]  # two broken off
    seeds = extremes(event, run)
    there = np.sort(run.values[np.isfinite(run.values)])
    value = dict(zip(run.seeds, run.values, strict=True))
    assert [value[seed] for seed in seeds.values()] == [there[0], there[2], there[5]]
    assert list(seeds) == ["best", "median", "worst"]


def test_the_command_says_all_that_is_needed(found):
    command = Episode("my seas/rough.toml", "kcs", "mine.py:Mine", 7, "rudder+rpm").command
    assert command == (
        "ship-gym record --controller mine.py:Mine --scenario 'my seas/rough.toml' --ship kcs "
        "--control rudder+rpm --seed 7"
    )
    found.about["controllers"]["mine"] = {"named": "mine.py:Mine"}
    assert episode(found, found.events[0], "mine", 3).controller == "mine.py:Mine"
    assert episode(found, found.events[0], "lqg", 3).controller == "lqg"


def test_every_controller_has_three_commands(found):
    grid, commands = blocks(found, found.events[0])
    assert [row[0] for row in grid.rows] == list(found.events[0].runs)
    lines = commands.text.splitlines()
    assert len(lines) == 15 and lines[0].startswith("ship-gym record --controller lqg")
    assert lines[2].endswith("# worst")


def test_few_pictures_show_many_events(found):
    chosen = shown(found, 100)
    first = [(event.cell, name, which) for event, name, which, _ in chosen[:6]]
    assert first == [
        (cell, "mine", which)
        for cell in ("course_changing/kcs", "heading_keeping/kcs")
        for which in ("best", "median", "worst")
    ]
    assert {which for _, _, which, _ in chosen[6:]} == {"worst"}
    assert len({event for event, *_ in chosen}) == 6
    assert shown(found, 4) == chosen[:4] and shown(found, 0) == []
