"""35 deg turning circles of KCS to both sides, in the forces that Stern et al. (2021) compare."""

from __future__ import annotations

import dataclasses
import functools
import math

import numpy as np

from reproduce.surge import hull_surge_terms
from ship_gym.conventions import FLOW_THRUST, G
from ship_gym.csv_file import read_csv
from ship_gym.manoeuvres import TurningCircle, turning_circle
from ship_gym.reports.balance import last_turn, steady_balance
from ship_gym.ships.files import DATA
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Ship
from ship_gym.simulation import self_propulsion, straight_forces

ANGLE = math.radians(35.0)
FROUDE_NUMBERS = (0.157, 0.26)
SIDES = {"starboard": 1.0, "port": -1.0}
AXES = ("X", "Y", "N")
OPEN_WATER = DATA / "kcs_model" / "kp505_open_water.csv"


@dataclasses.dataclass(frozen=True)
class Turn:
    """Steady part of a turning circle to one side; signs as if it were to starboard.

    Attributes
    ----------
    circle : TurningCircle
    speed : float
        Steady speed U [m/s].
    forces : dict
        Axis to component to force [N] or yaw moment [N m]: X has ``R_0`` apart from ``hull``;
        ``inertia`` is that of ``reports.balance``.
    """

    ship: Ship
    circle: TurningCircle
    speed: float
    forces: dict[str, dict[str, float]]

    def scale(self, axis: str) -> float:
        """Force [N] or moment [N m] that is 1 in primes: steady speed, L d (and L^2 d)."""
        h = self.ship.hull
        q = 0.5 * self.ship.rho * h.L * h.d * self.speed**2
        return q * h.L if axis == "N" else q

    def prime(self, axis: str, component: str) -> float:
        """Dimensionless force or moment, as Yasukawa & Yoshimura (2015) make it."""
        return self.forces[axis][component] / self.scale(axis)

    def drift(self, x: float) -> float:
        """Drift angle [rad] at `x` [L] from midship, beta_0 - x' r', as the source has it."""
        circle = self.circle
        return abs(circle.steady_drift) - x * abs(circle.steady_yaw_rate)

    @property
    def J_B(self) -> float:
        """U/(nD) of the steady turn."""
        return self.speed / (self.n * self.ship.propeller.D)

    @property
    def n(self) -> float:
        """Propeller speed [rev/s]."""
        return float(self.circle.trajectory["n"][-1])


@dataclasses.dataclass(frozen=True)
class Pair:
    """Both turns at one Froude number, and the approach.

    Attributes
    ----------
    froude, speed, n, thrust : float
        Of the approach, at self-propulsion [-], [m/s], [rev/s], [N].
    turns : dict
        ``starboard`` and ``port``.
    """

    ship: Ship
    froude: float
    speed: float
    n: float
    thrust: float
    turns: dict[str, Turn]

    @property
    def J(self) -> float:
        """U0/(nD) of the approach."""
        return self.speed / (self.n * self.ship.propeller.D)

    def excess(self, axis: str, component: str) -> float:
        """Magnitude to port over that to starboard, in primes [% of their mean]."""
        return self.percent(*(abs(t.prime(axis, component)) for t in self.turns.values()))

    @staticmethod
    def percent(starboard: float, port: float) -> float:
        """Port minus starboard [% of the mean], the negative of the source's difference."""
        return 200.0 * (port - starboard) / (port + starboard)


@functools.cache
def turns(froude: float) -> Pair:
    """Both 35 deg turns of the KCS model at a Froude number, revolutions held."""
    ship = load_ship("kcs_model")
    speed = froude * math.sqrt(G * ship.hull.L)
    n = self_propulsion(ship, speed)
    thrust = float(straight_forces(ship, speed, n)[-1][FLOW_THRUST])
    made = {name: _turn(ship, side, speed, n) for name, side in SIDES.items()}
    return Pair(ship, froude, speed, n, thrust, made)


def _turn(ship: Ship, side: float, speed: float, n: float) -> Turn:
    circle = turning_circle(ship, side * ANGLE, speed, n)
    balance = steady_balance(ship, circle.trajectory)
    mean = last_turn(circle.trajectory)
    forces = {
        axis: {name: (1.0 if k == 0 else side) * values[k] for name, values in balance.items()}
        for k, axis in enumerate(AXES)
    }
    R_0 = hull_surge_terms(ship, mean["u"], mean["v"], mean["r"])["R_0"]
    forces["X"] = {"R_0": R_0, **forces["X"], "hull": forces["X"]["hull"] - R_0}
    return Turn(ship, circle, math.hypot(mean["u"], mean["v"]), forces)


def thrust_identity(ship: Ship, thrust: float, speed: float, n: float) -> float:
    """Wake coefficient 1 - w at which KP505 in open water gives a thrust [N], NMRI's points."""
    points = read_csv(OPEN_WATER).columns
    K_T = thrust / (ship.rho * n**2 * ship.propeller.D**4)
    J = np.interp(-K_T, -points["K_T"], points["J"])  # K_T falls with J
    return float(J) * n * ship.propeller.D / speed


def flow_angle(ship: Ship, thrust: float, speed: float, n: float) -> float:
    """Angle of the inflow at 70 % radius [rad], wake by thrust identity, race by momentum theory.

    Estimated: half of the race's speed is there at the disc, no swirl. The pitch angle less this
    is the angle of attack, so a difference of two needs no pitch.
    """
    D = ship.propeller.D
    u_A = thrust_identity(ship, thrust, speed, n) * speed
    race = math.sqrt(u_A**2 + 8.0 * thrust / (ship.rho * math.pi * D**2))
    return math.atan2(0.5 * (u_A + race), 0.7 * math.pi * n * D)
