import math

import numpy as np
import pytest

from ship_gym.csv_file import read_csv
from ship_gym.ships import load_ship
from ship_gym.ships.b_series import b_series
from ship_gym.ships.files import DATA
from ship_gym.ships.open_water import continued, starred


def coefficients(ship, J):
    """K_T, K_Q that the open-water table gives at J."""
    C = ship.open_water(np.arctan(np.asarray(J) / (0.7 * math.pi)))
    return C * (math.pi / 8.0 * (np.asarray(J) ** 2 + (0.7 * math.pi) ** 2))[..., None]


def test_b_series_check_value():
    # printed check value of the reference: Z 5, P/D 0.997, AE/A0 0.8
    K_T, K_Q = b_series(np.array([0.0, 0.6]), 0.997, 0.8, 5)
    np.testing.assert_allclose(K_T, [0.4749, 0.2379], atol=5e-5)
    assert 10 * K_Q[1] == pytest.approx(0.3918, abs=5e-5)


def test_kp505_table_follows_the_measured_points():
    points = read_csv(DATA / "kcs_model" / "kp505_open_water.csv")
    K = coefficients(load_ship("kcs_model"), points.columns["J"])
    # the cubic misses the points by 0.007 at J = 0 (K_T) and 0.011 at J = 1.05 (10 K_Q)
    assert np.abs(K[:, 0] - points.columns["K_T"]).max() < 0.007
    assert np.abs(10 * K[:, 1] - points.columns["10K_Q"]).max() < 0.012


def test_kp505_thrust_is_the_cubic_of_the_reference():
    J = np.linspace(0.0, 1.0, 11)
    K_T = coefficients(load_ship("kcs_model"), J)[:, 0]
    printed = 0.5396 - 0.4901 * J + 0.0120 * J**2 - 0.0321 * J**3
    np.testing.assert_allclose(K_T, printed, atol=3e-4)


def test_kvlcc2_thrust_is_the_printed_polynomial():
    J = np.linspace(0.0, 0.8, 9)
    K = coefficients(load_ship("kvlcc2_model"), J)
    np.testing.assert_allclose(K[:, 0], 0.2931 - 0.2753 * J - 0.1385 * J**2, atol=2e-4)


def test_stopped_propeller_and_stopped_ship_are_ordinary_points(ship):
    values = ship.open_water.values
    assert np.isfinite(values).all()
    assert ship.open_water(0.0)[0] > 0.0 > ship.open_water(math.pi / 2)[0]


def test_tangents_continue_the_polynomial():
    p = np.array([1.0, 0.0, 0.0])
    assert continued(p, 3.0, 0.0, 1.0) == 1.0 + 2.0 * 2.0
    assert continued(p, 0.5, 0.0, 1.0) == 0.25
    assert starred(math.pi / 8, 0.0) == pytest.approx(1.0 / (0.7 * math.pi) ** 2)
