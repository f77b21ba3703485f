"""Picture of a ship in waves: its turning circle beside the one in calm water."""

from __future__ import annotations

import math
import os

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from ship_gym.conventions import FORCES
from ship_gym.manoeuvres import TurningCircle
from ship_gym.plotting.figure import (
    AMBER,
    BLUE,
    DASHED,
    FAINT,
    INK,
    MEASURED,
    RED,
    TEAL,
    VIOLET,
    headline,
    picture,
)
from ship_gym.recording.hull_shape import deck_outline
from ship_gym.recording.trajectory import Trajectory
from ship_gym.reports.case import Case
from ship_gym.reports.manoeuvre import CONDITION, title, wave_share
from ship_gym.reports.measures import rows

_OUTLINE_EVERY = 45.0  # deg of heading
_SHOWN = math.radians(560.0)  # heading up to which a turn is drawn; drift is counted to 540 deg
_DRIFT = (180.0, 540.0)  # deg of heading between which the drift of a circle is counted
_AXES = {"X": "surge force X [N]", "Y": "sway force Y [N]", "N": "yaw moment N [N m]"}


def seen_motion(columns) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """North, east [m] and heading [rad] with the wave-frequency sway and yaw on top, (T,)."""
    psi, sway = columns["psi"], columns["wave_sway"]
    north = columns["x"] - sway * np.sin(psi)
    east = columns["y"] + sway * np.cos(psi)
    return north, east, psi + columns["wave_yaw"]


def plot_turning_in_waves(case: Case, path: str | os.PathLike) -> None:
    """Draw a turning circle in waves beside the one in calm water.

    Tracks with the wave-frequency motion on top, drift between 180 and 540 deg of heading,
    histories, and forces by component as White (2020) draws them.

    Parameters
    ----------
    case : reports.case.Case
        A turning circle in a sea with waves.
    path : path-like
        PNG file; an interrupted write leaves an existing one as it was.
    """
    assert case.calm is not None
    waves, calm = _shown(case.result.trajectory), _shown(case.calm.trajectory)
    with picture(path, 12.5, 9.0) as figure:
        name, _, rest = title(case).partition(": ")
        what, condition = rest.split(CONDITION, 1)
        headline(figure, f"{name}: {what} in waves", condition)
        rows = figure.add_gridspec(2, 1, height_ratios=(1.75, 1.0))
        upper = rows[0].subgridspec(3, 3, width_ratios=(2.1, 1.0, 1.0))
        _tracks(figure.add_subplot(upper[:, 0]), case, waves, calm)
        panels = [figure.add_subplot(upper[k // 2, 1 + k % 2]) for k in range(6)]
        _histories(panels, case, waves, calm)
        lower = rows[1].subgridspec(1, 3)
        lower = [figure.add_subplot(lower[k]) for k in range(3)]
        for axes, axis in zip(lower, _AXES, strict=True):
            _contributions(axes, waves, calm, axis)
        lower[0].plot([], [], color=FAINT, linestyle=DASHED, label="dashed: calm")
        lower[0].legend(ncols=3, loc="best")
        for axes in (*panels, *lower):
            axes.set_xlim(0.0, waves["t"][-1])
        for axes in panels[:-2]:
            axes.tick_params(labelbottom=False)
        for axes in (*panels[-2:], *lower):
            axes.set_xlabel("time t [s]")


def _shown(trajectory: Trajectory) -> dict[str, np.ndarray]:
    rows = np.abs(trajectory["psi"]) <= _SHOWN
    return {name: values[rows] for name, values in trajectory.columns.items()}


def _tracks(axes: Axes, case: Case, waves: dict, calm: dict) -> None:
    """Tracks in ship lengths, east to the right and north up, with drift and wave direction."""
    L = case.ship.hull.L
    north, east, seen = seen_motion(waves)
    axes.plot(calm["y"] / L, calm["x"] / L, color=FAINT, linestyle=DASHED, label="calm water")
    axes.plot(
        east / L, north / L, color=AMBER, linewidth=2.6, alpha=0.7, label="with first-order sway"
    )
    axes.plot(waves["y"] / L, waves["x"] / L, color=BLUE, linewidth=0.9, label="in waves")
    turned = np.degrees(np.abs(waves["psi"]))
    for angle in np.arange(0.0, 361.0, _OUTLINE_EVERY):
        row = int(np.argmax(turned >= angle))
        _outline(axes, case, north[row] / L, east[row] / L, seen[row])
    start, end = ([np.interp(a, turned, waves[k]) / L for k in ("y", "x")] for a in _DRIFT)
    arrow = {"arrowstyle": "-|>", "color": RED, "linewidth": 1.8, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", end, start, arrowprops=arrow, zorder=6)
    _measured_drift(axes, case, start)
    result, still = case.result, case.calm
    assert isinstance(result, TurningCircle) and isinstance(still, TurningCircle)
    towards = math.degrees(result.drift_direction) % 360.0
    text = f"drift, 180 to 540 deg:\n{result.drift_distance:.2f} L to {towards:.0f} deg"
    text += f"\n(calm water {still.drift_distance:.2f} L)"
    side = math.copysign(1.0, case.delta)
    place, align = (0.98, "right") if side > 0.0 else (0.02, "left")
    style = {"ha": align, "va": "bottom", "color": RED, "transform": axes.transAxes}
    axes.text(place, 0.02, text, **style)
    _wave_arrow(axes, case, side)
    axes.margins(0.12)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("east y [L]")
    axes.set_ylabel("north x [L]")
    axes.legend(loc="upper left", bbox_to_anchor=(0.0, 1.1), ncols=3)


def _measured_drift(axes: Axes, case: Case, start: list[float]) -> None:
    """Drift of the trial from the same place, and its tactical diameter."""
    found = {row.name: row.measured for row in rows(case) if row.measured is not None}
    if "drift_distance" in found and "drift_direction" in found:
        towards, distance = math.radians(found["drift_direction"]), found["drift_distance"]
        end = [start[0] + distance * math.sin(towards), start[1] + distance * math.cos(towards)]
        arrow = {"arrowstyle": "-|>", "color": MEASURED, "linewidth": 1.8}
        arrow |= {"shrinkA": 0, "shrinkB": 0, "linestyle": DASHED}
        axes.annotate("", end, start, arrowprops=arrow, zorder=6)
        axes.plot([], [], color=MEASURED, linestyle=DASHED, label="measured")
    if "tactical_diameter" in found:
        side = math.copysign(found["tactical_diameter"], case.delta)
        axes.plot(side, start[1], "D", color=MEASURED, markersize=5, zorder=5)


def _outline(axes: Axes, case: Case, north: float, east: float, psi: float) -> None:
    """The ship from above, lengths in L."""
    hull = case.ship.hull
    shape = deck_outline(hull.L, hull.B, hull.d) / hull.L
    c, s = math.cos(psi), math.sin(psi)
    corners = [east + shape[:, 0] * s + shape[:, 1] * c, north + shape[:, 0] * c - shape[:, 1] * s]
    patch = Polygon(np.stack(corners, axis=1), facecolor=INK, edgecolor="none", alpha=0.28)
    axes.add_patch(patch)


def _wave_arrow(axes: Axes, case: Case, side: float) -> None:
    """Arrow along which the waves go, in the corner on the outer side of the turn's start."""
    go = case.water.wave_direction_to
    x, y = (0.9, 0.9) if side > 0.0 else (0.1, 0.9)
    dx, dy = 0.045 * math.sin(go), 0.045 * math.cos(go)
    arrow = {"arrowstyle": "-|>", "color": VIOLET, "linewidth": 2.5}
    ends = {"xycoords": "axes fraction", "textcoords": "axes fraction"}
    axes.annotate("", (x + dx, y + dy), (x - dx, y - dy), arrowprops=arrow, **ends)
    axes.text(
        x, y + 0.055, "waves", color=VIOLET, ha="center", va="bottom", transform=axes.transAxes
    )


def _histories(panels: list[Axes], case: Case, waves: dict, calm: dict) -> None:
    """Heading, speed, yaw rate, drift angle, and the wave-frequency motions over time."""
    L = case.ship.hull.L
    rate = 180.0 / math.pi
    speed = {k: np.hypot(c["u"], c["v"]) / case.speed for k, c in (("w", waves), ("c", calm))}
    pairs = (
        ("heading psi [deg]", rate * waves["psi"], rate * calm["psi"]),
        ("speed U/U0 [-]", speed["w"], speed["c"]),
        ("yaw rate r L/U0 [-]", waves["r"] * L / case.speed, calm["r"] * L / case.speed),
        ("drift beta [deg]", *(rate * np.arctan2(-c["v"], c["u"]) for c in (waves, calm))),
    )
    for axes, (label, here, still) in zip(panels, pairs, strict=False):
        axes.plot(calm["t"], still, color=FAINT, linestyle=DASHED, linewidth=1.2)
        axes.plot(waves["t"], here, color=BLUE)
        axes.set_title(label)
    seen = (waves["r"] + waves["wave_yaw_rate"]) * L / case.speed
    panels[2].plot(waves["t"], seen, color=AMBER, linewidth=0.8, zorder=1.5)
    sway, angle = panels[4], panels[5]
    sway.plot(waves["t"], waves["wave_sway"] / L, color=AMBER, linewidth=0.9)
    sway.set_title("wave-frequency sway [L]")
    for name, colour in (("roll", TEAL), ("yaw", AMBER)):
        values = rate * waves[f"wave_{name}"]
        angle.plot(waves["t"], values, color=colour, linewidth=0.9, label=name)
    angle.set_title("wave-frequency roll and yaw [deg]")
    angle.margins(y=0.3)
    angle.legend(ncols=2, loc="upper right")
    panels[1].text(
        0.97, 0.9, _share_text(case), ha="right", va="top", fontsize=8, color=VIOLET,
        transform=panels[1].transAxes,
    )  # fmt: skip


def _share_text(case: Case) -> str:
    share = wave_share(case)
    lines = [f"at first {share['first']:.0%}"] if "first" in share else []
    return "\n".join(["wave share of resistance", *lines, f"to 90 deg {share['to_90_deg']:.0%}"])


def _contributions(axes: Axes, waves: dict, calm: dict, axis: str) -> None:
    """One axis of the force breakdown in waves (full) and in calm water (dashed)."""
    for force in FORCES:
        column, colour = f"{axis}_{force.name}", force.colour
        if not np.any(waves[column] != 0.0):
            continue
        axes.plot(waves["t"], waves[column], color=colour, label=force.label, linewidth=1.3)
        if np.any(calm[column] != 0.0):
            style = {"linestyle": DASHED, "linewidth": 0.9, "alpha": 0.7}
            axes.plot(calm["t"], calm[column], color=colour, **style)
    axes.axhline(0.0, color=FAINT, linewidth=0.8)
    axes.set_title(_AXES[axis])
