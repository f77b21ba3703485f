"""Force balance of a steady turn: by component, and surge term by term."""

from __future__ import annotations

import math

import numpy as np

from ship_gym.recording.trajectory import Trajectory
from ship_gym.ships.particulars import Ship

_COMPONENTS = ("hull", "propeller", "rudder")


def last_turn(trajectory: Trajectory) -> dict[str, float]:
    """Mean of every column over the last 360 deg of a turning circle, in the columns' units."""
    turned = np.abs(trajectory["psi"])
    last = turned >= turned[-1] - 2.0 * math.pi
    return {name: float(trajectory[name][last].mean()) for name in trajectory.names}


def steady_balance(ship: Ship, trajectory: Trajectory) -> dict[str, tuple[float, float, float]]:
    """X, Y [N] and N [N m] of each component and of inertia in the steady part of a calm turn.

    Inertia is what the turn itself takes, with the sign of a force (Yasukawa & Yoshimura 2015):
    (m + m_y) v r + m x_G r^2, -(m + m_x) u r and -m x_G u r. The sum vanishes in a steady turn.

    Parameters
    ----------
    ship : Ship
    trajectory : Trajectory
        Of ``manoeuvres.turning_circle`` in calm water.

    Returns
    -------
    dict
        hull, propeller, rudder, inertia and their sum.
    """
    mean = last_turn(trajectory)
    balance = {k: tuple(mean[f"{axis}_{k}"] for axis in "XYN") for k in _COMPONENTS}
    centripetal, offset = inertia_terms(ship, mean["u"], mean["v"], mean["r"])
    u, r, inertia = mean["u"], mean["r"], ship.inertia
    balance["inertia"] = (centripetal + offset, -inertia.m_u * u * r, -inertia.m_xG * u * r)
    balance["sum"] = tuple(float(s) for s in np.sum(list(balance.values()), axis=0))
    return balance


def inertia_terms(ship: Ship, u: float, v: float, r: float) -> tuple[float, float]:
    """Surge terms of inertia in a steady turn, (m + m_y) v r and m x_G r^2 [N]."""
    return ship.inertia.m_v * v * r, ship.inertia.m_xG * r * r


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
