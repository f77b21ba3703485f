"""Checks of each line of a user's samples, before anything is fitted."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from ship_gym.config import ConfigError, check_known, nearest
from ship_gym.csv_file import CsvTable

# Largest size that a propeller or rudder can have: thrust of a stopped ship is below 1, a stalled
# plate or a foil stays below 2 by the speed in the race.
LARGEST = {"K_T": 2.0, "K_X": 2.0, "10K_Q": 3.0, "K_S": 1.0, "C_Fx": 3.0, "C_Fy": 3.0, "C_Mz": 3.0}
UNITS = {
    "point": ("-",),
    "J": ("-",),
    "beta": ("deg", "rad"),
    "abs(beta)": ("deg", "rad"),
    "delta": ("deg", "rad"),
    **dict.fromkeys(LARGEST, ("-",)),
    **dict.fromkeys((f"{name} std" for name in LARGEST), ("-",)),
}
TEXTS = ("grid", "turbulence", "side", "set")
LARGEST_J = 3.0
SETS = ("training", "validation")
_DEGREES = "; looks like degrees"


def lines(rows: np.ndarray) -> str:
    """``line 7`` or ``lines 7, 9``."""
    numbers = ", ".join(str(int(row)) for row in rows)
    return f"line {numbers}" if len(rows) == 1 else f"lines {numbers}"


def side_signs(C_Fy: np.ndarray, sign: float) -> np.ndarray:
    """+1 where the rudder pushes the stern outwards of the turn, as it should, else -1 or 0."""
    return np.sign(sign * C_Fy)


def check_columns(rows: CsvTable, path: Path) -> tuple[str, str]:
    """Check names and units of the columns; give the names of drift and axial force.

    Raises
    ------
    ConfigError
        Missing or unknown column, or a unit that is not allowed, with the line of titles.
    """
    where = f"{path}:{rows.title_row}"
    for name in rows.columns:
        if name not in UNITS and name not in TEXTS:
            raise ConfigError(f"{where}: unknown column {name!r};{nearest(name, (*UNITS, *TEXTS))}")
        allowed = UNITS.get(name, ())
        if allowed and rows.units.get(name) not in allowed:
            given = f"unit [{rows.units[name]}]" if name in rows.units else "no unit"
            raise ConfigError(
                f"{where}: column {name!r} has {given}; allowed is "
                + " or ".join(f"'{name} [{unit}]'" for unit in allowed)
            )
        if not allowed and name in rows.units:
            raise ConfigError(f"{where}: column {name!r} holds names and takes no unit")
    beta, thrust = (
        _one_of(rows, names, where) for names in (("beta", "abs(beta)"), ("K_T", "K_X"))
    )
    for name in rows.columns:
        if name.removesuffix(" std") not in rows.columns:
            raise ConfigError(f"{where}: column {name!r} without {name.removesuffix(' std')!r}")
    for name in ("point", "J", "C_Fx", "C_Fy"):
        if name not in rows.columns:
            raise ConfigError(f"{where}: no column {name!r};{nearest(name, rows.columns)}")
    for name in set(rows.columns["set"]) if "set" in rows.columns else ():
        check_known(f"set in {path}", name, SETS)
    return beta, thrust


def _one_of(rows: CsvTable, names: tuple[str, str], where: str) -> str:
    there = [name for name in names if name in rows.columns]
    if len(there) != 1:
        raise ConfigError(f"{where}: needed is one of the columns {' and '.join(map(repr, names))}")
    return there[0]


def check_rows(rows: CsvTable, beta: str, sign: float) -> None:
    """Check every number, then that no point is there twice and that the turn has the right side.

    Parameters
    ----------
    rows : CsvTable
        With the right columns.
    beta : str
        Column of the drift angle.
    sign : float
        Factor of side forces to a turn to starboard in axes with y to port.

    Raises
    ------
    ConfigError
        With file and line.
    """
    point, drift = rows.columns["point"], rows.si(beta)
    _refuse(rows, "point", point % 1.0 != 0.0, "must be a whole number")
    J = rows.columns["J"]
    _refuse(
        rows, "J", ~((J > 0.0) & (J <= LARGEST_J)), f"allowed is above 0, at most {LARGEST_J:g}"
    )
    hint = _DEGREES if rows.units[beta] == "rad" else ""
    _refuse(rows, beta, np.abs(drift) > 0.5 * math.pi, f"allowed is at most 90 deg{hint}")
    for name in LARGEST.keys() & rows.columns.keys():
        too_large = np.abs(rows.columns[name]) > LARGEST[name]
        _refuse(rows, name, too_large, f"physical is at most {LARGEST[name]:g}")
        if (std := f"{name} std") in rows.columns:
            _refuse(rows, std, ~(rows.columns[std] > 0.0), "a standard deviation is above 0")
    _check_repeats(rows, drift)
    if "delta" in rows.columns:
        delta, hint = rows.si("delta"), _DEGREES if rows.units["delta"] == "rad" else ""
        outside = (delta < 0.0) | (delta > 0.5 * math.pi)
        _refuse(rows, "delta", outside, f"allowed is 0 to 90 deg{hint}")
    _check_turn(rows, beta, sign)


def _check_turn(rows: CsvTable, beta: str, sign: float) -> None:
    """The rudder that is over most turns the ship to its side, and the stern swings outwards."""
    several, drift = "delta" in rows.columns, rows.si(beta)
    over = rows
    if several:
        over = rows.select(rows.columns["delta"] == rows.columns["delta"].max())
    sides = side_signs(over.columns["C_Fy"], sign)
    if np.median(sides) < 0.0:
        raise ConfigError(
            f"{rows.path}: {lines(over.rows[sides < 0.0])}: C_Fy has the sign of a turn to the "
            "other side; say '# turn: port', or '# side force: starboard', if that is what the "
            "samples are"
        )
    # of several rudder angles drift to either side is wanted, but not to the wrong one alone
    if drift.min() < 0.0 and (drift.max() <= 0.0 if several else np.median(drift) < 0.0):
        raise ConfigError(
            f"{rows.path}: {lines(rows.rows[drift < 0.0])}: {beta} is negative; it is positive "
            "where the stern swings outwards of the turn: turn its sign, or use abs(beta)"
        )


def _refuse(rows: CsvTable, name: str, wrong: np.ndarray, allowed: str) -> None:
    """ConfigError with the first line that is wrong."""
    for i in np.flatnonzero(wrong):
        value, unit = rows.columns[name][i], rows.units[name]
        raise ConfigError(f"{rows.path}:{rows.rows[i]}: {name} = {value:g} [{unit}]: {allowed}")


def _check_repeats(rows: CsvTable, drift: np.ndarray) -> None:
    """A point has one place; on a grid, side and angle it is there once, a place has one value."""
    names = sorted(LARGEST.keys() & rows.columns.keys())
    values = np.column_stack([rows.columns[name] for name in names])
    apart = (*TEXTS[:3], "delta")
    keys = [rows.columns[name].tolist() for name in apart if name in rows.columns]
    cases = list(zip(*keys, strict=True)) if keys else [()] * len(rows.rows)
    at: dict[float, tuple] = {}
    seen: dict[tuple, int] = {}  # point or place, with side and grid, to its first row
    for i, case in enumerate(cases):
        number, line = rows.columns["point"][i], int(rows.rows[i])
        place = (float(rows.columns["J"][i]), float(drift[i]))
        first_place, first_line = at.setdefault(number, (place, line))
        where, name = f"{rows.path}:{line}", f"point {number:g}"
        if place != first_place:
            raise ConfigError(f"{where}: {name} is at another J or drift in line {first_line}")
        k = seen.setdefault((*case, place), i)
        if (values[k] != values[i]).any():
            raise ConfigError(f"{where}: {name} has other values in line {rows.rows[k]}")
        k = seen.setdefault((*case, number), i)
        if k != i:
            raise ConfigError(f"{where}: {name} is in line {rows.rows[k]} already: delete one")
