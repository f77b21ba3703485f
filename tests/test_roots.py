"""Zeros of functions of one number."""

import math

import pytest
from scipy.optimize import brentq

from ship_gym.roots import root


@pytest.mark.parametrize(
    ("function", "low", "high"),
    [
        (lambda x: x * x - 2.0, 0.0, 2.0),
        (lambda x: 2.0 - x * x, 0.0, 2.0),
        (lambda x: math.exp(x) - 1e3, -5.0, 30.0),
        (lambda x: math.atan(50.0 * (x - 0.3)), -10.0, 2.0),
        (lambda x: (x - 0.7) * (1.0 if x < 0.7 else 400.0), 0.0, 5.0),  # a kink in the zero
    ],
)
def test_as_scipy_finds_it(function, low, high):
    found = root(function, low, high, 1e-13)
    assert found == pytest.approx(brentq(function, low, high, xtol=1e-14), abs=1e-12)


def test_ends_and_calls():
    assert root(lambda x: x, 0.0, 3.0, 1e-9) == 0.0
    assert root(lambda x: x - 3.0, 0.0, 3.0, 1e-9) == 3.0
    calls = []
    root(lambda x: calls.append(x) or x**3 - x - 1.0, 1.0, 2.0, 1e-13)
    assert len(calls) < 20  # bisection needs 44


def test_one_sign_is_refused():
    with pytest.raises(ValueError, match="no change of sign"):
        root(lambda x: x * x, 1.0, 2.0, 1e-9)
