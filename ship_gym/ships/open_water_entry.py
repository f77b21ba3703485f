"""Section ``open_water`` of a ship file to a table of C_T and C_Q over the advance angle."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, build, check_number, shown
from ship_gym.csv_file import read_csv
from ship_gym.provenance import sha256
from ship_gym.ships.b_series import b_series
from ship_gym.ships.four_quadrants import Screw, nearest_screw
from ship_gym.ships.open_water import open_water_table
from ship_gym.ships.ranges import OPEN_WATER
from ship_gym.ships.reader import Reader
from ship_gym.tables import Table

_MOST_COEFFICIENTS = 7  # of a polynomial in J
_COLUMNS = {"J": (-3.0, 3.0), "K_T": (-5.0, 5.0), "10K_Q": (-50.0, 50.0)}  # of any propeller


@dataclasses.dataclass(frozen=True)
class _Entry:
    """Section ``open_water`` of a ship file: points with a degree, or polynomials in J."""

    source: str = ""
    estimated: str = ""
    points: str | None = None
    degree: int = 3
    K_T: tuple[float, ...] = ()  # from the constant upwards
    K_Q: tuple[float, ...] = ()
    J_range: tuple[float, ...] = ()
    b_series: Screw | None = None
    four_quadrants: Screw | None = None  # outside the data; b_series, else the nearest, if omitted


def open_water(entry: Mapping[str, Any] | None, reader: Reader) -> Table | None:
    """Open-water table of a ship file: from points, from polynomials, or K_Q from the B-series.

    None if there is no entry or it cannot be used; `reader` then has a finding.
    """
    if entry is None:
        return None
    where = f"{reader.label}: open_water"
    with reader.findings.kept(where):
        e = build(_Entry, entry, where)
        card = {"source": e.source or reader.source}
        reader.sources["open_water"] = card["source"]
        if e.estimated:
            reader.estimated["open_water"] = e.estimated
        if not e.K_T and e.points is None:
            raise ConfigError(f"{where}: needs points = 'file.csv' or K_T with K_Q")
        made = _polynomials(e, where) if e.K_T else _fitted(e, where, reader.path.parent, card)
        K_T, K_Q, J_range = made
        return open_water_table(K_T, K_Q, J_range, _screw(e, K_T, J_range, reader), card)


def _polynomials(e: _Entry, where: str) -> tuple[np.ndarray, np.ndarray, tuple]:
    """K_T and K_Q, highest power first, and the range of J, of an entry with coefficients."""
    if len(e.J_range) != 2 or not (e.K_Q or e.b_series):
        raise ConfigError(f"{where}: K_T also needs J_range = [low, high] and K_Q or b_series")
    for name in ("K_T", "K_Q"):
        if len(getattr(e, name)) > _MOST_COEFFICIENTS:
            raise ConfigError(f"{where}.{name}: at most {_MOST_COEFFICIENTS} coefficients")
    _check_rising(f"{where}.J_range", e.J_range)
    K_T = np.array(e.K_T[::-1])
    if e.K_Q:
        return K_T, np.array(e.K_Q[::-1]), e.J_range
    assert e.b_series is not None
    J = np.linspace(e.J_range[0], e.J_range[1], 33)
    return K_T, np.polyfit(J, b_series(J, **dataclasses.asdict(e.b_series))[1], 3), e.J_range


def _fitted(e: _Entry, where: str, folder: Path, card: dict) -> tuple:
    """As `_polynomials`, fitted to the points of a file, which `card` then names."""
    check_number(f"{where}.degree", e.degree, 1, 6)
    assert e.points is not None
    path = folder / e.points
    if not path.is_file():
        raise ConfigError(f"{where}.points = {shown(e.points)}: no such file beside the ship file")
    points = read_csv(path).require(*_COLUMNS)
    for name, limits in _COLUMNS.items():
        for row, value in zip(points.rows, points.columns[name], strict=True):
            check_number(f"{path}:{row}: {name}", value, *limits)
    J, K_T, K_Q = (points.columns[name] for name in _COLUMNS)
    if len(set(J)) <= e.degree:
        raise ConfigError(f"{path}: {len(set(J))} different J, a fit needs more than the degree")
    card["points"] = {e.points: sha256(path)}
    J_range = (float(J.min()), float(J.max()))
    return np.polyfit(J, K_T, e.degree), np.polyfit(J, 0.1 * K_Q, e.degree), J_range


def _check_rising(where: str, J_range: tuple[float, float]) -> None:
    low, high = OPEN_WATER["J_low"].must[0], OPEN_WATER["J_high"].must[1]
    if not low <= J_range[0] < J_range[1] <= high:
        raise ConfigError(
            f"{where} = {shown(list(J_range))}: allowed is [low, high], low < high, within "
            f"{low:g} to {high:g}"
        )


def _screw(e: _Entry, K_T: np.ndarray, J_range, reader: Reader) -> Screw:
    """Series screw that stands for the propeller outside its open-water data, as an estimate."""
    screw = e.four_quadrants or e.b_series
    if screw is None:
        J = np.linspace(J_range[0], J_range[1], 33)
        screw = nearest_screw(J, np.polyval(K_T, J))
    reader.sources["open_water.four_quadrants"] = "Roddy, Hess & Faller (2006)"
    reader.estimated["open_water.four_quadrants"] = (
        f"outside the open-water data: Wageningen harmonics nearest to {screw.blades} blades, "
        f"P/D {screw.pitch_ratio:g}, AE/A0 {screw.area_ratio:g}"
    )
    return screw
