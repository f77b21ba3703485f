"""Vectors from their direction."""

import math

import numpy as np
import pytest

from ship_gym.physics.angles import arctan2, north_east


def test_north_east():
    north, east = np.zeros(2), np.zeros(2)
    north_east(np.array([2.0, 1.0]), np.array([0.5 * math.pi, math.pi]), north, east)
    np.testing.assert_allclose(north, [0.0, -1.0], atol=1e-15)
    np.testing.assert_allclose(east, [2.0, 0.0], atol=1e-15)


@pytest.mark.parametrize(("y", "x"), [(math.nan, 1.0), (1.0, math.nan), (math.nan, math.nan)])
def test_the_angle_of_what_is_not_a_number_is_none(y, x):
    assert math.isnan(arctan2(y, x))
