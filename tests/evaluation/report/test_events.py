"""From the table to events: who sailed what, middles, shared seeds, the best classical one."""

import numpy as np
import pytest

from ship_gym.evaluation.report.events import events, slug
from ship_gym.evaluation.statistics import interquartile_mean


@pytest.fixture(scope="module")
def found(results):
    return events(results.table)


def test_an_event_for_each_scenario_and_ship(found):
    assert len(found) == 6
    cells = [event.cell for event in found]
    assert cells[0] == "course_changing/kcs" and len(set(cells)) == 6
    for event in found:
        policy = {"ppo_kcs"} if event.ship == "kcs" else set()
        assert set(event.runs) == {"constant", "pid", "lqg", "mine"} | policy


def test_runs_are_sorted_from_the_best_and_those_without_a_middle_come_last(found):
    assert list(found[0].runs) == ["lqg", "pid", "mine", "ppo_kcs", "constant"]
    assert list(found[1].runs) == ["lqg", "pid", "constant", "mine"]  # which broke two off


def test_values_of_a_run_are_those_of_the_table(results, found):
    event = found[0]
    rows = [
        row
        for row in results.table.to_pylist()
        if (row["scenario"], row["ship"], row["controller"]) == (event.scenario, event.ship, "pid")
    ]
    run = event.runs["pid"]
    assert run.seeds.tolist() == [row["seed"] for row in rows]
    assert run.values.tolist() == [row["value"] for row in rows]
    assert run.estimate.value == interquartile_mean(run.values) == run.middle("value")
    assert run.estimate.low < run.estimate.value < run.estimate.high
    assert run.middle("success") == 1.0 and run.middle("rms_route") is None  # of another task


def test_broken_episodes_leave_no_number(found):
    run = found[1].runs["mine"]
    assert run.broken.tolist() == (run.seeds % 4 == 3).tolist()
    assert run.estimate is None and run.middle("value") is None
    assert found[1].finished(["mine", "pid"]).tolist() == [s for s in run.seeds if s % 4 != 3]
    shared = found[1].finished(["mine", "pid"])
    assert np.isfinite(run.at(shared)).all() and len(run.at(shared)) == 6


def test_the_best_classical_controller_is_neither_policy_nor_idle(found):
    assert {event.best_classical for event in found} == {"lqg"}


def test_names_of_files_are_anchors_too():
    assert slug("mine-my suites/rough.toml-kcs") == "mine-my-suites-rough.toml-kcs"
