"""A relay with dead band: the naive opponent that every autopilot should beat."""

from __future__ import annotations

import dataclasses
import math
from typing import ClassVar

import numpy as np

from ship_gym.ships.particulars import Ship
from ship_gym.tasks.columns import View
from ship_gym_agents.autopilot import Autopilot, wrapped
from ship_gym_agents.wave_filter import check_gains


@dataclasses.dataclass(frozen=True)
class BangBangGains:
    """Gains of the relay; numbers, or arrays of shape (count,).

    Attributes
    ----------
    rudder : float
        Angle to either side [rad]; the gear's largest at the most.
    dead_band : float
        Heading error, with its lead, up to which the rudder is amidships [rad].
    lead : float
        Time by which the yaw rate leads the heading [L / U0].
    """

    rudder: float = math.radians(10.0)
    dead_band: float = math.radians(2.0)
    lead: float = 0.5

    # the motion as it is measured, the order as it is given
    wave_filter: ClassVar = None
    observer: ClassVar = None
    reference: ClassVar = None

    def __post_init__(self):
        check_gains("gains", self, positive=("rudder",))


class BangBang(Autopilot):
    """Rudder hard to one of two angles where the heading is off by more than the dead band.

    Parameters
    ----------
    gains : BangBangGains, optional
        The tuned gains of the ship if omitted; without any, `first_gains`.
    name : str
    """

    KIND = "bang_bang"
    TUNED: ClassVar = {
        "rudder": (0.01, 0.6, math.radians(10.0)),
        "dead_band": (1e-3, 0.3, math.radians(2.0)),
        "lead": (0.0, 3.0, 0.5),
    }

    def __init__(self, gains: BangBangGains | None = None, name: str = "bang_bang"):
        super().__init__(gains, name)

    @classmethod
    def first_gains(cls, ship: Ship) -> BangBangGains:
        """The same for every ship."""
        return BangBangGains()

    def _rudder(self, seen: View, motion, wanted) -> np.ndarray:
        """Rudder angle [rad], one of three."""
        error = wrapped(motion[0] - wanted[0]) + self._g.lead * motion[1]
        return np.where(np.abs(error) > self._g.dead_band, -self._g.rudder * np.sign(error), 0.0)
