"""What surrounds a recorded ship: waves, wind and current, from columns and meta."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ship_gym.config import build
from ship_gym.sea.measured import MeasuredSpectrum

if TYPE_CHECKING:
    from ship_gym.recording.trajectory import Trajectory


def section(meta: Mapping, *names: str) -> Mapping[str, Any]:
    """A mapping inside a meta, empty where there is none."""
    for name in names:
        found = meta.get(name)
        meta = found if isinstance(found, Mapping) else {}
    return meta


class Surroundings(NamedTuple):
    """Waves, wind and current of one row; None: not recorded.

    Attributes
    ----------
    wave_height, wave_period : float or None
        Significant height [m], of a regular wave twice its amplitude; peak period [s].
    wave_direction_to : float
        [rad]
    wind_speed, current_speed : float or None
        [m/s]
    wind_direction_from, current_direction_to : float
        [rad]
    regular : bool
        Whether it is one regular wave.
    """

    wave_height: float | None
    wave_period: float | None
    wave_direction_to: float
    wind_speed: float | None
    wind_direction_from: float
    current_speed: float | None
    current_direction_to: float
    regular: bool


def surroundings(trajectory: Trajectory, row: int = 0) -> Surroundings:
    """What surrounds the ship in a row."""
    waves, wind = waves_of(trajectory.meta), _wind(trajectory, row)
    speed, to = None, 0.0
    if "current_speed" in trajectory:
        speed = float(trajectory["current_speed"][row])
        to = float(trajectory["current_direction_to"][row])
    return Surroundings(*waves[:3], *wind, speed, to, waves[3])


def speed_through_water(columns: Mapping[str, np.ndarray]) -> np.ndarray:
    """Speed through the water [m/s], shape (T,); over ground where no current is recorded."""
    flow = columns.get("current_speed", 0.0)
    angle = columns.get("current_direction_to", 0.0) - columns["psi"]
    return np.hypot(columns["u"] - flow * np.cos(angle), columns["v"] - flow * np.sin(angle))


def waves_of(meta: Mapping[str, Any]) -> tuple[float | None, float | None, float, bool]:
    """Height, period, direction, and whether it is a regular wave.

    An episode has them in its ``sea``, a manoeuvre in its config. Energies of several systems add
    up; period and direction are those of the highest.
    """
    sea, made = section(meta, "sea"), section(meta, "config", "sea")
    if "wave_height" in sea:
        to = float(sea.get("wave_direction_to", 0.0))
        return sea["wave_height"], sea.get("wave_period"), to, False
    to = made.get("wave_direction_to", 0.0)
    if regular := made.get("regular"):
        return 2.0 * regular["amplitude"], 2.0 * math.pi / regular["omega"], to, True
    if systems := made.get("waves"):
        height = math.hypot(*(system["height"] for system in systems))
        highest = max(systems, key=lambda one: one["height"])
        return height, highest["peak_period"], to + highest.get("direction", 0.0), False
    if measured := made.get("spectrum"):
        spectrum = build(MeasuredSpectrum, measured, "meta: config.sea.spectrum")
        return spectrum.height, spectrum.peak_period, to, False
    return 0.0 if "waves" in made else None, None, 0.0, False


def _wind(trajectory: Trajectory, row: int) -> tuple[float | None, float]:
    """Speed and where it comes from."""
    if "wind_speed" in trajectory:
        speed = float(trajectory["wind_speed"][row])
        return speed, float(trajectory["wind_direction_from"][row])
    sea = section(trajectory.meta, "sea")
    come = (sea.get("wind_direction_to", 0.0) + math.pi) % (2.0 * math.pi)
    if "wind_speed" in sea:
        return sea["wind_speed"], come
    made = section(trajectory.meta, "config", "sea")
    return made.get("wind_speed"), made.get("wind_direction_from", 0.0)
