"""Write a trajectory as a rerun recording and read it back; the only place that imports rerun.

The file is the record, not only a picture: entity ``/record`` holds every column as float64 and
``/record/meta`` the meta as JSON; the rest is what the viewer shows, drawn from them.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
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
            _fill(stream, trajectory)
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


def _fill(stream: rr.RecordingStream, trajectory: Trajectory) -> None:
    columns, ship = trajectory.columns, scene.ship_shape(trajectory.meta)
    steering, motion = steering_panels(columns), motion_panels(columns)
    spatial = {"x", "y", "psi"} <= columns.keys()
    stream.send_recording_name(run_name(trajectory.meta))
    _log_record(stream, trajectory)
    _log(stream, "about", rr.TextDocument(about_text(trajectory), media_type="text/markdown"))
    views = [rrb.TextDocumentView(origin="/about", name="About")]
    if spatial:
        points = scene.positions(columns)
        length = ship.L if ship else max(0.05 * float(np.ptp(points, axis=0).max()), 1.0)
        _log_scene(stream, trajectory, points, ship, length)
        corners = _log_plan(stream, trajectory, points, ship, length)
        views = [_scene_view(columns, length), rrb.Tabs(_plan_view(*corners), *views)]
    for panel in steering + motion:
        _log_panel(stream, columns["t"], panel)
    stream.send_blueprint(_blueprint(columns["t"], views, steering, motion))


def _log_record(stream: rr.RecordingStream, trajectory: Trajectory) -> None:
    head = {"format": _FORMAT, "columns": trajectory.names, "meta": trajectory.meta}
    text = {"json": json.dumps(head)}
    _log(stream, "record/meta", rr.DynamicArchetype(_HEAD, components=text))
    rows = rr.DynamicArchetype.columns(archetype=_COLUMN, components=trajectory.columns)
    _send(stream, "record", trajectory["t"], rows)


def _log_scene(stream, trajectory: Trajectory, points: np.ndarray, ship, length: float) -> None:
    columns, t = trajectory.columns, trajectory["t"]
    _log(stream, "world", rr.ViewCoordinates.FRD)  # x north, y east, z down: right-handed
    _log_sea(stream, trajectory, points, length)
    places, turns = scene.pose(columns)
    _send(stream, "world/ship", t, rr.Transform3D.columns(translation=places, quaternion=turns))
    _send(stream, "world/at_ship", t, rr.Transform3D.columns(translation=points))
    if ship is not None:
        _log_ship(stream, columns, ship)
    _log_marks(stream, columns, length)


def _log_sea(stream, trajectory: Trajectory, points: np.ndarray, length: float) -> None:
    """Log the sea with, just above it, the wake and the route of way-points."""
    centre, half = points.mean(axis=0), 0.5 * np.ptp(points, axis=0).max() + 15.0 * length
    corners = centre + half * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    faces = [[0, 2, 1], [0, 3, 2]]
    sea = rr.Mesh3D(vertex_positions=corners, triangle_indices=faces, albedo_factor=_SEA)
    _log(stream, "world/sea", sea)
    above = -0.002 * length
    rows, pieces = scene.wake(points + np.array([0.0, 0.0, above]))
    _log_style(stream, "world/wake", rr.LineStrips3D, colors=[_TRACK], radii=[-1.5])
    _send(stream, "world/wake", trajectory["t"][rows], rr.LineStrips3D.columns(strips=pieces))
    if trajectory.meta.get("waypoints"):
        route = np.array(trajectory.meta["waypoints"], dtype=float)
        route = np.column_stack([route[:, 0], route[:, 1], np.full(len(route), above)])
        _log(stream, "world/route", rr.LineStrips3D([route], colors=_BRONZE, radii=-1.0))


def _log_marks(stream, columns, length: float) -> None:
    """Log the compass ring and the arrows, which move with the ship but do not turn with it."""
    lift = np.array([0.0, 0.0, -0.01 * length])
    ring, names = scene.compass_ring(length)
    ring = rr.LineStrips3D([line + lift for line in ring], colors=_TRACK, radii=-0.6)
    _log(stream, _FOLLOWED, ring)
    names = rr.Points3D(names + lift, labels=["N", "E", "S", "W"], colors=_TRACK, radii=-1.0)
    _log(stream, f"{_FOLLOWED}/names", names)
    for arrow in scene.arrows(columns, length):
        path = f"world/at_ship/{arrow.name}"
        style = {"colors": [arrow.color], "radii": [0.012 * length], "labels": [arrow.label]}
        _log_style(stream, path, rr.Arrows3D, show_labels=True, **style)
        rows = rr.Arrows3D.columns(vectors=arrow.vectors, origins=arrow.origins + lift)
        _send(stream, path, columns["t"], rows)


def _log_ship(stream, columns, ship: scene.ShipShape) -> None:
    sizes, t = (ship.L, ship.B, ship.d), columns["t"]
    _log_solid(stream, "world/ship/hull", hull_shape.hull_mesh(*sizes))
    _log_solid(stream, "world/ship/house", hull_shape.superstructure_mesh(*sizes), _WHITE)
    ahead = [[(0.5 * ship.L, 0.0, 0.0), (scene.RING * ship.L, 0.0, 0.0)]]
    _log(stream, "world/ship/ahead", rr.LineStrips3D(ahead, colors=_TRACK, radii=-1.0))
    stock, low, high = scene.rudder_plate(ship)
    _log_solid(stream, "world/ship/rudder", hull_shape.box_mesh(low, high), _STEEL)
    delta = columns.get("delta", np.zeros(len(t)))
    # The blade hangs aft of its stock: for delta > 0 its trailing edge goes to starboard, which
    # is a negative turn about z (down).
    pose = {"translation": np.tile(stock, (len(t), 1)), "quaternion": scene.turned(-delta, axis=2)}
    _send(stream, "world/ship/rudder", t, rr.Transform3D.columns(**pose))
    centre, *mesh = scene.propeller_mesh(ship)
    _log_solid(stream, "world/ship/propeller", mesh, _BRONZE)
    turn = scene.propeller_angle(columns) if "n" in columns else np.zeros(len(t))
    pose = {"translation": np.tile(centre, (len(t), 1)), "quaternion": scene.turned(turn, axis=0)}
    _send(stream, "world/ship/propeller", t, rr.Transform3D.columns(**pose))


def _log_plan(stream, trajectory: Trajectory, points, ship, length: float):
    t, track = trajectory["t"], plan.to_plan(points)
    low, high = plan.plan_bounds(track, 1.5 * length)
    lines, places, labels = plan.grid_lines(low, high)
    _log(stream, "plan/grid", rr.LineStrips2D(lines, colors=_GRID, radii=-0.5, draw_order=-2.0))
    ticks = rr.Points2D(places, labels=labels, colors=_TICK, radii=-1.0, draw_order=-1.0)
    _log(stream, "plan/labels", ticks)
    rows, pieces = scene.wake(track)
    _log_style(stream, "plan/track", rr.LineStrips2D, colors=[_TRACK], radii=[-1.0])
    _send(stream, "plan/track", t[rows], rr.LineStrips2D.columns(strips=pieces))
    shape = (ship.L, ship.B, ship.d) if ship else (length, 0.2 * length, 0.1 * length)
    outline = plan.to_plan(hull_shape.deck_outline(*shape))
    _log(stream, "plan/ship", rr.LineStrips2D([outline], colors=_BRONZE, radii=-1.5))
    places = np.column_stack([track, np.zeros(len(t))])
    pose = {"translation": places, "quaternion": scene.turned(trajectory["psi"], axis=2)}
    _send(stream, "plan/ship", t, rr.Transform3D.columns(**pose))
    if trajectory.meta.get("waypoints"):
        route = plan.to_plan(np.array(trajectory.meta["waypoints"], dtype=float))
        _log(stream, "plan/route", rr.LineStrips2D([route], colors=_BRONZE, radii=-0.7))
    return low, high


def _log_solid(stream, path: str, mesh, color=None) -> None:
    """Log a closed mesh with sharp edges, in one colour or in a hull's paint."""
    vertices, triangles, normals = hull_shape.flat_shaded(*mesh)
    paint = np.array([color]) if color else scene.hull_colors(vertices, normals)
    _log(
        stream,
        path,
        rr.Mesh3D(
            vertex_positions=vertices,
            triangle_indices=triangles,
            vertex_normals=normals,
            vertex_colors=np.broadcast_to(paint, vertices.shape),
        ),
    )


def _log_panel(stream: rr.RecordingStream, t: np.ndarray, panel: Panel) -> None:
    """Log all lines of a plot as one entity, which is smaller and faster than one for each."""
    names, colors = [s.label for s in panel.series], [s.color for s in panel.series]
    _log(stream, panel.path, rr.SeriesLines(names=names, colors=colors, widths=[1.5] * len(names)))
    values = np.stack([series.values for series in panel.series], axis=1)
    rows = rr.Scalars.columns(scalars=values.ravel()).partition([values.shape[1]] * len(t))
    _send(stream, panel.path, t, rows)


def _log(stream: rr.RecordingStream, path: str, archetype) -> None:
    stream.log(path, archetype, static=True, strict=True)


def _log_style(stream: rr.RecordingStream, path: str, archetype: type, **style) -> None:
    """Log what stays the same of an entity whose geometry changes in time."""
    _log(stream, path, archetype.from_fields(**style))


def _send(stream: rr.RecordingStream, path: str, t: np.ndarray, columns: Iterable) -> None:
    clock = rr.TimeColumn(TIMELINE, duration=np.round(t * 1e9).astype("timedelta64[ns]"))
    rr.send_columns(path, [clock], columns, recording=stream, strict=True)


def _past() -> rrb.VisibleTimeRanges:
    """Show everything up to the time cursor, which makes a track grow."""
    start, end = rrb.TimeRangeBoundary.infinite(), rrb.TimeRangeBoundary.cursor_relative()
    return rrb.VisibleTimeRanges([rrb.VisibleTimeRange(TIMELINE, start=start, end=end)])


def _scene_view(columns, length: float) -> rrb.Spatial3DView:
    """Look over the ship from astern on its port side, and stay with it."""
    cosine, sine = np.cos(columns["psi"][0]), np.sin(columns["psi"][0])
    target = np.array([columns["x"][0], columns["y"][0], 0.0])
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


def _blueprint(t, views: list, steering: list[Panel], motion: list[Panel]) -> rrb.Blueprint:
    """Pictures on the left, steering in the middle, motion, forces and reward on the right."""
    plots = [
        rrb.Vertical(*(_plot_view(panel, t) for panel in panels))
        for panels in (steering, motion)
        if panels
    ]
    pictures = rrb.Vertical(*views, row_shares=[3, 2][: len(views)])
    shares = [4, 3, 3][: 1 + len(plots)]
    pace = max(1.0, float(np.round((t[-1] - t[0]) / 60.0)))  # the whole run in about a minute
    clock = rrb.TimePanel(state="collapsed", timeline=TIMELINE, playback_speed=pace)
    layout = rrb.Horizontal(pictures, *plots, column_shares=shares)
    return rrb.Blueprint(layout, clock, collapse_panels=True)


def _plot_view(panel: Panel, t: np.ndarray) -> rrb.TimeSeriesView:
    edge = rr.TimeRangeBoundary.absolute
    whole = rr.TimeRange(start=edge(seconds=t[0]), end=edge(seconds=t[-1]))
    return rrb.TimeSeriesView(
        origin=f"/{panel.path}",
        name=panel.title,
        axis_x=rrb.TimeAxis(view_range=whole),
        plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.LeftTop, visible=len(panel.series) > 1),
    )
