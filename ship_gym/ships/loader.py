"""Ship files: TOML with printed numbers, units and sources to a `Ship` in SI."""

from __future__ import annotations

import dataclasses
import math
import os
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, build, check_known, check_number, merged, nearest
from ship_gym.csv_file import read_csv
from ship_gym.provenance import sha256
from ship_gym.reading import read_toml
from ship_gym.ships.b_series import b_series
from ship_gym.ships.estimators import estimated_hull
from ship_gym.ships.files import (
    Named,
    base_of,
    check_chain,
    file_of,
    name_of,
    text_of,
)
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
    check_sections,
)
from ship_gym.ships.reader import Reader
from ship_gym.ships.records import numbered, surrogate_names
from ship_gym.ships.scaling import scaled
from ship_gym.ships.surrogate_card import check_surrogate
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
_NEEDED = (
    "title",
    "status",
    "source",
    "full_length",
    "rho",
    "nu",
    "speed",
    "open_water",
    *_SECTIONS,
)
_TOP = (*_NEEDED, *_OPTIONAL, "surrogate", "trial", "propulsion")
_TOP_UNITS = (("full_length", "m"), ("rho", "kg/m3"), ("nu", "m2/s"), ("speed", "m/s"))
_SAME_SHIP = 0.02  # of D / L: rounding of printed particulars
# rudder formulas in place of a fitted surrogate, with the propeller's open-water curve in the wake
FORMULAS = ("none", "beaufoy")
# what a set of captive tests brings to the rudder law and to the thrust straight ahead
_CAPTIVE = ("open_water", "rudder.epsilon", "rudder.kappa", "rudder.gamma_R_p", "rudder.t_R")


def available_variants(ship: Named) -> list[str]:
    """Hull variants of a ship beside its default, e.g. ``["hull_a", "hull_c"]``."""
    path = file_of(ship)
    base = base_of(read_toml(path), path)
    own = sorted(found.stem for found in path.parent.glob("hull_*.toml"))
    return own + (available_variants(base) if base else [])


def available_surrogates(ship: Named) -> list[str]:
    """Propeller and rudder surrogates of a ship; ``"none"`` (MMG rudder) and Beaufoy's first."""
    path = file_of(ship)
    data = read_toml(path)
    if base := base_of(data, path):
        return available_surrogates(base)
    twin = "y_P" in data.get("propeller", {})
    return [
        *(FORMULAS[:1] if twin else FORMULAS),
        *sorted(p.stem.removeprefix("surrogate_") for p in path.parent.glob("surrogate_*.npz")),
    ]


def load_ship(
    name: Named | Ship, *, surrogate: str | None = None, variant: str | None = None
) -> Ship:
    """Load a ship by name or from a ship file.

    Parameters
    ----------
    name : str, path or Ship
        One of `available_ships()`, or the path of a ``.toml`` file. A `Ship` is given back.
    surrogate : str, optional
        One of `available_surrogates(name)`; the ship file's default if omitted.
    variant : str, optional
        One of `available_variants(name)`: another published hull set.

    Returns
    -------
    Ship
        Everything in SI; ``ship.describe()`` lists the estimated numbers. A file's ship has the
        name of the file, or of its folder if it is a ``ship.toml``; with ``own_`` before it if
        that is the name of a ship of the package.

    Raises
    ------
    ConfigError
        Unknown name or key (with the nearest one), missing number, wrong unit or value.
    """
    if isinstance(name, Ship):
        for what, given in (("surrogate", surrogate), ("variant", variant)):
            if given is not None:
                raise ConfigError(f"{what} = {given!r}: the ship given as an object brings its own")
        return name
    text = text_of(name)
    if text.endswith(".toml"):  # a user's file may change while this process runs
        return _load.__wrapped__(text, surrogate, variant)
    return _load(text, surrogate, variant)


def bare(ship: Named | Ship) -> Ship:
    """Ship without a surrogate, to fit one for it; a `Ship` is given back."""
    return ship if isinstance(ship, Ship) else load_ship(ship, surrogate="none")


def load_ships(ships: Named | Ship | Sequence[Named | Ship], count: int) -> list[Ship]:
    """`count` ships of one given ship, or of a sequence; each different one is loaded once."""
    if isinstance(ships, str | os.PathLike | Ship):
        return [load_ship(ships)] * count
    given = [ship if isinstance(ship, Ship) else text_of(ship) for ship in ships]
    different, numbers = numbered(given)
    made = [load_ship(ship) for ship in different]
    return [made[k] for k in numbers]


@lru_cache(maxsize=32)
def _load(name: str, surrogate: str | None, variant: str | None) -> Ship:
    path = file_of(name)
    data = read_toml(path)
    if base := base_of(data, path):
        check_chain(path)
        ship = _scaled_ship(load_ship(base, surrogate=surrogate, variant=variant), data, path)
    else:
        if variant is not None:
            check_known(f"hull variant of {name}", variant, available_variants(name))
            data = merged(data, read_toml(path.with_name(f"{variant}.toml")))
        ship = _ship(data, path)
        ship = _with_surrogate(ship, data, path.parent, name, surrogate)
    ship = dataclasses.replace(ship, name=name_of(path))
    check_sections(ship)
    return ship


def _ship(data: Mapping[str, Any], path: Path) -> Ship:
    """Ship of a complete file, without its surrogate."""
    for key in data:
        if key not in _TOP:
            raise ConfigError(f"{path}: unknown key {key!r};{nearest(key, _TOP)}")
    for key in _NEEDED:
        if key not in data:
            raise ConfigError(f"{path}: missing key {key!r}")
    reader = Reader(path, data["source"])
    length = reader.number("hull.L", "m", data["hull"].get("L"), math.nan, data["source"])
    parts = {name: data[name] for name in _SECTIONS}
    parts["hull"] = _estimated_hull(data["hull"], length, reader)
    parts |= {name: data[name] for name in _OPTIONAL if name in data}
    sections = {
        name: reader.section(name, cls, parts[name], length)
        for name, cls in (_SECTIONS | _OPTIONAL).items()
        if name in parts
    }
    top = {
        key: reader.number(key, unit, data[key], length, data["source"]) for key, unit in _TOP_UNITS
    }
    trials = tuple(_trial(trial, f"{path}: trial", length) for trial in data.get("trial", []))
    return Ship(
        name=name_of(path),
        title=data["title"],
        status=data["status"],
        open_water=_open_water(data["open_water"], path, reader),
        variant=data["hull"].get("variant", "published"),
        wind_type=data.get("wind", {}).get("type", ""),
        wave_table=_wave_table(path),
        trials=trials,
        propulsion=_propulsion(data, path),
        sources=reader.sources,
        estimated=reader.estimated,
        **top,
        **sections,
    )


def _propulsion(data: Mapping[str, Any], path: Path) -> tuple[PropulsionPoint, ...]:
    """Published points of self-propulsion of a ship file."""
    where = f"{path}: propulsion"
    return tuple(build(PropulsionPoint, point, where) for point in data.get("propulsion", []))


def _trial(entry: Mapping[str, Any], where: str, length: float) -> Trial:
    """A trial at the scale of its ship of length `length` [m]."""
    trial = build(Trial, entry, where)
    return trial if trial.length is None else scaled_trial(trial, length / trial.length)


def _wave_table(path: Path) -> str:
    """Path of the wave table beside a ship file, of this ship or of all; empty without one."""
    for name in (f"waves_{name_of(path)}.npz", "waves.npz"):
        found = path.resolve().with_name(name)
        if found.is_file():
            return str(found)
    return ""


def _estimated_hull(hull: Mapping[str, Any], length: float, reader: Reader) -> dict[str, Any]:
    """The section ``hull``, filled up by ``estimators.estimated_hull`` if it asks for that."""
    hull = dict(hull)
    wanted = hull.pop("estimate", False)
    if not isinstance(wanted, bool):
        raise ConfigError(f"{reader.path}: hull.estimate = {wanted!r}: allowed is true or false")
    if not wanted:
        return hull
    main = {
        key: reader.number(f"hull.{key}", unit, hull.get(key), length, "")
        for key, unit in (("L", "m"), ("B", "m"), ("d", "m"), ("volume", "m3"), ("x_G", "m"))
    }
    estimates = {
        key: {"value": value, "unit": "-", "estimated": why}
        for key, (value, why) in estimated_hull(**main).items()
    }
    return {**estimates, **hull}


def _scaled_ship(base: Ship, data: Mapping[str, Any], path: Path) -> Ship:
    """Ship of a file that scales another one and replaces some of its numbers."""
    sections = [*_SECTIONS, *(name for name in _OPTIONAL if getattr(base, name) is not None)]
    own = ("title", "status", "scaled_from", "length", "wake_correction", "propulsion")
    allowed = (*own, *sections)
    for key in data:
        if key not in allowed:
            raise ConfigError(f"{path}: unknown key {key!r};{nearest(key, allowed)}")
    reader = Reader(path, f"{base.name} by Froude's law")
    length = reader.number("length", "m", data.get("length"), math.nan, "")
    wake = data.get("wake_correction", True)
    if not isinstance(wake, bool):
        raise ConfigError(f"{path}: wake_correction = {wake!r}: allowed is true or false")
    ship = scaled(base, length, wake_correction=wake)
    changes = {
        name: reader.replaced(name, getattr(ship, name), data[name], length)
        for name in sections
        if name in data
    }
    return dataclasses.replace(
        ship,
        title=data.get("title", ship.title),
        status=data.get("status", ship.status),
        propulsion=_propulsion(data, path),
        sources={**ship.sources, **reader.sources},
        estimated={
            **{k: v for k, v in ship.estimated.items() if k not in reader.sources},
            **reader.estimated,
        },
        **changes,
    )


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


def _open_water(entry: Mapping[str, Any], path: Path, reader: Reader) -> Table:
    """Open-water table from points, from polynomials, or K_Q from the B-series."""
    where = f"{path}: open_water"
    e = build(_OpenWaterEntry, entry, where)
    card = {"source": e.source or reader.source}
    reader.sources["open_water"] = card["source"]
    if e.estimated:
        reader.estimated["open_water"] = e.estimated
    if e.K_T:
        if len(e.J_range) != 2 or not (e.K_Q or e.b_series):
            raise ConfigError(f"{where}: K_T also needs J_range = [low, high] and K_Q or b_series")
        if e.K_Q:
            K_Q = np.array(e.K_Q[::-1])
        else:
            J = np.linspace(*e.J_range, 33)
            K_Q = np.polyfit(J, b_series(J, **dataclasses.asdict(e.b_series))[1], 3)
        K_T = np.array(e.K_T[::-1])
        return open_water_table(K_T, K_Q, e.J_range, _screw(e, K_T, e.J_range, reader), card)
    if e.points is None:
        raise ConfigError(f"{where}: needs points = 'file.csv' or K_T with K_Q")
    check_number(f"{where}.degree", e.degree, 1, 6)
    if not (path.parent / e.points).is_file():
        raise ConfigError(f"{where}.points = {e.points!r}: no such file beside the ship file")
    points = read_csv(path.parent / e.points).require("J", "K_T", "10K_Q")
    J = points.columns["J"]
    K_T = np.polyfit(J, points.columns["K_T"], e.degree)
    K_Q = np.polyfit(J, 0.1 * points.columns["10K_Q"], e.degree)
    card["points"] = {e.points: sha256(path.parent / e.points)}
    J_range = (float(J.min()), float(J.max()))
    return open_water_table(K_T, K_Q, J_range, _screw(e, K_T, J_range, reader), card)


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


def _with_surrogate(ship: Ship, data, folder: Path, name: str, wanted: str | None) -> Ship:
    """Attach a fitted surrogate table and the effective-inflow law that was fitted with it."""
    entry = data.get("surrogate", {})
    wanted = wanted or entry.get("default", "none")
    if wanted == "regression":  # the family, beside "gp" and "nn"
        wanted = entry.get("default", "none")
    known = available_surrogates(name)
    if wanted == entry.get("default") and wanted not in known:
        raise ConfigError(
            f"{name}: surrogate.default = {wanted!r}: no surrogate_{wanted}.npz beside the file"
        )
    check_known(f"surrogate of {name}", wanted, known)
    if wanted == "none":
        return ship
    if wanted == "beaufoy":
        return with_beaufoy(ship)
    file = folder / f"surrogate_{wanted}.npz"
    table = Table.load(file)
    try:
        return attach_surrogate(ship, table, wanted)
    except ConfigError as error:
        raise ConfigError(f"{file}: {error}") from None


def with_beaufoy(ship: Ship) -> Ship:
    """Ship with Beaufoy's rudder formula (``physics.rudder.beaufoy``), to compare with.

    Raises
    ------
    ConfigError
        The ship has two propellers: the formula's race factor is of a single screw.
    """
    if ship.propellers > 1:
        raise ConfigError(f"{ship.name}: Beaufoy's formula is for one propeller and one rudder")
    return dataclasses.replace(
        ship,
        rudder=dataclasses.replace(ship.rudder, beaufoy=1.0),
        surrogate_name="beaufoy",
        sources={**ship.sources, "rudder.beaufoy": "Stern et al. (2021)"},
    )


def attach_surrogate(ship: Named | Ship, table: Table, name: str) -> Ship:
    """Ship with a deflected-rudder surrogate, at any scale.

    A ship whose open-water curve and rudder constants are measured keeps them all, of its own hull
    set: the MMG rudder with its interaction (t_R, a_H, x_H) at small angles, and straight ahead
    the thrust of the open-water curve in the wake, to which the surrogate's is shifted
    (``records.anchored``), if its range holds zero drift. At the trained angle the rudder force is
    the surrogate's.

    A ship with estimates there gets the effective-inflow law that was fitted to the samples in the
    table's card (area, gradient and height in the race too), and no steering deduction: the
    surrogate is the force on the rudder alone, X_R its surge force as it stands. A single rudder
    then keeps the ship's ratio of flow straightening to port, since the samples are of turns to
    starboard only; of two rudders the leeward and the windward one have their own.

    Raises
    ------
    ConfigError
        The table was made for a ship with another propeller, by its diameter over the length, or
        with another number of propellers.
    """
    ship = load_ship(ship)
    check_surrogate(table, {units: surrogate_names(units) for units in (1, 2)}, name)
    made, law = table.card["made_for"], table.card["effective_inflow"]
    ratio = ship.hull.L / made["L"]
    if abs(ship.propeller.D / (made["D"] * ratio) - 1.0) > _SAME_SHIP:
        raise ConfigError(
            f"surrogate {name} was made for {made['ship']} with D / L = "
            f"{made['D'] / made['L']:.4f}; {ship.name} has {ship.propeller.D / ship.hull.L:.4f}"
        )
    if len(law["gamma_R"]) != ship.propellers:
        raise ConfigError(
            f"surrogate {name} was made for {len(law['gamma_R'])} propellers; {ship.name} has "
            f"{ship.propellers}"
        )
    domain = {**table.card["domain"], "S_R": made["A_R"] * ratio**2}
    measured, drift = has_captive_set(ship), table.axes[-1]
    known_ahead = drift.start <= 0.0 <= drift.stop  # else there is no point to shift it by
    card = {**table.card, "domain": domain, "anchored": measured and known_ahead}
    if not measured:
        ship = _with_fitted_law(ship, table.card, name)
    return dataclasses.replace(
        ship, surrogate=dataclasses.replace(table, card=card), surrogate_name=name
    )


def has_captive_set(ship: Ship) -> bool:
    """Whether open-water curve and rudder constants of a ship are measured, none estimated."""
    return not any(key in ship.estimated for key in _CAPTIVE)


def _with_fitted_law(ship: Ship, card: Mapping[str, Any], name: str) -> Ship:
    """Ship with the effective-inflow law of a surrogate's card in place of its own constants."""
    made, law = card["made_for"], card["effective_inflow"]
    # leeward before windward; to port of a single rudder the ship file's asymmetry
    gamma_R_p, gamma_R_n = next(iter(law["gamma_R"].values())), list(law["gamma_R"].values())[-1]
    if ship.propellers == 1:
        gamma_R_n *= ship.rudder.gamma_R_n / ship.rudder.gamma_R_p
    rudder = dataclasses.replace(
        ship.rudder,
        A_R=made["A_R"] * (ship.hull.L / made["L"]) ** 2,
        f_alpha=made["f_alpha"],
        eta=made["eta"],
        t_R=0.0,
        epsilon=law["epsilon"],
        kappa=law["kappa"],
        gamma_R_p=gamma_R_p,
        gamma_R_n=gamma_R_n,
    )
    fitted = f"fitted to the CFD samples of surrogate {name}"
    names = ("epsilon", "kappa", "gamma_R_p", "gamma_R_n")
    sources = {**ship.sources, **{f"rudder.{k}": fitted for k in names}}
    sources["rudder.t_R"] = "0: the surrogate is the force on the rudder itself"
    return dataclasses.replace(ship, rudder=rudder, sources=sources)
