"""A `Ship` as the text of a ship file, each number with unit and where it comes from."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Sequence
from typing import Any

from ship_gym.config import cut
from ship_gym.ships.particulars import Ship
from ship_gym.ships.ranges import RANGES

_TOP = {"full_length": "m", "rho": "kg/m3", "nu": "m2/s", "speed": "m/s"}


def ship_text(ship: Ship, source: str, doubts: Sequence[str] = ()) -> str:
    """The ship file of a ship without surrogate, trials and points of self-propulsion.

    Parameters
    ----------
    ship : Ship
        Numbers are written with six digits, angles in degrees.
    source : str
        Of numbers that name none.
    doubts : sequence of str
        As ``doubts.doubts`` has them: comments at the top of the file.
    """
    lines = [cut(f"# doubtful: {line}") for line in doubts]
    lines += [f"{key} = {_quoted(getattr(ship, key))}" for key in ("title", "status")]
    lines.append(f"source = {_quoted(source)}")
    if not ship.strict:
        lines.append("strict = false")
    lines += [_number(ship, key, getattr(ship, key), unit) for key, unit in _TOP.items()]
    for name in ("hull", "propeller"):
        lines += _section(ship, name)
    lines += _open_water(ship)
    for name in RANGES:
        if name not in ("hull", "propeller") and getattr(ship, name) is not None:
            lines += _section(ship, name)
    return "\n".join(lines) + "\n"


def _quoted(text: Any) -> str:
    return json.dumps(str(text), ensure_ascii=False)


def _section(ship: Ship, name: str) -> list[str]:
    part, lines = getattr(ship, name), ["", f"[{name}]"]
    if name == "hull":
        lines.append(f"variant = {_quoted(ship.variant)}")
    if name == "wind":
        lines.append(f"type = {_quoted(ship.wind_type)}")
    for field in dataclasses.fields(part):
        value = getattr(part, field.name)
        if value != field.default and math.isfinite(value):
            where = f"{name}.{field.name}"
            lines.append(_number(ship, where, value, field.metadata["unit"]))
    return lines


def _number(ship: Ship, where: str, value: float, unit: str) -> str:
    if unit == "rad":
        value, unit = math.degrees(value), "deg"
    elif unit == "rad/s":
        value, unit = math.degrees(value), "deg/s"
    why = ship.estimated.get(where)
    told = f", estimated = {_quoted(why)}" if why else ""
    return f'{where.rsplit(".", 1)[-1]} = {{ value = {value:.6g}, unit = "{unit}"{told} }}'


def _open_water(ship: Ship) -> list[str]:
    card, lines = ship.open_water.card, ["", "[open_water]"]
    if "source" in card:
        lines.append(f"source = {_quoted(card['source'])}")
    if why := ship.estimated.get("open_water"):
        lines.append(f"estimated = {_quoted(why)}")
    for key in ("K_T", "K_Q"):  # a file has them from the constant upwards
        lines.append(f"{key} = [{', '.join(f'{x:.6g}' for x in reversed(card[key]))}]")
    lines.append(f"J_range = [{', '.join(f'{x:.6g}' for x in card['J_range'])}]")
    screw = ", ".join(f"{k} = {v:g}" for k, v in card["four_quadrants"].items())
    return [*lines, f"four_quadrants = {{ {screw} }}"]
