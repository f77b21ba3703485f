"""Time histories of MARIN's free-running KVLCC2 (SIMMAN 2008), where a folder holds them.

The files are not part of the package. They are of full scale, `marin_free_turn_DEG.csv` and
`marin_free_zigzag_DEG.csv`; their rudder angle, and so DEG, is positive to port, all else as here.
"""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.plain_csv import read_plain_csv
from ship_gym.reports.case import Case
from ship_gym.ships.particulars import Ship

SHIPS = ("kvlcc2", "kvlcc2_model")
SOURCE = "MARIN, free-running model at 15.5 kn full scale, SIMMAN 2008"
_COLUMNS = ("t [s]", "x [m]", "y [m]", "psi [deg]", "u [m/s]", "v [m/s]", "delta [deg]")
_PREFIX = {"turning_circle": "turn", "zigzag": "zigzag"}
_MOVED = 1.0  # deg of rudder that are no noise
_LARGEST = 90.0  # deg of rudder


@dataclasses.dataclass(frozen=True)
class History:
    """A manoeuvre over time, from the order of the rudder on; axes of the approach course.

    Attributes
    ----------
    t : numpy.ndarray
        Full scale [s].
    x, y : numpy.ndarray
        Ahead and to starboard [L].
    psi, delta : numpy.ndarray
        Heading and rudder, positive to starboard [rad].
    speed : numpy.ndarray
        Over the approach speed.
    """

    t: np.ndarray
    x: np.ndarray
    y: np.ndarray
    psi: np.ndarray
    delta: np.ndarray
    speed: np.ndarray


def find_trials(folder: str | Path | None = None) -> Path | None:
    """Folder of the histories: the one given, or that beside a checkout; None without.

    Raises
    ------
    ConfigError
        A folder is given and has none.
    """
    checkout = Path(__file__).parents[2]
    asked = checkout.parent / "shared" / "reference" if folder is None else Path(folder)
    for place in (asked, asked / "kvlcc2"):
        if any(place.glob("marin_free_*.csv")):
            return place
    if folder is not None:
        raise ConfigError(
            f"trials = {folder}: no files marin_free_*.csv in it, nor in its folder kvlcc2"
        )
    return None


def measured_history(case: Case, folder: Path | None) -> History | None:
    """What was measured in the manoeuvre that was sailed; None where nothing was."""
    if folder is None or case.ship.name not in SHIPS or case.sea != "calm":
        return None
    delta, psi = (round(math.degrees(angle)) for angle in (case.delta, case.psi))
    if case.manoeuvre == "zigzag" and delta != psi:
        return None
    path = folder / f"marin_free_{_PREFIX[case.manoeuvre]}_{-delta}.csv"
    if not path.is_file():
        return None
    found = read_history(path, case.ship)
    return _while_over(found) if case.manoeuvre == "turning_circle" else found


def _while_over(history: History) -> History:
    """A turning circle until its rudder is put back."""
    over = np.abs(history.delta) >= np.abs(history.delta).max() - math.radians(_MOVED)
    end = len(over) - int(np.argmax(over[::-1]))
    return History(*(getattr(history, f.name)[:end] for f in dataclasses.fields(history)))


def read_history(path: Path, ship: Ship) -> History:
    """A file of measured values.

    Time and place count from when the rudder begins to move. Headings stay those of the file, of
    which 0 is the approach course: reversals were ordered by them.

    Raises
    ------
    ConfigError
        A column is missing, a cell is no number, or the rudder does not move.
    """
    table = read_plain_csv(path)
    t, x, y, psi, u, v, delta = (table.numbers(name) for name in _COLUMNS)
    if late := [line for line, step in zip(table.lines[1:], np.diff(t), strict=True) if step <= 0]:
        raise ConfigError(f"{path}:{late[0]}: {_COLUMNS[0]} does not rise")
    moved = np.flatnonzero(np.abs(delta - delta[0]) > _MOVED)
    if len(moved) == 0 or moved[0] + 1 == len(t):
        raise ConfigError(f"{path}: the rudder does not move")
    if (far := np.abs(delta) > _LARGEST).any():
        i = int(far.argmax())
        raise ConfigError(
            f"{path}:{table.lines[i]}: {_COLUMNS[-1]} = {delta[i]:g}: allowed is -{_LARGEST:g} to "
            f"{_LARGEST:g} [deg]"
        )
    k = moved[0]
    rate = (delta[k + 1] - delta[k]) / (t[k + 1] - t[k])
    # of a rudder that is over within one row, the row before
    order = t[k] - (delta[k] - delta[0]) / rate if rate else t[k - 1]
    x, y = x - np.interp(order, t, x), y - np.interp(order, t, y)
    L, after = ship.full_length, t >= order
    speed = np.hypot(u, v)
    if not (approach := speed[: max(k, 1)].mean()):
        raise ConfigError(f"{path}: the ship lies still before the rudder moves")
    speed /= approach
    found = History(t - order, x / L, y / L, np.radians(psi), -np.radians(delta), speed)
    return History(*(getattr(found, field.name)[after] for field in dataclasses.fields(found)))


def computed_history(case: Case) -> History:
    """The same of a manoeuvre that was sailed."""
    c, L = case.result.trajectory, case.ship.hull.L
    return History(
        c["t"] * case.ship.time_unit, c["x"] / L, c["y"] / L, c["psi"], c["delta"],
        np.hypot(c["u"], c["v"]) / case.speed,
    )  # fmt: skip


def difference(computed: History, measured: History) -> dict[str, float]:
    """How far two histories are apart over the time that both have, of a circle the first turn.

    Returns
    -------
    dict
        ``time`` compared [s], ``heading`` rms [deg], ``track`` rms distance [L], ``speed`` rms.
    """
    turned = np.flatnonzero(np.abs(measured.psi) >= 2.0 * math.pi)
    last = measured.t[turned[0]] if len(turned) else measured.t[-1]
    end = min(computed.t[-1], last)
    t = measured.t[measured.t <= end]

    def apart(name: str) -> np.ndarray:
        ours = np.interp(t, computed.t, getattr(computed, name))
        return ours - np.interp(t, measured.t, getattr(measured, name))

    square = apart("x") ** 2 + apart("y") ** 2
    return {
        "time": float(end),
        "heading": math.degrees(math.sqrt(np.mean(apart("psi") ** 2))),
        "track": math.sqrt(np.mean(square)),
        "speed": math.sqrt(np.mean(apart("speed") ** 2)),
    }
