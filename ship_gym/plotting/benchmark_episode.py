"""Pictures of single episodes of a benchmark: two controllers on the same seed."""

from __future__ import annotations

import os
from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes

from ship_gym.plotting.benchmark import Style
from ship_gym.plotting.figure import DASHED, FAINT, INK, picture
from ship_gym.recording.trajectory import Trajectory
from ship_gym.tasks.measures import full_scale_time


def plot_episode(
    sailed: Mapping[str, Trajectory],
    look: Mapping[str, Style],
    path: str | os.PathLike,
    title: str = "",
) -> None:
    """Heading error or, on a track, the way of the ship above; the rudder below.

    Parameters
    ----------
    sailed : mapping
        Controller to its recording, all of the same scenario, ship and seed.
    look : mapping
    path : path-like
    title : str
    """
    first = next(iter(sailed.values()))
    on_track = "waypoints" in first.meta
    with picture(path, 4.4, 4.6 if on_track else 3.6) as figure:
        grid = figure.add_gridspec(2, 1, height_ratios=[2.2, 1.0] if on_track else [1.0, 1.0])
        upper, lower = figure.add_subplot(grid[0]), figure.add_subplot(grid[1])
        for name, trajectory in sailed.items():
            style = {"color": look[name].colour, "linewidth": 1.1, "label": name}
            _draw_way(upper, trajectory, style) if on_track else _draw_error(
                upper, trajectory, style
            )
            minutes = full_scale_time(trajectory) / 60.0
            lower.plot(minutes, np.degrees(trajectory["delta"]), **style)
        _finish_way(upper, first) if on_track else upper.set_ylabel("heading error [deg]")
        lower.set_xlabel("time, full scale [min]")
        lower.set_ylabel("rudder [deg]")
        upper.set_title(title, fontsize=9)
        handles, labels = upper.get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=min(len(labels), 3))


def _draw_error(axes: Axes, trajectory: Trajectory, style: Mapping[str, object]) -> None:
    """Heading error over time; a cross where a limit ended the episode."""
    minutes = full_scale_time(trajectory) / 60.0
    error = np.degrees(trajectory["psi_error"])
    axes.plot(minutes, error, **style)
    if trajectory.meta["failed"]:
        axes.plot(minutes[-1], error[-1], "x", color=style["color"], markersize=8)


def _draw_way(axes: Axes, trajectory: Trajectory, style: Mapping[str, object]) -> None:
    """Way of the ship in her lengths, north up; a cross where a limit ended the episode."""
    L = trajectory.meta["ship"]["L"]
    north, east = trajectory["x"] / L, trajectory["y"] / L
    axes.plot(east, north, **style)
    if trajectory.meta["failed"]:
        axes.plot(east[-1], north[-1], "x", color=style["color"], markersize=8)


def _finish_way(axes: Axes, trajectory: Trajectory) -> None:
    """The route, its corridor where one is set, and equal scales."""
    L = trajectory.meta["ship"]["L"]
    points = np.array(trajectory.meta["waypoints"]) / L
    axes.plot(points[:, 1], points[:, 0], color=INK, linestyle=DASHED, linewidth=0.9, zorder=1)
    axes.plot(points[:, 1], points[:, 0], "o", color=FAINT, markersize=4, zorder=1, label="route")
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("east [L]")
    axes.set_ylabel("north [L]")
