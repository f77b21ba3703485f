"""Wave-frequency motion and drift of one wave, by hand: phases, sides, rates in time."""

import math

import numpy as np
import pytest

from ship_gym.physics.waves import (
    WAVE_EXTRAPOLATION,
    WAVE_ROLL,
    WAVE_SWAY,
    WAVE_SWAY_VELOCITY,
    WAVE_YAW,
    WAVE_YAW_RATE,
    set_waves,
    wave_loads,
)

G = 9.80665
A, OMEGA = 2.0, 0.5  # amplitude [m] and frequency [rad/s] of the wave
K = OMEGA**2 / G
GRID = (1.0, 1.0, 0.0)  # speed step and largest speed of the table, speed of the ship [m/s]
STILL = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
# real and imaginary part of sway, roll and yaw; no two alike, so that none can stand for another
SWAY, ROLL, YAW = (0.5, 0.25), (0.3, 0.2), (0.04, 0.01)


def sea(towards, turns):
    """One wave that goes `towards` [rad], with a phase of so many turns at the origin."""
    waves = np.zeros((6, 1))
    set_waves(np.array([[A, OMEGA, 0.0]]), towards, np.array([turns]), waves)
    return waves


def table(drift=(0.0, 0.0, 0.0)):
    """The same response at both speeds and both headings."""
    return np.broadcast_to([*drift, *SWAY, *ROLL, *YAW], (2, 2, 1, 9)).copy()


def loads(towards=-0.5 * math.pi, turns=0.0, time=0.0, body=STILL, response=None, mean=False):
    response = table() if response is None else response
    groups = np.array([0, 1])
    return wave_loads(time, body, sea(towards, turns), groups, response, GRID, mean)


HALF = math.sqrt(0.5)


@pytest.mark.parametrize(
    ("turns", "cosine", "sine"),
    [(0.0, 1, 0), (0.125, HALF, HALF), (0.25, 0, 1), (0.5, -1, 0), (0.75, 0, -1)],
)
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_motion_is_the_real_part_of_response_times_wave(turns, cosine, sine, side):
    """Re[(p + i q) a e^(i theta)] = a (p cos theta - q sin theta), from starboard (side 1).

    At an eighth of a turn roll is 2 (0.3 - 0.2) / sqrt(2) = 0.1414 rad; with the other sign of the
    sine part it would be 0.7071. From port everything lateral has the other sign.
    """
    # a ship that heads north: waves that go west come from starboard
    found = loads(-0.5 * math.pi * side, turns)
    for channel, (p, q) in ((WAVE_SWAY, SWAY), (WAVE_ROLL, ROLL), (WAVE_YAW, YAW)):
        expected = side * A * (p * cosine - q * sine)
        assert found[channel] == pytest.approx(expected, abs=1e-9)


def test_roll_an_eighth_of_a_turn_into_the_wave():
    assert loads(turns=0.125)[WAVE_ROLL] == pytest.approx(0.2 * HALF, abs=1e-9)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(("turns", "cosine", "sine"), [(0.0, 1, 0), (0.25, 0, 1), (0.5, -1, 0)])
def test_rates_of_a_ship_that_lies_still_are_the_derivatives_in_time(side, turns, cosine, sine):
    """d/dt of a (p cos(omega t + phi) - q sin(omega t + phi)) = -omega a (p sin + q cos).

    Yaw rate at phase 0, from starboard: -0.5 * 2 * 0.01 = -0.01 rad/s.
    """
    found = loads(-0.5 * math.pi * side, turns)
    for channel, (p, q) in ((WAVE_SWAY_VELOCITY, SWAY), (WAVE_YAW_RATE, YAW)):
        expected = -side * OMEGA * A * (p * sine + q * cosine)
        assert found[channel] == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("speed", [-4.0, 0.0, 4.0])
def test_head_waves_are_met_faster_and_following_ones_slower(speed):
    """omega_e = omega + k U against the waves; at phase 0 the yaw rate is -omega_e a q."""
    body = (speed, 0.0, 0.0, 0.0, 0.0, 0.0)
    # slightly off the bow, so that the side is known
    found = loads(math.pi - 1e-9, body=body)
    assert found[WAVE_YAW_RATE] == pytest.approx(A * YAW[1] * (OMEGA + K * speed), rel=1e-6)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("mean", [True, False])
def test_drift_of_one_wave_is_the_amplitude_squared_times_its_coefficients(side, mean):
    found = loads(-0.5 * math.pi * side, 0.3, 7.0, response=table((3.0, 5.0, 7.0)), mean=mean)
    assert found[:3] == pytest.approx((12.0, 20.0 * side, 28.0 * side), rel=1e-9)


def test_the_response_is_linear_in_speed_and_heading():
    """At a quarter of the speed step and three quarters of the headings' step.

    Corners by (speed, heading): 0, 4, 8, 16; low = 3, high = 8 + 6 = 14, a quarter up: 5.75.
    """
    response = np.zeros((2, 2, 1, 9))
    response[..., 0, 0] = [[0.0, 4.0], [8.0, 16.0]]
    waves, groups = sea(-0.75 * math.pi, 0.0), np.array([0, 1])  # mu = 135 deg
    found = wave_loads(0.0, STILL, waves, groups, response, (2.0, 2.0, 0.5), True)
    assert found[0] == pytest.approx(A**2 * 5.75, rel=1e-12)


def test_each_direction_has_its_own_side():
    """Of two equal waves from starboard and from port the lateral parts cancel, surge doubles."""
    two = np.concatenate([sea(-0.5 * math.pi, 0.0), sea(0.5 * math.pi, 0.0)], axis=1)
    response = np.concatenate([table((3.0, 5.0, 7.0))] * 2, axis=2)
    found = wave_loads(0.0, STILL, two, np.array([0, 1, 2]), response, GRID, True)
    assert found[0] == pytest.approx(24.0)
    assert np.abs(found[1:8]).max() < 1e-12


@pytest.mark.parametrize(("speed", "outside"), [(0.9, 0.0), (1.0, 0.0), (1.5, 0.5)])
def test_how_far_a_ship_is_faster_than_its_table(speed, outside):
    waves, groups = sea(0.0, 0.0), np.array([0, 1])
    found = wave_loads(0.0, STILL, waves, groups, table(), (1.0, 1.0, speed), False)
    assert found[WAVE_EXTRAPOLATION] == pytest.approx(outside)


def test_a_wave_goes_where_its_direction_says():
    """Going east by k = omega^2 / g: a quarter of a wave length east the phase is 90 deg behind."""
    waves = sea(0.5 * math.pi, 0.0)
    assert waves[:, 0] == pytest.approx([A, OMEGA, 0.0, K, 0.0, 0.5 * math.pi], abs=1e-12)
    body = (0.0, 0.0, 0.0, 0.0, 0.5 * math.pi / K, 0.0)
    found = loads(0.5 * math.pi, body=body)  # from port
    assert found[WAVE_ROLL] == pytest.approx(-A * ROLL[1], abs=1e-9)  # sin(-90 deg) = -1
