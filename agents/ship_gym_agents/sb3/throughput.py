"""How many samples a second training takes, ours beside stable-baselines3's own way.

Without validations and the writing of files.
"""

from __future__ import annotations

import dataclasses
import os
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import gymnasium
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import DummyVecEnv, VecNormalize

from ship_gym.tasks import TASKS
from ship_gym.tasks.base import env_id
from ship_gym_agents.sb3.algorithms import TORCH_ACTIVATIONS, make_model
from ship_gym_agents.sb3.config import RunConfig, run_config
from ship_gym_agents.sb3.environments import make_env
from ship_gym_agents.sb3.overlapped import OverlappedPPO, cores

_START = 30.0  # longest wait for the second process [s]
_PLAIN = ("n_steps", "batch_size", "n_epochs", "gae_lambda", "clip_range", "ent_coef", "vf_coef")


class _Clock(BaseCallback):
    """Wall time of some rollouts and of what comes between them, once `warm` says so."""

    def __init__(self, rollouts: int, warm: Callable[[BaseAlgorithm], bool]):
        super().__init__()
        self._wanted, self._warm = rollouts, warm
        self._born = time.perf_counter()
        self._begin = 0.0
        self.walls: list[float] = []
        self.sailing: list[float] = []
        self.learning: list[float] = []

    def _on_rollout_start(self) -> None:
        now = time.perf_counter()
        if len(self.sailing) > len(self.walls):
            self.walls.append(now - self._begin)
            if isinstance(self.model, OverlappedPPO):
                self.learning.append(self.model.learned["seconds"])
            else:
                self.learning.append(self.walls[-1] - self.sailing[-1])
        self._begin = now

    def _on_rollout_end(self) -> None:
        late = time.perf_counter() - self._born > _START
        if late or self._warm(self.model):
            self.sailing.append(time.perf_counter() - self._begin)

    def _on_step(self) -> bool:
        return len(self.walls) < self._wanted


def throughput(
    rollouts: int = 4, beside: int = 2, progress: Callable | None = None, **given: Any
) -> dict[str, Any]:
    """Train by PPO for some rollouts, as a run does and as stable-baselines3 does by itself.

    Parameters
    ----------
    rollouts : int
        Those timed, after the second process has started (where there is a second core).
    beside : int
        Rollouts of stable-baselines3's PPO over ``DummyVecEnv``; 0: none.
    progress : callable, optional
        Wraps what is measured, as ``tqdm`` does; also gets a text.
    **given
        As in ``config.run_config``; the algorithm is PPO.

    Returns
    -------
    dict
        ``algorithm``, ``envs``, ``threads`` (of torch), ``cores``, ``epochs``, ``samples``,
        ``samples_per_second`` (wall time), ``sailing_percent`` and ``learning_percent`` of that
        time, which overlap where ``side_by_side``; ``load`` of the machine at the end, its average
        of a minute; and ``plain``: samples, ``samples_per_second`` and ``learning_percent`` of
        stable-baselines3, and ``ratio`` to it.
    """
    config = run_config("ppo", **given)
    training, options = config.hyperparameters.training, config.hyperparameters.algorithm
    before = torch.get_num_threads()
    torch.set_num_threads(training.threads)
    try:
        jobs = [(_own, rollouts), *([(_plain, beside)] if beside else [])]
        shown = progress(jobs, "training") if progress else jobs
        ours, plain = [*(_measured(make(config), count) for make, count in shown), {}][:2]
    finally:
        torch.set_num_threads(before)
    if plain:
        plain["ratio"] = ours["samples_per_second"] / plain["samples_per_second"]
    return {
        "algorithm": config.algorithm,
        "envs": training.envs,
        "threads": training.threads,
        "cores": cores(),
        "epochs": dataclasses.asdict(options)["n_epochs"],
        **ours,
        "plain": plain,
        "load": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
    }


def _measured(model: BaseAlgorithm, rollouts: int) -> dict[str, Any]:
    """Samples a second and shares of time, of rollouts after the first one."""
    waits = isinstance(model, OverlappedPPO) and model.overlap and model.second_core

    def warm(now: Any) -> bool:
        return now.side_by_side if waits else now.num_timesteps > one

    one = model.n_steps * model.n_envs
    clock = _Clock(rollouts, warm)
    model.learn(10**12, callback=clock)
    model.get_env().close()
    spent = sum(clock.walls)
    return {
        "samples": rollouts * one,
        "samples_per_second": rollouts * one / spent,
        "sailing_percent": 100.0 * sum(clock.sailing) / spent,
        "learning_percent": 100.0 * sum(clock.learning) / spent,
        "side_by_side": waits and model.side_by_side,
    }


def _own(config: RunConfig) -> BaseAlgorithm:
    """The model of a run."""
    hyper = config.hyperparameters
    rate = hyper.training.learning_rate
    return make_model("ppo", make_env(config), hyper, config.seed, lambda _: rate)


def _plain(config: RunConfig) -> PPO:
    """Same task, network and numbers of samples, as stable-baselines3's own documentation has it.

    The scalar environments of ``gymnasium.make`` one after the other; nothing of our training.
    """
    hyper = config.hyperparameters
    training, network = hyper.training, hyper.network
    overrides = {"duration": training.episode or config.scenario.duration, **training.overrides}
    name = env_id(config.scenario.task, TASKS.versions[config.scenario.task])
    made = partial(gymnasium.make, name, scenario=config.scenario, overrides=overrides)
    envs = [lambda: Monitor(made())] * training.envs
    kinds = {"pi": list(network.hidden), "vf": list(network.critic or network.hidden)}
    return PPO(
        "MlpPolicy",
        VecNormalize(DummyVecEnv(envs), gamma=training.gamma),
        learning_rate=training.learning_rate,
        gamma=training.gamma,
        policy_kwargs={
            "net_arch": kinds,
            "activation_fn": TORCH_ACTIVATIONS[network.activation],
        },
        seed=config.seed,
        device="cpu",
        **{name: getattr(hyper.algorithm, name) for name in _PLAIN},
    )
