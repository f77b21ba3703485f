"""Which columns are drawn together over time, under which name, in which unit and colour."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ship_gym.conventions import FORCE_AXES, wrap_angle
from ship_gym.recording.load_panels import flow_panels, force_panel, units_panel
from ship_gym.recording.panel import (
    BLUE,
    DEG,
    GREEN,
    GREY,
    ORANGE,
    PALETTE,
    RED,
    STEERING,
    Columns,
    Panel,
    Series,
)
from ship_gym.recording.surroundings import speed_through_water


def plots_meta(plots: Sequence[tuple[str, str, Sequence[str]]]) -> dict[str, list]:
    """Plots of a task (name, title, columns) as an entry of a recording's meta; none: no entry."""
    found = [[name, title, list(columns)] for name, title, columns in plots]
    return {"plots": found} if found else {}


def steering_panels(columns: Columns, meta: Mapping[str, Any] | None = None) -> list[Panel]:
    """What is seen at once: what the task is judged by, rudder, speed with propeller, reward.

    The first is the first plot of the task's own, else the heading.

    Parameters
    ----------
    columns : mapping of str to numpy.ndarray
        Columns of a trajectory, shape (T,), SI units, angles in rad.
    meta : mapping, optional
        Of the trajectory: ``plots`` (see `plots_meta`), ``limits`` and ``ship``.

    Returns
    -------
    list of Panel
        Only the panels that have at least one of their columns.
    """
    meta = meta or {}
    own = _own_panels(columns, meta)
    first = own or [_heading_panel(columns, meta)]
    rest = (_rudder_panel(columns, meta), _speed_panel(columns), _reward_panel(columns))
    return [replace(panel, topic=STEERING) for panel in _filled(*first, *rest)]


def motion_panels(
    columns: Columns,
    largest: Mapping[str, float] | None = None,
    meta: Mapping[str, Any] | None = None,
) -> list[Panel]:
    """The other plots, by topic: course, forces, loads of each unit, flow; see `steering_panels`.

    Parameters
    ----------
    columns : mapping of str to numpy.ndarray
        Columns of a trajectory.
    largest : mapping of str to float, optional
        Force X, Y [N] and moment N [N m] that set the units, for a run that is not over; else the
        largest ones of the run do.
    meta : mapping, optional
        As for `steering_panels`.
    """
    meta = meta or {}
    own = _own_panels(columns, meta)
    return _filled(
        *([_heading_panel(columns, meta)] if own else []),
        Panel("plots/heading_error", "Heading error [deg]", _heading_error(columns)),
        Panel("plots/yaw_rate", "Rate of turn [deg/s]", _yaw_rate(columns)),
        Panel("plots/wave_motion", "Motion in waves [deg]", _wave_motion(columns)),
        *(force_panel(columns, axis, largest) for axis in FORCE_AXES),
        units_panel(columns, "thrust", "Thrust of each propeller", largest),
        units_panel(columns, "rudder_normal_force", "Normal force of each rudder", largest),
        *flow_panels(columns, meta),
    )


def heading_error(columns: Columns) -> np.ndarray | None:
    """Heading minus ordered heading [rad], shape (T,), or None where it is not known."""
    if "psi_error" in columns:
        return columns["psi_error"]
    if "psi" in columns and "psi_ordered" in columns:
        return wrap_angle(columns["psi"] - columns["psi_ordered"])
    return None


def unwrapped(psi: np.ndarray) -> np.ndarray:
    """Heading [rad] without jumps, from 0 to 360 deg where it begins, and throughout if it can."""
    found = np.unwrap(psi)
    return found - 2.0 * np.pi * np.floor(found[0] / (2.0 * np.pi))


def _heading_panel(columns: Columns, meta: Mapping[str, Any]) -> Panel:
    """Heading, order with its limits and what is measured, on one branch."""
    found: list[Series] = []
    if "psi" in columns:
        psi = unwrapped(columns["psi"])
        if "psi_measured" in columns:
            seen = psi + wrap_angle(columns["psi_measured"] - columns["psi"])
            found.append(Series("measured", DEG * seen, GREY))
        elif _in_waves(columns, "wave_yaw"):
            found.append(Series("in waves", DEG * (psi + columns["wave_yaw"]), GREY))
        found.append(Series("true", DEG * psi, BLUE))
        if "psi_ordered" in columns:
            ordered = psi - wrap_angle(columns["psi"] - columns["psi_ordered"])
            found.append(Series("ordered", DEG * ordered, ORANGE))
            end = _limit(meta, "heading_error_deg")
            if end is not None:
                sides = (1.0, -1.0)
                found += [Series("limit", DEG * ordered + k * end, RED, True) for k in sides]
    beyond = any(np.any((s.values < 0.0) | (s.values >= 360.0)) for s in found if not s.limit)
    title = "Heading [deg true]" + (", beyond 000-360 where it would jump" if beyond else "")
    return Panel("plots/heading", title, found)


def _in_waves(columns: Columns, name: str) -> bool:
    """Whether a wave-frequency motion is recorded and not zero all the time, as in calm water."""
    return name in columns and bool(np.any(columns[name]))


def _own_panels(columns: Columns, meta: Mapping[str, Any]) -> list[Panel]:
    """Plots of the task's own, the error with its limits."""
    error = meta.get("error")
    labels: dict[Any, Any] = {}
    if isinstance(error, Mapping):
        labels[error.get("column")] = error.get("label")
    found = _filled(
        *(
            Panel(f"plots/{name}", title, _plain(columns, *names, labels=labels))
            for name, title, names in meta.get("plots", ())
        )
    )
    aside = _beside_route(columns, meta)
    return [
        replace(panel, series=panel.series + aside) if panel.path == "plots/off_route" else panel
        for panel in found
    ]


def _beside_route(columns: Columns, meta: Mapping[str, Any]) -> list[Series]:
    """Corridor and limit on both sides of a route, which may differ from leg to leg."""
    corridor, limit = _limit(meta, "corridor"), _limit(meta, "cross_track")
    sides = ("corridor_starboard", "corridor_port")
    if corridor and limit and set(sides) <= columns.keys():
        lines = [(+1.0, columns[sides[0]]), (-1.0, columns[sides[1]])]
        near = [Series("corridor", side * values, RED, True) for side, values in lines]
        factor = limit / corridor
        return near + [Series("limit", side * factor * v, RED, True) for side, v in lines]
    bounds = [(corridor, "corridor"), (limit, "limit")]
    return [line for end, name in bounds if end for line in _both(end, name, columns)]


def _limit(meta: Mapping[str, Any], name: str) -> float | None:
    limits = meta.get("limits")
    value = limits.get(name) if isinstance(limits, Mapping) else None
    return float(value) if isinstance(value, int | float) else None


def _both(limit: float, label: str, columns: Columns) -> list[Series]:
    """Lines at a limit on both sides."""
    whole = np.ones(len(columns["t"]))
    return [Series(label, side * limit * whole, RED, True) for side in (1.0, -1.0)]


def _rudder_panel(columns: Columns, meta: Mapping[str, Any]) -> Panel:
    found = _pair(columns, "delta", DEG)
    ship = meta.get("ship")
    limit = _limit(meta, "rudder_deg")
    if limit is None and isinstance(ship, Mapping) and ship.get("delta_max"):
        limit = DEG * float(ship["delta_max"])
    if found and limit is not None and "t" in columns:
        found += _both(limit, "limit", columns)
    return Panel("plots/rudder", "Rudder [deg], + turns to starboard", found)


def _speed_panel(columns: Columns) -> Panel:
    """Speeds and, on the same axis in tens or hundreds of rpm, the propeller."""
    found: list[Series] = []
    if {"u", "v"} <= columns.keys():
        ground = np.hypot(columns["u"], columns["v"])
        water = _through_water(columns)
        if water is not None:
            found.append(Series("over ground", ground, GREY))
        found.append(Series("through water", ground if water is None else water, BLUE))
    unit = 1.0
    if "n" in columns:
        rpm = [60.0 * columns[name] for name in ("n_command", "n") if name in columns]
        unit = 10.0 ** max(0.0, np.floor(np.log10(max(float(np.abs(rpm[-1]).max()), 1.0))))
        names = (("rpm ordered", ORANGE), ("rpm", GREEN))[-len(rpm) :]
        per = f" / {unit:g}" if unit > 1.0 else ""
        found += [
            Series(label.replace("rpm", f"rpm{per}"), values / unit, color)
            for values, (label, color) in zip(rpm, names, strict=True)
        ]
    return Panel("plots/speed", "Speed [m/s] and propeller", found)


def _through_water(columns: Columns) -> np.ndarray | None:
    """Speed through the water [m/s]; None where it is that over ground."""
    names = {"psi", "current_speed", "current_direction_to"}
    if not names <= columns.keys() or not np.any(columns["current_speed"]):
        return None
    return speed_through_water(columns)


def _reward_panel(columns: Columns) -> Panel:
    """Reward and its terms, without what ends an episode once and would flatten all else."""
    end = columns.get("reward_termination")
    names = [k for k in columns if k.startswith("reward_") and k != "reward_termination"]
    found = [
        Series(name.removeprefix("reward_").replace("_", " "), _held(columns[name]), color)
        for name, color in zip(names, PALETTE * 9, strict=False)
    ]
    title = "Reward of an interval, by terms"
    if "reward" in columns:
        whole = columns["reward"] if end is None else columns["reward"] - end
        found.append(Series("all" if names else "reward", _held(whole), GREY))
    if end is not None and np.any(end):
        title += f"; {end.sum():g} for the end is left out"
    return Panel("plots/reward", title, found, robust=True)


def _held(values: np.ndarray) -> np.ndarray:
    """Values of intervals, the last one held to its end; the last row of a recording has none."""
    return np.append(values[:-1], values[-2]) if len(values) > 1 else values


def _yaw_rate(columns: Columns) -> list[Series]:
    """Draw the yaw rate over what a sensor in the waves measures."""
    if "r" not in columns:
        return []
    found = [Series("low-frequency", DEG * columns["r"], BLUE)]
    if _in_waves(columns, "wave_yaw_rate"):
        seen = DEG * (columns["r"] + columns["wave_yaw_rate"])
        found = [Series("in waves", seen, GREY), *found]
    return found


def _wave_motion(columns: Columns) -> list[Series]:
    """Draw roll and yaw of wave frequency; nothing in calm water."""
    names = (("wave_roll", "roll", GREEN), ("wave_yaw", "yaw", BLUE))
    return [
        Series(label, DEG * columns[name], color)
        for name, label, color in names
        if _in_waves(columns, name)
    ]


def _heading_error(columns: Columns) -> list[Series]:
    error = heading_error(columns)
    return [] if error is None else [Series("error", DEG * error, RED)]


def _pair(columns: Columns, name: str, scale: float) -> list[Series]:
    """Draw an achieved value over the ordered one."""
    pair = ((f"{name}_command", "ordered", ORANGE), (name, "achieved", BLUE))
    return [Series(label, scale * columns[c], color) for c, label, color in pair if c in columns]


def _plain(
    columns: Columns, *names: str, labels: Mapping[str, str | None] | None = None
) -> list[Series]:
    """Draw the columns `names` under their own names, or their labels."""
    there = [name for name in names if name in columns]
    return [
        Series((labels or {}).get(name) or name, columns[name], color)
        for name, color in zip(there, PALETTE * 9, strict=False)
    ]


def _filled(*panels: Panel) -> list[Panel]:
    return [panel for panel in panels if panel.series]
