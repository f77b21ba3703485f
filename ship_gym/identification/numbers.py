"""Numbers of a ship by name, ``hull.Y_v`` or ``Y_v``: read, replaced, and what they can be."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from ship_gym.config import ConfigError, check_known
from ship_gym.ships.particulars import Ship
from ship_gym.ships.plausible import basis
from ship_gym.ships.ranges import RANGES

SECTIONS = ("hull", "propeller", "rudder")
DERIVATIVES = {
    "X": ("X_vv", "X_vr", "X_rr", "X_vvvv"),
    "Y": ("Y_v", "Y_r", "Y_vvv", "Y_vvr", "Y_vrr", "Y_rrr"),
    "N": ("N_v", "N_r", "N_vvv", "N_vvr", "N_vrr", "N_rrr"),
}
# what no fit may move: the size of the ship, and what is counted or measured with a rule
_FIXED = {"L", "B", "d", "volume", "S", "D", "A_R", "y_P", "y_R", "beaufoy", "gamma_R_over"}


def allowed() -> dict[str, str]:
    """Short name of every number that may be fitted, to its section."""
    return {name: section for section in SECTIONS for name in RANGES[section] if name not in _FIXED}


def full_names(names: Sequence[str]) -> tuple[str, ...]:
    """Names with their sections.

    Raises
    ------
    ConfigError
        A number that no ship has, or one that is named twice.
    """
    known, found = allowed(), []
    for name in names:
        section, _, short = name.rpartition(".")
        check_known("number to fit", short, known)
        if section not in ("", known[short]):
            raise ConfigError(f"number to fit {name}: it is {known[short]}.{short}")
        found.append(f"{known[short]}.{short}")
    if twice := next((name for name in found if found.count(name) > 1), None):
        raise ConfigError(f"number to fit {twice}: named twice")
    return tuple(found)


def unit_of(ship: Ship, name: str) -> str:
    """SI unit of a number."""
    section, _, short = name.partition(".")
    fields = {f.name: f for f in dataclasses.fields(getattr(ship, section))}
    return fields[short].metadata["unit"]


def values_of(ship: Ship, names: Sequence[str]) -> np.ndarray:
    """Values in SI of named numbers, shape (k,)."""
    parts = (name.partition(".") for name in names)
    return np.array([getattr(getattr(ship, section), short) for section, _, short in parts])


def with_values(ship: Ship, names: Sequence[str], values: Iterable[float]) -> Ship:
    """The ship with other values, SI, of named numbers."""
    changes: dict[str, dict[str, float]] = {}
    for name, value in zip(names, values, strict=True):
        section, _, short = name.partition(".")
        changes.setdefault(section, {})[short] = float(value)
    parts = {s: dataclasses.replace(getattr(ship, s), **new) for s, new in changes.items()}
    return dataclasses.replace(ship, **parts)


def ranges_of(ship: Ship, names: Sequence[str]) -> Mapping[str, tuple[float, float]]:
    """What each number of a ship can be, in SI: ``ships.ranges``."""
    found = {}
    for name in names:
        section, _, short = name.partition(".")
        limits = RANGES[section][short]
        unit = basis(ship, limits.by, ship.speed) or 1.0
        found[name] = (limits.low * unit, limits.high * unit)
    return found
