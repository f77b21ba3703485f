"""CSV files of a row of names and rows of cells, commas between them: curves, measured histories.

Data files that name their source are read by ``csv_file``.
"""

from __future__ import annotations

import csv
import dataclasses
from pathlib import Path

import numpy as np

from ship_gym.config import ConfigError, nearest, shown
from ship_gym.csv_file import number_of
from ship_gym.reading import read_text


@dataclasses.dataclass(frozen=True)
class PlainCsv:
    """Cells of a file.

    Attributes
    ----------
    path : str
        File name, for messages.
    columns : dict
        Name to cells.
    lines : list of int
        Line in the file of each row.
    """

    path: str
    columns: dict[str, list[str]]
    lines: list[int]

    def numbers(self, name: str) -> np.ndarray:
        """Numbers of a column, finite.

        Raises
        ------
        ConfigError
            No such column, or a cell that is no number; with its line.
        """
        cells = zip(self.lines, self._cells(name), strict=True)
        return np.array([number_of(self.path, name, line, cell) for line, cell in cells])

    def maybe_numbers(self, name: str) -> list[float | None]:
        """Numbers of a column, None for an empty cell."""
        cells = zip(self.lines, self._cells(name), strict=True)
        return [number_of(self.path, name, k, cell) if cell else None for k, cell in cells]

    def _cells(self, name: str) -> list[str]:
        if name not in self.columns:
            raise ConfigError(f"{self.path}: no column {name!r};{nearest(name, self.columns)}")
        return self.columns[name]


def read_plain_csv(path: str | Path, least: int = 1) -> PlainCsv:
    """Read a file; empty lines and those that begin with ``#`` are passed over.

    Parameters
    ----------
    path : path-like
    least : int
        Rows that there must be.

    Raises
    ------
    ConfigError
        Too few rows, a name that is there twice or a row with more or fewer cells; with its line.
    """
    lines = enumerate(read_text(path).split("\n"), start=1)
    kept = [(k, line) for k, line in lines if line.strip() and line[0] != "#"]
    try:
        rows = list(csv.reader((line for _, line in kept), strict=True))
    except csv.Error as error:
        raise ConfigError(f"{path}: not a CSV file: {error}") from None
    if len(rows) != len(kept):
        raise ConfigError(f"{path}: a quoted cell goes over several lines")
    if len(rows) < 1 + least:
        raise ConfigError(f"{path}: needs a row of column names and at least {least} of numbers")
    names = [name.strip() for name in rows[0]]
    if len(names) == 1 and (mark := next((m for m in ";\t" if m in names[0]), "")):
        raise ConfigError(f"{path}:{kept[0][0]}: cells are parted by {mark!r}: allowed is ','")
    if double := [name for name in names if names.count(name) > 1]:
        raise ConfigError(f"{path}:{kept[0][0]}: column {shown(double[0])} is there twice")
    for (line, _), row in zip(kept, rows, strict=True):
        if len(row) != len(names):
            raise ConfigError(f"{path}:{line}: {len(row)} cells, but {len(names)} columns")
    columns = {name: [row[i].strip() for row in rows[1:]] for i, name in enumerate(names)}
    return PlainCsv(str(path), columns, [k for k, _ in kept[1:]])
