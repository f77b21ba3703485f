"""LQG heading autopilot: Kalman filter and linear-quadratic regulator on the linearised ship.

The filter is `Observer`, with rudder bias and the yaw of the waves. The regulator minimises the
mean of ``psi^2 + rudder delta^2 + rate (d delta / dt')^2 + yaw_rate r'^2`` of the linear ship. Its
input is what the rudder moves in an interval: discrete algebraic Riccati equation, scipy. The
measured angle is part of the state, so nothing winds up while the rudder is hard over.
"""

from __future__ import annotations

import dataclasses
import math
from typing import ClassVar

import numpy as np
from scipy.linalg import expm, solve_discrete_are

from ship_gym.linear import LinearShip
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship
from ship_gym.tasks.columns import View
from ship_gym_agents.autopilot import Autopilot, wrapped
from ship_gym_agents.reference import TUNED_TURN, TURN, Reference
from ship_gym_agents.rudder_effect import NEEDS, RudderEffect
from ship_gym_agents.wave_filter import Observer, check_gains


@dataclasses.dataclass(frozen=True)
class LQGGains:
    """Weights of the regulator and its filter; numbers, or arrays of shape (count,).

    Attributes
    ----------
    observer : Observer
        Its ship is the regulator's too.
    rudder : float
        Weight of the square of the rudder angle, beyond that which the bias asks for, over that of
        the heading error.
    rate : float
        Weight of the square of d delta / dt'.
    yaw_rate : float
        Weight of the square of r'.
    K_b : float
        Share of the estimated rudder bias that the rudder carries.
    schedule : float
        Exponent on the effect of the rudder by speed and propeller; 0: not scheduled.
    error_limit : float
        The heading error is limited to +- this [rad].
    reference : Reference, optional
        Reference model for changes of the order; None: the order itself.
    """

    observer: Observer
    rudder: float = 0.1
    rate: float = 2e-5
    yaw_rate: float = 0.0
    K_b: float = 0.8
    schedule: float = 1.0
    error_limit: float = math.pi
    reference: Reference | None = None

    def __post_init__(self):
        check_gains("gains", self, signed=("K_b",), positive=("rudder", "rate"))

    @property
    def wave_filter(self) -> Observer:
        """The filter of the motion."""
        return self.observer


class LQG(Autopilot):
    """Regulator and filter of the linearised ship, see the module.

    Parameters
    ----------
    gains : LQGGains, optional
        The tuned gains of the ship if omitted; without any, `first_gains`.
    name : str
    """

    KIND = "lqg"
    needs = (*Autopilot.needs, *NEEDS)
    TUNED: ClassVar = {
        "rudder": (0.01, 2.0, 0.1),
        "rate": (1e-6, 1e-2, 2e-5),
        "K_b": (-0.5, 2.0, 0.8),
        "schedule": (0.0, 1.5, 1.0),
        "observer.sway_noise": (0.02, 20.0, 0.5),
        "observer.yaw_noise": (0.05, 50.0, 2.0),
        "observer.bias_noise": (0.02, 20.0, 0.8),
        "observer.wave_frequency": (8.0, 30.0, 18.0),
        "observer.wave_noise": (1.0, 300.0, 30.0),
        "yaw_rate": (0.0, 0.5, None),
        "error_limit": (0.05, 4.0, None),
        **TUNED_TURN,
    }

    def __init__(self, gains: LQGGains | None = None, name: str = "lqg"):
        super().__init__(gains, name)

    @classmethod
    def first_gains(cls, ship: Ship) -> LQGGains:
        """Weights of J_0.1, a filter with waves on the linearised ship."""
        return LQGGains(Observer.first(ship, waves=True))

    @classmethod
    def structures(cls, ship: Ship) -> dict[str, tuple[LQGGains, tuple[str, ...]]]:
        """One, for headings: weights and filter."""
        turning = ("yaw_rate", "error_limit", *TUNED_TURN)
        return {"": (cls.first_gains(ship), tuple(n for n in cls.TUNED if n not in turning))}

    @classmethod
    def course_structures(cls, ship: Ship) -> dict[str, tuple[LQGGains, tuple[str, ...]]]:
        """For changes of the order: the gains of headings, which turn by themselves or by a model.

        The filter stays as it is.
        """
        gains = cls.gains_for(ship)
        free = ("rudder", "rate", "K_b", "schedule", "yaw_rate", "error_limit")
        return {
            "turn": (dataclasses.replace(gains, reference=None), free),
            "turn by a reference model": (
                dataclasses.replace(gains, reference=gains.reference or TURN),
                (*free, *TUNED_TURN),
            ),
        }

    def reset(self, count: int, ship: Ship, scenario: Scenario) -> None:
        """Design filter and regulator; `count` episodes of `scenario` begin together."""
        super().reset(count, ship, scenario)
        self._K = regulators(self._g, self._step)
        self._schedule = RudderEffect(ship, self._step)

    def restart(self, rows: np.ndarray) -> None:
        """Begin anew in these rows; see `Autopilot.restart`."""
        super().restart(rows)
        self._schedule.restart(rows)

    def _felt(self, seen: View, delta: np.ndarray) -> np.ndarray:
        """Rudder angle [rad] at which the nominal ship would turn as this one does."""
        self._effect = self._schedule(seen) ** self._g.schedule
        return delta * self._effect

    def _rudder(self, seen: View, motion, wanted) -> np.ndarray:
        """Rudder angle [rad] that may exceed the largest."""
        g, delta = self._g, seen.rudder * self._limit * self._effect
        error = np.clip(wrapped(motion[0] - wanted[0]), -g.error_limit, g.error_limit)
        aside = error, motion[2] - wanted[2], motion[1] - wanted[1]
        carried = delta - wanted[3] - g.K_b * motion[3]
        K = self._K
        moved = -(sum(K[k] * aside[k] for k in range(3)) + K[3] * carried)
        return (delta + moved) / self._effect


def regulators(g: LQGGains, step: float) -> np.ndarray:
    """Feedback of psi [rad], v', r' and rudder angle [rad] of each episode, shape (4, 1 or count).

    Parameters
    ----------
    g : LQGGains
    step : float
        Control interval over L / U0.
    """
    weights = np.broadcast_arrays(*map(np.ravel, (g.rudder, g.rate, g.yaw_rate)))
    rows, which = np.unique(np.stack(weights, axis=1), axis=0, return_inverse=True)
    found = [regulator(g.observer.ship, step, *row)[0] for row in rows.tolist()]
    return np.stack(found, axis=1)[:, which.ravel()]


def regulator(ship: LinearShip, step: float, rudder: float, rate: float, yaw_rate: float = 0.0):
    """Linear-quadratic regulator of psi, v', r' and the rudder angle.

    Returns
    -------
    K : numpy.ndarray
        Of ``moved = -K x``, how far the rudder goes in an interval, shape (4,).
    P : numpy.ndarray
        ``x P x`` is the cost from x on, over `step`, shape (4, 4).
    """
    A, B = over_interval(ship, step)
    Q, R = np.diag([1.0, 0.0, yaw_rate, rudder]), np.array([[rate / step**2]])
    P = solve_discrete_are(A, B, Q, R)
    return np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A)[0], P


def over_interval(ship: LinearShip, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Transition of psi, v', r', delta over an interval in which the rudder moves evenly by u.

    Returns
    -------
    A, B : numpy.ndarray
        Shapes (4, 4) and (4, 1).
    """
    slopes = np.zeros((5, 5))  # of psi, v', r', delta and u, which is d delta / dt' times step
    slopes[0, 2] = 1.0
    slopes[1:3, 1:3], slopes[1:3, 3] = ship.A, ship.B
    slopes[3, 4] = 1.0 / step
    held = expm(slopes * step)
    return held[:4, :4], held[:4, 4:]
