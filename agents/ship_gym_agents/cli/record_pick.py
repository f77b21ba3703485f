"""Which of many episodes ``ship-gym record`` keeps, and of which seeds they are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import click

OF = 32  # episodes to choose from, as many as an evaluation sails


class Pick(NamedTuple):
    """What is kept of the episodes of a controller; nothing asked: all of them.

    Attributes
    ----------
    worst, best : int
        How many, 0 without the option.
    median : bool
    by : str or None
        The metric that decides; None: the headline of the task.
    """

    worst: int
    best: int
    median: bool
    by: str | None

    @property
    def most(self) -> int:
        """How many are kept at most; 0 where all are."""
        return self.worst + self.best + self.median

    def seeds(self, seed: int | None, seeds: Sequence[int] | None, of: int | None) -> Sequence[int]:
        """Seeds to sail, from ``--seed``, ``--seeds`` and ``--of``, which exclude each other."""
        from ship_gym.evaluation.splits import evaluation_seeds

        options = {"--seed": seed, "--seeds": seeds, "--of": of}
        given = [option for option, value in options.items() if value is not None]
        if len(given) > 1:
            raise click.UsageError(f"{given[0]} and {given[1]}: give one of them")
        if not self.most:
            alone = [("--by", self.by), ("--of", of)]
            for option, value in alone:
                if value is not None:
                    raise click.UsageError(f"{option} {value}: needs --worst, --best or --median")
        if seed is not None:
            return [seed]
        if seeds is not None:
            return seeds
        return evaluation_seeds(of or (OF if self.most else 1))

    def metric(self, task: str) -> tuple[str, Mapping[str, Any]]:
        """Name of the metric that decides, and all metrics of the task.

        Raises
        ------
        ConfigError
            The task has no such metric (names the nearest one), or none at all.
        """
        from ship_gym.config import check_known
        from ship_gym.evaluation import metrics_of
        from ship_gym.tasks import TASKS

        known = metrics_of(task)
        name = check_known("metric", self.by or TASKS[task].headline, known)
        return name, known

    def chosen(
        self, values: Sequence[float | None], better: str, failed: Sequence[bool]
    ) -> dict[int, str]:
        """Episodes to keep, index to what it is; one that is several is kept once."""
        from ship_gym.evaluation import choice

        found: dict[int, str] = {}
        counts = {"worst": self.worst, "best": self.best, "median": int(self.median)}
        for which, count in counts.items():
            for i in choice.chosen(which, values, better, failed, count) if count else ():
                found[i] = f"{found[i]}, {which}" if i in found else which
        return found
