"""The polynomials for atan2, cosine and sine, exp against the library's: in sweeps and at edges."""

import math

import numpy as np
import pytest

from ship_gym.physics._kernel import loop
from ship_gym.physics.angles import (
    arctan2,
    cos_sin,
    cos_sin_of_turns,
    cosine,
    exp_negative,
    sine,
    wrapped,
)

INF, NAN = math.inf, math.nan


@loop
def _sweep(a, b, found):
    for i in range(len(a)):
        found[i, 0] = arctan2(a[i], b[i])
        found[i, 1], found[i, 2] = cos_sin_of_turns(a[i])
        found[i, 3], found[i, 4] = cos_sin(a[i])
        found[i, 5] = exp_negative(-abs(a[i]))


ATAN2, COS_TURNS, SIN_TURNS, COS, SIN, EXP = range(6)


def swept(a, b=None):
    """All functions of numbers, shape (n, 6)."""
    a = np.asarray(a, dtype=float)
    b = np.ones(len(a)) if b is None else np.asarray(b, dtype=float)
    found = np.zeros((len(a), 6))
    _sweep(a, b, found)
    return found


COUNT = 100_000


@pytest.mark.compiled
@pytest.mark.parametrize("size", [1e-300, 1e-9, 1.0, 1e9, 1e150])
def test_arctan2_all_round(size):
    angle = np.linspace(-np.pi, np.pi, COUNT)
    y, x = size * np.sin(angle), size * np.cos(angle)
    found = swept(y, x)[:, ATAN2]
    assert np.abs(found - np.arctan2(y, x)).max() < 1e-12
    assert np.abs(found).max() <= np.pi


@pytest.mark.compiled
def test_arctan2_of_ratios_of_any_size():
    """Small angles keep their relative error."""
    ratio = np.logspace(-300, 0, COUNT)
    found = swept(ratio, np.ones(COUNT))[:, ATAN2]
    np.testing.assert_allclose(found, np.arctan(ratio), rtol=1e-11)


def test_arctan2_on_axes_and_diagonals():
    """Exact on the axes, the nearest number on the diagonals; no signed zeros."""
    quarter = 0.5 * math.pi
    assert arctan2(0.0, 0.0) == 0.0 and arctan2(0.0, 2.0) == 0.0 and arctan2(-0.0, 2.0) == 0.0
    assert arctan2(3.0, 0.0) == quarter and arctan2(-3.0, 0.0) == -quarter
    assert arctan2(0.0, -2.0) == math.pi and arctan2(-0.0, -2.0) == math.pi
    for y, x in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        assert arctan2(5.0 * y, 5.0 * x) == pytest.approx(math.atan2(y, x), abs=1e-15)
    edge = math.tan(math.pi / 8)  # where the ratio is folded
    for t in (edge, np.nextafter(edge, 0), np.nextafter(edge, 1)):
        assert arctan2(t, 1.0) == pytest.approx(math.atan(t), abs=1e-12)
        assert arctan2(1.0, t) == pytest.approx(math.atan2(1.0, t), abs=1e-12)


def test_arctan2_is_odd_in_y_and_mirrors_in_x():
    rng = np.random.default_rng(0)
    for y, x in rng.uniform(0.01, 1.0, (200, 2)):
        angle = arctan2(y, x)
        assert arctan2(-y, x) == -angle and arctan2(y, -x) == math.pi - angle


@pytest.mark.parametrize(("y", "x"), [(NAN, 1.0), (1.0, NAN), (NAN, NAN), (NAN, -1.0)])
def test_arctan2_of_no_number_is_none(y, x):
    assert math.isnan(arctan2(y, x))


@pytest.mark.compiled
@pytest.mark.parametrize("bound", [0.5, 3.0, 300.0])
def test_cosine_and_sine_of_turns(bound):
    turns = np.linspace(-bound, bound, COUNT + 1)
    found = swept(turns)
    # the turn that is left, taken exactly: 2 pi times many turns would be rounded
    angle = 2.0 * np.pi * (turns - np.rint(turns))
    assert np.abs(found[:, COS_TURNS] - np.cos(angle)).max() < 1e-12
    assert np.abs(found[:, SIN_TURNS] - np.sin(angle)).max() < 1e-12


@pytest.mark.parametrize(("quarters", "cos", "sin"), [(0, 1, 0), (1, 0, 1), (2, -1, 0), (3, 0, -1)])
@pytest.mark.parametrize("turns", [0.0, -1.0, 5.0, 1e6])
def test_half_turns_are_exact_and_quarter_turns_nearly(quarters, cos, sin, turns):
    c, s = cos_sin_of_turns(turns + 0.25 * quarters)
    assert abs(c - cos) < 1e-12 and abs(s - sin) < 1e-12
    assert quarters % 2 or (c, s) == (cos, sin)


@pytest.mark.compiled
def test_cosine_and_sine_of_angles_within_hundreds_of_turns():
    angle = np.linspace(-600.0 * np.pi, 600.0 * np.pi, COUNT)
    found = swept(angle)
    assert np.abs(found[:, COS] - np.cos(angle)).max() < 2e-12
    assert np.abs(found[:, SIN] - np.sin(angle)).max() < 2e-12
    assert cosine(1.0) == cos_sin(1.0)[0] and sine(1.0) == cos_sin(1.0)[1]


def test_a_small_angle_is_its_own_sine():
    for angle in (1e-3, 1e-8, 1e-300, 0.0):
        assert sine(angle) == pytest.approx(angle - angle**3 / 6.0, rel=1e-11)
        assert sine(-angle) == -sine(angle) and cosine(-angle) == cosine(angle)


@pytest.mark.parametrize("value", [NAN, INF, -INF])
def test_cosine_of_no_number_is_none(value):
    assert all(math.isnan(x) for x in (*cos_sin_of_turns(value), *cos_sin(value)))


@pytest.mark.compiled
def test_exponential_of_negative_numbers():
    x = np.linspace(0.0, 30.0, COUNT)
    found = swept(x)[:, EXP]
    assert np.abs(found - np.exp(-x)).max() < 1e-13
    np.testing.assert_allclose(found, np.exp(-x), rtol=1e-9)


def test_exponential_at_its_ends():
    assert exp_negative(0.0) == 1.0 and exp_negative(-1e-18) == 1.0
    least = exp_negative(-30.0)
    assert least == pytest.approx(9.3576e-14, rel=1e-4)
    assert exp_negative(-1e300) == least and exp_negative(-INF) == least


@pytest.mark.parametrize("angle", [-7.0, -math.pi, 0.0, 3.0, math.pi, 100.0])
def test_angles_are_wrapped_below_pi(angle):
    found = wrapped(angle)
    assert -math.pi <= found < math.pi
    assert math.remainder(found - angle, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.compiled
def test_numbers_side_by_side_have_the_bits_of_one_alone():
    rng = np.random.default_rng(1)
    a, b = rng.uniform(-10.0, 10.0, (2, 67))
    together = swept(a, b)
    alone = np.concatenate([swept(a[i : i + 1], b[i : i + 1]) for i in range(67)])
    assert (together == alone).all()
