"""PID heading autopilot with non-dimensional gains, which carry over to a scaled ship.

What it shares with other autopilots, filter and reference model: ``ship_gym_agents.autopilot``.
"""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship
from ship_gym.tasks.columns import View
from ship_gym_agents import gains_files
from ship_gym_agents.autopilot import Autopilot, wrapped
from ship_gym_agents.gains_files import GainsFile
from ship_gym_agents.reference import TUNED_TURN, TURN, Guidance, Reference
from ship_gym_agents.wave_filter import LowPass, Observer, check_gains, identify

_FEEDBACK = ("K_p", "K_d", "K_v")
_OBSERVER = (*_FEEDBACK, "K_b", "observer.sway_noise", "observer.yaw_noise", "observer.bias_noise")
# Of the measured heading and sway over the yaw rate: about what waves of sea state 5 make of them
# and what sensors add. Free, they brought nothing.
_ERRORS = {"heading_error": 0.05, "sway_error": 0.25}


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
        of a turn, which is away from it, calls for counter rudder early. Where it does, K_d may
        be negative too.
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
        check_gains("gains", self, signed=("K_d", "K_i", "K_v", "K_b"))
        if self.low_pass is not None and self.observer is not None:
            raise ConfigError("gains: low_pass and observer are both given; allowed is one filter")
        if self.observer is None and np.any(np.asarray(self.K_b) != 0.0):
            raise ConfigError(f"gains.K_b = {self.K_b}: allowed is 0 without an observer")

    @property
    def wave_filter(self) -> LowPass | Observer | None:
        """The filter that is given."""
        return self.low_pass if self.observer is None else self.observer


def load_gains(path: str | Path) -> GainsFile:
    """Read a file of gains of a PID or of a guidance on top of it."""
    return gains_files.load_gains(path, PID)


def gains_of(ship: Ship) -> Gains:
    """Tuned gains of the PID of a ship, or a ConfigError that says how to tune them."""
    return gains_files.tuned_file(ship, PID).gains


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

    KIND: ClassVar[str] = "pid"  # in the names of gains files
    # gain -> lowest, highest, where tuning begins, see ``ship_gym_agents.tuning.ranges``
    TUNED: ClassVar[dict[str, tuple[float, float, float | None]]] = {
        "K_p": (0.2, 20.0, 3.0),
        "K_d": (-3.0, 10.0, 1.5),
        "K_i": (-0.5, 1.0, 0.1),
        "K_v": (-12.0, 6.0, -2.0),
        "K_b": (-0.5, 2.0, 0.8),
        "low_pass.T_r": (0.01, 1.0, 0.1),
        "low_pass.T_v": (0.01, 2.0, 0.2),
        "observer.sway_noise": (0.02, 20.0, 0.5),
        "observer.yaw_noise": (0.05, 50.0, 2.0),
        "observer.bias_noise": (0.02, 20.0, 0.8),
        "observer.wave_frequency": (8.0, 30.0, 18.0),
        "observer.wave_noise": (1.0, 300.0, 30.0),
        "error_limit": (0.05, 4.0, None),
        **TUNED_TURN,
    }

    @classmethod
    def first_gains(cls, ship: Ship) -> Gains:
        """Gains that tuning begins at: with an observer on the linear model of the ship."""
        start: dict[str, Any] = {
            name.removeprefix("observer."): cls.TUNED[name][2] for name in _OBSERVER
        }
        feedback = {name: start.pop(name) for name in (*_FEEDBACK, "K_b")}
        return Gains(**feedback, observer=Observer(identify(ship), **_ERRORS, **start))

    @classmethod
    def gains_for(cls, ship: Ship, task: str | None = None) -> Gains:
        """The tuned gains of a ship; without any, a ConfigError that says how to tune them."""
        return gains_files.tuned_file(ship, cls, task).gains

    @classmethod
    def structures(cls, ship: Ship) -> dict[str, tuple[Gains, tuple[str, ...]]]:
        """Structure -> gains to begin at and names of those that are free; simple ones first."""
        plain, observed = Gains(K_p=0.0, K_d=0.0), cls.first_gains(ship)
        filtered = dataclasses.replace(plain, low_pass=LowPass(T_psi=0.0, T_r=0.0, T_v=0.0))
        with_waves = (*_OBSERVER, "observer.wave_frequency", "observer.wave_noise")
        low_pass = (*_FEEDBACK, "K_i", "low_pass.T_r", "low_pass.T_v")
        return {
            "PD": (plain, ("K_p", "K_d")),
            "PID + sway": (plain, (*_FEEDBACK, "K_i")),
            "PID + sway, low-pass": (filtered, low_pass),
            "PD + sway, observer": (observed, _OBSERVER),
            "PD + sway, observer with waves": (observed, with_waves),
        }

    @classmethod
    def course_structures(cls, ship: Ship) -> dict[str, tuple[Gains, tuple[str, ...]]]:
        """For changes of the order: the gains of headings, which turn by themselves or by a model.

        The filter stays as it is.
        """
        path = gains_files.find_gains(ship.name)
        gains = cls.first_gains(ship) if path is None else load_gains(path).gains
        feedback = (*_FEEDBACK, "K_b") if gains.observer is not None else _FEEDBACK
        free = (*feedback, "error_limit")
        return {
            "turn": (dataclasses.replace(gains, reference=None), free),
            "turn by a reference model": (
                dataclasses.replace(gains, reference=gains.reference or TURN),
                (*free, *TUNED_TURN),
            ),
        }

    def __init__(self, gains: Gains | None = None, name: str = "pid"):
        super().__init__(gains, name)

    def reset(self, count: int, ship: Ship, scenario: Scenario) -> None:
        """Clear the integrals; `count` episodes of `scenario` with `ship` begin together."""
        super().reset(count, ship, scenario)
        self._integral = np.zeros(count)
        self._most: Any = self._limit  # rudder angle of this law at which the rudder is hard over

    def restart(self, rows: np.ndarray) -> None:
        """Clear the integrals of these rows; see `Autopilot.restart`."""
        super().restart(rows)
        self._integral[rows] = 0.0

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
