"""The environment ids: one for each task, made from its name."""

from __future__ import annotations

from gymnasium.envs.registration import register, registry

from ship_gym.tasks import TASKS
from ship_gym.tasks.base import Task, class_name, env_id

ENVIRONMENTS: dict[str, str] = {}  # id -> name of its default scenario


def register_all() -> None:
    """Register the ids of all tasks with Gymnasium; safe to call twice."""
    for name, version in TASKS.versions.items():
        _register(name, version)


def register_task(task: Task) -> None:
    """Know a task from outside the package: its id, class and default scenario are there then.

    To register a name again replaces it, as when a notebook runs a cell twice.

    Parameters
    ----------
    task : Task
        See ``ship_gym.tasks.api``, which has all that a task is made of.

    Raises
    ------
    ConfigError
        A name of the package's own, or a default scenario that is wrong.
    """
    from ship_gym.scenarios.scenario import load_scenario, scenario_class  # late: kernels
    from ship_gym.tasks.bridge import record_dtype

    before = TASKS.outside().get(task.name)
    TASKS.add(task)
    try:
        scenario_class(task)
        record_dtype(task)
        load_scenario(task.name)
    except Exception:
        TASKS.forget(task.name, before)
        raise
    _register(task.name, task.version)


def _register(name: str, version: int) -> None:
    """Register one id.

    No ``max_episode_steps``: truncation happens inside, since ``make_vec`` adds no TimeLimit.
    """
    made = env_id(name, version)
    ENVIRONMENTS[made] = name
    if made not in registry:
        register(
            id=made,
            entry_point=f"ship_gym.envs.classes:{class_name(name)}",
            vector_entry_point="ship_gym.envs.vector_env:ShipVectorEnv",
            kwargs={"scenario": name},
        )
