"""Which columns are drawn together over time, under which name, in which unit and colour."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ship_gym.conventions import FORCE_AXES, FORCES, UNITS, wrap_angle

Columns = Mapping[str, np.ndarray]

_BLUE, _ORANGE, _GREEN, _RED = (76, 155, 232), (240, 160, 60), (100, 190, 110), (224, 90, 90)
_GREY = (200, 200, 200)
_PALETTE = (_BLUE, _GREEN, _ORANGE, _RED, (170, 130, 220), (90, 200, 200), (220, 130, 180), _GREY)
_SIDES = (_GREEN, _RED)  # starboard and port, as their lights
_SHARES = {"X": "surge", "Y": "sway", "N": "yaw"}
_PREFIXES = ((1e6, "M"), (1e3, "k"), (1.0, ""))


@dataclass(frozen=True)
class Series:
    """One line of a plot: legend text, values of shape (T,) in the panel's unit, RGB colour."""

    label: str
    values: np.ndarray
    color: tuple[int, int, int]


@dataclass(frozen=True)
class Panel:
    """One plot: the entity path of its data, a title with the unit, and its lines."""

    path: str
    title: str
    series: list[Series]


def plots_meta(plots: Sequence[tuple[str, str, Sequence[str]]]) -> dict[str, list]:
    """Plots of a task (name, title, columns) as an entry of a recording's meta; none: no entry."""
    found = [[name, title, list(columns)] for name, title, columns in plots]
    return {"plots": found} if found else {}


def steering_panels(columns: Columns, meta: Mapping[str, Any] | None = None) -> list[Panel]:
    """Heading, heading error, rudder, propeller speed, and what the meta says of the task's own.

    Parameters
    ----------
    columns : mapping of str to numpy.ndarray
        Columns of a trajectory, shape (T,), SI units, angles in rad.
    meta : mapping, optional
        Of the trajectory; ``plots`` of it, see `plots_meta`.

    Returns
    -------
    list of Panel
        Only the panels that have at least one of their columns.
    """
    return _filled(
        Panel("plots/heading", "Heading [deg]", _heading(columns)),
        Panel("plots/heading_error", "Heading error [deg]", _heading_error(columns)),
        _pair(columns, "plots/rudder", "Rudder [deg]", "delta", 180.0 / np.pi),
        _pair(columns, "plots/rpm", "Propeller [rpm]", "n", 60.0),
        *(
            Panel(f"plots/{name}", title, _plain(columns, *names))
            for name, title, names in (meta or {}).get("plots", ())
        ),
    )


def motion_panels(columns: Columns, largest: Mapping[str, float] | None = None) -> list[Panel]:
    """Speeds, yaw rate, wave motion, forces, two propellers, reward terms; see `steering_panels`.

    Parameters
    ----------
    columns : mapping of str to numpy.ndarray
        Columns of a trajectory.
    largest : mapping of str to float, optional
        Force X, Y [N] and moment N [N m] that set the units, for a run that is not over; else the
        largest ones of the run do.
    """
    return _filled(
        Panel("plots/speed", "Speed over ground, u ahead, v to starboard [m/s]",
              _plain(columns, "u", "v")),
        Panel("plots/yaw_rate", "Yaw rate [deg/s]", _yaw_rate(columns)),
        Panel("plots/wave_motion", "Wave-frequency motion [deg]", _wave_motion(columns)),
        *(_forces(columns, axis, largest) for axis in FORCE_AXES),
        _units(columns, "thrust", "Thrust of each propeller", largest),
        _units(columns, "rudder_normal_force", "Normal force of each rudder", largest),
        Panel("plots/reward", "Reward and its terms [-]", _plain(columns, *_rewards(columns))),
    )  # fmt: skip


def heading_error(columns: Columns) -> np.ndarray | None:
    """Heading minus ordered heading [rad], shape (T,), or None where it is not known."""
    if "psi_error" in columns:
        return columns["psi_error"]
    if "psi" in columns and "psi_ordered" in columns:
        return wrap_angle(columns["psi"] - columns["psi_ordered"])
    return None


def _heading(columns: Columns) -> list[Series]:
    """Draw the heading without jumps at 360 deg, and the order on the same branch."""
    found = []
    if "psi" in columns:
        psi = np.unwrap(columns["psi"])
        if _in_waves(columns, "wave_yaw"):
            found.append(Series("with waves", np.degrees(psi + columns["wave_yaw"]), _GREY))
        found.append(Series("heading", np.degrees(psi), _BLUE))
        if "psi_ordered" in columns:
            ordered = psi - wrap_angle(columns["psi"] - columns["psi_ordered"])
            found.append(Series("ordered", np.degrees(ordered), _ORANGE))
    return found


def _in_waves(columns: Columns, name: str) -> bool:
    """Whether a wave-frequency motion is recorded and not zero all the time, as in calm water."""
    return name in columns and bool(np.any(columns[name]))


def _yaw_rate(columns: Columns) -> list[Series]:
    """Draw the yaw rate over what a sensor in the waves measures."""
    found = _plain(columns, "r", scale=180.0 / np.pi)
    if found and _in_waves(columns, "wave_yaw_rate"):
        seen = np.degrees(columns["r"] + columns["wave_yaw_rate"])
        found = [Series("with waves", seen, _GREY), *found]
    return found


def _wave_motion(columns: Columns) -> list[Series]:
    """Draw roll and yaw of wave frequency; nothing in calm water."""
    names = (("wave_roll", "roll", _GREEN), ("wave_yaw", "yaw", _BLUE))
    return [
        Series(label, np.degrees(columns[name]), color)
        for name, label, color in names
        if _in_waves(columns, name)
    ]


def _heading_error(columns: Columns) -> list[Series]:
    error = heading_error(columns)
    return [] if error is None else [Series("error", np.degrees(error), _RED)]


def _pair(columns: Columns, path: str, title: str, name: str, scale: float) -> Panel:
    """Draw an achieved value over the commanded one."""
    pair = ((f"{name}_command", "commanded", _ORANGE), (name, "achieved", _BLUE))
    found = [Series(label, scale * columns[c], color) for c, label, color in pair if c in columns]
    return Panel(path, title, found)


def _plain(columns: Columns, *names: str, scale: float = 1.0) -> list[Series]:
    """Draw the columns `names` under their own names."""
    names = [name for name in names if name in columns]
    return [
        Series(name, scale * columns[name], _PALETTE[i % len(_PALETTE)])
        for i, name in enumerate(names)
    ]


def _forces(columns: Columns, axis: str, largest: Mapping[str, float] | None) -> Panel:
    """Draw one axis of the force breakdown: columns X_hull, X_propeller, ..., the known first."""
    colours = {f"{axis}_{force.name}": force.on_dark for force in FORCES}
    names = [name for name in colours if name in columns]
    names += [name for name in columns if name.startswith(f"{axis}_") and name not in colours]
    most = max((float(np.abs(columns[name]).max()) for name in names), default=0.0)
    size, prefix = _prefix(most if largest is None else largest[axis])
    unit = f"{prefix}N m" if axis == "N" else f"{prefix}N"
    what = "moment" if axis == "N" else "force"
    series = [Series(k, columns[k] / size, colours.get(k, _GREY)) for k in names]
    return Panel(f"plots/force_{axis}", f"{axis}: {_SHARES[axis]} {what} [{unit}]", series)


def _units(columns: Columns, name: str, title: str, largest: Mapping[str, float] | None) -> Panel:
    """Draw a force of the starboard unit and of the port one; nothing of a ship with one."""
    names = [f"{name}_{side}" for side in UNITS if f"{name}_{side}" in columns]
    most = max((float(np.abs(columns[k]).max()) for k in names), default=0.0)
    size, prefix = _prefix(most if largest is None else largest["X"])
    series = [
        Series(k.removeprefix(f"{name}_"), columns[k] / size, colour)
        for k, colour in zip(names, _SIDES, strict=False)
    ]
    return Panel(f"plots/{name}_of_units", f"{title} [{prefix}N]", series)


def _prefix(most: float) -> tuple[float, str]:
    """Size and prefix of the unit in which `most` is drawn."""
    return next((p for p in _PREFIXES if most >= p[0]), (1.0, ""))


def _rewards(columns: Columns) -> list[str]:
    return [name for name in columns if name == "reward" or name.startswith("reward_")]


def _filled(*panels: Panel) -> list[Panel]:
    return [panel for panel in panels if panel.series]
