"""Values of a ship file to a `Ship` in SI; all that is wrong with a file is told at once."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, build, check_number, shown
from ship_gym.csv_file import read_csv
from ship_gym.provenance import sha256
from ship_gym.ships.b_series import b_series
from ship_gym.ships.estimators import estimated_hull
from ship_gym.ships.files import name_of
from ship_gym.ships.four_quadrants import Screw, nearest_screw
from ship_gym.ships.open_water import open_water_table
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
from ship_gym.ships.plausible import findings_of
from ship_gym.ships.ranges import OPEN_WATER
from ship_gym.ships.reader import Reader
from ship_gym.ships.scaling import scaled
from ship_gym.ships.trials import Trial, scaled_trial
from ship_gym.tables import Table

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
_MOST_COEFFICIENTS = 7  # of a polynomial in J
_COLUMNS = {"J": (-3.0, 3.0), "K_T": (-5.0, 5.0), "10K_Q": (-50.0, 50.0)}  # of any propeller


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
    for key in _NEEDED:
        if key not in data:
            reader.add(f"missing key {key!r}")
    texts = {key: reader.text(key, data[key]) for key in _TEXTS if key in data}
    reader.source = texts.get("source", "")
    parts = {
        name: reader.table(name, data[name])
        for name in (*_SECTIONS, *_OPTIONAL, "open_water", "surrogate")
        if name in data
    }
    _check_surrogate(parts.get("surrogate") or {}, reader)
    sections = _sections(parts, reader)
    strict = reader.switch("strict", data.get("strict", True))
    ship = Ship(
        name=name_of(path),
        title=texts.get("title"),
        status=texts.get("status"),
        open_water=_open_water(parts.get("open_water"), reader),
        variant=(parts.get("hull") or {}).get("variant", "published"),
        wind_type=(parts.get("wind") or {}).get("type", ""),
        wave_table=_wave_table(path),
        trials=_trials(data, reader),
        propulsion=_propulsion(data, reader),
        sources=reader.sources,
        estimated=reader.estimated,
        strict=strict is not False,
        **{key: reader.number(key, _UNITS[key], data.get(key)) for key in _UNITS},
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
    texts = {key: reader.text(key, data[key]) for key in _TEXTS[:2] if key in data}
    strict = reader.switch("strict", data.get("strict", base.strict))
    wake = reader.switch("wake_correction", data.get("wake_correction", True))
    ship = None
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
    for line in found.impossible + (found.implausible if ship.strict else []):
        reader.add(line)
    reader.findings.tell()
    return dataclasses.replace(ship, implausible=tuple(found.implausible))


def _sections(parts: Mapping[str, Mapping | None], reader: Reader) -> dict[str, Any]:
    """Sections of particulars; None where there is none."""
    hull = parts.get("hull") or {}
    if "L" in hull:
        length = reader.number("hull.L", "m", hull["L"])
        reader.length = length if length is not None and length > 0.0 else None
    sections = {}
    for name, cls in (_SECTIONS | _OPTIONAL).items():
        values = parts.get(name)
        if values is None:
            sections[name] = None
        elif name == "hull":
            sections[name] = reader.section(name, cls, *_filled_up(values, reader))
        else:
            sections[name] = reader.section(name, cls, values)
    return sections


def _filled_up(hull: Mapping[str, Any], reader: Reader) -> tuple[dict[str, Any], bool]:
    """The section ``hull``, with ``estimators.estimated_hull`` if it asks for that.

    And whether it asks: where the estimates cannot be made, what they would fill up is not
    missing.
    """
    hull = dict(hull)
    wanted = reader.switch("hull.estimate", hull.pop("estimate", False))
    if not wanted:
        return hull, False
    main = {
        key: reader.number(f"hull.{key}", unit, hull[key])
        for key, unit in _MAIN.items()
        if key in hull
    }
    if len(main) < len(_MAIN) or None in main.values():
        return hull, True
    with reader.kept():
        estimates = {
            key: {"value": value, "unit": "-", "estimated": why}
            for key, (value, why) in estimated_hull(**main).items()
        }
        hull = {**estimates, **hull}
    return hull, True


def _check_surrogate(entry: Mapping[str, Any], reader: Reader) -> None:
    reader.known(entry, ("default",), "surrogate")
    if "default" in entry:
        reader.text("surrogate.default", entry["default"])


def _wave_table(path: Path) -> str:
    """Path of the wave table beside a ship file, of this ship or of all; empty without one."""
    for name in (f"waves_{name_of(path)}.npz", "waves.npz"):
        found = path.resolve().with_name(name)
        if found.is_file():
            return str(found)
    return ""


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


@dataclasses.dataclass(frozen=True)
class _OpenWaterEntry:
    """Section ``open_water`` of a ship file: points with a degree, or polynomials in J."""

    source: str = ""
    estimated: str = ""
    points: str | None = None
    degree: int = 3
    K_T: tuple[float, ...] = ()  # from the constant upwards
    K_Q: tuple[float, ...] = ()
    J_range: tuple[float, ...] = ()
    b_series: Screw | None = None
    four_quadrants: Screw | None = None  # outside the data; b_series, else the nearest, if omitted


def _open_water(entry: Mapping[str, Any] | None, reader: Reader) -> Table | None:
    """Open-water table from points, from polynomials, or K_Q from the B-series."""
    if entry is None:
        return None
    where = f"{reader.label}: open_water"
    with reader.findings.kept(where):
        e = build(_OpenWaterEntry, entry, where)
        card = {"source": e.source or reader.source}
        reader.sources["open_water"] = card["source"]
        if e.estimated:
            reader.estimated["open_water"] = e.estimated
        if not e.K_T and e.points is None:
            raise ConfigError(f"{where}: needs points = 'file.csv' or K_T with K_Q")
        made = _polynomials(e, where) if e.K_T else _fitted(e, where, reader.path.parent, card)
        K_T, K_Q, J_range = made
        return open_water_table(K_T, K_Q, J_range, _screw(e, K_T, J_range, reader), card)


def _polynomials(e: _OpenWaterEntry, where: str) -> tuple[np.ndarray, np.ndarray, tuple]:
    """K_T and K_Q, highest power first, and the range of J, of an entry with coefficients."""
    if len(e.J_range) != 2 or not (e.K_Q or e.b_series):
        raise ConfigError(f"{where}: K_T also needs J_range = [low, high] and K_Q or b_series")
    for name in ("K_T", "K_Q"):
        if len(getattr(e, name)) > _MOST_COEFFICIENTS:
            raise ConfigError(f"{where}.{name}: at most {_MOST_COEFFICIENTS} coefficients")
    _check_rising(f"{where}.J_range", e.J_range)
    K_T = np.array(e.K_T[::-1])
    if e.K_Q:
        return K_T, np.array(e.K_Q[::-1]), e.J_range
    J = np.linspace(*e.J_range, 33)
    return K_T, np.polyfit(J, b_series(J, **dataclasses.asdict(e.b_series))[1], 3), e.J_range


def _fitted(e: _OpenWaterEntry, where: str, folder: Path, card: dict) -> tuple:
    """As `_polynomials`, fitted to the points of a file, which `card` then names."""
    check_number(f"{where}.degree", e.degree, 1, 6)
    path = folder / e.points
    if not path.is_file():
        raise ConfigError(f"{where}.points = {shown(e.points)}: no such file beside the ship file")
    points = read_csv(path).require(*_COLUMNS)
    for name, limits in _COLUMNS.items():
        for row, value in zip(points.rows, points.columns[name], strict=True):
            check_number(f"{path}:{row}: {name}", value, *limits)
    J, K_T, K_Q = (points.columns[name] for name in _COLUMNS)
    if len(set(J)) <= e.degree:
        raise ConfigError(f"{path}: {len(set(J))} different J, a fit needs more than the degree")
    card["points"] = {e.points: sha256(path)}
    J_range = (float(J.min()), float(J.max()))
    return np.polyfit(J, K_T, e.degree), np.polyfit(J, 0.1 * K_Q, e.degree), J_range


def _check_rising(where: str, J_range: tuple[float, float]) -> None:
    low, high = OPEN_WATER["J_low"].must[0], OPEN_WATER["J_high"].must[1]
    if not low <= J_range[0] < J_range[1] <= high:
        raise ConfigError(
            f"{where} = {shown(list(J_range))}: allowed is [low, high], low < high, within "
            f"{low:g} to {high:g}"
        )


def _screw(e: _OpenWaterEntry, K_T: np.ndarray, J_range, reader: Reader) -> Screw:
    """Series screw that stands for the propeller outside its open-water data, as an estimate."""
    screw = e.four_quadrants or e.b_series
    if screw is None:
        J = np.linspace(*J_range, 33)
        screw = nearest_screw(J, np.polyval(K_T, J))
    reader.sources["open_water.four_quadrants"] = "Roddy, Hess & Faller (2006)"
    reader.estimated["open_water.four_quadrants"] = (
        f"outside the open-water data: Wageningen harmonics nearest to {screw.blades} blades, "
        f"P/D {screw.pitch_ratio:g}, AE/A0 {screw.area_ratio:g}"
    )
    return screw
