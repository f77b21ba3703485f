"""The minimum-time turn: what a change of the ordered heading takes at least, by our simulator.

In calm water and with the propeller held, the rudder goes hard over and, at one switch, hard over
to the other side, so late that the heading's peak passes the order by just the band of the settling
time. The time until the error enters the band is an estimate of the least that a controller can
reach, on the low side: how the ship is then held in the band is left out.
"""

from __future__ import annotations

import functools
import math
from typing import NamedTuple

import numpy as np

from ship_gym.config import ConfigError, check_angle, check_number
from ship_gym.conventions import PSI, R
from ship_gym.ships.files import Named
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Ship
from ship_gym.simulation import ShipSim, self_propulsion
from ship_gym.tasks.measures import SETTLED_DEG

BAND = math.radians(SETTLED_DEG)
_SAMPLE = 0.5  # between the switches that are tried [full-scale s]
_LONGEST = 3600.0  # of a turn [full-scale s]; a ship that needs more is refused


class _Turns(NamedTuple):
    """Turns to one side that differ in when the rudder is put over: after k samples.

    Attributes
    ----------
    time : numpy.ndarray
        Full scale [s], shape (T,).
    heading : numpy.ndarray
        To the side of the turn [rad], shape (T, switches).
    peak : numpy.ndarray
        Largest heading of each [rad], shape (switches,); rises with the switch.
    """

    time: np.ndarray
    heading: np.ndarray
    peak: np.ndarray


def minimum_turn_time(ship: Named | Ship, step: float, speed: float | None = None) -> float:
    """Least time until the heading error after a step of the order enters the band of 2 deg.

    Parameters
    ----------
    ship : str, path or Ship
    step : float
        Step of the ordered heading [rad], positive to starboard, within 180 deg.
    speed : float, optional
        Speed through the water on the straight course before it [m/s]; the nominal one if omitted.

    Returns
    -------
    float
        [full-scale s]; 0 for a step within the band.

    Raises
    ------
    ConfigError
        A step beyond 180 deg, or a ship that does not turn so far in an hour.
    """
    ship = load_ship(ship)
    size = abs(check_angle("step", step, math.pi))
    speed = check_number("speed", ship.speed if speed is None else speed, 1e-6, 100.0, "m/s")
    if size <= BAND:
        return 0.0
    turns = _turns(ship, math.copysign(1.0, step), speed)
    # the last switch whose peak is allowed, and the next one: between them lies the best
    k = int(np.searchsorted(turns.peak, size + BAND)) - 1
    part = (size + BAND - turns.peak[k]) / (turns.peak[k + 1] - turns.peak[k])
    first, second = (_entry(turns, switch, size - BAND) for switch in (k, k + 1))
    return float(first + part * (second - first))


def _entry(turns: _Turns, switch: int, heading: float) -> float:
    """Time at which a turn first has a heading [rad]."""
    rising = turns.heading[:, switch]
    after = int(np.argmax(rising >= heading))
    ends = slice(after - 1, after + 1)
    return float(np.interp(heading, rising[ends], turns.time[ends]))


@functools.lru_cache(maxsize=64)
def _turns(ship: Ship, side: float, speed: float) -> _Turns:
    """Turns to one side, with every switch up to the heading of 180 deg, sailed in one batch."""
    dt, n = _SAMPLE / ship.time_unit, self_propulsion(ship, speed)
    over = side * ship.gear.delta_max
    # hard over without a switch: how many switches there are to try
    alone = _sail(ship, speed, n, np.array([math.inf]), over, dt, math.pi + BAND)
    switches = np.arange(len(alone), dtype=np.float64)
    heading = _sail(ship, speed, n, switches, over, dt, math.inf)
    time = _SAMPLE * np.arange(len(heading))
    return _Turns(time, heading, heading.max(axis=0))


def _sail(
    ship: Ship, speed: float, n: float, switches: np.ndarray, over: float, dt: float, enough: float
) -> np.ndarray:
    """Headings to the side of the turn [rad], row by row, shape (T, switches).

    Until all have the heading `enough` [rad], or turn back.
    """
    sim = ShipSim(ship, len(switches))
    sim.reset(0, speed=speed, n=n)
    side, rows = math.copysign(1.0, over), [np.zeros(len(switches))]
    commands = np.column_stack([np.zeros(len(switches)), np.full(len(switches), n)])
    for k in range(round(_LONGEST / _SAMPLE)):
        commands[:, 0] = np.where(k < switches, over, -over)
        state = sim.step(commands, dt)
        rows.append(side * state[:, PSI])
        back = (k >= switches) & (side * state[:, R] <= 0.0)
        if (back | (rows[-1] >= enough)).all():
            return np.array(rows)
    raise ConfigError(
        f"{ship.name}: no turn of 180 deg within {_LONGEST:g} s (full scale) at a speed of "
        f"{speed:.4g} m/s"
    )
