"""The planned turn of a route: an arc between two legs as short straight pieces."""

from __future__ import annotations

import math

import numpy as np

from ship_gym.charts import geodesy

SHORTEST_ARC = 5.0  # [m]; no piece of an arc or of a great circle is shorter
CLOSE = 0.5  # [m] between an arc and its pieces


def arc_places(before: np.ndarray, after: np.ndarray, turn: float) -> np.ndarray:
    """Places on an arc between the places where it touches two legs, without those.

    A circle of the Mercator projection, which keeps angles and, within an arc, lengths: across
    10 km at 60 deg of latitude its scale changes by 0.3 %.

    Parameters
    ----------
    before, after : array_like, shape (2,)
        Latitude and longitude [deg].
    turn : float
        Change of course [rad], positive to starboard, not 0.

    Returns
    -------
    numpy.ndarray, shape (P - 1, 2)
        Latitude and longitude [deg]; the P pieces are within 0.5 m of the arc.
    """
    y, y_there = geodesy.mercator([before[0], after[0]])
    east = geodesy.A * math.radians(geodesy.short_way(before[1], after[1]))
    chord, bearing = math.hypot(y_there - y, east), math.atan2(east, y_there - y)
    size = geodesy.scale(0.5 * (before[0] + after[0]))
    radius = chord / size / (2.0 * math.sin(0.5 * abs(turn)))
    widest = 2.0 * math.acos(1.0 - min(1.0, CLOSE / radius))
    count = min(math.ceil(abs(turn) / widest), int(radius * abs(turn) / SHORTEST_ARC))
    angle = turn * np.arange(1, max(1, count)) / max(1, count)
    part = chord * np.sin(0.5 * angle) / math.sin(0.5 * turn)
    course = bearing - 0.5 * turn + 0.5 * angle
    longitude = before[1] + np.degrees(part * np.sin(course) / geodesy.A)
    return np.stack(
        [
            geodesy.from_mercator(y + part * np.cos(course)),
            geodesy.wrap_longitude(longitude),
        ],
        axis=-1,
    )
