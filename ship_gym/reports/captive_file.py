"""Measured captive tests: our own CSV form, and the files of HMRI's tests of KVLCC2."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path

import numpy as np

from ship_gym.captive import AXES, PARTS, Condition
from ship_gym.config import ConfigError, check_number, shown
from ship_gym.csv_file import CsvTable, read_csv
from ship_gym.plain_csv import read_plain_csv
from ship_gym.reading import read_text
from ship_gym.ships.particulars import Ship

_NEEDED = ("speed", "n")
_SI = {"speed": "m/s", "n": "rev/s", "beta": "rad", "delta": "rad", "yaw_rate": "-", "sway": "-"}
_MOTIONS = ("beta", "delta", "yaw_rate", "sway", "frequency")
_CYCLES = {"1/s": 1.0, "Hz": 1.0, "rev/s": 1.0, "rad/s": 0.5 / math.pi}  # of a frequency
FORCES = (*AXES, *(f"{axis}_{part}" for axis in AXES for part in PARTS))
# what HMRI's files call them; forces follow by rule
_HMRI_NAMES = {"rps": "n", "r": "yaw_rate", "freq.": "frequency", "freq": "frequency"}
_COURSE = 60.0  # [deg] that the course of a swinging model may swing to either side
_HMRI_LENGTH = 320.0 / 46.426  # [m]
# words that are meant to be, and are not, that of the line with the length
_LENGTHS = ("l", "lpp", "l_pp", "lbp", "lwl", "l_wl", "model length", "scale", "scale ratio")


@dataclasses.dataclass(frozen=True)
class Measured:
    """One measured run at the scale of the ship, and its coefficients by 1/2 rho L d U^2.

    Attributes
    ----------
    condition : captive.Condition
    values : dict
        Names of `FORCES` to what was measured, as `captive.measure` gives them.
    """

    condition: Condition
    values: dict[str, float]


def read_measured(path: str | Path, ship: Ship) -> list[Measured]:
    """Measured runs of a file, moved to the scale of a ship by Froude's law.

    Our own form starts as every data file does (``csv_file.read_csv``) and may have a line
    ``# length: 6.893``, the model's own [m]. Its columns are ``speed [m/s]`` and ``n [rev/s]``,
    the motion (``beta [deg]``, ``delta [deg]``, ``yaw_rate [-]``, ``sway [-]``,
    ``frequency [1/s]``; one that is not there is zero) and coefficients by 1/2 rho L d U^2,
    moments by that times L: ``X [-]``, ``Y [-]``, ``N [-]``, thrust ``T [-]``, or their harmonics
    (``Y_out [-]``), signs as here. A file of HMRI's captive tests (SIMMAN 2014) is known by its
    first line.

    Raises
    ------
    ConfigError
        Unknown column, one that is missing, or a value out of range; with file and line.
    """
    text = read_text(path)
    hmri = "captive tests in deep water at HMRI" in text.partition("\n")[0]
    length, rows = _hmri(path, ship) if hmri else _own(path, ship)
    root = math.sqrt(ship.hull.L / length)
    return [_measured(path, line, row, root, ship.hull.L) for line, row in rows]


def _measured(
    path: str | Path, line: int, row: Mapping[str, float], root: float, L: float
) -> Measured:
    """One run from its columns in SI; `root` is that of the ratio of lengths, ship by model."""
    motion = {key: row.get(key, 0.0) for key in ("beta", "delta", "yaw_rate", "sway")}
    omega = 2.0 * math.pi * row.get("frequency", 0.0) / root
    try:
        run = Condition(row["speed"] * root, row["n"] / root, omega=omega, **motion)
    except ConfigError as error:
        raise ConfigError(f"{path}:{line}: {error}") from None
    _check_kind(f"{path}:{line}", run, [key for key in row if key in FORCES], L)
    return Measured(run, {key: row[key] for key in FORCES if key in row})


def _check_kind(where: str, run: Condition, names: Sequence[str], L: float) -> None:
    """Refuse harmonics of a steady run, the reverse, and a course that swings too far."""
    swings = run.omega > 0.0
    if wrong := [name for name in names if (name in AXES) == swings]:
        steady = "harmonics are of a swinging model: needs a 'frequency [1/s]' above zero"
        told = "a swinging model has harmonics, as in 'Y_out [-]'" if swings else steady
        raise ConfigError(f"{where}: {wrong[0]}: {told}")
    if swings:
        course = abs(run.yaw_rate) * run.speed / (L * run.omega)
        what = f"{where}: course angle by yaw_rate and frequency"
        check_number(what, math.degrees(course), 0.0, _COURSE, "deg")


def _own(path: str | Path, ship: Ship) -> tuple[float, list[tuple[int, dict[str, float]]]]:
    """Length of the model and rows of a file of our own form."""
    data = read_csv(path).require(*_NEEDED)
    known = (*_NEEDED, *_MOTIONS, *FORCES)
    given = [name for name in data.columns if name in data.units or name in known]
    for name in given:
        if name not in known:
            allowed = ", ".join((*_NEEDED, *_MOTIONS))
            raise ConfigError(
                f"{path}: unknown column {shown(name)}; allowed are {allowed}, X, Y_out, ..."
            )
    if not any(name in FORCES for name in given):
        raise ConfigError(f"{path}: no column of a force, as in 'Y [-]'")
    columns = {
        n: _frequency(data) if n == "frequency" else data.si(n, _SI.get(n, "-")) for n in given
    }
    return own_length(data, ship), _as_rows(data.rows, columns)


def own_length(data: CsvTable, ship: Ship) -> float:
    """Length of what was tested [m]: of the line ``# length: 6.9``, else the ship's.

    Raises
    ------
    ConfigError
        A line that looks as if it were meant, but would be passed over.
    """
    for key in data.header:
        word = key.partition("[")[0].strip()
        if key != "length" and (
            word in _LENGTHS or get_close_matches(word, ["length"], cutoff=0.8)
        ):
            raise ConfigError(f"{data.path}: '# {key}: ...': write '# length: 6.9', in m")
    length = data.number("length") if "length" in data.header else ship.hull.L
    return check_number(f"{data.path}: length", length, 0.1, 1000.0, "m")


def _frequency(data: CsvTable) -> np.ndarray:
    """Cycles in a second; 1/s is no unit of a ship file."""
    unit = data.units.get("frequency", "")
    if unit not in _CYCLES:
        allowed = ", ".join(f"[{one}]" for one in _CYCLES)
        where = f"{data.path}:{data.title_row}: column 'frequency'"
        raise ConfigError(f"{where} has unit [{unit}]; allowed is {allowed}")
    return data.columns["frequency"] * _CYCLES[unit]


def _hmri(path: str | Path, ship: Ship) -> tuple[float, list[tuple[int, dict]]]:
    """Length of the model and rows of a file of HMRI.

    There coefficients are by 1/2 rho L^2 U^2 and the rudder's positive angle turns to port. The
    means over a period are left out: they are some forty times smaller than those of static tests.
    The files do not say about which point the moment is; midship is taken, as static drift at 4 to
    9 deg fits best. Their model has k_zz 0.253 L, the ship file 0.25 L.
    """
    table = read_plain_csv(path)
    columns = {_hmri_name(title): table.numbers(title) for title in table.columns}
    if len(columns) != len(table.columns):
        raise ConfigError(f"{path}: two columns have one meaning")
    for name in _NEEDED:
        if name not in columns:
            raise ConfigError(f"{path}: no column {name!r}: no captive test")
    if "vdot" in columns:  # by U^2 / L, of v = v' U cos(omega t)
        omega = 2.0 * math.pi * columns["frequency"] * _HMRI_LENGTH / columns["speed"]
        columns["sway"] = -columns["vdot"] / omega
    for name in columns:
        if name in FORCES:
            columns[name] = columns[name] * ship.hull.L / ship.hull.d
    for name, sign in (("beta", 1.0), ("delta", -1.0)):
        if name in columns:
            columns[name] = np.radians(sign * columns[name]) + 0.0  # never -0
    kept = {name: v for name, v in columns.items() if not name.endswith("_mean")}
    return _HMRI_LENGTH, _as_rows(np.array(table.lines), kept)


def _hmri_name(title: str) -> str:
    """A column of HMRI under the name it has here; ``RX`` and ``RY``, of the rudder, stay."""
    name = title.strip().removesuffix("'").partition("(")[0]
    if name in FORCES or name == "TX":
        return "T" if name == "TX" else name
    return _HMRI_NAMES.get(name.lower(), name.lower())


def _as_rows(lines: np.ndarray, columns: Mapping[str, np.ndarray]) -> list[tuple[int, dict]]:
    rows = zip(*(values.tolist() for values in columns.values()), strict=True)
    return [
        (int(k), dict(zip(columns, row, strict=True))) for k, row in zip(lines, rows, strict=True)
    ]
