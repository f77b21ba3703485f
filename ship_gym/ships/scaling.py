"""A ship at another size: Froude's law for everything but friction and the wake it makes."""

from __future__ import annotations

import dataclasses
import math

from ship_gym.config import check_number
from ship_gym.conventions import NU_SEA, RHO_SEA
from ship_gym.ships.particulars import Hull, PropulsionPoint, Ship
from ship_gym.ships.trials import scaled_trial

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
# powers of the length ratio for a point of self-propulsion; the speeds go with its root
_POINT_POWERS = {"thrust": 3.0, "effective_power": 3.5, "delivered_power": 3.5}
RUDDER_WAKE = 0.04  # ITTC-78: what a rudder behind the propeller adds to the potential wake


def ittc57(reynolds: float) -> float:
    """ITTC-57 friction coefficient C_F = 0.075 / (log10 Re - 2)^2."""
    return 0.075 / (math.log10(reynolds) - 2.0) ** 2


def correlation_allowance(L: float) -> float:
    """C_A = 0.006 (L + 100)^-0.16 - 0.00205 of Holtrop & Mennen (1982), L [m] at full scale."""
    return 0.006 * (L + 100.0) ** -0.16 - 0.00205


def viscous_resistance(hull: Hull, speed: float, nu: float, full_length: float) -> float:
    """(1 + k) C_F of ITTC-57, plus the allowance C_A at full scale; both on S."""
    allowance = hull.C_A if hull.L == full_length else 0.0
    return hull.form_factor * ittc57(speed * hull.L / nu) + allowance


def scaled_wake(w: float, t: float, ratio: float) -> float:
    """Effective wake fraction of a single screw at another scale, ITTC 7.5-02-03-01.4 (ITTC-78).

    w_S = (t + 0.04) + (w_M - t - 0.04) ((1 + k) C_FS + Delta C_F) / ((1 + k) C_FM): the potential
    part, taken as the thrust deduction t and 0.04 of the rudder, stays; the viscous part goes with
    the boundary layer, here with `ratio` of the viscous resistances. A wake without a viscous part
    is kept.
    """
    potential = t + RUDDER_WAKE
    return min(w, potential) + max(w - potential, 0.0) * ratio


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
    wake_correction: bool | None = None,
    name: str | None = None,
) -> Ship:
    """The same ship at another length.

    Resistance, in the basis of R0' (1/2 rho L d U^2), at the nominal speed:
    R0'(new) = R0'(old) - ((1 + k) (C_F,old - C_F,new) - C_A) S / (L d), C_A added at full scale
    only. The wake of a single screw goes by `scaled_wake`; two screws in open water keep theirs.
    Thrust deduction and rudder constants are kept. With the correction of friction the ship is no
    longer the model of its trials: of those only the track and speed ratio stay, at the ship's own
    self-propulsion, named as the model's; its points of self-propulsion go.

    Parameters
    ----------
    ship : Ship, or its name or file
    length : float
        New length between perpendiculars [m].
    rho, nu : float
        Density [kg/m3] and kinematic viscosity [m2/s] of the new ship's water.
    friction_correction : bool
        False keeps R0' (a self-propelled model without towing force).
    wake_correction : bool, optional
        False keeps the wake fraction. As `friction_correction` if omitted.
    """
    from ship_gym.ships.loader import load_ship  # late: the loader scales ships

    ship = load_ship(ship)
    ratio = check_number("length", length, 0.1, 1000.0, "m") / ship.hull.L
    hull = dataclasses.replace(scaled_section(ship.hull, ratio), L=float(length))
    speed, density = ship.speed * math.sqrt(ratio), rho / ship.rho
    old = viscous_resistance(ship.hull, ship.speed, ship.nu, ship.full_length)
    new = viscous_resistance(hull, speed, nu, ship.full_length)
    if friction_correction:
        hull = dataclasses.replace(hull, R_0=hull.R_0 - (old - new) * hull.S / (hull.L * hull.d))
    of_model = friction_correction and ratio != 1.0
    trials = tuple(
        scaled_trial(t, ratio, density, f"model trial of {ship.name}" if of_model else "")
        for t in ship.trials
    )
    points = () if of_model else tuple(_scaled_point(p, ratio, density) for p in ship.propulsion)
    other = dataclasses.replace(
        ship,
        name=name or f"{ship.name} at {length:g} m",
        rho=rho,
        nu=nu,
        speed=speed,
        hull=hull,
        propeller=scaled_section(ship.propeller, ratio),
        rudder=scaled_section(ship.rudder, ratio),
        gear=scaled_section(ship.gear, ratio),
        engine=scaled_section(ship.engine, ratio, density),
        form=None if ship.form is None else scaled_section(ship.form, ratio),
        wind=None if ship.wind is None else scaled_section(ship.wind, ratio),
        surrogate=_scaled_surrogate(ship.surrogate, ratio),
        trials=trials,
        propulsion=points,
    )
    wanted = friction_correction if wake_correction is None else wake_correction
    return _with_scaled_wake(other, ship, new / old) if wanted else other


def _with_scaled_wake(ship: Ship, model: Ship, ratio: float) -> Ship:
    """A ship with the wake of its model at her own scale, named as estimated."""
    old = model.propeller.w_P0
    w = old if ship.propellers == 2 else scaled_wake(old, model.propeller.t_P, ratio)
    if w == old:
        return ship
    where, why = "propeller.w_P0", f"{old:.4g} of {model.name} scaled by ITTC-78, {w:.3f} here"
    return dataclasses.replace(
        ship,
        propeller=dataclasses.replace(ship.propeller, w_P0=w),
        sources={**ship.sources, where: "ITTC 7.5-02-03-01.4 (ITTC-78)"},
        estimated={**ship.estimated, where: why},
    )


def _scaled_point(point: PropulsionPoint, ratio: float, density_ratio: float) -> PropulsionPoint:
    """A point of self-propulsion by Froude's law."""
    root = math.sqrt(ratio)
    forces = {
        name: value * ratio**power * density_ratio
        for name, power in _POINT_POWERS.items()
        if (value := getattr(point, name)) is not None
    }
    n = None if point.n is None else point.n / root
    return dataclasses.replace(point, speed=point.speed * root, n=n, **forces)


def _scaled_surrogate(table, ratio: float):
    """The surrogate's coefficients do not change; its reference area does."""
    if table is None:
        return None
    domain = {**table.card["domain"], "S_R": table.card["domain"]["S_R"] * ratio**2}
    return dataclasses.replace(table, card={**table.card, "domain": domain})
