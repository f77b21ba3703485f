"""Picture of a recorded run: the plots that rerun's viewer shows, with the marks of the run."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from ship_gym.config import ConfigError
from ship_gym.plotting.figure import DASHED, FAINT, INK, headline, picture
from ship_gym.recording.axes import y_range
from ship_gym.recording.card import run_name
from ship_gym.recording.marks import Mark, marks
from ship_gym.recording.panel import Panel
from ship_gym.recording.panels import motion_panels, steering_panels
from ship_gym.recording.trajectory import Trajectory

_COLUMNS = 2  # of plots


def plot_run(trajectory: Trajectory, path: str | os.PathLike) -> None:
    """Draw all plots of a run over time.

    Parameters
    ----------
    trajectory : Trajectory
    path : path-like
        PNG file; an interrupted write leaves an existing one as it was.

    Raises
    ------
    ConfigError
        It has no column that is plotted.
    """
    columns, meta = trajectory.columns, trajectory.meta
    panels = steering_panels(columns, meta) + motion_panels(columns)
    if not panels:
        raise ConfigError(f"columns {trajectory.names}: nothing to plot")
    across = min(_COLUMNS, len(panels))
    rows = -(-len(panels) // across)
    with picture(path, 13.0, 1.0 + 2.1 * rows) as figure:
        headline(figure, run_name(meta), _details(trajectory))
        places = figure.subplots(rows, across, squeeze=False, sharex=True)
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
    """Lines as in the viewer; a label that several lines share is written once."""
    for series in panel.series:
        color = np.array(series.color) / 255.0
        axes.plot(t, series.values, color=color, linewidth=1.1, label=series.label)
    for mark in found:
        style = {"color": INK if mark.kind in ("error", "failure") else FAINT, "linewidth": 0.8}
        axes.axvline(mark.time, linestyle=DASHED, zorder=0.5, **style)
    lines = [series.values for series in panel.series if not series.limit]
    limits = [series.values for series in panel.series if series.limit]
    axes.set_ylim(y_range(lines, limits, panel.robust))
    axes.set_title(panel.title)
    handles, labels = axes.get_legend_handles_labels()
    named = dict(zip(labels, handles, strict=True))
    if len(named) > 1:
        style = {"frameon": True, "framealpha": 0.8, "edgecolor": "none"}
        axes.legend(named.values(), named.keys(), loc="best", **style)
