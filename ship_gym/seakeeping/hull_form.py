"""A hull from a ship's particulars: superellipse sections between two curves of form.

At x / L the section is |y / b|^n + |z / T|^n = 1 with half breadth b, draught T and an n that gives
it its area A. Amidships b and A are constant; forward of the parallel body

    b = B/2 (1 - u^p)^q,  A = C_m B d (1 - u^p')^1.4,  u from 0 to 1 at the perpendicular,

aft the same above the breadth and the area of the transom. The two p come from the waterplane's
area and centre, the two p' from volume and centre of buoyancy. There is no bulb and no overhang.
The form is this project's own; it is meant for wave loads, not for resistance.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq
from scipy.special import beta, gammaln

from ship_gym.config import ConfigError
from ship_gym.seakeeping.hull_mesh import HullMesh, divided, mesh_from_sections
from ship_gym.ships.particulars import Ship

STATIONS, GIRTH = 44, 8  # panels along and around the half hull
_Q_BREADTH, _Q_AREA = 1.0, 1.4  # 1.0: a finite angle of entrance
_P_RANGE = (0.3, 40.0)  # from a spike to a box
_TRANSOM_FULLNESS = 2.0 / 3.0  # area coefficient of the transom: gives its draught
_C_MAX = 0.9995  # beyond it a section is a rectangle
_N = np.geomspace(0.12, 400.0, 2000)


def section_coefficient(n):
    """Area coefficient c(n) = Gamma(1 + 1/n)^2 / Gamma(1 + 2/n) of |y/b|^n + |z/T|^n = 1.

    2/3 would be a parabola; n = 2 is the ellipse, pi/4; n = 1 the triangle, 1/2; below it the
    section is hollow.
    """
    n = np.asarray(n, dtype=float)
    return np.exp(2.0 * gammaln(1.0 + 1.0 / n) - gammaln(1.0 + 2.0 / n))


def section_exponent(c):
    """Inverse of `section_coefficient`, by interpolation; c from 1e-5 to 0.9995 [-]."""
    return np.exp(np.interp(c, section_coefficient(_N), np.log(_N)))


@dataclasses.dataclass(frozen=True)
class Curve:
    """Breadth or sectional area along the ship, by its value amidships, x by L.

    Attributes
    ----------
    p_aft, p_fore, q : float
        Exponents of the two ends.
    end : float
        Value at the transom.
    parallel : float
        Half length of the constant part.
    """

    p_aft: float
    p_fore: float
    q: float
    end: float
    parallel: float

    def __call__(self, x: np.ndarray) -> np.ndarray:
        """Value at x / L, shape of x."""
        u = np.clip((np.abs(x) - self.parallel) / (0.5 - self.parallel), 0.0, 1.0)
        fore = (1.0 - u**self.p_fore) ** self.q
        aft = self.end + (1.0 - self.end) * (1.0 - u**self.p_aft) ** self.q
        return np.where(x > 0.0, fore, aft)

    def moments(self) -> tuple[float, float]:
        """Area under the curve and its first moment about midship."""
        h, length = self.parallel, 0.5 - self.parallel
        sums = []
        for p, end in ((self.p_aft, self.end), (self.p_fore, 0.0)):
            area = beta(1.0 / p, self.q + 1.0) / p  # integral of (1 - u^p)^q
            first = beta(2.0 / p, self.q + 1.0) / p  # of u (1 - u^p)^q
            area, first = end + (1.0 - end) * area, 0.5 * end + (1.0 - end) * first
            sums.append((h + length * area, 0.5 * h**2 + length * (h * area + length * first)))
        return sums[0][0] + sums[1][0], sums[1][1] - sums[0][1]


def fitted_curve(
    area: float, centre: float, q: float, end: float, parallel: float, names: tuple[str, str]
) -> Curve:
    """Curve with a given area and centre.

    Parameters
    ----------
    area, centre : float
        Area under the curve and its centre, both by L; `names` are theirs, for messages.
    q, end, parallel : float
        As in `Curve`.

    Raises
    ------
    ConfigError
        No such curve: says which of the two is out of its range, and the range.
    """
    low, high = _P_RANGE

    def curve(p_aft: float, p_fore: float) -> Curve:
        return Curve(p_aft, p_fore, q, end, parallel)

    smallest, largest = curve(low, low).moments()[0], curve(high, high).moments()[0]
    _check_range(names[0], area, smallest, largest)

    def aft_for(p_fore: float) -> float:
        return _root(lambda p: curve(p, p_fore).moments()[0] - area)

    def centre_for(p_fore: float) -> float:
        total, first = curve(aft_for(p_fore), p_fore).moments()
        return first / total

    # the fullness of the bow for which the stern is still possible
    least = _root(lambda p: curve(high, p).moments()[0] - area)
    most = _root(lambda p: curve(low, p).moments()[0] - area)
    _check_range(names[1], centre, centre_for(least), centre_for(most))
    p_fore = brentq(lambda p: centre_for(p) - centre, least, most, xtol=1e-12)
    return curve(aft_for(p_fore), p_fore)


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


def transom_draught(a_transom: float, b_transom: float, C_m: float) -> float:
    """Draught of the transom by d, such that its area coefficient is 2/3; 1 without a transom."""
    return C_m * a_transom / (b_transom * _TRANSOM_FULLNESS) if b_transom > 0.0 else 1.0


@dataclasses.dataclass(frozen=True)
class HullLines:
    """Half breadth, draught and exponent of every section, x forward of midship [m]."""

    x: np.ndarray
    half_breadth: np.ndarray
    draught: np.ndarray
    exponent: np.ndarray


def hull_lines(ship: Ship, stations: int = STATIONS) -> HullLines:
    """Sections of a ship from the section ``form`` of its file.

    Parameters
    ----------
    ship : Ship
        With a form.
    stations : int
        Panels along the length; the sections are closer at both ends.

    Returns
    -------
    HullLines
        Arrays of shape (stations + 1,), from aft forward.

    Raises
    ------
    ConfigError
        The ship has no form, or none exists with its coefficients: says which and the range.
    """
    form, hull = ship.form, ship.hull
    if form is None:
        raise ConfigError(f"{ship.name}: no section [form], which a hull form is drawn from")
    L, parallel = hull.L, form.parallel / hull.L
    C_p = hull.volume / (form.C_m * L * hull.B * hull.d)
    breadth = fitted_curve(
        form.C_wp, form.x_F / L, _Q_BREADTH, form.b_transom, parallel, ("C_wp", "x_F / L")
    )
    area = fitted_curve(
        C_p, form.x_B / L, _Q_AREA, form.a_transom, parallel, ("C_b / C_m", "x_B / L")
    )
    share = np.linspace(0.0, 1.0, stations + 1)
    x = 0.5 * (0.5 * (2.0 * share - 1.0) - 0.5 * np.cos(np.pi * share))
    rise = np.clip((form.x_keel / L - x) / (form.x_keel / L + 0.5), 0.0, 1.0)
    end = transom_draught(form.a_transom, form.b_transom, form.C_m)
    draught = 1.0 - (1.0 - end) * rise
    b = breadth(x)
    with np.errstate(invalid="ignore", divide="ignore"):
        c = np.where(b > 1e-9, form.C_m * area(x) / (b * draught), 0.0)
    worst = int(np.argmax(c))
    if c[worst] > _C_MAX:
        raise ConfigError(
            f"{ship.name}: no hull of this form: at x / L = {x[worst]:.3f} the sectional area is "
            f"{c[worst]:.3f} of breadth times draught: allowed is {_C_MAX}; raise C_wp or "
            "b_transom, move x_F towards there, or let the keel rise nearer to the stern (x_keel)"
        )
    exponent = section_exponent(np.maximum(c, 1e-5))
    return HullLines(x * L, 0.5 * hull.B * b, hull.d * draught, exponent)


def section_points(b: float, T: float, n: float, count: int) -> np.ndarray:
    """Points of a superellipse from the keel to the waterline, shape (count + 1, 2): y, z [m]."""
    angle = 0.5 * np.pi * (0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 400)))
    c, s = np.cos(angle), np.sin(angle)
    c[-1] = s[0] = 0.0
    r = (c**n + s**n) ** (-1.0 / n)
    return divided(np.stack([b * r * s, T * r * c], axis=-1), count)  # angle 0 is the keel


def parametric_mesh(ship: Ship, stations: int = STATIONS, girth: int = GIRTH) -> HullMesh:
    """Panels of the hull that `hull_lines` draws.

    Parameters
    ----------
    ship : Ship
        With a section ``form``.
    stations, girth : int
        Panels along the length and from keel to waterline, of one half.

    Returns
    -------
    HullMesh
        Starboard half, symmetric, with transom.

    Raises
    ------
    ConfigError
        As `hull_lines`.
    """
    lines = hull_lines(ship, stations)
    sections = np.zeros((stations + 1, girth + 1, 3))
    for i, (x, b, T, n) in enumerate(
        zip(lines.x, lines.half_breadth, lines.draught, lines.exponent, strict=True)
    ):
        sections[i, :, 0] = x
        sections[i, :, 1:] = section_points(b, T, n, girth)
    text = f"parametric hull of {ship.name}: {stations} x {girth} panels per side"
    return mesh_from_sections(sections, (text,))
