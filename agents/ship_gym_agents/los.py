"""Guidance to a track: which heading, on top of the heading autopilot of ``ship_gym_agents.pid``.

Lengths are in L and times in L / U0. Angles are taken from the bearing of the active leg, the
cross-track error is positive to starboard of it.
"""

from __future__ import annotations

import dataclasses
import math
from typing import ClassVar

import numpy as np

from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship
from ship_gym.tasks.columns import View
from ship_gym_agents.gains_files import find_gains
from ship_gym_agents.pid import PID, Gains, gains_of
from ship_gym_agents.reference import Guidance, Reference

# For gains without a reference model: saves kcs some 8 % of the rudder's travel. Radius 2.5 L.
_TURNS = Reference(frequency=3.0, rate_limit=0.4)
_HELMSMAN = ("K_p", "K_d", "K_v", "K_b")


class LOSPID(PID):
    """PID with line-of-sight guidance: the wanted heading is ``-atan(e / look_ahead)`` off the leg.

    Look-ahead steering, Fossen (2021), Handbook of Marine Craft Hydrodynamics and Motion Control,
    2nd ed., chapter 12. The turn at a way-point begins ``turn_radius tan(|d_chi| / 2) + reach``
    before it, where the circle of that radius leaves the leg, unless the environment names the next
    leg earlier. From there the next leg is the one to reach; the way-point is passed at the
    bisector of its angle, so however early that is.

    Parameters
    ----------
    gains : Gains, optional
        With guidance; the gains of this guidance tuned for the ship if omitted, else those of its
        heading autopilot. Without a reference model in them, a moderate one is taken.
    name : str
    """

    needs = (*PID.needs, "cross_track", "to_go", "next_turn")
    KIND: ClassVar[str] = "los_pid"
    # A start of None: as in the tuned gains of the heading autopilot.
    TUNED: ClassVar[dict[str, tuple[float, float, float | None]]] = {
        "guidance.look_ahead": (0.5, 12.0, None),
        "guidance.turn_radius": (0.5, 12.0, None),
        "guidance.reach": (-1.0, 3.0, None),
        "reference.frequency": (0.8, 16.0, None),
        "reference.rate_limit": (0.1, 5.0, None),
        **{name: (*PID.TUNED[name][:2], None) for name in _HELMSMAN},
    }

    @classmethod
    def first_gains(cls, ship: Ship) -> Gains:
        """Those tuned for the heading, with a reference model and moderate guidance."""
        gains = gains_of(ship)
        return dataclasses.replace(gains, reference=gains.reference or _TURNS, guidance=Guidance())

    @classmethod
    def gains_for(cls, ship: Ship, task: str | None = None) -> Gains:
        """The gains of this guidance tuned for a ship, else those to begin at."""
        if find_gains(ship.name, cls.KIND, task) is None:
            return cls.first_gains(ship)
        return super().gains_for(ship, task)

    @classmethod
    def structures(cls, ship: Ship) -> dict[str, tuple[Gains, tuple[str, ...]]]:
        """The guidance alone, then with the feedback of the heading autopilot too."""
        first = cls.first_gains(ship)
        guidance = tuple(name for name in cls.TUNED if name not in _HELMSMAN)
        helmsman = _HELMSMAN if first.observer is not None else _HELMSMAN[:3]
        return {
            "guidance": (first, guidance),
            "guidance and helmsman": (first, (*guidance, *helmsman)),
        }

    def __init__(self, gains: Gains | None = None, name: str = "los_pid"):
        super().__init__(gains, name)

    def _gains_for(self, ship: Ship, task: str) -> Gains:
        gains = super()._gains_for(ship, task)
        return dataclasses.replace(gains, reference=gains.reference or _TURNS)

    def _wanted(self, seen: View, jump: np.ndarray) -> np.ndarray:
        turn, cross = self._leg(seen)
        return turn - np.arctan(cross / self._g.guidance.look_ahead)

    def _leg(self, seen: View) -> tuple[np.ndarray, np.ndarray]:
        """Bearing [rad, from the active leg] of and error across the leg to reach, (count,)."""
        cross, to_go, p = seen.cross_track, seen.to_go, self._g.guidance
        turn = seen.next_turn * math.pi
        half = 0.5 * np.maximum(np.abs(turn), 1e-6)
        reach = p.turn_radius * np.tan(half) + p.reach
        over = (turn != 0.0) & (to_go <= reach)
        turn = np.where(over, turn, 0.0)
        # position from the way-point is (-to_go, cross), along and to starboard of the active leg
        return turn, to_go * np.sin(turn) + cross * np.cos(turn)


class ILOS(LOSPID):
    """Line-of-sight guidance with integral action against current and drift.

    ``-atan((e + kappa z) / look_ahead)`` with ``dz/dt' = look_ahead e / (look_ahead^2 +
    (e + kappa z)^2)``: Borhaug, Pavlov & Pettersen (2008), 47th IEEE Conference on Decision and
    Control, as in ``ILOSpsi`` of Fossen's MSS toolbox, times U0 / L. Far from the leg z hardly
    grows, so it does not wind up. At a new leg, of the drift that z stands for the part across
    that leg is kept.
    """

    KIND: ClassVar[str] = "ilos"
    TUNED: ClassVar[dict[str, tuple[float, float, float | None]]] = {
        "guidance.integral": (0.005, 5.0, None),
        **LOSPID.TUNED,
    }

    def __init__(self, gains: Gains | None = None, name: str = "ilos"):
        super().__init__(gains, name)

    def reset(self, count: int, ship: Ship, scenario: Scenario) -> None:
        """Clear the integrals; `count` episodes of `scenario` with `ship` begin together."""
        super().reset(count, ship, scenario)
        self._drift = np.zeros(count)

    def restart(self, rows: np.ndarray) -> None:
        """Clear the integrals of these rows; see `Autopilot.restart`."""
        super().restart(rows)
        self._drift[rows] = 0.0

    def _wanted(self, seen: View, jump: np.ndarray) -> np.ndarray:
        p, (turn, cross) = self._g.guidance, self._leg(seen)
        self._drift = self._drift * np.cos(jump)
        # While it turns to the next leg, the error across that one says nothing of the drift.
        aim = cross + p.integral * self._drift * np.cos(turn)
        grown = self._step * p.look_ahead * cross / (p.look_ahead**2 + aim**2)
        self._drift = self._drift + np.where(turn == 0.0, grown, 0.0)
        return turn - np.arctan(aim / p.look_ahead)
