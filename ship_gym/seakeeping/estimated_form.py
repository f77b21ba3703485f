"""A form of a new ship that a hull can be drawn from: what is estimated of it gives way.

By dimension of another ship the centre of the waterplane, its area and the metacentre of a form
need not fit each other, the volume and the given numbers. What is given stays as it is.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
from typing import NamedTuple

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.seakeeping.hull_form import centres_of_waterplane, parametric_mesh
from ship_gym.seakeeping.hull_mesh import HullMesh
from ship_gym.seakeeping.hydrostatics import hydrostatics
from ship_gym.ships.particulars import HullForm, Ship

_STEP, _FULLEST = 0.01, 0.98  # of C_wp
_KEELS = (-0.3, -0.4, -0.45)  # x_keel by L, tried one after the other
# KG by d, unless it is more by dimension; the ships of the package have 0.89 to 1.67
_HIGHEST = 2.0
_INSIDE = 0.1  # of the width of the range of x_F, from its ends: there a waterline is a spike


def with_estimated_form(ship: Ship) -> tuple[Ship, str]:
    """A new ship with a form that can be drawn, if there is one.

    The centre of the waterplane moves to the nearest that is possible, a waterplane that is too
    small for the sectional areas grows, the keel rises nearer to the stern, and KG becomes what
    leaves the estimated GM with the drawn hull (GM what a given KG leaves, or one that is high).

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
    drawn, why = _drawn(_Trial(ship, ship.form))
    if drawn is None:
        estimated = {k: v for k, v in ship.estimated.items() if not k.startswith("form.")}
        return dataclasses.replace(ship, form=None, estimated=estimated), why
    return _stable(*drawn).ship, ""


class _Trial(NamedTuple):
    """A ship and her form."""

    ship: Ship
    form: HullForm

    def free(self, key: str) -> bool:
        """Whether a number of the form is estimated."""
        return f"form.{key}" in self.ship.estimated

    def set(self, key: str, value: float, why: str) -> _Trial:
        """With another number in the form; why is added to the reason of the estimate."""
        if value == getattr(self.form, key):
            return self
        where = f"form.{key}"
        estimated = self.ship.estimated | {where: f"{self.ship.estimated[where]}; {why}"}
        form = dataclasses.replace(self.form, **{key: value})
        return _Trial(dataclasses.replace(self.ship, form=form, estimated=estimated), form)


def _drawn(given: _Trial) -> tuple[tuple[_Trial, HullMesh] | None, str]:
    """The ship and her hull; or why there is none, with the form as it is."""
    first, form, L = "", given.form, given.ship.hull.L
    areas, keels = [form.C_wp], [form.x_keel]
    if given.free("C_wp"):
        areas += np.arange(form.C_wp + _STEP, _FULLEST, _STEP).tolist()
    if given.free("x_keel"):
        keels += [at * L for at in _KEELS if at * L < form.x_keel]
    for x_keel, C_wp in itertools.product(keels, areas):
        trial = given.set("x_keel", x_keel, f"{x_keel:.3g} m, else no hull can be drawn")
        trial = _centred(trial.set("C_wp", C_wp, f"{C_wp:.3f}, the least that can be drawn"))
        try:
            return (trial, parametric_mesh(trial.ship)), ""
        except ConfigError as error:
            first = first or str(error).splitlines()[0].removeprefix(f"{given.ship.name}: ")
    return None, first


def _centred(trial: _Trial) -> _Trial:
    """An estimated x_F moved to where a waterline is possible."""
    found = centres_of_waterplane(trial.ship)
    if found is None or not trial.free("x_F"):
        return trial
    margin = _INSIDE * (found[1] - found[0])
    x_F = float(np.clip(trial.form.x_F, found[0] + margin, found[1] - margin))
    return trial.set("x_F", x_F, "moved to the nearest that can be drawn")


def _stable(trial: _Trial, mesh: HullMesh) -> _Trial:
    """KG + GM = KM of the hull that is drawn, as far as the two are estimated."""
    form, KM = trial.form, hydrostatics(mesh).KM
    KG = KM - form.GM
    if trial.free("KG") and trial.free("GM"):
        KG = min(KG, max(form.KG, _HIGHEST * trial.ship.hull.d))
    elif trial.free("GM"):
        KG = form.KG
    if trial.free("KG"):
        trial = trial.set("KG", KG, f"fitted to KM {KM:.3g} m of the drawn hull")
    if KG >= KM:
        raise ConfigError(
            f"form.KG = {KG:g} m: allowed is below {KM:.4g} m, the metacentre of her hull"
        )
    if trial.free("GM") and not math.isclose(KM - KG, form.GM):
        trial = trial.set("GM", KM - KG, f"KM {KM:.3g} m of the drawn hull less KG")
    return trial
