"""Pictures of a benchmark from plain numbers: scores, profiles, wear, wave headings.

All are narrow, so that a page can set them beside each other and a telephone can show one.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

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
    picture,
)

_COLOURS = (BLUE, AMBER, TEAL, RED, VIOLET, SKY, "#8c6d31", "#c2578f", "#5b8c3a", "#3b3f8f")
_MARKERS = "osD^vPX*"
_WIDTH = 4.4  # of a picture [in]
_NOTHING = "constant"


class Range(NamedTuple):
    """A value with its interval; the ends are those of the value where there is none."""

    value: float
    low: float
    high: float


class Style(NamedTuple):
    """Colour and mark of a controller, the same in all pictures of a page."""

    colour: str
    marker: str


def styles(names: Sequence[str]) -> dict[str, Style]:
    """Styles by controller; the one that does nothing is faint."""
    others = [name for name in names if name != _NOTHING]
    found = {
        name: Style(_COLOURS[k % len(_COLOURS)], _MARKERS[k % len(_MARKERS)])
        for k, name in enumerate(others)
    }
    return found | {_NOTHING: Style(FAINT, "o")}


def plot_scores(
    scores: Mapping[str, Range], look: Mapping[str, Style], path: str | os.PathLike
) -> None:
    """Mean scores with intervals, the best at the top; lines at 0 and 100."""
    names = sorted(scores, key=lambda name: scores[name].value)
    with picture(path, 4.8, 0.9 + 0.28 * len(names)) as figure:
        axes = figure.add_subplot()
        for k, name in enumerate(names):
            found, style = scores[name], look[name]
            axes.plot([found.low, found.high], [k, k], color=style.colour)
            axes.plot(found.value, k, style.marker, color=style.colour, markersize=6)
        axes.set_yticks(range(len(names)), names)
        axes.set_ylim(-0.6, len(names) - 0.4)
        for level in (0.0, 100.0):
            axes.axvline(level, color=FAINT, linestyle=DASHED, linewidth=1.0, zorder=0)
        axes.set_xlabel("mean score: 0 doing nothing, 100 the reference")


def plot_profiles(
    ratios: Mapping[str, np.ndarray],
    look: Mapping[str, Style],
    path: str | os.PathLike,
    title: str = "",
) -> None:
    """Share of the episodes in which a controller is within a factor of the best one.

    Parameters
    ----------
    ratios : mapping
        Controller to its value over the best value of the same episode, infinite where it has
        none, shapes (n,).
    look : mapping
    path : path-like
    title : str
    """
    finite = {name: np.sort(each[np.isfinite(each)]) for name, each in ratios.items()}
    widest = max(float(np.quantile(each, 0.9)) for each in finite.values() if len(each))
    end = float(np.clip(widest, 1.5, 10.0))
    with picture(path, _WIDTH, 3.4) as figure:
        axes = figure.add_subplot()
        for name, steps in finite.items():
            share = np.arange(len(steps) + 1) / len(ratios[name])
            x = np.concatenate([[1.0], steps, [max(end, 1.0, *steps[-1:])]])
            y = np.append(share, share[-1])
            axes.plot(x, y, color=look[name].colour, label=name, drawstyle="steps-post")
        axes.set_xscale("log")
        axes.set_xlim(1.0, end)
        axes.set_ylim(0.0, 1.02)
        _plain_ticks(axes, end)
        axes.set_xlabel("within this factor of the episode's best")
        axes.set_ylabel("share of episodes")
        axes.set_title(title)
        _legend(figure, len(ratios))


def _plain_ticks(axes: Axes, end: float) -> None:
    """Factors as plain numbers on a logarithmic axis."""
    ticks = [t for t in (1, 1.1, 1.2, 1.3, 1.5, 1.75, 2, 2.5, 3, 4, 5, 7, 10) if t <= end * 1.001]
    if end > 2.0:
        ticks = [t for t in ticks if t not in (1.1, 1.2, 1.3, 1.75, 2.5, 7)]
    axes.set_xticks(ticks, [f"{t:g}" for t in ticks])
    axes.xaxis.set_minor_locator(NullLocator())


def _legend(figure: Figure, count: int, columns: int = 4) -> None:
    columns = min(count, columns)
    figure.legend(loc="outside lower center", ncols=columns, columnspacing=1.2, handlelength=1.6)


def plot_pareto(
    points: Mapping[str, tuple[Range, Range]],
    look: Mapping[str, Style],
    labels: tuple[str, str],
    path: str | os.PathLike,
    title: str = "",
    optimum: float | None = None,
) -> None:
    """Error against wear, a point for each controller; the line joins those that none beats.

    Parameters
    ----------
    points : mapping
        Controller to (wear, error).
    look : mapping
    labels : tuple of str
        Of the axes, with units.
    path : path-like
    title : str
    optimum : float, optional
        Error of the reference optimum, whose wear is not known.
    """
    with picture(path, _WIDTH, 3.4) as figure:
        axes = figure.add_subplot()
        front = pareto_front({name: (x.value, y.value) for name, (x, y) in points.items()})
        corners = sorted(points[name][0].value for name in front)
        heights = [min(y.value for x, y in points.values() if x.value <= c) for c in corners]
        axes.step(corners, heights, where="post", color=FAINT, linewidth=1.0, zorder=1)
        for name, (x, y) in points.items():
            colour, marker = look[name]
            axes.plot([x.low, x.high], [y.value, y.value], color=colour, linewidth=1.0)
            axes.plot([x.value, x.value], [y.low, y.high], color=colour, linewidth=1.0)
            axes.plot(x.value, y.value, marker, color=colour, label=name, linestyle="none")
        if optimum is not None:
            style = {"color": INK, "linestyle": DASHED, "linewidth": 1.0}
            axes.axhline(optimum, label="optimum", **style)
        _error_scale(axes, [y.value for _, y in points.values()])
        axes.set_xlabel(labels[0])
        axes.set_ylabel(labels[1])
        axes.set_title(title)
        _legend(figure, len(points) + (optimum is not None))


def _error_scale(axes: Axes, values: Sequence[float]) -> None:
    """Logarithmic where the errors span more than a factor of four: all stay apart."""
    if min(values) > 0.0 and max(values) > 4.0 * min(values):
        axes.set_yscale("log")
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.yaxis.set_minor_locator(NullLocator())


def pareto_front(points: Mapping[str, tuple[float, float]]) -> list[str]:
    """Names of the points that no other one equals or beats in both."""
    return [
        name
        for name, (x, y) in points.items()
        if not any(a <= x and b <= y and (a, b) != (x, y) for other, (a, b) in points.items())
    ]


def plot_polar(
    angles: np.ndarray,
    sectors: Mapping[str, np.ndarray],
    look: Mapping[str, Style],
    path: str | os.PathLike,
    title: str = "",
    label: str = "",
    limit: float = np.inf,
) -> None:
    """A measure by where the waves come from, as seen from the bridge.

    Parameters
    ----------
    angles : numpy.ndarray
        Middle of each sector, where waves come from: 0 ahead, 180 astern [deg], shape (m,).
    sectors : mapping
        Controller to its values, shape (m,); NaN: no episode.
    look : mapping
    path : path-like
    title : str
    label : str
        What the radius is.
    limit : float
        Largest radius; what is beyond runs out of the picture.
    """
    with picture(path, 3.3, 4.4) as figure:
        axes = figure.add_subplot(projection="polar")
        axes.set_theta_zero_location("N")
        axes.set_theta_direction(-1)
        axes.set_thetalim(0.0, np.pi)
        for name, values in sectors.items():
            style = look[name]
            theta = np.radians(angles)
            axes.plot(theta, values, color=style.colour, marker=style.marker, ms=4, label=name)
        axes.set_xticks(
            np.radians([0, 45, 90, 135, 180]), ["ahead", "bow", "beam", "quarter", "astern"]
        )
        largest = max(float(np.nanmax(values)) for values in sectors.values())
        axes.set_ylim(0.0, min(1.05 * largest, limit))
        axes.tick_params(axis="x", pad=7)
        axes.tick_params(axis="y", labelsize=7.5)
        axes.grid(linewidth=0.6)
        figure.suptitle(title, fontsize=9.5)
        axes.set_ylabel(label, labelpad=22)
        _legend(figure, len(sectors), 3)
