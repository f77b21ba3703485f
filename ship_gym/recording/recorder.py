"""Rows of one run on their way to a file, kept on disk while the run is on."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.locks import unfit
from ship_gym.recording.journal import Journal, journal_path
from ship_gym.recording.trajectory import Trajectory, import_rerun_export, plain
from ship_gym.writing import DiskFull

_SECONDS, _ROWS = 10.0, 16  # a chunk: rows of about this time, but at least so many


class Recorder:
    """Keeps the rows of a run in a journal beside the file, and writes the file at its end.

    A run that is killed leaves the journal ``PATH.partial`` with all rows but those of the last
    chunk; ``Trajectory.from_file`` reads it.

    Parameters
    ----------
    path : path-like
        File ``*.rrd`` to write; its folder is created if missing.
    meta : mapping
        What is known of the run before it begins, as in ``Trajectory``.
    names : sequence of str
        Of the columns that `add` takes; ``"t"`` is one of them.
    chunk : int, optional
        Rows of a chunk; default: those of about 10 s, at least 16.
    picture : bool
        Whether the file holds what the viewer shows, or only the record.

    Raises
    ------
    ConfigError
        A path that is no ``*.rrd``, names without ``t`` or twice, or another run that is recorded
        into this file.
    ImportError
        If rerun-sdk is not installed.
    OSError
        If nothing can be written there.
    """

    def __init__(
        self,
        path: str | os.PathLike,
        meta: Mapping[str, object],
        names: Sequence[str],
        *,
        chunk: int | None = None,
        picture: bool = True,
    ):
        self.path, self._picture = Path(path), picture
        self._chunk = chunk
        self._names = _checked_names(names)
        if self.path.suffix.lower() != ".rrd":
            raise ConfigError(f"path = {str(path)!r}: a recording is a file '*.rrd'")
        if what := unfit(self.path):
            raise ConfigError(f"path = {str(path)!r}: {what}")
        import_rerun_export()  # a missing one is said before the run begins
        self._time = self._names.index("t")
        self._rows = np.empty((_ROWS, len(self._names)))
        self._count, self._last = 0, -np.inf
        self._journal: Journal | None = Journal(
            journal_path(self.path), self._names, plain(dict(meta), "meta")
        )

    @property
    def journal(self) -> Path:
        """Where the rows are until the file is written."""
        return journal_path(self.path)

    def add(self, rows: np.ndarray) -> None:
        """Take rows, shape (k, C) or one of shape (C,); whole chunks go to disk.

        Raises
        ------
        ConfigError
            Rows of another shape, a value that is not finite, or a time that does not increase.
        OSError
            If they cannot be written, as on a full disk; what is in the journal stays readable.
        """
        rows = np.asarray(rows, dtype=np.float64)
        if rows.ndim == 1:
            rows = rows[None]
        self._check(rows)
        for row in rows:
            if self._count == len(self._rows):
                self._rows = np.concatenate([self._rows, np.empty_like(self._rows)])
            self._rows[self._count] = row
            self._count += 1
            if self._is_whole():
                self._flush()

    def finish(self, trajectory: Trajectory) -> None:
        """Write the file from the whole run and remove the journal.

        Raises
        ------
        OSError
            If it cannot be written; the journal stays, with every row.
        """
        if self._journal is None:
            raise ConfigError(f"{self.path}: this recording is over")
        try:
            self._flush()
            import_rerun_export().write_rrd(trajectory, self.path, picture=self._picture)
        except BaseException as error:
            with contextlib.suppress(OSError):
                self.keep()
            if isinstance(error, DiskFull) and self.journal.exists():
                text = f"{error}; its rows are in {self.journal}"
                raise DiskFull(error.errno, text) from error
            raise
        self.discard()

    def keep(self) -> None:
        """Leave the run as it is: the rows so far in the journal, which stays."""
        if self._journal is not None:
            try:
                self._flush()
            finally:
                journal, self._journal = self._journal, None
                if journal is not None:
                    journal.close()

    def discard(self) -> None:
        """Remove the journal; no file is written."""
        journal, self._journal = self._journal, None
        if journal is not None:
            journal.remove()

    def __enter__(self) -> Recorder:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Keep the rows of a run that was not finished; its own error goes before a disk's."""
        with contextlib.suppress(*([OSError] if error is not None else [])):
            self.keep()

    def _check(self, rows: np.ndarray) -> None:
        if self._journal is None:
            raise ConfigError(f"{self.path}: this recording is over")
        if rows.ndim != 2 or rows.shape[1] != len(self._names):
            raise ConfigError(f"rows have shape {rows.shape}, not (k, {len(self._names)})")
        if not np.isfinite(rows).all():
            row, column = np.argwhere(~np.isfinite(rows))[0]
            name = self._names[column]
            raise ConfigError(f"{name} = {rows[row, column]} in a row of {self.path.name}")
        times = rows[:, self._time]
        for now in times.tolist():
            if now <= self._last:
                raise ConfigError(
                    f"{self.path.name}: 't' does not increase: {self._last} then {now}"
                )
            self._last = now

    def _is_whole(self) -> bool:
        """Whether the rows that are held make a chunk."""
        if self._chunk is not None:
            return self._count >= self._chunk
        if self._count < _ROWS:
            return False
        times = self._rows[: self._count, self._time]
        steps = self._count / (self._count - 1)  # a row stands for the time up to the next
        return (times[-1] - times[0]) * steps >= _SECONDS

    def _flush(self) -> None:
        if self._count and self._journal is not None:
            count, self._count = self._count, 0
            self._journal.append(self._rows[:count])


def _checked_names(names: Sequence[str]) -> list[str]:
    names = list(names)
    if "t" not in names or len(set(names)) < len(names):
        raise ConfigError(f"names = {names}: 't' must be among them, and none twice")
    return names
