"""Power on a straight course in calm water, beside published points of self-propulsion.

The classic balance of naval architecture: thrust identity in open water, no rudder, no weather.
The simulation finds the same point with its own kernels, ``simulation.self_propulsion``; a test
holds the two together.
"""

from __future__ import annotations

import dataclasses
import math

from ship_gym.config import ConfigError, check_number
from ship_gym.conventions import KNOT
from ship_gym.roots import root
from ship_gym.ships.open_water import coefficients
from ship_gym.ships.particulars import PropulsionPoint, Ship


@dataclasses.dataclass(frozen=True)
class Powering:
    """Self-propulsion at one speed; thrust and torque are of all propellers together.

    Attributes
    ----------
    speed : float
        Through the water [m/s].
    n : float
        Propeller speed [rev/s].
    resistance, thrust : float
        [N].
    torque : float
        [N m].
    """

    speed: float
    n: float
    resistance: float
    thrust: float
    torque: float

    @property
    def effective_power(self) -> float:
        """Resistance times speed [W]."""
        return self.resistance * self.speed

    @property
    def delivered_power(self) -> float:
        """At the propellers, 2 pi n Q [W]; no losses of shaft and gear, eta_R = 1."""
        return 2.0 * math.pi * self.n * self.torque

    @property
    def efficiency(self) -> float:
        """Effective by delivered power, quasi-propulsive."""
        return self.effective_power / self.delivered_power


def powering(ship: Ship, speed: float | None = None) -> Powering:
    """Power that a ship needs on a straight course.

    R = 1/2 rho L d R0' U^2, T = R / (1 - t), K_T(J_A) = T / (rho n^2 D^4) with
    J_A = (1 - w) U / (n D), each propeller carrying its share.

    Parameters
    ----------
    ship : Ship
    speed : float, optional
        Through the water [m/s]; the nominal speed if omitted.

    Raises
    ------
    ConfigError
        Speed out of range, or beyond the engine's largest propeller speed.
    """
    U = check_number("speed", ship.speed if speed is None else speed, 1e-6, 100.0, "m/s")
    h, p, rho, units = ship.hull, ship.propeller, ship.rho, ship.propellers
    resistance = 0.5 * rho * h.L * h.d * h.R_0 * U * U
    each = resistance / (1.0 - p.t_P) / units

    def forces(n: float) -> tuple[float, float]:
        K_T, K_Q = coefficients(ship.open_water, (1.0 - p.w_P0) * U / (n * p.D))
        q = rho * n * n * p.D**4
        return float(q * K_T), float(q * K_Q * p.D)

    lowest, highest = 0.1 * U / p.D, ship.engine.n_max  # J of 10: no thrust
    if lowest >= highest or forces(highest)[0] < each:
        raise ConfigError(
            f"{ship.name} cannot hold {U:.4g} m/s: resistance {resistance:.4g} N exceeds the "
            f"thrust at its largest propeller speed, {highest:.4g} rev/s"
        )
    n = root(lambda n: forces(n)[0] - each, lowest, highest, 1e-13)
    return Powering(U, n, resistance, units * each, units * forces(n)[1])


def largest_power(ship: Ship) -> float:
    """Power that the engines give at most, all propellers together [W].

    At the largest propeller speed with the torque of a propeller that is held in place, or the
    engine's limit where that is less: no steady speed takes more.
    """
    n, D = ship.engine.n_max, ship.propeller.D
    bollard = float(coefficients(ship.open_water, 0.0)[1]) * ship.rho * n * n * D**5
    return 2.0 * math.pi * n * min(bollard, ship.engine.torque_max) * ship.propellers


# what a published point may hold -> the same of `Powering`
COMPARED = ("n", "thrust", "effective_power", "delivered_power")


def compared(ship: Ship, point: PropulsionPoint) -> dict[str, tuple[float, float]]:
    """Computed and published value of each number that a published point has, SI."""
    found = powering(ship, point.speed)
    pairs = {name: (getattr(found, name), getattr(point, name)) for name in COMPARED}
    return {name: pair for name, pair in pairs.items() if pair[1] is not None}


def powering_text(ship: Ship) -> list[str]:
    """Power at the nominal speed and at each published point, one line each."""
    try:
        p = powering(ship)
    except ConfigError as error:
        return [f"power: {error}"]
    lines = [
        f"power at {_speed(p.speed)}: {_value('n', p.n)}, resistance {_force(p.resistance)}, "
        f"thrust {_force(p.thrust)}, effective {_power(p.effective_power)}, delivered "
        f"{_power(p.delivered_power)}, efficiency {p.efficiency:.3f}"
    ]
    for point in ship.propulsion:
        pairs = ", ".join(
            f"{name.replace('_', ' ')} {_value(name, ours)} beside {_value(name, theirs)} "
            f"({100.0 * (ours / theirs - 1.0):+.1f} %)"
            for name, (ours, theirs) in compared(ship, point).items()
        )
        lines.append(f"published at {_speed(point.speed)}: {pairs}; {point.source}")
    return lines


def _value(name: str, value: float) -> str:
    if name == "n":
        return f"{value:.2f} rev/s" if value > 4.0 else f"{60.0 * value:.1f} rpm"
    return _force(value) if name == "thrust" else _power(value)


def _speed(speed: float) -> str:
    return f"{speed:.4g} m/s" if speed < 4.0 else f"{speed:.4g} m/s ({speed / KNOT:.1f} kn)"


def _force(force: float) -> str:
    return f"{force:.4g} N" if force < 1e4 else f"{1e-3 * force:.4g} kN"


def _power(power: float) -> str:
    return f"{power:.4g} W" if power < 1e4 else f"{1e-6 * power:.4g} MW"
