"""Write a trajectory as a rerun recording and read it back; the only place that imports rerun.

The file is the record, not only a picture: entity ``/record`` holds every column as float64 and
``/record/meta`` the meta as JSON; the rest is what the viewer shows, drawn from them.
A live view (``live.py``) sends the same, row by row.
"""

from __future__ import annotations

import json
import math
import os
import shutil
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from rerun.chunk import Chunk, RrdReader

from ship_gym.provenance import atomic_path
from ship_gym.recording import hull_shape, plan, scene
from ship_gym.recording.about import about_text, run_name
from ship_gym.recording.panels import Panel, motion_panels, steering_panels
from ship_gym.recording.trajectory import Trajectory

TIMELINE = "sim_time"
_FOLLOWED = "world/at_ship/compass"  # the eye follows only what can be drawn; its size sets how far
_FORMAT = 1  # of /record; a reader refuses what it does not know
# Prefixes keep our names apart from rerun's own, and from each other: within one process rerun
# remembers the type of every component name.
_COLUMN, _HEAD = "ShipGymColumn", "ShipGymHead"
_TRACK, _SEA, _GRID, _TICK = (235, 235, 235), (18, 66, 108, 190), (70, 78, 88), (150, 160, 172)
_WHITE, _BRONZE, _STEEL = (226, 226, 220), (196, 150, 70), (120, 128, 138)


@dataclass
class Output:
    """A stream and what of a run it has already.

    Attributes
    ----------
    stream : rr.RecordingStream
    sent : float
        Time of the last row that was sent [s].
    fixed : bool
        Whether to send what does not change in time, such as shapes, names and the blueprint.
    area : numpy.ndarray or None
        Corners of the sea of a live view [m], shape (k, 3); None: the run is known to its end.
    largest : dict or None
        Forces of a live view that set the units of its plots, as for ``panels.motion_panels``.
    """

    stream: rr.RecordingStream
    sent: float = -math.inf
    fixed: bool = True
    area: np.ndarray | None = None
    largest: dict[str, float] | None = None


def write_rrd(trajectory: Trajectory, path: str | os.PathLike) -> None:
    """Write `trajectory` to a ``.rrd`` file with its blueprint, without a viewer.

    Parameters
    ----------
    trajectory : Trajectory
        What to write; views whose columns are missing are left out.
    path : path-like
        File to write; it is replaced only by a complete file that was read back and compared.

    Raises
    ------
    OSError
        If the file that was written does not hold the trajectory, such as on a full disk.
    """
    with atomic_path(path) as temporary:
        stream = rr.RecordingStream(f"ship_gym_{trajectory.meta.get('task', 'run')}")
        try:
            stream.save(temporary)
            send(Output(stream), trajectory)
            stream.flush()
        finally:
            stream.disconnect()  # closes the file
        _check_written(temporary, trajectory)


def read_rrd(path: str | os.PathLike) -> tuple[dict[str, np.ndarray], dict[str, object]]:
    """Read the columns, each float64 of shape (T,), and the meta from a file of `write_rrd`.

    Parameters
    ----------
    path : path-like
        A ``.rrd`` file.

    Returns
    -------
    columns : dict of str to numpy.ndarray
        In their original order.
    meta : dict
        As it was given to the Trajectory.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If the file is not a recording of Ship Gym.
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"no recording {path}")
    try:
        chunks = RrdReader(path).stream().filter(content=["/record", "/record/meta"]).to_chunks()
    except (RuntimeError, ValueError, OSError) as error:
        raise ValueError(f"{path} is not a readable .rrd file: {error}") from error
    heads = [chunk for chunk in chunks if chunk.entity_path == "/record/meta"]
    if not heads:
        raise ValueError(f"{path} is a rerun file, but not a recording of Ship Gym")
    head = json.loads(heads[0].to_record_batch().column(f"{_HEAD}:json")[0][0].as_py())
    if head["format"] != _FORMAT:
        raise ValueError(f"{path} has recording format {head['format']}, not {_FORMAT}")
    rows = [chunk for chunk in chunks if chunk.entity_path == "/record"]
    return {name: _read_column(rows, name) for name in head["columns"]}, head["meta"]


def _read_column(chunks: list[Chunk], name: str) -> np.ndarray:
    """Join one column over its chunks; rerun's tools may have split and reordered the file."""
    times, values = [], []
    for chunk in chunks:
        batch = chunk.to_record_batch()
        if f"{_COLUMN}:{name}" in batch.schema.names:
            column = batch.column(f"{_COLUMN}:{name}")
            times.append(batch.column(TIMELINE).cast("int64").to_numpy()[column.is_valid()])
            values.append(column.flatten().to_numpy())
    order = np.argsort(np.concatenate(times), kind="stable")
    return np.concatenate(values)[order]


def _check_written(path: Path, trajectory: Trajectory) -> None:
    """Rerun writes in a thread that only warns, so look whether everything has arrived."""
    try:
        columns, meta = read_rrd(path)
    except (ValueError, KeyError) as error:
        raise OSError(f"the recording could not be written: {error}") from error
    same = list(columns) == trajectory.names and meta == trajectory.meta
    if not same or any(columns[k].tobytes() != trajectory[k].tobytes() for k in columns):
        raise OSError("the recording could not be written completely")


def open_stream(name: str, sink: str | None) -> rr.RecordingStream:
    """Open a stream of a live view.

    Parameters
    ----------
    name : str
        Application id.
    sink : str or None
        File to write, address ``rerun+http://...`` of a viewer, or None: open a viewer here, or use
        the one that is open.

    Raises
    ------
    RuntimeError
        If no viewer can be opened.
    """
    stream = rr.RecordingStream(name)
    if sink is None:
        program = shutil.which("rerun") or shutil.which("rerun", path=Path(sys.executable).parent)
        rr.spawn(recording=stream, executable_path=program)
    elif "://" in sink:
        stream.connect_grpc(sink)
    else:
        stream.save(sink)
    return stream


def send(out: Output, trajectory: Trajectory) -> None:
    """Send the rows of `trajectory` that `out` does not have yet, and all views of them."""
    columns, ship = trajectory.columns, scene.ship_shape(trajectory.meta)
    steering = steering_panels(columns, trajectory.meta)
    motion = motion_panels(columns, out.largest)
    views = [rrb.TextDocumentView(origin="/about", name="About")]
    _log_record(out, trajectory)
    if {"x", "y", "psi"} <= columns.keys():
        points = scene.positions(columns)
        length = ship.L if ship else max(0.05 * float(np.ptp(points, axis=0).max()), 1.0)
        _log_scene(out, trajectory, points, ship, length)
        corners = _log_plan(out, trajectory, points, ship, length)
        row = 0 if out.area is None else -1
        views = [_scene_view(columns, length, row), rrb.Tabs(_plan_view(*corners), *views)]
    for panel in steering + motion:
        _log_panel(out, columns["t"], panel)
    if out.fixed:
        send_about(out, trajectory)
        out.stream.send_recording_name(run_name(trajectory.meta))
        times = _whole(columns["t"]) if out.area is None else _latest()
        out.stream.send_blueprint(_blueprint(*times, views, steering, motion))
    out.sent = float(columns["t"][-1])


def send_about(out: Output, trajectory: Trajectory) -> None:
    """Send the page that says what was run."""
    _log(out, "about", rr.TextDocument(about_text(trajectory), media_type="text/markdown"))


def _log_record(out: Output, trajectory: Trajectory) -> None:
    if out.fixed:
        head = {"format": _FORMAT, "columns": trajectory.names, "meta": trajectory.meta}
        text = {"json": json.dumps(head)}
        _log(out, "record/meta", rr.DynamicArchetype(_HEAD, components=text))

    def rows(new):
        columns = {name: values[new] for name, values in trajectory.columns.items()}
        return rr.DynamicArchetype.columns(archetype=_COLUMN, components=columns)

    _send(out, "record", trajectory["t"], rows)


def _log_scene(out, trajectory: Trajectory, points: np.ndarray, ship, length: float) -> None:
    columns, t = trajectory.columns, trajectory["t"]
    if out.fixed:
        _log(out, "world", rr.ViewCoordinates.FRD)  # x north, y east, z down: right-handed
        _log_sea(out, points if out.area is None else out.area, length)
        _log_compass(out, length)
    _send_pose(out, "world/ship", t, *scene.pose(columns))
    _send(out, "world/at_ship", t, lambda new: rr.Transform3D.columns(translation=points[new]))
    _log_wake(out, trajectory, points, -0.002 * length)
    if ship is not None:
        _log_ship(out, columns, ship)
    for arrow in scene.arrows(columns, length):
        _log_arrow(out, t, arrow, length)


def _log_sea(out, area: np.ndarray, length: float) -> None:
    centre, half = area.mean(axis=0), 0.5 * np.ptp(area, axis=0).max() + 15.0 * length
    corners = centre + half * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    faces = [[0, 2, 1], [0, 3, 2]]
    sea = rr.Mesh3D(vertex_positions=corners, triangle_indices=faces, albedo_factor=_SEA)
    _log(out, "world/sea", sea)


def _log_wake(out, trajectory: Trajectory, points: np.ndarray, above: float) -> None:
    """Log the wake and the route of way-points, just above the sea."""
    rows, pieces = scene.wake(points + np.array([0.0, 0.0, above]))
    if out.fixed:
        _log_style(out, "world/wake", rr.LineStrips3D, colors=[_TRACK], radii=[-1.5])
    times = trajectory["t"][rows]
    _send(out, "world/wake", times, lambda new: rr.LineStrips3D.columns(strips=pieces[new]))
    if out.fixed and trajectory.meta.get("waypoints"):
        route = np.array(trajectory.meta["waypoints"], dtype=float)
        route = np.column_stack([route[:, 0], route[:, 1], np.full(len(route), above)])
        _log(out, "world/route", rr.LineStrips3D([route], colors=_BRONZE, radii=-1.0))


def _log_compass(out, length: float) -> None:
    """Log the compass ring, which moves with the ship but does not turn with it."""
    lift = _lift(length)
    ring, names = scene.compass_ring(length)
    ring = rr.LineStrips3D([line + lift for line in ring], colors=_TRACK, radii=-0.6)
    _log(out, _FOLLOWED, ring)
    names = rr.Points3D(names + lift, labels=["N", "E", "S", "W"], colors=_TRACK, radii=-1.0)
    _log(out, f"{_FOLLOWED}/names", names)


def _lift(length: float) -> np.ndarray:
    return np.array([0.0, 0.0, -0.01 * length])


def _log_arrow(out, t: np.ndarray, arrow: scene.Arrow, length: float) -> None:
    """Log an arrow that moves with the ship but does not turn with it."""
    path, origins = f"world/at_ship/{arrow.name}", arrow.origins + _lift(length)
    if out.fixed:
        style = {"colors": [arrow.color], "radii": [0.012 * length], "labels": [arrow.label]}
        _log_style(out, path, rr.Arrows3D, show_labels=True, **style)

    def rows(new):
        return rr.Arrows3D.columns(vectors=arrow.vectors[new], origins=origins[new])

    _send(out, path, t, rows)


def _log_ship(out, columns, ship: scene.ShipShape) -> None:
    t, (stock, *plate) = columns["t"], scene.rudder_plate(ship)
    centre, *mesh = scene.propeller_mesh(ship)
    if out.fixed:
        sizes = (ship.L, ship.B, ship.d)
        _log_solid(out, "world/ship/hull", hull_shape.hull_mesh(*sizes))
        _log_solid(out, "world/ship/house", hull_shape.superstructure_mesh(*sizes), _WHITE)
        ahead = [[(0.5 * ship.L, 0.0, 0.0), (scene.RING * ship.L, 0.0, 0.0)]]
        _log(out, "world/ship/ahead", rr.LineStrips3D(ahead, colors=_TRACK, radii=-1.0))
        _log_solid(out, "world/ship/rudder", hull_shape.box_mesh(*plate), _STEEL)
        _log_solid(out, "world/ship/propeller", mesh, _BRONZE)
    delta = columns.get("delta", np.zeros(len(t)))
    # The blade hangs aft of its stock: for delta > 0 its trailing edge goes to starboard, which
    # is a negative turn about z (down).
    places = np.tile(stock, (len(t), 1))
    _send_pose(out, "world/ship/rudder", t, places, scene.turned(-delta, axis=2))
    turn = scene.propeller_angle(columns) if "n" in columns else np.zeros(len(t))
    places = np.tile(centre, (len(t), 1))
    _send_pose(out, "world/ship/propeller", t, places, scene.turned(turn, axis=0))


def _log_plan(out, trajectory: Trajectory, points, ship, length: float):
    t, track = trajectory["t"], plan.to_plan(points)
    area = track if out.area is None else plan.to_plan(out.area)
    low, high = plan.plan_bounds(area, 1.5 * length)
    if out.fixed:
        _log_chart(out, trajectory, ship, length, low, high)
    rows, pieces = scene.wake(track)
    times = t[rows]
    _send(out, "plan/track", times, lambda new: rr.LineStrips2D.columns(strips=pieces[new]))
    places = np.column_stack([track, np.zeros(len(t))])
    _send_pose(out, "plan/ship", t, places, scene.turned(trajectory["psi"], axis=2))
    return low, high


def _log_chart(out, trajectory: Trajectory, ship, length: float, low, high) -> None:
    """Log what stays the same of the plan view: grid, outline of the ship, route."""
    lines, places, labels = plan.grid_lines(low, high)
    _log(out, "plan/grid", rr.LineStrips2D(lines, colors=_GRID, radii=-0.5, draw_order=-2.0))
    ticks = rr.Points2D(places, labels=labels, colors=_TICK, radii=-1.0, draw_order=-1.0)
    _log(out, "plan/labels", ticks)
    _log_style(out, "plan/track", rr.LineStrips2D, colors=[_TRACK], radii=[-1.0])
    shape = (ship.L, ship.B, ship.d) if ship else (length, 0.2 * length, 0.1 * length)
    outline = plan.to_plan(hull_shape.deck_outline(*shape))
    _log(out, "plan/ship", rr.LineStrips2D([outline], colors=_BRONZE, radii=-1.5))
    if trajectory.meta.get("waypoints"):
        route = plan.to_plan(np.array(trajectory.meta["waypoints"], dtype=float))
        _log(out, "plan/route", rr.LineStrips2D([route], colors=_BRONZE, radii=-0.7))


def _log_solid(out, path: str, mesh, color=None) -> None:
    """Log a closed mesh with sharp edges, in one colour or in a hull's paint."""
    vertices, triangles, normals = hull_shape.flat_shaded(*mesh)
    paint = np.array([color]) if color else scene.hull_colors(vertices, normals)
    _log(
        out,
        path,
        rr.Mesh3D(
            vertex_positions=vertices,
            triangle_indices=triangles,
            vertex_normals=normals,
            vertex_colors=np.broadcast_to(paint, vertices.shape),
        ),
    )


def _log_panel(out: Output, t: np.ndarray, panel: Panel) -> None:
    """Log all lines of a plot as one entity, which is smaller and faster than one for each."""
    if out.fixed:
        names, colors = [s.label for s in panel.series], [s.color for s in panel.series]
        lines = rr.SeriesLines(names=names, colors=colors, widths=[1.5] * len(names))
        _log(out, panel.path, lines)
    values = np.stack([series.values for series in panel.series], axis=1)

    def rows(new):
        chosen = values[new]
        return rr.Scalars.columns(scalars=chosen.ravel()).partition([chosen.shape[1]] * len(chosen))

    _send(out, panel.path, t, rows)


def _log(out: Output, path: str, archetype) -> None:
    """Log what does not change in time."""
    out.stream.log(path, archetype, static=True, strict=True)


def _log_style(out: Output, path: str, archetype: type, **style) -> None:
    """Log what stays the same of an entity whose geometry changes in time."""
    _log(out, path, archetype.from_fields(**style))


def _send(out: Output, path: str, t: np.ndarray, rows: Callable[[np.ndarray], Iterable]) -> None:
    """Send `rows` of the times that are new, a mask of shape (T,)."""
    new = t > out.sent
    if new.any():
        times = np.round(t[new] * 1e9).astype("timedelta64[ns]")
        clock = rr.TimeColumn(TIMELINE, duration=times)
        rr.send_columns(path, [clock], rows(new), recording=out.stream, strict=True)


def _send_pose(out: Output, path: str, t: np.ndarray, places, turns) -> None:
    def rows(new):
        return rr.Transform3D.columns(translation=places[new], quaternion=turns[new])

    _send(out, path, t, rows)


def _past() -> rrb.VisibleTimeRanges:
    """Show everything up to the time cursor, which makes a track grow."""
    start, end = rrb.TimeRangeBoundary.infinite(), rrb.TimeRangeBoundary.cursor_relative()
    return rrb.VisibleTimeRanges([rrb.VisibleTimeRange(TIMELINE, start=start, end=end)])


def _scene_view(columns, length: float, row: int) -> rrb.Spatial3DView:
    """Look over the ship from astern on its port side as it is in a row, and stay with it."""
    cosine, sine = np.cos(columns["psi"][row]), np.sin(columns["psi"][row])
    target = np.array([columns["x"][row], columns["y"][row], 0.0])
    aft, port, up = 1.3 * length, 1.0 * length, 0.75 * length
    eye = target + np.array([-aft * cosine + port * sine, -aft * sine - port * cosine, -up])
    return rrb.Spatial3DView(
        origin="/world",
        name="Ship",
        background=[150, 172, 190],
        line_grid=rrb.LineGrid3D(spacing=length, color=[255, 255, 255, 40], stroke_width=1.0),
        eye_controls=rrb.EyeControls3D(
            position=eye, look_target=target, eye_up=(0.0, 0.0, -1.0), tracking_entity=_FOLLOWED
        ),
        overrides={"world/wake": _past()},
    )


def _plan_view(low: np.ndarray, high: np.ndarray) -> rrb.Spatial2DView:
    bounds = rrb.VisualBounds2D(x_range=(low[0], high[0]), y_range=(low[1], high[1]))
    name = "Plan, north up [m]"
    return rrb.Spatial2DView(
        origin="/plan", name=name, visual_bounds=bounds, overrides={"plan/track": _past()}
    )


def _whole(t: np.ndarray) -> tuple[rr.TimeRange, rrb.TimePanel]:
    """Time axis and clock of a run that is over: all of it, shown in about a minute."""
    edge = rr.TimeRangeBoundary.absolute
    pace = max(1.0, float(np.round((t[-1] - t[0]) / 60.0)))
    axis = rr.TimeRange(start=edge(seconds=t[0]), end=edge(seconds=t[-1]))
    return axis, rrb.TimePanel(state="collapsed", timeline=TIMELINE, playback_speed=pace)


def _latest() -> tuple[rr.TimeRange, rrb.TimePanel]:
    """Time axis and clock of a run that is on: everything up to the newest row."""
    edge = rr.TimeRangeBoundary
    axis = rr.TimeRange(start=edge.infinite(), end=edge.cursor_relative())
    return axis, rrb.TimePanel(state="collapsed", timeline=TIMELINE, play_state="following")


def _blueprint(
    axis: rr.TimeRange, clock: rrb.TimePanel, views: list, steering: list[Panel], motion
) -> rrb.Blueprint:
    """Pictures on the left, steering in the middle, motion, forces and reward on the right."""
    plots = [
        rrb.Vertical(*(_plot_view(panel, axis) for panel in panels))
        for panels in (steering, motion)
        if panels
    ]
    pictures = rrb.Vertical(*views, row_shares=[3, 2][: len(views)])
    shares = [4, 3, 3][: 1 + len(plots)]
    layout = rrb.Horizontal(pictures, *plots, column_shares=shares)
    return rrb.Blueprint(layout, clock, collapse_panels=True)


def _plot_view(panel: Panel, axis: rr.TimeRange) -> rrb.TimeSeriesView:
    return rrb.TimeSeriesView(
        origin=f"/{panel.path}",
        name=panel.title,
        axis_x=rrb.TimeAxis(view_range=axis),
        plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.LeftTop, visible=len(panel.series) > 1),
    )
