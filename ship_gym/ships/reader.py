"""Numbers of a ship file: strict, in SI, with where each comes from; all findings at once."""

from __future__ import annotations

import dataclasses
import math
import textwrap
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from ship_gym.config import UNITS, ConfigError, Findings, check_number, nearest, shown, unknown_keys
from ship_gym.ships.filled import FILLED

_TEXTS = ("source", "variant", "type")
_NUMBER_KEYS = ("value", "unit", "source", "estimated")


_LINE = 120  # characters of missing keys in one line


def _missing(section: str, names: Sequence[str], estimated: bool) -> Iterator[str]:
    """What is missing of a section in few lines, and what may help."""
    filled = [name for name in names if name in FILLED]
    hint = ""
    if section == "hull" and estimated:
        hint = "; hull.estimate = true fills up added masses, derivatives, S, k_zz and C_D only"
    elif section == "hull" and filled:
        many = "all of them" if len(filled) == len(names) else ", ".join(filled)
        what = "it" if len(names) == 1 else many if len(many) <= _LINE else f"{len(filled)} of them"
        hint = f"; hull.estimate = true fills {what} up"
    if len(names) == 1:
        yield f"missing key {section}.{names[0]!r}{hint}"
        return
    *lines, last = textwrap.wrap(", ".join(names), _LINE)
    for line in (*lines, last + hint):
        yield f"missing keys of [{section}]: {line.rstrip(',')}"


class Reader:
    """Reads numbers of one file and collects where each comes from and what is wrong.

    What cannot be read is None, with a line in `findings`.

    Attributes
    ----------
    path : pathlib.Path
    label : str
        The file as messages name it.
    source : str
        Of numbers that name none.
    length : float or None
        Length of the ship [m], for numbers in the unit ``L``; None: not known.
    """

    def __init__(self, path: Path, label: str = ""):
        self.path, self.label = path, label or str(path)
        self.source = ""
        self.length: float | None = None
        self.findings = Findings()
        self.sources: dict[str, str] = {}
        self.estimated: dict[str, str] = {}

    def kept(self):
        """Context that keeps what a ``ConfigError`` says, with the file's name."""
        return self.findings.kept(f"{self.label}:")

    def add(self, text: str) -> None:
        """Keep a finding, with the file's name."""
        self.findings.add(f"{self.label}: {text}")

    def known(self, values: Mapping[str, Any], allowed: Collection[str], section: str = "") -> None:
        """Find the keys of `values` that are not `allowed`."""
        prefix = section and f"{section}."
        for key in unknown_keys(values, allowed):
            self.add(f"unknown key {prefix}{shown(key)};{nearest(key, allowed)}")

    def text(self, where: str, value: Any) -> str | None:
        """A text."""
        if isinstance(value, str):
            return value
        self.add(f"{where} = {shown(value)}: must be a text")
        return None

    def switch(self, where: str, value: Any) -> bool | None:
        """True or false."""
        if isinstance(value, bool):
            return value
        self.add(f"{where} = {shown(value)}: allowed is true or false")
        return None

    def table(self, where: str, value: Any) -> Mapping[str, Any] | None:
        """A table of keys."""
        if isinstance(value, Mapping):
            return value
        self.add(f"{where} = {shown(value)}: must be a table of keys")
        return None

    def tables(self, where: str, value: Any) -> list[tuple[str, Mapping[str, Any]]]:
        """Tables of a list of tables, those of them that are, each with its name."""
        if not isinstance(value, list):
            self.add(f"{where} = {shown(value)}: must be a list of tables, [[{where}]]")
            return []
        named = [(f"{where}[{k}]", entry) for k, entry in enumerate(value)]
        return [(name, entry) for name, entry in named if self.table(name, entry) is not None]

    def section(
        self, name: str, cls: type, values: Mapping[str, Any], spared: Collection[str] = ()
    ) -> Any:
        """A dataclass of particulars; needed are the fields without a default but `spared`."""
        made = self._numbers(name, cls, values)
        needed = [f.name for f in dataclasses.fields(cls) if f.default is dataclasses.MISSING]
        missing = [key for key in needed if key not in made]
        if told := [key for key in missing if key not in spared]:
            for line in _missing(name, told, bool(spared)):
                self.add(line)
        return cls(**made, **dict.fromkeys(missing))

    def replaced(self, name: str, section: Any, values: Mapping[str, Any]) -> Any:
        """An existing section with some numbers replaced."""
        return dataclasses.replace(section, **self._numbers(name, type(section), values))

    def _numbers(self, name: str, cls: type, values: Mapping[str, Any]) -> dict[str, float | None]:
        units = {field.name: field.metadata["unit"] for field in dataclasses.fields(cls)}
        self.known(values, (*units, *_TEXTS), name)
        for key in _TEXTS:
            if key in values:
                self.text(f"{name}.{key}", values[key])
        source = values.get("source", self.source)
        return {
            key: self.number(f"{name}.{key}", units[key], value, source)
            for key, value in values.items()
            if key in units
        }

    def number(self, where: str, unit: str, entry: Any, source: str | None = None) -> float | None:
        """One number in SI. A plain number is dimensionless; others are {value, unit, ...}."""
        if entry is None:
            self.add(f"missing key {where!r}")
            return None
        if not isinstance(entry, Mapping):
            entry = {"value": entry, "unit": "-"}
        self.known(entry, _NUMBER_KEYS, where)
        texts: dict[str, Any] = {
            k: self.text(f"{where}.{k}", entry[k]) for k in _NUMBER_KEYS[1:] if k in entry
        }
        result = None
        with self.kept():
            result = self._si(where, unit, entry.get("value"), texts.get("unit", "-"))
        self.sources[where] = texts.get("source", self.source if source is None else source)
        if "estimated" in entry:
            self.estimated[where] = texts["estimated"]
            self.sources[where] = texts.get("source", "estimated")
        return result

    def _si(self, where: str, unit: str, value: Any, given: str | None) -> float | None:
        """A value in its unit, in SI; None where the unit could not be read."""
        value = check_number(where, value)
        units = {**UNITS, "L": (self.length, "m")}
        if given is None:
            return None
        if given not in units or units[given][1] != unit:
            allowed = [name for name, (_, si) in units.items() if si == unit]
            raise ConfigError(
                f"{where}: unit {shown(given)} given, allowed is {' or '.join(allowed)}"
            )
        if units[given][0] is None:  # the ship's length could not be read
            if where in ("hull.L", "length"):
                raise ConfigError(f"{where}: unit 'L' given, which is the length itself")
            return None
        result = value * units[given][0]
        if unit == "rad" and abs(result) > 2.0 * math.pi:
            raise ConfigError(f"{where} = {value} {given}: looks like degrees, give unit = 'deg'")
        return result
