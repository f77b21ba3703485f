"""A user's own samples: a csv file, checked line by line, read as a `DataSet`.

Exports of a spreadsheet are read as they are (``csv_file``). The file starts with the four lines
``# title:``, ``# source:``, ``# obtained:``, ``# conventions:`` and may add

- ``# turn: port`` if the ship turns to port in the samples (default ``starboard``);
- ``# side force: starboard`` if C_Fy and K_S are positive to starboard (default ``port``);
- ``# delta_deg: 35``, size of the rudder angle [deg] (default: the largest of the ship).

Then a row of column names with units, and one row for each point:

- ``point [-]`` whole number; ``J [-]`` = u/(n D) of the ship's speed, above 0, at most 3;
- ``beta [deg]`` or ``beta [rad]`` drift angle at propeller and rudder, positive in a turn to
  starboard; ``abs(beta) [deg]`` is read alike, and is what a turn to port needs; some may be
  negative;
- ``delta [deg]`` or ``[rad]``, optional: rudder angle into the turn, where the samples have
  several; the file is then one scattered set or one plane for each angle, see ``rudder_angles``;
- ``K_T [-]``, or ``K_X [-]`` along the ship's axis; ``10K_Q [-]`` and ``K_S [-]`` may be absent;
- ``C_Fx [-]`` forward and ``C_Fy [-]`` to the side: force on the rudder alone over
  1/2 rho u_R^2 A_R, with A_R the ship's rudder area and u_R^2 = u^2 (1 + 8 K_T/(pi J^2)) + v^2;
- ``K_T std [-]`` and so on, optional: the standard deviation of each value, for a Gaussian process
  with ``noise = "given"``;
- without a unit, all optional: ``grid``, ``turbulence`` (names), ``set`` (``training`` or
  ``validation``), and for two propellers ``side`` (``leeward`` or ``windward``, or ``port`` and
  ``starboard``). The port propeller is to leeward in a turn to port. The first grid in the file is
  the default; a process may build on another one, cheap and at more points.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from ship_gym.config import ConfigError, check_known, check_number
from ship_gym.csv_file import CsvTable, read_csv
from ship_gym.ships.files import Named
from ship_gym.ships.loader import bare
from ship_gym.ships.particulars import Ship
from ship_gym.surrogates.row_checks import check_columns, check_rows, lines
from ship_gym.surrogates.samples import LEEWARD, SINGLE, WINDWARD, DataSet

SAME_ANGLE = math.radians(0.01)


def own_data_set(
    path: str | Path,
    ship: Named | Ship,
    *,
    delta_deg: float | None = None,
    validation: tuple[int, ...] = (),
) -> DataSet:
    """Read a user's samples; the columns are described at the top of this module.

    Parameters
    ----------
    path : path-like
    ship : Ship, or its name or file
        The ship they belong to.
    delta_deg : float, optional
        Size of the rudder angle [deg]; that of the file, else the ship's largest, if omitted. Of a
        file with several angles the samples of this one; all of them, if omitted.
    validation : tuple of int
        Points to hold out, if the file has no column ``set``.

    Returns
    -------
    DataSet
        Its box is the range of the samples.

    Raises
    ------
    ConfigError
        With file and line: a wrong or missing unit or column, a number that is none or beyond the
        physical range, a point that is there twice, or a turn to the other side.
    """
    path, ship = Path(path), bare(ship)
    rows = read_csv(path)
    beta, thrust = check_columns(rows, path)
    turn = check_known(
        f"turn in {path}", rows.header.get("turn", "starboard"), ("port", "starboard")
    )
    positive = rows.header.get("side force", "port")
    check_known(f"side force in {path}", positive, ("port", "starboard"))
    to_port = (turn == "port") != (positive == "starboard")
    check_rows(rows, beta, -1.0 if to_port else 1.0)
    rows, angles = _at_angles(rows, delta_deg)
    choices = _choices(rows)
    held = _held_out(rows, validation)
    mine = _of_choice(rows, choices[0] if choices else ("", ""))
    points = np.unique(mine.columns["point"])
    fitted = mine.select(~np.isin(mine.columns["point"], sorted(held)))
    if not len(fitted.rows):
        raise ConfigError(f"{path}: all points are held out; at least some must be in training")
    quantities = (thrust, "10K_Q", "K_S", "C_Fx", "C_Fy")
    return DataSet(
        name=path.stem,
        ship=ship.name,
        path=path,
        delta=max(angles) if angles else _delta(rows, ship, delta_deg),
        thrust=thrust,
        quantities=tuple(q for q in quantities if q in rows.columns),
        sides=_sides(rows, ship, turn),
        box=(*_range(fitted.si("J")), *_range(fitted.si(beta))),
        training=tuple(int(p) for p in points if p not in held),
        validation=tuple(int(p) for p in points if p in held),
        to_port=to_port,
        choices=choices,
        angles=angles,
    )


def _range(x: np.ndarray) -> tuple[float, float]:
    return float(x.min()), float(x.max())


def _at_angles(rows: CsvTable, delta_deg: float | None) -> tuple[CsvTable, tuple[float, ...]]:
    """Rows of the rudder angle asked for, or all, and the angles in them [rad]."""
    if "delta" not in rows.columns:
        return rows, ()
    delta = rows.si("delta")
    there = np.unique(delta)
    if delta_deg is not None:
        there = there[np.abs(there - math.radians(delta_deg)) < SAME_ANGLE]
        if not len(there):
            found = ", ".join(f"{math.degrees(a):g}" for a in np.unique(delta))
            raise ConfigError(f"{rows.path}: delta_deg = {delta_deg:g}: the samples have {found}")
    if not there.max() > 0.0:
        raise ConfigError(f"{rows.path}: delta = 0: a surrogate needs the rudder over")
    return rows.select(np.isin(delta, there)), tuple(there.tolist())


def _delta(rows: CsvTable, ship: Ship, delta_deg: float | None) -> float:
    """Size of the rudder angle [rad]."""
    if delta_deg is None and "delta_deg" in rows.header:
        delta_deg = rows.number("delta_deg")
    if delta_deg is None:
        return ship.gear.delta_max
    return math.radians(check_number("delta_deg", delta_deg, 1.0, 90.0, "deg"))


def _sides(rows: CsvTable, ship: Ship, turn: str) -> dict[str, str]:
    """Propeller and rudder to their name in the column ``side``."""
    there = set(rows.columns["side"]) if "side" in rows.columns else set()
    if ship.propellers == 1:
        if len(there) > 1:
            raise ConfigError(f"{rows.path}: sides {sorted(there)}, but {ship.name} has one rudder")
        return {SINGLE: ""}
    away = {"port": "starboard", "starboard": "port"}[turn]
    for names in ((LEEWARD, WINDWARD), (turn, away)):
        if there == set(names):
            return dict(zip((LEEWARD, WINDWARD), names, strict=True))
    raise ConfigError(
        f"{rows.path}: column side has {sorted(there)}; {ship.name} has two propellers: needed are "
        "leeward and windward, or port and starboard"
    )


def _choices(rows: CsvTable) -> tuple[tuple[str, str], ...]:
    """Grids and turbulence models in the order of the file."""
    blank = np.full(len(rows.rows), "")
    columns = [rows.columns.get(name, blank) for name in ("grid", "turbulence")]
    found = dict.fromkeys(zip(*(column.tolist() for column in columns), strict=True))
    return tuple(found) if set(found) != {("", "")} else ()


def _of_choice(rows: CsvTable, choice: tuple[str, str]) -> CsvTable:
    conditions = dict(zip(("grid", "turbulence"), choice, strict=True))
    return rows.where(**{name: value for name, value in conditions.items() if value})


def _held_out(rows: CsvTable, validation: tuple[int, ...]) -> set[int]:
    """Points held out, from the column ``set`` or the argument."""
    there = set(rows.columns["point"].astype(int).tolist())
    if "set" not in rows.columns:
        if unknown := sorted(set(validation) - there):
            raise ConfigError(f"{rows.path}: no points {unknown} to hold out")
        return set(validation)
    if validation:
        raise ConfigError(f"{rows.path}: it has a column 'set'; no other validation points allowed")
    out = rows.where(set="validation")
    held = set(out.columns["point"].astype(int).tolist())
    both = held & set(rows.where(set="training").columns["point"].astype(int).tolist())
    if both:
        where = np.isin(rows.columns["point"], sorted(both))
        raise ConfigError(
            f"{rows.path}: {lines(rows.rows[where])}: points {sorted(both)} are in both sets"
        )
    return held
