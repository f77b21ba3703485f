"""Whether a ship can exist: every number against its range, all findings at once.

Two kinds of findings. What cannot be computed with (`Range.must`, a mass matrix that is not
positive) is an error, always. What no ship has (`Range.low`, `Range.high`) is an error of a strict
ship; of one whose file says ``strict = false`` it stands in ``Ship.implausible`` and is a warning,
``config.ImplausibleShip``.
"""

from __future__ import annotations

import dataclasses
import math
import re
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ship_gym.config import ConfigError, ImplausibleShip, shown
from ship_gym.conventions import G
from ship_gym.ships.particulars import PropulsionPoint, Ship
from ship_gym.ships.ranges import (
    NOT_NEGATIVE,
    OPEN_WATER,
    POSITIVE,
    PROPULSION,
    RANGES,
    TOP,
    TRIAL,
    Range,
)
from ship_gym.ships.trials import Trial

_LEAST_REYNOLDS = 1e4  # ITTC-57 has a pole at 100


class Verdict(NamedTuple):
    """Lines about one ship: what cannot be computed with, and what no ship has."""

    impossible: list[str]
    implausible: list[str]


# Basis of a range -> its SI unit, and its value for a ship that sails at U [m/s]; what a number is
# divided by, so that it no longer depends on the size of the ship.
_Basis = tuple[str, Callable[[Any, Any], float]]  # a number of a ship that is read may be None
BASES: dict[str, _Basis] = {
    "": ("", lambda s, U: 1.0),
    "L": ("m", lambda s, U: s.hull.L),
    "B": ("m", lambda s, U: s.hull.B),
    "d": ("m", lambda s, U: s.hull.d),
    "L_oa": ("m", lambda s, U: s.wind.L_oa),
    "L d": ("m2", lambda s, U: s.hull.L * s.hull.d),
    "L (1.7 d + C_b B)": ("m2", lambda s, U: 1.7 * s.hull.L * s.hull.d + s.hull.volume / s.hull.d),
    "L^2": ("m2", lambda s, U: s.hull.L**2),
    "B^2": ("m2", lambda s, U: s.hull.B**2),
    "A_L": ("m2", lambda s, U: s.wind.A_L),
    "L B d": ("m3", lambda s, U: s.hull.L * s.hull.B * s.hull.d),
    "sqrt(g L)": ("m/s", lambda s, U: math.sqrt(G * s.hull.L)),
    "sqrt(L/g)": ("s", lambda s, U: math.sqrt(s.hull.L / G)),
    "U/D": ("rev/s", lambda s, U: U / s.propeller.D),
    "n_max": ("rev/s", lambda s, U: s.engine.n_max),
    "n_max / sqrt(L/g)": ("rev/s2", lambda s, U: s.engine.n_max / math.sqrt(s.hull.L / G)),
    "deg": ("rad", lambda s, U: math.radians(1.0)),
    "deg / sqrt(L/g)": ("rad/s", lambda s, U: math.radians(1.0) / math.sqrt(s.hull.L / G)),
    "torque_max": ("N m", lambda s, U: s.engine.torque_max),
    "rho n_max^2 D^5": ("N m", lambda s, U: s.rho * s.engine.n_max**2 * s.propeller.D**5),
    "rho D^5": ("kg m2", lambda s, U: s.rho * s.propeller.D**5),
    "rho L d U^2 / 2": ("N", lambda s, U: 0.5 * s.rho * s.hull.L * s.hull.d * U**2),
    "rho L d U^3 / 2": ("W", lambda s, U: 0.5 * s.rho * s.hull.L * s.hull.d * U**3),
}


_KEYS = {"L": "hull.L", "B": "hull.B", "d": "hull.d", "U": "speed", "rho": "rho"}
_KEYS |= {"D": "propeller.D", "n_max": "engine.n_max", "torque_max": "engine.torque_max"}
_KEYS |= {"L_oa": "wind.L_oa", "A_L": "wind.A_L", "C_b": "hull.volume"}
# basis -> keys of the numbers that it is made of
_PARTS = {
    name: [_KEYS[word] for word in re.findall(r"\w+", name) if word in _KEYS] for name in BASES
}


def basis(ship: Ship, name: str, speed: float | None) -> float | None:
    """A basis of `BASES` for a ship; None if a number it needs is missing or not above zero."""
    try:
        value = BASES[name][1](ship, speed)
    except (AttributeError, TypeError, ArithmeticError, ValueError):
        return None
    return value if value and value > 0.0 else None


def values_of(ship: Ship) -> Iterator[tuple[str, dict[str, Any], Mapping[str, Range], float]]:
    """Prefix of the keys, values, ranges and speed of every part of a ship that has ranges."""
    speed = ship.speed and ship.share and ship.speed / ship.share
    L = basis(ship, "L", speed)
    top = {"full_length / hull.L": ship.full_length / L if L and ship.full_length else None}
    parts = [(f"{name}.", getattr(ship, name), table) for name, table in RANGES.items()]
    sized = [(prefix, vars(part), table) for prefix, part, table in parts if part is not None]
    sized.insert(1, ("", vars(ship) | {"speed": speed} | top, TOP))  # the hull is first, for L
    for prefix, values, table in sized:
        yield prefix, values, table, speed
    yield "open_water.", _open_water(ship), OPEN_WATER, speed
    for name, table in (("trial", TRIAL), ("propulsion", PROPULSION)):
        points: Sequence[Trial | PropulsionPoint] = (
            ship.trials if name == "trial" else ship.propulsion
        )
        for k, point in enumerate(points):
            yield f"{name}[{k}].", vars(point), table, point.speed


def _open_water(ship: Ship) -> dict[str, float]:
    """Ends of the data of an open-water table and the coefficients there, as its card has them."""
    card = ship.open_water.card if ship.open_water is not None else {}
    if not {"J_range", "K_T", "K_Q"} <= set(card):
        return {}
    low, high = card["J_range"]
    K_T, K_Q = (np.polyval(card["K_T"], [low, high]), np.polyval(card["K_Q"], [low, high]))
    found = {"J_low": low, "J_high": high, "K_T at J_low": K_T[0], "K_Q at J_low": K_Q[0]}
    found["K_T at J_high"] = K_T[1]
    if low != high:
        found["mean slope of K_T"] = (K_T[1] - K_T[0]) / (high - low)
    J = np.linspace(max(low, 0.0), high, 50) if low < high and high > 0.0 else np.empty(0)
    K_T, K_Q = np.polyval(card["K_T"], J), np.polyval(card["K_Q"], J)
    with np.errstate(divide="ignore", invalid="ignore"):
        useful = np.where(K_Q > 0.0, J * K_T / (2.0 * math.pi * K_Q), math.inf)[K_T > 0.0]
    if useful.size:
        found["largest efficiency"] = useful.max()
    return {name: float(value) for name, value in found.items()}


def findings_of(ship: Ship) -> Verdict:
    """All that is wrong with the numbers of a ship.

    A number, a section or a table of her that could not be read is None and passed over, and so
    are the limits that are shares of it. Of numbers by a number that is out of range, only what
    cannot be computed with is told: else one slip would be many findings.
    """
    found = Verdict([], [])
    bad: set[str] = set()
    for prefix, values, table, speed in values_of(ship):
        for name, allowed in table.items():
            if (value := values.get(name)) is not None:
                doubtful = bool(bad) and (
                    any(key in bad for key in _PARTS[allowed.by])
                    or ("U" in allowed.by and f"{prefix}speed" in bad)
                )
                if _look(found, ship, prefix + name, value, allowed, speed, doubtful):
                    bad.add(prefix + name)
    found.impossible.extend(_joint(ship))
    return found


def _look(
    found: Verdict, ship: Ship, key: str, value: float, allowed: Range, speed, doubtful: bool
) -> bool:
    """Add what is to be said about one number, by a basis that may be `doubtful`; if anything."""
    if allowed.endless and value == math.inf:
        return False
    usual = (allowed.low, allowed.high)
    unit = basis(ship, allowed.by, speed)
    if unit is None:  # its sign can be judged all the same
        if allowed.must not in (POSITIVE, NOT_NEGATIVE):
            return False
        allowed, usual, unit = Range(*allowed.must, must=allowed.must), allowed.must, 1.0
    if doubtful and ship.strict and allowed.must == usual:
        return False
    ratio = value / unit
    endless = math.isinf(value) and math.isfinite(allowed.high)
    if endless or not allowed.must[0] <= ratio <= allowed.must[1]:
        limits = usual if ship.strict else allowed.must
        found.impossible.append(_told(key, value, ratio, allowed.by, unit, limits))
    elif not doubtful and not usual[0] <= ratio <= usual[1]:
        found.implausible.append(_told(key, value, ratio, allowed.by, unit, usual))
    else:
        return False
    return True


_UNITS = {"full_length": "m", "rho": "kg/m3", "nu": "m2/s", "speed": "m/s", "hull.L": "m"}


def _told(key: str, value: float, ratio: float, by: str, unit: float, limits) -> str:
    """One finding: key, value in SI and by its basis, what is allowed in both."""
    si = BASES[by][0] or _UNITS.get(key, "")
    given = f"{key} = {value:.6g} {si}".rstrip()
    if not by:
        return f"{given}: allowed is {_limits(limits)} {si}".rstrip()
    if by.startswith("deg"):
        return f"{given} = {ratio:.4g} {by}: allowed is {_limits(limits)} {by}"
    allowed = _limits(limits, unit)
    return f"{given} = {ratio:.4g} {by}: allowed is {_limits(limits)} {by}, here {allowed} {si}"


def _limits(limits: tuple[float, float], unit: float = 1.0) -> str:
    """Limits in words, times `unit`."""
    low, high = (f"{x * unit:.4g}" for x in limits)
    if limits[0] == POSITIVE[0]:
        return f"above 0, at most {high}" if limits[1] < math.inf else "above 0"
    if limits[1] == math.inf:
        return f"{low} or more"
    return f"{high} or less" if limits[0] == -math.inf else f"{low} to {high}"


def _joint(ship: Ship) -> Iterator[str]:
    """What several numbers together make impossible; of numbers that were read."""
    for rule in (_mass, _water, _propellers, _form):
        try:
            line = rule(ship)
        except (AttributeError, TypeError, ArithmeticError):  # a number is missing
            continue
        if line:
            yield line


def _mass(ship: Ship) -> str:
    i = ship.inertia
    if min(i.m_u, i.m_v, i.I_r, i.m_v * i.I_r - i.m_xG**2) > 0.0 and math.isfinite(i.I_r):
        return ""
    return (
        f"hull.m_x = {ship.hull.m_x:.4g}, m_y = {ship.hull.m_y:.4g}, J_z = {ship.hull.J_z:.4g}, "
        f"k_zz = {ship.hull.k_zz:.4g} m: the mass matrix is not positive definite"
    )


def _water(ship: Ship) -> str:
    reynolds = ship.file_speed * ship.hull.L / ship.nu
    if reynolds >= _LEAST_REYNOLDS or min(ship.speed, ship.hull.L, ship.nu) <= 0.0:
        return ""
    return f"speed L / nu = {reynolds:.4g}: allowed is a Reynolds number of {_LEAST_REYNOLDS:g} up"


def _propellers(ship: Ship) -> str:
    if ship.propellers == 1 or ship.rudder.neutral == 0.0:
        return ""
    return (
        f"rudder.neutral = {ship.rudder.neutral:g} rad: allowed is 0 with two propellers, whose "
        "swirls mirror each other"
    )


def _form(ship: Ship) -> str:
    f: Any = ship.form
    if (f.b_transom > 0.0) != (f.a_transom > 0.0):
        return (
            f"form.b_transom = {f.b_transom:g}, form.a_transom = {f.a_transom:g}: a transom needs "
            "both, a pointed stern neither"
        )
    if len({x > 0.0 for x in (f.l_bulb, f.a_bulb, f.b_bulb)}) > 1:
        return (
            f"form.l_bulb = {f.l_bulb:g}, form.a_bulb = {f.a_bulb:g}, form.b_bulb = {f.b_bulb:g}: "
            "a bulb needs all three, a ship without one none"
        )
    return ""


def errors_of(ship: Ship, found: Verdict) -> list[str]:
    """What is an error of the findings of a ship, and the way out if there is one."""
    if found.impossible or not found.implausible or not ship.strict:
        return found.impossible + (found.implausible if ship.strict else [])
    return [*found.implausible, "if these numbers are meant: strict = false makes warnings of them"]


def checked(ship: Ship, where: str = "") -> Ship:
    """The ship, her implausible numbers named if she is not strict; without a warning.

    Parameters
    ----------
    ship : Ship
    where : str
        File for the messages; the ship's name if omitted.

    Raises
    ------
    ConfigError
        With a line for every number that cannot be computed with or, of a strict ship, that no
        ship has.
    """
    lines = list(_no_numbers(ship))
    if not lines:  # else nothing can be computed with
        found = findings_of(ship)
        lines = errors_of(ship, found)
    if lines:
        raise ConfigError("\n".join(f"{where or ship.name}: {line}" for line in lines))
    named = tuple(found.implausible)
    return ship if named == ship.implausible else dataclasses.replace(ship, implausible=named)


def _no_numbers(ship: Ship) -> Iterator[str]:
    """What of a ship made in Python is no number or no section; a file's is refused when read."""
    for key in TOP.keys() & vars(ship).keys() | {"share"}:
        yield from _no_number(key, getattr(ship, key))
    for name, table in RANGES.items():
        part = getattr(ship, name)
        if part is None and name in ("form", "wind"):
            continue
        if not dataclasses.is_dataclass(part):
            yield f"{name} = {shown(part)}: must be a section of numbers"
            continue
        for key in table:
            yield from _no_number(f"{name}.{key}", getattr(part, key, None))


def _no_number(key: str, value: Any) -> Iterator[str]:
    if not isinstance(value, int | float | np.integer | np.floating):
        yield f"{key} = {shown(value)}: must be a number"


def warn_of(ship: Ship, where: str) -> None:
    """Warn of a ship's implausible numbers, at the line of who called Ship Gym."""
    if not ship.implausible:
        return
    level, frame = 1, sys._getframe()
    while frame.f_back and frame.f_globals.get("__name__", "").startswith("ship_gym"):
        level, frame = level + 1, frame.f_back
    lines = "\n".join(f"  {line}" for line in ship.implausible)
    warnings.warn(f"{where} is not strict:\n{lines}", ImplausibleShip, stacklevel=level)
