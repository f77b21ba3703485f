"""Strict loaders: TOML to frozen dataclasses in SI, and CSV files that name their source.

A wrong file is refused before any work starts, with the file, the field, the value and what is
allowed. Unknown keys name the nearest known one.
"""

from __future__ import annotations

import dataclasses
import difflib
import math
import tomllib
import types
import typing
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.conventions import KNOT


class ConfigError(ValueError):
    """A file, a key or a value that cannot be used; the message says which and what is allowed."""


# Factor from a printed unit to SI, and the SI unit it becomes. "L" is the ship's own length.
UNITS: dict[str, tuple[float, str]] = {
    "-": (1.0, "-"),
    "m": (1.0, "m"),
    "m2": (1.0, "m2"),
    "m3": (1.0, "m3"),
    "s": (1.0, "s"),
    "m/s": (1.0, "m/s"),
    "kn": (KNOT, "m/s"),
    "rad": (1.0, "rad"),
    "deg": (math.pi / 180.0, "rad"),
    "rad/s": (1.0, "rad/s"),
    "deg/s": (math.pi / 180.0, "rad/s"),
    "rev/s": (1.0, "rev/s"),
    "rpm": (1.0 / 60.0, "rev/s"),
    "rev/s2": (1.0, "rev/s2"),
    "kg/m3": (1.0, "kg/m3"),
    "m2/s": (1.0, "m2/s"),
    "N": (1.0, "N"),
    "N m": (1.0, "N m"),
}


def nearest(name: str, known: Iterable[str]) -> str:
    """Text ``did you mean 'x'? Known: ...`` for an unknown name."""
    known = sorted(str(k) for k in known)
    close = difflib.get_close_matches(name, known, n=1, cutoff=0.4)
    guess = f" did you mean {close[0]!r}?" if close else ""
    return f"{guess} Known: {', '.join(known)}"


def check_known(kind: str, name: str, known: Iterable[str]) -> str:
    """Return `name` if it is known, else raise ConfigError that names the nearest one."""
    known = list(known)
    if name not in known:
        raise ConfigError(f"unknown {kind} {name!r};{nearest(str(name), known)}")
    return name


def check_angle(field: str, value: float, limit: float = 2.0 * math.pi) -> float:
    """Return an angle [rad] if it is finite and within `limit` [rad], else raise ConfigError."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.number):
        raise ConfigError(f"{field} = {value!r}: must be an angle in rad")
    value = float(value)
    if not math.isfinite(value):
        raise ConfigError(f"{field} = {value}: must be a finite angle in rad")
    if abs(value) > limit * (1.0 + 1e-12):
        hint = f"; looks like degrees, use {math.radians(value):.4g} rad"
        hint = hint if abs(value) > 2.0 * math.pi or abs(math.radians(value)) <= limit else ""
        raise ConfigError(f"{field} = {value} rad: allowed is |{field}| <= {limit:.4g} rad{hint}")
    return value


def check_number(
    field: str, value: float, low: float = -math.inf, high: float = math.inf, unit: str = "-"
) -> float:
    """Return a finite number within [low, high], else raise ConfigError that says so."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.number):
        raise ConfigError(f"{field} = {value!r}: must be a number [{unit}]")
    if not math.isfinite(value) and low == -math.inf and high == math.inf:
        raise ConfigError(f"{field} = {value}: must be finite [{unit}]")
    if not (math.isfinite(value) and low <= value <= high):
        raise ConfigError(f"{field} = {value}: allowed is {low:g} to {high:g} [{unit}]")
    return float(value)


def check_fields(section: str, item: object, ranges: dict[str, tuple[float, float, str]]) -> None:
    """Refuse a field of a dataclass outside its range (low, high, unit); None is passed over.

    A field may be an array: each of its numbers is checked.
    """
    for name, (low, high, unit) in ranges.items():
        value = getattr(item, name)
        for number in value.ravel().tolist() if isinstance(value, np.ndarray) else [value]:
            if number is not None:
                check_number(f"{section}.{name}", number, low, high, unit)


def read_toml(path: str | Path) -> dict[str, Any]:
    """Read a TOML file; a missing or malformed file is a ConfigError with its path."""
    path = Path(path)
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise ConfigError(f"{path}: no such file") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: not a valid TOML file: {error}") from None


def build(cls: type, values: Mapping[str, Any], where: str) -> Any:
    """Make a frozen dataclass from a mapping, strictly.

    Parameters
    ----------
    cls : type
        Dataclass whose annotations are float, int, bool, str, tuples of these, nested dataclasses
        or ``X | None``.
    values : mapping
        Keys must be fields of `cls`; nested mappings for nested dataclasses.
    where : str
        File and section, for the error message.

    Raises
    ------
    ConfigError
        Unknown key (with the nearest one), missing key, or a value of the wrong type.
    """
    hints = typing.get_type_hints(cls)
    fields = {f.name: f for f in dataclasses.fields(cls) if f.init}
    for key in values:
        if key not in fields:
            raise ConfigError(f"{where}: unknown key {key!r};{nearest(key, fields)}")
    made = {}
    for name, field in fields.items():
        if name in values:
            made[name] = _convert(hints[name], values[name], f"{where}.{name}")
        elif field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING:
            raise ConfigError(f"{where}: missing key {name!r}")
    return cls(**made)


def _convert(kind: Any, value: Any, where: str) -> Any:
    """Convert one TOML value to the annotated type, or raise ConfigError."""
    if typing.get_origin(kind) in (typing.Union, types.UnionType):
        if value is None:
            return None
        kind = next(k for k in typing.get_args(kind) if k is not type(None))
    if dataclasses.is_dataclass(kind):
        if dataclasses.is_dataclass(value):
            return value
        if not isinstance(value, Mapping):
            raise ConfigError(f"{where} = {value!r}: must be a table of keys")
        return build(kind, value, where)
    if typing.get_origin(kind) is tuple:
        if not isinstance(value, list | tuple | np.ndarray):
            raise ConfigError(f"{where} = {value!r}: must be a list")
        return tuple(_convert(typing.get_args(kind)[0], item, where) for item in value)
    if typing.get_origin(kind) is dict:
        kind = dict
    if kind is float:
        return check_number(where, value)
    if not isinstance(value, kind) or (kind is int and isinstance(value, bool)):
        raise ConfigError(f"{where} = {value!r}: must be of type {kind.__name__}")
    return value


def merged(base: Mapping[str, Any], overrides: Mapping[str, Any]) -> dict[str, Any]:
    """Nested mapping `base` with the keys of `overrides` replaced; unknown keys are kept.

    They are refused afterwards by `build`, which knows the allowed names.
    """
    result = dict(base)
    for key, value in overrides.items():
        old = result.get(key)
        nested = isinstance(value, Mapping) and isinstance(old, Mapping)
        result[key] = merged(old, value) if nested else value
    return result


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
    """

    path: str
    header: dict[str, str]
    columns: dict[str, np.ndarray]
    units: dict[str, str]
    rows: np.ndarray

    def require(self, *names: str) -> CsvTable:
        """Return self if all columns exist, else raise ConfigError that lists what is there."""
        for name in names:
            if name not in self.columns:
                raise ConfigError(f"{self.path}: no column {name!r};{nearest(name, self.columns)}")
        return self

    def si(self, name: str) -> np.ndarray:
        """Values of a numeric column in SI (degrees become radians)."""
        self.require(name)
        unit = self.units.get(name, "-")
        if unit not in UNITS:
            raise ConfigError(f"{self.path}: column {name!r} has unknown unit [{unit}]")
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


_HEADER_KEYS = ("title", "source", "obtained", "conventions")


def read_csv(path: str | Path) -> CsvTable:
    """Read a CSV file that names its source.

    The file starts with ``# title:``, ``# source:``, ``# obtained:`` and ``# conventions:`` lines,
    then one row of column names, each with its unit in brackets (``beta [deg]``); a column without
    a unit holds text.

    Raises
    ------
    ConfigError
        Missing header line, column row or cell, or a number that is none, with its row number.
    """
    path = Path(path)
    if not path.is_file():
        raise ConfigError(f"{path}: no such file")
    lines = [
        (number, line.strip())
        for number, line in enumerate(path.read_text(encoding="utf-8-sig").splitlines(), start=1)
        if line.strip()
    ]
    header = _read_header(path, [line for _, line in lines if line.startswith("#")])
    body = [(number, line.split(",")) for number, line in lines if not line.startswith("#")]
    if len(body) < 2:
        raise ConfigError(f"{path}: needs a row of column names with units and at least one row")
    (line, titles), data = body[0], body[1:]
    names = [title.strip().partition(" [")[0] for title in titles]
    if double := sorted({name for name in names if names.count(name) > 1}):
        raise ConfigError(f"{path}:{line}: column {double[0]!r} is there twice")
    for number, cells in data:
        if len(cells) != len(titles):
            raise ConfigError(f"{path}:{number}: {len(cells)} cells, but {len(titles)} columns")
    columns, units = {}, {}
    for i, title in enumerate(titles):
        name, _, unit = title.strip().partition(" [")
        cells = [(number, row[i].strip()) for number, row in data]
        if unit:
            units[name] = unit.rstrip("]")
            columns[name] = np.array([_number(path, name, n, cell) for n, cell in cells])
        else:
            columns[name] = np.array([cell for _, cell in cells])
    if not units:
        raise ConfigError(f"{path}: no column has a unit in brackets, as in 'beta [deg]'")
    return CsvTable(str(path), header, columns, units, np.array([number for number, _ in data]))


def _read_header(path: Path, lines: list[str]) -> dict[str, str]:
    header = {}
    for line in lines:
        key, _, text = line.lstrip("# ").partition(":")
        header[key.strip().lower()] = text.strip()
    for key in _HEADER_KEYS:
        if not header.get(key):
            needed = ", ".join(f"'# {name}: ...'" for name in _HEADER_KEYS)
            raise ConfigError(f"{path}: no line '# {key}: ...'; a data file starts with {needed}")
    return header


def _number(path: Path, name: str, row: int, cell: str) -> float:
    try:
        value = float(cell)
    except ValueError:
        raise ConfigError(f"{path}:{row}: {name} = {cell!r} is not a number") from None
    if not math.isfinite(value):
        raise ConfigError(f"{path}:{row}: {name} = {cell} is not finite")
    return value
