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


def files(**how: Any):
    """Argument FILE..., recordings and journals."""
    given: dict[str, Any] = {"nargs": -1, "required": True, "metavar": "FILE..."} | how
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


def viewable(path: Path) -> Trajectory | None:
    """The run in a file, or None of a comparison of recordings; both verified."""
    from ship_gym.config import ConfigError
    from ship_gym.recording.library import is_comparison

    try:
        return recorded(path)
    except ConfigError:
        if is_comparison(path):
            return None
        raise


@contextlib.contextmanager
def drawn(paths: Sequence[Path], runs: Sequence[Trajectory | None]) -> Iterator[list[Path]]:
    """Files that a viewer opens.

    A journal, a file that was cut and a record without a picture are drawn into a temporary one.
    """
    from ship_gym.recording.sealed import verify

    with tempfile.TemporaryDirectory(prefix="ship-gym-") as folder:
        found = []
        for number, (path, run) in enumerate(zip(paths, runs, strict=True)):
            if run is not None and not (run.complete and verify(path).has_picture):
                path = Path(folder) / f"{number}-{path.name.removesuffix('.partial')}"
                run.to_rrd(path)
            found.append(path)
        yield found


def next_review(verb: str, *words: Any) -> str:
    """A ``ship-gym review`` command to go on with, to be copied."""
    return " ".join(["ship-gym review", verb, *(shlex.quote(str(word)) for word in words)])
