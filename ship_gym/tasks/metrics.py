"""Metrics of one episode, computed from its recording alone, so that a stored file gives the same.

Each task has its own (``ship_gym.tasks``); ``tasks.measures`` says how episodes count that ended
early, and holds what all have in common.
"""

from __future__ import annotations

import math

from ship_gym.config import ConfigError
from ship_gym.recording.trajectory import Trajectory
from ship_gym.tasks import TASKS, measures
from ship_gym.tasks.base import Metric


def metrics_of(task: str) -> dict[str, Metric]:
    """Metrics of a task, in the order of a table.

    Raises
    ------
    ConfigError
        An unknown task, or one without metrics.
    """
    found = TASKS[task]
    if found.measure is None:
        raise ConfigError(
            f"task {task!r} has no metrics: give its Task `metrics` and `measure`, which computes "
            "them from a recording (ship_gym.tasks.measures has parts for it)"
        )
    return {**found.metrics, **measures.COMMON}


def all_metrics() -> dict[str, Metric]:
    """Metrics of all tasks, each once, the common ones last."""
    own = [task.metrics for task in TASKS.values() if task.measure is not None]
    return {name: m for part in (*own, measures.COMMON) for name, m in part.items()}


def metrics(trajectory: Trajectory) -> dict[str, float | None]:
    """Metrics of one episode.

    Parameters
    ----------
    trajectory : Trajectory
        As made by ``Rollout.trajectory`` or read back from its file.

    Returns
    -------
    dict of str to float or None
        The keys of `metrics_of` its task, with the units there. None where an episode has no such
        value: a steady part, if it is all turn; what `measure` gives as None, NaN or infinite.

    Raises
    ------
    ConfigError
        A recording of something else, or of a task that is not known here or has no metrics.
    """
    if not isinstance(trajectory, Trajectory):
        raise ConfigError(
            f"metrics of a {type(trajectory).__name__}: needs a Trajectory, for example "
            "rollout.trajectory(0)"
        )
    _check(trajectory)
    names, task = metrics_of(trajectory.meta["task"]), TASKS[trajectory.meta["task"]]
    assert task.measure is not None  # as `metrics_of` has seen
    own = task.measure(trajectory)
    if set(own) != set(task.metrics):
        raise ConfigError(
            f"task {task.name!r}: `measure` gives {sorted(own)}, `metrics` names "
            f"{sorted(task.metrics)}"
        )
    found = {**own, **measures.common(trajectory, task)}
    values = {name: math.nan if found[name] is None else float(found[name]) for name in names}
    return {name: value if math.isfinite(value) else None for name, value in values.items()}


def _check(trajectory: Trajectory) -> None:
    meta = trajectory.meta
    missing = [name for name in measures.COLUMNS if name not in trajectory]
    missing += [f"meta {name}" for name in measures.META if name not in meta]
    if missing:
        raise ConfigError(
            f"a recording of task {meta.get('task')!r} has no metrics: it lacks "
            f"{', '.join(missing)}"
        )
    if len(trajectory) < 2:
        raise ConfigError("a recording needs at least two rows for metrics")
