"""Force balance and drift of KCS turning to both sides, as Stern et al. (2021) draw them."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from reproduce.stern_tables import LABELS
from reproduce.stern_turns import AXES
from ship_gym.plotting.figure import BLUE, FAINT, INK, MEASURED, RED, headline, picture

_NAMES = {"X": "surge X' [1e-3]", "Y": "sway Y' [1e-3]", "N": "yaw moment N' [1e-3]"}


def plot_sides(data: dict[str, Any], path: str | os.PathLike) -> None:
    """Draw every component to starboard and to port, the excess to port, and drift on the hull.

    Parameters
    ----------
    data : dict
        Of ``stern_tables.as_dict``.
    path : path-like
        PNG file; an interrupted write leaves an existing one as it was.
    """
    with picture(path, 15.0, 6.4) as figure:
        headline(
            figure,
            "KCS: steady 35 deg turn to starboard and to port",
            "forces at Fn 0.157, by 1/2 rho L d U^2 (N: L^2 d) with the steady speed, signs as to "
            "starboard; drift at Fn 0.26",
        )
        grid = figure.add_gridspec(2, 4, height_ratios=(1.5, 1.0))
        for column, axis in enumerate(AXES):
            mine = [row for row in data["balance"] if row["axis"] == axis]
            upper, lower = (figure.add_subplot(grid[k, column]) for k in (0, 1))
            _sides(upper, mine)
            upper.set_title(_NAMES[axis])
            _excess(lower, mine)
            if column == 0:
                upper.legend()
                lower.set_title("port less starboard, sizes [% of the mean]")
        _drift(figure.add_subplot(grid[:, 3]), data["drift"])


def _drift(axes: Axes, rows: list[dict[str, Any]]) -> None:
    """Drift angle from AP to FP (Fig. 3), with what the text prints of it."""
    places = {"AP": -0.5, "midship": 0.0, "FP": 0.5}
    for row, colour in zip(rows, (BLUE, RED), strict=True):
        values = [row[k] for k in places]
        axes.plot(list(places.values()), values, color=colour, label=row["side"])
    style = {"color": MEASURED, "linestyle": "none", "markersize": 6}
    axes.plot([-0.5, 0.5], [40.0, -10.0], "D", label="printed, about", **style)
    axes.axhline(0.0, color=INK, linewidth=0.8)
    axes.set_title("drift angle along the hull [deg]")
    axes.set_xlabel("x/L, AP to FP [-]")
    axes.legend()


def _sides(axes: Axes, rows: list[dict[str, Any]]) -> None:
    places = np.arange(len(rows))
    for shift, side, colour in ((-0.2, "starboard", BLUE), (0.2, "port", RED)):
        axes.bar(places + shift, [row[side] for row in rows], 0.38, color=colour, label=side)
    _finish(axes, rows)


def _excess(axes: Axes, rows: list[dict[str, Any]]) -> None:
    # + 0.0 and no digit beyond the label's: a difference of nothing is no "-0.0" below the axis
    values = [round(row["difference_percent"], 1) + 0.0 for row in rows]
    bars = axes.bar(range(len(rows)), values, 0.5, color=FAINT)
    axes.bar_label(bars, fmt="%+.1f", fontsize=8, padding=2)
    axes.margins(y=0.2)
    _finish(axes, rows)


def _finish(axes: Axes, rows: list[dict[str, Any]]) -> None:
    axes.axhline(0.0, color=INK, linewidth=0.8)
    axes.set_xticks(range(len(rows)), [LABELS[row["component"]] for row in rows])
    axes.grid(False, axis="x")
