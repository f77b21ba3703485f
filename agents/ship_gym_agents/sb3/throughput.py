"""How many samples a second training takes, without validations and the writing of files."""

from __future__ import annotations

import time
from typing import Any

import torch
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import VecNormalize

from ship_gym_agents.sb3.algorithms import make_model
from ship_gym_agents.sb3.config import run_config
from ship_gym_agents.sb3.vec_adapter import ShipVecEnv


class _Sailing(BaseCallback):
    """Wall time of the rollouts, the rest is learning."""

    seconds = 0.0
    _start = 0.0

    def _on_rollout_start(self) -> None:
        self._start = time.perf_counter()

    def _on_rollout_end(self) -> None:
        self.seconds += time.perf_counter() - self._start

    def _on_step(self) -> bool:
        return True


def throughput(rollouts: int = 4, **given: Any) -> dict[str, Any]:
    """Train by PPO with the package's own hyperparameters for some rollouts.

    Parameters
    ----------
    rollouts : int
        After one that is not timed.
    **given
        As in ``config.run_config``.

    Returns
    -------
    dict
        ``algorithm``, ``envs``, ``threads`` (of torch), ``samples``, ``samples_per_second`` (wall
        time) and ``learning_percent`` of that time; the rest is sailing.
    """
    config = run_config(**given)
    training = config.hyperparameters.training
    before = torch.get_num_threads()
    torch.set_num_threads(training.threads)
    try:
        env = ShipVecEnv(training.envs, stagger=True, scenario=config.scenario)
        model = make_model(
            config.algorithm,
            VecNormalize(env, gamma=training.gamma),
            config.hyperparameters,
            config.seed,
            lambda _: training.learning_rate,
        )
        one = model.n_steps * training.envs
        model.learn(one)
        sailing = _Sailing()
        start = time.perf_counter()
        model.learn(rollouts * one, callback=sailing, reset_num_timesteps=False)
        spent = time.perf_counter() - start
    finally:
        torch.set_num_threads(before)
    return {
        "algorithm": config.algorithm,
        "envs": training.envs,
        "threads": training.threads,
        "samples": rollouts * one,
        "samples_per_second": rollouts * one / spent,
        "learning_percent": 100.0 * (1.0 - sailing.seconds / spent),
    }
