"""PID heading autopilot with non-dimensional gains, which carry over to a scaled ship."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, build, check_number, read_toml
from ship_gym.evaluation.controller import ConstantController
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship

GAINS = Path(__file__).parent / "gains"
_LARGEST = 1e3
# columns of the observation, ship_gym.tasks.heading.OBSERVATIONS
_SIN, _COS, _RATE, _SWAY = 0, 1, 2, 4


@dataclasses.dataclass(frozen=True)
class Gains:
    """Gains of ``delta = -(K_p e + K_d r' + K_i I + K_v v')`` with r' = r L / U0, v' = v / U0.

    Numbers, or arrays of shape (count,) with own gains for each episode (tuning).

    Attributes
    ----------
    K_p : float
        Rudder angle by heading error [rad / rad].
    K_d : float
        Rudder angle by yaw rate r' [rad].
    K_i : float
        Rudder angle by the integral of the heading error over t' = t U0 / L [rad / rad].
    K_v : float
        Rudder angle by sway velocity through the water [rad]; 0: a plain PID. Negative: the sway
        of a turn, which is away from it, calls for counter rudder early.
    error_limit : float
        e is the heading error limited to +- this [rad]: a large turn becomes one at constant rate.
    """

    K_p: float
    K_d: float
    K_i: float = 0.0
    K_v: float = 0.0
    error_limit: float = math.pi

    def __post_init__(self):
        for field in dataclasses.fields(self):
            low = -_LARGEST if field.name == "K_v" else 0.0
            for value in np.ravel(getattr(self, field.name)).tolist():
                check_number(f"gains.{field.name}", value, low, _LARGEST)


@dataclasses.dataclass(frozen=True)
class GainsFile:
    """A file of gains: what they are for and how they were found."""

    ship: str
    gains: Gains
    tuning: dict[str, Any]
    versions: dict[str, str]


def gains_path(ship: str) -> Path:
    """File of the tuned gains of a ship."""
    return GAINS / f"pid_{ship}.toml"


def tuned_ships() -> list[str]:
    """Names of the ships with tuned gains."""
    return sorted(path.stem.removeprefix("pid_") for path in GAINS.glob("pid_*.toml"))


def load_gains(path: str | Path) -> GainsFile:
    """Read a file of gains, strictly; a wrong file is a ConfigError with its path and key."""
    return build(GainsFile, read_toml(path), str(path))


def gains_of(ship: Ship) -> Gains:
    """Tuned gains of a ship, or a ConfigError that says how to tune them."""
    path = gains_path(ship.name)
    if not path.is_file():
        raise ConfigError(
            f"no PID gains for ship {ship.name!r} (tuned: {', '.join(tuned_ships())}); tune them "
            "with: python scripts/tune.py --ship NAME_OR_FILE"
        )
    return load_gains(path).gains


class PID:
    """PID on heading error and yaw rate, with sway feedback where it is tuned; batch first.

    The heading error ``psi_e = psi - psi_ordered`` and ``r`` are positive to starboard, and so is
    the turn that ``delta > 0`` makes: hence the minus of the law. The integral stands still while
    the rudder is saturated and the error would push it further (anti-windup by clamping). With
    rpm control the propeller keeps the self-propulsion speed.

    Parameters
    ----------
    gains : Gains, optional
        The tuned gains of the ship if omitted.
    name : str
    """

    def __init__(self, gains: Gains | None = None, name: str = "pid"):
        self.gains, self.name = gains, name

    def reset(self, count: int, ship: Ship, scenario: Scenario) -> None:
        """Clear the integrals; `count` episodes of `scenario` with `ship` begin together."""
        self._g = gains_of(ship) if self.gains is None else self.gains
        self._limit = ship.gear.delta_max
        # control interval over L / U0
        self._step = scenario.control_interval / ship.time_unit * ship.speed / ship.hull.L
        self._integral = np.zeros(count)
        steady = ConstantController()
        steady.reset(count, ship, scenario)
        self._action = np.array(steady.act(np.empty((count, 0))))

    def act(self, observations: np.ndarray) -> np.ndarray:
        """Actions in [-1, 1], shape (count, n_actions), for observations of shape (count, 9)."""
        seen = np.asarray(observations, dtype=np.float64)
        g, error = self._g, np.arctan2(seen[:, _SIN], seen[:, _COS])
        error = np.clip(error, -g.error_limit, g.error_limit)
        integral = self._integral + error * self._step
        damping = g.K_d * seen[:, _RATE] + g.K_v * seen[:, _SWAY]
        delta = -(g.K_p * error + g.K_i * integral + damping)
        winding = (np.abs(delta) > self._limit) & (delta * error < 0.0)
        self._integral = np.where(winding, self._integral, integral)
        action = self._action.copy()
        action[:, 0] = np.clip(delta / self._limit, -1.0, 1.0)
        return action
