"""Surge forces of a steady turn, term by term: what docs/turning_circle_speed.md weighs."""

from __future__ import annotations

import math

from ship_gym.recording.trajectory import Trajectory
from ship_gym.reports.balance import inertia_terms, last_turn
from ship_gym.ships.particulars import Ship


def hull_surge_terms(ship: Ship, u: float, v: float, r: float) -> dict[str, float]:
    """Surge force of the MMG polynomial, term by term [N].

    Valid where the hull model is the polynomial alone (drift to 30 deg, r' to 1.2).

    Parameters
    ----------
    u, v : float
        Through the water, at midship [m/s].
    r : float
        [rad/s]
    """
    h = ship.hull
    U = math.hypot(u, v)
    q = 0.5 * ship.rho * h.L * h.d * U * U
    v_, r_ = v / U, r * h.L / U
    return {
        "R_0": -q * h.R_0,
        "X_vv": q * h.X_vv * v_**2,
        "X_vr": q * h.X_vr * v_ * r_,
        "X_rr": q * h.X_rr * r_**2,
        "X_vvvv": q * h.X_vvvv * v_**4,
    }


def surge_balance(ship: Ship, trajectory: Trajectory) -> dict[str, float]:
    """Every surge force of the steady part of a calm turning circle [N]; their sum is zero."""
    mean = last_turn(trajectory)
    motion = (mean["u"], mean["v"], mean["r"])
    centripetal, offset = inertia_terms(ship, *motion)
    return {
        "propeller": mean["X_propeller"],
        "rudder": mean["X_rudder"],
        **hull_surge_terms(ship, *motion),
        "(m + m_y) v r": centripetal,
        "m x_G r^2": offset,
    }
