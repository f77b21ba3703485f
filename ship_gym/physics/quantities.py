"""Named tuples that kernels pass to each other: one word, one meaning.

Each is a tuple to Python and to numba, so it costs nothing and may be unpacked.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ship_gym.conventions import FLOW_NAMES, STATE_NAMES


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
    """How propeller and rudder are loaded, ``conventions.FLOW_NAMES``.

    J, beta_P, beta_R [rad], thrust [N], torque [N m], rudder normal force [N], extrapolation.
    """

    J: float
    beta_P: float
    beta_R: float
    thrust: float
    torque: float
    rudder_normal_force: float
    extrapolation: float


class Tables(NamedTuple):
    """Tables of one kind of ship: open water (count, 2), surrogate (2, count, count, 11)."""

    open_water: np.ndarray
    deflected: np.ndarray


class Around(NamedTuple):
    """What is around one ship: its waves (6, N), their groups, its response, its wind table."""

    waves: np.ndarray
    groups: np.ndarray
    response: np.ndarray
    wind: np.ndarray


if State._fields != STATE_NAMES or Flow._fields != FLOW_NAMES:
    raise ImportError("State and Flow must name what conventions.STATE_NAMES and FLOW_NAMES do")
