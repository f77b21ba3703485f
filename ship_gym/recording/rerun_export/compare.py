"""Runs overlaid in one rerun file: ships in the colours of their lines, tracks, differences."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Sequence

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from ship_gym.provenance import atomic_path
from ship_gym.recording import hull_shape, plan, scene
from ship_gym.recording.comparison import Run, common_times, panels, runs_of
from ship_gym.recording.comparison_card import comparison_card, sources
from ship_gym.recording.marks import marks
from ship_gym.recording.panels import Panel
from ship_gym.recording.rerun_export.annotations import CARD, MARKS, marks_view
from ship_gym.recording.rerun_export.blueprint import whole
from ship_gym.recording.rerun_export.log import TIMELINE, Output, log, log_style, send_rows
from ship_gym.recording.rerun_export.rrd_file import read_chunks
from ship_gym.recording.sealed import DamagedRecording, seal
from ship_gym.recording.trajectory import Trajectory

_HEAD = "ShipGymComparison"
_SKY, _SEA = [150, 172, 190], (18, 66, 108)
_CHART, _GRID, _TICK, _ROUTE = [24, 32, 42], (62, 78, 96), (160, 172, 184), (206, 160, 80)
_GHOST = 120  # opacity of the other ships, of 255
_MOST_POINTS = 1000  # of a track
_EDGE = 15.0  # of the sea beyond the tracks [L]


def write_comparison(
    trajectories: Sequence[Trajectory],
    path: str | os.PathLike,
    names: Sequence[str] | None = None,
) -> None:
    """Write two or more runs, overlaid and aligned at their first rows, to one ``.rrd`` file.

    It is a picture and holds no record of its own: its head lists the runs with hashes of what they
    hold (``comparison_card.sources``), see `read_comparison`.

    Parameters
    ----------
    trajectories : sequence of Trajectory
        The first is what the others are compared with. Runs of other seeds, ships or settings are
        allowed, and the card says so.
    path : path-like
        File to write; an interrupted write leaves an existing one as it was.
    names : sequence of str, optional
        Of the runs; default: what tells them apart.

    Raises
    ------
    ConfigError
        Runs that cannot be compared, see ``comparison.runs_of``.
    OSError
        The file cannot be written.
    """
    runs = runs_of(trajectories, names)
    stream = rr.RecordingStream("ship_gym_comparison")
    try:
        source = stream.binary_stream()
        out = Output(stream)
        head = {"format": 1, "kind": "comparison", "sources": sources(runs)}
        _send_head(out, head)
        first = source.read() or b""
        _send_picture(out, runs)
        shown = source.read() or b""
    finally:
        stream.disconnect()
    with atomic_path(path) as temporary:
        temporary.write_bytes(seal(first, shown))


def read_comparison(path: str | os.PathLike) -> dict:
    """The head of a file of `write_comparison`, which is verified: format, kind, sources.

    Raises
    ------
    DamagedRecording
        If the file is not as it was written, or is no comparison.
    """
    for chunk in read_chunks(path):
        if chunk.entity_path == "/comparison":
            return json.loads(chunk.to_record_batch().column(f"{_HEAD}:json")[0][0].as_py())
    raise DamagedRecording(f"{path} is no comparison of recordings")


def _send_head(out: Output, head: dict) -> None:
    text = {"json": [json.dumps(head)]}
    columns = rr.DynamicArchetype.columns(archetype=_HEAD, components=text)
    rr.send_columns("comparison", [], columns, recording=out.stream, strict=True)


def _send_picture(out: Output, runs: list[Run]) -> None:
    length = _length(runs)
    log(out, "world", rr.ViewCoordinates.FRD)  # x north, y east, z down: right-handed
    _log_sea(out, runs, length)
    low, high = _log_chart(out, runs, length)
    for number, run in enumerate(runs):
        _log_run(out, run, number, length)
    found, less = panels(runs)
    for panel in found:
        _log_lines(out, panel, [run.t for run in runs])
    for panel in less:
        _log_lines(out, panel, [common_times(run, runs[0]) for run in runs[1:]])
    log(out, CARD, rr.TextDocument(comparison_card(runs), media_type="text/markdown"))
    _send_marks(out, runs)
    names = " against ".join(run.name for run in runs)
    out.stream.send_recording_name(names)
    out.stream.send_blueprint(_blueprint(runs, names, length, (low, high), found, less))


def _length(runs: Sequence[Run]) -> float:
    """Length of the first run's ship, or what makes a ship visible [m]."""
    shape = scene.ship_shape(runs[0].trajectory.meta)
    extent = float(np.ptp(_tracks(runs), axis=0).max())
    return shape.L if shape else max(0.05 * extent, 1.0)


def _tracks(runs: Sequence[Run]) -> np.ndarray:
    """Places of all ships, shape (rows, 3) [m]."""
    return np.concatenate([scene.positions(run.trajectory.columns) for run in runs])


def _log_sea(out: Output, runs: Sequence[Run], length: float) -> None:
    """Log a flat sea around all tracks."""
    points = _tracks(runs)
    low, high = points.min(axis=0) - _EDGE * length, points.max(axis=0) + _EDGE * length
    corners = [
        [low[0], low[1], 0],
        [high[0], low[1], 0],
        [high[0], high[1], 0],
        [low[0], high[1], 0],
    ]
    sea = rr.Mesh3D(
        vertex_positions=corners, triangle_indices=[[0, 2, 1], [0, 3, 2]], albedo_factor=_SEA
    )
    log(out, "world/sea", sea)


def _log_chart(out: Output, runs: Sequence[Run], length: float) -> tuple[np.ndarray, np.ndarray]:
    """Log grid and route of the plan, and give its corners."""
    low, high = plan.plan_bounds(plan.to_plan(_tracks(runs)), 1.5 * length)
    lines, places, texts = plan.grid_lines(low, high)
    log(out, "plan/grid", rr.LineStrips2D(lines, colors=_GRID, radii=-0.5, draw_order=-2.0))
    labels = rr.Points2D(places, labels=texts, colors=_TICK, radii=-1.0, draw_order=-1.0)
    log(out, "plan/labels", labels)
    route = runs[0].trajectory.meta.get("waypoints")
    if route:
        route = np.array(route, dtype=float)
        log(out, "plan/route", rr.LineStrips2D([plan.to_plan(route)], colors=_ROUTE, radii=-0.7))
        strip = np.column_stack([route, np.full(len(route), -0.002 * length)])
        log(out, "world/route", rr.LineStrips3D([strip], colors=_ROUTE, radii=-1.0))
    return low, high


def _log_run(out: Output, run: Run, number: int, length: float) -> None:
    """Log ship and track of one run in both views; all but the first ship are ghosts."""
    columns = run.trajectory.columns
    shape = scene.ship_shape(run.trajectory.meta)
    sizes = (shape.L, shape.B, shape.d) if shape else (length, 0.2 * length, 0.1 * length)
    color = (*run.color, 255 if number == 0 else _GHOST)
    path = f"world/runs/{number}"
    for name, mesh in (
        ("hull", hull_shape.hull_mesh(*sizes)),
        ("house", hull_shape.superstructure_mesh(*sizes)),
    ):
        vertices, triangles, normals = hull_shape.flat_shaded(*mesh)
        log(out, f"{path}/{name}", rr.Mesh3D(
            vertex_positions=vertices, triangle_indices=triangles, vertex_normals=normals,
            albedo_factor=color,
        ))  # fmt: skip
    high = (
        0.25 + 0.1 * number
    ) * length  # so that names of ships in one place do not hide each other
    name = rr.Points3D([[0.0, 0.0, -high]], labels=[run.name], colors=[run.color], radii=0)
    log(out, f"{path}/name", name)
    places, turns = scene.pose(columns)
    _send_pose(out, path, run.t, places, turns)
    track = scene.positions(columns)
    step = max(1, -(-len(track) // _MOST_POINTS))
    track = np.concatenate([track[:-1][::step], track[-1:]])
    above = np.array([0.0, 0.0, -0.002 * length])
    strip = rr.LineStrips3D([track + above], colors=[run.color], radii=-1.2)
    log(out, f"world/tracks/{number}", strip)
    strip = rr.LineStrips2D([plan.to_plan(track)], colors=[run.color], radii=-1.0)
    log(out, f"plan/tracks/{number}", strip)
    outline = plan.to_plan(hull_shape.deck_outline(*sizes))
    log(out, f"plan/ships/{number}", rr.LineStrips2D([outline], colors=[run.color], radii=-1.2))
    flat = np.column_stack([plan.to_plan(scene.positions(columns)), np.zeros(len(run.t))])
    _send_pose(out, f"plan/ships/{number}", run.t, flat, scene.turned(columns["psi"], axis=2))


def _send_pose(out: Output, path: str, t: np.ndarray, places, turns) -> None:
    def rows(new):
        return rr.Transform3D.columns(translation=places[new], quaternion=turns[new])

    send_rows(out, path, t, rows)


def _log_lines(out: Output, panel: Panel, times: Sequence[np.ndarray]) -> None:
    """Log one line of a plot for each run, at the times of its rows."""
    for number, (series, t) in enumerate(zip(panel.series, times, strict=True)):
        path = f"{panel.path}/{number}"
        style = {"names": [series.label], "colors": [series.color], "widths": [1.5]}
        log_style(out, path, rr.SeriesLines, **style)

        def rows(new, values=series.values):
            return rr.Scalars.columns(scalars=values[new])

        send_rows(out, path, t, rows)


def _send_marks(out: Output, runs: Sequence[Run]) -> None:
    """Send the marks of all runs as one log, with the name and in the colour of each."""
    found = sorted(
        (mark.time - run.trajectory["t"][0], number, mark)
        for number, run in enumerate(runs)
        for mark in marks(run.trajectory)
    )
    times = np.round(np.array([time for time, *_ in found]) * 1e9).astype("timedelta64[ns]")
    entries = rr.TextLog.columns(
        text=[f"{runs[number].name}: {mark.text}" for _, number, mark in found],
        level=[str(rr.TextLogLevel.INFO)] * len(found),
        color=[runs[number].color for _, number, _ in found],
    )
    clock = rr.TimeColumn(TIMELINE, duration=times)
    rr.send_columns(MARKS, [clock], entries, recording=out.stream, strict=True)


def _blueprint(runs, names: str, length: float, corners, found, less) -> rrb.Blueprint:
    """Ships above, plan with card and marks below; beside them the lines, in a tab differences."""
    longest = max(runs, key=lambda run: run.t[-1])
    axis, clock = whole(longest.t)
    (west, north), (east, south) = corners
    chart = rrb.Spatial2DView(
        origin="/plan",
        name="Plan, north up [m]",
        background=_CHART,
        visual_bounds=rrb.VisualBounds2D(x_range=(west, east), y_range=(north, south)),
    )
    card = rrb.TextDocumentView(origin=f"/{CARD}", name="Card")
    pages = rrb.Tabs(chart, card, marks_view(), active_tab=0)
    left = rrb.Vertical(_ships_view(runs, names, length), pages, row_shares=[3, 2])
    tabs = [
        rrb.Vertical(*_plot_views(which, axis), name=name)
        for which, name in ((found, "Runs"), (less, "Differences"))
    ]
    layout = rrb.Horizontal(left, rrb.Tabs(*tabs, active_tab=0), column_shares=[1, 1])
    return rrb.Blueprint(layout, clock, collapse_panels=True)


def _ships_view(runs: Sequence[Run], names: str, length: float) -> rrb.Spatial3DView:
    """Look over the first ship from astern, and stay with it."""
    columns = runs[0].trajectory.columns
    cosine, sine = np.cos(columns["psi"][0]), np.sin(columns["psi"][0])
    target = np.array([columns["x"][0], columns["y"][0], 0.0])
    aft, port, up = 1.6 * length, 1.1 * length, 1.0 * length
    eye = target + np.array([-aft * cosine + port * sine, -aft * sine - port * cosine, -up])
    return rrb.Spatial3DView(
        origin="/world",
        name=names,
        background=_SKY,
        line_grid=False,
        eye_controls=rrb.EyeControls3D(
            position=eye, look_target=target, eye_up=(0.0, 0.0, -1.0),
            tracking_entity="world/runs/0/hull",
        ),
    )  # fmt: skip


def _plot_views(which: Sequence[Panel], axis: rr.TimeRange) -> Iterator[rrb.TimeSeriesView]:
    for panel in which:
        yield rrb.TimeSeriesView(
            origin=f"/{panel.path}", name=panel.title, axis_x=rrb.TimeAxis(view_range=axis)
        )
