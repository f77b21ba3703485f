"""Runs overlaid in one rerun file: ships in the colours of their lines, tracks, differences."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from typing import Any

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from ship_gym.recording import hull_shape, plan, scene
from ship_gym.recording.axes import free_corner, y_range
from ship_gym.recording.comparison import Run, common_times, panels, runs_of
from ship_gym.recording.comparison_card import comparison_card, sources, title
from ship_gym.recording.marks import marks
from ship_gym.recording.panel import Panel
from ship_gym.recording.rerun_export.annotations import CARD, MARKS
from ship_gym.recording.rerun_export.blueprint import (
    Packed,
    plan_view,
    scene_view,
    text_views,
    whole,
)
from ship_gym.recording.rerun_export.log import Output, clock, log, log_style, new_stream
from ship_gym.recording.rerun_export.picture import (
    log_compass,
    log_grid,
    log_route,
    log_solid,
    send_pose,
)
from ship_gym.recording.rerun_export.rows import send_chosen, shown_rows, slow_rows
from ship_gym.recording.rerun_export.rrd_file import COMPARISON, read_chunks
from ship_gym.recording.rerun_export.water import send_water
from ship_gym.recording.sealed import DamagedRecording, damage_told, seal
from ship_gym.recording.trajectory import Trajectory
from ship_gym.recording.wave_grid import wave_grid
from ship_gym.writing import atomic_path

_FORMAT, _HEAD = 1, "ShipGymComparison"
_WHITE = (240, 240, 235)
_GHOST = 120  # opacity of the other ships, of 255
_MOST_POINTS = 1000  # of a track
_EDGE = 25.0  # of the sea beyond the tracks [L]


def write_comparison(
    trajectories: Sequence[Trajectory],
    path: str | os.PathLike,
    names: Sequence[str] | None = None,
) -> None:
    """Write two or more runs, overlaid and aligned at their first rows, to one ``.rrd`` file.

    It is a picture and holds no record of its own: its head lists the runs with hashes of what they
    hold (``comparison_card.sources``), see `read_comparison`. The file is sealed as recordings are.

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
        The file cannot be written; names it.
    """
    data = _encoded(runs_of(trajectories, names))
    with atomic_path(path) as temporary:
        temporary.write_bytes(data)


def read_comparison(path: str | os.PathLike) -> dict[str, Any]:
    """Read what a comparison is of: ``kind`` "comparison" and ``sources``, a list of dicts.

    Raises
    ------
    DamagedRecording
        The file is not as it was written, or is no comparison.
    """
    for chunk in read_chunks(path):
        if chunk.entity_path == COMPARISON:
            with damage_told(path):
                head = json.loads(chunk.to_record_batch().column(f"{_HEAD}:json")[0][0].as_py())
                if not isinstance(head["sources"], list):
                    raise ValueError("its sources are no list")
                return head
    raise DamagedRecording(f"{path} is no comparison of runs")


def _encoded(runs: Sequence[Run]) -> bytes:
    """The file: the head as rerun encodes it, then the picture, sealed."""
    listed = sources(runs)
    # A viewer shares layout and axes between recordings of one id, so these runs have their own.
    stream = new_stream("_".join(["ship_gym", *(one["content"][:8] for one in listed)]))
    try:
        source = stream.binary_stream()
        out = Output(stream)
        head = json.dumps({"format": _FORMAT, "kind": "comparison", "sources": listed})
        column = rr.DynamicArchetype.columns(archetype=_HEAD, components={"json": [head]})
        rr.send_columns(COMPARISON[1:], [], column, recording=stream, strict=True)
        record = source.read() or b""
        _send_picture(out, runs)
        shown = source.read() or b""
    finally:
        stream.disconnect()
    return seal(record, shown)


def _send_picture(out: Output, runs: Sequence[Run]) -> None:
    length = _length(runs)
    low, high = _log_chart(out, runs, length)
    above = _log_sea(out, runs[0], _tracks(runs), length)
    log_route(out, runs[0].trajectory, above, length)
    for number, run in enumerate(runs):
        _log_run(out, run, number, length, above)
    found, less = panels(runs)
    alone = [[run.t for run in runs]] * len(found)
    shared = [[common_times(run, runs[0]) for run in runs[1:]]] * len(less)
    for panel, times in zip([*found, *less], [*alone, *shared], strict=True):
        _log_lines(out, panel, times)
    log(out, CARD, rr.TextDocument(comparison_card(runs), media_type="text/markdown"))
    _send_marks(out, runs)
    views = [scene_view(runs[0].trajectory.columns, 1.15 * length, 0, title(runs))]
    views.append(rrb.Tabs(plan_view(low, high), *text_views(), active_tab=0))
    axis, time_panel = whole(max((run.t for run in runs), key=lambda t: t[-1]))
    tabs = [
        rrb.Vertical(
            *(_plot_view(panel, t, axis) for panel, t in zip(*both, strict=True)), name=name
        )
        for both, name in (((found, alone), "Runs"), ((less, shared), "Differences"))
    ]
    pictures = rrb.Vertical(*views, row_shares=[3, 2])
    layout = rrb.Horizontal(pictures, rrb.Tabs(*tabs, active_tab=0), column_shares=[1, 1])
    out.stream.send_recording_name(title(runs))
    Packed(layout, time_panel, collapse_panels=True).send(out.stream)


def _length(runs: Sequence[Run]) -> float:
    """Length of the first run's ship, or what makes a ship visible [m]."""
    shape = scene.ship_shape(runs[0].trajectory.meta)
    extent = float(np.ptp(_tracks(runs), axis=0).max())
    return shape.L if shape else max(0.05 * extent, 1.0)


def _tracks(runs: Sequence[Run]) -> np.ndarray:
    """Places of all ships, shape (rows, 3) [m]."""
    return np.concatenate([scene.positions(run.trajectory.columns) for run in runs])


def _log_sea(out: Output, first: Run, tracks: np.ndarray, length: float) -> np.ndarray:
    """Log the water about the first ship, and the ring that the eye follows; a step above both."""
    far = float(np.ptp(tracks, axis=0).max()) + _EDGE * length
    grid = wave_grid(first.trajectory.meta, length, far)
    above = np.array([0.0, 0.0, -0.5 * grid.height - 0.004 * length])
    log(out, "world", rr.ViewCoordinates.FRD)  # x north, y east, z down: right-handed
    points, shown = scene.positions(first.trajectory.columns), shown_rows(len(first.t), False)
    send_water(out, grid, first.t, points, shown)
    log_compass(out, length, above)
    send_pose(out, "world/at_ship", first.t, shown, points)
    return above


def _log_chart(out: Output, runs: Sequence[Run], length: float) -> tuple[np.ndarray, np.ndarray]:
    """Log the grid of the plan, and give its corners."""
    low, high = plan.plan_bounds(plan.to_plan(_tracks(runs)), 1.5 * length)
    log_grid(out, low, high)
    return low, high


def _log_run(out: Output, run: Run, number: int, length: float, above: np.ndarray) -> None:
    """Log ship and track of one run in both views; all but the first ship are ghosts."""
    columns = run.trajectory.columns
    shape = scene.ship_shape(run.trajectory.meta)
    sizes = (shape.L, shape.B, shape.d) if shape else (length, 0.2 * length, 0.1 * length)
    path = f"world/runs/{number}"
    _log_ship(out, path, sizes, (*run.color, 255 if number == 0 else _GHOST))
    high = (0.25 + 0.1 * number) * length  # names of ships in one place do not hide each other
    label = rr.Points3D([[0.0, 0.0, -high]], labels=[run.name], colors=[_WHITE], radii=0.0)
    log(out, f"{path}/name", label)
    chosen = shown_rows(len(run.t), False)
    send_pose(out, path, run.t, chosen, *scene.pose(columns))
    points = scene.positions(columns)
    step = max(1, -(-len(points) // _MOST_POINTS))
    track = np.concatenate([points[:-1][::step], points[-1:]])
    strip = rr.LineStrips3D([track + above], colors=[run.color], radii=-1.2)
    log(out, f"world/tracks/{number}", strip)
    strip = rr.LineStrips2D([plan.to_plan(track)], colors=[run.color], radii=-1.0)
    log(out, f"plan/tracks/{number}", strip)
    outline = plan.to_plan(hull_shape.deck_outline(*sizes))
    path = f"plan/ships/{number}"
    log(out, path, rr.LineStrips2D([outline], colors=[run.color], radii=-1.2))
    flat = np.column_stack([plan.to_plan(points), np.zeros(len(points))])
    chosen &= slow_rows(run.t, length)
    send_pose(out, path, run.t, chosen, flat, scene.turned(columns["psi"], axis=2))


def _log_ship(out: Output, path: str, sizes: tuple, color: tuple) -> None:
    """Log hull and house in one colour."""
    log_solid(out, f"{path}/hull", hull_shape.hull_mesh(*sizes), color)
    log_solid(out, f"{path}/house", hull_shape.superstructure_mesh(*sizes), color)


def _log_lines(out: Output, panel: Panel, times: Sequence[np.ndarray]) -> None:
    """Log one line of a plot for each run, at the times of its rows."""
    for number, (series, t) in enumerate(zip(panel.series, times, strict=True)):
        path = f"{panel.path}/{number}"
        style = {"names": [series.label], "colors": [series.color], "widths": [1.6]}
        log_style(out, path, rr.SeriesLines, **style)

        def rows(new, values=series.values):
            return rr.Scalars.columns(scalars=values[new])

        send_chosen(out, path, t, shown_rows(len(t), False), rows)


def _plot_view(panel: Panel, times: Sequence[np.ndarray], axis) -> rrb.TimeSeriesView:
    """View of one plot: all of the runs, with several ticks, its legend where it hides least."""
    lines = [series.values for series in panel.series]
    ends = y_range(lines)
    longest = max(range(len(times)), key=lambda k: len(times[k]))
    corner = free_corner(times[longest], [lines[longest]], ends, len(lines))
    return rrb.TimeSeriesView(
        origin=f"/{panel.path}",
        name=panel.title,
        axis_x=rrb.TimeAxis(view_range=axis),
        axis_y=rrb.ScalarAxis(range=ends),
        plot_legend=rrb.PlotLegend(corner=getattr(rrb.Corner2D, corner)),
    )


def _send_marks(out: Output, runs: Sequence[Run]) -> None:
    """Send the marks of all runs as one log, with the name and in the colour of each."""
    found = sorted(
        (mark.time - run.trajectory["t"][0], number, mark)
        for number, run in enumerate(runs)
        for mark in marks(run.trajectory)
    )
    entries = rr.TextLog.columns(
        text=[f"{runs[number].name}: {mark.text}" for _, number, mark in found],
        level=[str(rr.TextLogLevel.INFO)] * len(found),
        color=[runs[number].color for _, number, _ in found],
    )
    times = clock([time for time, *_ in found])
    rr.send_columns(MARKS, [times], entries, recording=out.stream, strict=True)
