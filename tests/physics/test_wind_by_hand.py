"""Wind force, gusts and the random disturbance at one instant, by hand."""

import math

import numpy as np
import pytest

from ship_gym.physics.disturbance import disturbance_forces, set_harmonics
from ship_gym.physics.quantities import Around
from ship_gym.physics.step import held_loads
from ship_gym.physics.waves import WaveState
from ship_gym.physics.wind import gust_factor, wind_forces
from ship_gym.sea.records import N_GUSTS, N_HARMONICS, SEA_DTYPE, set_phases

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


def forces(wind_to, speed=10.0, psi=0.0, u=0.0, v=0.0, **values):
    """Force of a wind that goes to `wind_to` [rad] on a ship at a heading."""
    north, east = speed * math.cos(wind_to), speed * math.sin(wind_to)
    blown = sea(wind_north=north, wind_east=east, **values)
    return wind_forces(0.0, (u, v, 0.0, 0.0, 0.0, psi), blown, TABLE)


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


def test_gusts_are_cosines_of_their_phases():
    """1 + 0.2 cos(0) + 0.1 cos(90 deg) at 0 s; at a quarter of the first period 1 - 0.1 sin."""
    share, omega, phase = np.zeros((3, N_GUSTS))
    share[:2], omega[:2], phase[:2] = (0.2, 0.1), (0.5, 1.0), (0.0, 0.25)
    gusty = sea(gust_share=share, gust_omega=omega, gust_phase=phase)
    assert gust_factor(0.0, gusty) == pytest.approx(1.2)
    # 0.5 rad/s for pi s: 90 deg; the other, from 90 deg on, is at 270 deg then
    assert gust_factor(math.pi, gusty) == pytest.approx(1.0)
    # 120 deg and 330 deg
    t = 4.0 * math.pi / 3.0
    second = 0.1 * math.cos(0.5 * math.pi + t)
    assert gust_factor(t, gusty) == pytest.approx(1.0 + 0.2 * -0.5 + second)


def test_a_gust_acts_by_its_square():
    share = np.zeros(N_GUSTS)
    share[0] = 0.2  # 12 m/s instead of 10
    found = forces(SOUTH, gust_share=share)
    assert found == pytest.approx(expected(61.25 * 1.44, *TABLE[0]), abs=1e-6)


@pytest.mark.parametrize("time", [0.0, 3.0, 50.0])
def test_the_disturbance_is_the_sum_of_its_harmonics(time):
    """Sum of std amplitude_k cos(k omega t + 2 pi phase_k), own phases for force and moment."""
    rng = np.random.default_rng(1)
    amplitude, phases = rng.random(N_HARMONICS), rng.random((1, 2 * N_HARMONICS))
    record = np.zeros(1, SEA_DTYPE)
    record["amplitude"], record["omega_1"] = amplitude, 0.02
    record["Y_std"], record["N_std"] = 3.0, 70.0
    set_harmonics(record, phases)
    k = np.arange(1, N_HARMONICS + 1)
    angles = k * 0.02 * time + 2.0 * np.pi * phases.reshape(2, -1)
    Y, N = (amplitude * np.cos(angles)).sum(axis=1) * [3.0, 70.0]
    assert disturbance_forces(time, record[0]) == pytest.approx((Y, N), rel=1e-9)


def test_the_disturbance_of_a_step_is_that_of_its_middle():
    """A step of 2 s from 10 s on: taken at 11 s; sway force and yaw moment, no surge force."""
    record = np.zeros(1, SEA_DTYPE)
    record["disturbed"], record["omega_1"] = 1, 0.3
    record["Y_cos"][0, 0], record["N_sin"][0, 0] = 5.0, 7.0
    body, waves = (0.0,) * 6, WaveState(1.0, 2.0, 3.0, *(0.0,) * 6)
    around = Around(np.zeros((6, 0)), np.zeros(1, int), np.zeros((0, 0, 0, 9)), TABLE)
    wave, wind, found = held_loads(10.0, 2.0, body, record[0], waves, around)
    assert wave == wind == (0.0, 0.0, 0.0)  # neither waves nor wind are on
    expected = (0.0, 5.0 * math.cos(3.3), 7.0 * math.sin(3.3))
    assert found == pytest.approx(expected, rel=1e-12)


def test_phases_of_current_and_gusts_follow_those_of_the_disturbance():
    record = np.zeros(1, SEA_DTYPE)
    uniform = np.arange(2 * N_HARMONICS + 1 + N_GUSTS, dtype=float)[None, :]
    set_harmonics(record, uniform)
    set_phases(record, uniform)
    assert record["variation_phase"][0] == 2 * N_HARMONICS
    assert (record["gust_phase"][0] == 2 * N_HARMONICS + 1 + np.arange(N_GUSTS)).all()
