"""The environment ids: one for each task, made from its name."""

from __future__ import annotations

import os

from gymnasium.envs.registration import register, registry

from ship_gym import own_files
from ship_gym.config import ConfigError, check_known
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
    from ship_gym.scenarios.scenario import check_task, load_scenario  # late: kernels

    if not isinstance(task, Task):
        raise ConfigError(f"register_task({task!r}): needs a ship_gym.tasks.api.Task")
    check_task(task)
    before = TASKS.outside().get(task.name)
    TASKS.add(task)
    try:
        load_scenario(task.name)
    except Exception:
        TASKS.forget(task.name, before)
        raise
    _register(task.name, task.version)


def load_task(name_or_file: str | os.PathLike) -> Task:
    """A task by name, or one of a Python file, which is known then.

    Parameters
    ----------
    name_or_file : str or path
        One of ``ship_gym.tasks.TASKS``, or a file that calls ``ship_gym.register_task``;
        ``file.py:NAME`` registers the `Task` of that name in it. The file is run.

    Raises
    ------
    ConfigError
        An unknown name, no such file, an error while it runs, no task in it or several.
    """
    file = own_files.split(name_or_file)
    if file is None:
        return TASKS[str(name_or_file)]
    path, wanted = file
    here = {k: v for k, v in vars(own_files.load_file(path)).items() if isinstance(v, Task)}
    if wanted:
        task = here[check_known(f"Task in {path}", wanted, here)]
        if TASKS.outside().get(task.name) is not task:
            register_task(task)
        TASKS.files[task.name] = str(name_or_file)
        return task
    known = [task for task in here.values() if TASKS.outside().get(task.name) is task]
    if len(known) != 1:
        raise ConfigError(
            f"{path}: registers {len(known)} tasks ({', '.join(t.name for t in known)}); one is "
            f"needed, or {path}:NAME with the name of a Task in it"
        )
    TASKS.files[known[0].name] = str(name_or_file)
    return known[0]


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
