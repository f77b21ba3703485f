"""The class of each environment id, with its page as docstring; made when it is asked for.

``from ship_gym.envs.classes import HeadingKeeping``, or ``ship_gym.HeadingKeeping``.
"""

from __future__ import annotations

from ship_gym.envs.docstring import docstring
from ship_gym.envs.env import ShipEnv
from ship_gym.tasks import TASKS
from ship_gym.tasks.base import Task, class_name


def class_of(task: Task) -> type[ShipEnv]:
    """Class of the environments of a task."""
    known = globals().get(task.class_name)
    if known is not None and known.task is task:
        return known
    made = type(
        task.class_name,
        (ShipEnv,),
        {
            "__doc__": docstring(task),
            "__module__": __name__,
            "scenario_name": task.name,
            "task": task,
        },
    )
    globals()[task.class_name] = made  # so that instances can be pickled
    return made


def __getattr__(name: str) -> type[ShipEnv]:
    for task_name in TASKS:
        if class_name(task_name) == name:
            return class_of(TASKS[task_name])
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
