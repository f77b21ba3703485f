"""Empirical estimates from a ship's main particulars, for numbers that no source prints.

Each function is one published regression. Lengths may be of any scale: everything is formed of
their ratios, with C_b = volume / (L B d), c = C_b B / L, k = 2 d / L. Two ships with measured
derivatives judge the formulas, KCS (C_b 0.651, L/B 7.1) and KVLCC2 (0.810, 5.5); outside that
range nothing here is validated.

Zhou: Zhou, Yan & Feng (1983), regressions of Motora's charts.
YM12: Yoshimura & Masumoto (2012), MARSIM, merchant ships and fishing vessels.
YY15: Yasukawa & Yoshimura (2015), J. Mar. Sci. Technol. 20:37-52.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from ship_gym.config import check_known, check_number
from ship_gym.ships.ranges import BOX

ZHOU = "Zhou et al. (1983)"
YM12 = "Yoshimura & Masumoto (2012)"
ESTIMATED = (  # by `estimated_hull`
    *("m_x", "m_y", "J_z", "X_vv", "X_vr", "X_rr", "X_vvvv"),
    *("Y_v", "Y_r", "Y_vvv", "Y_vvr", "Y_vrr", "Y_rrr"),
    *("N_v", "N_r", "N_vvv", "N_vvr", "N_vrr", "N_rrr"),
)
POOR = ("X_rr", "X_vvvv", "Y_vvr", "Y_rrr")  # neither KCS nor KVLCC2 confirms them


def block_coefficient(L: float, B: float, d: float, volume: float) -> float:
    """C_b = volume / (L B d).

    Parameters
    ----------
    L, B, d : float
        Length between perpendiculars, beam, draught [m].
    volume : float
        Displacement volume [m3].

    Raises
    ------
    ConfigError
        A length that is not positive, or a C_b that no ship has.
    """
    for name, value in (("L", L), ("B", B), ("d", d)):
        check_number(name, value, 1e-3, 1e3, "m")
    return check_number("block coefficient volume / (L B d)", volume / (L * B * d), 0.2, BOX)


def added_mass(L: float, B: float, d: float, C_b: float) -> tuple[float, float, float]:
    """m'_x, m'_y, J'_z by Zhou's regressions of Motora's charts.

    With m' = 2 C_b B / L the ratios m'_x / m', m'_y / m' and J'_z / m' (the radius of gyration of
    the added mass over L, squared). In circulating copies the last term of m'_y lacks its C_b, or
    J'_z has an L too many.

    Returns
    -------
    m_x, m_y, J_z : float
        By 1/2 rho L^2 d, 1/2 rho L^2 d and 1/2 rho L^4 d, as in ``particulars.Hull``. Within 8 %
        of the measured ones of KCS and within 5 % for KVLCC2.
    """
    s, h, m = L / B, d / B, 2.0 * C_b * B / L
    m_x = 0.398 + 11.97 * C_b * (1.0 + 3.73 * h) - 2.89 * C_b * s * (1.0 + 1.13 * h)
    m_x += 0.175 * C_b * s**2 * (1.0 + 0.541 * h) - 1.107 * s * h
    m_y = 0.882 - 0.54 * C_b * (1.0 - 1.6 * h) - 0.156 * s * (1.0 - 0.673 * C_b)
    m_y += 0.826 * h * s * (1.0 - 0.678 * h) - 0.638 * C_b * h * s * (1.0 - 0.669 * h)
    k_z = 33.0 - 76.85 * C_b * (1.0 - 0.784 * C_b) + 3.43 * s * (1.0 - 0.63 * C_b)
    return m * 0.01 * m_x, m * m_y, m * (0.01 * k_z) ** 2


def surge_derivatives(L: float, B: float, C_b: float, x_G: float, m_y: float) -> dict[str, float]:
    """X_vv, X_vr, X_rr, X_vvvv by YM12, for the equations of YY15 ((m + m_y) v r kept apart).

    YM12 prints its beta form with the added mass lumped in; taken apart, X_vr = -(m'_y - 1.91 c +
    0.08); with m'_y + ..., found in codes, KCS has the wrong sign (KVLCC2's is nearly zero). X_rr
    and X_vvvv are poor: KCS +0.003 and 0.49 against -0.014 and -0.08 measured, KVLCC2 -0.012 and
    0.12 against +0.011 and 0.77.

    Parameters
    ----------
    L, B : float
        [m]
    C_b, m_y : float
        Block coefficient and added mass in sway [-].
    x_G : float
        Centre of gravity forward of midship [m].
    """
    c = C_b * B / L
    return {
        "X_vv": 1.15 * c - 0.18,
        "X_vr": -(m_y - 1.91 * c + 0.08),
        "X_rr": -0.085 * c + 0.008 - x_G / L * m_y,
        "X_vvvv": -6.68 * c + 1.1,
    }


def sway_derivatives(L: float, B: float, d: float, C_b: float, m_x: float) -> dict[str, float]:
    """Y_v ... Y_rrr by YM12 in YY15 form, m_x [-] the added mass in surge.

    Y_r = m'_x + 0.5 c, since YY15 has (m + m_x) u r on the other side. Y_vvv carries -(0.185 L/B +
    0.48): with -0.185 L/B + 0.48, found in codes, both ships disagree. Y_vvr = -0.75 (KCS -0.31,
    KVLCC2 +0.38 measured) and Y_rrr = -0.051 (-0.005, +0.008) are constants, and poor.
    """
    k, c = 2.0 * d / L, C_b * B / L
    return {
        "Y_v": -(0.5 * math.pi * k + 1.4 * c),
        "Y_r": m_x + 0.5 * c,
        "Y_vvv": -(0.185 * L / B + 0.48),
        "Y_vvr": -0.75,
        "Y_vrr": -(0.26 * (1.0 - C_b) * L / B + 0.11),
        "Y_rrr": -0.051,
    }


def yaw_derivatives(L: float, B: float, d: float, C_b: float) -> dict[str, float]:
    """N_v ... N_rrr by YM12 in YY15 form.

    N_r = -0.54 k + k^2, and N_vrr = -0.075 (1 - C_b) L/B + 0.098: -k (0.54 + k) and -0.098, found
    in codes, disagree with both ships. The linear terms hold within 17 %; N_vrr has hardly more
    than its sign, N_vvr and N_vvv of KVLCC2 are two and three times too large.
    """
    k, c = 2.0 * d / L, C_b * B / L
    return {
        "N_v": -k,
        "N_r": -0.54 * k + k**2,
        "N_vvv": -(0.66 - 0.69 * C_b),
        "N_vvr": 1.55 * c - 0.76,
        "N_vrr": -0.075 * (1.0 - C_b) * L / B + 0.098,
        "N_rrr": 0.25 * c - 0.056,
    }


def estimated_hull(
    L: float, B: float, d: float, volume: float, x_G: float
) -> dict[str, tuple[float, str]]:
    """Added masses and all hull derivatives of a ship of which only the particulars are known.

    Parameters
    ----------
    L, B, d : float
        Length between perpendiculars, beam, draught [m].
    volume : float
        Displacement volume [m3].
    x_G : float
        Centre of gravity forward of midship [m].

    Returns
    -------
    dict
        Field of ``particulars.Hull`` to its value and the reason why it is an estimate.

    Raises
    ------
    ConfigError
        As `block_coefficient`; or a centre of gravity outside the ship.
    """
    C_b = block_coefficient(L, B, d, volume)
    check_number("x_G", x_G, -0.5 * L, 0.5 * L, "m")
    m_x, m_y, J_z = added_mass(L, B, d, C_b)
    derivatives = surge_derivatives(L, B, C_b, x_G, m_y)
    derivatives |= sway_derivatives(L, B, d, C_b, m_x) | yaw_derivatives(L, B, d, C_b)
    found = {"m_x": (m_x, ZHOU), "m_y": (m_y, ZHOU), "J_z": (J_z, ZHOU)}
    poor = f"{YM12}; a poor regression, wrong in size or sign for KCS and KVLCC2"
    return found | {k: (x, poor if k in POOR else YM12) for k, x in derivatives.items()}


def wetted_surface(L: float, B: float, d: float, C_b: float) -> float:
    """Denny-Mumford: S = L (1.7 d + C_b B) [m2], bare hull; 4 % low for KCS and for KVLCC2."""
    return L * (1.7 * d + C_b * B)


def wake_fraction(C_b: float) -> float:
    """Effective wake fraction of a single-screw ship, w_P0 = 0.5 C_b - 0.05 (Taylor).

    Low for models: KCS 0.275 (0.353 measured at 3 m), KVLCC2 0.355 (0.40 at 7 m, 0.35 full scale).
    """
    return 0.5 * C_b - 0.05


def rudder_gradient(aspect_ratio: float) -> float:
    """Fujii: f_alpha = 6.13 Lambda / (Lambda + 2.25), Lambda = H_R^2 / A_R.

    YY15 has f_alpha = 2.747 at Lambda = 1.827 by this formula.
    """
    return 6.13 * aspect_ratio / (aspect_ratio + 2.25)


def race_share(L: float, B: float, C_b: float) -> float:
    """Share of the race that reaches the rudder, kappa = 0.55 - 0.8 c.

    Low: KCS 0.48 (0.633 measured), KVLCC2 0.43 (0.50). From a public code that names no paper.
    """
    return 0.55 - 0.8 * C_b * B / L


def flow_straightening(L: float, B: float, C_b: float) -> float:
    """Flow straightening gamma_R = 2.06 c + 0.14, one value for both sides.

    KCS 0.33 (0.492 and 0.338 measured), KVLCC2 0.44 (0.640 and 0.395). Source as `race_share`.
    """
    return 2.06 * C_b * B / L + 0.14


def _stern(C_b: float) -> tuple[float, float, float]:
    a_H = 2.32 * C_b**2 - 0.904 * C_b + 0.0276
    return _t_R(C_b), a_H, 9.64 * C_b**2 - 8.22 * C_b + 0.0077


def _kijima(C_b: float) -> tuple[float, float, float]:
    return _t_R(C_b), 0.6784 - 1.3374 * C_b + 1.8891 * C_b**2, -(0.4 + 0.1 * C_b)


def _quadvlieg(C_b: float) -> tuple[float, float, float]:
    return _t_R(C_b), 0.627 * C_b - 0.153, -(0.4 + 0.1 * C_b)


def _t_R(C_b: float) -> float:
    return 1.0 - (0.28 * C_b + 0.55)


INTERACTIONS: dict[str, Callable[[float], tuple[float, float, float]]] = {
    "kijima": _kijima,
    "quadvlieg": _quadvlieg,
    "stern_2021": _stern,
}


def rudder_interaction(C_b: float, variant: str = "quadvlieg") -> tuple[float, float, float]:
    """t_R, a_H and x_H / L of the rudder force with the hull, by what circulates as "Kijima".

    All variants have t_R = 1 - (0.28 C_b + 0.55).

    - ``quadvlieg``: a_H = 0.627 C_b - 0.153, x_H/L = -(0.4 + 0.1 C_b);
    - ``kijima``: a_H = 0.6784 - 1.3374 C_b + 1.8891 C_b^2, the same x_H;
    - ``stern_2021``: a_H = 2.32 C_b^2 - 0.904 C_b + 0.0276, x_H/L = 9.64 C_b^2 - 8.22 C_b +
      0.0077, as Stern et al. (2021) print it. At KCS' C_b = 0.6505 (52030 m3) this gives their
      0.2679, 0.4213 and -1.2602 to the last digit. But x_H = -1.26 L lies three quarters of a
      length behind the stern: not to be used in a simulation.

    Measured: KCS 0.258, 0.361, -0.436; KVLCC2 0.387, 0.312, -0.464. ``quadvlieg`` is within 0.11
    of a_H for both ships; the two quadratics give 0.8 for KVLCC2. t_R falls with C_b here, while
    the fuller ship of the two has the larger one.

    Raises
    ------
    ConfigError
        Unknown variant.
    """
    return INTERACTIONS[check_known("interaction formula", variant, INTERACTIONS)](C_b)
