"""The scene of a row of a recording: what the running environment showed at that instant."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.conventions import COMMAND_NAMES, STATE_NAMES
from ship_gym.recording.surroundings import section, surroundings
from ship_gym.recording.trajectory import Trajectory
from ship_gym.recording.turns import is_manoeuvre
from ship_gym.rendering.scene import Scene

_WAKE = 901  # positions that the wake of a running environment keeps
_LONG_WAKE = 3200  # and those that a picture can use
_SHIP = ("name", "L", "B", "speed", "delta_max", "n_max")


def scene_at(trajectory: Trajectory, row: int) -> Scene:
    """The scene of a row: what the running environment showed at that instant.

    Command and reward are those of the interval that ends there, as on its screen; the row itself
    holds those of the interval that begins.

    Parameters
    ----------
    trajectory : Trajectory
    row : int
        Negative ones count from the end.

    Raises
    ------
    ConfigError
        The recording lacks a column or an entry of its meta that a picture needs.
    """
    _check(trajectory)
    row = range(len(trajectory))[row]
    meta, ship, before = trajectory.meta, trajectory.meta["ship"], max(row - 1, 0)
    around = surroundings(trajectory, row)
    state = np.array([trajectory[name][row] for name in STATE_NAMES])
    command = np.array([trajectory[name][before] for name in COMMAND_NAMES])
    if row == 0 and not is_manoeuvre(trajectory):
        command = np.array([0.0, trajectory["n"][0]])  # of an episode nothing is ordered before it
    return Scene(
        task=str(meta.get("task", "run")).replace("_", " ").capitalize(),
        ship=ship["name"],
        L=ship["L"],
        B=ship["B"],
        U0=ship["speed"],
        delta_max=ship["delta_max"],
        n_max=ship["n_max"],
        scale=ship.get("scale", 1.0),
        state=state,
        command=command,
        time=float(trajectory["t"][row]),
        wake=_wake(trajectory, row),
        **_aim(trajectory, row),
        current=_velocity(around.current_speed, around.current_direction_to),
        wind=_velocity(around.wind_speed, around.wind_direction_from + math.pi),
        wave_height=around.wave_height or 0.0,
        wave_period=around.wave_period or 0.0,
        wave_direction_to=around.wave_direction_to,
        wave_yaw=_value(trajectory, "wave_yaw", row),
        wave_roll=_value(trajectory, "wave_roll", row),
        **_reward(trajectory, row),
        outcome=str(meta.get("outcome") or "") if row == len(trajectory) - 1 else "",
    )


def _check(trajectory: Trajectory) -> None:
    ship = section(trajectory.meta, "ship")
    missing = [name for name in (*STATE_NAMES, *COMMAND_NAMES) if name not in trajectory]
    missing += [f"meta ship.{name}" for name in _SHIP if ship.get(name) is None]
    if missing:
        raise ConfigError(f"a recording without {', '.join(missing)} cannot be drawn")


def _wake(trajectory: Trajectory, row: int) -> np.ndarray:
    """Past positions: of an episode as many as its screen keeps, of a manoeuvre the whole way."""
    track = np.stack([trajectory["x"][: row + 1], trajectory["y"][: row + 1]], axis=1)
    if not is_manoeuvre(trajectory):
        return track[-_WAKE:]
    step = math.ceil(len(track) / _LONG_WAKE)
    return track[::-1][::step][::-1]


def _aim(trajectory: Trajectory, row: int) -> dict[str, Any]:
    """Ordered heading or track with their limits, as arguments of a scene."""
    meta, found = trajectory.meta, {}
    if "psi_ordered" in trajectory:
        found["psi_ordered"] = float(trajectory["psi_ordered"][row])
    if meta.get("waypoints"):
        return found | {
            "track": np.array(meta["waypoints"], dtype=np.float64),
            "active_leg": int(_value(trajectory, "leg", row)),
            "cross_track": _value(trajectory, "off_route", row),
            **_corridor(trajectory, row),
        }
    degrees = section(meta, "limits").get("heading_error_deg")
    return found | {"heading_limit": None if degrees is None else math.radians(degrees)}


def _corridor(trajectory: Trajectory, row: int) -> dict[str, Any]:
    """Limit and corridor of a track, as arguments of a scene."""
    meta, limits = trajectory.meta, section(trajectory.meta, "limits")
    limit, corridor = limits.get("cross_track"), limits.get("corridor")
    found: dict[str, Any] = {"cross_track_limit": limit, "corridor": corridor}
    if meta.get("leg_of"):
        found["leg_of"] = np.array(meta["leg_of"], dtype=np.int64)
    if meta.get("leg_limits") and limit is not None and corridor is not None:
        side = "starboard" if _value(trajectory, "off_route", row) > 0.0 else "port"
        beside = _value(trajectory, f"corridor_{side}", row) or corridor
        found |= {"corridor": beside, "cross_track_limit": limit * (beside / corridor)}
        found["leg_limits"] = np.array(meta["leg_limits"], dtype=np.float64)
    return found


def _reward(trajectory: Trajectory, row: int) -> dict[str, Any]:
    """Reward and its terms of the interval that ends in a row, zero in the first."""
    names = [name for name in trajectory.names if name.startswith("reward_")]
    at = row - 1
    terms = {n.removeprefix("reward_"): float(trajectory[n][at]) if row else 0.0 for n in names}
    return {"reward": _value(trajectory, "reward", at) if row else 0.0, "reward_terms": terms}


def _value(trajectory: Trajectory, name: str, row: int) -> float:
    return float(trajectory[name][row]) if name in trajectory else 0.0


def _velocity(speed: float | None, to: float) -> tuple[float, float]:
    speed = speed or 0.0
    return speed * math.cos(to), speed * math.sin(to)
