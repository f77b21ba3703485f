"""Manoeuvres with the engine: crash stop, coasting, acceleration.

On a straight course a ship stays on it here: what turns a real single-screw ship when her propeller
reverses (its side force) is not modelled, so a lateral deviation comes from rudder and sea only.
"""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, check_number
from ship_gym.conventions import DELTA, PSI, U, V
from ship_gym.manoeuvres import Run, approach
from ship_gym.physics.dynamics import water_velocity
from ship_gym.recording.trajectory import Trajectory
from ship_gym.sea.state import Sea
from ship_gym.ships.files import Named
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Ship
from ship_gym.simulation import ShipSim, through_water

_LONGEST = 400.0  # L / U0 after which a ship that has not arrived is refused
_SAMPLE = 1.0 / 50.0  # output step [L / U0]


@dataclasses.dataclass(frozen=True)
class SpeedChange:
    """Measures of a manoeuvre with the engine, from the order to its end; lengths in L.

    Attributes
    ----------
    head_reach, lateral_deviation : float
        Way along the approach course and across it, to starboard positive.
    track_reach : float
        Way along the track.
    heading_change : float
        [rad], to starboard positive.
    time : float
        [s]
    reversal : float
        Time at which the propeller first turns astern [s]; nan if it does not.
    speed_ratio : float
        Speed through the water at the end over the approach or the aimed speed.
    final_n : float
        Propeller speed at the end [rev/s].
    largest_astern_thrust : float
        [N], positive; 0 without.
    """

    head_reach: float
    lateral_deviation: float
    track_reach: float
    heading_change: float
    time: float
    reversal: float
    speed_ratio: float
    final_n: float
    largest_astern_thrust: float
    trajectory: Trajectory

    def measures(self) -> dict[str, float]:
        """All measures by name, without the trajectory."""
        return {f.name: getattr(self, f.name) for f in dataclasses.fields(self)[:-1]}


def stopping(
    ship: Named | Ship,
    delta: float | None = None,
    speed: float | None = None,
    n: float | None = None,
    order: float | None = None,
    sea: Sea | None = None,
) -> SpeedChange:
    """Crash stop: full astern is ordered on a straight course to the north, until she lies still.

    Parameters
    ----------
    ship : str, path or Ship
    delta : float, optional
        Rudder angle all the time [rad], positive to starboard; `neutral_angle` if omitted.
    speed, n : float, optional
        Approach speed through the water [m/s], the ship's nominal one if omitted, and propeller
        speed [rev/s], self-propulsion if omitted.
    order : float, optional
        Ordered propeller speed [rev/s], negative; the largest astern if omitted.
    sea : Sea, optional
        Calm water if omitted.

    Raises
    ------
    ConfigError
        An engine that cannot reverse, an order that is not astern or beyond its limit, or a ship
        that does not stop.
    """
    ship = load_ship(ship)
    delta = neutral_angle(ship) if delta is None else delta
    U0, n = approach(ship, delta, speed, n)
    if not ship.engine.n_astern > 0.0:
        raise ConfigError(f"{ship.name}: engine.n_astern = 0: her engine cannot reverse")
    limit = ship.engine.n_astern
    order = check_number("order", -limit if order is None else order, -limit, 0.0, "rev/s")
    run = _begun(ship, U0, n, sea)
    run.n = order
    _until(run, lambda sim, t: water_motion(sim)[0] <= 0.0, delta, U0, "does not stop")
    config = {"delta": delta, "speed": U0, "n": n, "order": order}
    return _measured(run, U0, {"manoeuvre": "stopping", **config})


def coasting(
    ship: Named | Ship,
    delta: float | None = None,
    speed: float | None = None,
    n: float | None = None,
    share: float = 0.1,
    sea: Sea | None = None,
) -> SpeedChange:
    """Engine stopped on a straight course to the north, until a share of the speed is left.

    Parameters
    ----------
    ship, delta, speed, n, sea
        As in `stopping`. The shaft stands still, or turns with the water where the engine's brake
        cannot hold it.
    share : float
        Speed through the water at the end, by the approach speed.

    Raises
    ------
    ConfigError
        A share outside 0.01 to 0.99, or a ship that does not slow down to it.
    """
    ship = load_ship(ship)
    delta = neutral_angle(ship) if delta is None else delta
    U0, n = approach(ship, delta, speed, n)
    check_number("share", share, 0.01, 0.99)
    run = _begun(ship, U0, n, sea)
    run.n = 0.0
    reached = _slower_than(share * U0)
    _until(run, reached, delta, U0, f"does not slow down to {share:g} of her speed")
    config = {"delta": delta, "speed": U0, "n": n, "share": share}
    return _measured(run, U0, {"manoeuvre": "coasting", **config})


def acceleration(
    ship: Named | Ship,
    delta: float | None = None,
    speed: float | None = None,
    n: float | None = None,
    share: float = 0.9,
    sea: Sea | None = None,
) -> SpeedChange:
    """From rest, propeller stopped, heading north: a speed is ordered, until a share is reached.

    Parameters
    ----------
    ship, delta, sea
        As in `stopping`.
    speed : float, optional
        Aimed speed through the water [m/s]; the ship's nominal one if omitted.
    n : float, optional
        Ordered propeller speed [rev/s]; self-propulsion at `speed` if omitted.
    share : float
        Speed at the end, by the aimed speed.

    Raises
    ------
    ConfigError
        A share outside 0.01 to 0.99, or a ship that does not reach it.
    """
    ship = load_ship(ship)
    delta = neutral_angle(ship) if delta is None else delta
    U0, n = approach(ship, delta, speed, n)
    check_number("share", share, 0.01, 0.99)
    run = _begun(ship, U0, n, sea, at_rest=True)
    slower = _slower_than(share * U0)
    _until(
        run, lambda sim, t: not slower(sim, t), delta, U0, f"does not reach {share * U0:.4g} m/s"
    )
    config = {"delta": delta, "speed": U0, "n": n, "share": share}
    return _measured(run, U0, {"manoeuvre": "acceleration", **config})


def neutral_angle(ship: Ship) -> float:
    """Rudder angle [rad] at which a ship on a straight course feels no rudder force."""
    return math.atan(ship.rudder.neutral)


def water_motion(sim: ShipSim) -> tuple[float, float]:
    """Surge and sway velocity of the first ship through the water [m/s]."""
    state = sim.state[0]
    u_c, v_c = water_velocity(state[PSI], sim.seas[0])
    return float(state[U] - u_c), float(state[V] - v_c)


def _begun(ship: Ship, U0: float, n: float, sea: Sea | None, at_rest: bool = False) -> Run:
    """A run whose rudder is at the angle of the straight course before."""
    run = Run(ship, U0, n, sea, _SAMPLE, at_rest)
    run.sim.state[0, DELTA] = neutral_angle(ship)
    return run


def _slower_than(speed: float):
    return lambda sim, t: math.hypot(*water_motion(sim)) < speed


def _until(run: Run, reached, delta: float, U0: float, failing: str) -> None:
    """Sail until `reached`, and one step more, so that the last row is past the end."""
    longest = _LONGEST * run.ship.hull.L / U0
    run.until(reached, delta, longest)
    if not reached(run.sim, run.sim.time[0]):
        name = run.ship.name
        raise ConfigError(f"{name}: {failing} within {longest:.4g} s ({_LONGEST:g} L / U0)")
    end = run.rows + 1
    run.until(lambda sim, t: run.rows >= end, delta, longest)


def _measured(run: Run, U0: float, config: dict[str, Any]) -> SpeedChange:
    c, L = run.columns(), run.ship.hull.L
    astern = c["t"][c["n"] < 0.0]
    way = np.hypot(np.diff(c["x"]), np.diff(c["y"])).sum()
    speed = np.hypot(*through_water(c))
    return SpeedChange(
        head_reach=float(c["x"][-1]) / L,
        lateral_deviation=float(c["y"][-1]) / L,
        track_reach=float(way) / L,
        heading_change=float(c["psi"][-1]),
        time=float(c["t"][-1]),
        reversal=float(astern[0]) if len(astern) else math.nan,
        speed_ratio=float(speed[-1]) / U0,
        final_n=float(c["n"][-1]),
        largest_astern_thrust=max(0.0, -float(c["thrust"].min())),
        trajectory=run.trajectory(c, config),
    )
