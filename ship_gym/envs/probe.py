"""A task's kernels tried once, on copies, before an episode of it is sailed.

A kernel that writes more terms or rows than its task names would write beside the arrays; one that
writes fewer would shift names or leave zeros. Both are told before anything is sailed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.tasks import bridge

if TYPE_CHECKING:
    from ship_gym.envs.episodes import EpisodeBatch
    from ship_gym.tasks.base import Task

_SPARE = 16  # columns behind those that are named, so that nothing else is written over
_tried: set[Task] = set()


def try_kernels(episodes: EpisodeBatch) -> None:
    """Compare what the kernels of a task write with what it names; once for each task.

    Raises
    ------
    ConfigError
        Terms, rows of the observation or an outcome that the task does not name, or names without
        them.
    """
    task = episodes.task
    if task in _tried:
        return
    sim, n = episodes.sim, episodes.n
    rows = bridge.N_BRIDGE + len(task.observations)
    seen = np.full((n, rows + _SPARE), np.nan, dtype=np.float32)
    task.observe(
        sim.state, sim.waves, sim.commands, sim.records, sim.seas, episodes.tasks.copy(),
        episodes.elapsed.copy(), seen,
    )  # fmt: skip
    _check(task, "rows of the observation", _written(seen), rows)
    terms = np.full((n, len(episodes.reward_terms) + _SPARE), np.nan)
    results = np.zeros(n, bridge.RESULT_DTYPE)
    task.judge(
        sim.state, sim.state.copy(), sim.seas, episodes.tasks.copy(), episodes.plans.copy(), terms,
        results,
    )  # fmt: skip
    _check(task, "terms of the reward, costs included", _written(terms), len(episodes.reward_terms))
    check_outcomes(task, results["outcome"])
    _tried.add(task)


def check_outcomes(task: Task, outcomes: np.ndarray) -> None:
    """Refuse an outcome that the task does not name."""
    known = task.all_outcomes
    wrong = outcomes[(outcomes < 0) | (outcomes >= len(known))]
    if len(wrong):
        raise ConfigError(
            f"task {task.name!r}: its kernel gives outcome {wrong[0]}; named are "
            f"{', '.join(f'{k} {end.name}' for k, end in enumerate(known))}"
        )


def _written(array: np.ndarray) -> int:
    """How many columns, from the first, were written."""
    missing = np.isnan(array).any(axis=0)
    return int(missing.argmax()) if missing.any() else array.shape[1]


def _check(task: Task, what: str, written: int, named: int) -> None:
    if written != named:
        raise ConfigError(
            f"task {task.name!r}: its kernel writes {written} {what}; it names {named}"
        )
