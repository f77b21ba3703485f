"""What the viewer shows of a trajectory: 3-D view, plan, plots, a page; drawn from its columns."""

from __future__ import annotations

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from ship_gym.recording import hull_shape, plan, scene
from ship_gym.recording.card import run_name
from ship_gym.recording.marks import marks
from ship_gym.recording.panels import motion_panels, steering_panels
from ship_gym.recording.rerun_export.annotations import send_card, send_marks, send_points
from ship_gym.recording.rerun_export.blueprint import (
    FOLLOWED,
    blueprint,
    latest,
    plan_view,
    scene_view,
    text_views,
    whole,
)
from ship_gym.recording.rerun_export.earth_map import send_map
from ship_gym.recording.rerun_export.log import Output, log, log_style
from ship_gym.recording.rerun_export.plots import marked_line, send_panels, with_near_limits
from ship_gym.recording.rerun_export.rows import changes, send_chosen, shown_rows, slow_rows
from ship_gym.recording.rerun_export.water import send_water
from ship_gym.recording.route import corridor_lines, corridor_of, legs_near
from ship_gym.recording.trajectory import Trajectory
from ship_gym.recording.wave_grid import wave_grid

_TRACK, _GRID, _TICK = (240, 240, 235), (62, 78, 96), (255, 255, 255)
_CORRIDOR = (86, 130, 190)
_WHITE, _BRONZE, _STEEL = (226, 226, 220), (206, 160, 80), (120, 128, 138)
_FINE = 256.0  # turns of the hull, the rudder and the propeller are in parts of this


def send_picture(out: Output, trajectory: Trajectory) -> None:
    """Send all views of the rows of `trajectory` that `out` does not have yet."""
    columns, meta, live = trajectory.columns, trajectory.meta, out.area is not None
    t, ship = columns["t"], scene.ship_shape(meta)
    panels = steering_panels(columns, meta) + motion_panels(columns, out.largest, meta)
    if not live:
        panels = [with_near_limits(panel) for panel in panels]
    views = [rrb.Tabs(*text_views())]
    often = shown_rows(len(t), live)
    seldom = often & slow_rows(t, ship.L if ship else 200.0)
    if {"x", "y", "psi"} <= columns.keys():
        points = scene.positions(columns)
        length = ship.L if ship else max(0.05 * float(np.ptp(points, axis=0).max()), 1.0)
        _log_scene(out, trajectory, points, ship, length, often, seldom)
        corners = _log_plan(out, trajectory, points, ship, length, seldom)
        row, title = (-1, "Ship") if live else (0, _title(trajectory, length))
        earth = send_map(out, trajectory, length, seldom)
        maps = [] if earth is None else [earth]
        pages = rrb.Tabs(plan_view(*corners), *text_views(), *maps, active_tab=0)
        views = [scene_view(columns, length, row, title), pages]
    send_panels(out, t, often, seldom, panels)
    if out.fixed:
        if live:  # the marks of a run that is on come at its end
            send_card(out, trajectory)
        else:
            send_about(out, trajectory)
        out.stream.send_recording_name(run_name(meta))
        times = latest() if live else whole(t)
        blueprint(*times, views, panels, t, live).send(out.stream)
    out.sent = float(t[-1])


def send_about(out: Output, trajectory: Trajectory) -> None:
    """Send the card of a run, and its marks: a list, and points on the lines that are followed."""
    send_card(out, trajectory)
    send_marks(out, trajectory)
    found = marks(trajectory)
    for panel in steering_panels(trajectory.columns, trajectory.meta):
        line = marked_line(panel)
        if line is not None:
            send_points(out, trajectory["t"], panel, found, line)


def _title(trajectory: Trajectory, length: float) -> str:
    """What stands above the picture: the run, how it ended, and what surrounds the ship.

    The labels in the picture say that too, but not all themes show them well.
    """
    meta = trajectory.meta
    outcome = meta.get("outcome")
    run = run_name(meta) + (f": {outcome}" if outcome else "")
    around = [arrow.labels[0] for arrow in scene.flow_arrows(trajectory.columns, length, meta)]
    return ". ".join([run, ", ".join(around)]) if around else run


def _log_scene(out, trajectory: Trajectory, points, ship, length, often, seldom) -> None:
    columns, t = trajectory.columns, trajectory["t"]
    grid = wave_grid(trajectory.meta, length, _far(out, points, length))
    above = np.array([0.0, 0.0, -0.5 * grid.height - 0.004 * length])
    if out.fixed:
        log(out, "world", rr.ViewCoordinates.FRD)  # x north, y east, z down: right-handed
        log_compass(out, length, above)
        log_route(out, trajectory, above, length)
    send_water(out, grid, t, points, often)
    places, turns = scene.pose(columns)
    send_pose(out, "world/ship", t, often, places, turns)
    send_pose(out, "world/at_ship", t, often, points)
    _log_wake(out, trajectory, points, above, seldom)
    if ship is not None:
        _log_ship(out, columns, ship, seldom)
    for arrow in scene.arrows(columns, length, trajectory.meta):
        _log_arrow(out, t, arrow, length, above, seldom)


def _far(out: Output, points: np.ndarray, length: float) -> float:
    """How far the water goes on round the ship [m]."""
    area = points if out.area is None else out.area
    return float(np.ptp(area, axis=0).max()) + 25.0 * length


def send_pose(out: Output, path: str, t, chosen, places, turns=None) -> None:
    """Send places (T, 3) [m] and turns (T, 4) of an entity, in the rows in which they change."""
    turns = None if turns is None else np.round(turns * _FINE * 16.0) / (_FINE * 16.0)
    moved = changes(places) if turns is None else changes(places, turns)

    def rows(new):
        quaternion = {} if turns is None else {"quaternion": turns[new]}
        return rr.Transform3D.columns(translation=places[new], **quaternion)

    send_chosen(out, path, t, chosen & moved, rows)


def _send_turns(out: Output, path: str, t, chosen, place, angle: np.ndarray, axis: int) -> None:
    """Send turns by `angle` [rad], shape (T,), about an axis at a place that stays, (3,) [m]."""
    angle = np.round(angle * _FINE) / _FINE
    turns = scene.turned(angle, axis)
    places = np.broadcast_to(place, (len(t), 3))  # a static one would not count beside the turns

    def rows(new):
        return rr.Transform3D.columns(translation=places[new], quaternion=turns[new])

    send_chosen(out, path, t, chosen & changes(angle), rows)


def _log_wake(out, trajectory: Trajectory, points: np.ndarray, above, chosen) -> None:
    """Log the wake, just above the sea."""
    rows, pieces = scene.wake(points + above, chosen)
    if out.fixed:
        log_style(out, "world/wake", rr.LineStrips3D, colors=[_TRACK], radii=[-1.5])
    _send_pieces(out, "world/wake", trajectory["t"], rows, pieces, rr.LineStrips3D)


def log_route(out: Output, trajectory: Trajectory, above: np.ndarray, length: float) -> None:
    """Log the legs of a track near the ship, and its corridor: in the plan, and just above the sea.

    Nothing without way-points.
    """
    if not trajectory.meta.get("waypoints"):
        return
    waypoints = np.array(trajectory.meta["waypoints"], dtype=float)
    legs = legs_near(waypoints, scene.positions(trajectory.columns)[:, :2], length)
    if not len(legs.number):
        return
    _log_flat(out, "route", list(np.stack([legs.start, legs.end], axis=1)), _BRONZE, above, -1.0)
    corridor = corridor_of(trajectory.meta, legs)
    if corridor is not None:
        lines = [line for _, line in corridor_lines(legs, corridor)]
        _log_flat(out, "corridor", lines, _CORRIDOR, above, -0.6)


def _log_flat(out: Output, name: str, lines, color, above: np.ndarray, radius: float) -> None:
    """Log lines (2, 2) north and east [m] in the plan and above the sea."""
    flat = [plan.to_plan(line) for line in lines]
    log(out, f"plan/{name}", rr.LineStrips2D(flat, colors=color, radii=0.7 * radius))
    high = [np.column_stack([line, np.full(len(line), above[2])]) for line in lines]
    log(out, f"world/{name}", rr.LineStrips3D(high, colors=color, radii=radius))


def _send_pieces(out: Output, path: str, t, rows, pieces, archetype) -> None:
    """Send pieces of a track, each at the time of the row at which it ends."""
    chosen, order = np.zeros(len(t), dtype=bool), np.full(len(t), -1)
    chosen[rows], order[rows] = True, np.arange(len(rows))
    send_chosen(out, path, t, chosen, lambda new: archetype.columns(strips=pieces[order[new]]))


def log_compass(out, length: float, above: np.ndarray) -> None:
    """Log the compass ring, which moves with the ship but does not turn with it."""
    ring, names = scene.compass_ring(length)
    ring = rr.LineStrips3D([line + above for line in ring], colors=_TRACK, radii=-0.6)
    log(out, FOLLOWED, ring)
    names = rr.Points3D(
        names + above, labels=["N", "E", "S", "W"], colors=scene.COMPASS, radii=-1.0
    )
    log(out, f"{FOLLOWED}/names", names)


def _log_arrow(out, t: np.ndarray, arrow: scene.Arrow, length: float, above, chosen) -> None:
    """Log an arrow that moves with the ship but does not turn with it."""
    path = f"world/at_ship/{arrow.name}"
    fine = 0.002 * length
    vectors, origins = (np.round(a / fine) * fine for a in (arrow.vectors, arrow.origins + above))
    if out.fixed:
        style = {"colors": [arrow.color], "radii": [0.012 * length], "show_labels": [True]}
        log_style(out, path, rr.Arrows3D, **style)

    def rows(new):
        labels = {"labels": arrow.labels[new].tolist()} if arrow.labels.any() else {}
        return rr.Arrows3D.columns(vectors=vectors[new], origins=origins[new], **labels)

    send_chosen(out, path, t, chosen & changes(vectors, origins, arrow.labels), rows)


def _log_ship(out, columns, ship: scene.ShipShape, chosen) -> None:
    t, (stock, *plate) = columns["t"], scene.rudder_plate(ship)
    centre, *mesh = scene.propeller_mesh(ship)
    if out.fixed:
        sizes = (ship.L, ship.B, ship.d)
        log_solid(out, "world/ship/hull", hull_shape.hull_mesh(*sizes))
        log_solid(out, "world/ship/house", hull_shape.superstructure_mesh(*sizes), _WHITE)
        ahead = [[(0.5 * ship.L, 0.0, 0.0), (scene.RING * ship.L, 0.0, 0.0)]]
        log(out, "world/ship/ahead", rr.LineStrips3D(ahead, colors=_TRACK, radii=-1.0))
        log_solid(out, "world/ship/rudder", hull_shape.box_mesh(*plate), _STEEL)
        log_solid(out, "world/ship/propeller", mesh, _BRONZE)
    delta = columns.get("delta", np.zeros(len(t)))
    # The blade hangs aft of its stock: for delta > 0 its trailing edge goes to starboard, which
    # is a negative turn about z (down).
    _send_turns(out, "world/ship/rudder", t, chosen, stock, -delta, axis=2)
    turn = scene.propeller_angle(columns) if "n" in columns else np.zeros(len(t))
    _send_turns(out, "world/ship/propeller", t, chosen, centre, turn, axis=0)


def _log_plan(out, trajectory: Trajectory, points, ship, length: float, chosen):
    t, track = trajectory["t"], plan.to_plan(points)
    area = track if out.area is None else plan.to_plan(out.area)
    low, high = plan.plan_bounds(area, 1.5 * length)
    if out.fixed:
        _log_chart(out, ship, length, low, high)
    rows, pieces = scene.wake(track, chosen)
    _send_pieces(out, "plan/track", t, rows, pieces, rr.LineStrips2D)
    places = np.column_stack([track, np.zeros(len(t))])
    moved = np.zeros(len(t), dtype=bool)
    moved[rows] = True
    send_pose(out, "plan/ship", t, moved, places, scene.turned(trajectory["psi"], axis=2))
    return low, high


def _log_chart(out, ship, length: float, low, high) -> None:
    """Log what stays the same of the plan view: grid, outline of the ship."""
    log_grid(out, low, high)
    log_style(out, "plan/track", rr.LineStrips2D, colors=[_TRACK], radii=[-1.0])
    shape = (ship.L, ship.B, ship.d) if ship else (length, 0.2 * length, 0.1 * length)
    outline = plan.to_plan(hull_shape.deck_outline(*shape)[::3])
    log(out, "plan/ship", rr.LineStrips2D([outline], colors=_BRONZE, radii=-1.5))


def log_grid(out: Output, low: np.ndarray, high: np.ndarray) -> None:
    """Log the grid of the plan between two corners [m], with its numbers."""
    lines, places, labels = plan.grid_lines(low, high)
    log(out, "plan/grid", rr.LineStrips2D(lines, colors=_GRID, radii=-0.5, draw_order=-2.0))
    ticks = rr.Points2D(places, labels=labels, colors=_TICK, radii=-1.0, draw_order=-1.0)
    log(out, "plan/labels", ticks)


def log_solid(out, path: str, mesh, color=None) -> None:
    """Log a closed mesh, sharp-edged in one colour, or round in a hull's paint."""
    vertices, triangles, normals = hull_shape.flat_shaded(*mesh)
    if color is not None:
        look = {"albedo_factor": color}
    else:
        paint = scene.hull_colors(vertices, normals)
        shaded = hull_shape.smooth_shaded(vertices, normals, paint)
        vertices, triangles, normals, look = *shaded[:3], {"vertex_colors": shaded[3]}
    points = {"vertex_positions": vertices, "triangle_indices": triangles}
    log(out, path, rr.Mesh3D(**points, vertex_normals=normals, **look))
