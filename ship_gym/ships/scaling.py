"""A ship at another size: Froude's law for everything but friction."""

from __future__ import annotations

import dataclasses
import math

from ship_gym.config import check_number
from ship_gym.conventions import NU_SEA, RHO_SEA
from ship_gym.ships.particulars import Ship, Trial

# SI unit -> power of the length ratio by Froude's law
_POWERS = {
    "-": 0.0,
    "rad": 0.0,
    "m": 1.0,
    "m2": 2.0,
    "m3": 3.0,
    "s": 0.5,
    "m/s": 0.5,
    "rad/s": -0.5,
    "rev/s": -0.5,
    "rev/s2": -1.0,
    "N m": 4.0,
    "kg m2": 5.0,
}
# measures of a trial in N or N m -> power of the length ratio; the others are in L or ratios
_MEASURE_POWERS = {
    "steady_thrust": 3.0,
    "rudder_normal_force": 3.0,
    "steady_torque": 4.0,
}


def ittc57(reynolds: float) -> float:
    """ITTC-57 friction coefficient C_F = 0.075 / (log10 Re - 2)^2."""
    return 0.075 / (math.log10(reynolds) - 2.0) ** 2


def scaled_section(section, ratio: float, density_ratio: float = 1.0):
    """A section of particulars, every field multiplied by its power of the length ratio."""
    changes = {}
    for field in dataclasses.fields(section):
        unit = field.metadata["unit"]
        factor = ratio ** _POWERS[unit] * (density_ratio if unit in ("N m", "kg m2") else 1.0)
        changes[field.name] = getattr(section, field.name) * factor
    return dataclasses.replace(section, **changes)


def scaled(
    ship: Ship,
    length: float,
    *,
    rho: float = RHO_SEA,
    nu: float = NU_SEA,
    friction_correction: bool = True,
    name: str | None = None,
) -> Ship:
    """The same ship at another length.

    Resistance, in the basis of R0' (1/2 rho L d U^2), at the nominal speed:
    R0'(new) = R0'(old) - ((1 + k) (C_F,old - C_F,new) - C_A) S / (L d), C_A added at full scale
    only. Thrust deduction, wake and rudder constants are kept. With the correction the ship is no
    longer the model of its trials: of those only the track and speed ratio stay, at the ship's own
    self-propulsion, named as the model's.

    Parameters
    ----------
    ship : Ship, or its name or file
    length : float
        New length between perpendiculars [m].
    rho, nu : float
        Density [kg/m3] and kinematic viscosity [m2/s] of the new ship's water.
    friction_correction : bool
        False keeps R0' (a self-propelled model without towing force).
    """
    from ship_gym.ships.loader import load_ship  # late: the loader scales ships

    ship = load_ship(ship)
    ratio = check_number("length", length, 0.1, 1000.0, "m") / ship.hull.L
    hull = dataclasses.replace(scaled_section(ship.hull, ratio), L=float(length))
    speed = ship.speed * math.sqrt(ratio)
    if friction_correction:
        old = ittc57(ship.speed * ship.hull.L / ship.nu)
        new = ittc57(speed * hull.L / nu)
        allowance = hull.C_A if hull.L == ship.full_length else 0.0
        change = (hull.form_factor * (old - new) - allowance) * hull.S / (hull.L * hull.d)
        hull = dataclasses.replace(hull, R_0=hull.R_0 - change)
    of_model = friction_correction and ratio != 1.0
    trials = tuple(
        _scaled_trial(t, ratio, rho / ship.rho, f"model trial of {ship.name}" if of_model else "")
        for t in ship.trials
    )
    return dataclasses.replace(
        ship,
        name=name or f"{ship.name} at {length:g} m",
        rho=rho,
        nu=nu,
        speed=speed,
        hull=hull,
        propeller=scaled_section(ship.propeller, ratio),
        rudder=scaled_section(ship.rudder, ratio),
        gear=scaled_section(ship.gear, ratio),
        engine=scaled_section(ship.engine, ratio, rho / ship.rho),
        form=None if ship.form is None else scaled_section(ship.form, ratio),
        wind=None if ship.wind is None else scaled_section(ship.wind, ratio),
        surrogate=_scaled_surrogate(ship.surrogate, ratio),
        trials=trials,
    )


def _scaled_trial(trial: Trial, ratio: float, density_ratio: float, model: str) -> Trial:
    """A trial at the new scale; of a `model` trial no propeller speed and no force is left."""
    root, measures = math.sqrt(ratio), {}
    for name, value in trial.measures.items():
        if name not in _MEASURE_POWERS:
            measures[name] = value
        elif not model:
            measures[name] = value * ratio ** _MEASURE_POWERS[name] * density_ratio
    return dataclasses.replace(
        trial,
        speed=trial.speed * root,
        n=None if trial.n is None or model else trial.n / root,
        measures=measures,
        source=f"{model}: {trial.source}" if model else trial.source,
    )


def _scaled_surrogate(table, ratio: float):
    """The surrogate's coefficients do not change; its reference area does."""
    if table is None:
        return None
    domain = {**table.card["domain"], "S_R": table.card["domain"]["S_R"] * ratio**2}
    return dataclasses.replace(table, card={**table.card, "domain": domain})
