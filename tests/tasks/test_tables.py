"""Tables of the tasks that people read: metrics, outcomes, moments."""

import pytest

from ship_gym.tasks import TASKS, measures

UNITS = {"-", "deg", "deg2", "kWh", "s", "L", "deg/h", "1/h", "kWh/nmi"}


@pytest.mark.parametrize("name", TASKS.own())
def test_metrics_have_a_unit_a_meaning_and_a_direction(name):
    task = TASKS[name]
    for metric in (*task.metrics.values(), *measures.COMMON.values()):
        assert metric.unit in UNITS and metric.better in ("lower", "higher")
        assert " " in metric.meaning
    assert measures.COMMON["success"].better == "higher"
    higher = {key for key, metric in task.metrics.items() if metric.better == "higher"}
    assert higher == ({"corridor"} if name == "track_following" else set())


@pytest.mark.parametrize("name", TASKS.own())
def test_outcomes_and_moments(name):
    task = TASKS[name]
    assert [end.failed for end in task.all_outcomes[:3]] == [False, True, True]
    assert [end.name for end in task.outcomes if end.reached] == (
        ["arrived"] if name == "track_following" else []
    )
    # a picture of an episode under way, of one of the first seeds
    assert task.moment.seed < 10 and 100 <= task.moment.intervals <= 700
