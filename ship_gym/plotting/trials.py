"""Picture of all trials: difference of each measure from the measured value, with its scatter."""

from __future__ import annotations

import os
from collections.abc import Sequence

from matplotlib.axes import Axes

from ship_gym.plotting.figure import BLUE, FAINT, INK, MEASURED, headline, picture
from ship_gym.reports.measures import DIRECTIONS, Row
from ship_gym.reports.trials import Comparison, summary_text

_LINE = 0.19  # inches for each measure
_WIDEST = 60.0  # percent beyond which a mark stands at the edge
_NAMES = -104.0  # where names begin


def plot_trials(
    found: Sequence[Comparison], path: str | os.PathLike, before: str = "before"
) -> None:
    """Draw every difference from a measured value in percent, beside the facilities' scatter.

    Parameters
    ----------
    found : sequence of Comparison
        Directions are left out: their difference is no share.
    path : path-like
        PNG file; an interrupted write leaves an existing one as it was.
    before : str
        What the open marks are, where there is another time.
    """
    shown = [each for each in found if each.row.name not in DIRECTIONS]
    trials = list(dict.fromkeys((each.ship, each.trial) for each in shown))
    height = 1.6 + _LINE * (len(shown) + 1.6 * len(trials))
    with picture(path, 10.5, height) as figure:
        headline(figure, "Every trial beside the model", summary_text(found).split(". ")[0])
        axes = figure.subplots()
        y = 0.0
        for ship, trial in trials:
            y += 1.6
            name = {"fontsize": 8, "fontweight": "bold", "color": INK, "va": "center"}
            axes.text(_NAMES, y - 0.85, f"{ship}   {trial}", **name, zorder=6)
            for each in shown:
                if (each.ship, each.trial) == (ship, trial):
                    _mark(axes, each, y)
                    y += 1.0
        _finish(axes, y, before if any(each.before for each in shown) else "")


def _mark(axes: Axes, each: Comparison, y: float) -> None:
    """One measure: scatter as a bar about zero, before open, now filled."""
    row = each.row
    assert row.measured is not None
    axes.text(_NAMES, y, f"    {row.label.strip()}", fontsize=8, va="center", zorder=6)
    if row.deviation:
        share = 100.0 * row.deviation / abs(row.measured)
        style = {"color": MEASURED, "elinewidth": 1.4, "capsize": 3.0, "zorder": 3}
        axes.errorbar(0.0, y, xerr=share, fmt="none", **style)
        axes.barh(y, 4.0 * share, 0.7, -2.0 * share, color=MEASURED, alpha=0.2, zorder=2)
    now = _inside(row)
    if each.before is not None:
        then = _inside(each.before)
        axes.plot([then, now], [y, y], color=FAINT, linewidth=0.9, zorder=3)
        style = {"markerfacecolor": "white", "markeredgecolor": FAINT}
        axes.plot(then, y, "o", markersize=5, **style, zorder=4)
    axes.plot(now, y, "D", color=BLUE, markersize=4.5, zorder=5)


def _inside(row: Row) -> float:
    assert row.difference is not None  # as it was measured
    return min(max(row.difference, -_WIDEST), _WIDEST)


def _finish(axes: Axes, y: float, before: str) -> None:
    """Axis, zero line and legend."""
    axes.axvline(0.0, color=MEASURED, linewidth=1.0, zorder=1)
    axes.set_xlim(_NAMES, _WIDEST * 1.04)
    axes.set_xticks([-60, -40, -20, 0, 20, 40, 60])
    axes.set_ylim(y + 0.2, 0.0)
    axes.set_yticks([])
    axes.spines["left"].set_visible(False)
    axes.set_xlabel("(computed - measured) / measured [%]; marks at the edge are beyond it")
    handles = [axes.plot([], [], "D", color=BLUE, markersize=4.5, label="computed")[0]]
    if before:
        style = {"markerfacecolor": "white", "markeredgecolor": FAINT, "color": FAINT}
        handles.append(axes.plot([], [], "o", markersize=5, label=before, **style)[0])
    bar = axes.errorbar([], [], xerr=[], fmt="none", color=MEASURED, capsize=3.0)
    bar.set_label("1 SD of the facilities; pale: 2 SD")
    axes.legend(handles=[*handles, bar], ncols=3, loc="lower right", bbox_to_anchor=(1.0, 1.0))
