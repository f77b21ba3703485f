"""Where a function of one number is zero.

``scipy.optimize`` has such functions too, but importing it takes as long as everything else of ours
up to the first step of a process.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

_MOST = 100  # calls in pairs; bisection alone needs 50 for all digits


def root(function: Callable[[float], float], low: float, high: float, within: float) -> float:
    """Zero of a continuous function between two places where its signs differ.

    By the method of Ridders (1979), which halves the range at least and doubles the digits near
    the zero.

    Parameters
    ----------
    function : callable
    low, high : float
    within : float
        Largest error of the place.

    Raises
    ------
    ValueError
        The function has one sign at both ends.
    """
    at_low, at_high = function(low), function(high)
    if at_low == 0.0 or at_high == 0.0:
        return low if at_low == 0.0 else high
    if (at_low < 0.0) == (at_high < 0.0):
        raise ValueError(f"no change of sign between {low} and {high}")
    before = math.inf
    for _ in range(_MOST):
        middle = 0.5 * (low + high)
        at_middle = function(middle)
        rise = math.copysign(1.0, at_low - at_high)
        shift = rise * (middle - low) * at_middle / math.sqrt(at_middle**2 - at_low * at_high)
        found = middle + shift
        value = function(found)
        if value == 0.0:
            return found
        if abs(found - before) <= within:  # near a kink steps may be short, but not the last
            other_side = found + within if (value < 0.0) == (at_low < 0.0) else found - within
            if (function(other_side) < 0.0) != (value < 0.0):
                return found
        before = found
        ends = ((low, at_low), (middle, at_middle), (found, value), (high, at_high))
        low, at_low, high, at_high = _narrowest(sorted(ends))
        if high - low <= within:
            break
    return 0.5 * (low + high)


def _narrowest(places: list[tuple[float, float]]) -> tuple[float, float, float, float]:
    """The first two neighbours of (place, value) whose signs differ."""
    for (low, at_low), (high, at_high) in itertools.pairwise(places):
        if (at_low < 0.0) != (at_high < 0.0):
            return low, at_low, high, at_high
    raise AssertionError("the ends have different signs")
