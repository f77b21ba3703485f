"""Numbers of a ship file: strict, in SI, with where each comes from."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ship_gym.config import UNITS, ConfigError, check_number, nearest

_TEXTS = ("source", "variant", "type")
_NUMBER_KEYS = ("value", "unit", "source", "estimated")


class Reader:
    """Reads numbers of one file and collects where each comes from."""

    def __init__(self, path: Path, source: str):
        self.path, self.source = path, source
        self.sources: dict[str, str] = {}
        self.estimated: dict[str, str] = {}

    def section(self, name: str, cls: type, values: Mapping[str, Any], length: float) -> Any:
        """A dataclass of particulars; every field without a default must be there."""
        self._check_keys(name, cls, values)
        source = values.get("source", self.source)
        made = {}
        for field in dataclasses.fields(cls):
            if field.name in values:
                unit = field.metadata["unit"]
                where = f"{name}.{field.name}"
                made[field.name] = self.number(where, unit, values[field.name], length, source)
            elif field.default is dataclasses.MISSING:
                hint = "; hull.estimate = true fills it up" if name == "hull" else ""
                raise ConfigError(f"{self.path}: missing key {name}.{field.name!r}{hint}")
        return cls(**made)

    def replaced(self, name: str, section: Any, values: Mapping[str, Any], length: float) -> Any:
        """An existing section with some numbers replaced."""
        self._check_keys(name, type(section), values)
        units = {f.name: f.metadata["unit"] for f in dataclasses.fields(section)}
        changes = {
            key: self.number(
                f"{name}.{key}", units[key], value, length, values.get("source", self.source)
            )
            for key, value in values.items()
            if key in units
        }
        return dataclasses.replace(section, **changes)

    def _check_keys(self, name: str, cls: type, values: Mapping[str, Any]) -> None:
        known = {field.name for field in dataclasses.fields(cls)}
        for key in values:
            if key not in known and key not in _TEXTS:
                raise ConfigError(f"{self.path}: unknown key {name}.{key!r};{nearest(key, known)}")

    def number(self, where: str, unit: str, entry: Any, length: float, source: str) -> float:
        """One number in SI. A plain number is dimensionless; others are {value, unit, ...}."""
        label = f"{self.path}: {where}"
        if entry is None:
            raise ConfigError(f"{label}: missing")
        if not isinstance(entry, Mapping):
            entry = {"value": entry, "unit": "-"}
        for key in entry:
            if key not in _NUMBER_KEYS:
                raise ConfigError(f"{label}: unknown key {key!r};{nearest(key, _NUMBER_KEYS)}")
        value, given = entry.get("value"), entry.get("unit", "-")
        value = check_number(label, value)
        units = {**UNITS, "L": (length, "m")}
        if given not in units or units[given][1] != unit:
            allowed = [name for name, (_, si) in units.items() if si == unit]
            raise ConfigError(f"{label}: unit {given!r} given, allowed is {' or '.join(allowed)}")
        result = value * units[given][0]
        if unit == "rad" and abs(result) > 2.0 * math.pi:
            raise ConfigError(f"{label} = {value} {given}: looks like degrees, give unit = 'deg'")
        self.sources[where] = entry.get("source", source)
        if "estimated" in entry:
            self.estimated[where] = str(entry["estimated"])
            self.sources[where] = entry.get("source", "estimated")
        return result
