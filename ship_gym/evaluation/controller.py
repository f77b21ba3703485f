"""What a controller is: an object with `reset` and `act`, for a batch of episodes."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship
from ship_gym.simulation import self_propulsion
from ship_gym.tasks.columns import action_columns


@runtime_checkable
class Controller(Protocol):
    """Anything that steers: an autopilot, a policy, a constant.

    It may have an attribute `file`, what it was loaded from: a recording names it with its SHA-256.

    Attributes
    ----------
    name : str
        Shown in tables.
    """

    name: str

    def reset(self, count: int, ship: Ship, scenario: Scenario) -> None:
        """Forget everything; `count` episodes of `scenario` with `ship` begin together."""

    def act(self, observations: np.ndarray) -> np.ndarray:
        """Actions (count, n_actions) in [-1, 1] for observations (count, n_observations).

        What the columns are is known by name: ``tasks.columns.observation_columns(scenario)`` in
        `reset`, then ``columns.view(observations).yaw_rate``; ``action_columns`` for the actions.
        """


def check_controller(thing: object, what: str) -> None:
    """Refuse what is no controller; `what` it is called, for the message."""
    missing = [key for key in ("name", "reset", "act") if not hasattr(thing, key)]
    if missing:
        raise ConfigError(f"{what} is no controller: it has no {' and no '.join(missing)}")


class ConstantController:
    """The same action always; the default, rudder amidships at self-propulsion, does nothing.

    Parameters
    ----------
    rudder : float
        Rudder command as a fraction of the largest angle.
    name : str
    """

    def __init__(self, rudder: float = 0.0, name: str = "constant"):
        self.rudder, self.name = rudder, name

    def reset(self, count: int, ship: Ship, scenario: Scenario) -> None:
        """Prepare the one action."""
        columns = action_columns(scenario)
        self._action = np.zeros((count, len(columns)))
        self._action[:, columns["rudder"]] = self.rudder
        if "rpm" in columns:
            n = self_propulsion(ship, ship.speed) / ship.engine.n_max
            astern = scenario.astern
            self._action[:, columns["rpm"]] = 2.0 * (n + astern) / (1.0 + astern) - 1.0

    def act(self, observations: np.ndarray) -> np.ndarray:
        """Return the constant action for every episode."""
        return self._action
