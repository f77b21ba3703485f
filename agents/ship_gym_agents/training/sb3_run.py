"""A run that learns with stable-baselines3: model, environments, state."""

from __future__ import annotations

import contextlib
import dataclasses
import importlib.util
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import torch

from ship_gym.evaluation.splits import VALIDATION_SEED
from ship_gym_agents.policies.policy import Policy
from ship_gym_agents.policies.policy_file import load_policy
from ship_gym_agents.sb3.algorithms import (
    explore,
    export,
    load_checkpoint,
    make_model,
    save_checkpoint,
    warm_start,
)
from ship_gym_agents.sb3.config import RunConfig
from ship_gym_agents.sb3.environments import form_env, make_env
from ship_gym_agents.sb3.sections import Price
from ship_gym_agents.training.run import Run
from ship_gym_agents.training.supervisor import Supervisor

_ENDLESS = 10**12


def learn(
    run: Run, init: str | Path | None, bar: Any, judge: Callable[[Any], dict[str, Any]] | None
) -> dict[str, Any]:
    """Learn to the end of the budget; whatever ends it early, what there is stays.

    Parameters
    ----------
    run : Run
    init : path, optional
        Policy to begin with.
    bar : object, optional
    judge : callable, optional
        Final evaluation of the best policy.

    Returns
    -------
    dict
        The card.
    """
    with _torch_threads(run.config.hyperparameters.training.threads):
        return SB3Run(run, init).learn(bar, judge)


class SB3Run:
    """Model and environments of a run."""

    def __init__(self, run: Run, init: str | Path | None = None):
        self.run, self.config, self.hyper = run, run.config, run.config.hyperparameters
        self.model = self._make_model()
        if run.checkpoint is not None:
            load_checkpoint(self.model, run.checkpoint)
            self._renew_noise()
        elif init is not None:
            warm_start(self.model, self.config.algorithm, self.hyper, load_policy(init))
        self._seed_episodes()

    def _renew_noise(self) -> None:
        """Other random numbers than in the earlier part of the run, which began with the seed.

        The environments begin new episodes, so that the earlier state of the generators could not
        make the run go on as if it had not been broken off.
        """
        generator = np.random.default_rng([self.config.seed, self.model.num_timesteps, 1])
        self.model.set_random_seed(int(generator.integers(2**31)))

    def _make_model(self):
        config = self.config
        _compile_kernels(config)
        env = make_env(config)
        has_board = importlib.util.find_spec("tensorboard") is not None
        log = self.run.folder.path / "tensorboard" if has_board else None
        return make_model(
            config.algorithm, env, config.hyperparameters, config.seed, self._learning_rate, log
        )

    def _learning_rate(self, _: float) -> float:
        """Falls to zero over the budget; stable-baselines3 itself knows of samples only."""
        samples = self.model.num_timesteps if hasattr(self, "model") else 0
        start = self.hyper.training.learning_rate
        return start * (1.0 - self.run.budget.used(samples))

    def _seed_episodes(self) -> None:
        """Own seeds for each run and each part of it, all below the validation seeds."""
        generator = np.random.default_rng([self.config.seed, self.model.num_timesteps])
        envs = self.hyper.training.envs
        self.model.get_env().seed(int(generator.integers(VALIDATION_SEED - envs)))

    def policy(self) -> Policy:
        """The present policy."""
        card = {"name": self.run.name}
        return export(self.model, self.config.algorithm, self.hyper, card)

    def save(self, folder: Path) -> None:
        """Write the state of the model."""
        save_checkpoint(self.model, folder, {})

    def told(self) -> dict[str, float]:
        """Price of the rudder's travel, where it is a multiplier."""
        if not self.hyper.price.limit:
            return {}
        return {"multiplier": form_env(self.model.get_env()).price.travel_price}

    def learn(self, bar: Any, judge: Callable | None) -> dict[str, Any]:
        """Train to the end of the budget."""
        run, options = self.run, self.hyper.algorithm
        supervisor = Supervisor(
            run,
            self.policy,
            self.save,
            lambda used: explore(self.model, options, used),
            self.told,
            bar,
        )
        with run.broken_off(lambda: self.model.num_timesteps, self.save):
            if run.used < 1.0:  # else only its end is left
                self.model.learn(
                    (run.budget.steps or _ENDLESS) - self.model.num_timesteps,
                    callback=supervisor,
                    reset_num_timesteps=self.model.num_timesteps == 0,
                    tb_log_name=self.config.algorithm,
                )
            return run.end(self.model.num_timesteps, self.policy, self.save, judge, **self.told())


def _compile_kernels(config: RunConfig) -> None:
    """Step once before the clock runs: the first step after installation compiles for seconds."""
    hyper = config.hyperparameters
    training = dataclasses.replace(hyper.training, envs=max(1, len(hyper.training.ships)))
    small = dataclasses.replace(hyper, training=training, price=Price())
    env = make_env(dataclasses.replace(config, hyperparameters=small))
    env.reset()
    env.step(np.zeros((env.num_envs, *env.action_space.shape), dtype=env.action_space.dtype))


@contextlib.contextmanager
def _torch_threads(count: int) -> Iterator[None]:
    before = torch.get_num_threads()
    torch.set_num_threads(count)
    try:
        yield
    finally:
        torch.set_num_threads(before)
