"""A task's kernels tried once, on copies, before an episode of it is sailed.

A kernel that writes more terms or rows than its task names would write beside the arrays; one that
writes fewer would shift names or leave zeros. Both are told before anything is sailed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.envs.interval import Loops
from ship_gym.tasks import bridge

if TYPE_CHECKING:
    from ship_gym.tasks.base import Task

_SHIPS = 16  # that are tried
_SPARE = 16  # columns behind those that are named, so that nothing else is written over
_tried: set[Task] = set()


def try_kernels(task: Task, loops: Loops, terms: int) -> None:
    """Compare what the kernels of a task write with what it names; once for each task.

    Parameters
    ----------
    task : Task
    loops : Loops
        Of a batch whose episodes have begun; nothing of it is changed.
    terms : int
        Number of terms of the reward that are named, costs included.

    Raises
    ------
    ConfigError
        Terms, rows of the observation or an outcome that the task does not name, or names without
        them.
    """
    if task in _tried:
        return
    n = len(loops.episodes.tasks)
    count, rows = min(n, _SHIPS), bridge.N_BRIDGE + len(task.observations)
    spare = loops.episodes._replace(
        observations=np.full((n, rows + _SPARE), np.nan, dtype=np.float32),
        terms=np.full((n, terms + _SPARE), np.nan),
        privileged_from=0,
    )
    fleet, episodes = _first(loops.fleet, n, count), _first(spare, n, count)
    episodes.actions[:] = 0.0
    copy = Loops(task, fleet, episodes)
    copy.observe(np.arange(count))
    _check(task, "rows of the observation", _written(episodes.observations), rows)
    copy.interval(0, count)
    _check(task, "terms of the reward, costs included", _written(episodes.terms), terms)
    check_outcomes(task, episodes.results["outcome"])
    _tried.add(task)


def _first(arrays, n: int, count: int):
    """Copies of the rows of the first `count` of n ships; what is no array of ships is shared."""
    return arrays._replace(
        **{
            name: value[:count].copy()
            for name, value in arrays._asdict().items()
            if isinstance(value, np.ndarray) and len(value) == n
        }
    )


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
