"""J of the turn and of the steady part, on recordings whose numbers are worked out by hand."""

import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ship_gym.evaluation import compare, metrics, rollout, table
from ship_gym.evaluation.controller import ConstantController
from ship_gym.recording import Trajectory
from ship_gym.tasks import TASKS
from ship_gym.tasks.measures import TURN, turning

LIMIT, HARD_OVER = 60.0, 35.0


def sailed(
    error, delta, orders=None, interval=1.0, duration=600.0, scale=1.0, failed=False, **meta
):
    """Recording whose rows, one at each end of an interval, have these angles [deg]."""
    rows = len(error)
    orders, full = np.zeros(rows) if orders is None else np.asarray(orders), np.ones(rows)
    columns = {
        "t": interval * np.arange(rows) / math.sqrt(scale),
        "u": 8.0 * full,
        "v": 0.0 * full,
        "psi": np.radians(orders + error),
        "psi_ordered": np.radians(orders),
        "psi_error": np.radians(error),
        "delta": np.radians(delta),
        "n": 2.0 * full,
        "torque": 1000.0 * full,
        "current_speed": 0.0 * full,
        "current_direction_to": 0.0 * full,
        "reward": 0.0 * full,
    }
    about = {
        "task": "heading_keeping" if not orders.any() else "course_changing",
        "failed": failed,
        "outcome": "heading limit" if failed else "end of time",
        "ship": {"speed": 8.0, "scale": scale, "delta_max": math.radians(HARD_OVER)},
        "config": {
            "duration": duration,
            "control_interval": interval,
            "limits": {"heading_error_deg": LIMIT},
        },
    }
    return Trajectory(columns, about | meta)


def test_headlines():
    assert TASKS["heading_keeping"].headline == "J_steady"
    assert TASKS["course_changing"].headline == "settling_time"
    assert TURN == 120.0


@pytest.mark.parametrize("scale", [1.0, 64.0])
def test_turn_and_steady_part_of_one_heading(scale):
    """Rows 1 to 120 end the turn's intervals: 6 deg and 10 deg, so 36 + 0.1 100 = 46; after them
    1 deg and 2 deg, so 1 + 0.1 4 = 1.4; together (120 46 + 480 1.4) / 600 = 10.32.
    """
    error = np.r_[99.0, np.full(120, 6.0), np.full(480, 1.0)]
    delta = np.r_[0.0, np.full(120, 10.0), np.full(480, 2.0)]
    found = metrics(sailed(error, delta, scale=scale))
    assert found["J_turn"] == pytest.approx(46.0)
    assert found["J_steady"] == pytest.approx(1.4)
    assert found["J_0.1"] == pytest.approx(10.32)


@pytest.mark.parametrize(("row", "turn", "steady"), [(120, 36.0 / 120, 0.0), (121, 0.0, 36 / 480)])
def test_the_interval_that_ends_at_120_s_is_the_turn_s_last(row, turn, steady):
    error = np.zeros(601)
    error[row] = 6.0
    found = metrics(sailed(error, np.zeros(601)))
    assert (found["J_turn"], found["J_steady"]) == pytest.approx((turn, steady))


def test_an_interval_that_begins_within_the_turn_is_its():
    """Intervals of 50 s begin at 0, 50, 100 | 150, ...: the first three are the turn."""
    error = np.r_[0.0, 3.0, 3.0, 3.0, np.full(9, 1.0)]
    found = metrics(sailed(error, np.zeros(13), interval=50.0))
    assert (found["J_turn"], found["J_steady"]) == pytest.approx((9.0, 1.0))
    assert turning([0], 12, 50.0).sum() == 3
    assert turning([0], 12, 40.0).sum() == 3 and turning([0], 12, 60.0).sum() == 2
    assert turning([0], 5000, 0.1).sum() == 1200


def test_parts_of_a_course_follow_its_orders():
    """Orders at 0, 200 and 500 s of 600: turns 0-120, 200-320, 500-600, so 340 s; steady 260 s.

    The first turn has 0 deg, the second 4 deg, the third 10 deg; the steady part 2 deg, with rudder
    10 deg: J_turn = (120 16 + 100 100) / 340, J_steady = 4 + 0.1 100.
    """
    k = np.arange(601)
    orders = np.where(k < 200, 0.0, np.where(k < 500, 20.0, -10.0))
    first, second, third = (k >= 1) & (k <= 120), (k >= 201) & (k <= 320), k >= 501
    error = np.select([first, second, third], [0.0, 4.0, 10.0], 2.0)
    error[[200, 500]] += (
        orders[[199, 499]] - orders[[200, 500]]
    )  # row of the new order, old heading
    delta = np.where(first | second | third, 0.0, 10.0)
    found = metrics(sailed(error, delta, orders))
    assert found["J_turn"] == pytest.approx((120 * 16.0 + 100 * 100.0) / 340)
    assert found["J_steady"] == pytest.approx(14.0)


def test_what_failing_lost_counts_in_both_parts():
    """Failed after 60 s with 2 deg: of the turn 60 s of 120 are lost, of the steady part all.

    The worst is 60 deg with 35 deg of rudder: 3600 + 0.1 1225 = 3722.5.
    """
    found = metrics(sailed(np.full(61, 2.0), np.zeros(61), failed=True))
    assert found["J_turn"] == pytest.approx((60 * 4.0 + 60 * 3722.5) / 120)
    assert found["J_steady"] == pytest.approx(3722.5)


def test_orders_that_failing_came_before_have_their_turns():
    """Failed at 300 s, orders planned for 0, 100 and 400 s: turns 0-220 and 400-520, so 340 s, of
    which the last 120 are lost; steady 220-400 (its last 100 lost) and 520-600 (all lost).
    """
    k = np.arange(301)
    orders = np.where(k < 100, 0.0, 30.0)
    error = np.where(k == 100, 1.0 - 30.0, 1.0)
    t = sailed(error, np.zeros(301), orders, failed=True, order_from=[0, 100, 400, 900])
    found = metrics(t)
    assert found["J_turn"] == pytest.approx((220 * 1.0 + 120 * 3722.5) / 340)
    assert found["J_steady"] == pytest.approx((80 * 1.0 + 180 * 3722.5) / 260)


def test_recordings_of_a_course_have_the_orders_planned():
    run = rollout(ConstantController(), "course_changing", seeds=[3], overrides={"duration": 300.0})
    t = run.trajectory(0)
    changes = (np.flatnonzero(np.diff(t["psi_ordered"])) + 1).tolist()
    planned = t.meta["order_from"]
    assert len(planned) == 5 and planned[:2] == [0, 30]
    assert changes == [begins for begins in planned[1:] if begins < len(t)]


angles = st.lists(st.tuples(st.floats(-60, 60), st.floats(-35, 35)), min_size=2, max_size=300)


@given(angles, st.lists(st.integers(0, 600), max_size=3))
def test_j_is_the_mean_of_its_parts(rows, planned):
    error, delta = np.array(rows).T
    found = metrics(sailed(error, delta, failed=True, order_from=planned))
    n = turning({0, *planned}, 600, 1.0).sum()
    whole = n * found["J_turn"] + (600 - n) * found["J_steady"]
    assert whole == pytest.approx(600 * found["J_0.1"], rel=1e-9)


def test_an_episode_too_short_for_a_steady_part_has_none():
    short = sailed(np.ones(61), np.zeros(61), duration=60.0)
    assert metrics(short)["J_steady"] is None
    assert metrics(short)["J_turn"] == pytest.approx(1.0)
    runs = [
        rollout(ConstantController(name=name), seeds=[1, 2], overrides={"duration": 30.0})
        for name in ("a", "b")
    ]
    found = compare(runs)
    assert json.loads(json.dumps(found, allow_nan=False)) == found
    assert found["controllers"]["a"]["J_steady"] == {"value": None, "low": None, "high": None}
    assert found["differences"]["b"]["J_steady"]["value"] is None
    assert found["episodes"]["a"]["J_steady"] == [None, None]
    row = next(line for line in table(found).splitlines() if line.startswith("J_steady"))
    assert row.split()[-2:] == ["-", "-"]
