"""Pictures of manoeuvres over time, of several seas and of measurements, one above the other."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes

from ship_gym.plotting.figure import (
    BLUE,
    DASHED,
    FAINT,
    INK,
    MEASURED,
    TEAL,
    headline,
    picture,
)
from ship_gym.reports.histories import History

CALM, WAVES, TRIAL = "calm", "waves", "trial"
_LINES = {
    CALM: {"color": BLUE, "linewidth": 1.6},
    WAVES: {"color": TEAL, "linewidth": 1.2, "linestyle": DASHED},
    TRIAL: {"color": MEASURED, "linewidth": 1.4},
}


class Curve(NamedTuple):
    """A history with its label; `kind` is `CALM`, `WAVES` or `TRIAL`."""

    label: str
    kind: str
    history: History


def plot_turns(curves: Sequence[Curve], title: str, details: str, path: str | os.PathLike) -> None:
    """Draw turning circles: tracks, and the speed over time.

    Parameters
    ----------
    curves : sequence of Curve
        Of either side; a label is shown once.
    title, details : str
    path : path-like
        PNG file; an interrupted write leaves an existing one as it was.
    """
    with picture(path, 9.5, 5.2) as figure:
        headline(figure, title, details)
        track, speed = figure.subplots(1, 2, width_ratios=(3, 2))
        for curve in curves:
            h = curve.history
            track.plot(h.y, h.x, label=curve.label, **_LINES[curve.kind])
            speed.plot(h.t, h.speed, **_LINES[curve.kind])
        track.plot(0.0, 0.0, "o", color=INK, markersize=4)
        track.set_aspect("equal", adjustable="datalim")
        track.set(xlabel="across the approach y [L]", ylabel="ahead x [L]")
        speed.set(xlabel="time t, full scale [s]", ylabel="speed over that of the approach [-]")
        speed.set_ylim(0.0, None)
        _legend(track)


def plot_zigzags(
    panels: Mapping[str, Sequence[Curve]], title: str, details: str, path: str | os.PathLike
) -> None:
    """Draw zig-zags, two panels in a row: heading, and fainter the rudder, over time.

    Parameters
    ----------
    panels : mapping
        Title of a panel to its curves; the rudder of the first one is drawn.
    title, details, path
        As of `plot_turns`.
    """
    rows = -(-len(panels) // 2)
    with picture(path, 9.5, 0.8 + 2.0 * rows) as figure:
        headline(figure, title, details)
        places = figure.subplots(rows, 2, squeeze=False).ravel()
        for axes, (name, curves) in zip(places, panels.items(), strict=False):
            _zigzag(axes, name, curves)
        for axes in places[len(panels) :]:
            axes.set_visible(False)
        for axes in places[max(0, len(panels) - 2) : len(panels)]:
            axes.set_xlabel("time t, full scale [s]")
        largest = max(panels.values(), key=len, default=())
        handles = [
            axes_line
            for curve in largest
            for axes_line in places[0].plot([], [], label=curve.label, **_LINES[curve.kind])
        ]
        handles += places[0].plot([], [], color=FAINT, linewidth=1.0, label="rudder, first curve")
        figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))


def _zigzag(axes: Axes, name: str, curves: Sequence[Curve]) -> None:
    axes.set_title(name)
    axes.axhline(0.0, color=FAINT, linewidth=0.8)
    end = 0.0
    for number, curve in enumerate(curves):
        h = curve.history
        axes.plot(h.t, np.degrees(h.psi), **_LINES[curve.kind])
        end = max(end, h.t[-1]) if curve.kind != TRIAL else end
        if number == 0:
            axes.plot(h.t, np.degrees(h.delta), color=FAINT, linewidth=1.0)
    axes.set(ylabel="heading [deg]", xlim=(0.0, end or None))


def _legend(axes: Axes) -> None:
    """Legend with each label once."""
    handles, labels = axes.get_legend_handles_labels()
    once = dict(zip(labels, handles, strict=True))
    axes.legend(once.values(), once.keys(), loc="best")
