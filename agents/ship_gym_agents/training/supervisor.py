"""Supervisor: what happens between the rollouts of a training run with stable-baselines3."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from stable_baselines3.common.callbacks import BaseCallback

from ship_gym_agents.training.progress import Progress
from ship_gym_agents.training.run import Run


class Supervisor(BaseCallback):
    """Set the exploration, let the run do what is due, move the progress bar, stop in time.

    Parameters
    ----------
    run : Run
    policy, save : callable
        As `Run.between` takes them.
    explore : callable
        Called with the used share of the budget before each rollout.
    learner : callable
        What the learner tells of itself, such as its multiplier: names to numbers.
    bar : object, optional
        As in `Progress`.
    """

    def __init__(
        self,
        run: Run,
        policy: Callable[[], Any],
        save: Callable[[Path], None],
        explore: Callable[[float], None],
        learner: Callable[[], dict[str, float]],
        bar: Any = None,
    ):
        super().__init__()
        self._run, self._policy, self._save = run, policy, save
        self._explore, self._learner = explore, learner
        self._progress = Progress(run, bar)

    def _on_training_start(self) -> None:
        self._run.begin(self._policy, self._save)
        self._log(self._run.last)

    def _on_rollout_start(self) -> None:
        found = self._run.between(self.num_timesteps, self._policy, self._save, **self._learner())
        self._log(found)
        self._explore(self._run.budget.used(self.num_timesteps))

    def _log(self, found: dict[str, Any] | None) -> None:
        """A validation for tensorboard."""
        for name, value in (found or {}).items():
            if value is not None:
                self.logger.record(f"validation/{name}", value)
        if found:
            self.logger.dump(self.num_timesteps)

    def _on_step(self) -> bool:
        self._progress.show(self.num_timesteps, self._learner)
        return not self._run.budget.time_is_up  # samples end the run with a whole rollout
