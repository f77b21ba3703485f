"""Speed for a voyage with a deadline: as slow as it may be, on top of line-of-sight guidance.

Resistance grows with the square of the speed, so of all ways to cover a distance in a given time
the constant speed takes the least energy: what is left to go over what is left of the time.
"""

from __future__ import annotations

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship
from ship_gym.simulation import self_propulsion
from ship_gym.tasks.columns import action_columns
from ship_gym_agents.autopilot import Perceived
from ship_gym_agents.fresh import Fresh, begun
from ship_gym_agents.los import ILOS
from ship_gym_agents.pid import Gains

MARGIN = 0.03  # share of the time that is left to chance
_MEMORY = 60.0  # of the current's low-pass [full-scale s]
_SLOWEST, _FASTEST = 0.2, 1.6  # speed through the water that is asked for, over U0
# Speeds over U0, times over L / U0: a ship's speed follows her propeller in some 10 L / U0.
_PROPORTIONAL, _INTEGRAL = 0.8, 0.05


class JustInTime(ILOS):
    """ILOS that arrives just in time: ``rudder+rpm`` on a track of one leg.

    The speed over ground that is needed is the distance to go over the time that is left, less a
    margin. The current along the track is what the ship makes good over ground less her speed by
    the log. The propeller turns for the speed needed in calm water, with proportional and integral
    action on what is missing of it; the integral stands still where the speed asked for is limited.

    Parameters
    ----------
    gains : Gains, optional
        As of `ILOS`.
    name : str
    """

    needs = (*ILOS.needs, "surge", "propeller")

    def __init__(self, gains: Gains | None = None, name: str = "just_in_time"):
        super().__init__(gains, name)

    def reset(self, count: int, ship: Ship, scenario: Scenario) -> None:
        """`count` episodes of `scenario` with `ship` begin together.

        Raises
        ------
        ConfigError
            The control has no propeller speed, or the track more than one leg.
        """
        super().reset(count, ship, scenario)
        actions = action_columns(scenario)
        if "rpm" not in actions:
            raise ConfigError(f"controller {self.name}: needs control = 'rudder+rpm'")
        check_one_leg(scenario, f"controller {self.name}")
        self._rpm, self._astern = actions["rpm"], scenario.astern
        # times in L / U0, speeds in U0, propeller speeds in n_max
        self._whole = scenario.steps * self._step * (1.0 - MARGIN)
        self._left = np.full(count, self._whole)
        self._keep = np.exp(-scenario.control_interval / _MEMORY)
        self._calm = self_propulsion(ship, ship.speed) / ship.engine.n_max
        self._current, self._missing = np.zeros(count), np.zeros(count)
        self._before: np.ndarray | None = None
        self._fresh = Fresh()

    def restart(self, rows: np.ndarray) -> None:
        """Give these rows the whole time again; see `Autopilot.restart`."""
        super().restart(rows)
        self._left[rows], self._current[rows], self._missing[rows] = self._whole, 0.0, 0.0
        self._fresh.add(rows)

    def steer(self, perceived: Perceived, offset: np.ndarray | None = None) -> np.ndarray:
        """Actions in [-1, 1], shape (count, 2); see `Autopilot.steer`."""
        action, seen = super().steer(perceived, offset), perceived.seen
        first = self._fresh.take()
        current = (begun(self._before, first, seen.to_go) - seen.to_go) / self._step - seen.surge
        known = self._keep * self._current + (1.0 - self._keep) * current
        known[first] = 0.0
        self._current, self._before = known, np.array(seen.to_go)
        needed = seen.to_go / np.maximum(self._left, self._step) - self._current
        self._left = self._left - self._step
        share = self._calm * self._asked(np.clip(needed, _SLOWEST, _FASTEST), seen.surge)
        action[:, self._rpm] = 2.0 * (share + self._astern) / (1.0 + self._astern) - 1.0
        return np.clip(action, -1.0, 1.0)

    def _asked(self, needed: np.ndarray, surge: np.ndarray) -> np.ndarray:
        """Speed over U0 in calm water whose propeller speed is set; takes the integral on."""
        missing = self._missing + _INTEGRAL * self._step * (needed - surge)
        asked = needed + _PROPORTIONAL * (needed - surge) + missing
        free = (asked > _SLOWEST) & (asked < _FASTEST)
        self._missing = np.where(free, missing, self._missing)
        return np.clip(asked, _SLOWEST, _FASTEST)


def check_one_leg(scenario: Scenario, who: str) -> None:
    """Refuse a track of several legs, whose whole way to go is not observed."""
    track = scenario.track
    one_leg = track.kind == "straight" or len(track.points) == 2
    if not one_leg and not (track.kind == "random" and track.legs == 1):
        raise ConfigError(
            f"{who}: knows the way to go on a track of one leg only; allowed is kind = "
            "'straight', two points, or legs = 1"
        )
