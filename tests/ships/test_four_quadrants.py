"""Harmonics of the series screws beside the polynomials of the first quadrant, and the joints."""

import dataclasses
import math

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.ships import load_ship
from ship_gym.ships.b_series import b_series
from ship_gym.ships.four_quadrants import Screw, harmonics, nearest_screw, starred_of
from ship_gym.ships.open_water import JOIN, ROUND, first_quadrant

B5 = Screw(1.0, 0.75, 5)


def at(J):
    return np.arctan(np.asarray(J) / (0.7 * math.pi))


def K(C, J):
    return C * (math.pi / 8.0 * (np.asarray(J) ** 2 + (0.7 * math.pi) ** 2))[..., None]


@pytest.mark.parametrize(
    "screw",
    [B5, *(Screw(pitch, 0.70, 4) for pitch in (0.6, 0.8, 1.0, 1.2, 1.4)), Screw(1.0, 0.40, 4)],
)
def test_first_quadrant_is_that_of_the_polynomials(screw):
    """Two sources that know nothing of each other here: harmonics and Oosterveld's polynomials."""
    J = np.linspace(0.0, 1.2, 13)
    K_T, K_Q = b_series(J, **dataclasses.asdict(screw))
    found = K(starred_of(screw, at(J)), J)[K_T > 0.0]
    np.testing.assert_allclose(found[:, 0], K_T[K_T > 0.0], atol=0.045)
    np.testing.assert_allclose(found[:, 1], K_Q[K_T > 0.0], atol=0.007)


def test_b5_75_by_hand():
    """Coefficients of the reference file at four angles; B_1 and A_0 alone make most of it."""
    assert harmonics(B5)[:2].ravel().tolist() == pytest.approx(
        [2.3789, 0.0, -3.6237, 0.0, 18.34, -77.904, -27.937, 115.96]
    )
    table = harmonics(B5)
    even, odd = table[0::2, 0, 0], table[1::2, 0, 1]
    locked = 0.01 * (even[0::2].sum() - even[1::2].sum() + odd[0::2].sum() - odd[1::2].sum())
    assert starred_of(B5, math.pi / 2)[0] == pytest.approx(locked, rel=1e-12)
    assert starred_of(B5, 0.0)[0] == pytest.approx(0.01 * table[:, 0, 0].sum(), rel=1e-12)


def test_pitch_and_area_lie_between_the_tabulated_screws():
    middle = 0.5 * (harmonics(Screw(0.6, 0.7, 4)) + harmonics(Screw(0.8, 0.7, 4)))
    np.testing.assert_allclose(harmonics(Screw(0.7, 0.7, 4)), middle, atol=1e-12)
    assert (harmonics(Screw(1.7, 0.9, 3)) == harmonics(Screw(1.4, 0.7, 4))).all()
    np.testing.assert_allclose(
        harmonics(Screw(1.0, 0.55, 4)),
        0.5 * (harmonics(Screw(1.0, 0.4, 4)) + harmonics(Screw(1.0, 0.7, 4))),
        atol=1e-12,
    )
    small, large = (starred_of(Screw(0.721, area, 4), math.pi / 2)[0] for area in (0.431, 0.7))
    assert 0.4 < small / large < 0.7  # about as the areas, 0.62
    lever = [
        np.divide(*starred_of(Screw(0.721, area, 4), math.pi / 2)[::-1]) for area in (0.431, 0.7)
    ]
    assert lever[0] == pytest.approx(lever[1], rel=0.25)  # torque by thrust: the same pitch


@pytest.mark.parametrize("screw", [(-1.0, 0.7, 4), (0.8, 7.0, 4), (0.8, 0.7, 1)])
def test_no_such_screw(screw):
    with pytest.raises(ConfigError, match="allowed is"):
        Screw(*screw)


def test_nearest_screw_finds_a_screw_of_the_series():
    J = np.linspace(0.0, 0.8, 17)
    for screw in (Screw(0.8, 0.7, 4), B5):
        assert nearest_screw(J, b_series(J, **dataclasses.asdict(screw))[0] + 1e-4) == screw


def test_own_curve_inside_its_data_and_series_far_from_it(ship):
    card, table = ship.open_water.card, ship.open_water
    J = np.linspace(*card["J_range"], 41)
    own = np.stack(first_quadrant(table, J), axis=-1)
    np.testing.assert_allclose(K(table(at(J)), J), own, atol=3e-4)
    screw = Screw(**card["four_quadrants"])
    low, high = at(card["J_range"][0]) - JOIN, at(card["J_range"][1]) + JOIN
    away = ROUND.points[(ROUND.points <= low) | (ROUND.points >= high)]
    np.testing.assert_allclose(table(away), starred_of(screw, away), atol=1e-12)


def test_no_jump_and_no_kink_at_the_joints(ship):
    """The table closes on itself; from one cell to the next its slope changes by little.

    Were the curves joined by a straight fade, the slope would jump by up to 0.4, were they not
    joined at all, by 20.
    """
    values = ship.open_water.values
    np.testing.assert_allclose(values[0], values[-1], atol=1e-12)
    slope = np.diff(values, axis=0) / ROUND.step
    bend = np.abs(np.diff(slope, axis=0))  # per step of 0.3 deg
    lows, highs = (at(J) for J in ship.open_water.card["J_range"])
    joints = [lows - JOIN, lows, highs, highs + JOIN]
    near = [round(float(e - ROUND.start) / ROUND.step) for e in joints]
    assert all((bend[k - 3 : k + 2] < 0.2).all() for k in near)


def test_stopped_screw_is_dragged_and_turned(ship):
    """At n = 0 ahead it brakes and is turned ahead by the water; astern both change sign."""
    locked, backing = ship.open_water(math.pi / 2), ship.open_water(-math.pi / 2)
    assert locked[0] < -0.3 and locked[1] < 0.0
    assert backing[0] > 0.3 and backing[1] > 0.0
    bollard, astern = ship.open_water(0.0), ship.open_water(math.pi)
    assert bollard[0] > -astern[0] > 0.0 and bollard[1] > 0.0 > astern[1]


def test_what_stands_for_the_propeller_is_named_as_an_estimate():
    text = load_ship("kvlcc2_model").estimated["open_water.four_quadrants"]
    assert "4 blades" in text and "0.721" in text


@pytest.mark.parametrize("name", ["kcs_model", "kvlcc2_model", "dtc_model", "s175", "onrt_model"])
def test_a_propeller_gives_no_more_than_it_gets(name):
    """T u_A <= 2 pi n Q at every advance angle: no thrust for nothing, no free windmill."""
    epsilon = np.linspace(-math.pi, math.pi, 3001)
    C_T, C_Q = load_ship(name).open_water(epsilon).T
    assert (C_T * np.sin(epsilon) - C_Q * np.cos(epsilon) * 2.0 / 0.7).max() <= 0.0
