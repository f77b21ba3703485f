"""A hull from a ship's particulars: superellipse sections between two curves of form, and a bulb.

At x / L the section is |y / b|^n + |z / T|^n = 1 with half breadth b, draught T and an n that gives
it its area A. Amidships b and A are constant; forward of the parallel body

    b = B/2 (1 - u^p)^q,  A = C_m B d (a + (1 - a) (1 - u^p')^q'),  u from 0 to 1 at the
                                                                      perpendicular,

a the area of the bulb, aft the same above the breadth and the area of the transom. The two p come
from the waterplane's area and centre, the two p' from volume and centre of buoyancy, the q from the
ship file. The half breadth of the bulb (`bulb`) is added to that of the section, whose area is the
rest. There is no overhang of the waterline. The form is this project's own; it is meant for wave
loads, not for resistance.
"""

from __future__ import annotations

import dataclasses

import numpy as np
from scipy.special import gammaln

from ship_gym.config import ConfigError
from ship_gym.seakeeping.bulb import Bulb, ship_bulb
from ship_gym.seakeeping.form_curves import Curve, CurveEnd, centre_range, fitted_curve
from ship_gym.seakeeping.hull_mesh import HullMesh, divided, mesh_from_sections
from ship_gym.ships.files import Named
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import HullForm, Ship

DRAWN = "parametric hull"  # begins the report of a drawn one
STATIONS, GIRTH = 44, 8  # panels along and around the half hull
_NOSE = (0.0, 0.35, 0.65, 0.88, 1.0)  # stations of the bulb ahead of the perpendicular, by it
_TRANSOM_FULLNESS = 2.0 / 3.0  # area coefficient of the transom: gives its draught
_KNIFE = 1e-3  # of the bulb's breadth; thinner parts of the forefoot are left away
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


def transom_draught(a_transom: float, b_transom: float, C_m: float) -> float:
    """Draught of the transom by d, such that its area coefficient is 2/3; 1 without a transom."""
    return C_m * a_transom / (b_transom * _TRANSOM_FULLNESS) if b_transom > 0.0 else 1.0


def area_curve(ship: Ship, bulb: Bulb | None) -> Curve:
    """Sectional area between the perpendiculars by C_m B d; the bulb ahead of them is deducted.

    Raises
    ------
    ConfigError
        None exists with the ship's volume and centre of buoyancy: says the range.
    """
    form, hull = _form(ship), ship.hull
    volume, moment, at_fore = hull.volume, hull.volume * form.x_B, 0.0
    if bulb is not None:
        volume -= bulb.volume
        moment -= bulb.volume * bulb.centre
        at_fore = form.a_bulb
    C_p = volume / (form.C_m * hull.L * hull.B * hull.d)
    ends = CurveEnd(form.a_transom, form.q_area_aft), CurveEnd(at_fore, form.q_area_fore)
    names = "C_b / C_m", "x_B / L"
    return fitted_curve(C_p, moment / volume / hull.L, *ends, form.parallel / hull.L, names)


def breadth_curve(ship: Ship) -> Curve:
    """Breadth of the waterline by B.

    Raises
    ------
    ConfigError
        None exists with the ship's C_wp and x_F: says the range.
    """
    form, L = _form(ship), ship.hull.L
    names = "C_wp", "x_F / L"
    return fitted_curve(form.C_wp, form.x_F / L, *_wl_ends(form), form.parallel / L, names)


def centres_of_waterplane(ship: Ship) -> tuple[float, float] | None:
    """Smallest and largest x_F [m] of waterlines with the ship's C_wp; None: there are none."""
    form, L = _form(ship), ship.hull.L
    found = centre_range(form.C_wp, *_wl_ends(form), form.parallel / L)
    return None if found is None else (found[0] * L, found[1] * L)


def _wl_ends(form: HullForm) -> tuple[CurveEnd, CurveEnd]:
    return CurveEnd(form.b_transom, form.q_wl_aft), CurveEnd(0.0, form.q_wl_fore)


@dataclasses.dataclass(frozen=True)
class HullLines:
    """Sections between the perpendiculars without their bulb, x forward of midship [m].

    Attributes
    ----------
    x, half_breadth, draught, exponent : numpy.ndarray
        From aft forward, all of one shape.
    bulb : Bulb or None
    """

    x: np.ndarray
    half_breadth: np.ndarray
    draught: np.ndarray
    exponent: np.ndarray
    bulb: Bulb | None

    def section(self, i: int, count: int) -> np.ndarray:
        """Points of section i with the bulb, from the keel to the waterline, shape (N, 2)."""
        x, b, T = (float(a[i]) for a in (self.x, self.half_breadth, self.draught))
        points = section_outline(b, T, float(self.exponent[i]))
        if self.bulb is None or self.bulb.size(x) == 0.0:
            return divided(points, count)
        y, z = points[::-1].T
        deep = self.bulb.middle(x) + (T - self.bulb.middle(x)) * np.linspace(-1.0, 1.0, 200)
        z_all = np.union1d(z, deep[(deep >= 0.0) & (deep <= T)])[::-1]
        both = np.interp(z_all, z, y) + self.bulb.half_breadths(x, z_all)
        lowest = int(np.argmax(both > _KNIFE * self.bulb.half_breadth))
        both[lowest] = 0.0
        return divided(np.stack([both, z_all], axis=-1)[lowest:], count)


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
        raise ConfigError(
            f"{ship.name}: no section [form], which a hull is drawn from; name a hull file (--mesh)"
        )
    bulb = ship_bulb(ship)
    breadth, area = breadth_curve(ship), area_curve(ship, bulb)
    share = np.linspace(0.0, 1.0, stations + 1)
    x = hull.L * 0.5 * (0.5 * (2.0 * share - 1.0) - 0.5 * np.cos(np.pi * share))
    draught, b = hull.d * _keel(ship, x, bulb), breadth(x / hull.L)
    rest = form.C_m * area(x / hull.L)  # by B d
    if bulb is not None:
        rest -= bulb.area / (hull.B * hull.d) * bulb.size(x)
    with np.errstate(invalid="ignore", divide="ignore"):
        c = np.where(b > 1e-9, rest * hull.d / (b * draught), 0.0)
    _check_areas(ship, x, c)
    return HullLines(x, 0.5 * hull.B * b, draught, section_exponent(np.maximum(c, 1e-5)), bulb)


def _form(ship: Ship) -> HullForm:
    """Form of a ship that has one: `hull_sections` has seen to that."""
    assert ship.form is not None
    return ship.form


def _keel(ship: Ship, x: np.ndarray, bulb: Bulb | None) -> np.ndarray:
    """Draught by d: it falls to that of the transom aft, and to the bottom of the bulb forward."""
    form, hull = _form(ship), ship.hull
    end = transom_draught(form.a_transom, form.b_transom, form.C_m)
    rise = np.clip((form.x_keel - x) / (form.x_keel + 0.5 * hull.L), 0.0, 1.0)
    draught = 1.0 - (1.0 - end) * rise
    if bulb is not None:
        forefoot = np.clip(1.0 + (x - bulb.x) / bulb.length, 0.0, 1.0)
        draught -= (1.0 - bulb.bottom(bulb.x) / hull.d) * forefoot**2
    return draught


def _check_areas(ship: Ship, x: np.ndarray, c: np.ndarray) -> None:
    """Refuse sections that are fuller than a rectangle."""
    worst = int(np.argmax(c))
    if c[worst] > _C_MAX:
        raise ConfigError(
            f"{ship.name}: no hull of this form: at x / L = {x[worst] / ship.hull.L:.3f} the "
            f"sectional area is {c[worst]:.3f} of breadth times draught: allowed is {_C_MAX}; "
            "raise C_wp or b_transom, move x_F towards there, or let the keel rise nearer to the "
            "stern (x_keel)"
        )


def section_outline(b: float, T: float, n: float) -> np.ndarray:
    """Points of a superellipse from the keel to the waterline, closely, shape (400, 2): y, z."""
    angle = 0.5 * np.pi * (0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 400)))
    c, s = np.cos(angle), np.sin(angle)
    c[-1] = s[0] = 0.0
    r = (c**n + s**n) ** (-1.0 / n)
    return np.stack([b * r * s, T * r * c], axis=-1)  # angle 0 is the keel


def parametric_mesh(ship: Named | Ship, stations: int = STATIONS, girth: int = GIRTH) -> HullMesh:
    """Panels of the hull that `hull_lines` draws.

    Parameters
    ----------
    ship : Ship, or its name or file
        With a section ``form``.
    stations, girth : int
        Panels along the length and from keel to waterline, of one half; the last four along the
        length are ahead of the perpendicular if there is a bulb.

    Returns
    -------
    HullMesh
        Starboard half, symmetric, with transom.

    Raises
    ------
    ConfigError
        As `hull_lines`.
    """
    ship = load_ship(ship)
    lines = hull_lines(ship, stations - (len(_NOSE) - 1 if ship_bulb(ship) else 0))
    x, points = lines.x, [lines.section(i, girth) for i in range(len(lines.x))]
    if lines.bulb is not None:
        nose = lines.bulb.x + lines.bulb.length * np.array(_NOSE)
        points[-1:] = [_nose_section(lines.bulb, at, girth) for at in nose]
        x = np.concatenate([x[:-1], nose])
    sections = np.zeros((len(x), girth + 1, 3))
    sections[..., 0], sections[..., 1:] = x[:, None], np.array(points)
    text = f"{DRAWN} of {ship.name}: {len(x) - 1} x {girth} panels per side"
    return mesh_from_sections(sections, (text,))


def _nose_section(bulb: Bulb, x: float, girth: int) -> np.ndarray:
    """Points of a section at or ahead of the perpendicular, shape (girth + 1, 2): y, z [m].

    The last piece is the stem between bulb and waterline, and nothing ahead of it: so no other
    panel of the bulb lies in the centre plane.
    """
    points = divided(bulb.outline(x), girth - 1)
    end = np.zeros(2) if x <= bulb.x else points[-1]
    return np.concatenate([points, end[None]])
