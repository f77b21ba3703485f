"""Named tracks for scenarios and benchmarks, in units of ship length.

All start at the origin with the first leg to the north, and a ship of turning radius 3 L can round
every way-point. Square and circle turn to starboard and end where they began.
"""

from __future__ import annotations

import math

import numpy as np

from ship_gym.config import check_known
from ship_gym.tracks.track import Track

Points = tuple[tuple[float, float], ...]

_CIRCLE_RADIUS, _CIRCLE_LEGS = 8.0, 24  # [L]; 24 turns of 15 deg


def _from_legs(length: float, bearings_deg: list[float]) -> Points:
    """Way-points of legs of one length on the given bearings."""
    points = [(0.0, 0.0)]
    for bearing in map(math.radians, bearings_deg):
        north, east = points[-1]
        points.append((north + length * math.cos(bearing), east + length * math.sin(bearing)))
    return tuple(points)


def _circle() -> Points:
    """Polygon whose way-points lie on a circle of 8 L; its legs come 0.07 L within it."""
    turn_deg = 360.0 / _CIRCLE_LEGS
    leg = 2.0 * _CIRCLE_RADIUS * math.sin(0.5 * math.radians(turn_deg))
    return _from_legs(leg, [turn_deg * i for i in range(_CIRCLE_LEGS)])


# Name to way-points (north, east) [L].
SHAPES: dict[str, Points] = {
    "straight": ((0.0, 0.0), (40.0, 0.0)),
    "zigzag": _from_legs(8.0, [0.0, 30.0, -30.0, 30.0, -30.0, 0.0]),
    "square": ((0.0, 0.0), (12.0, 0.0), (12.0, 12.0), (0.0, 12.0), (0.0, 0.0)),
    "circle": _circle(),
    "l_turn": ((0.0, 0.0), (15.0, 0.0), (15.0, 15.0)),
}


def shape_track(name: str, L: float = 1.0) -> Track:
    """Named track of `SHAPES` for a ship of length `L` [m]; unknown names are a ConfigError."""
    return Track(np.array(SHAPES[check_known("track", name, SHAPES)])).scaled(L)
