"""Fewer way-points of a route that was logged: those within a distance of the line go."""

from __future__ import annotations

import numpy as np

from ship_gym.charts import Chart
from ship_gym.config import ConfigError, check_number, shown
from ship_gym.tracks.route import Route
from ship_gym.tracks.waypoint import Leg


def simplified(route: Route, distance: float) -> Route:
    """The route without way-points that lie within a distance of the rest.

    Douglas & Peucker (1973), The Canadian Cartographer 10(2):112-122, in the plane of the route.
    For what a receiver has logged: a place each second is no route, since no leg is as long as its
    turns need.

    Parameters
    ----------
    route : Route
        Without radii and limits, as a logged track is; its legs become rhumb lines.
    distance : float
        [m], above 0.

    Raises
    ------
    ConfigError
        A way-point with a radius or a leg with limits: they would be lost; a distance of none.
    """
    check_number("simplify", distance, 1e-3, 1e6, "m")
    planned = [i for i, point in enumerate(route.waypoints) if point.radius]
    planned += [k + 1 for k, leg in enumerate(route.legs) if leg != Leg()]
    if planned:
        raise ConfigError(
            f"simplify = {distance:g} m: {shown(route.label(planned[0]), 60)} has a radius, or its "
            "leg limits, speeds or a great circle; allowed is a logged track without any"
        )
    chart = Chart.laid(
        [point.latitude for point in route.waypoints],
        [point.longitude for point in route.waypoints],
    )
    kept = _kept(np.stack([chart.north, chart.east], axis=-1), distance)
    return Route(route.name, tuple(route.waypoints[i] for i in np.flatnonzero(kept)))


def _kept(points: np.ndarray, distance: float) -> np.ndarray:
    """Which points (W, 2) [m] stay, bool (W,)."""
    kept = np.zeros(len(points), dtype=bool)
    kept[[0, -1]] = True
    parts = [(0, len(points) - 1)]  # a list and no recursion: a log has thousands of points
    while parts:
        first, last = parts.pop()
        if last - first < 2:
            continue
        off = _off(points[first + 1 : last], points[first], points[last])
        farthest = int(np.argmax(off))
        if off[farthest] > distance:
            middle = first + 1 + farthest
            kept[middle] = True
            parts += [(first, middle), (middle, last)]
    return kept


def _off(points: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Distances [m] of points from the piece between two places."""
    along = end - start
    square = float(along @ along)
    share = np.clip((points - start) @ along / square, 0.0, 1.0) if square > 0.0 else 0.0
    return np.linalg.norm(points - (start + np.multiply.outer(share, along)), axis=-1)
