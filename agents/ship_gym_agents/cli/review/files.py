"""Recordings as the verbs of ``review`` take them: verified, with errors that name the file."""

from __future__ import annotations

import contextlib
import shlex
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from ship_gym.recording import Trajectory

_JOURNAL = ".partial"


def files(**how: Any):
    """Argument FILE..., recordings and journals."""
    given = {"nargs": -1, "required": True, "metavar": "FILE..."} | how
    return click.argument("files", type=click.Path(path_type=Path), **given)


def recorded(path: Path) -> Trajectory:
    """The run in a file, verified; an error names the file."""
    from ship_gym.config import ConfigError
    from ship_gym.recording import Trajectory

    try:
        return Trajectory.from_file(path)
    except ValueError as error:
        text = str(error)
        raise ConfigError(text if str(path) in text else f"{path}: {text}") from None


@contextlib.contextmanager
def drawn(paths: Sequence[Path], runs: Sequence[Trajectory]) -> Iterator[list[Path]]:
    """Files that a viewer opens; a journal is drawn into a temporary one."""
    with tempfile.TemporaryDirectory(prefix="ship-gym-") as folder:
        found = []
        for number, (path, run) in enumerate(zip(paths, runs, strict=True)):
            if path.suffix == _JOURNAL:
                path = Path(folder) / f"{number}-{path.name.removesuffix(_JOURNAL)}"
                run.to_rrd(path)
            found.append(path)
        yield found


def labels(runs: Sequence[Trajectory], paths: Sequence[Path]) -> list[str]:
    """A short name for each run: the controller, else the name of the file, else its path."""
    candidates = (
        [str(run.meta.get("controller", "")) for run in runs],
        [path.name.partition(".")[0] for path in paths],
        [str(path) for path in paths],
    )
    return next(
        (names for names in candidates if all(names) and len(set(names)) == len(names)),
        candidates[-1],
    )


def next_review(verb: str, *words: Any) -> str:
    """A ``ship-gym review`` command to go on with, to be copied."""
    return " ".join(["ship-gym review", verb, *(shlex.quote(str(word)) for word in words)])
