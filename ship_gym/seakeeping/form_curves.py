"""Curves of form: breadth or sectional area along a ship, with a given area and centre.

Between a constant part amidships and the perpendicular the curve is a + (1 - a) (1 - u^p)^q, u from
0 to 1; a is its value at the end. The two exponents p follow from area and centre.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq
from scipy.special import beta

from ship_gym.config import ConfigError

_P_RANGE = (0.3, 40.0)  # from a spike to a box


@dataclasses.dataclass(frozen=True)
class CurveEnd:
    """One end of a curve of form: value + (1 - value) (1 - u^p)^q.

    Attributes
    ----------
    value : float
        At the perpendicular, by that amidships.
    q : float
        Exponent: 1 ends at an angle, more is hollow, 0.5 is round.
    """

    value: float
    q: float

    def __call__(self, u: np.ndarray, p: float) -> np.ndarray:
        """Value at u from 0 (end of the parallel part) to 1 (perpendicular)."""
        return self.value + (1.0 - self.value) * (1.0 - u**p) ** self.q


@dataclasses.dataclass(frozen=True)
class Curve:
    """Breadth or sectional area along the ship, by its value amidships, x by L.

    Attributes
    ----------
    aft, fore : CurveEnd
        The two ends.
    p_aft, p_fore : float
        Their exponents p.
    parallel : float
        Half length of the constant part.
    """

    aft: CurveEnd
    fore: CurveEnd
    p_aft: float
    p_fore: float
    parallel: float

    def __call__(self, x: np.ndarray) -> np.ndarray:
        """Value at x / L, shape of x; 0 beyond the fore end."""
        u = np.clip((np.abs(x) - self.parallel) / (0.5 - self.parallel), 0.0, 1.0)
        return np.where(x > 0.0, self.fore(u, self.p_fore), self.aft(u, self.p_aft))

    def moments(self) -> tuple[float, float]:
        """Area under the curve and its first moment about midship."""
        h, length = self.parallel, 0.5 - self.parallel
        sums = []
        for side, p in ((self.aft, self.p_aft), (self.fore, self.p_fore)):
            area = beta(1.0 / p, side.q + 1.0) / p  # integral of (1 - u^p)^q
            first = beta(2.0 / p, side.q + 1.0) / p  # of u (1 - u^p)^q
            area = side.value + (1.0 - side.value) * area
            first = 0.5 * side.value + (1.0 - side.value) * first
            sums.append((h + length * area, 0.5 * h**2 + length * (h * area + length * first)))
        return sums[0][0] + sums[1][0], sums[1][1] - sums[0][1]


def fitted_curve(
    area: float,
    centre: float,
    aft: CurveEnd,
    fore: CurveEnd,
    parallel: float,
    names: tuple[str, str],
) -> Curve:
    """Curve with a given area and centre.

    Parameters
    ----------
    area, centre : float
        Area under the curve and its centre, both by L; `names` are theirs, for messages.
    aft, fore, parallel
        As in `Curve`.

    Raises
    ------
    ConfigError
        No such curve: says which of the two is out of its range, and the range.
    """
    family = _Family(area, aft, fore, parallel)
    _check_range(names[0], area, *family.areas())
    _check_range(names[1], centre, *family.centres())
    p_fore = brentq(lambda p: family.centre(p) - centre, *family.bows(), xtol=1e-12)
    return family.member(p_fore)


def centre_range(
    area: float, aft: CurveEnd, fore: CurveEnd, parallel: float
) -> tuple[float, float] | None:
    """Smallest and largest centre of a curve with a given area, as in `fitted_curve`.

    None if there is no curve with this area.
    """
    family = _Family(area, aft, fore, parallel)
    low, high = family.areas()
    return family.centres() if low < area < high else None


@dataclasses.dataclass(frozen=True)
class _Family:
    """All curves with one area; the exponent of the bow tells them apart."""

    area: float
    aft: CurveEnd
    fore: CurveEnd
    parallel: float

    def _curve(self, p_aft: float, p_fore: float) -> Curve:
        return Curve(self.aft, self.fore, p_aft, p_fore, self.parallel)

    def areas(self) -> tuple[float, float]:
        """Smallest and largest area with these ends."""
        low, high = (self._curve(p, p).moments()[0] for p in _P_RANGE)
        return low, high

    def member(self, p_fore: float) -> Curve:
        """The curve with this bow."""
        return self._curve(_root(lambda p: self._curve(p, p_fore).moments()[0] - self.area), p_fore)

    def centre(self, p_fore: float) -> float:
        """Its centre."""
        total, first = self.member(p_fore).moments()
        return first / total

    def bows(self) -> tuple[float, float]:
        """Least and fullest bow for which the stern is still possible."""
        low, high = _P_RANGE
        least = _root(lambda p: self._curve(high, p).moments()[0] - self.area)
        return least, _root(lambda p: self._curve(low, p).moments()[0] - self.area)

    def centres(self) -> tuple[float, float]:
        """Centres with the two."""
        least, most = self.bows()
        return self.centre(least), self.centre(most)


def _root(function: Callable[[float], float]) -> float:
    """Zero of an increasing function of the exponent, or the end of its range next to it."""
    low, high = _P_RANGE
    if function(low) >= 0.0:
        return low
    if function(high) <= 0.0:
        return high
    return brentq(function, low, high, xtol=1e-13)


def _check_range(name: str, value: float, low: float, high: float) -> None:
    if not low < value < high:
        raise ConfigError(
            f"no hull of this form: {name} = {value:.4f}: allowed is {low:.4f} to {high:.4f} with "
            "the other numbers of the section [form]"
        )
