"""One picture of an environment in action: what ``env.render()`` shows when a controller steers."""

from __future__ import annotations

import gymnasium as gym
import numpy as np

from ship_gym.config import ConfigError
from ship_gym.evaluation.controller import Controller


def still(controller: Controller, env_id: str, seed: int, intervals: int) -> np.ndarray:
    """Picture of an episode after some control intervals.

    Parameters
    ----------
    controller : Controller
        For observations of shape (1, n_observations) of the id's task.
    env_id : str
        One of ``ship_gym.ENVIRONMENTS``.
    seed : int
        Of the episode.
    intervals : int
        How many it sails before the picture.

    Returns
    -------
    numpy.ndarray
        uint8, shape (height, width, 3).

    Raises
    ------
    ConfigError
        The episode ends earlier.
    """
    env = gym.make(env_id, render_mode="rgb_array").unwrapped
    observation, _ = env.reset(seed=seed)
    controller.reset(1, env.ship, env.scenario)
    for k in range(1, intervals + 1):
        action = controller.act(observation[None])[0]
        observation, _, terminated, truncated, _ = env.step(action)
        if (terminated or truncated) and k < intervals:
            raise ConfigError(f"intervals = {intervals}: {env_id}, seed {seed}, ends after {k}")
    return env.render()
