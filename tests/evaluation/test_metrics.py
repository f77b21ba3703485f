import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from ship_gym_agents.pid import PID, Gains

from ship_gym.config import ConfigError
from ship_gym.evaluation.controller import ConstantController
from ship_gym.evaluation.metrics import metrics, metrics_of
from ship_gym.evaluation.rollout import rollout
from ship_gym.recording import Trajectory
from ship_gym.tasks import TASKS
from ship_gym.tasks.measures import overshoot, reversals, settling_time

SPEED, DURATION, LIMIT, HARD_OVER = 8.0, 600.0, 60.0, 35.0


def hand_made(error_deg, delta_deg, terminated=False, scale=1.0, **changes):
    """Recording at SPEED through a cross current, rows 1 s full scale apart."""
    rows = len(error_deg)
    full = np.ones(rows)
    columns = {
        "t": np.arange(rows) / math.sqrt(scale),
        "u": SPEED * full,
        "v": 0.5 * full,
        "psi": np.radians(error_deg) * full,
        "psi_ordered": 0.0 * full,
        "delta": np.radians(delta_deg) * full,
        "n": 2.0 * full,
        "torque": 1000.0 * full,
        "psi_error": np.radians(error_deg) * full,
        "current_speed": 0.5 * full,
        "current_direction_to": 0.5 * math.pi + np.radians(error_deg) * full,  # abeam
        "reward": -1.0 * full,
    }
    meta = {
        "task": "heading_keeping",
        "terminated": terminated,
        "failed": terminated,
        "outcome": "heading limit" if terminated else "end of time",
        "ship": {"speed": 10.0, "scale": scale, "delta_max": math.radians(HARD_OVER)},
        "config": {
            "duration": DURATION,
            "control_interval": 1.0,
            "limits": {"heading_error_deg": LIMIT},
        },
    }
    return Trajectory(columns | changes, meta)


def test_constant_error_and_rudder():
    found = metrics(hand_made(np.full(601, 3.0), np.full(601, 2.0)))
    assert list(found) == list(metrics_of("heading_keeping"))
    assert found["J_0.1"] == pytest.approx(9.4)
    assert found["J_1"] == pytest.approx(13.0)
    assert found["J_8"] == pytest.approx(41.0)
    assert found["rms_error"] == pytest.approx(3.0)
    assert found["max_error"] == pytest.approx(3.0)
    assert found["overshoot"] == found["rudder_travel"] == found["saturation"] == 0.0
    assert found["settling_time"] == DURATION
    assert found["speed_loss"] == pytest.approx(0.2)
    assert found["success"] == 1.0
    assert found["return"] == pytest.approx(-601.0)


def test_energy_is_power_over_distance_through_the_water():
    found = metrics(hand_made(np.zeros(601), np.zeros(601)))
    newton = 2.0 * math.pi * 2.0 * 1000.0 / SPEED  # the cross current moves water and ship alike
    assert found["energy"] == pytest.approx(newton * 1852.0 / 3.6e6)


def test_start_does_not_count_but_the_final_state_does():
    found = metrics(hand_made(np.r_[30.0, np.zeros(599), 6.0], np.zeros(601)))
    assert found["J_0.1"] == pytest.approx(36.0 / 600)
    assert found["max_error"] == pytest.approx(30.0)


def test_rudder_triangle():
    # from 0 to 10 deg and back, in steps of 1 deg: 20 deg in each 20 s
    k = np.arange(601)
    delta = 10.0 - np.abs(k % 20 - 10.0)
    found = metrics(hand_made(np.zeros(601), delta))
    assert found["rudder_travel"] == pytest.approx(3600.0)
    assert found["rudder_reversals"] == pytest.approx(59 * 6)
    assert found["saturation"] == 0.0
    assert metrics(hand_made(np.zeros(601), 3.5 * delta))["saturation"] == pytest.approx(30 / 600)


def test_model_gives_the_full_scale_times_of_its_ship():
    k = np.arange(601)
    delta, error = 10.0 - np.abs(k % 20 - 10.0), np.where(k < 100, 20.0, 1.0)
    ship = metrics(hand_made(error, delta))
    model = metrics(hand_made(error, delta, scale=64.0))
    for name in ("settling_time", "rudder_travel", "rudder_reversals", "J_0.1"):
        assert model[name] == pytest.approx(ship[name], rel=1e-12)
    assert model["energy"] == pytest.approx(64.0**3 * ship["energy"])


@pytest.mark.parametrize("sign", [1, -1])
def test_overshoot_is_the_first_swing_past_zero(sign):
    error = sign * np.array([20.0, 5.0, -3.0, -4.0, -1.0, 2.0, -9.0])
    assert overshoot(error) == 4.0
    assert overshoot(error[:2]) == 0.0
    assert overshoot(np.zeros(4)) == 0.0


def test_settling_time_asks_for_a_stay():
    time = np.arange(300.0)
    error = np.full(300, 10.0)
    error[50:90] = 1.0  # 39 s: too short
    assert settling_time(time, error) is None
    error[100:161] = -2.0
    assert settling_time(time, error) == 100.0
    error[:61] = 0.0
    assert settling_time(time, error) == 0.0
    error[:] = 9.0
    error[250:] = 0.0  # the episode ends before the stay is long enough
    assert settling_time(time, error) is None


@pytest.mark.parametrize(
    ("angle", "count"),
    [
        ([0, 5, 0], 1),
        ([0, 0.9, 0, 0.9, 0], 0),
        ([0, 5, 4.5, 6, 0], 1),
        ([0, 2, 0, 2, 0], 3),
        ([3, 3, 3], 0),
        ([0, -2, 0, 5, 3], 2),
    ],
)
def test_reversals_ignore_the_dead_band(angle, count):
    assert reversals(np.array(angle, dtype=float)) == count
    assert reversals(-np.array(angle, dtype=float)) == count


angles = st.lists(st.tuples(st.floats(-60, 60), st.floats(-35, 35)), min_size=2, max_size=20)


@given(angles, angles)
def test_ending_early_never_beats_sailing_on(sailed, rest):
    head, whole = np.array(sailed), np.array(sailed + rest)
    whole = np.vstack([whole, np.repeat(whole[-1:], 601 - len(whole), axis=0)])
    ended = metrics(hand_made(*head.T, terminated=True))
    alive = metrics(hand_made(*whole.T))
    for name in ("J_0.1", "J_1", "J_8", "rms_error"):
        assert ended[name] >= alive[name] * (1.0 - 1e-12)
    assert (ended["success"], alive["success"]) == (0.0, 1.0)


def test_missing_time_counts_at_the_limit():
    found = metrics(hand_made(np.zeros(301), np.zeros(301), terminated=True))
    assert found["J_1"] == pytest.approx(0.5 * (LIMIT**2 + HARD_OVER**2))
    assert found["rms_error"] == pytest.approx(LIMIT / math.sqrt(2.0))


def test_metrics_of_a_failed_rollout():
    gentle = {"sea.states": ["ss3"]}
    found = metrics(rollout(ConstantController(1.0), seeds=[0], overrides=gentle).trajectory(0))
    assert found["success"] == 0.0
    assert found["max_error"] > LIMIT
    assert found["saturation"] > 0.5
    assert 3000.0 < found["J_0.1"] < LIMIT**2 + 0.1 * HARD_OVER**2


def test_J_is_the_reward_of_heading_and_rudder():
    t = rollout(PID(Gains(2.0, 2.0)), seeds=[2]).trajectory(0)
    paid = -(t["reward_heading"] + t["reward_rudder"]).sum() / DURATION
    assert metrics(t)["J_0.1"] == pytest.approx(np.degrees(np.degrees(paid)), rel=1e-9)


def test_metrics_of_the_file_are_those_of_the_episode(tmp_path):
    pytest.importorskip("rerun")
    controller = PID(Gains(2.0, 2.0))
    t = rollout(controller, seeds=[2], overrides={"duration": 60.0}).trajectory(0)
    t.to_rrd(tmp_path / "run.rrd")
    assert metrics(Trajectory.from_rrd(tmp_path / "run.rrd")) == metrics(t)


def test_other_recordings_are_refused():
    with pytest.raises(ConfigError, match=r"'zigzag'.*torque.*reward.*meta outcome"):
        metrics(Trajectory({"t": [0.0, 1.0]}, {"task": "zigzag"}))


@pytest.mark.parametrize("value", [None, math.nan, math.inf])
def test_a_value_that_is_no_number_is_none(monkeypatch, value):
    """A recording could not hold it."""
    task = TASKS["heading_keeping"]
    own = list(task.metrics)
    given = dataclasses.replace(task, measure=lambda _: dict.fromkeys(own, value))
    monkeypatch.setitem(TASKS._known, task.name, given)
    found = metrics(hand_made(np.full(601, 3.0), np.full(601, 2.0)))
    assert {found[name] for name in own} == {None}
    assert found["saturation"] == 0.0
