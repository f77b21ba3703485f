"""What every verb shares when it works: one-line errors, progress bar, JSON, needed libraries."""

from __future__ import annotations

import contextlib
import json
import os
import shlex
import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import click

_REFUSED = 2  # exit code: nothing was done, or it was broken off
_QUIET = 2.0  # seconds before a progress bar appears
# library -> extra of ship-gym that brings it, and what for
_EXTRAS = {
    "rerun": ("rerun", "recordings"),
    "matplotlib": ("plot", "pictures"),
    "pyarrow": ("benchmark", "tables as parquet"),
    "PIL": ("render", "pictures by the painter"),
    "capytaine": ("bem", "wave tables"),
    "joblib": ("bem", "wave tables"),
    "av": ("video", "videos"),
    "stable_baselines3": ("rl", "training"),
    "torch": ("rl", "training"),
    "onnx": ("onnx", "ONNX files"),
    "pythonfmu": ("fmu", "FMUs"),
    "pythonfmu3": ("fmu", "FMUs of FMI 3.0"),
    "minari": ("minari", "data sets"),
}


def run(main: Callable[[], Any]) -> None:
    """Call `main`; errors a user can mend are on stderr, one line each, and exit code 2."""
    usual = threading.excepthook
    threading.excepthook = lambda ended: _thread_ended(ended, usual)
    try:
        main()
        with _stdout():  # at exit Python would print a trace
            sys.stdout.flush()
    except (KeyboardInterrupt, click.Abort) as stop:  # click's stands for one that says more
        sys.exit(_refuse(str(stop.__cause__ or stop) or "interrupted"))
    except click.ClickException as error:
        sys.exit(_refuse(f"error: {_one_line(error.format_message())}"))
    except Exception as error:
        if not (text := _in_words(error)):
            raise
        sys.exit(_refuse(f"error: {text}"))
    finally:
        threading.excepthook = usual


def _thread_ended(ended: Any, usual: Callable[[Any], Any]) -> None:
    """A library's writing thread that found a full disk says so in a line, not with a trace."""
    from ship_gym.writing import no_space

    if ended.exc_value is not None and (reason := no_space(ended.exc_value)):
        print(f"warning: a log is broken off: {reason}", file=sys.stderr)
    else:
        usual(ended)


def _in_words(error: Exception) -> str:
    """An error that a user can mend, in words; empty for one that only a programmer can."""
    from ship_gym.config import ConfigError  # late: it imports Gymnasium
    from ship_gym.writing import DiskFull, causes, no_space

    for full in causes(error):
        if isinstance(full, DiskFull):
            return str(full)
    if reason := no_space(error):
        where = getattr(error, "filename", None)
        return f"{where}: {reason}" if where else f"{reason}; what was being written is not whole"
    if isinstance(error, ConfigError):  # a line for each thing that is wrong
        return str(error)
    return _one_line(error) if isinstance(error, ImportError | OSError) else ""


def _one_line(text: object) -> str:
    return " ".join(str(text).split())


@contextlib.contextmanager
def _stdout() -> Iterator[None]:
    """Name stdout in an error of writing to it; a pipe that is read no more is none."""
    try:
        yield
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # for the flush at exit
        if not isinstance(error, BrokenPipeError):
            error.filename = "stdout"
            raise


def _refuse(message: str) -> int:
    from ship_gym.config import cut  # late, as above

    for line in filter(None, map(_one_line, message.splitlines())):
        print(cut(line), file=sys.stderr)
    return _REFUSED


def need(*libraries: str) -> None:
    """Refuse, before any work, what a library that is not installed would break off later."""
    for library in libraries:
        if find_spec(library) is None:
            extra, purpose = _EXTRAS[library]
            raise ImportError(f'{purpose} need {library}: pip install "ship-gym[{extra}]"')


def progress(iterable: Any, description: str = "", total: int | None = None) -> Any:
    """The iterable with a tqdm bar on a terminal after 2 s, if tqdm is installed; else as it is."""
    try:
        from tqdm import tqdm
    except ImportError:
        return iterable
    # disable=None: no bar where stderr is no terminal
    return tqdm(iterable, description, total, leave=False, delay=_QUIET, disable=None)


def show(as_json: bool, data: Mapping[str, Any], text: str) -> None:
    """Print `data` as JSON (``--json``) or `text` for people, on stdout."""
    with _stdout():
        print(json.dumps(data, indent=2, allow_nan=False) if as_json else text)


def next_command(verb: str, **options: Any) -> str:
    """A ``ship-gym`` command to go on with, to be copied; options without a value are left out."""
    words = ["ship-gym", verb]
    for name, value in options.items():
        option = f"--{name.replace('_', '-')}"
        for each in value if isinstance(value, list | tuple) else [value]:
            if each is not None:
                words += [option, shlex.quote(str(each))]
    return " ".join(words)


def place(given: Path | None, usual: str | Path, option: str = "--out") -> Path:
    """The file to write: the one that was given, and tried then, else the usual one, tried now."""
    if given is not None:
        return given
    from ship_gym.writing import check_place

    return check_place(usual, option)


def report_page(wanted: Path | None, table: Path) -> Path | None:
    """File of the page: the one named, else beside the table; None without ``--report``."""
    return table.with_suffix(".html") if wanted == Path() else wanted


def check_different(**files: Path | None) -> None:
    """Refuse two outputs that are one file."""
    from ship_gym.config import ConfigError

    seen: dict[Path, str] = {}
    for option, path in files.items():
        if path is None:
            continue
        if (other := seen.setdefault(path.resolve(), option)) != option:
            raise ConfigError(f"--{option} {path}: --{other} writes that file")
