"""Sails the manoeuvres of a suite with each ship, to each side, in each sea."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any

from ship_gym.config import ConfigError
from ship_gym.evaluation.manoeuvres.definition import CALM, Manoeuvre
from ship_gym.reports.case import MANOEUVRES, Case, sail, sail_trial
from ship_gym.reports.handling import Handling, sail_handling
from ship_gym.reports.trials import trial_name
from ship_gym.sea.state import load_sea
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Ship
from ship_gym.ships.trials import Trial

AHEAD_DEG = 0.0  # where waves and wind come from, from the approach course
NO_WAVES = "the ship has no wave table"
NO_WIND = "the ship has no wind areas"


@dataclasses.dataclass(frozen=True)
class Sailed:
    """A manoeuvre that has been sailed, or why it could not be.

    Attributes
    ----------
    ship : Ship
    manoeuvre : Manoeuvre
    side : str
        ``starboard``, ``port`` or nothing; the first turn of a zig-zag.
    sea : str
    case : Case, Handling or None
    error : str
        Why there is no case.
    trial : Trial or None
        It is none of the suite but a measured one of the ship file, sailed as it was measured.
    """

    ship: Ship
    manoeuvre: Manoeuvre
    side: str
    sea: str
    case: Case | Handling | None = None
    error: str = ""
    trial: Trial | None = None

    @property
    def name(self) -> str:
        """In words, without side and sea; of a trial with all that it was."""
        return self.manoeuvre.name if self.trial is None else trial_name(self.ship, self.trial)


def sail_manoeuvres(
    manoeuvres: Sequence[Manoeuvre],
    ships: Sequence[str | Ship],
    progress: Callable[[Iterable, str, int], Iterable] | None = None,
) -> list[Sailed]:
    """Sail all manoeuvres with all ships, and the trials of each ship that are not among them.

    What a ship cannot do (a heading that is not reached, an engine that cannot reverse, a sea that
    she has no table for) is told in `Sailed.error` and ends nothing.

    Parameters
    ----------
    manoeuvres : sequence of Manoeuvre
    ships : sequence of str or Ship
    progress : callable, optional
        ``progress(iterable, description, total)``.

    Raises
    ------
    ConfigError
        An unknown ship or sea.
    """
    loaded = [load_ship(ship) for ship in ships]
    for sea in {sea for each in manoeuvres for sea in each.seas}:
        load_sea(sea)
    orders = [
        Sailed(ship, manoeuvre, side, sea)
        for ship in loaded
        for manoeuvre in manoeuvres
        for sea in manoeuvre.seas
        for side in manoeuvre.sides
    ]
    shown = progress(orders, "manoeuvres", len(orders)) if progress else orders
    found = [_sailed(order) for order in shown]
    others = [trial for ship in loaded for trial in _trials(ship, found)]
    shown = progress(others, "trials", len(others)) if progress and others else others
    return [*found, *(_sailed(order) for order in shown)]


def _trials(ship: Ship, found: Sequence[Sailed]) -> list[Sailed]:
    """Trials of a ship beside which no manoeuvre of the suite stands."""
    there = [f.case.trial for f in found if f.ship is ship and isinstance(f.case, Case)]
    names = {kind: name for name, kind in MANOEUVRES.items()}
    return [
        Sailed(ship, Manoeuvre(names[trial.manoeuvre], abs(trial.delta_deg)), "", "", trial=trial)
        for trial in ship.trials
        if trial.measures and trial not in there
    ]


def _sailed(order: Sailed) -> Sailed:
    why = "" if order.trial else _cannot(order.ship, order.sea)
    if why:
        return dataclasses.replace(order, error=why)
    try:
        case = _case(order)
        return dataclasses.replace(order, case=case, sea=case.sea if order.trial else order.sea)
    except ConfigError as error:
        return dataclasses.replace(order, error=str(error))


def _cannot(ship: Ship, name: str) -> str:
    """Why a ship cannot sail in a sea; nothing if she can."""
    sea = load_sea(name)
    if sea.waves and not ship.wave_table:
        return NO_WAVES
    if sea.wind_speed > 0.0 and ship.wind is None:
        return NO_WIND
    return ""


def _case(order: Sailed) -> Case | Handling:
    if order.trial is not None:
        return sail_trial(order.ship, order.trial)
    manoeuvre, sign = order.manoeuvre, -1.0 if order.side == "port" else 1.0
    where: dict[str, Any] = {"sea": order.sea}
    if order.sea != CALM and load_sea(order.sea).waves:
        where["wave_from_deg"] = AHEAD_DEG
    rudder = manoeuvre.rudder_deg
    if manoeuvre.kind not in MANOEUVRES:
        return sail_handling(order.ship, manoeuvre.kind, delta_deg=rudder, **where)
    largest = math.degrees(order.ship.gear.delta_max)
    if manoeuvre.kind == "turning":
        rudder = min(rudder or 35.0, largest)
        return sail(order.ship, "turning", delta_deg=sign * rudder, **where)
    heading = manoeuvre.heading_deg or rudder or 10.0
    rudder = rudder or heading
    where |= {"delta_deg": sign * rudder, "psi_deg": sign * heading}
    return sail(order.ship, "zigzag", **where)
