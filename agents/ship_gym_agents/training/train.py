"""train: a policy from a scenario, with everything needed to repeat, resume and judge it.

A run folder holds ``policy.zip`` (the best policy so far, see module ``policy``), ``card.json``
(resolved config, versions, samples, validations) and ``checkpoint/`` (to resume). All three are
written at every validation, each whole or not at all.
"""

from __future__ import annotations

import contextlib
import importlib.util
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.evaluation.metrics import metrics
from ship_gym.evaluation.rollout import rollout
from ship_gym.evaluation.splits import VALIDATION_SEED
from ship_gym.provenance import atomic_path, provenance
from ship_gym.scenarios.scenario import Scenario
from ship_gym.tasks import TASKS
from ship_gym.tasks.columns import observation_columns
from ship_gym_agents.sb3.config import CARD_FILE, RunConfig, check_free, plain, read_card
from ship_gym_agents.sb3.policy import (
    POLICY_FILE,
    SB3Policy,
    load_policy,
    save_policy,
)
from ship_gym_agents.training.budget import Budget

try:
    import torch
    from stable_baselines3.common.vec_env import VecNormalize

    from ship_gym_agents.sb3.algorithms import (
        explore,
        export,
        load_checkpoint,
        make_model,
        save_checkpoint,
    )
    from ship_gym_agents.sb3.vec_adapter import ShipVecEnv
    from ship_gym_agents.training.supervisor import Supervisor
except ModuleNotFoundError as error:
    if error.name not in ("torch", "stable_baselines3"):
        raise
    raise ImportError(
        f'training needs {error.name}, which is not installed: pip install "ship-gym[rl]"'
    ) from error

VALIDATION_EPISODES = 64
_ENDLESS = 10**12
# Floor of the variance of an observation: one that hardly varies is not blown up to noise.
_EPSILON = 1e-4


def train(
    config: RunConfig,
    out: str | Path,
    *,
    minutes: float | None = None,
    steps: int | None = None,
    resume: bool = False,
    bar: Any = None,
) -> dict[str, Any]:
    """Train a policy and write its run folder.

    Parameters
    ----------
    config : RunConfig
    out : str or path
        Run folder; must not hold a run unless `resume`.
    minutes : float, optional
        Wall-clock time of the whole run, earlier parts of a resumed one included.
    steps : int, optional
        Samples of the whole run. At least one of the two limits is needed.
    resume : bool
        Continue the run in `out`, which must have the same config.
    bar : object, optional
        Progress bar with ``n``, ``total`` and ``update(increment)``.

    Returns
    -------
    dict
        The card.

    Raises
    ------
    ConfigError
        No budget or none left, a folder that holds a run, or no such run to resume.
    """
    with _torch_threads(config.hyperparameters.training.threads):
        run = _Run(config, Path(out), minutes, steps, resume)
        return run.learn(bar)


class _Run:
    """One run: model, environments, budget and the record of what has happened."""

    def __init__(
        self,
        config: RunConfig,
        out: Path,
        minutes: float | None,
        steps: int | None,
        resume: bool,
    ):
        self.config, self.out = config, out
        card = self._earlier(resume)
        _compile_kernels(config.scenario)
        self.validations: list[dict[str, float | None]] = []
        self.best: SB3Policy | None = None
        self.budget = Budget(minutes, steps, card["seconds"] if card else 0.0)
        self.model = self._make_model()
        if card:
            load_checkpoint(self.model, out / "checkpoint")
            self.validations = card["validations"]
            self.best = load_policy(out)
            if self.budget.used(self.model.num_timesteps) >= 1.0:
                raise ConfigError(
                    f"{out}: its budget is used up ({card['samples']} samples, "
                    f"{card['seconds'] / 60.0:.2f} min); give more minutes or steps in all"
                )
            self._renew_noise()
        self._seed_episodes()

    def _renew_noise(self) -> None:
        """Other random numbers than in the earlier part of the run, which began with the seed."""
        generator = np.random.default_rng([self.config.seed, self.model.num_timesteps, 1])
        self.model.set_random_seed(int(generator.integers(2**31)))

    def _earlier(self, resume: bool) -> dict[str, Any] | None:
        """Card of the run to resume; None for a new one."""
        if not resume:
            check_free(self.out)
            return None
        card = read_card(self.out)
        if card["config"] != plain(self.config):
            raise ConfigError(f"{self.out}: cannot resume with another config than in {CARD_FILE}")
        return card

    def _make_model(self):
        config, hyper = self.config, self.config.hyperparameters
        duration = hyper.training.episode or config.scenario.duration
        env = ShipVecEnv(
            hyper.training.envs,
            stagger=True,
            scenario=config.scenario,
            overrides={"duration": duration},
        )
        env = VecNormalize(env, gamma=hyper.training.gamma, epsilon=_EPSILON)
        log = self.out / "tensorboard" if importlib.util.find_spec("tensorboard") else None
        return make_model(config.algorithm, env, hyper, config.seed, self._learning_rate, log)

    def _learning_rate(self, _: float) -> float:
        """Falls to zero over the budget; stable-baselines3 itself knows of samples only."""
        samples = self.model.num_timesteps if hasattr(self, "model") else 0
        start = self.config.hyperparameters.training.learning_rate
        return start * (1.0 - self.budget.used(samples))

    def _seed_episodes(self) -> None:
        """Own seeds for each run and each part of it, all below the validation seeds."""
        generator = np.random.default_rng([self.config.seed, self.model.num_timesteps])
        envs = self.config.hyperparameters.training.envs
        self.model.get_env().seed(int(generator.integers(VALIDATION_SEED - envs)))

    def learn(self, bar: Any) -> dict[str, Any]:
        """Train to the end of the budget; whatever ends it early, what there is gets written."""
        hyper = self.config.hyperparameters
        supervisor = Supervisor(
            self.budget,
            hyper.training.validations,
            self._validate,
            lambda used: explore(self.model, hyper.algorithm, used),
            bar,
        )
        try:
            self.model.learn(
                (self.budget.steps or _ENDLESS) - self.model.num_timesteps,
                callback=supervisor,
                reset_num_timesteps=self.model.num_timesteps == 0,
                tb_log_name=self.config.algorithm,
            )
        except KeyboardInterrupt:
            self._validate("interrupted")
            raise
        return self._validate("complete")

    def _validate(self, status: str = "running") -> dict[str, Any]:
        """Sail the validation episodes, keep the policy if it is the best, write everything."""
        now = export(
            self.model,
            self.config.algorithm,
            self.config.hyperparameters.network.activation,
            {"name": f"{self.config.algorithm}-{self.out.name}"},
        )
        found = validate(now, self.config.scenario)
        found |= {"samples": self.model.num_timesteps, "seconds": round(self.budget.seconds, 2)}
        returns = [earlier["return"] for earlier in self.validations]
        self.validations.append(found)
        if self.best is None or found["return"] > max(returns):
            self.best = now
        for name in found.keys() - {"success"}:
            self.model.logger.record(f"validation/{name}", found[name])
        self.model.logger.dump(self.model.num_timesteps)
        return self._write(status)

    def _write(self, status: str) -> dict[str, Any]:
        card = {
            "name": self.best.name,
            "status": status,
            "config": plain(self.config),
            "budget": {"minutes": self.budget.minutes, "steps": self.budget.steps},
            "samples": self.model.num_timesteps,
            "seconds": round(self.budget.seconds, 2),
            "validation_seeds": [VALIDATION_SEED, VALIDATION_SEED + VALIDATION_EPISODES - 1],
            "validations": self.validations,
            "best": max(self.validations, key=lambda found: found["return"]),
            "observations": list(observation_columns(self.config.scenario)),
            **provenance(),
        }
        self.best.card = card
        save_checkpoint(self.model, self.out / "checkpoint", {"status": status})
        save_policy(self.best, self.out / POLICY_FILE)
        with atomic_path(self.out / CARD_FILE) as temporary:
            temporary.write_text(json.dumps(card, indent=1) + "\n", encoding="utf-8")
        return card


def validate(policy: SB3Policy, scenario: Scenario) -> dict[str, float | None]:
    """Means over the validation episodes of `scenario`.

    Returns
    -------
    dict
        The headline metric of the task, None where an episode has none (one too short for a steady
        part), ``return`` (sum of rewards) and ``success``.
    """
    seeds = range(VALIDATION_SEED, VALIDATION_SEED + VALIDATION_EPISODES)
    found = [metrics(episode) for episode in rollout(policy, scenario, seeds=seeds).episodes]
    names = dict.fromkeys((TASKS[scenario.task].headline, "return", "success"))
    columns = {name: [m[name] for m in found] for name in names}
    return {
        name: None if None in column else float(np.mean(column)) for name, column in columns.items()
    }


def _compile_kernels(scenario: Scenario) -> None:
    """Step once before the clock runs: the first step after installation compiles for seconds."""
    env = ShipVecEnv(1, scenario=scenario)
    env.reset()
    env.step(np.zeros((1, *env.action_space.shape)))


@contextlib.contextmanager
def _torch_threads(count: int) -> Iterator[None]:
    before = torch.get_num_threads()
    torch.set_num_threads(count)
    try:
        yield
    finally:
        torch.set_num_threads(before)
