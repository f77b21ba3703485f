"""PID heading autopilot with non-dimensional gains, which carry over to a scaled ship.

What it shares with other autopilots, filter and reference model: ``ship_gym_agents.autopilot``.
"""

from __future__ import annotations

import dataclasses
import math
import os
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, build, read_toml
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship
from ship_gym.tasks.columns import View
from ship_gym_agents.autopilot import Autopilot, wrapped
from ship_gym_agents.reference import Guidance, Reference
from ship_gym_agents.wave_filter import LowPass, Observer, check_gains

GAINS = Path(__file__).parent / "gains"


@dataclasses.dataclass(frozen=True)
class Gains:
    """Gains of ``delta = -(K_p e + K_d r' + K_i I + K_v v') + K_b b``; r' = r L / U0, v' = v / U0.

    Numbers, or arrays of shape (count,) with own gains for each episode (tuning). What has a
    default may be missing in a file.

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
    K_b : float
        Rudder angle by the rudder bias b that an observer estimates [rad / rad]; 0 without one.
    error_limit : float
        e is the heading error limited to +- this [rad]: a large turn becomes one at constant rate.
    low_pass, observer : LowPass, Observer, optional
        Wave filter, one of them at most; None: heading, r' and v' as they are measured.
    reference : Reference, optional
        Reference model for changes of the order; None: the order itself.
    guidance : Guidance
        For tracks; the heading autopilot does not use it.
    """

    K_p: float
    K_d: float
    K_i: float = 0.0
    K_v: float = 0.0
    K_b: float = 0.0
    error_limit: float = math.pi
    low_pass: LowPass | None = None
    observer: Observer | None = None
    reference: Reference | None = None
    guidance: Guidance = dataclasses.field(default_factory=Guidance)

    def __post_init__(self):
        check_gains("gains", self, signed=("K_v",))
        if self.low_pass is not None and self.observer is not None:
            raise ConfigError("gains: low_pass and observer are both given; allowed is one filter")
        if self.observer is None and np.any(np.asarray(self.K_b) != 0.0):
            raise ConfigError(f"gains.K_b = {self.K_b}: allowed is 0 without an observer")

    @property
    def wave_filter(self) -> LowPass | Observer | None:
        """The filter that is given."""
        return self.low_pass if self.observer is None else self.observer


@dataclasses.dataclass(frozen=True)
class GainsFile:
    """A file of gains: what they are for and how they were found."""

    ship: str
    gains: Gains
    tuning: dict[str, Any]
    versions: dict[str, str]


def gains_path(ship: str) -> Path:
    """File of the tuned gains of a ship of the package."""
    return GAINS / f"pid_{ship}.toml"


def own_gains() -> Path:
    """Folder of a user's gains for ships that the package has none for."""
    data = os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share"
    return Path(data) / "ship_gym" / "gains"


def place_for_gains(ship: str) -> Path:
    """Where newly tuned gains of a ship belong: the package of a checkout, else `own_gains`.

    Raises
    ------
    ConfigError
        An installed package has gains of this ship: what `pid` means there stays the same.
    """
    path = gains_path(ship)
    if (GAINS.parents[2] / "pyproject.toml").is_file():
        return path
    if path.is_file():
        raise ConfigError(
            f"ship {ship!r} comes with gains in the installed package; name a file for yours: "
            f"--out runs/{path.name}"
        )
    return own_gains() / path.name


def tuned_ships() -> list[str]:
    """Names of the ships with tuned gains."""
    files = [*GAINS.glob("pid_*.toml"), *own_gains().glob("pid_*.toml")]
    return sorted({path.stem.removeprefix("pid_") for path in files})


def load_gains(path: str | Path) -> GainsFile:
    """Read a file of gains, strictly; a wrong file is a ConfigError with its path and key."""
    return build(GainsFile, read_toml(path), str(path))


def gains_of(ship: Ship) -> Gains:
    """Tuned gains of a ship, or a ConfigError that says how to tune them."""
    path = gains_path(ship.name)
    if not path.is_file():
        path = own_gains() / path.name
    if not path.is_file():
        raise ConfigError(
            f"no PID gains for ship {ship.name!r} (tuned: {', '.join(tuned_ships())}); tune them "
            "with: ship-gym tune --ship NAME_OR_FILE --out mine.toml, then take the controller "
            "'mine.toml', in Python make_controller('mine.toml')"
        )
    return load_gains(path).gains


class PID(Autopilot):
    """PID on heading error and yaw rate, with sway feedback where it is tuned; batch first.

    The heading error ``psi_e = psi - psi_ordered`` and ``r`` are positive to starboard, and so is
    the turn that ``delta > 0`` makes: hence the minus of the law. The integral stands still while
    the rudder is saturated and the error would push it further (anti-windup by clamping). With
    rpm control the propeller keeps the self-propulsion speed. With a reference model, e and r' are
    less the reference, and with an observer v' too, and the rudder of that turn is added.

    Parameters
    ----------
    gains : Gains, optional
        The tuned gains of the ship if omitted.
    name : str
    """

    KIND = "pid"

    def __init__(self, gains: Gains | None = None, name: str = "pid"):
        super().__init__(gains, name)

    def reset(self, count: int, ship: Ship, scenario: Scenario) -> None:
        """Clear the integrals; `count` episodes of `scenario` with `ship` begin together."""
        super().reset(count, ship, scenario)
        self._integral = np.zeros(count)
        self._most = self._limit  # rudder angle of this law at which the rudder is hard over

    def _gains_for(self, ship: Ship) -> Gains:
        return gains_of(ship) if self.gains is None else self.gains

    def _rudder(self, seen: View, motion, wanted) -> np.ndarray:
        """Rudder angle [rad] that may exceed the largest; takes the integral one interval on."""
        g = self._g
        error = np.clip(wrapped(motion[0] - wanted[0]), -g.error_limit, g.error_limit)
        integral = self._integral + error * self._step
        damping = g.K_d * (motion[1] - wanted[1]) + g.K_v * (motion[2] - wanted[2])
        delta = -(g.K_p * error + g.K_i * integral + damping) + g.K_b * motion[3] + wanted[3]
        winding = (np.abs(delta) > self._most) & (delta * error < 0.0)
        self._integral = np.where(winding, self._integral, integral)
        return delta
