"""A user's own things from a file: ``"mylqr.py:LQR"`` is the object LQR of the file mylqr.py.

The file is run once in a process, as Python would import it; modules beside it can be imported.
"""

from __future__ import annotations

import inspect
import re
import sys
import traceback
from pathlib import Path
from types import ModuleType
from typing import Any

from ship_gym.config import ConfigError, check_known
from ship_gym.evaluation.controller import Controller

_MEMBERS = ("name", "reset", "act")
_files: dict[tuple[Path, int], ModuleType] = {}


def is_own(text: str) -> bool:
    """Whether a name means a file of Python: ``file.py`` or ``file.py:Name``."""
    return _split(text) is not None


def load_object(text: str) -> Any:
    """The object that ``"file.py:Name"`` names.

    Raises
    ------
    ConfigError
        No such file, no such name in it (with the nearest one), or an exception while the file
        runs, with its line.
    """
    path, name = _split(text) or (Path(text), "")
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
                f"{text}: cannot be made: {_told(_split(text)[0].resolve(), error)}"
            ) from error
    missing = [key for key in _MEMBERS if not hasattr(made, key)]
    if missing:
        raise ConfigError(f"{text}: is no controller: it has no {' and no '.join(missing)}")
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


def load_file(path: Path) -> ModuleType:
    """The module that a file makes, run once for each version of the file."""
    if not path.is_file():
        raise ConfigError(f"{path}: no such file")
    path = path.resolve()
    key = path, path.stat().st_mtime_ns
    if key not in _files:
        _files[key] = _run(path, f"_ship_gym_own_{len(_files)}_{path.stem}")
    return _files[key]


def _run(path: Path, name: str) -> ModuleType:
    module = ModuleType(name)
    module.__file__ = str(path)
    sys.modules[name] = module  # dataclasses and pickle look there
    if str(path.parent) not in sys.path:
        sys.path.append(str(path.parent))
    try:
        exec(compile(path.read_bytes(), str(path), "exec"), vars(module))
    except (Exception, SystemExit) as error:
        del sys.modules[name]
        raise ConfigError(_told(path, error)) from error
    return module


def _told(path: Path, error: BaseException) -> str:
    """An exception in one line, with the last line of the file that it passed."""
    lines = [
        f.lineno for f in traceback.extract_tb(error.__traceback__) if Path(f.filename) == path
    ]
    if isinstance(error, SyntaxError) and error.filename == str(path):
        lines, error.args = [error.lineno], error.args[:1]  # args: the message without its place
    place = f"{path}:{lines[-1]}: " if lines else ""
    return f"{place}{type(error).__name__}: {error}"


def _split(text: str) -> tuple[Path, str] | None:
    """File and name of ``file.py:Name``; None if it is nothing of the kind."""
    found = re.fullmatch(r"(.+\.py)(?::(.*))?", str(text))
    return (Path(found[1]), found[2] or "") if found else None
