"""Records of a free-running ship: track, heading, rudder and propeller speed over time.

Our own form starts as every data file does (``csv_file.read_csv``), has the columns ``t [s]``,
``x [m]`` (north), ``y [m]`` (east), ``psi [deg]``, ``delta [deg]`` (positive to starboard) and
``n [rpm]`` or ``n [rev/s]``, and may have a line ``# length: 320``, the ship's own [m]. The files
of MARIN's free-running tests of KVLCC2 (SIMMAN 2008) are known by their first line.
"""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np

from ship_gym.config import UNITS, ConfigError
from ship_gym.csv_file import read_csv
from ship_gym.identification.record_checks import check_record, start_of
from ship_gym.plain_csv import read_plain_csv
from ship_gym.reading import read_text
from ship_gym.reports.captive_file import own_length
from ship_gym.ships.particulars import Ship

_SI = {"t": "s", "x": "m", "y": "m", "psi": "rad", "delta": "rad", "n": "rev/s"}
COLUMNS = tuple(_SI)
_MARIN = {"t": "s", "x": "m", "y": "m", "psi": "deg", "delta": "deg", "n": "rpm"}
_MARIN_LENGTH = 320.0  # [m]; their rudder angle is positive to port
_STEP = 0.025  # [L / U0] between rows that are sailed
_LEAST = 20  # rows


@dataclasses.dataclass(frozen=True, eq=False)
class Record:
    """A record at the scale of the ship, in SI, from a start at t = 0.

    Attributes
    ----------
    path : str
    t, x, y, psi : numpy.ndarray
        Shape (m,); `psi` goes on beyond 180 deg.
    delta, n : numpy.ndarray
        Mean from each row to the next, shape (m,).
    time : float
        Of a ship length at the speed of the start [s].
    start : numpy.ndarray
        x, y [m], psi [rad], u, v [m/s], r [rad/s] at t = 0, by the first rows, shape (6,).
    covariance : numpy.ndarray
        Of `start`, shape (6, 6): how well the first rows tell it.
    """

    path: str
    t: np.ndarray
    x: np.ndarray
    y: np.ndarray
    psi: np.ndarray
    delta: np.ndarray
    n: np.ndarray
    time: float
    start: np.ndarray
    covariance: np.ndarray


def read_record(path: str | Path, ship: Ship) -> Record:
    """A record of a file, moved to the scale of a ship by Froude's law.

    Raises
    ------
    ConfigError
        Missing column, time that does not go on or has gaps, a record that is too short, or
        columns that do not go with each other.
    """
    marin = "free-running test at MARIN" in read_text(path).partition("\n")[0]
    length, columns = _marin(path) if marin else _own(path, ship)
    ratio = ship.hull.L / length
    c = {name: columns[name] for name in COLUMNS}
    if len(c["t"]) < _LEAST:
        raise ConfigError(f"{path}: {len(c['t'])} rows: allowed are {_LEAST} or more")
    if not (np.diff(c["t"]) > 0.0).all():
        row = int((np.diff(c["t"]) <= 0.0).argmax()) + 2
        raise ConfigError(f"{path}: t [s] in row {row}: must be later than in the row before")
    c["t"] = (c["t"] - c["t"][0]) * math.sqrt(ratio)
    c["x"], c["y"] = c["x"] * ratio, c["y"] * ratio
    c["psi"], c["n"] = np.unwrap(c["psi"]), c["n"] / math.sqrt(ratio)
    start, covariance = start_of(path, c, ship)
    check_record(path, c, start, ship)
    time = ship.hull.L / float(start[3])
    k = max(int(_STEP * time / np.median(np.diff(c["t"]))), 1)
    for name in ("delta", "n"):
        c[name] = _means(c["t"], c[name], k)
    t, x, y, psi = (c[name][::k] for name in COLUMNS[:4])
    return Record(str(path), t, x, y, psi, c["delta"], c["n"], time, start, covariance)


def _means(t: np.ndarray, values: np.ndarray, k: int) -> np.ndarray:
    """Mean of a history, straight between its rows, from each k-th row to the next."""
    area = np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(t))])
    return np.append(np.diff(area[::k]) / np.diff(t[::k]), values[-1])


def _own(path: str | Path, ship: Ship) -> tuple[float, dict[str, np.ndarray]]:
    data = read_csv(path).require(*COLUMNS)
    return own_length(data, ship), {name: data.si(name, unit) for name, unit in _SI.items()}


def _marin(path: str | Path) -> tuple[float, dict[str, np.ndarray]]:
    table = read_plain_csv(path)
    columns = {
        name: table.numbers(f"{name} [{unit}]") * UNITS[unit][0] for name, unit in _MARIN.items()
    }
    return _MARIN_LENGTH, columns | {"delta": -columns["delta"]}
