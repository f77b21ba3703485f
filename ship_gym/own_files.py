"""Python files of a user: run once in a process, as Python would import them.

Running a file runs its code: name only files that you trust.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import re
import sys
import traceback
from pathlib import Path
from types import ModuleType

from ship_gym.config import ConfigError

_files: dict[tuple[Path, int], ModuleType] = {}


def split(text: str | os.PathLike) -> tuple[Path, str] | None:
    """File and name of ``file.py:Name``, the name empty if there is none; None: no such thing."""
    found = re.fullmatch(r"(.+\.py)(?::(.*))?", str(text))
    return (Path(found[1]), found[2] or "") if found else None


def load_file(path: str | os.PathLike) -> ModuleType:
    """The module that a file makes, run once for each version of the file.

    It goes by the file's name, so that what it defines can be pickled and its kernels cached;
    modules beside it can be imported.

    Raises
    ------
    ConfigError
        No such file, or an exception while it runs, with its line.
    """
    path = Path(path)
    if not os.path.isfile(path):
        raise ConfigError(f"{path}: no such file")
    path = path.resolve()
    key = path, path.stat().st_mtime_ns
    if key not in _files:
        _files[key] = _run(path)
    return _files[key]


def _run(path: Path) -> ModuleType:
    name = path.stem
    known = sys.modules.get(name)
    if known is not None and getattr(known, "__file__", None) != str(path):
        name = f"{name}_{hashlib.sha256(str(path).encode()).hexdigest()[:8]}"
    if str(path.parent) not in sys.path:
        sys.path.append(str(path.parent))
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None and spec.loader is not None  # as of every .py file
    module = importlib.util.module_from_spec(spec)
    before = sys.modules.get(name)
    sys.modules[name] = module  # dataclasses and pickle look there
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        del sys.modules[name]
        if before is not None:
            sys.modules[name] = before
        raise ConfigError(told(path, error)) from error
    return module


def told(path: Path, error: BaseException) -> str:
    """An exception in one line, with the last line of the file that it passed."""
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if Path(frame.filename) == path]
    text = str(error)
    if isinstance(error, SyntaxError) and error.filename == str(path):
        lines, text = [error.lineno], error.msg
    place = f"{path}:{lines[-1]}: " if lines else ""
    return f"{place}{type(error).__name__}: {text}"
