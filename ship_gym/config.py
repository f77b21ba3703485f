"""Strict loaders: text files of any encoding, and TOML to frozen dataclasses in SI.

A wrong file is refused before any work starts, with the file, the field, the value and what is
allowed. Unknown keys name the nearest known one.
"""

from __future__ import annotations

import codecs
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
    "kg m2": (1.0, "kg m2"),
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


# Byte order marks; the longer ones first, since that of UTF-16 begins that of UTF-32.
_MARKS = {
    codecs.BOM_UTF8: "utf-8",
    codecs.BOM_UTF32_LE: "utf-32-le",
    codecs.BOM_UTF32_BE: "utf-32-be",
    codecs.BOM_UTF16_LE: "utf-16-le",
    codecs.BOM_UTF16_BE: "utf-16-be",
}
_WORKBOOKS = (b"PK\x03\x04", b"\xd0\xcf\x11\xe0")  # xlsx and ods; xls


def read_text(path: str | Path, fallback: str | None = None) -> str:
    r"""Text of a file, its lines ended by ``\n``; every reader of text goes through here.

    A byte order mark (UTF-8, UTF-16, UTF-32) is obeyed and left out; without one the file is in
    UTF-8.

    Parameters
    ----------
    path : path-like
    fallback : str, optional
        Encoding of a file that is not in UTF-8. Without it such a file is refused.

    Raises
    ------
    ConfigError
        No such file, one that cannot be read, or not a text file; the message says what to do.
    """
    path = Path(path)
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        raise ConfigError(f"{path}: no such file") from None
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {error.strerror}") from None
    text = _decoded(path, data, fallback)
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _decoded(path: Path, data: bytes, fallback: str | None) -> str:
    mark = next((mark for mark in _MARKS if data.startswith(mark)), b"")
    if not mark and data.startswith(_WORKBOOKS):
        raise ConfigError(f"{path}: a workbook, not a text file; save the sheet as 'CSV UTF-8'")
    if not mark and b"\0" in data:
        raise ConfigError(
            f"{path}: holds zero bytes: not a text file, or UTF-16 without a byte order mark; save "
            "it as UTF-8"
        )
    encoding = _MARKS.get(mark, "utf-8")
    try:
        return data[len(mark) :].decode(encoding)
    except UnicodeDecodeError as error:
        if not mark and fallback is not None:
            return data.decode(fallback, errors="replace")
        line = data[: error.start].count(b"\n") + 1
        where = f"{path}:{line}" if encoding == "utf-8" else f"{path}"
        raise ConfigError(
            f"{where}: not in {encoding.upper()} (byte 0x{data[len(mark) + error.start]:02x}); "
            "save the file as UTF-8"
        ) from None


def read_toml(path: str | Path) -> dict[str, Any]:
    """Read a TOML file; a missing or malformed file is a ConfigError with its path."""
    text = read_text(path)
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
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
