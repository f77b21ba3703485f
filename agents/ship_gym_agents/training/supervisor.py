"""Supervisor: what happens between the rollouts of a training run."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from stable_baselines3.common.callbacks import BaseCallback

from ship_gym_agents.training.budget import Budget


class Supervisor(BaseCallback):
    """Set the exploration, validate at even intervals, move the progress bar, stop in time.

    Parameters
    ----------
    budget : Budget
    validations : int
        Number of validations over the budget; the last one is due after the end and not done here.
    validate : callable
        Called without arguments between two rollouts.
    explore : callable
        Called with the used share of the budget before each rollout.
    bar : object, optional
        With ``n``, ``total`` and ``update(increment)``, like a ``tqdm`` bar.
    """

    def __init__(
        self,
        budget: Budget,
        validations: int,
        validate: Callable[[], Any],
        explore: Callable[[float], None],
        bar: Any = None,
    ):
        super().__init__()
        self._budget, self._validate, self._explore, self._bar = budget, validate, explore, bar
        self._interval = 1.0 / validations
        self._next = 0.0

    def _on_training_start(self) -> None:
        used = self._budget.used(self.num_timesteps)
        self._next = (used // self._interval + 1.0) * self._interval

    def _on_rollout_start(self) -> None:
        used = self._budget.used(self.num_timesteps)
        if used >= self._next and used < 1.0:
            self._next = (used // self._interval + 1.0) * self._interval
            self._validate()
        self._explore(used)

    def _on_step(self) -> bool:
        if self._bar is not None:
            used = self._budget.used(self.num_timesteps)
            self._bar.update(int(used * self._bar.total) - self._bar.n)
        return not self._budget.time_is_up  # samples end the run with a whole rollout
