"""Values of a ship file to a `Ship` in SI; all that is wrong with a file is told at once."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

from ship_gym.config import build
from ship_gym.ships.files import name_of
from ship_gym.ships.filled import FILLED, filled_hull
from ship_gym.ships.open_water_entry import open_water
from ship_gym.ships.particulars import (
    Engine,
    Hull,
    HullForm,
    Propeller,
    PropulsionPoint,
    Rudder,
    Ship,
    SteeringGear,
    WindAreas,
)
from ship_gym.ships.plausible import errors_of, findings_of
from ship_gym.ships.reader import Reader
from ship_gym.ships.scaling import scaled
from ship_gym.ships.trials import Trial, scaled_trial

_SECTIONS = {
    "hull": Hull,
    "propeller": Propeller,
    "rudder": Rudder,
    "gear": SteeringGear,
    "engine": Engine,
}
_OPTIONAL = {"form": HullForm, "wind": WindAreas}
_UNITS = {"full_length": "m", "rho": "kg/m3", "nu": "m2/s", "speed": "m/s"}
_TEXTS = ("title", "status", "source")
_NEEDED = (*_TEXTS, *_UNITS, "open_water", *_SECTIONS)
_TOP = (*_NEEDED, *_OPTIONAL, "surrogate", "trial", "propulsion", "strict")
_MAIN = {"L": "m", "B": "m", "d": "m", "volume": "m3", "x_G": "m"}  # what estimates need
_OWN = ("title", "status", "scaled_from", "length", "wake_correction", "propulsion", "strict")


def complete_ship(data: Mapping[str, Any], path: Path, label: str = "") -> Ship:
    """Ship of a complete file, without its surrogate.

    Parameters
    ----------
    data : mapping
        Values of the file, as TOML has them.
    path : pathlib.Path
    label : str
        The file in messages; its path if omitted.

    Raises
    ------
    ConfigError
        One line for every missing or unknown key, wrong type, wrong unit and implausible number.
    """
    reader = Reader(path, label)
    reader.known(data, _TOP)
    if missing := [repr(key) for key in _NEEDED if key not in data]:
        reader.add(f"missing key{'s' if len(missing) > 1 else ''} {', '.join(missing)}")
    # what cannot be read is None in the ship, until `_judged` refuses her
    texts: dict[str, Any] = dict.fromkeys(_TEXTS)
    texts |= {key: reader.text(key, data[key]) for key in _TEXTS if key in data}
    reader.source = texts["source"] or ""
    parts = {
        name: reader.table(name, data[name])
        for name in (*_SECTIONS, *_OPTIONAL, "open_water", "surrogate")
        if name in data
    }
    _check_surrogate(parts.get("surrogate") or {}, reader)
    sections = _sections(parts, reader)
    strict = reader.switch("strict", data.get("strict", True))
    table: Any = open_water(parts.get("open_water"), reader)
    ship = Ship(
        name=name_of(path),
        title=texts["title"],
        status=texts["status"],
        open_water=table,
        variant=(parts.get("hull") or {}).get("variant", "published"),
        wind_type=(parts.get("wind") or {}).get("type", ""),
        **_wave_table(path),
        trials=_trials(data, reader),
        propulsion=_propulsion(data, reader),
        sources=reader.sources,
        estimated=reader.estimated,
        strict=strict is not False,
        **_numbers(data, reader),
        **sections,
    )
    return _judged(ship, reader)


def scaled_ship(base: Ship, data: Mapping[str, Any], path: Path) -> Ship:
    """Ship of a file that scales another one, `base`, and replaces some of its numbers.

    Raises
    ------
    ConfigError
        As `complete_ship`.
    """
    reader = Reader(path)
    reader.source = f"{base.name} by Froude's law"
    parts = [*_SECTIONS, *(name for name in _OPTIONAL if getattr(base, name) is not None)]
    reader.known(data, (*_OWN, *parts))
    texts: dict[str, Any] = {k: reader.text(k, data[k]) for k in _TEXTS[:2] if k in data}
    strict = reader.switch("strict", data.get("strict", base.strict))
    wake = reader.switch("wake_correction", data.get("wake_correction", True))
    ship: Ship | None = None
    with reader.kept():
        length = reader.number("length", "m", data.get("length"))
        ship = scaled(base, length, wake_correction=wake) if length is not None else None
    reader.length = None if ship is None else ship.hull.L
    tables = {name: reader.table(name, data[name]) for name in parts if name in data}
    changes = {
        name: reader.replaced(name, getattr(ship or base, name), table)
        for name, table in tables.items()
        if table is not None
    }
    points = _propulsion(data, reader)
    if ship is None:
        reader.findings.tell()
    assert ship is not None  # else there was a finding
    ship = dataclasses.replace(
        ship,
        **texts,
        propulsion=points,
        sources={**ship.sources, **reader.sources},
        estimated={
            **{k: v for k, v in ship.estimated.items() if k not in reader.sources},
            **reader.estimated,
        },
        strict=strict is not False,
        **changes,
    )
    return _judged(ship, reader)


def _judged(ship: Ship, reader: Reader) -> Ship:
    """The ship, if nothing was found that is wrong; else every finding is told."""
    found = findings_of(ship)
    for line in errors_of(ship, found):
        reader.add(line)
    reader.findings.tell()
    return dataclasses.replace(ship, implausible=tuple(found.implausible))


def _numbers(data: Mapping[str, Any], reader: Reader) -> dict[str, Any]:
    """Numbers of no section."""
    return {k: reader.number(k, unit, data[k]) if k in data else None for k, unit in _UNITS.items()}


def _sections(parts: Mapping[str, Mapping | None], reader: Reader) -> dict[str, Any]:
    """Sections of particulars; None where there is none."""
    hull = parts.get("hull") or {}
    if "L" in hull:
        length = reader.number("hull.L", "m", hull["L"])
        reader.length = length if length is not None and length > 0.0 else None
    sections: dict[str, Any] = {}
    for name, cls in (_SECTIONS | _OPTIONAL).items():
        values = parts.get(name)
        if values is None:
            sections[name] = None
        elif name == "hull":
            sections[name] = reader.section(name, cls, *_filled_up(values, reader))
        else:
            sections[name] = reader.section(name, cls, values)
    return sections


def _filled_up(hull: Mapping[str, Any], reader: Reader) -> tuple[dict[str, Any], Collection[str]]:
    """The section ``hull``, with ``filled.filled_hull`` if it asks for that.

    And what is not missing where the estimates cannot be made, since they would fill it up.
    """
    hull = dict(hull)
    wanted = reader.switch("hull.estimate", hull.pop("estimate", False))
    if not wanted:
        return hull, ()
    main: dict[str, Any] = {
        key: reader.number(f"hull.{key}", unit, hull[key])
        for key, unit in _MAIN.items()
        if key in hull
    }
    if len(main) < len(_MAIN) or None in main.values():
        return hull, FILLED
    with reader.kept():
        estimates = {
            key: {"value": value, "unit": unit, "estimated": why}
            for key, (value, unit, why) in filled_hull(**main).items()
        }
        hull = {**estimates, **hull}
    return hull, FILLED


def _check_surrogate(entry: Mapping[str, Any], reader: Reader) -> None:
    reader.known(entry, ("default",), "surrogate")
    if "default" in entry:
        reader.text("surrogate.default", entry["default"])


def _wave_table(path: Path) -> dict[str, Any]:
    """The wave table beside a ship file, of this ship or of all, if there is one."""
    for name in (f"waves_{name_of(path)}.npz", "waves.npz"):
        found = path.resolve().with_name(name)
        if found.is_file():
            state = found.stat()
            return {"wave_table": str(found), "wave_state": (state.st_mtime_ns, state.st_size)}
    return {}


def _propulsion(data: Mapping[str, Any], reader: Reader) -> tuple[PropulsionPoint, ...]:
    """Published points of self-propulsion of a ship file."""
    made = []
    for name, entry in reader.tables("propulsion", data.get("propulsion", [])):
        where = f"{reader.label}: {name}"
        with reader.findings.kept(where):
            made.append(build(PropulsionPoint, entry, where))
    return tuple(made)


def _trials(data: Mapping[str, Any], reader: Reader) -> tuple[Trial, ...]:
    """Trials of a ship file, at the scale of the ship."""
    made = []
    for name, entry in reader.tables("trial", data.get("trial", [])):
        where = f"{reader.label}: {name}"
        with reader.findings.kept(where):
            trial = build(Trial, entry, where)
            if trial.length is not None and reader.length is not None:
                trial = scaled_trial(trial, reader.length / trial.length)
            made.append(trial)
    return tuple(made)
