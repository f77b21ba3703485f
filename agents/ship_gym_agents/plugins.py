"""A user's own things from a file: ``"mylqr.py:LQR"`` is the object LQR of the file mylqr.py.

The file is run once in a process, as Python would import it; modules beside it can be imported.
"""

from __future__ import annotations

import inspect
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError, check_known
from ship_gym.evaluation.controller import Controller, check_controller
from ship_gym.own_files import load_file, split, told
from ship_gym_agents.gains_files import kind_of


def file_of(text: str) -> Path:
    """The file of a name that means one (`is_own`)."""
    found = split(text)
    assert found is not None
    return found[0]


def is_own(text: str) -> bool:
    """Whether a name means a file of Python: ``file.py`` or ``file.py:Name``."""
    return split(text) is not None


def check_no_code(base: str, file: str | Path, instead: str) -> None:
    """Refuse an autopilot that is a Python file: what a card names must not be run.

    Parameters
    ----------
    base : str
        As ``make_controller`` takes it; a file of gains may name Python, too.
    file : path
        What names it.
    instead : str
        What to do, for the message.
    """
    kind = kind_of(base) if base.endswith(".toml") and Path(base).is_file() else base
    if any(is_own(part) for part in (kind, kind.rpartition("@")[0])):
        raise ConfigError(
            f"{file}: steers by {base}, which is Python code of its own, not run for a file; "
            f"{instead}"
        )


def load_object(text: str) -> Any:
    """The object that ``"file.py:Name"`` names.

    Raises
    ------
    ConfigError
        No such file, no such name in it (with the nearest one), or an exception while the file
        runs, with its line.
    """
    path, name = split(text) or (Path(text), "")
    module = load_file(path)
    public = [key for key in vars(module) if not key.startswith("_")]
    if not name:
        found = controllers_in(path) or [f"{path}:NAME"]
        raise ConfigError(f"{path}: which object of the file? Name it, like {', '.join(found)}")
    if name not in vars(module):
        check_known(f"name in {path}", name, public)
    return vars(module)[name]


def own_controller(text: str) -> Controller:
    """The controller that ``"file.py:Name"`` names: a class, a factory, or the object itself.

    Raises
    ------
    ConfigError
        As `load_object`, or what it names cannot be made without arguments or is no controller.
    """
    made = load_object(text)
    if inspect.isclass(made) or (callable(made) and not isinstance(made, Controller)):
        try:
            made = made()
        except Exception as error:
            raise ConfigError(
                f"{text}: cannot be made: {told(file_of(text).resolve(), error)}"
            ) from error
    check_controller(made, f"{text}:")
    return made


def controllers_in(path: str | Path) -> list[str]:
    """What of a file can be named as a controller, as ``file.py:Name``."""
    module = load_file(Path(path))
    own = [key for key, value in vars(module).items() if _steers(value, module.__name__)]
    return [f"{path}:{key}" for key in own]


def _steers(thing: Any, module: str) -> bool:
    """Whether a class of this module or an object has what a controller needs."""
    if inspect.isclass(thing) and thing.__module__ != module:
        return False
    return all(callable(getattr(thing, key, None)) for key in ("reset", "act"))
