"""Which hull a wave table is for: facts in its card, and whether a ship has that hull."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Iterator, Mapping
from typing import Any

from ship_gym.config import ConfigError, check_number, shown
from ship_gym.ships.files import available_ships
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import HullForm, Ship
from ship_gym.ships.scaling import scaled_section

SAME = 0.02  # of a ratio: rounding of printed particulars
_SAME_FORM = 2e-3  # of a number of the form, absolute: of those near zero
_LENGTHS = ("L", "B", "d")
_OF_MASS = ("KG", "GM", "k_xx", "k_yy")  # of the form, which count also for a hull from a file


def hull_facts(ship: Ship, drawn: bool) -> dict[str, Any]:
    """What a wave table's card says of its hull, ``made_for``.

    Parameters
    ----------
    ship : Ship
        With a form, or without: the table then has none of it.
    drawn : bool
        Whether the panels were drawn from the form: all of it counts then, else what it says of
        the mass.

    Returns
    -------
    dict
        L, B, d [m], volume [m3], and the form's numbers by L.
    """
    h = ship.hull
    facts: dict[str, Any] = {"L": h.L, "B": h.B, "d": h.d, "volume": h.volume, "k": "by L"}
    if ship.form is not None:
        numbers = dataclasses.asdict(scaled_section(ship.form, 1.0 / h.L))
        facts["form"] = numbers if drawn else {key: numbers[key] for key in _OF_MASS}
    return facts


def check_facts(made: Any) -> None:
    """Refuse facts of a card that are no numbers; those that are missing are not asked for."""
    where = "wave table: card.made_for"
    for key in _LENGTHS:
        length: Any = made.get(key) if isinstance(made, dict) else made
        check_number(f"{where}.{key}", length, 1e-3, 1e4, "m")
    if "volume" in made:
        check_number(f"{where}.volume", made["volume"], 1e-9, 1e9, "m3")
    form = made.get("form", {})
    if not isinstance(form, dict):
        raise ConfigError(f"{where}.form = {shown(form)}: allowed is a mapping")
    for key, value in form.items():
        check_number(f"{where}.form.{shown(key)}", value, -1e3, 1e3)


def differences(card: Mapping[str, Any], ship: Ship) -> Iterator[str]:
    """What of a ship's hull is not that of a table with this card, in words, the first ones first.

    An older card says L, B and d; of a table of the package the rest is that of its ship.
    """
    made, h = card.get("made_for"), ship.hull
    if not made:  # a table that is made by hand may not say
        return
    if "volume" not in made and card.get("ship") in _names():
        made = _of_package(card["ship"]) | dict(made)
    for name in ("B", "d"):
        given, wanted = made[name] / made["L"], getattr(h, name) / h.L
        if abs(given / wanted - 1.0) > SAME:
            yield f"{name} / L = {given:.4f}; {ship.name} has {wanted:.4f}"
    if "volume" in made:
        given = made["volume"] / (made["L"] * made["B"] * made["d"])
        wanted = h.volume / (h.L * h.B * h.d)
        if abs(given / wanted - 1.0) > SAME:
            yield f"C_b = {given:.4f}; {ship.name} has {wanted:.4f}"
    if ship.form is None:
        return
    numbers = dataclasses.asdict(scaled_section(ship.form, 1.0 / h.L))
    for key in made.get("form", {}).keys() & numbers.keys():
        given, wanted = made["form"][key], numbers[key]
        if abs(given - wanted) > max(SAME * max(abs(given), abs(wanted)), _SAME_FORM):
            by = " / L" if HullForm.__dataclass_fields__[key].metadata["unit"] == "m" else ""
            yield f"form.{key}{by} = {given:.4f}; {ship.name} has {wanted:.4f}"


@functools.cache
def _names() -> frozenset[str]:
    return frozenset(available_ships())


@functools.cache
def _of_package(name: str) -> dict[str, Any]:
    return hull_facts(load_ship(name, surrogate="none"), drawn=True)
