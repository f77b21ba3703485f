"""Linear model of a ship about straight sailing, by finite differences of the kernels that sail.

The speed is held by self-propulsion and the rudder is at its neutral angle. From it: Nomoto's
gain and time constants, and whether the ship is stable on her course.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, check_fields, check_number
from ship_gym.physics.dynamics import accelerations, total
from ship_gym.physics.dynamics import forces as ship_forces
from ship_gym.physics.quantities import Tables
from ship_gym.ships.files import Named
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Ship
from ship_gym.ships.records import fleet
from ship_gym.simulation import self_propulsion
from ship_gym.stopping import neutral_angle

_LARGEST = 1e3
_STEP = 1e-4  # of u', v', r', the rudder angle [rad] and n / n0: central differences
_WITHIN = 0.1  # error of the linear model, by its own value, that ends its range
_RANGES = {"v": 0.5, "r": 1.5, "delta": math.radians(35.0)}  # how far a range is looked for


@dataclasses.dataclass(frozen=True)
class LinearShip:
    """Small motions about straight sailing, non-dimensional by L and U0.

    ``dv'/dt' = Y_v v' + Y_r r' + Y_delta delta``, ``dr'/dt' = N_v v' + N_r r' + N_delta delta``;
    v' = v / U0, r' = r L / U0, t' = t U0 / L, delta [rad]. Accelerations, not forces: the mass is
    in the numbers, and the turning of the axes too.
    """

    Y_v: float
    Y_r: float
    Y_delta: float
    N_v: float
    N_r: float
    N_delta: float

    def __post_init__(self) -> None:
        names = [f.name for f in dataclasses.fields(self)]
        check_fields("linear_ship", self, dict.fromkeys(names, (-_LARGEST, _LARGEST, "-")))
        if self.N_delta <= 0.0:
            raise ConfigError(f"linear_ship.N_delta = {self.N_delta}: must be positive")

    def rudder_for(self, v: Any, r: Any, r_dot: Any) -> Any:
        """Rudder angle [rad] that gives the yaw acceleration dr'/dt' `r_dot` at v' and r'."""
        return (r_dot - self.N_v * v - self.N_r * r) / self.N_delta

    def sway_acceleration(self, v: Any, r: Any, delta: Any) -> Any:
        """dv'/dt' at v', r' and rudder angle [rad]."""
        return self.Y_v * v + self.Y_r * r + self.Y_delta * delta

    @property
    def A(self) -> np.ndarray:
        """Matrix of v' and r', shape (2, 2)."""
        return np.array([[self.Y_v, self.Y_r], [self.N_v, self.N_r]])

    @property
    def B(self) -> np.ndarray:
        """Column of the rudder angle, shape (2,)."""
        return np.array([self.Y_delta, self.N_delta])

    @property
    def nomoto(self) -> Nomoto:
        """Nomoto's numbers of this ship, non-dimensional: K' = K L / U0, T' = T U0 / L."""
        determinant = self.Y_v * self.N_r - self.Y_r * self.N_v
        slope = self.N_v * self.Y_delta - self.Y_v * self.N_delta  # K T1 T2 without the units
        T3 = self.N_delta / slope
        half = -0.5 * (self.Y_v + self.N_r)
        apart = half * half - determinant
        if determinant == 0.0 or apart < 0.0:
            T1 = T2 = math.nan
        else:  # -1 / eigenvalue: the slower one first
            fast = half + math.copysign(math.sqrt(apart), half)
            T1, T2 = fast / determinant, 1.0 / fast
        K = slope / determinant if determinant else math.inf
        T = 2.0 * half / determinant - T3 if determinant else math.inf
        return Nomoto(K, T1, T2, T3, T)


@dataclasses.dataclass(frozen=True)
class Nomoto:
    """``T1 T2 r'' + (T1 + T2) r' + r = K (delta + T3 delta')`` and ``T r' + r = K delta``.

    The second-order model of Nomoto, Taguchi, Honda & Hirano (1957), On the steering qualities of
    ships, International Shipbuilding Progress 4(35), and its first-order equivalent with
    T = T1 + T2 - T3; a ship that is unstable on her course has K, T1 and T below zero.

    Attributes
    ----------
    K : float
        Yaw rate by rudder angle in a steady turn [1/s].
    T1, T2, T3, T : float
        [s]; T1 is that of the slower motion. nan where sway and yaw swing (complex eigenvalues).
    """

    K: float
    T1: float
    T2: float
    T3: float
    T: float

    def scaled(self, time: float) -> Nomoto:
        """The same with times in units of 1 / `time`: [s] from primes with L / U0 [s]."""
        return Nomoto(self.K / time, *(t * time for t in (self.T1, self.T2, self.T3, self.T)))


@dataclasses.dataclass(frozen=True, eq=False)
class LinearModel:
    """Linear model of a ship about straight sailing.

    ``d(u, v, r)/dt = A (u - speed, v, r) + B (delta - delta0, n - n0)`` through the water.

    Attributes
    ----------
    ship : str
        Name.
    L, speed : float
        Length [m] and speed through the water [m/s], which primes are made with.
    delta0, n0 : float
        Rudder angle [rad] and propeller speed [rev/s] about which it is.
    A, B : numpy.ndarray
        Shapes (3, 3) and (3, 2), SI.
    left : numpy.ndarray
        Accelerations there [m/s2], [rad/s2], shape (3,): not zero where one propeller pushes the
        stern aside, or where `n` was given.
    valid : dict
        Largest v', r' and rudder angle [rad] from there, each alone and to both sides, at which
        the sway and yaw accelerations that the ship feels are within 10 % of the linear ones
        (as a vector, sway in L).
    """

    ship: str
    L: float
    speed: float
    delta0: float
    n0: float
    A: np.ndarray
    B: np.ndarray
    left: np.ndarray
    valid: dict[str, float]

    @property
    def time(self) -> float:
        """L / U [s]."""
        return self.L / self.speed

    @property
    def A_prime(self) -> np.ndarray:
        """A of u', v', r' and t', shape (3, 3)."""
        units = np.array([self.speed, self.speed, self.speed / self.L])
        return self.A * units / units[:, None] * self.time

    @property
    def B_prime(self) -> np.ndarray:
        """B of delta [rad] and n / n0, in u', v', r' and t', shape (3, 2)."""
        units = np.array([self.speed, self.speed, self.speed / self.L])
        return self.B * [1.0, self.n0] / units[:, None] * self.time

    @property
    def steering(self) -> LinearShip:
        """Sway and yaw by themselves, non-dimensional."""
        a, b = self.A_prime, self.B_prime
        return LinearShip(*(float(x) for k in (1, 2) for x in (a[k, 1], a[k, 2], b[k, 0])))

    @property
    def nomoto(self) -> Nomoto:
        """Nomoto's numbers [1/s], [s]."""
        return self.steering.nomoto.scaled(self.time)

    @property
    def eigenvalues(self) -> np.ndarray:
        """Of sway and yaw [1/s], complex, shape (2,), the slower one first."""
        found = np.linalg.eigvals(self.A[1:, 1:])
        return found[np.argsort(np.abs(found), kind="stable")]

    @property
    def stable(self) -> bool:
        """Whether she goes straight by herself with the rudder neutral (both decay)."""
        return bool((self.eigenvalues.real < 0.0).all())

    def as_dict(self) -> dict:
        """Everything as numbers and lists for JSON; nan becomes None."""
        nomoto, prime = self.nomoto, self.steering.nomoto
        return {
            "ship": self.ship,
            "speed": self.speed,
            "rudder": self.delta0,
            "n": self.n0,
            "A": self.A.tolist(),
            "B": self.B.tolist(),
            "A_prime": self.A_prime.tolist(),
            "B_prime": self.B_prime.tolist(),
            "left": self.left.tolist(),
            "steering": dataclasses.asdict(self.steering),
            "nomoto": {k: _number(x) for k, x in dataclasses.asdict(nomoto).items()},
            "nomoto_prime": {k: _number(x) for k, x in dataclasses.asdict(prime).items()},
            "eigenvalues": [[float(x.real), float(x.imag)] for x in self.eigenvalues],
            "course_stable": self.stable,
            "valid": self.valid,
        }


def linearise(
    ship: Named | Ship, speed: float | None = None, n: float | None = None
) -> LinearModel:
    """Linear model of a ship about straight sailing in calm deep water, rudder neutral.

    Central differences of forces and accelerations of ``ship_gym.physics`` with steps of 1e-4 in
    u', v', r', delta [rad] and n / n0, so a ship whose sides differ gets the mean of both.

    Parameters
    ----------
    ship : str, path or Ship
    speed : float, optional
        Through the water [m/s]; the ship's nominal one if omitted.
    n : float, optional
        Propeller speed [rev/s]; self-propulsion at `speed` if omitted.

    Returns
    -------
    LinearModel

    Raises
    ------
    ConfigError
        A speed that is not positive or that the engine cannot hold, or a wrong propeller speed.
    """
    ship = load_ship(ship)
    U = check_number("speed", ship.speed if speed is None else speed, 0.01, 100.0, "m/s")
    if n is None:
        n = self_propulsion(ship, U)
    else:
        n = check_number("n", n, 0.01 * ship.engine.n_max, ship.engine.n_max, "rev/s")
    L, delta = ship.hull.L, neutral_angle(ship)
    units = np.array([U, U, U / L, 1.0, n])
    there = np.array([U, 0.0, 0.0, delta, n])
    slopes = np.empty((3, 5))
    feels = _acceleration(ship)
    for k, unit in enumerate(units):
        aside = np.zeros(5)
        aside[k] = _STEP * unit
        slopes[:, k] = (feels(there + aside) - feels(there - aside)) / (2.0 * _STEP * unit)
    left = feels(there)
    valid = {
        name: _reach(feels, there, left, slopes[:, k], k, units[k], limit, L)
        for k, (name, limit) in zip((1, 2, 3), _RANGES.items(), strict=True)
    }
    return LinearModel(ship.name, L, U, delta, n, slopes[:, :3], slopes[:, 3:], left, valid)


def _acceleration(ship: Ship) -> Callable[[np.ndarray], np.ndarray]:
    """Function of (u, v, r, delta, n) to u', v' [m/s2], r' [rad/s2] in calm water."""
    made = fleet([ship])
    record, tables = made.records[0], Tables(made.open_water[0], made.deflected[0])

    def feels(at: np.ndarray) -> np.ndarray:
        u, v, r, delta, n = at.tolist()
        own, _ = ship_forces((u, v, r), (delta, n), record, tables)
        force = total(own)
        return np.array(accelerations((u, v, r), force.X, force.Y, force.N, record.inertia))

    return feels


def _reach(
    feels: Any, there: Any, left: Any, slope: Any, k: int, unit: Any, limit: float, L: float
) -> float:
    """How far along axis `k` (in its unit) the linear accelerations hold to `_WITHIN`."""
    axes = np.array([1.0, L])  # the yaw acceleration as that of a point at a distance L
    reached = 0.0
    for share in np.linspace(0.02, 1.0, 50):
        for side in (1.0, -1.0):
            aside = np.zeros(5)
            aside[k] = side * share * limit * unit
            wrong = (feels(there + aside) - left - slope * aside[k])[1:] * axes
            if np.hypot(*wrong) > _WITHIN * np.hypot(*(slope[1:] * aside[k] * axes)):
                return reached
        reached = float(f"{share * limit:.3g}")
    return reached


def _number(x: float) -> float | None:
    return x if math.isfinite(x) else None
