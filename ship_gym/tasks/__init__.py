"""Tasks: what the agent sees, what it is paid for, when the episode ends; batches of numbers."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from ship_gym.tasks import bridge, heading, privileged, track


class Task(NamedTuple):
    """One task: tables for people and loops over ships.

    Attributes
    ----------
    observations : tuple
        Rows (symbol, unit, low, high, meaning) of the observation.
    reward_terms : tuple of str
    observe_batch, judge_batch, begin_batch : callable
        See ``tasks.heading`` and ``tasks.track``.
    """

    observations: tuple[tuple[str, str, float, float, str], ...]
    reward_terms: tuple[str, ...]
    observe_batch: Callable
    judge_batch: Callable
    begin_batch: Callable


def _task(module, extra=()) -> Task:
    loops = module.observe_batch, module.judge_batch, module.begin_batch
    return Task((*bridge.OBSERVATIONS, *extra), module.REWARD_TERMS, *loops)


TASKS: dict[str, Task] = {
    "heading_keeping": _task(heading),
    "course_changing": _task(heading),
    "track_following": _task(track, track.OBSERVATIONS),
}


def observations_of(task: str, with_privileged: bool = False):
    """Rows (symbol, unit, low, high, meaning) of the observation of a task."""
    rows = TASKS[task].observations
    return (*rows, *privileged.OBSERVATIONS) if with_privileged else rows
