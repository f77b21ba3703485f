"""The map of a run that has a chart: planned line, corridor, track and ship in degrees.

The file holds lines and points alone. The viewer fetches the map behind them from OpenStreetMap
while the tab is shown, so it is not the first one; without a network the ground stays empty.
"""

from __future__ import annotations

from importlib.util import find_spec
from typing import NamedTuple

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from ship_gym.charts import Chart
from ship_gym.recording.earth import chart_of, parted_at_antimeridian, sailed_places
from ship_gym.recording.rerun_export.log import Output, log, log_style
from ship_gym.recording.rerun_export.rows import send_chosen
from ship_gym.recording.route import corridor_lines, corridor_of, legs_near
from ship_gym.recording.trajectory import Trajectory

MAP = "map"
_VIEW, _CLOSEST = (2.4, 1.2), 17.0  # width and height by 256 points; the largest zoom
_MOST_POINTS = 1000  # of the track
# seen on the light map and on the dark ground without one
_ROUTE, _CORRIDOR = (190, 130, 40), (70, 120, 200)
_TRACK, _SHIP = (200, 60, 160), (220, 40, 40)


def send_map(out: Output, trajectory: Trajectory, length: float, chosen) -> rrb.MapView | None:
    """Send the map and return its view; None without a chart, while it runs, or without pyproj."""
    known = out.area is None and find_spec("pyproj") is not None  # else the rest is shown without
    chart = chart_of(trajectory) if known else None
    if chart is None:
        return None
    lat, lon = sailed_places(trajectory, chart)
    step = max(1, -(-len(lat) // _MOST_POINTS))
    rows = np.append(np.arange(0, len(lat) - 1, step), len(lat) - 1)
    lines = _planned(trajectory, chart, length)
    lines["track"] = _Lines(parted_at_antimeridian(lat[rows], lon[rows]), _TRACK, -1.5)
    for name, (strings, color, radius) in lines.items():
        shown = rr.GeoLineStrings(lat_lon=strings, colors=color, radii=radius)
        log(out, f"{MAP}/{name}", shown)
    log_style(out, f"{MAP}/ship", rr.GeoPoints, colors=[_SHIP], radii=[-6.0])
    places = np.column_stack([lat, lon])

    def ship(new):
        return rr.GeoPoints.columns(positions=places[new])

    send_chosen(out, f"{MAP}/ship", trajectory["t"], chosen, ship)
    zoom = _zoom(np.concatenate([line for one in lines.values() for line in one.strings]))
    return rrb.MapView(origin=f"/{MAP}", name="Map", zoom=zoom)


class _Lines(NamedTuple):
    """Lines of one kind: latitudes and longitudes [deg], shapes (P, 2), colour and radius."""

    strings: list[np.ndarray]
    color: tuple[int, int, int]
    radius: float


def _planned(trajectory: Trajectory, chart: Chart, length: float) -> dict[str, _Lines]:
    """What of the route and its corridor is near the track, by name."""
    found: dict[str, _Lines] = {}
    if len(chart.north) < 2:
        return found
    waypoints = np.column_stack([chart.north, chart.east])
    sailed = np.column_stack([trajectory["x"], trajectory["y"]])
    legs = legs_near(waypoints, sailed, length)
    if len(legs.number):
        ends = np.stack([legs.start, legs.end], axis=1)
        planned = list(zip(legs.number.tolist(), ends, strict=True))
        found["route"] = _Lines(_on_earth(planned, chart), _ROUTE, -1.5)
        corridor = corridor_of(trajectory.meta, legs)
        if corridor is not None:
            lines = _on_earth(corridor_lines(legs, corridor), chart)
            found["corridor"] = _Lines(lines, _CORRIDOR, -0.8)
    return found


def _zoom(places: np.ndarray) -> float:
    """Zoom at which all places are in the view; at 0 the earth is 256 points wide.

    The viewer has the middle of what is drawn in the middle of the view, but no zoom of its own.
    """
    lat, lon = places.T
    north = np.arctanh(np.sin(np.radians(np.clip(lat, -85.0, 85.0))))
    spans = np.ptp(lon) / 360.0 / _VIEW[0], np.ptp(north) / (2.0 * np.pi) / _VIEW[1]
    return float(np.clip(-np.log2(max(*spans, 1e-9)), 0.0, _CLOSEST))


def _on_earth(lines: list[tuple[int, np.ndarray]], chart: Chart) -> list[np.ndarray]:
    """Lines of the plane, each of one leg, in latitude and longitude [deg]."""
    numbers = np.repeat([number for number, _ in lines], 2)
    x, y = np.concatenate([ends for _, ends in lines]).T
    lat, lon = chart.place(x, y, numbers)
    pairs = zip(lat.reshape(-1, 2), lon.reshape(-1, 2), strict=True)
    return [part for pair in pairs for part in parted_at_antimeridian(*pair)]
