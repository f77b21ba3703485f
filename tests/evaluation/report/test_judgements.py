"""Scores between what scales say, their reasons where there are none, corrected differences."""

import numpy as np
import pytest

from ship_gym.evaluation.episodes_table import Results, table_of
from ship_gym.evaluation.report import judge
from ship_gym.evaluation.report.events import events
from ship_gym.evaluation.report.judgements import scale, tail
from ship_gym.evaluation.report.leaderboard import boards, places
from ship_gym.evaluation.score import OPTIMA, Reference, References

from .conftest import made_up


def stored(event, nothing=80.0):
    cell = Reference(
        event.scenario, event.ship, event.measure, nothing, 20.0, "lqg", 10.0, OPTIMA[0], 32
    )
    return References("ShipBench-1", (0, 64), {event.cell: cell}, {})


NONE_STORED = References("ShipBench-1", (0, 64), {}, {})


def test_scores_of_a_stored_scale(results):
    event = events(results.table)[0]
    found = scale(event, stored(event))
    assert (found.cell.reference_controller, found.source) == ("lqg", "ShipBench-1")
    assert found.score(80.0) == 0.0 and found.score(20.0) == 100.0
    assert found.score(40.0) == pytest.approx(50.0)  # half of the way in ratios
    assert found.optimum == pytest.approx(150.0)
    run = event.runs["pid"]
    scored = found.estimate(run.values)
    assert scored.value == found.score(run.middle("value"))
    # the score falls with the measure: its lower end is that of the largest middle
    assert found.score(run.values.max()) < scored.low < scored.value
    assert scored.value < scored.high < found.score(run.values.min())
    assert found.score(0.0) is None and found.score(None) is None


def test_without_a_stored_scale_the_episodes_give_it(results):
    event = events(results.table)[0]
    found = scale(event, NONE_STORED)
    assert found.source == "these episodes" and found.optimum is None
    assert found.cell.reference_controller == "pid"
    assert found.score(event.runs["pid"].middle("value")) == pytest.approx(100.0)
    assert found.score(event.runs["constant"].middle("value")) == pytest.approx(0.0, abs=1e-12)


def test_why_there_is_no_score(results):
    event = events(results.table)[0]
    near = scale(event, stored(event, nothing=20.5))
    assert near.score(10.0) is None and "hardly worse than the reference lqg" in near.why
    alone = events(made_up(("lqg", "mine")).table)[0]
    assert scale(alone, NONE_STORED).why == (
        "no reference value is stored, and the results have no constant and no pid"
    )


def test_leaderboard_ranks_those_with_all_cells_first_and_doing_nothing_last(results):
    found = judge(results, NONE_STORED)
    assert list(boards(found)) == ["all suites", "course", "heading"]
    ranked = places(found, found.events)
    assert [(p.controller, len(p.cells)) for p in ranked] == [
        ("lqg", 6), ("pid", 6), ("mine", 3), ("ppo_kcs", 3), ("constant", 6),
    ]  # fmt: skip
    pid = next(place for place in ranked if place.controller == "pid").score
    assert pid.value == pytest.approx(100.0) and pid.low < 100.0 < pid.high


def test_mean_score_is_the_mean_of_the_cells(results):
    found = judge(results, NONE_STORED)
    cells = found.scored("lqg", found.events)
    scores = [found.score(event, "lqg") for event in cells]
    assert found.mean_score("lqg", cells).value == pytest.approx(np.mean(scores))


def test_differences_are_paired_and_corrected(many):
    found = judge(many, NONE_STORED)
    kcs = found.events[0]
    ppo = found.difference(kcs, "ppo_kcs")
    own, best = kcs.runs["ppo_kcs"].values, kcs.runs["lqg"].values
    assert (ppo.against, ppo.n, ppo.verdict) == ("lqg", 24, "worse")
    assert ppo.found.value == np.mean(own - best) and ppo.found.low > 0.0
    assert ppo.share == pytest.approx(np.mean(own) / np.mean(best) - 1.0)
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
    found = judge(Results(table_of(same), {}), NONE_STORED)
    assert [(each.found.value, each.p, each.verdict) for each in found.differences] == [
        (0.0, 1.0, "")
    ] * 2


def test_the_bound_of_the_p_value_holds():
    """All flips of ten differences, counted."""
    for shift in (0.0, 0.5, 2.0):
        d = np.random.default_rng(1).normal(shift, 1.0, 10)
        signs = np.array(np.meshgrid(*[[-1.0, 1.0]] * 10)).reshape(10, -1)
        exact = np.mean(np.abs(d @ signs) >= abs(d.sum()) - 1e-12)
        assert exact <= tail(d) <= 1.0
    assert tail(np.zeros(4)) == 1.0
    assert tail(np.ones(64)) == pytest.approx(2.0 * np.exp(-32.0))  # 64^2 / (2 64)
