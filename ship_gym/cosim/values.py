"""Values of the parameters of a unit: what they start with, and the sea that they make."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError, check_angle, check_number, shown
from ship_gym.conventions import wrap_angle
from ship_gym.cosim.variables import (
    INPUTS,
    PARAMETERS,
    PROPELLER,
    REAL,
    RUDDER,
    START_PLACE,
    SWITCH,
    TEXT,
    WHOLE,
)
from ship_gym.sea.spectra import WaveSystem
from ship_gym.sea.state import Sea, irregular_sea, load_sea, regular_sea
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Ship
from ship_gym.simulation import self_propulsion

_TYPES: dict[str, Any] = {REAL: (int, float), WHOLE: int, SWITCH: bool, TEXT: str}
_OF = {v.name: v for v in (*PARAMETERS, *START_PLACE, *INPUTS)}


def start_values(ship: str, **given: Any) -> dict[str, Any]:
    """Values that a unit starts with.

    Parameters
    ----------
    ship : str
        Name or ship file.
    **given
        Parameters by their names, with two underscores for the dot (``sea__name="ss5"``); what is
        not given is as in `usual`. A start with latitude and longitude has a place.

    Raises
    ------
    ConfigError
        An unknown name, a value out of range, a ship that cannot hold the speed.
    """
    found = usual(ship)
    for name, value in given.items():
        name = name.replace("__", ".")
        if name not in _OF:
            raise ConfigError(f"unknown parameter {shown(name)} of a unit")
        found[name] = value
    check(found)
    vessel = ship_of(found, Path())
    found.setdefault("start.speed", vessel.speed)
    if found["start.self_propulsion"]:
        n = self_propulsion(vessel, found["start.speed"])
    else:
        n = found["start.propeller_speed"]
    return found | {"start.propeller_speed": n, PROPELLER: found.get(PROPELLER, n)}


def usual(ship: str) -> dict[str, Any]:
    """A ship that holds her nominal speed northward in calm water; the speed is not in it."""
    return {
        **{RUDDER: 0.0, "ship.name": str(ship), "ship.surrogate": "", "ship.variant": ""},
        **{"sea.name": "calm", "sea.wave_height": 0.0, "sea.wave_period": 10.0},
        **{"sea.regular": False, "sea.spreading": 0.0, "sea.wave_direction_from": 0.0},
        **{"sea.swell_height": 0.0, "sea.swell_period": 14.0, "sea.swell_spreading": 0.0},
        **{"sea.swell_direction_from": 0.0, "sea.current_variation": 0.0},
        "sea.current_period": 1800.0,
        **{"sea.wind_speed": 0.0, "sea.wind_direction_from": 0.0, "sea.gusts": False},
        **{"sea.current_speed": 0.0, "sea.current_direction_to": 0.0, "seed": 0},
        **{"start.heading": 0.0, "start.self_propulsion": True, "start.propeller_speed": 0.0},
        "integration.interval": 0.0,
    }


def check(values: Mapping[str, Any]) -> None:
    """Refuse a value of a wrong type or out of its range."""
    for name, value in values.items():
        variable = _OF[name]
        if variable.unit == "rad":
            check_angle(name, value)
        elif variable.kind in (REAL, WHOLE):
            low = -math.inf if variable.low is None else variable.low
            high = math.inf if variable.high is None else variable.high
            check_number(name, value, low, high, variable.unit or "-")
        if not isinstance(value, _TYPES[variable.kind]):
            what = {WHOLE: "whole number", SWITCH: "switch", TEXT: "text"}[variable.kind]
            raise ConfigError(f"{name} = {shown(value)}: must be a {what}")


def ship_of(values: Mapping[str, Any], folder: Path) -> Ship:
    """The ship; one of a file is looked for in the unit's `folder`."""
    name = values["ship.name"]
    where = str(folder / name) if name.endswith(".toml") else name
    surrogate, variant = values["ship.surrogate"] or None, values["ship.variant"] or None
    return load_ship(where, surrogate=surrogate, variant=variant)


def sea_of(values: Mapping[str, Any], ship: Ship) -> Sea:
    """The sea of the parameters: the named one, with waves, wind and current of their own.

    Raises
    ------
    ConfigError
        What ``sea.state`` refuses, or waves that break.
    """
    sea = load_sea(values["sea.name"]).scaled(ship.scale)
    _check_meant(values, sea)
    come, wind_from = values["sea.wave_direction_from"], values["sea.wind_direction_from"]
    if values["sea.wave_height"] > 0.0:
        made = _waves(values, come)
        sea = dataclasses.replace(
            sea,
            waves=made.waves,
            regular=made.regular,
            wave_direction_to=made.wave_direction_to,
        )
    elif come != 0.0:  # those of the package come from north
        turned = regular_sea(1e-3, omega=1.0, direction_from=come)
        sea = dataclasses.replace(sea, wave_direction_to=turned.wave_direction_to)
    if values["sea.swell_height"] > 0.0:
        sea = _with_swell(values, sea)
    if values["sea.wind_speed"] > 0.0:
        sea = dataclasses.replace(sea, wind_speed=values["sea.wind_speed"])
    if values["sea.current_speed"] > 0.0:
        speed, to = values["sea.current_speed"], values["sea.current_direction_to"]
        sea = dataclasses.replace(sea, current_speed=speed, current_direction_to=to)
    if values["sea.current_variation"] > 0.0:
        share, period = values["sea.current_variation"], values["sea.current_period"]
        sea = dataclasses.replace(sea, current_variation=share, current_period=period)
    return dataclasses.replace(sea, wind_direction_from=wind_from, gusts=values["sea.gusts"])


def _with_swell(values: Mapping[str, Any], sea: Sea) -> Sea:
    """A sea with a swell as its last system, at its direction from the main one."""
    if sea.regular is not None:
        raise ConfigError(
            f"sea.swell_height = {values['sea.swell_height']:g}: not beside a regular wave"
        )
    to = values["sea.swell_direction_from"] + math.pi
    swell = WaveSystem(
        height=values["sea.swell_height"],
        peak_period=values["sea.swell_period"],
        direction=float(wrap_angle(to - sea.wave_direction_to)),
        spreading=values["sea.swell_spreading"],
    )
    return dataclasses.replace(sea, waves=(*sea.waves, swell))


def _check_meant(values: Mapping[str, Any], sea: Sea) -> None:
    """Refuse what would say nothing: a direction, or a kind of waves, of what is not there."""
    own = values["sea.wave_height"] > 0.0
    for name, there, needs in (
        ("sea.regular", own, "sea.wave_height"),
        ("sea.spreading", own, "sea.wave_height"),
        ("sea.wave_direction_from", own or sea.waves, "waves"),
        ("sea.swell_spreading", values["sea.swell_height"] > 0.0, "sea.swell_height"),
        ("sea.swell_direction_from", values["sea.swell_height"] > 0.0, "sea.swell_height"),
        ("sea.current_variation", values["sea.current_speed"] or sea.current_speed, "a current"),
        ("sea.wind_direction_from", values["sea.wind_speed"] or sea.wind_speed, "wind"),
        ("sea.current_direction_to", values["sea.current_speed"] > 0.0, "sea.current_speed"),
    ):
        if values[name] and not there:
            raise ConfigError(f"{name} = {values[name]}: means nothing without {needs}")


def _waves(values: Mapping[str, Any], come: float) -> Sea:
    height, period = values["sea.wave_height"], values["sea.wave_period"]
    if values["sea.regular"]:
        if values["sea.spreading"]:
            raise ConfigError(
                f"sea.spreading = {values['sea.spreading']:g}: a regular wave has one direction"
            )
        return regular_sea(0.5 * height, omega=2.0 * math.pi / period, direction_from=come)
    spreading = values["sea.spreading"]
    return irregular_sea(height, period, spreading=spreading, direction_from=come)
