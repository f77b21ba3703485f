"""Named tuples that kernels pass to each other: one word, one meaning.

Each is a tuple to Python and to numba, so it costs nothing and may be unpacked.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ship_gym.conventions import FLOW_OF_UNITS, STATE_NAMES


def record_type(fields: list) -> np.dtype:
    """Type of a record of named fields; aligned, or a graphics card would read byte by byte."""
    return np.dtype((np.record, np.dtype(fields, align=True)))


class Motion(NamedTuple):
    """Velocities through the water at midship: u, v [m/s], r [rad/s]."""

    u: float
    v: float
    r: float


class Body(NamedTuple):
    """Velocities over ground [m/s], [rad/s], position [m] and heading [rad]; or their rates."""

    u: float
    v: float
    r: float
    x: float
    y: float
    psi: float


class Controls(NamedTuple):
    """Rudder angle [rad] and propeller speed [rev/s]: achieved, or commanded."""

    delta: float
    n: float


class State(NamedTuple):
    """A body and its controls, in the order of ``conventions.STATE_NAMES``."""

    u: float
    v: float
    r: float
    x: float
    y: float
    psi: float
    delta: float
    n: float


class Force(NamedTuple):
    """X, Y [N] and N [N m] at midship."""

    X: float
    Y: float
    N: float


class Flow(NamedTuple):
    """How propeller and rudder are loaded, ``conventions.FLOW_OF_UNITS``.

    J, beta_P, beta_R [rad], thrust [N], torque [N m], rudder normal force [N] of the ship, the
    extrapolation, and the first six again of the starboard unit and of the port one. A single unit
    stands as the starboard one, the port one is zero then.
    """

    J: float
    beta_P: float
    beta_R: float
    thrust: float
    torque: float
    rudder_normal_force: float
    extrapolation: float
    J_starboard: float
    beta_P_starboard: float
    beta_R_starboard: float
    thrust_starboard: float
    torque_starboard: float
    rudder_normal_force_starboard: float
    J_port: float
    beta_P_port: float
    beta_R_port: float
    thrust_port: float
    torque_port: float
    rudder_normal_force_port: float


class Tables(NamedTuple):
    """Tables of one kind of ship: open water (count, 2), surrogate (2, count, count, 11)."""

    open_water: np.ndarray
    deflected: np.ndarray


if State._fields != STATE_NAMES or Flow._fields != FLOW_OF_UNITS:
    raise ImportError("State and Flow must be named as conventions.STATE_NAMES, FLOW_OF_UNITS")
