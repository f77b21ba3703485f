"""Tasks: what the agent sees, what it is paid for, when the episode ends, how it is judged.

One folder each, found by being there. Their names cost no import; a task itself, with its kernels,
loads when it is asked for.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator, Mapping

from ship_gym.config import ConfigError, nearest, shown
from ship_gym.tasks.base import Row, Task, class_name


class _Tasks(Mapping):
    """All tasks by name; those of the package are imported at first use."""

    def __init__(self):
        # name -> module of a package's task, or the task itself
        self._known: dict[str, str | Task] = {}
        self.versions: dict[str, int] = {}
        self.files: dict[str, str] = {}  # of tasks outside the package, as `load_task` took them
        for found in pkgutil.iter_modules(__path__):
            if found.ispkg:
                folder = importlib.import_module(f"{__name__}.{found.name}")  # two constants
                self._known[folder.NAME] = f"{folder.__name__}.task"
                self.versions[folder.NAME] = folder.VERSION

    def __reduce__(self):
        return _all_tasks, ()

    def __getitem__(self, name: str) -> Task:
        if name not in self:
            raise ConfigError(
                f"unknown task {shown(name)};{nearest(name, self._known)}. A task of one's own is "
                "known once its file is named: --task FILE.py, ship_gym.load_task('FILE.py')"
            )
        found = self._known[name]
        if isinstance(found, str):
            found = self._known[name] = importlib.import_module(found).TASK
        return found

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and name in self._known  # a list has no hash

    def __iter__(self) -> Iterator[str]:
        return iter(self._known)

    def __len__(self) -> int:
        return len(self._known)

    def own(self) -> list[str]:
        """Names of the package's own tasks."""
        outside = self.outside()
        return [name for name in self._known if name not in outside]

    def outside(self) -> dict[str, Task]:
        """Tasks from outside the package by name."""
        return {k: t for k, t in self._known.items() if isinstance(t, Task) and t.scenario}

    def add(self, task: Task) -> None:
        """Know a task from outside the package; the same name again replaces one from outside."""
        known = self._known.get(task.name)
        if isinstance(known, str) or (known is not None and known.scenario is None):
            raise ConfigError(f"task {task.name!r} is one of the package; choose another name")
        same = [k for k in self._known if k != task.name and class_name(k) == task.class_name]
        if same:
            raise ConfigError(
                f"task {task.name!r} has the class name of {same[0]!r}; choose another"
            )
        if task.scenario is None:
            raise ConfigError(
                f"task {task.name!r}: give its default `scenario`, such as "
                '{"base": "heading_keeping", ...}'
            )
        self._known[task.name] = task
        self.versions[task.name] = task.version

    def forget(self, name: str, before: Task | None = None) -> None:
        """Take back `add`; `before` is what the name stood for."""
        del self._known[name], self.versions[name]
        if before is not None:
            self.add(before)


TASKS = _Tasks()


def _all_tasks() -> _Tasks:
    return TASKS


def observations_of(task: str, with_privileged: bool = False) -> tuple[Row, ...]:
    """Rows of the observation of a task: bridge, its own, then the privileged ones if wanted."""
    from ship_gym.tasks import bridge, privileged  # late: kernels

    rows = (*bridge.OBSERVATIONS, *TASKS[task].observations)
    return (*rows, *privileged.OBSERVATIONS) if with_privileged else rows
