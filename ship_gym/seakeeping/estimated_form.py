"""A form of a new ship that a hull can be drawn from: what is estimated of it gives way.

By dimension of another ship the centre of the waterplane, its area and the metacentre of a form
need not fit each other, the volume and the given numbers. What is given stays as it is.
"""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.seakeeping.hull_form import centres_of_waterplane, parametric_mesh
from ship_gym.seakeeping.hull_mesh import HullMesh
from ship_gym.seakeeping.hydrostatics import hydrostatics
from ship_gym.ships.particulars import Ship

_STEP, _FULLEST = 0.01, 0.98  # of C_wp
_KEELS = (-0.3, -0.4, -0.45)  # x_keel by L, tried one after the other
_INSIDE = 0.1  # of the width of the range of x_F, from its ends: there a waterline is a spike


def with_estimated_form(ship: Ship) -> tuple[Ship, str]:
    """A new ship with a form that can be drawn, if there is one.

    The centre of the waterplane moves to the nearest that is possible, a waterplane that is too
    small for the sectional areas grows, the keel rises nearer to the stern, and KG becomes what
    leaves the estimated GM with the drawn hull (or GM what the given KG leaves).

    Parameters
    ----------
    ship : Ship
        With a form; those of its numbers that `ship.estimated` names may change.

    Returns
    -------
    ship : Ship
        Without a form if none can be drawn.
    why : str
        Why none can be drawn; empty if it can.

    Raises
    ------
    ConfigError
        Her given KG lies at her metacentre or above it.
    """
    if ship.form is None:
        return ship, "the ship that she is like has none"
    drawn, why = _drawn(ship)
    if drawn is None:
        estimated = {k: v for k, v in ship.estimated.items() if not k.startswith("form.")}
        return dataclasses.replace(ship, form=None, estimated=estimated), why
    return _stable(*drawn), ""


def _drawn(ship: Ship) -> tuple[tuple[Ship, HullMesh] | None, str]:
    """The ship and her hull; or why there is none, with the form as it is."""
    first, form = "", ship.form
    areas, keels = [form.C_wp], [form.x_keel]
    if "form.C_wp" in ship.estimated:
        areas += np.arange(form.C_wp + _STEP, _FULLEST, _STEP).tolist()
    if "form.x_keel" in ship.estimated:
        keels += [at * ship.hull.L for at in _KEELS if at * ship.hull.L < form.x_keel]
    for x_keel, C_wp in itertools.product(keels, areas):
        trial = _set(ship, "x_keel", x_keel, f"{x_keel:.3g} m, else no hull can be drawn")
        trial = _set(trial, "C_wp", C_wp, f"{C_wp:.3f}, the least that can be drawn")
        trial = _centred(trial)
        try:
            return (trial, parametric_mesh(trial)), ""
        except ConfigError as error:
            first = first or str(error).splitlines()[0].removeprefix(f"{ship.name}: ")
    return None, first


def _set(ship: Ship, key: str, value: float, why: str) -> Ship:
    """The ship with another number in her form; why is added to the reason of the estimate."""
    if value == getattr(ship.form, key):
        return ship
    where = f"form.{key}"
    estimated = ship.estimated | {where: f"{ship.estimated[where]}; {why}"}
    form = dataclasses.replace(ship.form, **{key: value})
    return dataclasses.replace(ship, form=form, estimated=estimated)


def _centred(ship: Ship) -> Ship:
    """The ship with an estimated x_F moved to where a waterline is possible."""
    found = centres_of_waterplane(ship)
    if found is None or "form.x_F" not in ship.estimated:
        return ship
    margin = _INSIDE * (found[1] - found[0])
    x_F = float(np.clip(ship.form.x_F, found[0] + margin, found[1] - margin))
    return _set(ship, "x_F", x_F, "moved to the nearest that can be drawn")


def _stable(ship: Ship, mesh: HullMesh) -> Ship:
    """The ship with KG + GM = KM of the hull that is drawn, as far as the two are estimated."""
    form, KM = ship.form, hydrostatics(mesh).KM
    if "form.KG" in ship.estimated:
        return _set(ship, "KG", KM - form.GM, f"so that GM is {form.GM:.3g} m of the drawn hull")
    if "form.GM" not in ship.estimated:
        return ship
    if KM <= form.KG:
        raise ConfigError(
            f"form.KG = {form.KG:g} m: allowed is below {KM:.4g} m, the metacentre of her hull"
        )
    return _set(ship, "GM", KM - form.KG, f"KM of the drawn hull, {KM:.3g} m, less KG")
