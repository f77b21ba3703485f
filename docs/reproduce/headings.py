"""Picture of docs/seaway.md: ships in waves, stopped, left to themselves and under an autopilot."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from ship_gym.plotting.figure import (
    AMBER,
    BLUE,
    DASHED,
    FAINT,
    INK,
    RED,
    TEAL,
    headline,
    picture,
)
from ship_gym.recording.trajectory import Trajectory

_RUNS = (RED, AMBER, TEAL, BLUE)


@dataclasses.dataclass(frozen=True)
class HeadingRun:
    """Three ships in waves from one direction; they lie to the north at first.

    Attributes
    ----------
    wave_from_deg : float
        Where the waves come from, from north [deg].
    stopped, free, steered : Trajectory
        At rest with the engine stopped, under way with the rudder amidships, under an autopilot.
    """

    wave_from_deg: float
    stopped: Trajectory
    free: Trajectory
    steered: Trajectory


def plot_headings(
    runs: Sequence[HeadingRun], path: str | os.PathLike, heading: str, details: str
) -> None:
    """Draw ships in waves: stopped, under way with the rudder amidships, and under an autopilot.

    Parameters
    ----------
    runs : sequence of HeadingRun
        At most four, of one length.
    path : path-like
        PNG file; an interrupted write leaves an existing one as it was.
    heading, details : str
        Headline of the picture.
    """
    with picture(path, 13.0, 8.0) as figure:
        headline(figure, heading, details)
        axes = figure.subplots(3, 3, sharex=True, height_ratios=(2.2, 1.0, 1.0))
        for run, colour in zip(runs, _RUNS, strict=False):
            _drifting(axes[:, 0], run.stopped, run.wave_from_deg, colour)
            _drifting(axes[:, 1], run.free, run.wave_from_deg, colour)
            _steered(axes[:, 2], run.steered, colour)
        for column, what in enumerate(("engine stopped", "under way, rudder amidships")):
            axes[0, column].set_title(f"{what}: bow to waves [deg]")
            _relative_marks(axes[0, column])
        axes[0, 0].legend(title="waves from", loc="upper right")
        axes[0, 2].set_title("PID autopilot: heading psi [deg], ordered 0")
        axes[0, 2].set_ylim(-3.0, 3.0)
        for below in axes[1]:
            below.set_title("yaw moment of the wave drift [MN m]")
        for below in axes[2, :2]:
            below.set_title("yaw moment of the hull [MN m]")
        axes[2, 2].set_title("rudder delta [deg]")
        for below in axes[2]:
            below.set_xlabel("time t [min]")
            below.set_xlim(0.0, runs[0].free["t"][-1] / 60.0)


def bow_to_waves(psi: np.ndarray, wave_from_deg: float) -> np.ndarray:
    """Angle from the bow to where the waves come from [deg], 0 head to 180 following sea, (T,)."""
    return np.abs((wave_from_deg - np.degrees(psi) + 180.0) % 360.0 - 180.0)


def _relative_marks(axes: Axes) -> None:
    """Lines at beam-on, with the names of head, beam and following sea."""
    axes.axhline(90.0, color=INK, linewidth=0.8, linestyle=DASHED)
    axes.set_ylim(-8.0, 188.0)
    axes.set_yticks(np.arange(0.0, 181.0, 30.0))
    for angle, name in ((2.0, "head sea"), (92.0, "beam-on"), (182.0, "following sea")):
        axes.text(0.3, angle, name, fontsize=8, color=FAINT, va="bottom" if angle < 180 else "top")


def _drifting(axes: Sequence[Axes], t: Trajectory, wave_from_deg: float, colour: str) -> None:
    """Relative direction, and the minute means of the yaw moments of waves and hull."""
    minutes = t["t"] / 60.0
    angle = bow_to_waves(t["psi"], wave_from_deg)
    axes[0].plot(minutes, angle, color=colour, label=f"{wave_from_deg:.0f} deg")
    for below, name in zip(axes[1:], ("N_wave", "N_hull"), strict=True):
        below.plot(minutes, 1e-6 * _minute_mean(t, name), color=colour, linewidth=1.1)
        below.axhline(0.0, color=FAINT, linewidth=0.8, zorder=1.0)


def _steered(axes: Sequence[Axes], t: Trajectory, colour: str) -> None:
    """Heading with (thin) and without wave-frequency yaw, moment of the drift, and rudder."""
    minutes, psi = t["t"] / 60.0, np.degrees(t["psi"])
    seen = psi + np.degrees(t["wave_yaw"])
    axes[0].plot(minutes, seen, color=colour, linewidth=0.5, alpha=0.5)
    axes[0].plot(minutes, psi, color=colour)
    axes[1].plot(minutes, 1e-6 * _minute_mean(t, "N_wave"), color=colour, linewidth=1.1)
    axes[1].axhline(0.0, color=FAINT, linewidth=0.8, zorder=1.0)
    axes[2].plot(minutes, np.degrees(t["delta"]), color=colour, linewidth=0.5, alpha=0.5)
    axes[2].plot(minutes, np.degrees(_minute_mean(t, "delta")), color=colour)


def _minute_mean(t: Trajectory, name: str) -> np.ndarray:
    """Running mean of a column over one minute; rows are equally far apart."""
    width = max(1, round(60.0 / (t["t"][1] - t["t"][0])))
    width = min(width, len(t["t"]))
    count = np.convolve(np.ones(len(t["t"])), np.ones(width), "same")
    return np.convolve(t[name], np.ones(width), "same") / count
