"""The sea a ship sails in: uniform current and a random low-frequency disturbance.

The disturbance stands for the slowly varying drift of a seaway. Its spectrum is that of a
first-order low-pass process, one-sided and normalised to unit variance,

    S(omega) = (2 / pi) T / (1 + (omega T)^2),

with the time T = `correlation_time` L / U0. It is sampled by `N_COMPONENTS` cosines of equal
energy at the middle quantiles, omega_i = tan(pi (i + 1/2) / (2 N)) / T, whose phases are drawn at
reset. Standard deviations are given non-dimensional, by 1/2 rho L d U0^2 and 1/2 rho L^2 d U0^2.
"""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np

from ship_gym.config import ConfigError, build, check_angle, check_known, check_number, read_toml
from ship_gym.ships.particulars import Ship

N_COMPONENTS = 8
N_PHASES = 2 * N_COMPONENTS  # sway force and yaw moment

SEA_DTYPE = np.dtype(
    (
        np.record,
        [
            ("V_north", np.float64),
            ("V_east", np.float64),
            ("Y_amplitude", np.float64),
            ("N_amplitude", np.float64),
            ("omega", np.float64, (N_COMPONENTS,)),
            ("phase_Y", np.float64, (N_COMPONENTS,)),
            ("phase_N", np.float64, (N_COMPONENTS,)),
        ],
    )
)


@dataclasses.dataclass(frozen=True)
class Sea:
    """Current and disturbance; the default is calm water.

    Attributes
    ----------
    current_speed : float
        [m/s]
    current_direction_to : float
        Where the current flows to, from north clockwise [rad].
    sway_disturbance, yaw_disturbance : float
        Standard deviations of the random sway force and yaw moment, non-dimensional.
    correlation_time : float
        T U0 / L of their spectrum.
    """

    current_speed: float = 0.0
    current_direction_to: float = 0.0
    sway_disturbance: float = 0.0
    yaw_disturbance: float = 0.0
    correlation_time: float = 2.0

    def __post_init__(self):
        check_number("sea.current_speed", self.current_speed, 0.0, 10.0, "m/s")
        check_angle("sea.current_direction_to", self.current_direction_to)
        check_number("sea.sway_disturbance", self.sway_disturbance, 0.0, 1.0)
        check_number("sea.yaw_disturbance", self.yaw_disturbance, 0.0, 1.0)
        check_number("sea.correlation_time", self.correlation_time, 1e-3, 1e3)


CALM = Sea()
_STATES = Path(__file__).with_name("states.toml")


def available_seas() -> list[str]:
    """Names of the seas that come with the package."""
    return sorted(read_toml(_STATES))


def load_sea(name: str) -> Sea:
    """A named sea; an unknown name is a ConfigError with the nearest one."""
    states = read_toml(_STATES)
    return build(Sea, states[check_known("sea", name, states)], f"sea {name}")


def disturbance_frequencies(correlation_time: float) -> np.ndarray:
    """Component frequencies [rad/s] of a correlation time [s], shape (N_COMPONENTS,)."""
    quantile = (np.arange(N_COMPONENTS) + 0.5) / N_COMPONENTS
    return np.tan(0.5 * math.pi * quantile) / correlation_time


def disturbance_spectrum(omega, correlation_time: float):
    """One-sided spectral density [s] of unit variance at omega [rad/s]."""
    T = correlation_time
    return 2.0 / math.pi * T / (1.0 + (np.asarray(omega) * T) ** 2)


def sea_records(ships: list[Ship], sea: Sea | list[Sea] = CALM) -> np.ndarray:
    """SEA_DTYPE array, one row per ship, with all phases zero.

    Parameters
    ----------
    ships : list of Ship
        The disturbance scales with each ship and its nominal speed.
    sea : Sea or list of Sea
        One for all, or one each.
    """
    seas = [sea] * len(ships) if isinstance(sea, Sea) else list(sea)
    if len(seas) != len(ships):
        raise ConfigError(f"{len(seas)} seas given for {len(ships)} ships")
    records = np.zeros(len(ships), SEA_DTYPE)
    made: dict[tuple[int, int], int] = {}
    for i, (ship, s) in enumerate(zip(ships, seas, strict=True)):
        key = (id(ship), id(s))
        if key in made:
            records[i] = records[made[key]]
            continue
        made[key] = i
        records[i]["V_north"] = s.current_speed * math.cos(s.current_direction_to)
        records[i]["V_east"] = s.current_speed * math.sin(s.current_direction_to)
        force = 0.5 * ship.rho * ship.hull.L * ship.hull.d * ship.speed**2
        component = math.sqrt(2.0 / N_COMPONENTS)
        records[i]["Y_amplitude"] = component * s.sway_disturbance * force
        records[i]["N_amplitude"] = component * s.yaw_disturbance * force * ship.hull.L
        records[i]["omega"] = disturbance_frequencies(s.correlation_time * ship.hull.L / ship.speed)
    return records


def set_phases(records: np.ndarray, uniform: np.ndarray) -> None:
    """Set the phases of each row from uniform numbers in [0, 1), shape (n, N_PHASES)."""
    phases = 2.0 * math.pi * uniform
    records["phase_Y"] = phases[:, :N_COMPONENTS]
    records["phase_N"] = phases[:, N_COMPONENTS:]
