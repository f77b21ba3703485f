"""Picture of a recorded run: the plots that rerun's viewer shows, with the marks of the run."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from ship_gym.plotting.figure import DASHED, FAINT, INK, headline, picture
from ship_gym.recording.card import run_name
from ship_gym.recording.marks import Mark, marks
from ship_gym.recording.panels import Panel, motion_panels, steering_panels
from ship_gym.recording.trajectory import Trajectory

_COLUMNS = 2  # of plots
_DARK = 0.72  # largest brightness of a line that is read on white


def plot_run(trajectory: Trajectory, path: str | os.PathLike) -> None:
    """Draw all plots of a run over time.

    Parameters
    ----------
    trajectory : Trajectory
    path : path-like
        PNG file; an interrupted write leaves an existing one as it was.
    """
    columns, meta = trajectory.columns, trajectory.meta
    panels = steering_panels(columns, meta) + motion_panels(columns)
    rows = -(-len(panels) // _COLUMNS)
    with picture(path, 13.0, 1.0 + 2.1 * rows) as figure:
        headline(figure, run_name(meta), _details(trajectory))
        places = figure.subplots(rows, _COLUMNS, squeeze=False, sharex=True)
        found = marks(trajectory)
        for axes, panel in zip(places.T.ravel(), panels, strict=False):
            _plot(axes, trajectory["t"], panel, found)
        for axes in places.T.ravel()[len(panels) :]:
            axes.set_visible(False)
        for column in places.T:
            last = [axes for axes in column if axes.get_visible()][-1]
            last.set_xlabel("time [s]")
            last.tick_params(labelbottom=True)


def _details(trajectory: Trajectory) -> str:
    """How the run ended."""
    t, outcome = trajectory["t"], trajectory.meta.get("outcome")
    end = "" if outcome is None else f", {outcome}"
    return f"{t[-1] - t[0]:.0f} s{end}" + ("" if trajectory.complete else ", broken off")


def _plot(axes: Axes, t: np.ndarray, panel: Panel, found: Sequence[Mark]) -> None:
    for series in panel.series:
        axes.plot(
            t, series.values, color=_on_white(series.color), linewidth=1.1, label=series.label
        )
    for mark in found:
        style = {"color": INK if mark.kind in ("error", "failure") else FAINT, "linewidth": 0.8}
        axes.axvline(mark.time, linestyle=DASHED, zorder=0.5, **style)
    axes.set_title(panel.title)
    if len(panel.series) > 1:
        axes.legend(loc="upper right", ncols=3, frameon=True, framealpha=0.8, edgecolor="none")


def _on_white(color: tuple[int, int, int]) -> tuple[float, ...]:
    """A colour of the dark viewer, darkened where it would be too bright on paper."""
    rgb = np.array(color[:3]) / 255.0
    brightness = float(rgb @ (0.299, 0.587, 0.114))
    return tuple(rgb * min(1.0, _DARK / max(brightness, 1e-6)))
