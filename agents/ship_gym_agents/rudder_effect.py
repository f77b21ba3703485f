"""How much the rudder does at a speed and propeller speed, by what it does at the nominal ones.

The yaw acceleration by rudder angle of the linearised ship there. An autopilot for the nominal
ship may steer by it: its rudder angle over this effect turns the ship as it means.
"""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

from ship_gym.linear import linearise
from ship_gym.ships.particulars import Ship
from ship_gym.simulation import self_propulsion
from ship_gym.tasks.columns import View
from ship_gym_agents.fresh import Fresh, begun

NEEDS = ("surge", "propeller")  # of the observation
_SPEEDS = np.array([0.3, 0.5, 0.7, 0.85, 1.0, 1.2])  # through the water, by U0
_TURNS = np.array([0.2, 0.5, 0.75, 1.0, 1.25])  # propeller speeds, by self-propulsion at U0
_LIMITS = (0.25, 2.5)  # beyond, no schedule is meant
_SMOOTH = 1.0  # time constant of the speed through the water [L / U0]


class RudderEffect:
    """Effect of the rudder from one measurement after the other.

    Parameters
    ----------
    ship : Ship
    step : float
        Control interval over L / U0.
    """

    def __init__(self, ship: Ship, step: float):
        self._table, self._share = effect_table(ship), 1.0 - np.exp(-step / _SMOOTH)
        self.turns_by = ship.engine.n_max / self_propulsion(ship, ship.speed)
        self._surge: Any = None
        self._fresh = Fresh()

    def restart(self, rows: np.ndarray) -> None:
        """Begin anew in these rows with the next measurement."""
        self._fresh.add(rows)

    def __call__(self, seen: View) -> np.ndarray:
        """Effect by the nominal one, shape (count,), within 0.25 to 2.5."""
        before = begun(self._surge, self._fresh.take(), seen.surge)
        self._surge = before + self._share * (seen.surge - before)
        return np.clip(
            interpolated(self._table, self._surge, seen.propeller * self.turns_by), *_LIMITS
        )


@functools.lru_cache(maxsize=64)  # 30 linear models take 0.2 s
def effect_table(ship: Ship) -> np.ndarray:
    """Yaw acceleration by rudder angle, by the nominal one, at `_SPEEDS` and `_TURNS`."""
    n0 = self_propulsion(ship, ship.speed)
    nominal = linearise(ship).B[2, 0]
    most = ship.engine.n_max
    return (
        np.array(
            [
                [linearise(ship, s * ship.speed, min(t * n0, most)).B[2, 0] for t in _TURNS]
                for s in _SPEEDS
            ]
        )
        / nominal
    )


def interpolated(table: np.ndarray, speed: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Value of the table at speeds and propeller speeds, shape (count,); held at its edges."""
    cells = []
    for axis, value in ((_SPEEDS, speed), (_TURNS, turns)):
        at = np.clip(value, axis[0], axis[-1])
        i = np.clip(np.searchsorted(axis, at, side="right") - 1, 0, len(axis) - 2)
        cells.append((i, (at - axis[i]) / (axis[i + 1] - axis[i])))
    (i, x), (j, y) = cells
    low = table[i, j] * (1.0 - y) + table[i, j + 1] * y
    high = table[i + 1, j] * (1.0 - y) + table[i + 1, j + 1] * y
    return low * (1.0 - x) + high * x
