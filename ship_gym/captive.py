"""Captive tests: the forces of an imposed motion, as a towing tank measures them.

A gauge between carriage and model feels the water and the model's own inertia, added masses with
it: X - m_u u' + m_v v r + m_xG r^2 and so on, which is Yasukawa & Yoshimura's (2015) equation of
motion read the other way round. At rest in the towing (static tests) only the water is left.

Planar motion: the carriage runs with U, the model's path swings about it, its course angle is
chi = chi_0 sin(omega t). The model points along the path (pure yaw) or off it by the drift angle
(yaw with drift). So r = chi_0 omega cos(omega t) has amplitude r' U / L, and what goes with the yaw
rate is in the cosine ("out" of phase with the course), what goes with its derivative in the sine
("in" phase). In pure sway the model keeps its heading and sways with v = v' U cos(omega t): what
goes with the sway velocity is in the cosine, what goes with its derivative in the sine.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence

import numpy as np

from ship_gym.config import ConfigError, check_angle, check_known, check_number
from ship_gym.physics.dynamics import forces as ship_forces
from ship_gym.physics.dynamics import total
from ship_gym.physics.quantities import Controls, Force, Motion, Tables
from ship_gym.ships.files import Named
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Inertia, Ship
from ship_gym.ships.records import fleet
from ship_gym.simulation import self_propulsion

TESTS = ("drift", "rudder", "yaw", "yaw_drift")
AXES = ("X", "Y", "N", "T")  # T: thrust of all propellers
HARMONICS = 3
PARTS = ("mean", *(f"{p}{k if k > 1 else ''}" for k in (1, 2, 3) for p in ("in", "out")))
_SAMPLES = 48  # of a period; the forces have few harmonics
SWAY = 0.143  # amplitude of the path in planar motion [L], that of HMRI's tests of KVLCC2

_DRIFTS = tuple(math.radians(x) for x in (*range(-20, 0, 4), -2, 0, 2, *range(4, 21, 4)))
_RUDDERS = tuple(math.radians(x) for x in range(-35, 36, 5))
_YAWS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
_YAW_DRIFTS = tuple(math.radians(x) for x in (4, 8, 12))


@dataclasses.dataclass(frozen=True)
class Condition:
    """One run of a captive test, at the scale of the ship.

    Attributes
    ----------
    speed : float
        Of the carriage [m/s].
    n : float
        Propeller speed [rev/s].
    beta, delta : float
        Drift angle atan2(-v, u) and rudder angle [rad]; delta > 0 turns to starboard.
    yaw_rate : float
        r' = r L / U: constant, or its amplitude if the model swings.
    omega : float
        Of the swinging [rad/s]; 0: a static test or a rotating arm.
    sway : float
        v' = v / U: amplitude of the sway velocity of a model that sways and does not yaw.
    """

    speed: float
    n: float
    beta: float = 0.0
    delta: float = 0.0
    yaw_rate: float = 0.0
    omega: float = 0.0
    sway: float = 0.0

    def __post_init__(self) -> None:
        check_number("captive speed", self.speed, 1e-3, 100.0, "m/s")
        check_number("captive n", self.n, 0.0, 1e3, "rev/s")
        check_angle("captive beta", self.beta, math.pi)
        check_angle("captive delta", self.delta, math.pi / 2)
        check_number("captive yaw_rate", self.yaw_rate, -5.0, 5.0)
        check_number("captive omega", self.omega, 0.0, 100.0, "rad/s")
        check_number("captive sway", self.sway, -2.0, 2.0)
        if self.omega > 0.0 and (self.yaw_rate == 0.0) == (self.sway == 0.0):
            raise ConfigError("captive: a model that swings has a yaw rate or sways")
        if self.omega == 0.0 and self.sway != 0.0:
            raise ConfigError("captive sway: needs a frequency above zero; a steady one is a drift")


def kind(conditions: Sequence[Condition]) -> str:
    """Which of `TESTS` some runs are; with drift and rudder both a drift test.

    Raises
    ------
    ConfigError
        No run, or steady ones and such of a swinging model together.
    """
    if any(run.sway != 0.0 for run in conditions):
        raise ConfigError("captive runs: pure sway is for ship-gym fit-hull alone")
    swinging = {run.omega > 0.0 for run in conditions}
    if len(swinging) != 1:
        raise ConfigError("captive runs: either all of a swinging model or all steady, one or more")
    drift = any(run.beta != 0.0 for run in conditions)
    if any(run.yaw_rate != 0.0 for run in conditions):
        return "yaw_drift" if drift else "yaw"
    return "drift" if drift or all(run.delta == 0.0 for run in conditions) else "rudder"


def programme(
    ship: Named | Ship, test: str, speed: float | None = None, n: float | None = None
) -> list[Condition]:
    """Runs of a usual captive test.

    Parameters
    ----------
    ship : str, path or Ship
    test : str
        One of `TESTS`: drift to 20 deg, rudder to 35 deg or the gear's limit, pure yaw with r' to
        0.6, and that with 4, 8 and 12 deg of drift.
    speed, n : float, optional
        Speed [m/s], the nominal one, and propeller speed [rev/s], self-propulsion at that speed.
    """
    ship = load_ship(ship)
    check_known("captive test", test, TESTS)
    U = check_number("speed", ship.speed if speed is None else speed, 1e-3, 100.0, "m/s")
    n = self_propulsion(ship, U) if n is None else n
    if test == "drift":
        return [Condition(U, n, beta) for beta in _DRIFTS]
    if test == "rudder":
        limit = ship.gear.delta_max + 1e-9
        return [Condition(U, n, delta=delta) for delta in _RUDDERS if abs(delta) <= limit]
    drifts = (0.0,) if test == "yaw" else _YAW_DRIFTS
    return [
        Condition(U, n, beta, yaw_rate=r, omega=math.sqrt(r / SWAY) * U / ship.hull.L)
        for beta in drifts
        for r in _YAWS
    ]


def gauge(force: Force, motion: Motion, rates: Motion, inertia: Inertia) -> Force:
    """What a gauge between carriage and model reads, X, Y [N] and N [N m] at midship.

    Parameters
    ----------
    force : Force
        Of the water on hull, propeller and rudder, without added masses.
    motion, rates : Motion
        u, v [m/s], r [rad/s] and their derivatives in time.
    inertia : Inertia
        Of the model; its masses have the added ones in them.
    """
    (u, v, r), (du, dv, dr), b = motion, rates, inertia
    return Force(
        force.X - b.m_u * du + b.m_v * v * r + b.m_xG * r * r,
        force.Y - b.m_v * dv - b.m_xG * dr - b.m_u * u * r,
        force.N - b.I_r * dr - b.m_xG * (dv + u * r),
    )


def measure(ship: Named | Ship, conditions: Sequence[Condition]) -> list[dict[str, float]]:
    """Coefficients of captive runs: forces by 1/2 rho L d U^2, moments by that times L.

    Returns
    -------
    list of dict
        ``X``, ``Y``, ``N``, ``T`` of a steady run. Of a swinging model ``X_mean``, ``X_in``,
        ``X_out``, ``X_in2`` to ``T_out3``: f = mean + sum of in_k sin(k omega t) + out_k
        cos(k omega t).
    """
    ship = load_ship(ship)
    made = fleet([ship])
    record, tables = made.records[0], Tables(made.open_water[0], made.deflected[0])

    def read(run: Condition, motion: Motion, rates: Motion) -> tuple[float, ...]:
        own, flow = ship_forces(motion, Controls(run.delta, run.n), record, tables)
        X, Y, N = gauge(total(own), motion, rates, ship.inertia)
        q = 0.5 * ship.rho * ship.hull.L * ship.hull.d * run.speed**2
        return X / q, Y / q, N / (q * ship.hull.L), flow.thrust / q

    found = []
    for run in conditions:
        if run.omega == 0.0:
            found.append(dict(zip(AXES, read(run, *_steady(run, ship.hull.L)), strict=True)))
            continue
        phase = 2.0 * math.pi * np.arange(_SAMPLES) / _SAMPLES
        rows = [read(run, *_swinging(run, float(x), ship.hull.L)) for x in phase]
        found.append(_harmonics(phase, np.array(rows)))
    return found


def _steady(run: Condition, L: float) -> tuple[Motion, Motion]:
    """Motion of a model towed straight or on a rotating arm, and that it does not change."""
    U = run.speed
    motion = Motion(U * math.cos(run.beta), -U * math.sin(run.beta), run.yaw_rate * U / L)
    return motion, Motion(0.0, 0.0, 0.0)


def _swinging(run: Condition, phase: float, L: float) -> tuple[Motion, Motion]:
    """Motion and its derivatives where the course is chi_0 sin(phase), or v is v' U cos(phase)."""
    U, omega = run.speed, run.omega
    if run.sway != 0.0:
        c, s, v = math.cos(run.beta), math.sin(run.beta), run.sway * U
        there = Motion(U * c, v * math.cos(phase) - U * s, 0.0)
        return there, Motion(0.0, -v * omega * math.sin(phase), 0.0)
    chi_0 = run.yaw_rate * U / (L * omega)
    chi, r = chi_0 * math.sin(phase), chi_0 * omega * math.cos(phase)
    dr = -omega * omega * chi
    path = U / math.cos(chi)  # along the path, while the carriage keeps its speed
    rate = path * math.tan(chi) * r
    c, s = math.cos(run.beta), math.sin(run.beta)
    return Motion(path * c, -path * s, r), Motion(rate * c, -rate * s, dr)


def _harmonics(phase: np.ndarray, rows: np.ndarray) -> dict[str, float]:
    """Mean and harmonics of samples, shapes (m,) and (m, axes)."""
    found: dict[str, float] = {}
    for k, axis in enumerate(AXES):
        values = rows[:, k]
        parts = [values.mean()]
        for order in range(1, HARMONICS + 1):
            wave = np.exp(1j * order * phase)
            both = 2.0 * (values * wave).mean()
            parts += [both.imag, both.real]
        found |= {f"{axis}_{p}": float(x) for p, x in zip(PARTS, parts, strict=True)}
    return found
