"""Wind force, gusts and the random disturbance at one instant, by hand."""

import math

import numpy as np
import pytest

from ship_gym.physics.disturbance import disturbance_forces, draw_disturbance
from ship_gym.physics.quantities import Body
from ship_gym.physics.scratch import GUST_COLUMNS, N_GUSTS, scratch_for
from ship_gym.physics.step import Water, held_loads
from ship_gym.physics.waves import EIGHT_WAVES, N_WAVE_STATE, PHASE, Waves
from ship_gym.physics.wind import gust_factor, wind_forces
from ship_gym.sea import Sea
from ship_gym.sea.records import N_DISTURBANCE, N_HARMONICS, SEA_DTYPE, set_phases, waters
from ship_gym.sea.spectra import WaveSystem
from ship_gym.ships import load_ship

RHO_AIR = 1.225
A_F, A_L, L_OA = 100.0, 400.0, 50.0
# CX, CY, CN at 0, 90, 180, 270 and 360 deg; no two alike, so that the angle can be told
TABLE = np.array(
    [
        [-0.8, 0.0, 0.0],
        [-0.1, -0.9, -0.05],
        [0.6, 0.0, 0.0],
        [0.2, 0.7, 0.04],
        [-0.8, 0.0, 0.0],
    ]
)


def sea(**values):
    record = np.zeros(1, SEA_DTYPE)
    record["A_F"], record["A_L"], record["L_oa"] = A_F, A_L, L_OA
    for name, value in values.items():
        record[name] = value
    return record[0]


def forces(wind_to, speed=10.0, psi=0.0, u=0.0, v=0.0, factor=1.0):
    """Force of a wind that goes to `wind_to` [rad] on a ship at a heading."""
    north, east = speed * math.cos(wind_to), speed * math.sin(wind_to)
    blown = sea(wind_north=north, wind_east=east)
    return wind_forces(u, v, psi, factor, blown, TABLE)


def expected(q, CX, CY, CN):
    return q * A_F * CX, q * A_L * CY, q * A_L * L_OA * CN


NORTH, EAST, SOUTH, WEST = 0.0, 0.5 * math.pi, math.pi, -0.5 * math.pi


@pytest.mark.parametrize("psi", [0.0, 0.7, 2.5, -2.0])
@pytest.mark.parametrize(
    ("off", "row"),
    [(SOUTH, 0), (WEST, 1), (NORTH, 2), (EAST, 3)],
    ids=["head", "stbd", "aft", "port"],
)
def test_wind_of_10_m_s_from_four_sides(psi, off, row):
    """q = 1/2 1.225 10^2 = 61.25 Pa; from starboard: a wind to port of the bow, gamma 90 deg."""
    found = forces(psi + off, psi=psi)
    assert found == pytest.approx(expected(61.25, *TABLE[row]), abs=1e-6)


@pytest.mark.parametrize(("degrees", "share"), [(30.0, 1 / 3), (45.0, 0.5), (80.0, 8 / 9)])
def test_between_the_rows_of_the_table_it_is_linear_in_the_angle(degrees, share):
    """From 30 deg on the starboard bow: two thirds of the head wind's row, one of the beam's."""
    row = (1.0 - share) * TABLE[0] + share * TABLE[1]
    found = forces(math.pi + math.radians(degrees))
    assert found == pytest.approx(expected(61.25, *row), rel=1e-9, abs=1e-9)


def test_between_port_and_ahead():
    """60 deg on the port bow is 300 deg: two thirds of the row of 270 deg, one of 360 deg."""
    found = forces(math.pi - math.radians(60.0))
    row = (2.0 * TABLE[3] + TABLE[4]) / 3.0
    assert found == pytest.approx(expected(61.25, *row), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(
    ("u", "v", "wind_to", "speed", "row", "relative"),
    [
        (5.0, 0.0, SOUTH, 10.0, 0, 15.0),  # against the wind
        (5.0, 0.0, NORTH, 5.0, None, 0.0),  # with it: no wind
        (5.0, 0.0, NORTH, 12.0, 2, 7.0),
        (0.0, 2.0, WEST, 10.0, 1, 12.0),  # drifts to starboard, the wind comes from there
        (0.0, -2.0, EAST, 3.0, 3, 5.0),
        (4.0, 0.0, 0.0, 0.0, 0, 4.0),  # the ship's own wind
    ],
)
def test_the_wind_counts_relative_to_the_ship(u, v, wind_to, speed, row, relative):
    row = np.zeros(3) if row is None else TABLE[row]
    q = 0.5 * RHO_AIR * relative**2
    assert forces(wind_to, speed, u=u, v=v) == pytest.approx(expected(q, *row), abs=1e-6)


def harmonics_of_gusts(*harmonics):
    """Shares and frequencies, and phases, of (share, frequency [rad/s], phase [turns]) each."""
    gusts, phases = np.zeros((2, GUST_COLUMNS)), np.zeros(GUST_COLUMNS)
    for k, (share, omega, phase) in enumerate(harmonics):
        gusts[:, k], phases[k] = (share, omega), phase
    return gusts, phases


def test_gusts_are_cosines_of_their_phases():
    """1 + 0.2 cos(0) + 0.1 cos(90 deg) at 0 s; at a quarter of the first period 1 - 0.1 sin."""
    gusts, phases = harmonics_of_gusts((0.2, 0.5, 0.0), (0.1, 1.0, 0.25))

    def factor(time, scale=1.0):
        return gust_factor(time, scale, gusts, phases, np.zeros(GUST_COLUMNS))

    assert factor(0.0) == pytest.approx(1.2)
    # 0.5 rad/s for pi s: 90 deg; the other, from 90 deg on, is at 270 deg then
    assert factor(math.pi) == pytest.approx(1.0)
    # 120 deg and 330 deg
    t = 4.0 * math.pi / 3.0
    second = 0.1 * math.cos(0.5 * math.pi + t)
    assert factor(t) == pytest.approx(1.0 + 0.2 * -0.5 + second)
    assert factor(t, 0.5) == pytest.approx(1.0 + 0.5 * (0.2 * -0.5 + second))
    assert factor(t, 0.0) == 1.0


def test_every_harmonic_of_the_gusts_counts():
    """All columns, in the last eight as in the first."""
    rng = np.random.default_rng(2)
    rows = rng.random((GUST_COLUMNS, 3))
    gusts, phases = harmonics_of_gusts(*rows)
    share, omega, phase = rows.T
    for t in (0.0, 7.0, 300.0):
        expected = 1.0 + (share * np.cos(omega * t + 2.0 * np.pi * phase)).sum()
        found = gust_factor(t, 1.0, gusts, phases, np.zeros(GUST_COLUMNS))
        assert found == pytest.approx(expected, abs=1e-9)


def test_a_gust_acts_by_its_square():
    """12 m/s instead of 10."""
    found = forces(SOUTH, factor=1.2)
    assert found == pytest.approx(expected(61.25 * 1.44, *TABLE[0]), abs=1e-6)


def surroundings(gusts=None, harmonics=None):
    """Water around one ship without waves: gusts (2, K) and their phases, and the disturbance."""
    waves = Waves(
        components=np.zeros((1, 3, 0)),
        offsets=np.zeros(0),
        turns=np.zeros((0, 2)),
        groups=np.zeros(1, np.uint64),
        swell=np.zeros(0, np.bool_),
        response=np.zeros((1, 2, 2, 0), EIGHT_WAVES),
        phases=np.zeros((1, 0)),
    )
    shares, phases = (np.zeros((2, 0)), np.zeros(0)) if gusts is None else gusts
    if harmonics is None:
        harmonics = np.zeros((1, 4, 0))
    return Water(waves, TABLE[None], shares[None], phases[None], harmonics)


def held(time, dt, body, record, water, met=(0.0,) * N_WAVE_STATE):
    return held_loads(time, dt, body, record, water, 0, np.array(met), scratch_for(1)[0])


def test_the_wind_of_a_step_is_that_of_its_middle():
    """A step of 2 s from 10 s on: the gust of 11 s, the heading after 1 s of turning.

    10 m/s from the north, a ship that heads 0.3 rad off and turns by -0.3 rad/s: a head wind.
    """
    record = sea(windy=1, wind_north=-10.0, gust_scale=1.0)
    water = surroundings(harmonics_of_gusts((0.2, 0.3, 0.1)))
    _, wind, other = held(10.0, 2.0, Body(0.0, 0.0, -0.3, 0.0, 0.0, 0.3), record, water)
    factor = 1.0 + 0.2 * math.cos(0.3 * 11.0 + 0.2 * math.pi)
    assert wind == pytest.approx(expected(61.25 * factor**2, *TABLE[0]), rel=1e-9, abs=1e-6)
    assert other == (0.0, 0.0, 0.0)


def test_the_drift_of_a_step_is_what_the_waves_did_before_it():
    """Held as found when the waves were looked at, and nothing without waves."""
    met, body = (3.0, 5.0, 7.0, *(9.0,) * (N_WAVE_STATE - 3)), Body(*(0.0,) * 6)
    assert held(0.0, 1.0, body, sea(wavy=1), surroundings(), met)[0] == (3.0, 5.0, 7.0)
    assert held(0.0, 1.0, body, sea(), surroundings(), met)[0] == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("time", [0.0, 3.0, 50.0])
def test_the_disturbance_is_the_sum_of_its_harmonics(time):
    """Sum of std amplitude_k cos(k omega t + 2 pi phase_k), own phases for force and moment."""
    rng = np.random.default_rng(1)
    amplitude, phases = rng.random(N_HARMONICS), rng.random((1, 2 * N_HARMONICS))
    record = np.zeros(1, SEA_DTYPE)
    record["Y_std"], record["N_std"] = 3.0, 70.0
    harmonics = np.zeros((1, 4, N_HARMONICS))
    draw_disturbance(np.arange(1), harmonics, record, amplitude, phases)
    k = np.arange(1, N_HARMONICS + 1)
    angles = k * 0.02 * time + 2.0 * np.pi * phases.reshape(2, -1)
    Y, N = (amplitude * np.cos(angles)).sum(axis=1) * [3.0, 70.0]
    assert disturbance_forces(time, 0.02, harmonics[0]) == pytest.approx((Y, N), rel=1e-9)


def test_the_disturbance_of_a_step_is_that_of_its_middle():
    """A step of 2 s from 10 s on: taken at 11 s; sway force and yaw moment, no surge force."""
    record = sea(disturbed=1, omega_1=0.3)
    harmonics = np.zeros((1, 4, 1))
    harmonics[0, :, 0] = 5.0, 0.0, 0.0, 7.0  # cosine of the force, sine of the moment
    met = (1.0, 2.0, 3.0, *(0.0,) * (N_WAVE_STATE - 3))
    wave, wind, found = held(
        10.0, 2.0, Body(*(0.0,) * 6), record, surroundings(harmonics=harmonics), met
    )
    assert wave == wind == (0.0, 0.0, 0.0)  # neither waves nor wind are on
    expected = (0.0, 5.0 * math.cos(3.3), 7.0 * math.sin(3.3))
    assert found == pytest.approx(expected, rel=1e-11)


def test_phases_of_current_gusts_and_waves_follow_those_of_the_disturbance():
    """Of two ships the second is drawn; the first keeps what she has."""
    everything = Sea(
        0.5, current_variation=0.3, sway_disturbance=0.01, wind_speed=10.0, gusts=True,
        waves=(WaveSystem("jonswap", 3.0, 9.0),), wave_count=13,
    )  # fmt: skip
    water = waters([load_ship("kcs")] * 2, everything)
    assert water.n_phases == N_DISTURBANCE + 1 + N_GUSTS + 13
    uniform = np.arange(water.n_phases, dtype=float)[None, :]
    set_phases(water, np.array([1]), uniform)
    after = N_DISTURBANCE + 1
    assert water.records["variation_phase"].tolist() == [0.0, N_DISTURBANCE]
    assert (water.gust_phases[1, :N_GUSTS] == after + np.arange(N_GUSTS)).all()
    assert (water.waves_of(1)[PHASE] == after + N_GUSTS + np.arange(13)).all()
    assert not water.gust_phases[0].any() and not water.waves_of(0)[PHASE].any()
    assert not water.harmonics[0].any() and water.harmonics[1].any()
