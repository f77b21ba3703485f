"""Speed against the number of ships and of waves, and beside other simulators."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter

from ship_gym.plotting.figure import AMBER, BLUE, FAINT, INK, TEAL, VIOLET, picture
from ship_gym.reports.speed_text import by_name

_COLOURS = {"calm": TEAL, "waves": BLUE, "environment": VIOLET, "CartPole-v1": FAINT}


def plot_speed(data: dict[str, Any], path: str | os.PathLike) -> None:
    """Three panels of what ``ship-gym speed`` measured; one without numbers says so.

    Parameters
    ----------
    data : dict
        As in ``reports.speed_text.as_text``.
    path : path
        PNG file.
    """
    with picture(path, 12.0, 3.8) as figure:
        ships, waves, peers = figure.subplots(1, 3, width_ratios=(1.2, 0.9, 1.2))
        _ships(ships, by_name(data["growth"]))
        _waves(waves, by_name(data["waves"]))
        _peers(peers, [row for row in data["peers"] if row["seconds"]])


def _ships(axes: Axes, curves: dict[str, dict[int, float]]) -> None:
    axes.set(title="One step, one core", xlabel="ships", ylabel="processor time of one ship [us]")
    for name, curve in curves.items():
        counts = sorted(curve)
        axes.loglog(
            counts,
            [1e6 * curve[n] for n in counts],
            marker="o",
            markersize=3,
            color=_COLOURS.get(name, AMBER),
            label=name,
        )
    if curves:
        axes.legend()
    _plain(axes)


def _waves(axes: Axes, curves: dict[str, dict[int, float]]) -> None:
    axes.set(title="Physics in a sea", xlabel="regular waves of the sea", ylabel="[us]")
    for curve in curves.values():
        counts = sorted(curve)
        times = [1e6 * curve[n] for n in counts]
        axes.plot(counts, times, marker="o", markersize=3, color=BLUE)
        axes.set_ylim(0.0, 1.1 * max(times))
    if not curves:
        axes.text(0.5, 0.5, "not measured", transform=axes.transAxes, ha="center", color=FAINT)


def _peers(axes: Axes, rows: list[dict[str, Any]]) -> None:
    axes.set(title="A second at sea, calm", xlabel="processor time [us]")
    if not rows:
        axes.text(0.5, 0.5, "not measured", transform=axes.transAxes, ha="center", color=FAINT)
        return
    places = np.arange(len(rows))[::-1]
    times = [1e6 * row["seconds"] for row in rows]
    ours = [row["name"].startswith("Ship Gym") for row in rows]
    axes.barh(places, times, 0.6, color=[BLUE if own else FAINT for own in ours], log=True)
    for place, time in zip(places, times, strict=True):
        axes.annotate(
            f"{time:.3g}", (time, place), (3, 0), textcoords="offset points", va="center", color=INK
        )
    axes.set_yticks(places, [row["name"].replace(", ", "\n", 1) for row in rows])
    axes.set_xlim(min(times) / 4.0, max(times) * 5.0)
    axes.grid(False, axis="y")
    axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))


def _plain(axes: Axes) -> None:
    """Numbers, not powers of ten, on logarithmic axes."""
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(FuncFormatter(lambda x, _: _short(x)))


def _short(x: float) -> str:
    return f"{x / 1000:g} k" if x >= 1000.0 else f"{x:g}"
