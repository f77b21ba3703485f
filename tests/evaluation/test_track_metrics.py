"""Metrics of a track and of course changes, by hand and from rollouts."""

import math

import numpy as np
import pytest
from ship_gym_agents.los import ILOS
from ship_gym_agents.pid import PID

from ship_gym.evaluation import metrics, rollout
from ship_gym.evaluation.metrics import all_metrics, metrics_of
from ship_gym.recording import Trajectory


@pytest.fixture(scope="module")
def sailed():
    return rollout(ILOS(), "track_following", seeds=[1, 2])


def test_metrics_of_a_track(sailed):
    L = sailed.ship.hull.L
    for i in range(2):
        t = sailed.trajectory(i)
        found = metrics(t)
        assert list(found) == list(metrics_of("track_following")) and set(found) <= set(
            all_metrics()
        )
        # the reward term is (e / L)^2 of the same intervals
        paid = -t["reward_cross_track"][:-1]
        assert found["rms_cross_track"] == pytest.approx(math.sqrt(paid.mean()), rel=1e-9)
        judged = max(math.sqrt(paid.max()), abs(t["cross_track_error"][0]) / L)
        assert found["max_cross_track"] == pytest.approx(judged, rel=1e-9)
        assert found["voyage_time"] == sailed.lengths[i] < 3600
        assert found["success"] == 1.0 and t.meta["outcome"] == "arrived"
        assert len(t.meta["waypoints"]) == 6 and t["leg"][-1] == 4


def test_a_voyage_that_failed_is_judged_to_the_end(sailed):
    t = sailed.trajectory(0)
    lost = Trajectory(t.columns, t.meta | {"failed": True, "outcome": "cross-track limit"})
    found, rows = metrics(lost), len(t) - 1
    squares = metrics(t)["rms_cross_track"] ** 2 * rows + 25.0 * (3600 - rows)
    assert found["rms_cross_track"] == pytest.approx(math.sqrt(squares / 3600))
    assert found["voyage_time"] == 3600.0 and found["success"] == 0.0


def test_the_file_of_a_track_gives_the_same_metrics(sailed, tmp_path):
    pytest.importorskip("rerun")
    sailed.trajectory(1).to_rrd(tmp_path / "t.rrd")
    assert metrics(Trajectory.from_rrd(tmp_path / "t.rrd")) == metrics(sailed.trajectory(1))


def test_steps_of_the_course_are_averaged():
    t = rollout(PID(), "course_calm", seeds=[3]).trajectory(0)
    begins = np.flatnonzero(np.diff(t["psi_ordered"])) + 1
    assert len(begins) == 4 and begins[0] == 30
    error = np.degrees(t["psi_error"])
    over = [
        max(0.0, (-math.copysign(1.0, error[a]) * error[a:b]).max())
        for a, b in zip(begins, [*begins[1:], len(t)], strict=True)
    ]
    found = metrics(t)
    assert found["overshoot"] == pytest.approx(np.mean(over), abs=0.2)  # later swings are small
    assert 20.0 < found["settling_time"] < 150.0


def test_an_interval_is_judged_by_the_order_that_held():
    t = rollout(PID(), "course_changing", seeds=[5]).trajectory(0)
    paid = -(t["reward_heading"] + t["reward_rudder"]).sum() / 900.0
    assert metrics(t)["J_0.1"] == pytest.approx(np.degrees(np.degrees(paid)), rel=1e-9)
