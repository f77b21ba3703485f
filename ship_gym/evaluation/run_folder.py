"""Folder of a benchmark: its settings, a lock, and the rows of every unit that is finished.

A unit's file appears whole or not at all, so that a run can be killed at any time and continued.
"""

from __future__ import annotations

import contextlib
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError
from ship_gym.evaluation.episodes_table import check_row, finite
from ship_gym.evaluation.unit import Sailed
from ship_gym.keys import read_keys
from ship_gym.locks import check_own, locked
from ship_gym.writing import atomic_path, sweep

EPISODES = "episodes.parquet"
REPORT = "report.html"
RECORDINGS = "episodes"  # folder of recorded episodes
_SETTINGS, _LOCK, _UNITS = "settings.json", ".lock", "units"


class RunFolder:
    """Where a benchmark keeps what it has.

    Parameters
    ----------
    path : path-like
    """

    def __init__(self, path: str | os.PathLike):
        self.path = Path(path)
        self._units = self.path / _UNITS

    @property
    def episodes(self) -> Path:
        """The table of all episodes."""
        return self.path / EPISODES

    @contextlib.contextmanager
    def locked(self) -> Iterator[None]:
        """Hold the folder; refused while another process does. Killing that one frees it.

        What killed ones left half is removed.
        """
        check_own(self.path, [EPISODES, REPORT, _SETTINGS, _UNITS, RECORDINGS])
        check_own(self.path, (f"{_UNITS}/{path.name}" for path in self._units.glob("*")))
        with locked(self.path / _LOCK, "benchmarks into this folder"):
            for folder in (self.path, self._units, self.path / RECORDINGS):
                sweep(folder)
            yield

    def settings(self) -> dict[str, Any] | None:
        """Settings of the run in the folder; None if there is none.

        Raises
        ------
        ConfigError
            Settings that cannot be read.
        """
        file = self.path / _SETTINGS
        if not file.is_file():
            return None
        try:
            return dict(read_keys(file).values)
        except ConfigError as error:
            raise ConfigError(f"{error}; begin anew with --fresh") from None

    def begin(self, settings: Mapping[str, Any], fresh: bool) -> None:
        """Begin a run, or continue the one in the folder if it has these settings.

        Parameters
        ----------
        settings : mapping
            Plain values: all that decides the rows.
        fresh : bool
            Remove what is there and begin anew.

        Raises
        ------
        ConfigError
            A run with other settings is there; says the first that differs.
        """
        wanted = json.loads(json.dumps(settings))
        if fresh:
            self._clear()
        elif (kept := self.settings()) is not None:
            self._check_same(kept, wanted)
        self._units.mkdir(exist_ok=True)
        with atomic_path(self.path / _SETTINGS) as temporary:
            temporary.write_text(json.dumps(wanted, indent=1) + "\n", encoding="utf-8")

    def _check_same(self, kept: Mapping[str, Any], wanted: Mapping[str, Any]) -> None:
        for key in {**kept, **wanted}:
            there, asked = kept.get(key), wanted.get(key)
            if there != asked:
                raise ConfigError(
                    f"{self.path} holds a run with other {key}: {_differing(there, asked)}; give "
                    "another --out, or begin anew with --fresh"
                )

    def _clear(self) -> None:
        """Remove the files of a run, and nothing else."""
        kept = (*self._units.glob("*.json"), *(self.path / RECORDINGS).glob("*.rrd*"))
        for file in (*kept, self.path / _SETTINGS, self.episodes):
            file.unlink(missing_ok=True)

    def keep(self, number: int, sailed: Sailed) -> None:
        """Keep the rows of a finished unit."""
        with atomic_path(self._file(number)) as temporary:
            rows = [{key: finite(value) for key, value in row.items()} for row in sailed.rows]
            kept = {"seconds": sailed.seconds, "rows": rows}
            temporary.write_text(json.dumps(kept), encoding="utf-8")

    def kept(self, number: int, seeds: Sequence[int]) -> Sailed | None:
        """Rows of a unit of these seeds; None if it is not finished, or its file is damaged."""
        try:
            found = read_keys(self._file(number))
            rows = [check_row(row, found.where) for row in found.items("rows")]
            whole = [row.get("seed") for row in rows] == [*seeds]
            return Sailed(rows, found.number("seconds", 0.0)) if whole else None
        except ConfigError:
            return None

    def _file(self, number: int) -> Path:
        return self._units / f"{number:05d}.json"


def _differing(there: Any, asked: Any) -> str:
    """Two values, of two mappings the first entries that differ, in few words."""
    if isinstance(there, dict) and isinstance(asked, dict):
        key = next(key for key in {**there, **asked} if there.get(key) != asked.get(key))
        return f"{key}: {_differing(there.get(key), asked.get(key))}"
    return f"{_short(there)} there, {_short(asked)} asked for"


def _short(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
