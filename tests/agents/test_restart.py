"""Rows of an autopilot that begin anew steer as a controller that was reset then."""

import numpy as np
import pytest
from ship_gym_agents.controllers import make_controller
from ship_gym_agents.fresh import Fresh, begun
from ship_gym_agents.pid import PID, Gains
from ship_gym_agents.wave_filter import LowPass

from ship_gym import load_scenario, load_ship
from tests.agents.measurements import measurements

CASES = {
    "pid": "heading_keeping",
    "lqg": "course_changing",
    "adaptive": "course_changing",
    "bang_bang": "heading_keeping",
    "los_pid": "track_following",
    "ilos": "track_following",
    "drift_los": "track_following",
    "just_in_time": "track_economy",
}
COUNT, LENGTH = 5, 40
RESTARTED = {0: [2], 11: [1, 3], 20: [3], 21: [3, 0]}  # rows before an interval


def controller(name, count):
    made, scenario = make_controller(name), load_scenario(CASES[name])
    made.reset(count, load_ship("kcs"), scenario)
    return made, scenario


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("as_mask", [False, True])
def test_a_restarted_row_steers_as_a_new_controller(name, as_mask):
    batch, scenario = controller(name, COUNT)
    seen = measurements(scenario, COUNT, LENGTH, seed=3)
    single = [controller(name, 1)[0] for _ in range(COUNT)]
    for k in range(LENGTH):
        rows = np.array(RESTARTED.get(k, []), dtype=np.int64)
        if len(rows):
            batch.restart(np.isin(np.arange(COUNT), rows) if as_mask else rows)
        for i in rows:
            single[i] = controller(name, 1)[0]
        expected = np.vstack([one.act(seen[k, i : i + 1]) for i, one in enumerate(single)])
        assert np.array_equal(batch.act(seen[k]), expected)


def test_without_a_restart_the_rows_differ():
    """That the test above can fail: the memory of a row matters."""
    used, scenario = controller("drift_los", COUNT)
    fresh, _ = controller("drift_los", COUNT)
    seen = measurements(scenario, COUNT, LENGTH, seed=3)
    for k in range(10):
        used.act(seen[k])
    assert not np.isclose(used.act(seen[10]), fresh.act(seen[10])).any()


def test_low_pass_and_integral_restart():
    gains = Gains(K_p=1.0, K_d=0.5, K_i=0.3, low_pass=LowPass(0.2, 0.3, 0.4))
    scenario = load_scenario("heading_keeping")
    seen = measurements(scenario, COUNT, LENGTH, seed=4)
    batch, late = PID(gains), PID(gains)
    for one in (batch, late):
        one.reset(COUNT, load_ship("kcs"), scenario)
    for k in range(7):
        batch.act(seen[k])
    batch.restart(np.array([0, 4]))
    for k in range(7, 15):
        ours, theirs = batch.act(seen[k]), late.act(seen[k])
        assert np.array_equal(ours[[0, 4]], theirs[[0, 4]])
        assert (ours[1:4] != theirs[1:4]).all()


def test_an_offset_is_added_to_the_wanted_heading():
    plain, scenario = controller("pid", COUNT)
    led, _ = controller("pid", COUNT)
    seen = measurements(scenario, COUNT, LENGTH, seed=5)[0]
    gain = plain.gains_for(load_ship("kcs")).K_p
    own = plain.steer(plain.perceive(seen))
    found = led.steer(led.perceive(seen), np.full(COUNT, 0.1))
    moved = (found - own) * load_ship("kcs").gear.delta_max
    assert moved[:, 0] == pytest.approx(gain * 0.1)
    assert (led.followed[0] == 0.1).all()


def test_a_planner_that_goes_on_from_its_last_plan_cannot_restart():
    assert make_controller("mpc").restart is None


def test_fresh_rows():
    fresh, rows = Fresh(), np.arange(4.0)
    assert begun(None, fresh.take(), rows) is rows
    before = np.zeros(4)
    assert begun(before, fresh.take(), rows) is before
    fresh.add(np.array([1]))
    fresh.add(np.array([False, False, False, True]))
    assert begun(before, fresh.take(), rows).tolist() == [0.0, 1.0, 0.0, 3.0]
    assert before.tolist() == [0.0] * 4
    again = Fresh()
    again.add(np.array([1]))  # all are fresh already
    assert again.take() == slice(None)
