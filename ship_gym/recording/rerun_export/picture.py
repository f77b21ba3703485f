"""What the viewer shows of a trajectory: 3-D view, plan, plots, a page; drawn from its columns."""

from __future__ import annotations

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from ship_gym.recording import hull_shape, plan, scene
from ship_gym.recording.card import run_name
from ship_gym.recording.panels import Panel, motion_panels, steering_panels
from ship_gym.recording.rerun_export.annotations import send_card, send_marks
from ship_gym.recording.rerun_export.blueprint import (
    FOLLOWED,
    blueprint,
    latest,
    plan_view,
    scene_view,
    whole,
)
from ship_gym.recording.rerun_export.log import Output, log, log_style, send_pose, send_rows
from ship_gym.recording.trajectory import Trajectory

_TRACK, _SEA, _GRID, _TICK = (235, 235, 235), (18, 66, 108, 190), (70, 78, 88), (150, 160, 172)
_WHITE, _BRONZE, _STEEL = (226, 226, 220), (196, 150, 70), (120, 128, 138)


def send_picture(out: Output, trajectory: Trajectory) -> None:
    """Send all views of the rows of `trajectory` that `out` does not have yet."""
    columns, ship = trajectory.columns, scene.ship_shape(trajectory.meta)
    steering = steering_panels(columns, trajectory.meta)
    motion = motion_panels(columns, out.largest)
    views = [rrb.TextDocumentView(origin="/about", name="About")]
    if {"x", "y", "psi"} <= columns.keys():
        points = scene.positions(columns)
        length = ship.L if ship else max(0.05 * float(np.ptp(points, axis=0).max()), 1.0)
        _log_scene(out, trajectory, points, ship, length)
        corners = _log_plan(out, trajectory, points, ship, length)
        row = 0 if out.area is None else -1
        views = [scene_view(columns, length, row), rrb.Tabs(plan_view(*corners), *views)]
    for panel in steering + motion:
        _log_panel(out, columns["t"], panel)
    if out.fixed:
        send_card(out, trajectory)
        if out.area is None:  # of a run that is on, the marks come at its end
            send_marks(out, trajectory)
        out.stream.send_recording_name(run_name(trajectory.meta))
        times = whole(columns["t"]) if out.area is None else latest()
        out.stream.send_blueprint(blueprint(*times, views, steering, motion))
    out.sent = float(columns["t"][-1])


def send_about(out: Output, trajectory: Trajectory) -> None:
    """Send the card of a run, and its marks."""
    send_card(out, trajectory)
    send_marks(out, trajectory)


def _log_scene(out, trajectory: Trajectory, points: np.ndarray, ship, length: float) -> None:
    columns, t = trajectory.columns, trajectory["t"]
    if out.fixed:
        log(out, "world", rr.ViewCoordinates.FRD)  # x north, y east, z down: right-handed
        _log_sea(out, points if out.area is None else out.area, length)
        _log_compass(out, length)
    send_pose(out, "world/ship", t, *scene.pose(columns))
    send_rows(out, "world/at_ship", t, lambda new: rr.Transform3D.columns(translation=points[new]))
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
    log(out, "world/sea", sea)


def _log_wake(out, trajectory: Trajectory, points: np.ndarray, above: float) -> None:
    """Log the wake and the route of way-points, just above the sea."""
    rows, pieces = scene.wake(points + np.array([0.0, 0.0, above]))
    if out.fixed:
        log_style(out, "world/wake", rr.LineStrips3D, colors=[_TRACK], radii=[-1.5])
    times = trajectory["t"][rows]
    send_rows(out, "world/wake", times, lambda new: rr.LineStrips3D.columns(strips=pieces[new]))
    if out.fixed and trajectory.meta.get("waypoints"):
        route = np.array(trajectory.meta["waypoints"], dtype=float)
        route = np.column_stack([route[:, 0], route[:, 1], np.full(len(route), above)])
        log(out, "world/route", rr.LineStrips3D([route], colors=_BRONZE, radii=-1.0))


def _log_compass(out, length: float) -> None:
    """Log the compass ring, which moves with the ship but does not turn with it."""
    lift = _lift(length)
    ring, names = scene.compass_ring(length)
    ring = rr.LineStrips3D([line + lift for line in ring], colors=_TRACK, radii=-0.6)
    log(out, FOLLOWED, ring)
    names = rr.Points3D(names + lift, labels=["N", "E", "S", "W"], colors=_TRACK, radii=-1.0)
    log(out, f"{FOLLOWED}/names", names)


def _lift(length: float) -> np.ndarray:
    return np.array([0.0, 0.0, -0.01 * length])


def _log_arrow(out, t: np.ndarray, arrow: scene.Arrow, length: float) -> None:
    """Log an arrow that moves with the ship but does not turn with it."""
    path, origins = f"world/at_ship/{arrow.name}", arrow.origins + _lift(length)
    if out.fixed:
        style = {"colors": [arrow.color], "radii": [0.012 * length], "labels": [arrow.label]}
        log_style(out, path, rr.Arrows3D, show_labels=True, **style)

    def rows(new):
        return rr.Arrows3D.columns(vectors=arrow.vectors[new], origins=origins[new])

    send_rows(out, path, t, rows)


def _log_ship(out, columns, ship: scene.ShipShape) -> None:
    t, (stock, *plate) = columns["t"], scene.rudder_plate(ship)
    centre, *mesh = scene.propeller_mesh(ship)
    if out.fixed:
        sizes = (ship.L, ship.B, ship.d)
        _log_solid(out, "world/ship/hull", hull_shape.hull_mesh(*sizes))
        _log_solid(out, "world/ship/house", hull_shape.superstructure_mesh(*sizes), _WHITE)
        ahead = [[(0.5 * ship.L, 0.0, 0.0), (scene.RING * ship.L, 0.0, 0.0)]]
        log(out, "world/ship/ahead", rr.LineStrips3D(ahead, colors=_TRACK, radii=-1.0))
        _log_solid(out, "world/ship/rudder", hull_shape.box_mesh(*plate), _STEEL)
        _log_solid(out, "world/ship/propeller", mesh, _BRONZE)
    delta = columns.get("delta", np.zeros(len(t)))
    # The blade hangs aft of its stock: for delta > 0 its trailing edge goes to starboard, which
    # is a negative turn about z (down).
    places = np.tile(stock, (len(t), 1))
    send_pose(out, "world/ship/rudder", t, places, scene.turned(-delta, axis=2))
    turn = scene.propeller_angle(columns) if "n" in columns else np.zeros(len(t))
    places = np.tile(centre, (len(t), 1))
    send_pose(out, "world/ship/propeller", t, places, scene.turned(turn, axis=0))


def _log_plan(out, trajectory: Trajectory, points, ship, length: float):
    t, track = trajectory["t"], plan.to_plan(points)
    area = track if out.area is None else plan.to_plan(out.area)
    low, high = plan.plan_bounds(area, 1.5 * length)
    if out.fixed:
        _log_chart(out, trajectory, ship, length, low, high)
    rows, pieces = scene.wake(track)
    times = t[rows]
    send_rows(out, "plan/track", times, lambda new: rr.LineStrips2D.columns(strips=pieces[new]))
    places = np.column_stack([track, np.zeros(len(t))])
    send_pose(out, "plan/ship", t, places, scene.turned(trajectory["psi"], axis=2))
    return low, high


def _log_chart(out, trajectory: Trajectory, ship, length: float, low, high) -> None:
    """Log what stays the same of the plan view: grid, outline of the ship, route."""
    lines, places, labels = plan.grid_lines(low, high)
    log(out, "plan/grid", rr.LineStrips2D(lines, colors=_GRID, radii=-0.5, draw_order=-2.0))
    ticks = rr.Points2D(places, labels=labels, colors=_TICK, radii=-1.0, draw_order=-1.0)
    log(out, "plan/labels", ticks)
    log_style(out, "plan/track", rr.LineStrips2D, colors=[_TRACK], radii=[-1.0])
    shape = (ship.L, ship.B, ship.d) if ship else (length, 0.2 * length, 0.1 * length)
    outline = plan.to_plan(hull_shape.deck_outline(*shape))
    log(out, "plan/ship", rr.LineStrips2D([outline], colors=_BRONZE, radii=-1.5))
    if trajectory.meta.get("waypoints"):
        route = plan.to_plan(np.array(trajectory.meta["waypoints"], dtype=float))
        log(out, "plan/route", rr.LineStrips2D([route], colors=_BRONZE, radii=-0.7))


def _log_solid(out, path: str, mesh, color=None) -> None:
    """Log a closed mesh with sharp edges, in one colour or in a hull's paint."""
    vertices, triangles, normals = hull_shape.flat_shaded(*mesh)
    paint = np.array([color]) if color else scene.hull_colors(vertices, normals)
    log(
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
        log(out, panel.path, lines)
    values = np.stack([series.values for series in panel.series], axis=1)

    def rows(new):
        chosen = values[new]
        return rr.Scalars.columns(scalars=chosen.ravel()).partition([chosen.shape[1]] * len(chosen))

    send_rows(out, panel.path, t, rows)
