"""Values of the variables of a netCDF file in SI: units, directions, numbers that are finite."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, shown
from ship_gym.reading import read_as
from ship_gym.sea.measured_forms import LONGEST_R_1

_DEG = ("deg", "degree", "degrees", "degrees_true", "degree_true", "degreet")
_RAD = ("rad", "radian", "radians")
_HZ = ("hz", "hertz", "s-1", "1/s", "s^-1", "cycles/s")
_RAD_S = ("rad/s", "rad s-1", "radian/s", "radians/s", "rad s^-1")
_KNOWN_FROM = ("mean_wave_dir", "waveMeanDirection")
_WORDS = (("m", "m|met(er|re)s?"), ("s", "s|sec|seconds?|hz|hertz"), ("rad", "rad|radians?"),
          ("deg", "deg|degr|degrees?"))  # fmt: skip


def standard_name(variable: Any) -> str:
    """CF standard name of a variable, empty without."""
    return str(variable.attrs.get("standard_name", ""))


def unit_of(variable: Any, allowed: tuple[tuple[tuple[str, ...], float], ...]) -> float:
    """Factor to SI of a variable with one of some units."""
    given = variable.attrs.get("units")
    text = " ".join(str(given).lower().split())
    for names, factor in allowed:
        if text in names:
            return factor
    known = ", ".join(names[0] for names, _ in allowed)
    raise ConfigError(f"{variable.name}: units = {shown(given)}: allowed is {known}")


def angles(variable: Any) -> np.ndarray:
    """Angles [rad]."""
    return numbers(variable) * unit_of(variable, ((_DEG, math.pi / 180.0), (_RAD, 1.0)))


def bearings(variable: Any) -> np.ndarray:
    """Directions [rad]; refuse those of more than a full turn, such as 999 for a missing one."""
    found = angles(variable)
    for index in np.argwhere(np.abs(found) > 2.0 * math.pi + 1e-6):
        place, deg = ", ".join(map(str, index)), math.degrees(found[tuple(index)])
        raise ConfigError(
            f"{variable.name}[{place}] = {deg:.6g} deg: allowed is -360 to 360 deg; missing ones "
            "are nan or _FillValue"
        )
    return found


def check_r_1(name: object, values: np.ndarray) -> np.ndarray:
    """Refuse a length of a mean unit vector that is none; old NDBC files have a hundredfold."""
    for index in np.argwhere((values < 0.0) | (values > LONGEST_R_1)):
        place = ", ".join(map(str, index))
        raise ConfigError(f"{name}[{place}] = {values[tuple(index)]:.6g}: allowed is 0 to 1")
    return values


def frequencies(variable: Any) -> np.ndarray:
    """Frequencies [Hz]."""
    return numbers(variable) * unit_of(variable, ((_HZ, 1.0), (_RAD_S, 0.5 / math.pi)))


def numbers(variable: Any) -> np.ndarray:
    """Numbers of a variable, as they are; nan where they are missing."""
    if variable.dtype.kind not in "fiu":
        raise ConfigError(f"{variable.name} is of type {variable.dtype}: allowed are numbers")
    with read_as(str(variable.name), "numbers of a netCDF file"):
        return np.asarray(variable.values, dtype=float)


def density_factor(units: object, two: bool) -> float | None:
    """Factor from the unit of a density to m2/Hz, or m2/Hz/rad of a two-dimensional one; or None.

    Per hertz is also written as times a second.
    """
    text = str(units).lower()
    words = re.findall("[a-z]+", text)
    kinds = [next((k for k, form in _WORDS if re.fullmatch(form, w)), "?") for w in words]
    rad, deg = kinds.count("rad"), kinds.count("deg")
    square = kinds.count("m") == 2 or re.match(r"\W*[a-z]+\W*2", text)
    rate = re.search(r"/\s*s|s\W*-\W*1", text) and not rad  # m2/s is none
    if "?" in kinds or kinds[:1] != ["m"] or not square or "s" not in kinds or rate:
        return None
    of = (
        {(1, 0): 1.0, (0, 1): 180.0 / math.pi, (2, 0): 2.0 * math.pi}
        if two
        else {(0, 0): 1.0, (1, 0): 2.0 * math.pi}
    )
    return of.get((rad, deg))


def energy_of(variable: Any, two: bool) -> np.ndarray:
    """Numbers of the density in m2/Hz or m2/Hz/rad."""
    units = variable.attrs.get("units")
    factor = density_factor(units, two)
    if factor is None:
        allowed = "m2 s rad-1, m2/Hz/deg" if two else "m2/Hz, m2 s, m2 s rad-1 (per rad/s)"
        raise ConfigError(f"{variable.name}: units = {shown(units)}: allowed is {allowed}")
    return numbers(variable) * factor


def way_of(variable: Any, directions: str) -> str:
    """Whether directions are from or to."""
    if directions:
        return directions
    if str(variable.name) in _KNOWN_FROM:
        return "from"
    said = re.search(r"(from|to)_direction$", standard_name(variable))
    if said is None:
        raise ConfigError(
            f"{variable.name}: standard_name = {shown(variable.attrs.get('standard_name'))} does "
            "not say whether waves come from or go to it: give directions = 'from' or 'to'"
        )
    return said[1]


def check_finite(variable: Any, values: np.ndarray) -> None:
    """Refuse a value that is missing or infinite, with its place."""
    for index in np.argwhere(~np.isfinite(values)):
        place = ", ".join(map(str, index))
        raise ConfigError(
            f"{variable.name}[{place}] = {values[tuple(index)]}: allowed is a finite number"
        )
