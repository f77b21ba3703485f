"""Pictures of a sailed manoeuvre: turning circle and zig-zag."""

from __future__ import annotations

import math
import os

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Annulus, Ellipse, Polygon

from ship_gym.conventions import FORCES
from ship_gym.manoeuvres import TurningCircle, ZigZag
from ship_gym.plotting.figure import (
    BLUE,
    DASHED,
    FAINT,
    INK,
    MEASURED,
    RED,
    headline,
    level,
    picture,
)
from ship_gym.recording.hull_shape import deck_outline
from ship_gym.reports.case import Case
from ship_gym.reports.manoeuvre import CONDITION, title
from ship_gym.reports.measures import rows

_OUTLINE_EVERY = 30.0  # deg of heading
_SHOWN = 540.0  # deg of heading in the time histories
_FORCE_LABELS = {"X": "surge force X [N]", "Y": "sway force Y [N]", "N": "yaw moment N [N m]"}


def plot_manoeuvre(case: Case, path: str | os.PathLike) -> None:
    """Draw a sailed manoeuvre, whichever it is, to a PNG file."""
    draw = plot_turning_circle if case.manoeuvre == "turning_circle" else plot_zigzag
    draw(case, path)


def plot_turning_circle(case: Case, path: str | os.PathLike) -> None:
    """Draw a turning circle: track with its measures, time histories, forces by component.

    Parameters
    ----------
    case : reports.case.Case
        A turning circle; the values of its trial, if any, are marked.
    path : path-like
        PNG file; an interrupted write leaves an existing one as it was.
    """
    with picture(path, 12.5, 8.8) as figure:
        _headline(figure, case)
        rows = figure.add_gridspec(2, 1, height_ratios=(1.75, 1.0))
        upper = rows[0].subgridspec(3, 3, width_ratios=(2.1, 1.0, 1.0))
        _track(figure.add_subplot(upper[:, 0]), case)
        panels = [figure.add_subplot(upper[k // 2, 1 + k % 2]) for k in range(6)]
        columns = _shown(case)
        _histories(panels, case, columns)
        lower = rows[1].subgridspec(1, 3)
        lower = [figure.add_subplot(lower[k]) for k in range(3)]
        for axes, axis in zip(lower, "XYN", strict=True):
            _forces(axes, columns, axis)
        lower[0].legend(ncols=2, loc="best")
        for axes in (*panels, *lower):
            axes.set_xlim(0.0, columns["t"][-1])
        for axes in (*panels[-2:], *lower):
            axes.set_xlabel("time t [s]")


def plot_zigzag(case: Case, path: str | os.PathLike) -> None:
    """Draw a zig-zag: heading and rudder with overshoots, yaw rate and speed over time.

    Parameters
    ----------
    case : reports.case.Case
        A zig-zag; the overshoots of its trial, if any, are marked.
    path : path-like
        PNG file; an interrupted write leaves an existing one as it was.
    """
    track, L = case.result.trajectory, case.ship.hull.L
    U = np.hypot(track["u"], track["v"])
    with picture(path, 9.5, 6.4) as figure:
        _headline(figure, case)
        top, middle, bottom = figure.subplots(3, 1, sharex=True, height_ratios=(3, 1, 1))
        _overshoots(top, case)
        middle.plot(track["t"], track["r"] * L / case.speed, color=BLUE)
        middle.set_ylabel("yaw rate\nr L/U0 [-]")
        bottom.plot(track["t"], U / case.speed, color=BLUE)
        bottom.set_ylabel("speed\nU/U0 [-]")
        bottom.set_xlabel("time t [s]")
        bottom.set_xlim(0.0, track["t"][-1])


def _headline(figure: Figure, case: Case) -> None:
    name, _, rest = title(case).partition(": ")
    what, condition = rest.split(CONDITION, 1)
    details = f"{condition}; hull set {case.ship.variant}, surrogate {case.ship.surrogate_name}"
    headline(figure, f"{name}: {what}", details)


# --- turning circle ---------------------------------------------------------------------------


def _track(axes: Axes, case: Case) -> None:
    """Track in ship lengths: east to the right, north up, with the measures of the circle."""
    result, L = case.result, case.ship.hull.L
    assert isinstance(result, TurningCircle)
    t = result.trajectory
    side = math.copysign(1.0, case.delta)
    turned = np.degrees(np.abs(t["psi"]))
    first = turned <= 360.0
    axes.plot(t["y"] / L, t["x"] / L, color=FAINT, linewidth=0.9)
    axes.plot(t["y"][first] / L, t["x"][first] / L, color=BLUE, linewidth=1.8)
    axes.plot([0.0, 0.0], [-1.2, 0.0], color=BLUE, linewidth=1.8)
    for angle in np.arange(0.0, 331.0, _OUTLINE_EVERY):
        _outline(axes, case, int(np.argmax(turned >= angle)))
    advance, transfer, diameter = result.advance, result.transfer, result.tactical_diameter
    _dimension(axes, (side * transfer, 0.0), (side * transfer, advance), f"advance {advance:.2f} L")
    y = -0.75
    _dimension(axes, (0.0, y), (side * diameter, y), f"tactical diameter {diameter:.2f} L")
    _dimension(axes, (0.0, advance), (side * transfer, advance), f"transfer {transfer:.2f} L")
    _trial_marks(axes, case, side)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("east y [L]")
    axes.set_ylabel("north x [L]")


def _outline(axes: Axes, case: Case, row: int) -> None:
    """The ship seen from above at one row of the trajectory, to scale."""
    hull, t = case.ship.hull, case.result.trajectory
    shape = deck_outline(hull.L, hull.B, hull.d) / hull.L
    c, s = math.cos(t["psi"][row]), math.sin(t["psi"][row])
    north = t["x"][row] / hull.L + shape[:, 0] * c - shape[:, 1] * s
    east = t["y"][row] / hull.L + shape[:, 0] * s + shape[:, 1] * c
    corners = np.stack([east, north], axis=1)
    axes.add_patch(Polygon(corners, facecolor=INK, edgecolor="none", alpha=0.28, zorder=3))


def _dimension(axes: Axes, start, end, label: str) -> None:
    """Dimension line between two points (east, north) with its label at the middle."""
    arrow = {"arrowstyle": "<->", "color": INK, "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", end, start, arrowprops=arrow)
    upright = start[0] == end[0]
    middle = (0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1]))
    shift = {"xytext": (5, 0) if upright else (0, -4), "textcoords": "offset points"}
    align = {"ha": "left", "va": "center"} if upright else {"ha": "center", "va": "top"}
    paper = {"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 1.0}
    axes.annotate(label, middle, fontsize=8, bbox=paper, zorder=6, **shift, **align)


def _trial_marks(axes: Axes, case: Case, side: float) -> None:
    """Values of the trial at the places of the track that they belong to, with their scatter."""
    measured, bars = _measured(case)
    line = {"color": MEASURED, "linestyle": DASHED, "linewidth": 1.2}
    drawn = []
    if "max_advance" in measured:
        drawn += [axes.axhline(measured["max_advance"], **line)]
    if "max_transfer" in measured:
        drawn += [axes.axvline(side * measured["max_transfer"], **line)]
    if "advance" in measured:
        assert isinstance(case.result, TurningCircle)
        across = measured.get("transfer", case.result.transfer)
        bar = (bars.get("transfer"), bars.get("advance"))
        drawn += _diamond(axes, side * across, measured["advance"], *bar)
    if "tactical_diameter" in measured:
        along = _at(case, 180.0, "x") / case.ship.hull.L
        bar = (bars.get("tactical_diameter"), None)
        drawn += _diamond(axes, side * measured["tactical_diameter"], along, *bar)
    if "steady_diameter" in measured:
        north, east = _circle_centre(case)
        size, scatter = measured["steady_diameter"], bars.get("steady_diameter")
        drawn += [axes.add_patch(Ellipse((east, north), size, size, fill=False, **line))]
        if scatter:
            width = {"width": scatter, "facecolor": MEASURED, "alpha": 0.2}
            axes.add_patch(Annulus((east, north), 0.5 * (size + scatter), **width))
    if drawn:
        label = "measured: " + ", ".join(_drawn_names(measured))
        drawn[0].set_label(label + ("; bars, band: 1 SD of facilities" if bars else ""))
        axes.legend(handles=drawn[:1], loc="upper left", bbox_to_anchor=(0.0, 1.07))


def _measured(case: Case) -> tuple[dict[str, float], dict[str, float]]:
    """Measured values and standard deviations of the facilities, in units of display."""
    found = rows(case)
    measured = {row.name: row.measured for row in found if row.measured is not None}
    return measured, {
        row.name: row.deviation for row in found if row.name in measured and row.deviation
    }


def _diamond(axes: Axes, x: float, y: float, x_bar: float | None, y_bar: float | None) -> list:
    """A measured point with the error bars that it has."""
    style = {"color": MEASURED, "zorder": 5, "capsize": 3.0, "elinewidth": 1.4}
    made = axes.errorbar(x, y, y_bar, x_bar, fmt="D", markersize=5, **style)
    return [made]


def _drawn_names(measured: dict) -> list[str]:
    names = ("max_advance", "max_transfer", "advance", "tactical_diameter", "steady_diameter")
    return [name.replace("_", " ") for name in names if name in measured]


def _at(case: Case, angle: float, name: str) -> float:
    """Value of a column where the heading has changed by `angle` [deg]."""
    t = case.result.trajectory
    return float(np.interp(angle, np.degrees(np.abs(t["psi"])), t[name]))


def _circle_centre(case: Case) -> tuple[float, float]:
    """Centre of the last turn, north and east [L]."""
    t = case.result.trajectory
    turned = np.abs(t["psi"])
    last = turned >= turned[-1] - 2.0 * math.pi
    L = case.ship.hull.L
    return float(t["x"][last].mean()) / L, float(t["y"][last].mean()) / L


def _shown(case: Case) -> dict[str, np.ndarray]:
    """Columns of the first one and a half turns; what follows repeats the steady turn."""
    t = case.result.trajectory
    rows = np.abs(t["psi"]) <= math.radians(_SHOWN)
    return {name: values[rows] for name, values in t.columns.items()}


def _histories(panels: list[Axes], case: Case, t: dict[str, np.ndarray]) -> None:
    """Heading, yaw rate, speed, drift, rudder and thrust over time, with the trial's values."""
    L = case.ship.hull.L
    U = np.hypot(t["u"], t["v"])
    measured, bars = _measured(case)
    quantities = (
        ("heading psi [deg]", np.degrees(t["psi"]), ""),
        ("rudder delta [deg]", np.degrees(t["delta"]), ""),
        ("speed U/U0 [-]", U / case.speed, "steady_speed_ratio"),
        ("yaw rate r L/U [-]", t["r"] * L / U, ""),
        ("drift beta [deg]", np.degrees(np.arctan2(-t["v"], t["u"])), ""),
        ("thrust T [N]", t["thrust"], "steady_thrust"),
    )
    for axes, (label, values, name) in zip(panels, quantities, strict=True):
        axes.plot(t["t"], values, color=BLUE)
        axes.set_title(label)
        if name in measured:
            level(axes, measured[name], bars.get(name, 0.0), xmin=0.5)
    for axes in panels[:-2]:
        axes.tick_params(labelbottom=False)


def _forces(axes: Axes, track: dict[str, np.ndarray], axis: str) -> None:
    """One axis of the force breakdown over time; components that stay zero are left out."""
    for force in FORCES:
        values = track[f"{axis}_{force.name}"]
        if np.any(values != 0.0):
            axes.plot(track["t"], values, color=force.colour, label=force.label, linewidth=1.3)
    axes.axhline(0.0, color=FAINT, linewidth=0.8)
    axes.set_title(_FORCE_LABELS[axis])


# --- zig-zag ----------------------------------------------------------------------------------


def _overshoots(axes: Axes, case: Case) -> None:
    """Heading and rudder over time, each overshoot marked with its value."""
    assert isinstance(case.result, ZigZag) and case.psi is not None
    t = case.result.trajectory
    psi, limit = np.degrees(t["psi"]), abs(math.degrees(case.psi))
    axes.plot(t["t"], psi, color=BLUE, label="heading psi")
    axes.plot(t["t"], np.degrees(t["delta"]), color=RED, linewidth=1.1, label="rudder delta")
    for sign in (1.0, -1.0):
        axes.axhline(sign * limit, color=FAINT, linewidth=0.8)
    measured = (case.trial.measures if case.trial else {}).get("overshoots_deg", [])
    times = [*case.result.execute_times, t["t"][-1]]
    side = math.copysign(1.0, case.psi)
    for k, overshoot in enumerate(case.result.overshoots):
        sign = side if k % 2 == 0 else -side
        between = (t["t"] >= times[k]) & (t["t"] <= times[k + 1])
        when = float(t["t"][between][np.argmax(sign * psi[between])])
        trial = measured[k] if k < len(measured) else None
        _overshoot_mark(axes, when, sign, limit, math.degrees(overshoot), trial)
    axes.margins(y=0.16)
    axes.set_ylabel("angle [deg], starboard positive")
    axes.legend(ncols=3, loc="upper right")


def _overshoot_mark(
    axes: Axes, when: float, sign: float, limit: float, value: float, trial: float | None
) -> None:
    """Arrow from the heading of reversal to the peak, its value, and the measured peak."""
    arrow = {"arrowstyle": "<->", "color": INK, "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (when, sign * (limit + value)), (when, sign * limit), arrowprops=arrow)
    label = f"{value:.1f} deg"
    peak = value
    if trial is not None:
        label += f"\nmeasured {trial:.1f}"
        peak = max(value, trial)
        label_of_line = "measured peak" if not axes.get_legend_handles_labels()[1][2:] else None
        axes.plot(
            when, sign * (limit + trial), "D", color=MEASURED, markersize=5, label=label_of_line
        )
    axes.annotate(
        label,
        (when, sign * (limit + peak)),
        xytext=(0, 5 * sign),
        textcoords="offset points",
        ha="center",
        va="bottom" if sign > 0 else "top",
        fontsize=8,
    )
