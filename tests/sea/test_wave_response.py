"""Lookup in a wave table by hand: between its points, at its ends and beyond them."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from ship_gym.conventions import G
from ship_gym.sea.wave_response import SPEED_STEP, _at

TABLE = SimpleNamespace(omega=np.array([1.0, 2.0, 4.0]), froude=np.array([0.0, 0.1, 0.3]))
# values (speeds, headings, frequencies): 100 x speed number + 10 x its own frequency
VALUES = np.array([[[100.0 * f + 10.0 * w for w in (1.0, 2.0, 4.0)]] for f in range(3)])
L = G  # so that a frequency is non-dimensional as it is


@pytest.mark.parametrize(
    ("omega", "expected"), [(0.2, 10.0), (1.0, 10.0), (1.5, 15.0), (3.0, 30.0), (9.0, 40.0)]
)
def test_frequencies_between_the_points_and_held_beyond_the_ends(omega, expected):
    assert _at(TABLE, VALUES, np.array([omega]), L)[0, 0, 0] == pytest.approx(expected)


def test_froude_numbers_of_equal_step():
    """Steps of 0.05: half-way in the first piece, quarters of the second."""
    found = _at(TABLE, VALUES, np.array([1.0]), L)[:, 0, 0]
    assert len(found) == 1 + round(0.3 / SPEED_STEP)
    expected = [10.0, 60.0, 110.0, 135.0, 160.0, 185.0, 210.0]
    np.testing.assert_allclose(found, expected, atol=1e-9)


def test_the_last_speed_lies_at_or_beyond_the_end_on_the_slope_of_the_last_piece():
    table = SimpleNamespace(omega=TABLE.omega, froude=np.array([0.0, 0.1, 0.22]))
    found = _at(table, VALUES, np.array([1.0]), L)[:, 0, 0]
    assert found[-1] == pytest.approx(110.0 + 100.0 * (0.25 - 0.1) / 0.12)


def test_frequencies_are_made_non_dimensional_by_the_length():
    assert _at(TABLE, VALUES, np.array([3.0]), 0.25 * G)[0, 0, 0] == pytest.approx(15.0)
    assert math.sqrt(0.25 * G / G) * 3.0 == 1.5
