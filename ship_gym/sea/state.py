"""The sea a ship sails in: uniform current and a random low-frequency disturbance.

The disturbance stands for the slowly varying drift of a seaway. Its spectrum is that of a
first-order low-pass process, one-sided,

    S(omega) = (2 / pi) T / (1 + (omega T)^2),

with the time T = `correlation_time` L / U0. It is sampled by `N_HARMONICS` harmonics k omega_1 of
omega_1 = 0.4 / T, with amplitudes sqrt(2 S(k omega_1) omega_1) scaled to unit variance and phases
drawn at reset. It repeats after 15.7 T (about 970 s for KCS at 14.5 kn), more than an episode.
Standard deviations are given non-dimensional, by 1/2 rho L d U0^2 and 1/2 rho L^2 d U0^2.
"""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np

from ship_gym.config import ConfigError, build, check_angle, check_known, check_number, read_toml
from ship_gym.ships.particulars import Ship

N_HARMONICS = 16
N_PHASES = 2 * N_HARMONICS  # sway force and yaw moment
_FIRST = 0.4  # omega_1 T: 90 % of the spectrum's variance lies below the last harmonic

SEA_DTYPE = np.dtype(
    (
        np.record,
        [
            ("V_north", np.float64),
            ("V_east", np.float64),
            ("disturbed", np.int64),
            ("omega_1", np.float64),
            ("Y_std", np.float64),
            ("N_std", np.float64),
            *(
                (name, np.float64, (N_HARMONICS,))
                for name in ("amplitude", "Y_cos", "Y_sin", "N_cos", "N_sin")
            ),
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

    def scaled(self, scale: float) -> Sea:
        """The same sea for a model of a scale: current by Froude's law, the rest has no scale."""
        return dataclasses.replace(self, current_speed=self.current_speed / math.sqrt(scale))


CALM = Sea()
_STATES = Path(__file__).with_name("states.toml")


def available_seas() -> list[str]:
    """Names of the seas that come with the package."""
    return sorted(read_toml(_STATES))


def load_sea(name: str) -> Sea:
    """A named sea at full scale (`Sea.scaled` for a model); an unknown name is a ConfigError."""
    states = read_toml(_STATES)
    return build(Sea, states[check_known("sea", name, states)], f"sea {name}")


def disturbance_spectrum(omega, correlation_time: float):
    """One-sided spectral density [s] of unit variance at omega [rad/s]."""
    T = correlation_time
    return 2.0 / math.pi * T / (1.0 + (np.asarray(omega) * T) ** 2)


def disturbance_harmonics(correlation_time: float) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies [rad/s] and amplitudes of a unit-variance disturbance, shapes (N_HARMONICS,).

    Parameters
    ----------
    correlation_time : float
        T [s].
    """
    omega = _FIRST / correlation_time * np.arange(1, N_HARMONICS + 1)
    energy = disturbance_spectrum(omega, correlation_time)
    return omega, np.sqrt(2.0 * energy / energy.sum())


def sea_records(ships: list[Ship], sea: Sea | list[Sea] = CALM) -> np.ndarray:
    """SEA_DTYPE array, one row per ship; ``physics.disturbance.set_phases`` draws its phases.

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
        omega, amplitude = disturbance_harmonics(s.correlation_time * ship.hull.L / ship.speed)
        force = 0.5 * ship.rho * ship.hull.L * ship.hull.d * ship.speed**2
        records[i]["V_north"] = s.current_speed * math.cos(s.current_direction_to)
        records[i]["V_east"] = s.current_speed * math.sin(s.current_direction_to)
        records[i]["disturbed"] = s.sway_disturbance > 0.0 or s.yaw_disturbance > 0.0
        records[i]["omega_1"], records[i]["amplitude"] = omega[0], amplitude
        records[i]["Y_std"] = s.sway_disturbance * force
        records[i]["N_std"] = s.yaw_disturbance * force * ship.hull.L
    return records
