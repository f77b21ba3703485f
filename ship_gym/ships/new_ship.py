"""A ship from her particulars and a ship that she is like: what is not given is estimated.

Every number that is not given is the other ship's by its dimension (``ranges``: lengths by L, areas
by L d, times by sqrt(L/g) and so on) or one of the published regressions of ``estimators``; which
of the two, and from what, stands beside it as ``estimated``.
"""

from __future__ import annotations

import contextlib
import dataclasses
import math
import re
from collections.abc import Mapping

from ship_gym.config import UNITS, ConfigError, Findings, check_known, check_number
from ship_gym.ships.estimates import GIVEN, STEPS, Made
from ship_gym.ships.files import Named, text_of
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import (
    Engine,
    Hull,
    HullForm,
    Propeller,
    Rudder,
    Ship,
    SteeringGear,
    WindAreas,
)
from ship_gym.ships.plausible import findings_of
from ship_gym.ships.ranges import BOX, RANGES

# particular -> range of it, and its unit; L, B, d, speed and C_b (or volume) are needed
PARTICULARS: dict[str, tuple[float, float, str]] = {
    "L": (0.5, 500.0, "m"),
    "B": (0.05, 500.0, "m"),
    "d": (0.01, 100.0, "m"),
    "C_b": (0.25, 1.0, "-"),
    "volume": (1e-4, 2e6, "m3"),
    "speed": (0.05, 40.0, "m/s"),
    "x_G": (-50.0, 50.0, "m"),
    "D_P": (0.01, 15.0, "m"),
    "z": (2, 7, "-"),
    "pitch_ratio": (0.5, 1.4, "-"),
    "area_ratio": (0.3, 1.05, "-"),
    "propellers": (1, 2, "-"),
    "A_R": (1e-4, 500.0, "m2"),
    "n_max": (0.1, 100.0, "rev/s"),
}
SECTIONS = {"hull": Hull, "propeller": Propeller, "rudder": Rudder, "gear": SteeringGear}
SECTIONS |= {"engine": Engine, "form": HullForm, "wind": WindAreas}
WATER = {"rho": "kg/m3", "nu": "m2/s"}  # also fixed by name; above zero, or nothing is computed
_WITH_UNIT = re.compile(r"([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*([A-Za-z][\w/ ]*)?")
_WHOLE = ("z", "propellers")
_NEEDED = ("L", "B", "d", "speed")
_GEOMETRY = {  # number -> its own option
    **{f"hull.{key}": key for key in ("L", "B", "d", "volume", "x_G")},
    **{"propeller.D": "D_P", "rudder.A_R": "A_R", "engine.n_max": "n_max"},
}


def check_particulars(
    given: Mapping[str, float | None], fixed: Mapping[str, float]
) -> dict[str, float]:
    """The particulars that are given, with C_b and volume of each other.

    Raises
    ------
    ConfigError
        One line for everything that is missing, unknown or out of range, also of the numbers that
        are `fixed`.
    """
    findings, p = Findings(), {}
    with findings.kept():
        _check_fixed(fixed)
    for key, value in given.items():
        with findings.kept():
            low, high, unit = PARTICULARS[check_known("particular", key, PARTICULARS)]
            if value is not None:
                p[key] = check_number(f"--{key}", value, low, high, unit)
                if key in _WHOLE and p[key] != int(p[key]):
                    findings.add(f"--{key} = {value}: must be a whole number")
    missing = [f"--{key}" for key in _NEEDED if given.get(key) is None]
    if given.get("C_b") is None and given.get("volume") is None:
        missing.append("--C_b (or --volume)")
    if missing:
        findings.add(f"missing {', '.join(missing)}")
    if None not in (given.get("C_b"), given.get("volume")):
        findings.add("--C_b and --volume: give one of them")
    findings.tell()
    box = p["L"] * p["B"] * p["d"]
    p.setdefault("volume", p.get("C_b", 0.0) * box)
    with findings.kept():
        p["C_b"] = check_number("volume / (L B d)", p["volume"] / box, 0.25, BOX)
    findings.tell()
    return p


def number_of(text: str, unit: str) -> float | str:
    """The number of a text such as ``7.7`` or ``15 kn`` in its SI `unit`; else the text itself.

    Units are those of ship files; the text of no number and no unit is refused by `new_ship`.
    """
    found = _WITH_UNIT.fullmatch(text.strip())
    if found is None:
        return text
    factor, si = UNITS.get(found[2] or unit, (0.0, ""))
    if si == unit:
        with contextlib.suppress(ValueError):
            return float(found[1]) * (factor if found[2] else 1.0)
    return text


def unit_of(key: str) -> str:
    """SI unit of a particular or of a number of a ship, "section.field"; - if there is none."""
    if key in PARTICULARS:
        return PARTICULARS[key][2]
    if key in WATER:
        return WATER[key]
    section, _, field = key.partition(".")
    part = SECTIONS.get(section)
    known = {f.name: f.metadata["unit"] for f in dataclasses.fields(part)} if part else {}
    return known.get(field, "-")


def new_ship(
    like: Named | Ship,
    name: str,
    given: Mapping[str, float | None],
    fixed: Mapping[str, float] | None = None,
) -> Ship:
    """A ship from particulars.

    Parameters
    ----------
    like : ship, by name, file or as `Ship`
        Brings, by dimension, what is not given.
    name : str
    given : mapping
        As `PARTICULARS`, SI; None: not given. L, B, d, speed and C_b or volume are needed.
    fixed : mapping, optional
        "section.field", rho or nu to a number in SI that replaces the estimate.

    Returns
    -------
    Ship
        Not yet judged (``plausible.checked``); `estimated` has every number that was not given.

    Raises
    ------
    ConfigError
        One line for everything missing or out of range; or one propeller like a ship with two.
    """
    fixed = dict(fixed or {})
    p = check_particulars(given, fixed)
    if not isinstance(like, Ship):
        like = dataclasses.replace(load_ship(like, surrogate="none"), name=text_of(like))
    units = int(p.get("propellers", like.propellers))
    if units < like.propellers:
        raise ConfigError(f"--like {like.name}: has two propellers; name a ship with one")
    made = Made(like, p, fixed, name, units)
    for step in STEPS:
        try:
            step(made)
        except (ValueError, ArithmeticError) as error:  # of a number that no ship has
            raise ConfigError(_reasons(made.ship) or str(error)) from None
    lost = [key for key in fixed if made.ship.sources.get(key) != GIVEN]
    if lost:
        raise ConfigError(f"--set {', '.join(lost)}: {like.name} has no such section to replace in")
    return made.ship


def _reasons(ship: Ship) -> str:
    """What is wrong with the numbers of a ship that has no engine of her own yet."""
    found = findings_of(ship)
    lines = [*found.impossible, *found.implausible]
    return "\n".join(f"{ship.name}: {line}" for line in lines if not line.startswith("engine."))


def _check_fixed(fixed: Mapping[str, float]) -> None:
    findings, known = Findings(), [f"{s}.{key}" for s, table in RANGES.items() for key in table]
    known = [*WATER, *(key for key in known if key not in _GEOMETRY)]
    for key, value in fixed.items():
        with findings.kept():
            if key in _GEOMETRY:
                raise ConfigError(f"--set {key}: is the option --{_GEOMETRY[key]}")
            low, high = (1e-9, 1e9) if key in WATER else (-math.inf, math.inf)
            name = check_known("number of a ship", key, known)
            check_number(f"--set {name}", value, low, high, unit_of(key))
    findings.tell()
