"""Force balance of a steady turn: by component, and surge term by term."""

from __future__ import annotations

import math

import numpy as np

from ship_gym.conventions import FORCES
from ship_gym.recording.trajectory import Trajectory
from ship_gym.ships.particulars import Ship

_COMPONENTS = tuple(force.name for force in FORCES if not force.outside)


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
    balance = {k: (mean[f"X_{k}"], mean[f"Y_{k}"], mean[f"N_{k}"]) for k in _COMPONENTS}
    centripetal, offset = inertia_terms(ship, mean["u"], mean["v"], mean["r"])
    u, r, inertia = mean["u"], mean["r"], ship.inertia
    balance["inertia"] = (centripetal + offset, -inertia.m_u * u * r, -inertia.m_xG * u * r)
    X, Y, N = np.sum(list(balance.values()), axis=0).tolist()
    balance["sum"] = X, Y, N
    return balance


def inertia_terms(ship: Ship, u: float, v: float, r: float) -> tuple[float, float]:
    """Surge terms of inertia in a steady turn, (m + m_y) v r and m x_G r^2 [N]."""
    return ship.inertia.m_v * v * r, ship.inertia.m_xG * r * r
