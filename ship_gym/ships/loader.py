"""Ship files: by name or path to a `Ship`, with its variant and surrogate."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError, check_known, merged, shown, told_of
from ship_gym.reading import read_toml
from ship_gym.ships.files import Named, base_of, chain_of, file_of, name_of, text_of
from ship_gym.ships.particulars import Ship
from ship_gym.ships.plausible import checked, warn_of
from ship_gym.ships.records import numbered, surrogate_names
from ship_gym.ships.ship_file import complete_ship, scaled_ship
from ship_gym.ships.surrogate_card import check_surrogate
from ship_gym.tables import Table

_SAME_SHIP = 0.02  # of D / L: rounding of printed particulars
# rudder formulas in place of a fitted surrogate, with the propeller's open-water curve in the wake
FORMULAS = ("none", "beaufoy")
# what a set of captive tests brings to the rudder law and to the thrust straight ahead
_CAPTIVE = ("open_water", "rudder.epsilon", "rudder.kappa", "rudder.gamma_R_p", "rudder.t_R")


def available_variants(ship: Named) -> list[str]:
    """Hull variants of a ship beside its default, e.g. ``["hull_a", "hull_c"]``."""
    folders = [path.parent for path, _ in chain_of(file_of(ship))]
    return [
        variant
        for folder in folders
        for variant in sorted(found.stem for found in folder.glob("hull_*.toml"))
    ]


def available_surrogates(ship: Named) -> list[str]:
    """Propeller and rudder surrogates of a ship; ``"none"`` (MMG rudder) and Beaufoy's first."""
    path, data = chain_of(file_of(ship))[-1]
    return _surrogates(path, data)


def _surrogates(path: Path, data: Mapping[str, Any]) -> list[str]:
    """As `available_surrogates`, of a complete file with its values."""
    propeller = data.get("propeller")
    twin = isinstance(propeller, Mapping) and "y_P" in propeller
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
        One of `available_ships()`, or the path of a ``.toml`` file. A `Ship` is checked and given
        back.
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
        Unknown name; or, one line for each of them, unknown keys (with the nearest one), missing
        numbers, wrong types and units, and numbers that no ship has.

    Warns
    -----
    ImplausibleShip
        Instead of an error, for numbers that no ship has in a file that says ``strict = false``.
    """
    if isinstance(name, Ship):
        for what, given in (("surrogate", surrogate), ("variant", variant)):
            if given is not None:
                raise ConfigError(
                    f"{what} = {shown(given)}: the ship given as an object brings its own"
                )
        ship, where = checked(name), name.name
        if ship.implausible != name.implausible:
            warn_of(ship, where)
        return ship
    where = text_of(name)
    ship = _loaded(where, surrogate, variant)
    warn_of(ship, where)
    return ship


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


def _loaded(name: str, surrogate: str | None, variant: str | None) -> Ship:
    """As `load_ship`, without a warning."""
    if name.endswith(".toml"):  # a user's file may change while this process runs
        return _load.__wrapped__(name, surrogate, variant)
    return _load(name, surrogate, variant)


@lru_cache(maxsize=32)
def _load(name: str, surrogate: str | None, variant: str | None) -> Ship:
    path, data = chain_of(file_of(name))[0]
    if base := base_of(data, path):
        ship = scaled_ship(_loaded(base, surrogate, variant), data, path)
    else:
        label = str(path)
        if variant is not None:
            check_known(f"hull variant of {name}", variant, available_variants(name))
            data = merged(data, read_toml(path.with_name(f"{variant}.toml")))
            label = f"{path} with {variant}.toml"
        ship = complete_ship(data, path, label)
        ship = _with_surrogate(ship, data, path, name, surrogate)
        ship = checked(ship, label)  # a surrogate may bring a rudder law
    return dataclasses.replace(ship, name=name_of(path))


def _with_surrogate(ship: Ship, data, path: Path, name: str, wanted: str | None) -> Ship:
    """Attach a fitted surrogate table and the effective-inflow law that was fitted with it."""
    entry = data.get("surrogate", {})
    wanted = wanted or entry.get("default", "none")
    if wanted == "regression":  # the family, beside "gp" and "nn"
        wanted = entry.get("default", "none")
    known = _surrogates(path, data)
    if wanted == entry.get("default") and wanted not in known:
        raise ConfigError(
            f"{name}: surrogate.default = {shown(wanted)}: no surrogate_{wanted[:60]}.npz "
            "beside the file"
        )
    check_known(f"surrogate of {name}", wanted, known)
    if wanted == "none":
        return ship
    if wanted == "beaufoy":
        return with_beaufoy(ship)
    file = path.with_name(f"surrogate_{wanted}.npz")
    table = Table.load(file)
    with told_of(file):
        return attach_surrogate(ship, table, wanted)


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
