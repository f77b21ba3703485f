"""Where a ship is on a leg, the bearing to steer, and when the next leg begins.

Line-of-sight guidance with a look-ahead distance and a circle of acceptance, after Fossen (2011),
Handbook of Marine Craft Hydrodynamics and Motion Control, section 10.3.
"""

from __future__ import annotations

import math

import numpy as np

from ship_gym.physics._kernel import kernel


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
    dx, dy = x_b - x_a, y_b - y_a
    length = math.sqrt(dx * dx + dy * dy)
    cos, sin = 1.0, 0.0
    if length > 0.0:  # not the cos and sin of the bearing: sin(pi) is not 0
        cos, sin = dx / length, dy / length
    along = cos * (x - x_a) + sin * (y - y_a)
    cross = cos * (y - y_a) - sin * (x - x_a)
    return along, cross, math.atan2(dy, dx), length


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
def passed(along, cross, length, radius):
    """1 if the way-point at the end of the leg is reached or passed, else 0.

    Reached: within the circle of acceptance (rim included). Passed: abeam or astern of the ship on
    the leg, so that a ship that misses the circle does not sail on for ever.

    Parameters
    ----------
    along, cross, length : float
        From `leg_position` [m].
    radius : float
        Radius of the circle of acceptance [m].
    """
    ahead = length - along
    return 1 if ahead <= 0.0 or ahead * ahead + cross * cross <= radius * radius else 0


def cross_track(points: np.ndarray, legs: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Cross-track errors [m] of a voyage, shape (T,).

    Parameters
    ----------
    points : numpy.ndarray
        Way-points north and east [m], shape (W, 2).
    legs : numpy.ndarray
        Active leg at each instant, shape (T,): leg k ends at way-point k + 1.
    x, y : numpy.ndarray
        Positions north and east [m], shape (T,).
    """
    ends = np.column_stack([x, y, points[legs], points[np.asarray(legs) + 1]]).tolist()
    return np.array([leg_position(*row)[1] for row in ends])
