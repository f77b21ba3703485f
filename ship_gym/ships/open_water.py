"""Open-water curves K_T(J), K_Q(J) as a table over the whole advance angle.

In the range of the data the ship's own curve; elsewhere the four-quadrant harmonics of a
Wageningen screw (``four_quadrants``), joined over `JOIN` without a jump or a kink.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from ship_gym.ships.four_quadrants import Screw, starred_of
from ship_gym.tables import Axis, Table, smoothstep, tabulate

EPSILON = Axis("advance angle", -math.pi / 2, math.pi / 600, 601)  # propeller turning ahead
ROUND = Axis("advance angle", -math.pi, math.pi / 600, 1201)  # all four quadrants
JOIN = math.radians(15.0)  # width of the joint at each end of the data (our choice)


def starred(K, J):
    """C_T* (or C_Q*) from K_T (K_Q) at J: C* = 8 K / (pi (J^2 + (0.7 pi)^2)).

    C_T* = T / (1/2 rho (u^2 + (0.7 pi n D)^2) pi D^2 / 4), so a stopped propeller and a stopped
    ship are ordinary points. Exact.
    """
    return 8.0 / math.pi * K / (J**2 + (0.7 * math.pi) ** 2)


def coefficients(table: Table, J: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
    """K_T and K_Q of an open-water table at advance ratios J, each of J's shape."""
    J = np.asarray(J, dtype=float)
    starred_values = table(np.arctan(J / (0.7 * math.pi)))
    K = starred_values * (math.pi / 8.0 * (J**2 + (0.7 * math.pi) ** 2))[..., None]
    return K[..., 0], K[..., 1]


def continued(polynomial: np.ndarray, J, J_min: float, J_max: float):
    """Polynomial (highest power first) inside [J_min, J_max], its tangents outside."""
    inside = np.clip(J, J_min, J_max)
    slope = np.polyval(np.polyder(polynomial), inside)
    return np.polyval(polynomial, inside) + slope * (J - inside)


def first_quadrant(table: Table, J) -> tuple[np.ndarray, np.ndarray]:
    """K_T and K_Q of the ship's own curve alone, its tangents outside the data, each of J's shape.

    Of a table made by `open_water_table`, whose card holds the polynomials.
    """
    card, J = table.card, np.asarray(J, dtype=float)
    K_T, K_Q = (continued(np.array(card[name]), J, *card["J_range"]) for name in ("K_T", "K_Q"))
    return K_T, K_Q


def open_water_table(
    K_T: np.ndarray, K_Q: np.ndarray, J_range: tuple[float, float], screw: Screw, card: dict
) -> Table:
    """Table of C_T, C_Q over the advance angle from polynomials in J and four-quadrant harmonics.

    Parameters
    ----------
    K_T, K_Q : numpy.ndarray
        Polynomial coefficients, highest power first.
    J_range : (float, float)
        Range of the data. Within `JOIN` outside it the curve passes from its tangents to the
        harmonics.
    screw : Screw
        Series screw that stands for the propeller outside the data.
    card : dict
        Provenance, stored with the table.
    """
    low, high = (math.atan(J / (0.7 * math.pi)) for J in J_range)

    def model(epsilon):
        # tangents are asked for within the joint only, far from the infinite J of 90 deg
        near = np.clip(epsilon, low - JOIN, high + JOIN)
        J = 0.7 * math.pi * np.tan(near)
        K = np.stack([continued(p, J, *J_range) for p in (K_T, K_Q)], axis=-1)
        away = np.maximum(low - near, near - high) / JOIN
        own = 1.0 - smoothstep(away)[..., None]
        series = starred_of(screw, epsilon)
        return series + own * (starred(K, J[..., None]) - series)

    card = {**card, "J_range": list(J_range), "K_T": list(map(float, K_T))}
    card |= {"K_Q": list(map(float, K_Q)), "four_quadrants": dataclasses.asdict(screw)}
    return tabulate(model, (ROUND,), ("C_T", "C_Q"), card)
