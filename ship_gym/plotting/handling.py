"""Pictures of crash stop, coasting, acceleration, pull-out and spiral."""

from __future__ import annotations

import os

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ship_gym.plotting.figure import BLUE, FAINT, RED, TEAL, headline, picture
from ship_gym.reports.handling import Handling, title
from ship_gym.reports.manoeuvre import CONDITION
from ship_gym.simulation import through_water
from ship_gym.stability import Spiral


def plot_handling(case: Handling, path: str | os.PathLike) -> None:
    """Draw a manoeuvre of ``reports.handling`` to a PNG file; an interrupted write changes none."""
    draw = {"pull_out": _pull_out, "spiral": _spiral}.get(case.manoeuvre, _speed_change)
    with picture(path, 9.5, 6.4) as figure:
        name, _, rest = title(case).partition(": ")
        what, condition = rest.split(CONDITION, 1)
        details = f"{condition}; hull set {case.ship.variant}, surrogate {case.ship.surrogate_name}"
        headline(figure, f"{name}: {what}", details)
        draw(figure, case)


def _history(axes: Axes, t: np.ndarray, label: str, *lines: tuple[np.ndarray, str, str]) -> None:
    for values, colour, name in lines:
        axes.plot(t, values, color=colour, label=name)
    axes.axhline(0.0, color=FAINT, linewidth=0.8)
    axes.set_ylabel(label)
    if len(lines) > 1:
        axes.legend(ncols=2, loc="best")


def _speed_change(figure: Figure, case: Handling) -> None:
    """Speed and propeller speed, surge forces and way over time."""
    t, L = case.result.trajectory, case.ship.hull.L
    upper, middle, lower = figure.subplots(3, 1, sharex=True)
    U = np.hypot(*through_water(t.columns))
    speeds = ((U / case.speed, BLUE, "speed U/U0"), (t["n"] / case.n, RED, "propeller n/n0"))
    _history(upper, t["t"], "by the approach [-]", *speeds)
    scale, unit = (1e-3, "kN") if np.abs(t["X_hull"]).max() > 1e4 else (1.0, "N")
    forces = ((t["X_hull"], BLUE, "hull"), (t["X_propeller"], TEAL, "propeller"))
    _history(middle, t["t"], f"surge force X [{unit}]", *((scale * f, c, n) for f, c, n in forces))
    _history(lower, t["t"], "way ahead x [L]", (t["x"] / L, BLUE, ""))
    if np.ptp(t["y"]) > 0.01 * L:
        lower.plot(t["t"], t["y"] / L, color=RED, label="to starboard y")
        lower.legend(loc="best")
    lower.set_xlabel("time t [s]")
    lower.set_xlim(0.0, t["t"][-1])


def _pull_out(figure: Figure, case: Handling) -> None:
    """Yaw rate, rudder and speed over time."""
    t = case.result.trajectory
    U = np.hypot(*through_water(t.columns))
    upper, middle, lower = figure.subplots(3, 1, sharex=True, height_ratios=(3, 1, 1))
    _history(upper, t["t"], "yaw rate r L/U [-]", (t["r"] * case.ship.hull.L / U, BLUE, ""))
    _history(middle, t["t"], "rudder [deg]", (np.degrees(t["delta"]), RED, ""))
    _history(lower, t["t"], "U/U0 [-]", (U / case.speed, BLUE, ""))
    lower.set_xlabel("time t [s]")
    lower.set_xlim(0.0, t["t"][-1])


def _spiral(figure: Figure, case: Handling) -> None:
    """Steady yaw rate over the rudder angle, both branches, and amidships enlarged."""
    assert isinstance(case.result, Spiral)
    delta, rate = np.degrees(case.result.delta), np.array(case.result.yaw_rate)
    half = len(delta) // 2
    whole, near = figure.subplots(1, 2)
    for axes in (whole, near):
        axes.plot(delta[:half], rate[:half], ".-", color=BLUE, label="rudder to port")
        axes.plot(delta[half:], rate[half:], ".-", color=RED, label="rudder to starboard")
        axes.axhline(0.0, color=FAINT, linewidth=0.8)
        axes.axvline(0.0, color=FAINT, linewidth=0.8)
        axes.set_xlabel("rudder angle [deg], starboard positive")
    whole.set_ylabel("steady yaw rate r L/U [-]")
    whole.legend(loc="upper left")
    shown = np.abs(delta) <= 3.0
    largest = 1.1 * np.abs(rate[shown]).max()
    near.set(xlim=(-3.0, 3.0), ylim=(-largest, largest))
    near.set_title("near amidships")
