"""What a recording keeps of its ship, and what it says of its x and y."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ship_gym.config import ConfigError
from ship_gym.ships.powering import largest_power, powering

if TYPE_CHECKING:
    from ship_gym.ships.particulars import Ship

# of x and y, for people who read a file
_PLANE = "x north, y east [m] in a plane without a place on the earth"
_ROUTE = (
    "x north, y east [m] in the plane of the chart (meta chart): the legs of the route one behind "
    "the other, each with its true bearing and length; ship_gym.charts gives latitude, longitude"
)
_PLACE = (
    "x north, y east [m] in the plane about the place of the chart (meta chart), from where "
    "distances and bearings are true; ship_gym.charts gives latitude, longitude"
)


def frame(meta: Mapping[str, Any]) -> str:
    """What x and y of a recording are, in words; with a chart its meta has the key ``chart``."""
    chart = meta.get("chart")
    if not chart:
        return _PLANE
    return _PLACE if len(chart["latitude"]) == 1 else _ROUTE


def ship_meta(ship: Ship) -> dict[str, Any]:
    """What a recording keeps of a ship: names, what its metrics and pictures need, in SI."""
    return {
        "name": ship.name,
        "title": ship.title,
        "surrogate": ship.surrogate_name,
        "variant": ship.variant,
        "scale": ship.scale,
        "speed": ship.speed,
        "L": ship.hull.L,
        "B": ship.hull.B,
        "d": ship.hull.d,
        "A_R": ship.rudder.A_R,
        "D_P": ship.propeller.D,
        "delta_max": ship.gear.delta_max,
        "n_max": ship.engine.n_max,
        "power_max": largest_power(ship),
        "m_u": ship.inertia.m_u,
        "efficiency": _efficiency(ship),
        "trained_box": _trained_box(ship),
        "implausible": list(ship.implausible),
    }


def _trained_box(ship: Ship) -> dict[str, Any] | None:
    """Ranges of J and, for a rudder to starboard, of drift [rad]; None: no surrogate."""
    if ship.surrogate is None:
        return None
    domain = ship.surrogate.card["domain"]
    return {name: [domain[f"{name}_min"], domain[f"{name}_max"]] for name in ("J", "beta")}


def _efficiency(ship: Ship) -> float | None:
    """Quasi-propulsive efficiency at the nominal speed; None if the engine cannot hold that."""
    try:
        return powering(ship).efficiency
    except ConfigError:
        return None
