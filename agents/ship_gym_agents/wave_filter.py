"""Filters between sensors and autopilot: what of the measured motion the rudder should answer.

Heading, yaw rate and sway velocity are measured with the wave-frequency motion and sensor noise on
top. The rudder cannot stop that motion; answering it only wears the steering gear. `LowPass` is the
plain remedy and costs phase. `Observer` is a Kalman filter of fixed gain on the linearised ship,
with the rudder as known input and slow disturbance as rudder bias, and with or without a
second-order model of the wave-frequency yaw. That is the structure of the heading autopilot in
Fossen & Perez (2009), IEEE Control Systems Magazine 29(6):32-46, with sway added and, other than
there, the wave-frequency yaw rate measured too.

Everything is non-dimensional by L and U0: t' = t U0 / L, r' = r L / U0, v' = v / U0. So a filter
carries over to a scaled ship.
"""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
from scipy.linalg import expm, solve_discrete_are

from ship_gym.config import ConfigError, check_fields
from ship_gym.conventions import DELTA, N, R, U, V, wrap_angle
from ship_gym.linear import LinearShip, linearise
from ship_gym.ships.particulars import Ship
from ship_gym.simulation import ShipSim, self_propulsion
from ship_gym_agents.fresh import Fresh, begun

_LARGEST = 1e3
_TRIAL_TURN = 20  # intervals of 1 full-scale s for which the rudder of a trial stays
_TRIAL_RUDDER = math.radians(6.0)


def check_gains(
    kind: str, instance: Any, signed: tuple[str, ...] = (), positive: tuple[str, ...] = ()
) -> None:
    """Refuse fields (numbers or arrays) that are not finite, too large, or negative and unsigned.

    Those of `positive` may not be zero either.

    Raises
    ------
    ConfigError
        Names the field, its value and the range.
    """
    names = [f.name for f in dataclasses.fields(instance)]
    names = [name for name in names if not dataclasses.is_dataclass(getattr(instance, name))]
    lowest = {name: -_LARGEST if name in signed else 0.0 for name in names}
    check_fields(kind, instance, {name: (low, _LARGEST, "-") for name, low in lowest.items()})
    for name in positive:
        if np.min(getattr(instance, name)) <= 0.0:
            raise ConfigError(f"{kind}.{name} = {getattr(instance, name)}: must be positive")


def identify(ship: Ship, intervals: int = 1200, seed: int = 0) -> LinearShip:
    """Linear model of a ship by least squares from a trial in calm water, as at commissioning.

    The rudder takes a new random angle within 6 deg every 20 full-scale seconds.

    Parameters
    ----------
    ship : Ship
    intervals : int
        Length of the trial [full-scale s].
    seed : int
        Of the rudder angles.
    """
    rng, n = np.random.default_rng(seed), self_propulsion(ship, ship.speed)
    sim, dt = ShipSim(ship, 1, parallel=False), 1.0 / ship.time_unit
    sim.set_interval(dt)
    sim.state[0, [U, N]] = ship.speed, n
    states = [sim.state[0].copy()]
    for k in range(intervals):
        if k % _TRIAL_TURN == 0:
            sim.commands[0] = rng.uniform(-_TRIAL_RUDDER, _TRIAL_RUDDER), n
        sim.advance()
        states.append(sim.state[0].copy())
    U0, L = ship.speed, ship.hull.L
    z = np.array(states)[:, [V, R, DELTA]] * [1.0 / U0, L / U0, 1.0]
    # Differences and means over an interval: the trapezoidal rule, second order. The constant takes
    # the rudder angle that a ship with one propeller needs to sail straight.
    slope = np.diff(z[:, :2], axis=0) / (dt * U0 / L)
    known = np.column_stack([0.5 * (z[1:] + z[:-1]), np.ones(intervals)])
    found = np.linalg.lstsq(known, slope, rcond=None)[0]
    digits = [float(f"{x:.4g}") for x in found[:3].T.ravel()]
    return LinearShip(*digits)


@dataclasses.dataclass(frozen=True)
class LowPass:
    """First-order low-pass filters; the derivative of the heading, the yaw rate, gives the lead.

    Numbers, or arrays of shape (count,).

    Attributes
    ----------
    T_psi, T_r, T_v : float
        Time constants for heading, yaw rate and sway velocity over L / U0; 0: as measured.
    """

    T_psi: float
    T_r: float
    T_v: float

    def __post_init__(self):
        check_gains("low_pass", self)

    def start(self, count: int, step: float) -> LowPassFilter:
        """Filter for `count` episodes with control interval `step` (over L / U0)."""
        return LowPassFilter(self, step)


class LowPassFilter:
    """`LowPass` at work; the first measurement is taken as it is."""

    def __init__(self, parameters: LowPass, step: float):
        p = parameters
        with np.errstate(divide="ignore"):
            self._share = [1.0 - np.exp(-step / np.asarray(T)) for T in (p.T_psi, p.T_r, p.T_v)]
        self._seen, self._fresh = (None, None, None), Fresh()

    def restart(self, rows: np.ndarray) -> None:
        """Begin anew in these rows with the next measurement."""
        self._fresh.add(rows)

    def __call__(self, psi, r, v, delta, jump):
        """Filtered psi [rad], r', v' and no bias; see `ObserverFilter`."""
        rows = self._fresh.take()
        before = [begun(old, rows, new) for old, new in zip(self._seen, (psi, r, v), strict=True)]
        change = wrap_angle(psi - before[0] - jump), r - before[1], v - before[2]
        psi = wrap_angle(before[0] + jump + self._share[0] * change[0])
        r, v = (before[k] + self._share[k] * change[k] for k in (1, 2))
        self._seen = psi, r, v
        return psi, r, v, 0.0


@dataclasses.dataclass(frozen=True)
class Observer:
    """Kalman filter of fixed gain on the linearised ship; only ratios of its noises matter.

    Numbers, or arrays of shape (count,). Noises are standard deviations over that of the measured
    yaw rate r', those of the ship's motion per square root of t'.

    Attributes
    ----------
    ship : LinearShip
    sway_noise, yaw_noise : float
        Of dv'/dt' and dr'/dt': what the model does not know.
    bias_noise : float
        Of the rudder bias [rad], the rudder angle that would make the slow yaw moment.
    heading_error : float
        Of the measured heading [rad].
    sway_error : float
        Of the measured v'.
    wave_frequency : float
        Of the wave-frequency yaw, encounter frequency over U0 / L; 0: without that model. The
        autopilot does not know the sea, so this is one number for all of them.
    wave_damping : float
        Its relative damping: how wide its band is.
    wave_noise : float
        Of the wave-frequency yaw acceleration.
    """

    ship: LinearShip
    sway_noise: float
    yaw_noise: float
    bias_noise: float
    heading_error: float
    sway_error: float
    wave_frequency: float = 0.0
    wave_damping: float = 0.3
    wave_noise: float = 1.0

    def __post_init__(self):
        check_gains("observer", self, positive=("bias_noise", "heading_error", "sway_error"))

    @classmethod
    def first(cls, ship: Ship, waves: bool = False) -> Observer:
        """Where tuning begins: the linearised ship, noises of a seaway; `waves`: with their yaw.

        Errors of heading and sway over that of the yaw rate are about what waves of sea state 5
        make of them and what sensors add.
        """
        linear = linearise(ship).steering
        digits = (float(f"{x:.4g}") for x in dataclasses.astuple(linear))
        return cls(
            LinearShip(*digits),
            sway_noise=0.5,
            yaw_noise=2.0,
            bias_noise=0.8,
            heading_error=0.05,
            sway_error=0.25,
            wave_frequency=18.0 if waves else 0.0,
            wave_noise=30.0,
        )

    def start(self, count: int, step: float) -> ObserverFilter:
        """Filter for `count` episodes with control interval `step` (over L / U0)."""
        return ObserverFilter(self, count, step)


class ObserverFilter:
    """`Observer` at work. States: psi, v', r', bias and, with waves, their yaw and yaw rate.

    It begins with the heading first measured on a ship that sails straight.
    """

    def __init__(self, parameters: Observer, count: int, step: float):
        names = [f.name for f in dataclasses.fields(Observer)[1:]]
        columns = [np.ravel(getattr(parameters, name)) for name in names]
        rows = np.stack(np.broadcast_arrays(*columns), axis=1)
        # Candidates of a tuning sail many episodes each: one Riccati equation per candidate.
        rows, which = np.unique(rows, axis=0, return_inverse=True)
        noises = [dict(zip(names, row, strict=True)) for row in rows.tolist()]
        designs = [_design(parameters.ship, noise, step) for noise in noises]
        self._F, self._B, self._K = (np.stack(m)[which.ravel()] for m in zip(*designs, strict=True))
        self._x, self._delta = np.zeros((count, self._F.shape[-1])), np.zeros(count)
        self._fresh = Fresh()

    def restart(self, rows: np.ndarray) -> None:
        """Begin anew in these rows with the next measurement."""
        self._fresh.add(rows)

    def __call__(self, psi, r, v, delta, jump):
        """Low-frequency motion from one measurement.

        Parameters
        ----------
        psi : numpy.ndarray
            Heading less ordered heading as measured [rad], shape (count,).
        r, v : numpy.ndarray
            Yaw rate r' and sway velocity v' as measured, shape (count,).
        delta : numpy.ndarray
            Rudder angle achieved [rad], shape (count,).
        jump : numpy.ndarray
            By how much `psi` jumped because the order changed [rad], shape (count,).

        Returns
        -------
        tuple
            psi [rad], r', v' and rudder bias [rad], each of shape (count,).
        """
        held = 0.5 * (delta + self._delta)
        x = (self._F @ self._x[:, :, None])[:, :, 0] + self._B * held[:, None]
        x[:, 0] += jump
        first = self._fresh.take()
        x[first] = 0.0
        x[first, 0] = psi[first]
        wave_psi, wave_r = (x[:, 4], x[:, 5]) if x.shape[1] == 6 else (0.0, 0.0)
        missed = np.stack(
            [wrap_angle(psi - x[:, 0] - wave_psi), v - x[:, 1], r - x[:, 2] - wave_r], axis=1
        )
        self._x = x = x + (self._K @ missed[:, :, None])[:, :, 0]
        x[:, 0] = wrap_angle(x[:, 0])
        self._delta = np.array(delta)
        return x[:, 0], x[:, 2], x[:, 1], x[:, 3]


def _design(ship: LinearShip, p: dict[str, float], step: float):
    """Transition matrix, input column and Kalman gain of one observer over one interval."""
    A = np.zeros((4, 4))
    A[0, 2] = 1.0
    A[1] = 0.0, ship.Y_v, ship.Y_r, -ship.Y_delta
    A[2] = 0.0, ship.N_v, ship.N_r, -ship.N_delta
    B = np.array([0.0, ship.Y_delta, ship.N_delta, 0.0])
    C = np.eye(3, 4)
    noise = [1e-6, p["sway_noise"], p["yaw_noise"], p["bias_noise"]]
    if p["wave_frequency"] > 0.0:
        w = p["wave_frequency"]
        wave = np.array([[0.0, 1.0], [-w * w, -2.0 * p["wave_damping"] * w]])
        A = np.block([[A, np.zeros((4, 2))], [np.zeros((2, 4)), wave]])
        B, noise = np.append(B, [0.0, 0.0]), [*noise, 0.0, p["wave_noise"]]
        C = np.column_stack([C, [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    m = len(A)
    held = expm(np.block([[A, B[:, None]], [np.zeros((1, m + 1))]]) * step)
    F = held[:m, :m]
    # Noise of one interval: the motion's adds up over it, the measurement's averages out.
    moved = np.diag(np.square(noise)) * step
    read = np.diag(np.square([p["heading_error"], p["sway_error"], 1.0])) / step
    P = solve_discrete_are(F.T, C.T, moved, read)
    K = np.linalg.solve(C @ P @ C.T + read, C @ P).T
    return F, held[:m, m], K
