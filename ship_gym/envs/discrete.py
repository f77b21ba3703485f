"""DiscreteRudder: a choice of rudder angles, for agents such as DQN."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import gymnasium as gym
import numpy as np

from ship_gym.config import ConfigError, check_angle

ANGLES = tuple(
    math.radians(angle) for angle in (-20.0, -10.0, -5.0, -2.0, 0.0, 2.0, 5.0, 10.0, 20.0)
)


class DiscreteRudder(gym.ActionWrapper, gym.utils.RecordConstructorArgs):
    """Action ``k`` is the k-th rudder angle; the propeller keeps the self-propulsion speed.

    Parameters
    ----------
    env : gymnasium.Env
        A ``ShipEnv`` with ``control="rudder"``, wrapped or not.
    angles : sequence of float
        Rudder angles [rad], increasing, positive to starboard; by default 0, 2, 5, 10 and 20 deg to
        either side.

    Raises
    ------
    ConfigError
        Another control, or angles that are not increasing or beyond the ship's largest.
    """

    def __init__(self, env: gym.Env, angles: Sequence[float] = ANGLES):
        gym.utils.RecordConstructorArgs.__init__(self, angles=tuple(angles))  # for `env.spec`
        gym.ActionWrapper.__init__(self, env)
        if env.action_space.shape != (1,):
            raise ConfigError(
                f"DiscreteRudder needs control = 'rudder'; the action here has shape "
                f"{env.action_space.shape}"
            )
        base: Any = env.unwrapped
        largest = base.ship.gear.delta_max
        self.angles = np.array([check_angle("angles", angle, largest) for angle in angles])
        if len(self.angles) < 2 or not (np.diff(self.angles) > 0.0).all():
            raise ConfigError(
                f"angles = {list(angles)}: allowed are two or more in increasing order [rad]"
            )
        self._actions = (self.angles / largest).astype(np.float32)[:, None]
        self.action_space = gym.spaces.Discrete(len(self.angles))

    def action(self, action: Any) -> np.ndarray:
        """Rudder command in [-1, 1], shape (1,), of a choice."""
        choice = np.asarray(action)
        if choice.ndim > 0 or not self.action_space.contains(choice.item()):
            raise ConfigError(f"action {action!r}: allowed is 0 to {len(self.angles) - 1}")
        return self._actions[int(choice)]
