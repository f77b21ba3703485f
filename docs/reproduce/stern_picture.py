"""Bars of the force balance of KCS turning to both sides, as Stern et al. (2021) draw it."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from reproduce.stern_tables import LABELS
from reproduce.stern_turns import AXES
from ship_gym.plotting.figure import BLUE, FAINT, INK, RED, headline, picture

_NAMES = {"X": "surge X' [1e-3]", "Y": "sway Y' [1e-3]", "N": "yaw moment N' [1e-3]"}


def plot_sides(rows: list[dict[str, Any]], path: str | os.PathLike) -> None:
    """Draw every component to starboard and to port, and the excess to port below.

    Parameters
    ----------
    rows : list of dict
        Of ``stern_tables.balance``.
    path : path-like
        PNG file; an interrupted write leaves an existing one as it was.
    """
    with picture(path, 12.5, 6.4) as figure:
        headline(
            figure,
            "KCS: forces of the steady 35 deg turn to starboard and to port",
            "Fn 0.157; by 1/2 rho L d U^2 (N: L^2 d) with the steady speed; signs as to starboard",
        )
        grid = figure.subplots(2, 3, height_ratios=(1.5, 1.0))
        for column, axis in enumerate(AXES):
            mine = [row for row in rows if row["axis"] == axis]
            _sides(grid[0, column], mine)
            grid[0, column].set_title(_NAMES[axis])
            _excess(grid[1, column], mine)
        grid[0, 0].legend()
        grid[1, 0].set_title("magnitude to port less that to starboard [% of the mean]")


def _sides(axes: Axes, rows: list[dict[str, Any]]) -> None:
    places = np.arange(len(rows))
    for shift, side, colour in ((-0.2, "starboard", BLUE), (0.2, "port", RED)):
        axes.bar(places + shift, [row[side] for row in rows], 0.38, color=colour, label=side)
    _finish(axes, rows)


def _excess(axes: Axes, rows: list[dict[str, Any]]) -> None:
    values = [row["difference_percent"] for row in rows]
    bars = axes.bar(range(len(rows)), values, 0.5, color=FAINT)
    axes.bar_label(bars, fmt="%+.1f", fontsize=8, padding=2)
    axes.margins(y=0.2)
    _finish(axes, rows)


def _finish(axes: Axes, rows: list[dict[str, Any]]) -> None:
    axes.axhline(0.0, color=INK, linewidth=0.8)
    axes.set_xticks(range(len(rows)), [LABELS[row["component"]] for row in rows])
    axes.grid(False, axis="x")
