"""Open-water curves K_T(J), K_Q(J) as a table over the advance angle."""

from __future__ import annotations

import math

import numpy as np

from ship_gym.tables import Axis, Table, tabulate

EPSILON = Axis("advance angle", -math.pi / 2, math.pi / 600, 601)


def starred(K, J):
    """C_T* (or C_Q*) from K_T (K_Q) at J: C* = 8 K / (pi (J^2 + (0.7 pi)^2)).

    C_T* = T / (1/2 rho (u^2 + (0.7 pi n D)^2) pi D^2 / 4), so a stopped propeller and a stopped
    ship are ordinary points. Exact.
    """
    return 8.0 / math.pi * K / (J**2 + (0.7 * math.pi) ** 2)


def coefficients(table: Table, J: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
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


def open_water_table(K_T: np.ndarray, K_Q: np.ndarray, J_range: tuple[float, float], card) -> Table:
    """Table of C_T, C_Q over the advance angle from polynomials in J.

    Parameters
    ----------
    K_T, K_Q : numpy.ndarray
        Polynomial coefficients, highest power first.
    J_range : (float, float)
        Range of the data; outside it the tangents continue, which makes a freely turning propeller
        force-free at zero speed. Not validated there.
    card : dict
        Provenance, stored with the table.
    """

    def model(epsilon):
        # at +-90 deg J is infinite and the limit of C* along the tangent is zero
        J = 0.7 * math.pi * np.tan(np.clip(epsilon, -1.5707, 1.5707))
        K = np.stack([continued(p, J, *J_range) for p in (K_T, K_Q)], axis=-1)
        return starred(K, J[..., None])

    return tabulate(model, (EPSILON,), ("C_T", "C_Q"), {**card, "J_range": list(J_range)})
