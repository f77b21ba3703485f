"""Scores between what scales say, their reasons where there are none, corrected differences."""

import numpy as np
import pytest

from ship_gym.evaluation.episodes_table import Results, table_of
from ship_gym.evaluation.report import judge
from ship_gym.evaluation.report.events import events
from ship_gym.evaluation.report.judge import scale
from ship_gym.evaluation.report.leaderboard import boards, places

from .conftest import made_up


def stored(event, **changed):
    cell = {"measure": event.measure, "nothing": 80.0, "reference": 20.0, "optimum": 10.0}
    return {event.cell: cell | {"reference_controller": "lqg"} | changed}


def test_scores_of_a_stored_scale(results):
    event = events(results.table)[0]
    found = scale(event, stored(event))
    assert (found.by, found.source) == ("lqg", "ShipBench-1")
    assert found.score(80.0) == 0.0 and found.score(20.0) == 100.0
    assert found.score(40.0) == pytest.approx(50.0)  # half of the way in ratios
    assert found.optimum == pytest.approx(150.0)
    middle = event.runs["pid"].estimate
    scored = found.estimate(middle)
    assert scored.low == found.score(middle.high) and scored.low < scored.value < scored.high


def test_without_a_stored_scale_the_episodes_give_it(results):
    event = events(results.table)[0]
    found = scale(event, {})
    assert found.source == "these episodes" and found.by == "pid" and found.optimum is None
    assert found.score(event.runs["pid"].middle("value")) == pytest.approx(100.0)
    assert found.score(event.runs["constant"].middle("value")) == pytest.approx(0.0, abs=1e-12)


def test_why_there_is_no_score(results):
    event = events(results.table)[0]
    near = scale(event, stored(event, nothing=20.5))
    assert near.score(10.0) is None and "hardly worse than the reference lqg" in near.why
    alone = events(made_up(("lqg", "mine")).table)[0]
    assert scale(alone, {}).why == (
        "no reference value is stored, and the results have no constant and no pid"
    )


def test_leaderboard_ranks_those_with_all_cells_first(results):
    found = judge(results, {})
    assert list(boards(found)) == ["all suites", "course", "heading"]
    ranked = places(found, found.events)
    assert [(p.controller, len(p.cells)) for p in ranked] == [
        ("lqg", 6), ("pid", 6), ("constant", 6), ("mine", 3), ("ppo_kcs", 3),
    ]  # fmt: skip
    pid = next(place for place in ranked if place.controller == "pid").score
    assert pid.value == pytest.approx(100.0) and pid.low < 100.0 < pid.high


def test_mean_score_is_the_mean_of_the_cells(results):
    found = judge(results, {})
    cells = found.scored("lqg", found.events)
    scores = [found.score(event, "lqg") for event in cells]
    assert found.mean_score("lqg", cells).value == pytest.approx(np.mean(scores))


def test_differences_are_paired_and_corrected(many):
    found = judge(many, {})
    kcs = found.events[0]
    ppo = found.difference(kcs, "ppo_kcs")
    own, best = kcs.runs["ppo_kcs"].values, kcs.runs["lqg"].values
    assert (ppo.against, ppo.n, ppo.verdict) == ("lqg", 24, "worse")
    assert ppo.found.low < np.mean(own - best) < ppo.found.high
    assert ppo.share == pytest.approx(ppo.found.value / kcs.runs["lqg"].middle("value"))
    assert found.difference(kcs, "lqg") is None and found.difference(kcs, "constant") is None
    broken = found.difference(found.events[1], "mine")
    assert broken.n == 18  # of the seeds that it finished


def test_equal_controllers_differ_by_nothing():
    results = made_up(("constant", "pid", "lqg"), ("heading_keeping",))
    table = results.table.to_pylist()
    lqg = {(row["ship"], row["seed"]): row for row in table if row["controller"] == "lqg"}
    same = [
        row | {"value": lqg[row["ship"], row["seed"]]["value"]}
        if row["controller"] == "pid"
        else row
        for row in table
    ]
    found = judge(Results(table_of(same), {}), {})
    assert [(each.found.value, each.p, each.verdict) for each in found.differences] == [
        (0.0, 1.0, "")
    ] * 2
