"""Work-precision diagram: error of the heading against the time of one ship and step."""

from __future__ import annotations

import os
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator, NullFormatter

from ship_gym.plotting.figure import (
    AMBER,
    BLUE,
    DASHED,
    FAINT,
    INK,
    RED,
    SKY,
    TEAL,
    VIOLET,
    headline,
    picture,
)
from ship_gym.reports.accuracy import LEG, LEGS, MEDIAN, NINETY, SHIPS, Point, conditions

_COLOURS = (BLUE, AMBER, TEAL, RED, VIOLET, SKY, INK)
_LIMITS = {"median": MEDIAN, "ninety": NINETY}
_NAMES = {"median": "median", "ninety": "90 %"}


def plot_accuracy(points: Sequence[Point], path: str | os.PathLike) -> None:
    """Draw median and 90 % of the error over the time of a step, a column for each condition.

    A line joins the step lengths of one ship; models are dashed, in the colour of their full scale.
    The default step has a large mark.

    Parameters
    ----------
    points : sequence of reports.accuracy.Point
    path : path-like
        PNG file; an interrupted write leaves an existing one as it was.
    """
    shown = [c for c in conditions() if any(p.condition == c.name for p in points)]
    families = list(dict.fromkeys(_family(p.ship) for p in points))
    colours = {name: _COLOURS[k % len(_COLOURS)] for k, name in enumerate(families)}
    with picture(path, 1.5 + 3.6 * len(shown), 7.0) as figure:
        details = (
            f"largest heading error of each of {SHIPS} ships in {LEG * LEGS} default steps against "
            "1/32 of that step; marks from left to right: 2, 1 (large), 1/2, 1/4, 1/8 default steps"
        )
        headline(figure, "Error of the integration step and its cost", details)
        grid = figure.subplots(2, len(shown), squeeze=False, sharex=True, sharey="row")
        for column, condition in enumerate(shown):
            here = [p for p in points if p.condition == condition.name]
            for axes, size in zip(grid[:, column], _LIMITS, strict=True):
                _lines(axes, here, size, colours)
            grid[0, column].set_title(condition.title)
            grid[1, column].set_xlabel("processor time of a ship for one default step [us]")
        for axes, size in zip(grid[:, 0], _LIMITS, strict=True):
            axes.set_ylabel(f"heading error, {_NAMES[size]} [deg]")
        grid[0, 0].legend(ncols=2, loc="upper right")


def _family(ship: str) -> str:
    return ship.removesuffix("_model")


def _lines(axes: Axes, points: Sequence[Point], size: str, colours: dict[str, str]) -> None:
    """The lines of one panel, and the error that the default step may have."""
    for ship in dict.fromkeys(p.ship for p in points):
        mine = [p for p in points if p.ship == ship]
        x, y = [1e6 * p.seconds for p in mine], [max(getattr(p, size), 1e-6) for p in mine]
        style = {
            "color": colours[_family(ship)],
            "linestyle": "-" if _family(ship) == ship else DASHED,
        }
        axes.plot(x, y, **style, marker=".", markersize=3, linewidth=1.1, label=ship)
        default = [k for k, p in enumerate(mine) if p.fraction == 1.0]
        axes.plot([x[k] for k in default], [y[k] for k in default], "o", color=style["color"])
    axes.axhline(_LIMITS[size], color=FAINT, linestyle=DASHED, linewidth=1.0)
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_yscale("log")
