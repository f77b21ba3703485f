"""Where a ship is on a leg and on the route, the bearing to steer, and when the next leg begins.

Cross-track error, look-ahead steering and the circle of acceptance after Fossen (2011), Handbook of
Marine Craft Hydrodynamics and Motion Control, section 10.3. The distance to the route and the
bisector of a way-point are plain geometry.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ship_gym.physics._kernel import kernel

_NEARER = 1.0 - 1e-9  # squares of distances by which another leg is nearer, and not by rounding


class OnRoute(NamedTuple):
    """Where a ship is on a route, in [m].

    Attributes
    ----------
    off : float
        Distance to the nearest of the previous, the active and the next leg, positive when the
        ship is to starboard of that leg.
    cross : float
        Cross-track error from the active leg, positive to starboard.
    to_go : float
        Along the active leg to its end; negative beyond.
    along_next : float
        From there along the next leg, negative before; 0 on the last leg.
    nearest : int
        The leg that `off` is the distance to: -1 the previous, 0 the active, 1 the next. On the
        outside of a turn, where a way-point is as near on two legs, the active one.
    """

    off: float
    cross: float
    to_go: float
    along_next: float
    nearest: int


@kernel
def leg_axes(x, y, x_a, y_a, x_b, y_b):
    """Along [m], cross [m] and length [m] as `leg_position` has them, without the bearing."""
    dx, dy = x_b - x_a, y_b - y_a
    length = math.sqrt(dx * dx + dy * dy)
    cos, sin = 1.0, 0.0
    if length > 0.0:  # not the cos and sin of the bearing: sin(pi) is not 0
        cos, sin = dx / length, dy / length
    along = cos * (x - x_a) + sin * (y - y_a)
    cross = cos * (y - y_a) - sin * (x - x_a)
    return along, cross, length


@kernel
def leg_position(x, y, x_a, y_a, x_b, y_b):
    """Position of a ship in the axes of the leg from a to b, Fossen (2011) eqs. 10.58, 10.59.

    Parameters
    ----------
    x, y : float
        North and east of the ship [m].
    x_a, y_a, x_b, y_b : float
        North and east of the way-points at the start and the end of the leg [m].

    Returns
    -------
    along : float
        Distance from a along the leg [m]; negative before a, larger than `length` beyond b.
    cross : float
        Cross-track error [m], positive when the ship is to starboard of the leg.
    bearing : float
        Bearing of the leg [rad] from north, clockwise, in [-pi, pi]; 0 if a and b are one point.
    length : float
        Length of the leg [m].
    """
    along, cross, length = leg_axes(x, y, x_a, y_a, x_b, y_b)
    return along, cross, math.atan2(y_b - y_a, x_b - x_a), length


@kernel
def past_ends(along, length):
    """How far before its start or beyond its end a place is abeam of a leg [m], else 0."""
    return max(max(-along, along - length), 0.0)


@kernel
def on_route(x, y, x_0, y_0, x_a, y_a, x_b, y_b, x_c, y_c):
    """Position of a ship on the legs about the active one, from a to b.

    Legs are segments: beyond an end the distance is that to the way-point. Only the first leg,
    while it is active, goes on without end before its start, and the last one beyond its end, so
    that there the distance is the cross-track error.

    Parameters
    ----------
    x, y : float
        North and east of the ship [m].
    x_0, y_0 : float
        Start of the previous leg [m]; a itself if there is none.
    x_a, y_a, x_b, y_b : float
        Ends of the active leg [m].
    x_c, y_c : float
        End of the next leg [m]; b itself if there is none.

    Returns
    -------
    OnRoute
    """
    along, cross, length = leg_axes(x, y, x_a, y_a, x_b, y_b)
    along_0, cross_0, length_0 = leg_axes(x, y, x_0, y_0, x_a, y_a)
    along_1, cross_1, length_1 = leg_axes(x, y, x_b, y_b, x_c, y_c)
    before = max(-along, 0.0) if length_0 > 0.0 else 0.0
    beyond = max(along - length, 0.0) if length_1 > 0.0 else 0.0
    square, side = cross * cross + before * before + beyond * beyond, cross
    nearest, nearer = 0, _NEARER * square
    if length_0 > 0.0:
        past = past_ends(along_0, length_0)
        other = cross_0 * cross_0 + past * past
        if other < square:
            square, side = other, cross_0
            nearest = -1 if other < nearer else 0
    if length_1 > 0.0:
        past = past_ends(along_1, length_1)
        other = cross_1 * cross_1 + past * past
        if other < square:
            square, side = other, cross_1
            nearest = 1 if other < nearer else nearest
    off = math.copysign(math.sqrt(square), side)
    return OnRoute(off, cross, length - along, along_1 if length_1 > 0.0 else 0.0, nearest)


@kernel
def look_ahead_bearing(bearing, cross, distance):
    """Bearing [rad] from the ship to the point `distance` ahead on the leg; look-ahead steering.

    The course over ground to steer, Fossen (2021) eq. 12.78. Without the ship's drift angle taken
    off or an integral term a current sets the ship aside. Not wrapped: wrap differences of it.

    Parameters
    ----------
    bearing : float
        Bearing of the leg [rad].
    cross : float
        Cross-track error [m], positive to starboard.
    distance : float
        Look-ahead distance [m] > 0, from the ship's foot point on the leg.
    """
    return bearing - math.atan(cross / distance)


@kernel
def passed(to_go, along_next, cross, circle):
    """1 if the way-point at the end of the leg is passed, else 0.

    Passed: across the bisector of the way-point's angle, the line through it that halves the angle
    between the legs. There the distances to the way-point along both legs are equal,
    ``to_go = along_next``. On the last leg, where `along_next` is 0, that is abeam of the end.
    Or within the circle of acceptance (rim included), where there is one.

    Parameters
    ----------
    to_go, along_next, cross : float
        From `on_route` [m].
    circle : float
        Radius of the circle of acceptance [m]; 0: none.
    """
    circled = circle > 0.0 and to_go * to_go + cross * cross <= circle * circle
    return 1 if to_go <= along_next or circled else 0


def cross_track(points: np.ndarray, legs: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Cross-track errors from the active leg [m] of a voyage, see `off_route`."""
    return _voyage(lambda *row: on_route(*row).cross, points, legs, x, y)


def off_route(points: np.ndarray, legs: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Distances to the route [m] of a voyage, signed as in `OnRoute`, shape (T,).

    Parameters
    ----------
    points : numpy.ndarray
        Way-points north and east [m], shape (W, 2).
    legs : numpy.ndarray
        Active leg at each instant, shape (T,): leg k ends at way-point k + 1.
    x, y : numpy.ndarray
        Positions north and east [m], shape (T,).
    """
    return _voyage(lambda *row: on_route(*row).off, points, legs, x, y)


def nearest_leg(points: np.ndarray, legs: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Legs that the distances of `off_route` are to, shape (T,)."""
    return np.asarray(legs) + _voyage(lambda *row: on_route(*row).nearest, points, legs, x, y)


def share_left(points: np.ndarray, leg: int, x: float, y: float) -> float:
    """Share of the length of a route that a ship on leg `leg` has yet to sail, 0 to 1."""
    lengths = np.hypot(*np.diff(points, axis=0).T)
    to_go = leg_axes(x, y, *points[leg], *points[leg + 1])
    left = min(max(to_go[2] - to_go[0], 0.0), lengths[leg]) + lengths[leg + 1 :].sum()
    return float(left / lengths.sum())


def _voyage(value: Callable, points, legs, x, y) -> np.ndarray:
    """`value` of position and way-points, as `on_route` takes them, at each instant."""
    legs = np.asarray(legs)
    about = [points[np.clip(legs + k, 0, len(points) - 1)] for k in (-1, 0, 1, 2)]
    return np.array([value(*row) for row in np.column_stack([x, y, *about]).tolist()])
