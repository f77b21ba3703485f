"""Wave-frequency motion and drift of one wave, by hand: phases, sides, rates in time."""

import math

import numpy as np
import pytest

from ship_gym.physics.quantities import Body
from ship_gym.physics.scratch import N_SUMS
from ship_gym.physics.waves import (
    EIGHT_WAVES,
    WAVE_AHEAD,
    WAVE_EXTRAPOLATION,
    WAVE_ROLL,
    WAVE_SWAY,
    WAVE_SWAY_VELOCITY,
    WAVE_YAW,
    WAVE_YAW_RATE,
    Waves,
    wave_loads,
)
from ship_gym.sea.records import SEA_DTYPE

G = 9.80665
A, OMEGA = 2.0, 0.5  # amplitude [m] and frequency [rad/s] of the wave
K = OMEGA**2 / G
# real and imaginary part of sway, roll and yaw; no two alike, so that none can stand for another
SWAY, ROLL, YAW = (0.5, 0.25), (0.3, 0.2), (0.04, 0.01)


def still(u=0.0, r=0.0, y=0.0):
    """A ship at the origin that heads north."""
    return Body(u, 0.0, r, 0.0, y, 0.0)


def table(drift=(0.0, 0.0, 0.0)):
    """The same response at both speeds and both headings, shape (2, 2, 9)."""
    return np.broadcast_to([*drift, *SWAY, *ROLL, *YAW], (2, 2, 9)).copy()


def sea(mean=False, **values):
    record = np.zeros(1, SEA_DTYPE)
    record["wavy"], record["wave_share"], record["drift"], record["mean_drift"] = 1, 1.0, 1.0, mean
    record["speed_step"] = record["speed_max"] = record["wind_sea"] = 1.0
    for name, value in values.items():
        record[name] = value
    record["wave_north"], record["wave_east"] = np.cos(record["wave_to"]), np.sin(record["wave_to"])
    return record[0]


def waves_of(directions, turns, response, omegas=(OMEGA,)):
    """Waves of `A` of each frequency in each direction, each an eight that is filled up."""
    groups = np.arange(len(directions) + 1, dtype=np.uint64)
    components = np.zeros((1, 3, 8 * len(directions)))
    phases = np.zeros((1, 8 * len(directions)))
    found = np.zeros((1, 2, 2, len(directions)), EIGHT_WAVES)
    for g in range(len(directions)):
        for k, omega in enumerate(omegas):
            components[0, :, 8 * g + k] = A, omega, omega**2 / G
            phases[0, 8 * g + k] = turns
            found["of"][0, :, :, g, :, k] = response
    offsets = np.array(directions)
    turns = np.stack([np.cos(offsets), np.sin(offsets)], axis=1)
    swell = np.zeros(len(directions), np.bool_)
    return Waves(components, offsets, turns, groups, swell, found, phases)


def loads(
    towards=-0.5 * math.pi, turns=0.0, time=0.0, dt=0.0, body=None, response=None, mean=False,
    directions=(0.0,), omegas=(OMEGA,), **values,
):  # fmt: skip
    """Of waves that go `towards` [rad], with a phase of so many turns at the origin."""
    waves = waves_of(directions, turns, table() if response is None else response, omegas)
    body = still() if body is None else body
    work = np.zeros((N_SUMS, 8))
    return wave_loads(time, dt, body, sea(mean, wave_to=towards, **values), waves, 0, work)


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
    # slightly off the bow, so that the side is known
    found = loads(math.pi - 1e-9, body=still(speed))
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
    response = np.zeros((2, 2, 9))
    response[..., 0] = [[0.0, 4.0], [8.0, 16.0]]
    # mu = 135 deg
    found = loads(
        -0.75 * math.pi, body=still(0.5), response=response, mean=True, speed_step=2.0,
        speed_max=2.0,
    )  # fmt: skip
    assert found[0] == pytest.approx(A**2 * 5.75, rel=1e-12)


def test_the_speed_through_the_water_enters_the_table():
    """0.5 m/s over ground against 0.25 m/s of current: 0.75 of the way to the second speed."""
    response = np.zeros((2, 2, 9))
    response[1, :, 0] = 8.0
    found = loads(body=still(0.5), response=response, mean=True, V_north=-0.25)
    assert found[0] == pytest.approx(A**2 * 6.0, rel=1e-12)


@pytest.mark.parametrize("mean", [True, False])
def test_each_direction_has_its_own_side(mean):
    """Of two equal waves from starboard and from port the lateral parts cancel, surge doubles.

    Without `mean` the two waves are in phase, and beat: |a + a|^2 = 4 a^2 instead of 2 a^2.
    """
    found = loads(
        0.0, response=table((3.0, 5.0, 7.0)), mean=mean,
        directions=(-0.5 * math.pi, 0.5 * math.pi),
    )  # fmt: skip
    assert found[0] == pytest.approx(24.0 if mean else 48.0)
    assert np.abs(found[1:8]).max() < 1e-11


@pytest.mark.parametrize(("speed", "outside"), [(0.9, 0.0), (1.0, 0.0), (1.5, 0.5)])
def test_how_far_a_ship_is_faster_than_its_table(speed, outside):
    found = loads(0.0, body=still(speed))
    assert found[WAVE_EXTRAPOLATION] == pytest.approx(outside)


def test_a_wave_goes_where_its_direction_says():
    """Going east by k = omega^2 / g: a quarter of a wave length east the phase is 90 deg behind."""
    found = loads(0.5 * math.pi, body=still(y=0.5 * math.pi / K))  # from port
    assert found[WAVE_ROLL] == pytest.approx(-A * ROLL[1], abs=1e-9)  # sin(-90 deg) = -1


@pytest.mark.parametrize("dt", [0.0, 1.0, 4.0])
@pytest.mark.parametrize("speed", [0.0, 0.8])
def test_the_drift_of_two_waves_is_the_mean_of_two_instants_of_the_step(dt, speed):
    """Two head waves of one phase at 0 s that beat: sum over m, n of a^2 T cos(difference), T = 3.

    Twice a^2 T and twice a^2 T cos((omega_1 - omega_2) t), of the frequencies at which the ship
    meets them, at a quarter and three quarters of the step; she goes on as she does.
    """
    time, omegas = 5.0, (0.5, 0.9)
    first, second = (omega + omega**2 / G * speed for omega in omegas)
    # at the origin now, so the phases so far are those of time alone
    now = (omegas[0] - omegas[1]) * time
    angles = [now + (first - second) * share * dt for share in (0.25, 0.75)]
    expected = A**2 * 3.0 * (2.0 + 2.0 * np.mean(np.cos(angles)))
    found = loads(
        math.pi, time=time, dt=dt, body=still(speed), response=table((3.0, 0.0, 0.0)),
        omegas=omegas,
    )  # fmt: skip
    assert found[0] == pytest.approx(expected, rel=1e-9)
    assert found[WAVE_AHEAD] == dt


def test_the_drift_is_that_of_the_heading_at_the_middle_of_the_step():
    """2 s at 0.2 rad/s: 0.2 rad at the middle; the motion is that of now.

    Waves that go south meet a ship that heads north from ahead: mu = pi, at the middle pi - 0.2
    from the other side; the drift in surge falls linearly from 10 there to 0 in following waves.
    """
    response = table()
    response[:, 1, 0] = 10.0
    found = loads(math.pi, dt=2.0, body=still(r=0.2), response=response)
    assert found[0] == pytest.approx(A**2 * 10.0 * (1.0 - 0.2 / math.pi), rel=1e-9)
    turned = loads(math.pi, dt=0.0, body=still(r=0.2), response=response)
    assert found[3:8] == turned[3:8] and turned[0] == pytest.approx(A**2 * 10.0)


def test_height_and_drift_of_a_sea_are_switches():
    """Of half the height: half of the motion, a quarter of the drift; and none of it."""
    drift = table((3.0, 5.0, 7.0))
    whole, half = loads(response=drift), loads(response=drift, wave_share=0.5)
    assert half[:3] == pytest.approx(np.multiply(whole[:3], 0.25), rel=1e-12)
    assert half[3:8] == pytest.approx(np.multiply(whole[3:8], 0.5), rel=1e-12)
    none = loads(response=drift, drift=0.0)
    assert none[:3] == (0.0, 0.0, 0.0) and none[3:8] == whole[3:8]
