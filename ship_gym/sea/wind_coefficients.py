"""Wind force and moment coefficients of ships: Blendermann (1994) and Isherwood (1972).

    X = 1/2 rho_air V^2 A_F CX,  Y = 1/2 rho_air V^2 A_L CY,  N = 1/2 rho_air V^2 A_L L_oa CN

in body axes (x forward, y starboard, N > 0 bow to starboard, about midship), V the wind relative to
the ship. gamma_w = atan2(v - v_wind, u - u_wind) with both velocities in body axes says where the
relative wind comes from, clockwise from the bow: 0 head wind, +90 deg from starboard, 180 deg from
astern. So CX(0) < 0, CX(180) > 0, and a wind from starboard gives CY < 0.

The sources have gamma_w from 0 to 180 deg and a side force positive away from the wind; here that
is mirrored to the side the wind comes from. A wind on the bow quarter attacks forward of midship:
it turns the ship beam-on.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from pathlib import Path

import numpy as np

from ship_gym.config import ConfigError, check_known, check_number
from ship_gym.conventions import wrap_angle
from ship_gym.csv_file import read_csv
from ship_gym.ships.particulars import WindAreas
from ship_gym.tables import Axis, Table, tabulate

METHODS = ("blendermann", "isherwood")
_DATA = Path(__file__).with_name("wind_data")
_STEP = math.radians(2.0)
_COEFFICIENTS = ("CX", "CY", "CN")


@functools.lru_cache(maxsize=1)
def ship_types() -> dict[str, dict[str, float]]:
    """Blendermann's parameters CDt, CDl_AF_bow, CDl_AF_stern, delta, kappa by type of ship."""
    table = read_csv(_DATA / "blendermann.csv")
    return {
        name: {key: float(table.columns[key][i]) for key in table.units}
        for i, name in enumerate(table.columns["type"])
    }


def blendermann(gamma_w, areas: WindAreas, ship_type: str) -> np.ndarray:
    """Wind coefficients by Blendermann (1994).

    Parameters
    ----------
    gamma_w : array_like
        Direction the relative wind comes from, clockwise from the bow [rad].
    areas : WindAreas
    ship_type : str
        One of `ship_types`.

    Returns
    -------
    numpy.ndarray
        CX, CY, CN, shape (*shape of gamma_w, 3). |CY| at 90 deg is CDt; for slender ships it is a
        few per cent larger at 60 to 80 deg, as the formula has it.
    """
    types = ship_types()
    p = types[check_known("ship type for the wind", ship_type, types)]
    gamma, side = _mirrored(gamma_w)
    CDl_AF = np.where(gamma <= 0.5 * math.pi, p["CDl_AF_bow"], p["CDl_AF_stern"])
    ratio = CDl_AF * areas.A_F / areas.A_L / p["CDt"]
    damping = 1.0 - 0.5 * p["delta"] * (1.0 - ratio) * np.sin(2.0 * gamma) ** 2
    CX = -CDl_AF * np.cos(gamma) / damping
    CY = side * p["CDt"] * np.sin(gamma) / damping
    CN = (areas.s_L / areas.L_oa - 0.18 * (gamma - 0.5 * math.pi)) * CY
    return np.stack([CX, CY, CN], axis=-1)


def isherwood(gamma_w, areas: WindAreas, beam: float) -> np.ndarray:
    """Wind coefficients by Isherwood (1972), regression of merchant ships, every 10 deg and linear.

    Parameters
    ----------
    gamma_w : array_like
        Direction the relative wind comes from, clockwise from the bow [rad].
    areas : WindAreas
        With `A_SS` and `perimeter`.
    beam : float
        B [m].

    Returns
    -------
    numpy.ndarray
        CX, CY, CN, shape (*shape of gamma_w, 3).

    Raises
    ------
    ConfigError
        The ship has no `A_SS` or `perimeter`.
    """
    for name in ("A_SS", "perimeter"):
        if not getattr(areas, name) > 0.0:
            raise ConfigError(f"wind.{name} = 0: Isherwood's coefficients need it; must be > 0")
    check_number("beam", beam, 1e-2, 200.0, "m")
    gamma, side = _mirrored(gamma_w)
    shape = _isherwood_shape(areas, beam)
    rows = {name: _isherwood_rows(name) for name in _COEFFICIENTS}
    CX, CY, CN = (
        np.interp(gamma, angle, b @ np.append(shape, _last(name, areas))[: b.shape[1]])
        for name, (angle, b) in rows.items()
    )
    return np.stack([-CX, side * CY, side * CN], axis=-1)


def _isherwood_shape(areas: WindAreas, beam: float) -> np.ndarray:
    """1, 2 A_L/L^2, 2 A_F/B^2, L/B, S/L, C/L: what all three regressions take."""
    L = areas.L_oa
    slenderness = (2.0 * areas.A_L / L**2, 2.0 * areas.A_F / beam**2, L / beam)
    return np.array([1.0, *slenderness, areas.perimeter / L, 0.5 - areas.s_L / L])


def _last(name: str, areas: WindAreas) -> float:
    """The seventh variable: groups of masts for CX, share of the superstructure for CY."""
    return areas.masts if name == "CX" else areas.A_SS / areas.A_L


@functools.lru_cache(maxsize=3)
def _isherwood_rows(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Angles [rad], shape (19,), and regression coefficients, shape (19, 7 or 6)."""
    table = read_csv(_DATA / f"isherwood_{name}.csv")
    angle, *columns = (table.si(column) for column in table.columns)
    return angle, np.stack(columns, axis=-1)


def _mirrored(gamma_w) -> tuple[np.ndarray, np.ndarray]:
    """The angle within 0 to pi, and -1 for a wind from starboard (it pushes to port), else +1."""
    gamma = wrap_angle(np.asarray(gamma_w, dtype=float))
    return np.abs(gamma), np.where(gamma > 0.0, -1.0, 1.0)


@functools.lru_cache(maxsize=64)
def wind_table(areas: WindAreas, ship_type: str, beam: float, method: str = "blendermann") -> Table:
    """Wind coefficients over one turn of gamma_w, for linear interpolation by a kernel.

    Parameters
    ----------
    areas : WindAreas
    ship_type : str
        For Blendermann, one of `ship_types`.
    beam : float
        B [m], for Isherwood.
    method : str
        ``"blendermann"`` or ``"isherwood"``.

    Returns
    -------
    Table
        Axis gamma_w, 0 to 2 pi every 2 deg; CX, CY, CN: values of shape (181, 3).
    """
    if check_known("wind method", method, METHODS) == "blendermann":
        model = functools.partial(blendermann, areas=areas, ship_type=ship_type)
    else:
        model = functools.partial(isherwood, areas=areas, beam=beam)
    card = {"method": method, "ship_type": ship_type, "areas": dataclasses.asdict(areas)}
    return tabulate(model, (Axis("gamma_w", 0.0, _STEP, 181),), _COEFFICIENTS, card)
