"""Tasks: what the agent sees, what it is paid for, when the episode ends, how it is judged.

One folder each, found by being there. Their names cost no import; a task itself, with its kernels,
loads when it is asked for.
"""

from __future__ import annotations

import hashlib
import importlib
import importlib.util
import os
import pkgutil
import sys
import traceback
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import ModuleType

from ship_gym.config import ConfigError, check_known, nearest
from ship_gym.tasks.base import Row, Task


class _Tasks(Mapping):
    """All tasks by name; those of the package are imported at first use."""

    def __init__(self):
        # name -> module of a package's task, or the task itself
        self._known: dict[str, str | Task] = {}
        self.versions: dict[str, int] = {}
        for found in pkgutil.iter_modules(__path__):
            if found.ispkg:
                folder = importlib.import_module(f"{__name__}.{found.name}")  # two constants
                self._known[folder.NAME] = f"{folder.__name__}.task"
                self.versions[folder.NAME] = folder.VERSION

    def __reduce__(self):
        return _all_tasks, ()

    def __getitem__(self, name: str) -> Task:
        found = self._known[check_known("task", name, self._known)]
        if isinstance(found, str):
            found = self._known[name] = importlib.import_module(found).TASK
        return found

    def __contains__(self, name: object) -> bool:
        return name in self._known

    def __iter__(self) -> Iterator[str]:
        return iter(self._known)

    def __len__(self) -> int:
        return len(self._known)

    def outside(self) -> dict[str, Task]:
        """Tasks from outside the package by name."""
        return {k: t for k, t in self._known.items() if isinstance(t, Task) and t.scenario}

    def add(self, task: Task) -> None:
        """Know a task from outside the package; the same name again replaces one from outside."""
        known = self._known.get(task.name)
        if isinstance(known, str) or (known is not None and known.scenario is None):
            raise ConfigError(f"task {task.name!r} is one of the package; choose another name")
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


def load_task(name_or_file: str | os.PathLike) -> Task:
    """A task by name, or one that a Python file registers.

    Parameters
    ----------
    name_or_file : str or path
        One of `TASKS`, or a file that calls ``ship_gym.register_task``; ``file.py:NAME`` registers
        the `Task` of that name in it. The file is run: load only what you trust.

    Raises
    ------
    ConfigError
        An unknown name, no such file, an error while it runs, no task in it or several.
    """
    path, colon, wanted = str(name_or_file).partition(".py:")
    if colon or path.endswith(".py"):
        return _from_file(Path(path + ".py" if colon else path), wanted)
    return TASKS[str(name_or_file)]


def _from_file(path: Path, wanted: str) -> Task:
    from ship_gym.envs.registration import register_task  # above us; a file does the same

    before = TASKS.outside()
    module = import_file(path)
    if wanted:
        task = getattr(module, wanted, None)
        if not isinstance(task, Task):
            names = [k for k, v in vars(module).items() if isinstance(v, Task)]
            raise ConfigError(f"{path}: {wanted!r} is no Task;{nearest(wanted, names)}")
        if TASKS.outside().get(task.name) is not task:
            register_task(task)
        return task
    new = [task for name, task in TASKS.outside().items() if before.get(name) is not task]
    if len(new) != 1:
        raise ConfigError(
            f"{path}: registers {len(new)} tasks ({', '.join(t.name for t in new)}); one is "
            f"needed, or {path}:NAME with the name of a Task in it"
        )
    return new[0]


def import_file(path: str | os.PathLike) -> ModuleType:
    """Run a Python file of a user as a module; it is known by its name, so that it can be pickled.

    Raises
    ------
    ConfigError
        No such file, or an error while it runs, with its line.
    """
    path = Path(path)
    if not path.is_file():
        raise ConfigError(f"{path}: no such file")
    name = path.stem
    known = sys.modules.get(name)
    if known is not None and getattr(known, "__file__", None) != str(path.resolve()):
        name = f"{name}_{hashlib.sha256(str(path.resolve()).encode()).hexdigest()[:8]}"
    spec = importlib.util.spec_from_file_location(name, path.resolve())
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        del sys.modules[name]
        frames = traceback.extract_tb(error.__traceback__)
        lines = [frame.lineno for frame in frames if frame.filename == str(path.resolve())]
        line = lines[-1] if lines else getattr(error, "lineno", "?")
        raise ConfigError(f"{path}:{line}: {type(error).__name__}: {error}") from error
    return module


def observations_of(task: str, with_privileged: bool = False) -> tuple[Row, ...]:
    """Rows of the observation of a task: bridge, its own, then the privileged ones if wanted."""
    from ship_gym.tasks import bridge, privileged  # late: kernels

    rows = (*bridge.OBSERVATIONS, *TASKS[task].observations)
    return (*rows, *privileged.OBSERVATIONS) if with_privileged else rows
