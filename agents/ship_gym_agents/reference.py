"""Reference headings: a change of the order is followed by a turn that the ship can make.

Everything is non-dimensional by L and U0, see ``ship_gym_agents.wave_filter``.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.conventions import wrap_angle
from ship_gym_agents.fresh import Fresh, begun
from ship_gym_agents.wave_filter import LinearShip, check_gains

# Sensor noise (gyro 0.1 deg, five standard deviations of a difference) and the curvature of a turn
# stay below it; an order changed by less is taken for noise.
JUMP = math.radians(1.5)
_LONGEST = 0.02  # integration step over L / U0


class OrderWatch:
    """Sees when the ordered heading changes: the measured error jumps by more than the ship turned.

    Jumps of less than `JUMP` beyond what the yaw rate explains are taken for motion.
    """

    def __init__(self, step: float):
        self._step, self._fresh = step, Fresh()
        self._before: tuple[np.ndarray | None, np.ndarray | None] = None, None

    def restart(self, rows: np.ndarray) -> None:
        """Begin anew in these rows with the next measurement."""
        self._fresh.add(rows)

    def __call__(self, psi: np.ndarray, r: np.ndarray) -> np.ndarray:
        """By how much the error jumped because the order changed [rad], shape (count,); mostly 0.

        Parameters
        ----------
        psi : numpy.ndarray
            Heading less ordered heading as measured [rad], shape (count,).
        r : numpy.ndarray
            Yaw rate r' as measured, shape (count,).
        """
        first = self._fresh.take()
        psi_before, r_before = (
            begun(old, first, new) for old, new in zip(self._before, (psi, r), strict=True)
        )
        turned = 0.5 * (r + r_before) * self._step
        jump = wrap_angle(psi - psi_before - turned)
        jump[np.abs(jump) < JUMP] = 0.0
        jump[first] = 0.0
        self._before = np.array(psi), np.array(r)
        return jump


@dataclasses.dataclass(frozen=True)
class Reference:
    """Third-order reference model with limited rate; numbers, or arrays of shape (count,).

    Attributes
    ----------
    frequency : float
        Natural frequency over U0 / L.
    rate_limit : float
        Largest reference yaw rate r'.
    acceleration_limit : float
        Largest dr'/dt' of the reference; the rudder must be able to give it.
    """

    frequency: float
    rate_limit: float
    acceleration_limit: float = 1.0

    def __post_init__(self):
        check_gains("reference", self)
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            if np.min(value) <= 0.0:
                raise ConfigError(f"reference.{field.name} = {value}: must be positive")


# where a tuning of turns begins and what it searches
TURN = Reference(frequency=5.0, rate_limit=1.0, acceleration_limit=1.5)
TUNED_TURN = {
    "reference.frequency": (0.8, 30.0, TURN.frequency),
    "reference.rate_limit": (0.05, 5.0, TURN.rate_limit),
    "reference.acceleration_limit": (0.05, 20.0, TURN.acceleration_limit),
}


class ReferenceModel:
    """Heading and yaw rate that lead from where the ship is to what is wanted.

    ``psi''' = w^3 (target - psi) - 3 w^2 psi' - 3 w psi''`` with ``psi'`` and ``psi''`` limited:
    three times the pole -w, so without overshoot. With damping 1 it is ``refModel3`` of Fossen's
    Python Vehicle Simulator (Fossen 2021, Handbook of Marine Craft Hydrodynamics and Motion
    Control, 2nd ed., chapter 12), whose yaw acceleration has no limit.

    Parameters
    ----------
    parameters : Reference
    step : float
        Control interval over L / U0.
    ship : LinearShip, optional
        Gives sway and rudder angle of the turn; without it they are zero.
    """

    def __init__(self, parameters: Reference, step: float, ship: LinearShip | None = None):
        self._p, self._ship = parameters, ship
        self._parts = math.ceil(step / _LONGEST)
        self._step = step / self._parts
        self._psi: np.ndarray | None = None
        self._fresh = Fresh()

    def restart(self, rows: np.ndarray) -> None:
        """Begin anew in these rows where the ship then is."""
        self._fresh.add(rows)

    def __call__(self, target, psi, jump):
        """Reference heading [rad], yaw rate r', sway v' and rudder [rad], each of shape (count,).

        The rudder angle is what turns the linear ship so, the sway what it does then.

        Parameters
        ----------
        target : numpy.ndarray
            Wanted heading [rad], in the axes of `psi`.
        psi : numpy.ndarray
            Heading of the ship less ordered heading [rad], from which the first call begins.
        jump : numpy.ndarray
            By how much headings less ordered heading have jumped, see `OrderWatch` [rad].
        """
        first, rest = self._fresh.take(), np.zeros(len(psi))
        if self._psi is None:
            self._r = self._a = self._v = rest
        now = begun(self._psi, first, psi)
        self._r, self._a, self._v = (begun(x, first, rest) for x in (self._r, self._a, self._v))
        w, limit, fastest = self._p.frequency, self._p.rate_limit, self._p.acceleration_limit
        now = now + jump
        for _ in range(self._parts):
            left = wrap_angle(target - now)
            jerk = w * (w * (w * left - 3.0 * self._r) - 3.0 * self._a)
            self._a = np.clip(self._a + self._step * jerk, -fastest, fastest)
            r = self._r + self._step * self._a
            self._a = np.where(np.abs(r) > limit, 0.0, self._a)
            self._r = np.clip(r, -limit, limit)
            now = now + self._step * self._r
            rudder = self._turning()
        self._psi = now = wrap_angle(now)
        return now, self._r, self._v, rudder

    def _turning(self):
        """Rudder angle [rad] of the linear ship in this turn; takes its sway one part on."""
        if self._ship is None:
            return np.zeros(len(self._r))
        rudder = self._ship.rudder_for(self._v, self._r, self._a)
        sway = self._ship.sway_acceleration(self._v, self._r, rudder)
        self._v = self._v + self._step * sway
        return rudder


@dataclasses.dataclass(frozen=True)
class Guidance:
    """Line-of-sight guidance to a track; lengths in L.

    The defaults were chosen by hand on kcs; ``ship-gym tune`` finds those of a ship.

    Attributes
    ----------
    look_ahead : float
        Distance ahead on the leg at which the line of sight meets it.
    integral : float
        kappa' of the integral law (ILOS).
    turn_radius : float
        Of the turn that is begun before a way-point.
    reach : float
        Distance before that turn at which it is ordered: what is lost until the ship turns.
    drift_time : float
        Time over which the drift is estimated (DriftLOS), over L / U0.
    """

    look_ahead: float = 3.0
    integral: float = 0.1
    turn_radius: float = 4.0
    reach: float = 0.0
    drift_time: float = 6.0

    def __post_init__(self):
        check_gains("guidance", self, signed=("reach",))
        for name in ("look_ahead", "drift_time"):
            if np.min(getattr(self, name)) <= 0.0:
                raise ConfigError(f"guidance.{name} = {getattr(self, name)}: must be positive")
