"""The map of a run that has a chart: planned line, corridor, track and ship in degrees.

The file holds lines and points alone. The viewer fetches the map behind them from OpenStreetMap
while the tab is shown, so it is not the first one; without a network the ground stays empty.
"""

from __future__ import annotations

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
_MOST_POINTS = 1000  # of the track
_ROUTE, _CORRIDOR = (150, 96, 20), (40, 90, 200)
_TRACK, _SHIP = (20, 20, 20), (200, 30, 30)


def send_map(out: Output, trajectory: Trajectory, length: float, chosen) -> rrb.MapView | None:
    """Send the map and return its view; None of a run without a chart, or that is on."""
    chart = None if out.area is not None else chart_of(trajectory)
    if chart is None:
        return None
    lat, lon = sailed_places(trajectory, chart)
    _log_planned(out, trajectory, chart, length)
    step = max(1, -(-len(lat) // _MOST_POINTS))
    rows = np.append(np.arange(0, len(lat) - 1, step), len(lat) - 1)
    _log_lines(out, "track", parted_at_antimeridian(lat[rows], lon[rows]), _TRACK, -1.5)
    log_style(out, f"{MAP}/ship", rr.GeoPoints, colors=[_SHIP], radii=[-6.0])
    places = np.column_stack([lat, lon])

    def ship(new):
        return rr.GeoPoints.columns(positions=places[new])

    send_chosen(out, f"{MAP}/ship", trajectory["t"], chosen, ship)
    return rrb.MapView(origin=f"/{MAP}", name="Map")


def _log_planned(out: Output, trajectory: Trajectory, chart: Chart, length: float) -> None:
    """Log what of the route and its corridor is near the track."""
    if len(chart.north) < 2:
        return
    waypoints = np.column_stack([chart.north, chart.east])
    sailed = np.column_stack([trajectory["x"], trajectory["y"]])
    legs = legs_near(waypoints, sailed, length)
    ends = list(zip(legs.number.tolist(), np.stack([legs.start, legs.end], axis=1), strict=True))
    _log_lines(out, "route", _on_earth(ends, chart), _ROUTE, -1.5)
    corridor = corridor_of(trajectory.meta, legs) if len(legs.number) else None
    if corridor is not None:
        lines = _on_earth(corridor_lines(legs, corridor), chart)
        _log_lines(out, "corridor", lines, _CORRIDOR, -0.8)


def _on_earth(lines: list[tuple[int, np.ndarray]], chart: Chart) -> list[np.ndarray]:
    """Lines of the plane, each of one leg, in latitude and longitude [deg]."""
    if not lines:
        return []
    numbers = np.repeat([number for number, _ in lines], 2)
    lat, lon = chart.place(*np.concatenate([ends for _, ends in lines]).T, numbers)
    pairs = zip(lat.reshape(-1, 2), lon.reshape(-1, 2), strict=True)
    return [part for pair in pairs for part in parted_at_antimeridian(*pair)]


def _log_lines(out: Output, name: str, lines: list[np.ndarray], color, radius: float) -> None:
    if lines:
        strings = rr.GeoLineStrings(lat_lon=lines, colors=color, radii=radius)
        log(out, f"{MAP}/{name}", strings)
