"""Features of the ship: speed and propeller, what the rudder does, and her constants."""

from __future__ import annotations

import dataclasses
import functools
import math
from typing import ClassVar

import numpy as np

from ship_gym.conventions import G
from ship_gym.linear import linearise
from ship_gym.ships.particulars import Ship as Particulars
from ship_gym.simulation import self_propulsion
from ship_gym_agents.forms.block import Block
from ship_gym_agents.forms.look import Look, Sailing
from ship_gym_agents.fresh import zeroed
from ship_gym_agents.rudder_effect import RudderEffect

_MEAN = 1.5  # time constant of the means of `Hold` [L / U0]; for kcs 45 s
_LEAST = 0.3  # effect of the rudder by the nominal one, at about half the speed and propeller
_NEARLY_ALL = 0.8  # of the rudder


class Speed(Block):
    """Speed through the water and propeller speed, from the nominal ones."""

    FEATURES: ClassVar = {"surge": 1.0, "propeller": 1.0}
    needs = ("surge", "propeller")

    def __init__(self, sailing: Sailing):
        super().__init__(sailing)
        ship = sailing.ship
        self._turns_by = ship.engine.n_max / self_propulsion(ship, ship.speed)

    def values(self, look: Look) -> tuple:
        """See `Block`."""
        seen = look.seen
        return 8.0 * (seen.surge - 0.95), 4.0 * (seen.propeller * self._turns_by - 1.0)


class Effect(Block):
    """Effect of the rudder at this speed and propeller by the nominal one."""

    FEATURES: ClassVar = {"effect": 1.0}
    needs = ("surge", "propeller")

    def __init__(self, sailing: Sailing):
        super().__init__(sailing)
        self._effect = RudderEffect(sailing.ship, sailing.step)

    def values(self, look: Look) -> tuple:
        """See `Block`."""
        return (4.0 * (self._effect(look.seen) - 1.0),)

    def restart(self, rows: np.ndarray) -> None:
        """See `Block`."""
        self._effect.restart(rows)


class Hold(Block):
    """Rudder that holds the ship on her course, by the largest: how near she is to losing it.

    `rudder`: mean of the achieved angle, turned into the one that would turn the ship as much at
    nominal speed and propeller. `hard` rises where an effect of `_LEAST` would ask nearly all of
    the rudder for it: a ship that a loss of thrust may make fall off her course for good.
    """

    FEATURES: ClassVar = {"rudder": -1.0, "hard": -1.0}
    needs = ("surge", "propeller", "rudder")

    def __init__(self, sailing: Sailing):
        super().__init__(sailing)
        self._effect = RudderEffect(sailing.ship, sailing.step)
        self._share = sailing.step / _MEAN
        self._taken, self._mean = np.zeros(sailing.count), np.zeros(sailing.count)

    def restart(self, rows: np.ndarray) -> None:
        """See `Block`."""
        self._effect.restart(rows)
        self._taken, self._mean = zeroed(self._taken, rows), zeroed(self._mean, rows)

    def values(self, look: Look) -> tuple:
        """See `Block`."""
        held = look.seen.rudder * self._effect(look.seen)
        self._taken = self._taken + 1.0
        share = np.maximum(self._share, 1.0 / self._taken)
        self._mean = self._mean + share * (held - self._mean)
        return 2.0 * self._mean, np.tanh((self._mean / (_NEARLY_ALL * _LEAST)) ** 3)


class Ship(Block):
    """Constants of the ship that a bridge knows: linear model, form, speed, gear.

    Each less what is usual among the ships of the package, over about their spread. They are those
    of the ship file: what `randomisation` draws is not known.
    """

    USUAL: ClassVar = {
        "Y_v": (-0.9, 0.3),
        "Y_r": (-0.35, 0.1),
        "Y_delta": (-0.2, 0.15),
        "N_v": (-3.8, 1.0),
        "N_r": (-2.7, 0.7),
        "N_delta": (1.7, 0.7),
        "froude": (0.18, 0.04),
        "L/B": (6.9, 1.0),
        "B/d": (3.1, 0.3),
        "block": (0.65, 0.1),
        "gear": (1.4, 0.25),
        "propeller": (0.62, 0.15),
        "screws": (1.5, 0.5),
        "time": (28.0, 8.0),
    }
    FEATURES: ClassVar = dict.fromkeys(USUAL, 1.0)

    def __init__(self, sailing: Sailing):
        super().__init__(sailing)
        known = zip(constants(sailing.ship), self.USUAL.values(), strict=True)
        self._row = [(value - usual) / spread for value, (usual, spread) in known]
        self._ones = np.ones(sailing.count)

    def values(self, look: Look) -> tuple:
        """See `Block`."""
        return tuple(value * self._ones for value in self._row)


@functools.lru_cache(maxsize=64)
def constants(ship: Particulars) -> tuple[float, ...]:
    """Those of `Ship`: linear model, form, rudder rate by U0 / L, propeller, L / U0.

    All but the last are non-dimensional, and that is in full-scale seconds. Waves come in seconds,
    a ship and her filter work in L / U0: it tells how far apart the two are.
    """
    hull, U0 = ship.hull, ship.speed
    return (
        *dataclasses.astuple(linearise(ship).steering),
        U0 / math.sqrt(G * hull.L),
        hull.L / hull.B,
        hull.B / hull.d,
        hull.volume / (hull.L * hull.B * hull.d),
        ship.gear.rate * hull.L / U0,
        self_propulsion(ship, U0) / ship.engine.n_max,
        float(ship.propellers),
        hull.L / U0 * ship.time_unit,
    )
