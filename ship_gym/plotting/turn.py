"""Pictures of a sailed manoeuvre: its path in J and drift over the samples, its force shares."""

from __future__ import annotations

import math
import os

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from ship_gym.config import ConfigError
from ship_gym.conventions import FORCES
from ship_gym.plotting.figure import AMBER, BLUE, DASHED, FAINT, INK, RED, headline, picture
from ship_gym.recording.trajectory import Trajectory
from ship_gym.reports.manoeuvre import CONDITION
from ship_gym.ships.particulars import Ship
from ship_gym.surrogates.samples import DATA_SETS

_SHOWN = 540.0  # deg of heading; what follows repeats the steady turn
_SMALL = 0.05  # of the largest denominator: a share of less is not drawn
_PLACES = (("beta_P", "propeller", BLUE), ("beta_R", "rudder", RED))
# axis -> what the others are divided by, and who they are
_SHARES = {
    "X": (None, ("hull", "rudder", "wave")),
    "Y": ("hull", ("rudder", "wave")),
    "N": ("rudder", ("hull", "wave")),
}


def path_share(trajectory: Trajectory, ship: Ship) -> dict[str, float]:
    """Share of the samples of a manoeuvre that lie in the surrogate's trained box, by place.

    The drift angle is mirrored to that side of the ship to which the rudder is put, as the
    surrogate is.

    Raises
    ------
    ConfigError
        The ship has no surrogate.
    """
    box = _card(ship)["domain"]
    J = trajectory["J"]
    inside = (box["J_min"] <= J) & (box["J_max"] >= J)
    found = {}
    for column, place, _ in _PLACES:
        beta = _mirrored(trajectory, column)
        found[place] = float(np.mean(inside & _between(beta, box["beta_min"], box["beta_max"])))
    return found


def _between(values: np.ndarray, low: float, high: float) -> np.ndarray:
    return (values >= low) & (values <= high)


def _card(ship: Ship) -> dict:
    if ship.surrogate is None:
        raise ConfigError(f"{ship.name}: has no surrogate whose samples a path could cross")
    return ship.surrogate.card


def _mirrored(trajectory: Trajectory, column: str) -> np.ndarray:
    """Drift angle [rad] as if the rudder were to starboard."""
    return trajectory[column] * np.where(trajectory["delta"] < 0.0, -1.0, 1.0)


def _crossing(trajectory: Trajectory) -> np.ndarray:
    """Rows at which the rudder has just gone over to the other side, where the mirror jumps."""
    port = trajectory["delta"] < 0.0
    return np.concatenate([[False], port[1:] != port[:-1]])


def plot_path(
    trajectory: Trajectory, ship: Ship, path: str | os.PathLike, title: str
) -> dict[str, float]:
    """Draw the path of a manoeuvre in J and local drift over the samples of the surrogate.

    As Knight & Maki (2020) Fig. 11 has its unsteady cases, here of the ship's own manoeuvre.

    Parameters
    ----------
    trajectory : Trajectory
        A recording of `ship`.
    ship : Ship
        With a surrogate.
    path : path-like
        PNG file; an interrupted write leaves an existing one as it was.
    title : str
        As of ``reports.manoeuvre.title``.

    Returns
    -------
    dict
        Of `path_share`.
    """
    card, shares = _card(ship), path_share(trajectory, ship)
    what, *condition = title.split(CONDITION, 1)
    with picture(path, 8.6, 6.2) as figure:
        headline(figure, what, "; ".join((*condition, f"surrogate {ship.surrogate_name}")))
        axes = figure.add_subplot()
        for column, place, colour in _PLACES:
            beta = np.degrees(_mirrored(trajectory, column))
            shown = np.where(_crossing(trajectory), np.nan, beta)
            label = f"at the {place}, {shares[place]:.0%} of the time in the box"
            axes.plot(trajectory["J"], shown, color=colour, linewidth=1.3, label=label)
            axes.plot(trajectory["J"][-1], beta[-1], "s", color=colour, markersize=6)
        _samples(axes, card)
        _box(axes, card["domain"])
        axes.set_xlabel("advance ratio J of the propeller, u/(nD) [-]")
        axes.set_ylabel("local drift angle [deg], rudder to starboard")
        axes.legend(loc="lower left", title="squares: end")
    return shares


def _box(axes: Axes, box: dict[str, float]) -> None:
    low, high = math.degrees(box["beta_min"]), math.degrees(box["beta_max"])
    corner, width = (box["J_min"], low), box["J_max"] - box["J_min"]
    axes.add_patch(Rectangle(corner, width, high - low, fill=False, edgecolor=INK, linewidth=1.1))


def _samples(axes: Axes, card: dict) -> None:
    """Places of the samples, where the surrogate is of a project data set."""
    data = DATA_SETS.get(card["data"])
    if data is None:
        return
    rows = data.read(card["grid"], card["turbulence"], next(iter(data.sides)))
    for points, marker, label in (
        (card["training_points"], "o", "training points"),
        (card["held_out_points"], "D", "held-out points"),
    ):
        mine = [p for p in points if p in set(rows.points.tolist())]
        J, beta = rows.pick(mine).X.T
        style = {"color": INK, "markersize": 6, "fillstyle": "full" if marker == "o" else "none"}
        axes.plot(J, np.degrees(beta), marker, linestyle="none", label=label, **style)


def force_shares(trajectory: Trajectory) -> dict[str, dict[str, np.ndarray]]:
    """Shares of the forces over a manoeuvre, as White (2020) Figs. 3.20 to 3.22 has them.

    Returns
    -------
    dict
        Axis to component to its share, shape (T,): X of hull, rudder and waves over their sum (the
        resistance), Y over that of the hull, N over that of the rudder; nan where what they are
        divided by is below a twentieth of its largest value. Waves are left out in calm water.
    """
    found: dict[str, dict[str, np.ndarray]] = {}
    for axis, (base, names) in _SHARES.items():
        parts = {k: trajectory[f"{axis}_{k}"] for k in names}
        parts = {k: values for k, values in parts.items() if np.any(values != 0.0)}
        whole = (
            np.sum(list(parts.values()), axis=0) if base is None else trajectory[f"{axis}_{base}"]
        )
        small = np.abs(whole) < _SMALL * np.abs(whole).max()
        found[axis] = {k: values / np.where(small, np.nan, whole) for k, values in parts.items()}
    return found


def plot_shares(
    trajectory: Trajectory, path: str | os.PathLike, title: str
) -> dict[str, dict[str, float]]:
    """Draw `force_shares` over the first one and a half turns; return their last values.

    Parameters
    ----------
    trajectory : Trajectory
    path : path-like
        PNG file; an interrupted write leaves an existing one as it was.
    title : str
        As of ``reports.manoeuvre.title``.

    Returns
    -------
    dict
        Axis to component to share at the end of the recording.
    """
    shares = force_shares(trajectory)
    rows = np.abs(np.degrees(trajectory["psi"])) <= _SHOWN
    labels = {force.name: force.label for force in FORCES}
    colours = {force.name: force.colour for force in FORCES}
    titles = {
        "X": "surge: share of the resistance",
        "Y": "sway: share of the hull's force",
        "N": "yaw: share of the rudder's moment",
    }
    what, *condition = title.split(CONDITION, 1)
    with picture(path, 12.5, 4.3) as figure:
        headline(figure, what, "; ".join((*condition, "negative: against it")))
        for axes, (axis, parts) in zip(figure.subplots(1, 3), shares.items(), strict=True):
            for name, values in parts.items():
                axes.plot(
                    trajectory["t"][rows], values[rows], color=colours[name], label=labels[name]
                )
            _heading_marks(axes, trajectory)
            axes.axhline(0.0, color=FAINT, linewidth=0.8)
            axes.set_title(titles[axis])
            axes.set_xlabel("time t [s]")
            axes.set_xlim(0.0, trajectory["t"][rows][-1])
            axes.legend()
    return {
        axis: {name: float(values[-1]) for name, values in parts.items()}
        for axis, parts in shares.items()
    }


def _heading_marks(axes: Axes, trajectory: Trajectory) -> None:
    """Lines where the heading has changed by 90, 180 and 360 deg."""
    turned = np.abs(np.degrees(trajectory["psi"]))
    for angle in (90.0, 180.0, 360.0):
        if turned.max() >= angle:
            when = trajectory["t"][int(np.argmax(turned >= angle))]
            axes.axvline(when, color=AMBER, linewidth=0.9, linestyle=DASHED)
            style = {"rotation": 90, "ha": "right", "va": "bottom", "fontsize": 7, "color": AMBER}
            axes.text(when, 0.02, f"{angle:.0f} deg", transform=axes.get_xaxis_transform(), **style)
