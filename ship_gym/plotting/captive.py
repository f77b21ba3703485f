"""Picture of a captive test: coefficients over drift, rudder or yaw rate, measured ones marked."""

from __future__ import annotations

import math
import os

from matplotlib.axes import Axes

from ship_gym.captive import Condition
from ship_gym.plotting.figure import AMBER, BLUE, RED, SKY, TEAL, VIOLET, picture
from ship_gym.reports.captive import BASIS, CaptiveCase, title

_COLOURS = (BLUE, RED, TEAL, AMBER, VIOLET, SKY)
_FLAT = 1e-3  # of 1000 times a coefficient
_ABSCISSA = {
    "drift": "drift angle [deg]",
    "rudder": "rudder angle [deg]",
    "yaw": "yaw rate r L / U [-]",
    "yaw_drift": "yaw rate r L / U [-]",
}


def plot_captive(case: CaptiveCase, path: str | os.PathLike) -> None:
    """Draw the shown coefficients of a captive test to a PNG file: lines computed, dots measured.

    Parameters
    ----------
    case : reports.captive.CaptiveCase
    path : path-like
        PNG file; an interrupted write leaves an existing one as it was.
    """
    rows, columns = (2, 3) if len(case.shown) > 4 else (2, 2)
    with picture(path, 4.2 * columns, 6.6) as figure:
        lines = "lines computed, dots measured; " if case.measured else ""
        figure.suptitle(f"{title(case)}\n{lines}{BASIS}", fontsize=10, x=0.01, ha="left")
        panels = figure.subplots(rows, columns, sharex=True).ravel()
        for axes, name in zip(panels, case.shown, strict=True):
            _panel(axes, case, name)
        for axes in panels[-columns:]:
            axes.set_xlabel(_ABSCISSA[case.test])
        handles, labels = panels[0].get_legend_handles_labels()
        if labels:
            figure.legend(handles, labels, loc="outside right center")


def _panel(axes: Axes, case: CaptiveCase, name: str) -> None:
    axes.set_title(name)
    axes.axhline(0.0, color="#c5ccd2", linewidth=0.8)
    labels = [_group(case, run) for run in case.runs]
    for k, label in enumerate(dict.fromkeys(labels)):
        colour = _COLOURS[k % len(_COLOURS)]
        runs = sorted((i for i in range(len(labels)) if labels[i] == label), key=_order(case))
        x = [_x(case, case.runs[i]) for i in runs]
        axes.plot(x, [1e3 * case.computed[i][name] for i in runs], color=colour, label=label)
        dots = [i for i in runs if case.measured and name in case.measured[i]]
        values = [1e3 * case.measured[i][name] for i in dots]
        axes.plot([_x(case, case.runs[i]) for i in dots], values, "o", color=colour, ms=4)
    low, high = axes.get_ylim()
    if max(-low, high) < _FLAT:  # nothing but rounding
        axes.set_ylim(-1.0, 1.0)


def _order(case: CaptiveCase):
    return lambda i: _x(case, case.runs[i])


def _x(case: CaptiveCase, run: Condition) -> float:
    """Place of a run on the abscissa."""
    if case.test.startswith("yaw"):
        return run.yaw_rate
    return math.degrees(run.beta if case.test == "drift" else run.delta)


def _group(case: CaptiveCase, run: Condition) -> str:
    """Runs that belong on one line."""
    if case.test == "yaw_drift":
        return f"drift {math.degrees(run.beta):.0f} deg"
    if case.test == "drift":
        return "with rudder" if run.delta != 0.0 else "rudder amidships"
    J = run.speed / (run.n * case.ship.propeller.D) if run.n > 0.0 else math.inf
    return f"U / (n D) = {J:.2f}" if case.test == "rudder" else ""
