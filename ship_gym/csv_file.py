"""CSV files that name their source, as printed data and as spreadsheets write them.

What a file may look like:

- in UTF-8, with or without a byte order mark, UTF-16 with one, or cp1252 (Windows);
- columns apart by commas, semicolons or tabs, which the row of column names shows;
- decimal points, or decimal commas where the columns are not apart by commas or the cell is quoted;
- cells in double quotes, blank lines, empty rows, empty columns without a name, and Excel's line
  ``sep=;``.

A number has no thousands separator. One file has one decimal mark.
"""

from __future__ import annotations

import csv
import dataclasses
import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.config import UNITS, ConfigError, check_number, nearest, shown
from ship_gym.reading import read_text

_HEADER_KEYS = ("title", "source", "obtained", "conventions")
_SEPARATORS = ";,\t"
_EXCEL = re.compile(r'"?sep=(.)"?', re.IGNORECASE)
_TITLE = re.compile(r"(.*?)\s*\[(.*)\]")
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(,\d{3})+")  # 1,234: a thousand or a decimal
_Row = tuple[int, list[str]]  # line in the file, cells


@dataclasses.dataclass(frozen=True)
class CsvTable:
    """A CSV file with its source header.

    Attributes
    ----------
    path : str
        File name, for messages.
    header : dict
        The ``# key: text`` lines; always has title, source, obtained, conventions.
    columns : dict
        Name to values: float arrays for columns with a unit, string arrays for the others.
    units : dict
        Name to unit text for the columns with a unit.
    rows : numpy.ndarray
        Line number in the file of each data row, for messages.
    title_row : int
        Line number of the column names.
    decimal : str
        Decimal mark of the numbers, ``"."`` or ``","``.
    """

    path: str
    header: dict[str, str]
    columns: dict[str, np.ndarray]
    units: dict[str, str]
    rows: np.ndarray
    title_row: int
    decimal: str = "."

    def require(self, *names: str) -> CsvTable:
        """Return self if all columns exist, else raise ConfigError that lists what is there."""
        for name in names:
            if name not in self.columns:
                raise ConfigError(
                    f"{self.path}: no column {shown(name)};{nearest(name, self.columns)}"
                )
        return self

    def si(self, name: str, base: str = "") -> np.ndarray:
        """Values of a numeric column in SI (degrees become radians).

        With `base`, such as ``"rad"``, units that are not of that quantity are refused.
        """
        self.require(name)
        if name not in self.units:
            raise ConfigError(
                f"{self.path}:{self.title_row}: column {name!r} has no unit, as in '{name} [-]'"
            )
        unit = self.units[name]
        if unit not in UNITS:
            raise ConfigError(f"{self.path}: column {shown(name)} has unknown unit [{unit}]")
        if base and UNITS[unit][1] != base:
            allowed = " or ".join(f"[{one}]" for one, (_, si) in UNITS.items() if si == base)
            raise ConfigError(
                f"{self.path}:{self.title_row}: column {shown(name)} has unit [{unit}]; allowed "
                f"is {allowed}"
            )
        return self.columns[name] * UNITS[unit][0]

    def where(self, **conditions: Any) -> CsvTable:
        """Rows in which every named column equals its value."""
        self.require(*conditions)
        mask = np.ones(len(self.rows), dtype=bool)
        for name, value in conditions.items():
            mask &= self.columns[name] == value
        return self.select(mask)

    def select(self, mask: np.ndarray) -> CsvTable:
        """Rows picked by a boolean mask or an index array."""
        columns = {name: values[mask] for name, values in self.columns.items()}
        return dataclasses.replace(self, columns=columns, rows=self.rows[mask])

    def number(self, key: str) -> float:
        """Number of a header line ``# key: number``, written as the numbers of the columns."""
        text = self.header[key]
        try:
            value = float(text.replace(",", ".") if self.decimal == "," else text)
        except ValueError:
            raise ConfigError(f"{self.path}: # {key}: {shown(text)} is not a number") from None
        return check_number(f"{self.path}: # {key}", value)


def read_csv(path: str | Path) -> CsvTable:
    """Read a CSV file that names its source, in any form that the top of this module lists.

    The file starts with ``# title:``, ``# source:``, ``# obtained:`` and ``# conventions:`` lines,
    then one row of column names, each with its unit in brackets (``beta [deg]``); a column without
    a unit holds text.

    Raises
    ------
    ConfigError
        Missing header line, column row or cell, or a number that is none, with its row number.
    """
    text = read_text(path, fallback="cp1252")
    lines = [(n, line) for n, line in enumerate(text.split("\n"), start=1) if line.strip()]
    told = _EXCEL.fullmatch(lines[0][1].strip(" ")) if lines else None
    lines = lines[1:] if told else lines
    remarks = [line for _, line in lines if _is_remark(line)]
    body = [(n, line) for n, line in lines if not _is_remark(line)]
    separator = told[1] if told else _separator([line for _, line in body])
    header = _read_header(path, [_remark(line, separator) for line in remarks])
    table = [row for row in _rows(path, body, separator) if any(row[1])]
    if len(table) < 2:
        raise ConfigError(f"{path}: needs a row of column names with units and at least one row")
    (line, titles), data = table[0], table[1:]
    named = _named_columns(path, titles, data, separator)
    columns, units = {}, {}
    for i in named:
        name, unit = _name_and_unit(titles[i])
        if name in columns:
            raise ConfigError(f"{path}:{line}: column {shown(name)} is there twice")
        columns[name] = [(number, row[i]) for number, row in data]
        if unit:
            units[name] = unit
    if not units:
        raise ConfigError(f"{path}: no column has a unit in brackets, as in 'beta [deg]'")
    decimal = _decimal(path, {name: columns[name] for name in units}, separator)
    arrays = {
        name: np.array(
            [number_of(path, name, *cell, decimal) for cell in cells]
            if name in units
            else [cell for _, cell in cells]
        )
        for name, cells in columns.items()
    }
    rows = np.array([number for number, _ in data])
    return CsvTable(str(path), header, arrays, units, rows, line, decimal)


def _is_remark(line: str) -> bool:
    return line.lstrip(' "').startswith("#")


def _remark(line: str, separator: str) -> str:
    """Text of a line of the header; spreadsheets quote it and fill it up with empty cells."""
    if line.lstrip().startswith('"'):
        line = separator.join(next(csv.reader([line.strip()], delimiter=separator)))
    return line.strip().rstrip(_SEPARATORS).strip()


def _read_header(path: str | Path, remarks: list[str]) -> dict[str, str]:
    header = {}
    for line in remarks:
        key, _, text = line.lstrip("# ").partition(":")
        header[key.strip().lower()] = text.strip()
    for key in _HEADER_KEYS:
        if not header.get(key):
            needed = ", ".join(f"'# {name}: ...'" for name in _HEADER_KEYS)
            raise ConfigError(f"{path}: no line '# {key}: ...'; a data file starts with {needed}")
    return header


def _separator(lines: list[str]) -> str:
    """What is most often between the column names, outside quotes."""
    titles = ""
    for line in lines:  # a quoted name may hold a line end
        titles += line
        if titles.count('"') % 2 == 0:
            break
    bare = re.sub(r'"[^"]*"?', "", titles)
    return max(_SEPARATORS, key=bare.count) if any(map(bare.count, _SEPARATORS)) else ","


def _rows(path: str | Path, lines: list[tuple[int, str]], separator: str) -> Iterator[_Row]:
    """Rows of stripped cells with the line on which each begins; a quoted cell may hold line ends.

    Titles and text with a line end inside get a blank there.
    """
    at = [0]  # lines read so far

    def feed() -> Iterator[str]:
        for _, line in lines:
            at[0] += 1
            yield line + "\n"

    reader = csv.reader(feed(), delimiter=separator, skipinitialspace=True, strict=True)
    first = 0
    try:
        for cells in reader:
            yield lines[first][0], [" ".join(cell.split()) for cell in cells]
            first = at[0]
    except csv.Error as error:
        where = f"{path}:{lines[first][0]}"
        raise ConfigError(f"{where}: quotes that do not enclose a cell: {error}") from None


def _named_columns(
    path: str | Path, titles: list[str], data: list[_Row], separator: str
) -> list[int]:
    """Places of the columns with a name, after every row is made as wide as the last of them.

    Empty cells at the end of a row that no name belongs to are dropped. In a file with commas
    between the columns only where all rows have as many, lest a decimal comma is taken for one.
    """
    named = [i for i, title in enumerate(titles) if title]
    width = named[-1] + 1
    even = separator != "," or len({len(cells) for _, cells in data}) == 1
    for number, cells in data:
        while (even or len(cells) <= len(titles)) and len(cells) > width and not cells[-1]:
            cells.pop()
        if not width <= len(cells) <= len(titles):
            hint = ""
            if separator == "," and len(cells) > width:
                hint = (
                    "; if these are decimal commas, put semicolons between the columns or write "
                    "decimal points"
                )
            raise ConfigError(f"{path}:{number}: {len(cells)} cells, but {width} columns{hint}")
        if nameless := [i for i, cell in enumerate(cells) if cell and i not in named]:
            cell, column = shown(cells[nameless[0]]), nameless[0] + 1
            raise ConfigError(f"{path}:{number}: {cell} is in column {column}, which has no name")
    return named


def _name_and_unit(title: str) -> tuple[str, str]:
    found = _TITLE.fullmatch(title)
    return (found[1], found[2]) if found else (title, "")


def _decimal(path: str | Path, columns: dict[str, list[tuple[int, str]]], separator: str) -> str:
    """Decimal mark of the numbers; a file whose marks are not clear is refused."""
    cells = sorted((n, name, cell) for name, column in columns.items() for n, cell in column)
    commas = [cell for cell in cells if "," in cell[2]]
    points = [cell for cell in cells if "." in cell[2]]
    if commas and points:
        (n, name, comma), (other, _, point) = commas[0], points[0]
        raise ConfigError(
            f"{path}:{n}: {name} = {shown(comma)}, but {shown(point)} in line {other}: allowed is "
            "one decimal mark in a file, and no thousands separator"
        )
    if commas and separator == "," and all(_THOUSANDS.fullmatch(cell) for _, _, cell in commas):
        n, name, cell = commas[0]
        raise ConfigError(
            f"{path}:{n}: {name} = {shown(cell)}: a thousands separator or a decimal comma? Write "
            f"{cell.replace(',', '')} or {cell.replace(',', '.', 1)}"
        )
    return "," if commas else "."


def number_of(path: str | Path, name: str, row: int, cell: str, decimal: str = ".") -> float:
    """The finite number of a cell, else a ConfigError with its line."""
    plain = cell.replace(decimal, ".").replace("\N{MINUS SIGN}", "-")
    try:
        value = float(plain.replace("_", "?"))  # Python's own 1_000 is no number here
    except ValueError:
        raise ConfigError(f"{path}:{row}: {name} = {shown(cell)} is not a number") from None
    if not math.isfinite(value):
        raise ConfigError(f"{path}:{row}: {name} = {shown(value)} is not finite")
    return check_number(f"{path}:{row}: {name}", value, tiny=True)
