"""Where recordings go: a file for one, a folder or the stem of a file for several."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
from click.shell_completion import CompletionItem

from ship_gym_agents.cli.values import OutFile, OutFolder

FORMATS = (".rrd", ".csv")  # those of ship_gym.evaluation.recordings
ONE, MANY = "runs/rollout.rrd", "runs/recordings"


class OutRecordings(click.ParamType):
    """A .rrd or .csv file, or a folder; checked before any work."""

    name = "file or folder"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        """The path of a text."""
        path, option = Path(value), param.opts[0] if param else "file"
        if path.is_dir() or path.suffix == "":
            return OutFolder().convert(value, param, ctx)
        if path.suffix.lower() not in FORMATS:
            raise click.UsageError(
                f"{option} {path}: allowed is a {' or '.join(FORMATS)} file, or a folder", ctx
            )
        return OutFile(path.suffix.lower()).convert(value, param, ctx)

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        """How the help shows it."""
        return f"FILE{'|'.join(FORMATS)}|FOLDER"

    def shell_complete(self, ctx, param, incomplete: str) -> list[CompletionItem]:
        """Files of the shell."""
        return [CompletionItem(incomplete, type="file")]


class Places:
    """Files of recordings.

    Parameters
    ----------
    out : path, optional
        Of `OutRecordings`; default: `ONE` for one, `MANY` for several.
    several : bool
        Whether there can be more than one: their names then say controller and seed.

    Raises
    ------
    ConfigError
        Nothing can be written at the default; `OutRecordings` has tried the other places.
    """

    def __init__(self, out: Path | None, several: bool):
        from ship_gym.writing import check_place

        if out is None:
            out = check_place(MANY if several else ONE, "--out", folder=several)
        self._out = out
        self.many = several or self._is_folder
        self.folder = self._out if self._is_folder else self._out.parent
        self.suffix = FORMATS[0] if self._is_folder else self._out.suffix.lower()

    @property
    def _is_folder(self) -> bool:
        return self._out.is_dir() or self._out.suffix == ""

    def of(self, controller: str, seed: int) -> Path:
        """The file of an episode."""
        from ship_gym.evaluation.recordings import file_name

        if self._is_folder:
            return self._out / file_name(controller, seed, self.suffix)
        if not self.many:
            return self._out
        return self._out.with_name(f"{self._out.stem}-{file_name(controller, seed, self.suffix)}")
