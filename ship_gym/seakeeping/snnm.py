"""Added resistance in waves by the semi-empirical SNNM formula.

Liu & Papanikolaou (2020), "Regression analysis of experimental data for added resistance in waves
of arbitrary heading and development of a semi-empirical formula", Ocean Engineering 206, 107357;
as ITTC 7.5-04-01-01.1 takes it over for speed trials (named there after its makers SHOPERA, NTUA,
NTU, MARIC). Transcribed from two public codes that agree, not from the paper. It is a regression:
good in head and bow seas, weak in beam and following seas.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from ship_gym.config import ConfigError, check_number
from ship_gym.conventions import wrap_angle
from ship_gym.ships.estimators import block_coefficient
from ship_gym.ships.particulars import Ship


@dataclasses.dataclass(frozen=True)
class SnnmHull:
    """What the formula needs of a ship, of any scale.

    Attributes
    ----------
    L, B, T_bow, T_stern : float
        Length between perpendiculars, beam, draughts at the perpendiculars [m].
    C_b : float
        Block coefficient.
    k_yy : float
        Radius of gyration in pitch by L [-].
    L_E, L_R : float
        Lengths of entrance and run of the waterline [m].
    """

    L: float
    B: float
    T_bow: float
    T_stern: float
    C_b: float
    k_yy: float
    L_E: float
    L_R: float

    @property
    def T(self) -> float:
        """Mean draught [m]."""
        return 0.5 * (self.T_bow + self.T_stern)


def snnm_hull(ship: Ship) -> SnnmHull:
    """Input of the formula from a ship file; ConfigError without a section ``form``."""
    hull, form = ship.hull, ship.form
    if form is None:
        raise ConfigError(f"{ship.name}: no section [form], which the added resistance needs")
    C_b = block_coefficient(hull.L, hull.B, hull.d, hull.volume)
    draughts = hull.d - 0.5 * form.trim, hull.d + 0.5 * form.trim
    return SnnmHull(hull.L, hull.B, *draughts, C_b, form.k_yy / hull.L, form.L_E, form.L_R)


def added_resistance(hull: SnnmHull, Fn: float, wavelength, heading) -> np.ndarray:
    """C_AW = R_AW / (rho g zeta^2 B^2 / L), positive backwards, zeta the wave amplitude.

    In head seas the drift coefficient is CX = -C_AW. R_AW = R_AWM (motions) + R_AWR (reflection).
    The formula is for 0 <= Fn <= 0.3 or so, C_b 0.5 to 0.87, wavelengths of 0.1 to 3 L.

    Parameters
    ----------
    hull : SnnmHull
    Fn : float
        Froude number U / sqrt(g L), not negative.
    wavelength : array_like
        Length of the wave [m].
    heading : array_like
        Relative wave heading mu [rad] as in ``ship_gym.conventions``: the alpha of the paper, pi =
        head sea, 0 = following sea; both sides alike. Broadcast against `wavelength`.

    Returns
    -------
    numpy.ndarray
        C_AW [-]; negative where the waves push the ship.

    Raises
    ------
    ConfigError
        Fn out of 0 to 0.6, or a wavelength that is not positive.
    """
    check_number("Fn", Fn, 0.0, 0.6)
    wavelength, heading = np.broadcast_arrays(wavelength, heading)
    ratio = np.asarray(wavelength, dtype=float) / hull.L
    if not (np.isfinite(ratio) & (ratio > 0.0)).all():
        raise ConfigError(f"wavelength = {wavelength}: must be > 0 m")
    alpha = np.abs(wrap_angle(np.abs(heading)))  # abs twice: both sides alike to the last bit
    return _motions(hull, Fn, ratio, alpha) + _reflection(hull, Fn, ratio, alpha)


def _motions(hull: SnnmHull, Fn: float, ratio: np.ndarray, alpha: np.ndarray) -> np.ndarray:
    """R_AWM of any heading: below 90 deg linear between following and beam seas."""
    bow = _motions_formula(hull, Fn, ratio, np.maximum(alpha, 0.5 * np.pi))
    share = np.minimum(alpha / (0.5 * np.pi), 1.0)
    return share * bow + (1.0 - share) * _following(hull, Fn, ratio)


def _following(hull: SnnmHull, Fn: float, ratio: np.ndarray) -> np.ndarray:
    """R_AWM at alpha = 0, by the ship's speed beside the waves' group velocity V_g.

    At U = 0 the formula itself, at V_g / 2 nothing, at V_g a head sea at rest, linear between;
    faster, a head sea at the speed U - V_g.
    """
    group = 0.5 * np.sqrt(ratio / (2.0 * np.pi))  # V_g / sqrt(g L)
    pushed = _motions_formula(hull, 0.0, ratio, np.zeros_like(ratio))
    met = _motions_formula(hull, 0.0, ratio, np.full_like(ratio, np.pi))
    slow = np.where(
        Fn < 0.5 * group, pushed * (1.0 - 2.0 * Fn / group), met * (2.0 * Fn / group - 1.0)
    )
    excess = np.maximum(Fn - group, 0.0)
    return np.where(
        Fn > group, _motions_formula(hull, excess, ratio, np.full_like(ratio, np.pi)), slow
    )


def _motions_formula(hull: SnnmHull, Fn, ratio, alpha) -> np.ndarray:
    """4 a1 a2 a3 W^b1 exp[b1/d1 (1 - W^d1)], W the encounter frequency by that of the peak."""
    slender, flat, c = hull.L / hull.B, np.log(hull.B / hull.T), np.cos(alpha)
    trim = np.arctan(np.abs(hull.T_stern - hull.T_bow) / hull.L)
    a1 = 60.3 * hull.C_b**1.34 * (4.0 * hull.k_yy) ** 2 / flat
    a1 = a1 * (0.87 / hull.C_b) ** (-(1.0 + Fn) * c) * (1.0 - 2.0 * c) / 3.0
    a2 = np.where(Fn < 0.12, 0.0072 + 0.1676 * Fn, Fn**1.5 * np.exp(-3.5 * Fn))
    a3 = 1.0 + 28.7 * trim
    W = 2.142 * hull.k_yy ** (1.0 / 3.0) * np.sqrt(1.0 / ratio)
    W = W * (1.0 - 0.111 / hull.C_b * (flat - np.log(2.75))) * (hull.C_b / 0.65) ** 0.17
    speed = (-1.377 * Fn**2 + 1.157 * Fn) * np.abs(c)
    W = W * (speed + 0.618 * (13.0 + np.cos(2.0 * alpha)) / 14.0)
    short = -566.0 * slender**-2.66 * (4.0 - 125.0 * trim)
    b1 = np.where(W < 1.0, 11.0, -8.5)
    d1 = np.where(W < 1.0, 566.0 * (slender * hull.C_b) ** -2.66, short)
    return 4.0 * a1 * a2 * a3 * W**b1 * np.exp(b1 / d1 * (1.0 - W**d1))


def _reflection(hull: SnnmHull, Fn: float, ratio: np.ndarray, alpha: np.ndarray) -> np.ndarray:
    """R_AWR: reflection from the lit sides of bow (angle E1) and stern (angle E2)."""
    E1, E2 = np.arctan(0.495 * hull.B / hull.L_E), np.arctan(0.495 * hull.B / hull.L_R)
    c = np.cos(alpha)
    doppler = 2.0 * Fn * np.sqrt(2.0 * np.pi / ratio)  # 2 omega_0 U / g

    def side(angle: float, turned: np.ndarray) -> np.ndarray:
        return np.sin(turned) ** 2 + doppler * (np.cos(angle) * np.cos(turned) - c)

    fullness = np.where(alpha >= np.pi - E1, -c, 0.0)
    bow = np.where(alpha >= E1, side(E1, E1 - alpha), 0.0)
    bow = bow + np.where(alpha >= np.pi - E1, side(E1, E1 + alpha), 0.0)
    bow = bow * (0.87 / hull.C_b) ** ((1.0 + 4.0 * np.sqrt(Fn)) * fullness)
    stern = np.where(alpha <= np.pi - E2, side(E2, E2 + alpha), 0.0)
    stern = stern + np.where(alpha <= E2, side(E2, E2 - alpha), 0.0)
    root = np.sqrt(np.abs(c))
    depth = (4.0 + root) / 5.0 if hull.C_b <= 0.75 else (2.0 + root) / 3.0
    lit = _draught_factor(hull.T_bow / hull.L, ratio) * bow
    lit = lit - _draught_factor(hull.T_stern * depth / hull.L, ratio) * stern
    return 2.25 / 4.0 * hull.L / hull.B * lit


def _draught_factor(draught, ratio: np.ndarray) -> np.ndarray:
    """alpha_T* = 1 - exp[-4 pi (T*/lambda - T*/(2.5 L))] up to lambda = 2.5 L, then 0; T* by L."""
    depth = draught * np.maximum(1.0 / ratio - 0.4, 0.0)
    return 1.0 - np.exp(-4.0 * np.pi * depth)
