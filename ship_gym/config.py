"""Strict values: mappings to frozen dataclasses in SI, and one line for each that is wrong.

A wrong value is refused before any work starts, with the field, the value and what is allowed.
Unknown keys name the nearest known one. Files are read in ``ship_gym.reading``.
"""

from __future__ import annotations

import contextlib
import dataclasses
import difflib
import itertools
import math
import re
import types
import typing
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from ship_gym.conventions import KNOT

LONGEST = 300  # characters of a line of an error
_MOST_NAMES = 100  # characters of the known names in it
MOST_FINDINGS = 100  # lines of an error
_LONG_WORD = re.compile(r"[^\s'\"]{24,}")
# no quantity of a ship or a sea is smaller, but zero, or larger
SMALLEST, LARGEST = 1e-30, 1e30


class ConfigError(ValueError):
    """A file, a key or a value that cannot be used; the message says which and what is allowed.

    One line for each thing that is wrong, at most `LONGEST` characters; a longer one loses its
    middle.
    """

    def __init__(self, text: object = ""):
        super().__init__("\n".join(map(cut, str(text).splitlines() or [""])))


class ImplausibleShip(UserWarning):
    """Numbers that no published ship has, in a ship whose file says ``strict = false``."""


def cut(line: str, most: int = LONGEST) -> str:
    """A line of at most `most` characters: long paths lose their beginning, then it its middle."""
    line = "".join(c if c.isprintable() else " " for c in line)
    if len(line) > most:
        line = _LONG_WORD.sub(_end_of_path, line)
    if len(line) <= most:
        return line
    half = (most - 5) // 2
    return f"{line[:half]} ... {line[-half:]}"


def _end_of_path(word: re.Match) -> str:
    """The last three names of a long path; another word as it is."""
    names = word[0].split("/")
    return "/".join(["...", *names[-3:]]) if len(names) > 4 else word[0]


def shown(value: object, most: int = 60) -> str:
    """A value as it is named in an error: its ``repr``, at most `most` characters.

    Never an exception, whatever the value: Python itself refuses to print integers of more than
    4,300 digits.
    """
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, str | bytes):
        value = value if len(value) <= most else value[:most]
    elif isinstance(value, int) and value.bit_length() > 200:
        return f"an integer of {value.bit_length()} bits"
    try:
        return cut(repr(value), most)
    except (ValueError, RecursionError):
        return f"a {type(value).__name__} that cannot be printed"


class Findings:
    """All that is wrong with one thing, to be said at once.

    Examples
    --------
    >>> findings = Findings()
    >>> with findings.kept():
    ...     check_number("speed", -1.0, 0.0, 10.0, "m/s")
    >>> findings.lines
    ['speed = -1.0: allowed is 0 to 10 [m/s]']
    """

    def __init__(self) -> None:
        self.lines: list[str] = []

    def add(self, text: str) -> None:
        """Keep one line, once; at most `MOST_FINDINGS` of them."""
        if text not in self.lines and len(self.lines) <= MOST_FINDINGS:
            full = len(self.lines) == MOST_FINDINGS
            self.lines.append("more is wrong, see to these first" if full else text)

    @contextlib.contextmanager
    def kept(self, where: str = "") -> Iterator[None]:
        """Keep what a ``ConfigError`` in the block says, and go on after it.

        Parameters
        ----------
        where : str
            Put before a line that does not begin with it, such as a file's name and a colon.
        """
        try:
            yield
        except ConfigError as error:
            for line in str(error).splitlines():
                self.add(line if line.startswith(where) else f"{where} {line}")

    def tell(self) -> None:
        """Raise one ``ConfigError`` with a line for each finding, if there are any."""
        if self.lines:
            raise ConfigError("\n".join(self.lines))


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


def nearest(name: object, known: Iterable[str]) -> str:
    """Text ``did you mean 'x'? Known: ...`` for an unknown name; of many names the first ones."""
    known = sorted(str(k) for k in known)
    close = difflib.get_close_matches(shown(name)[:80].strip("'"), known, n=1, cutoff=0.4)
    guess = f" did you mean {close[0]!r}?" if close else ""
    names = ", ".join(known)
    if len(names) > _MOST_NAMES:
        fitting = names[:_MOST_NAMES].rpartition(", ")[0]
        names = f"{fitting} and {len(known) - fitting.count(', ') - 1} more"
    return f"{guess} Known: {names}"


def check_known(kind: str, name: str, known: Iterable[str]) -> str:
    """Return `name` if it is known, else raise ConfigError that names the nearest one."""
    known = list(known)
    if name not in known:
        raise ConfigError(f"unknown {kind} {shown(name)};{nearest(name, known)}")
    return name


def check_angle(field: str, value: float, limit: float = 2.0 * math.pi) -> float:
    """Return an angle [rad] if it is finite and within `limit` [rad], else raise ConfigError."""
    value = check_number(field, value, unit="rad")
    if abs(value) > limit * (1.0 + 1e-12):
        hint = f"; looks like degrees, use {math.radians(value):.4g} rad"
        hint = hint if abs(value) > 2.0 * math.pi or abs(math.radians(value)) <= limit else ""
        raise ConfigError(f"{field} = {value} rad: allowed is |{field}| <= {limit:.4g} rad{hint}")
    return value


def check_number(
    field: str,
    value: Any,
    low: float = -math.inf,
    high: float = math.inf,
    unit: str = "-",
    tiny: bool = False,
) -> float:
    """Return a finite number within [low, high], else raise ConfigError that says so.

    A number that a float cannot hold, and one that no quantity reaches (1e-30 to 1e30, or zero),
    is refused whatever the limits: its square would not be finite. With `tiny` it may be as small
    as it likes: a measured or computed value, which may be the rounding of a zero.
    """
    if isinstance(value, bool) or not isinstance(value, int | float | np.number):
        raise ConfigError(f"{field} = {shown(value)}: must be a number [{unit}]")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    except TypeError:  # complex
        raise ConfigError(f"{field} = {shown(value)}: must be a number [{unit}]") from None
    if not math.isfinite(number) and low == -math.inf and high == math.inf:
        raise ConfigError(f"{field} = {shown(value)}: must be finite [{unit}]")
    if not (math.isfinite(number) and low <= value <= high):  # value: an integer is exact
        raise ConfigError(f"{field} = {shown(value)}: allowed is {low:g} to {high:g} [{unit}]")
    if (number and not (tiny or SMALLEST <= abs(number))) or abs(number) > LARGEST:
        raise ConfigError(
            f"{field} = {shown(value)}: allowed is 0, or {SMALLEST:g} to {LARGEST:g} in size "
            f"[{unit}]"
        )
    return number


def check_fields(section: str, item: object, ranges: dict[str, tuple[float, float, str]]) -> None:
    """Refuse a field of a dataclass outside its range (low, high, unit); None is passed over.

    A field may be an array: each of its numbers is checked.
    """
    for name, (low, high, unit) in ranges.items():
        value = getattr(item, name)
        for number in value.ravel().tolist() if isinstance(value, np.ndarray) else [value]:
            if number is not None:
                check_number(f"{section}.{name}", number, low, high, unit)


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
        A line for each unknown key (with the nearest one), missing key and value of a wrong type;
        or what a dataclass refuses. Every line begins with `where`.
    """
    with told_of(where):
        return _build(cls, values, where)


@contextlib.contextmanager
def told_of(where: object) -> Iterator[None]:
    """Put `where`, such as the name of a file, before each line of a ``ConfigError``, once."""
    try:
        yield
    except ConfigError as error:
        lines = str(error).splitlines()
        if all(line.startswith(str(where)) for line in lines):
            raise
        told = [line if line.startswith(str(where)) else f"{where}: {line}" for line in lines]
        raise ConfigError("\n".join(told)) from None


def _build(cls: Any, values: Mapping[str, Any], where: str) -> Any:
    if not isinstance(values, Mapping):
        raise ConfigError(f"{where} = {shown(values)}: must be a table of keys")
    hints = typing.get_type_hints(cls)
    fields = {f.name: f for f in dataclasses.fields(cls) if f.init}
    findings, made = Findings(), {}
    for key in unknown_keys(values, fields):
        findings.add(f"{where}: unknown key {shown(key)};{nearest(key, fields)}")
    for name, field in fields.items():
        if name in values:
            with findings.kept():
                made[name] = _convert(hints[name], values[name], f"{where}.{name}")
        elif field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING:
            findings.add(f"{where}: missing key {name!r}")
    findings.tell()
    return cls(**made)


def unknown_keys(values: Iterable[str], known: Iterable[str]) -> list[str]:
    """Those of `values` that are not `known`, not more than an error has lines."""
    known = set(known)
    return list(itertools.islice((key for key in values if key not in known), MOST_FINDINGS + 1))


def _convert(kind: Any, value: Any, where: str) -> Any:
    """Convert one TOML value to the annotated type, or raise ConfigError."""
    if typing.get_origin(kind) in (typing.Union, types.UnionType):
        if value is None:
            return None
        kind = next(k for k in typing.get_args(kind) if k is not type(None))
    if dataclasses.is_dataclass(kind):
        if dataclasses.is_dataclass(value):
            return value
        return _build(kind, value, where)
    if (sequence := typing.get_origin(kind)) in (tuple, list):
        if not isinstance(value, list | tuple | np.ndarray):
            raise ConfigError(f"{where} = {shown(value)}: must be a list")
        return sequence(_convert(typing.get_args(kind)[0], item, where) for item in value)
    if dict in (kind, typing.get_origin(kind)):
        if not isinstance(value, Mapping):
            raise ConfigError(f"{where} = {shown(value)}: must be a table of keys")
        of_values = (typing.get_args(kind) or (str, Any))[1]
        return {key: _convert(of_values, v, f"{where}.{key}") for key, v in value.items()}
    if kind is Any:
        return value
    if kind is float:
        return check_number(where, value)
    if not isinstance(value, kind) or (kind is int and isinstance(value, bool)):
        raise ConfigError(f"{where} = {shown(value)}: must be of type {kind.__name__}")
    if kind is int and value.bit_length() > 63:
        raise ConfigError(f"{where} = {shown(value)}: must be less than 2^63 in size")
    return value


def merged(base: Mapping[str, Any], overrides: Mapping[str, Any]) -> dict[str, Any]:
    """Nested mapping `base` with the keys of `overrides` replaced; unknown keys are kept.

    They are refused afterwards by `build`, which knows the allowed names.
    """
    result = dict(base)
    for key, value in overrides.items():
        old = result.get(key)
        if isinstance(value, Mapping) and isinstance(old, Mapping):
            value = merged(old, value)
        result[key] = value
    return result
