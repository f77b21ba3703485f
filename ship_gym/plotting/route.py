"""A route on the earth: legs as they run, planned turns, limits."""

from __future__ import annotations

import itertools
import os

import numpy as np
from matplotlib.axes import Axes

from ship_gym.charts import geodesy
from ship_gym.plotting.figure import AMBER, BLUE, FAINT, picture
from ship_gym.tracks import Track

_PIECES = 60  # of a long leg, so that it bends as on the earth
_WIDTH, _TALLEST, _LOWEST = 9.0, 9.0, 3.5  # [in]
_CROWDED = 0.05  # of the size of the route; nearer way-points share one name


def plot_route(track: Track, path: str | os.PathLike) -> None:
    """Write a picture of a track that has a route, as PNG.

    East is drawn true to scale at the middle latitude; longitudes run on across 180 deg.
    """
    legs = np.repeat(np.arange(len(track.points) - 1), _pieces(track))
    share = np.concatenate([np.linspace(0.0, 1.0, n) for n in _pieces(track)])
    line = _places(track, legs, share, 0.0)
    middle = 0.5 * (line[0].min() + line[0].max())
    across = np.ptp(line[1]) * np.cos(np.radians(middle))
    height = np.clip(_WIDTH * np.ptp(line[0]) / max(across, 1e-9), _LOWEST, _TALLEST)
    assert track.route is not None
    with picture(path, _WIDTH, float(height)) as figure:
        axes = figure.subplots()
        axes.plot(line[1], line[0], color=BLUE)
        _limits(axes, track, legs, share)
        _waypoints(axes, track, line[1][0])
        axes.set_aspect(1.0 / np.cos(np.radians(middle)), adjustable="datalim")
        axes.xaxis.set_major_formatter(lambda x, _: f"{geodesy.wrap_longitude(x):.6g}")
        axes.set(xlabel="longitude [deg]", ylabel="latitude [deg]", title=track.route.name)


def _pieces(track: Track) -> np.ndarray:
    """How many places of each leg are drawn."""
    share = track.leg_lengths / track.total_length
    return np.clip(np.ceil(_PIECES * share), 2, _PIECES).astype(int)


def _places(track: Track, legs: np.ndarray, share: np.ndarray, aside: np.ndarray | float):
    """Latitude and continuous longitude [deg] along legs, `aside` [m] to starboard of them."""
    start, end = track.points[legs], track.points[legs + 1]
    bearing = track.leg_bearings[legs]
    north, east = (start + share[:, None] * (end - start)).T
    north, east = north - aside * np.sin(bearing), east + aside * np.cos(bearing)
    assert track.chart is not None
    latitude, longitude = track.chart.place(north, east, legs)
    return latitude, np.unwrap(longitude, period=360.0)


def _limits(axes: Axes, track: Track, legs: np.ndarray, share: np.ndarray) -> None:
    assert track.limits is not None  # as of every route
    for side, sign in enumerate((-1.0, 1.0)):
        limit = track.limits[legs, side]
        if np.isfinite(limit).any():
            latitude, longitude = _places(track, legs, share, sign * np.nan_to_num(limit))
            latitude[np.isnan(limit)] = np.nan
            axes.plot(longitude, latitude, color=FAINT, linewidth=0.8)


def _waypoints(axes: Axes, track: Track, first: float) -> None:
    assert track.route is not None
    points = track.route.waypoints
    turns = [geodesy.short_way(a.longitude, b.longitude) for a, b in itertools.pairwise(points)]
    longitude = first + np.concatenate([[0.0], np.cumsum(turns)])
    axes.plot(longitude, [p.latitude for p in points], "o", color=AMBER, markersize=4)
    apart = _CROWDED * max(np.ptp(longitude), np.ptp([p.latitude for p in points]))
    named: list[tuple[float, float]] = []
    for i, (point, x) in enumerate(zip(points, longitude.tolist(), strict=True)):
        if any(np.hypot(x - a, point.latitude - b) < apart for a, b in named):
            continue
        named.append((x, point.latitude))
        axes.annotate(
            point.name or str(i),
            (x, point.latitude),
            xytext=(5, 5),
            textcoords="offset points",
            fontsize=8,
        )
