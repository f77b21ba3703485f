"""The recordings of folders: what each one says of its run, bad files included."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError
from ship_gym.recording.trajectory import Trajectory

SUFFIXES = (".rrd", ".rrd.partial")  # complete recordings, and journals of runs on or broken off


@dataclass(frozen=True)
class Run:
    """A recorded run as one row of a table.

    Attributes
    ----------
    path : pathlib.Path
    meta : mapping
        Of the recording; empty if the file cannot be read.
    duration : float or None
        From the first row to the last [s].
    complete : bool
        False of a journal, whose run is on or was broken off.
    error : str
        Why the file cannot be read, in words; empty if it can.
    """

    path: Path
    meta: Mapping[str, Any] = field(default_factory=dict)
    duration: float | None = None
    complete: bool = False
    error: str = ""

    @property
    def metrics(self) -> Mapping[str, float | None]:
        """Metrics of an episode, measures of a manoeuvre, as they were stored."""
        return stored_metrics(self.meta)

    def value(self, name: str) -> str | float | None:
        """A column of `COLUMNS` or a metric; None where the run has none."""
        return COLUMNS[name](self) if name in COLUMNS else self.metrics.get(name)

    def columns(self) -> dict[str, str | float | None]:
        """All of `COLUMNS`."""
        return {name: get(self) for name, get in COLUMNS.items()}


def stored_metrics(meta: Mapping[str, Any]) -> dict[str, float | None]:
    """Metrics or measures in the meta of a recording; of a list, numbers with theirs behind."""
    found: dict[str, float | None] = {}
    for key, value in (meta.get("metrics") or {}).items():
        several = value if isinstance(value, list) else [value]
        names = [f"{key}_{k}" for k in range(1, len(several) + 1)] if several is value else [key]
        pairs = zip(names, several, strict=True)
        found |= {name: one for name, one in pairs if one is None or _is_number(one)}
    return found


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _named(run: Run, key: str) -> str | None:
    """An entry of the meta that is a name, or has one."""
    entry = run.meta.get(key)
    entry = entry.get("name") if isinstance(entry, Mapping) else entry
    return None if entry is None else str(entry)


def _kind(run: Run) -> str | None:
    """Episode or manoeuvre; recordings that do not say it have the manoeuvre in their config."""
    config = run.meta.get("config")
    manoeuvre = isinstance(config, Mapping) and "manoeuvre" in config
    return "manoeuvre" if manoeuvre else _named(run, "kind")


def _state(run: Run) -> str:
    return "unreadable" if run.error else "complete" if run.complete else "incomplete"


def _truth(run: Run, key: str) -> str | None:
    entry = run.meta.get(key)
    return None if entry is None else "yes" if entry else "no"


COLUMNS: dict[str, Callable[[Run], str | float | None]] = {
    "file": lambda run: str(run.path),
    "kind": _kind,
    "scenario": lambda run: _named(run, "scenario") or _named(run, "task"),
    "task": lambda run: _named(run, "task"),
    "ship": lambda run: _named(run, "ship"),
    "controller": lambda run: _named(run, "controller"),
    "seed": lambda run: None if _kind(run) == "manoeuvre" else run.meta.get("seed"),
    "outcome": lambda run: _named(run, "outcome"),
    "failed": lambda run: _truth(run, "failed"),
    "duration": lambda run: run.duration,
    "state": _state,
}
NUMBERS = ("seed", "duration")  # columns that are numbers; the others are text


def recordings(places: Iterable[str | os.PathLike]) -> list[Path]:
    """Files of `SUFFIXES` in folders and their subfolders, by name; a file stands for itself.

    Parameters
    ----------
    places : iterable of path-like
        Folders and files.

    Raises
    ------
    ConfigError
        One of the places does not exist.
    """
    found: list[Path] = []
    for place in map(Path, places):
        if place.is_dir():
            inside = (p for p in place.rglob("*") if p.name.lower().endswith(SUFFIXES))
            # a hidden one is being written
            found += sorted(p for p in inside if p.is_file() and not p.name.startswith("."))
        elif place.exists():
            found.append(place)
        else:
            raise ConfigError(f"{place}: no such file or folder")
    return list(dict.fromkeys(found))


def read(path: str | os.PathLike) -> Run:
    """What a file says of its run, all of it verified; a bad file is a Run with `error`.

    A comparison of recordings is a Run, too, without a duration.

    Raises
    ------
    ImportError
        If rerun-sdk is not installed.
    """
    path = Path(path)
    try:
        trajectory = Trajectory.from_file(path)
    except (ValueError, OSError) as error:
        if is_comparison(path):
            return Run(path, {"kind": "comparison"}, complete=True)
        text = " ".join(str(error).split()).removeprefix(str(path)).lstrip(": ")
        return Run(path, error=text or type(error).__name__)
    t = trajectory["t"]
    return Run(path, trajectory.meta, float(t[-1] - t[0]), trajectory.complete)


def is_comparison(path: str | os.PathLike) -> bool:
    """Whether a file is a whole one that `write_comparison` wrote."""
    from ship_gym.recording.rerun_export.compare import read_comparison

    try:
        read_comparison(path)
    except (ValueError, OSError):
        return False
    return True


def metric_names(runs: Sequence[Run]) -> list[str]:
    """Names of all metrics that a run has, each once."""
    return list(dict.fromkeys(name for run in runs for name in run.metrics))
