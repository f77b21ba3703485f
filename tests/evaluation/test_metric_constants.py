"""Constants of the metrics at their edges: each recording is made by hand, rows 1 s apart."""

import math

import numpy as np
import pytest

from ship_gym.evaluation import metrics
from ship_gym.recording import Trajectory

DURATION = 600.0
ROWS = 601


def sailed(error_deg, delta_deg=None, orders_deg=None, scale=1.0, **changes):
    """Recording of a ship whose heading error and rudder angle [deg] are given, row by row."""
    full = np.ones(len(error_deg))
    delta = np.zeros(len(error_deg)) if delta_deg is None else np.asarray(delta_deg, dtype=float)
    orders = np.zeros(len(error_deg)) if orders_deg is None else np.asarray(orders_deg, float)
    columns = {
        "t": np.arange(len(error_deg)) / math.sqrt(scale),
        "u": 8.0 * full,
        "v": 0.0 * full,
        "psi": np.radians(orders + error_deg),
        "psi_ordered": np.radians(orders),
        "psi_error": np.radians(error_deg),
        "delta": np.radians(delta),
        "n": 2.0 * full,
        "torque": 1000.0 * full,
        "current_speed": 0.0 * full,
        "current_direction_to": 0.0 * full,
        "reward": 0.0 * full,
    }
    meta = {
        "task": "heading_keeping" if orders_deg is None else "course_changing",
        "terminated": False,
        "failed": False,
        "outcome": "end of time",
        "ship": {"speed": 8.0, "scale": scale, "delta_max": math.radians(35.0)},
        "config": {
            "duration": DURATION,
            "control_interval": 1.0,
            "limits": {"heading_error_deg": 60.0},
        },
    }
    return Trajectory(columns | changes, meta)


def stays(band_deg, seconds, begin=100):
    """Error of 10 deg but for a stay of so many seconds within the band."""
    error = np.full(ROWS, 10.0)
    error[begin : begin + seconds + 1] = band_deg
    return error


@pytest.mark.parametrize(
    ("seconds", "settled"), [(59, DURATION), (60, 100.0), (61, 100.0), (200, 100.0)]
)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_stay_of_60_s_settles_one_of_59_s_does_not(seconds, settled, sign):
    assert metrics(sailed(sign * stays(1.0, seconds)))["settling_time"] == settled


@pytest.mark.parametrize(("band", "settled"), [(1.99, 100.0), (2.01, DURATION), (1.0, 100.0)])
def test_the_band_of_the_settling_time_is_2_deg(band, settled):
    assert metrics(sailed(stays(band, 100)))["settling_time"] == settled
    assert metrics(sailed(stays(-band, 100)))["settling_time"] == settled


def test_a_stay_at_the_very_end_counts_if_it_is_long_enough():
    """600 s: a stay that begins at 540 s has its 60 s, one at 541 s has not."""
    for begin, settled in ((540, 540.0), (541, DURATION)):
        assert metrics(sailed(stays(0.0, 600, begin)))["settling_time"] == settled


def test_the_first_stay_that_is_long_enough_counts():
    error = stays(0.0, 30, 50)  # 30 s: too short
    error[200:280] = 0.0
    error[400:500] = 0.0
    assert metrics(sailed(error))["settling_time"] == 200.0


def steps(settle_second=None, first=100, second=400):
    """Orders 0, 20 and 40 deg; the first step settles after 30 s, the second at a time or never."""
    orders = np.where(np.arange(ROWS) < first, 0.0, np.where(np.arange(ROWS) < second, 20.0, 40.0))
    error = np.zeros(ROWS)
    error[first : first + 30] = -20.0
    error[second:] = -20.0
    if settle_second is not None:
        error[second + settle_second :] = 1.0
    return error, orders


@pytest.mark.parametrize(
    ("second", "mean"),
    [
        (None, (30.0 + 200.0) / 2),  # never: the 200 s from its order to the end
        (50, (30.0 + 50.0) / 2),
        (140, (30.0 + 140.0) / 2),  # its 60 s end with the recording
        (141, (30.0 + 200.0) / 2),  # too late for a stay of 60 s
    ],
)
@pytest.mark.parametrize("scale", [1.0, 64.0])
def test_a_later_step_that_never_settles_counts_the_time_it_had(second, mean, scale):
    error, orders = steps(second)
    found = metrics(sailed(error, orders_deg=orders, scale=scale))
    assert found["settling_time"] == pytest.approx(mean, rel=1e-12)


def test_a_first_step_that_never_settles_ends_with_the_next_order():
    """Orders at 100 and 400 s: the last row of the first is 399 s, so it had 299 s."""
    error, orders = steps(50)
    error[100:400] = -20.0
    found = metrics(sailed(error, orders_deg=orders))
    assert found["settling_time"] == pytest.approx((299.0 + 50.0) / 2)


def test_overshoot_of_each_step_is_averaged():
    """3 deg past the first order and none past the second: 1.5 deg; later swings do not count."""
    error, orders = steps(50)
    error[130:140], error[140:150], error[150:160] = 3.0, -1.0, 5.0
    error[450:] = -1.0
    assert metrics(sailed(error, orders_deg=orders))["overshoot"] == pytest.approx(1.5)


@pytest.mark.parametrize(("swing", "turns"), [(0.9, 0), (1.1, 10), (5.0, 10)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_swings_of_the_rudder_below_1_deg_are_no_reversals(swing, turns, sign):
    """Six swings up and five down in 600 s: ten changes of direction, 60 in an hour."""
    delta = np.zeros(ROWS)
    for k in range(6):
        delta[50 + 100 * k : 75 + 100 * k] = sign * swing
    delta[575:] = sign * swing  # stays up: the last swing has no way back
    assert metrics(sailed(np.zeros(ROWS), delta))["rudder_reversals"] == pytest.approx(6.0 * turns)


def test_a_slow_sweep_with_small_ripples_reverses_once():
    """Up to 20 deg and down again with ripples of 0.8 deg: 1 change in 600 s, 6 in an hour."""
    k = np.arange(ROWS)
    delta = 20.0 - np.abs(k - 300) / 15.0 + 0.4 * np.where(k % 2 == 0, 1.0, -1.0)
    assert metrics(sailed(np.zeros(ROWS), delta))["rudder_reversals"] == pytest.approx(6.0)


@pytest.mark.parametrize(("angle", "share"), [(34.9, 0.0), (34.97, 0.5), (-34.97, 0.5)])
def test_hard_over_is_99_9_percent_of_the_largest_angle(angle, share):
    """34.965 deg of 35; the start does not count: 300 of the 600 ends of intervals."""
    delta = np.zeros(ROWS)
    delta[1:301] = angle
    assert metrics(sailed(np.zeros(ROWS), delta))["saturation"] == pytest.approx(share)


def test_costs_by_hand():
    """2 deg of error for a third of the time, 3 deg of rudder for half: J = 4/3 + lambda 9/2."""
    error, delta = np.zeros(ROWS), np.zeros(ROWS)
    error[1:201], delta[1:301] = 2.0, -3.0
    found = metrics(sailed(error, delta))
    for lam, J in ((0.1, 4 / 3 + 0.45), (1.0, 4 / 3 + 4.5), (8.0, 4 / 3 + 36.0)):
        assert found[f"J_{lam:g}"] == pytest.approx(J)
    assert found["rms_error"] == pytest.approx(math.sqrt(4 / 3))
    assert found["rudder_travel"] == pytest.approx(6.0 * 6.0)  # 3 deg there and back in 1/6 h


def test_an_interval_across_180_deg_is_no_large_error():
    """Ordered 179 deg and heading -179 deg: an error of 2 deg, and J = 4 deg2."""
    orders = np.full(ROWS, 179.0)
    t = sailed(np.full(ROWS, 2.0), orders_deg=orders, psi=np.full(ROWS, np.radians(-179.0)))
    assert metrics(t)["J_1"] == pytest.approx(4.0)
