"""How a record begins, and whether its columns go with each other."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ship_gym.config import ConfigError, check_number, told_of
from ship_gym.ships.particulars import Ship
from ship_gym.simulation import self_propulsion

EVERY = 0.5  # [L / U] of time between the rows that are compared
_SHORTEST = 4  # of those rows
_START = (0.2, 0.4, 0.8, 1.6)  # [L / U0] over which the motion at the start is measured
_TOLD = 0.05  # of U: standard deviation of a velocity that is told well enough
_FEWEST = 6  # rows for it
_SURE = 1e-6  # of L, U and a radian: no record tells its start better
_TURNED = math.radians(5.0)  # of heading, in all, from which its sign can be told
_SLOPE = (0.5, 2.0)  # of course over heading
_BEYOND = math.radians(5.0)  # of the gear's limit that a rudder may be measured
_PULL = 3.0  # n at the start by that of self-propulsion, or the inverse


def start_of(
    path: str | Path, c: Mapping[str, np.ndarray], ship: Ship
) -> tuple[np.ndarray, np.ndarray]:
    """x, y, psi, u, v, r at the first row, and their covariance, shapes (6,) and (6, 6).

    By parabolas through the first rows; how far those are off the parabolas tells how sure it is.
    Of a noisy track more rows are taken.
    """
    for window in _START:
        first = c["t"] <= max(window * ship.hull.L / ship.speed, float(c["t"][_FEWEST - 1]))
        at, spread = _parabolas(c, first)
        if math.sqrt(spread[3, 3] + spread[4, 4]) < _TOLD * ship.speed:
            break
    cos, sin = math.cos(at[2]), math.sin(at[2])
    body = np.eye(6)
    body[3:5, 3:5] = [[cos, sin], [-sin, cos]]
    start = body @ at
    low, high = 0.05 * ship.speed, 3.0 * ship.speed
    what = f"{path}: speed ahead at the start (x north, y east, psi clockwise from north)"
    check_number(what, float(start[3]), low, high, "m/s")
    L, U = ship.hull.L, ship.speed
    least = _SURE * np.array([L, L, 1.0, U, U, U / L])
    return start, body @ spread @ body.T + np.diag(least**2)


def _parabolas(c: Mapping[str, np.ndarray], rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """x, y, psi and their rates at t = 0, shape (6,), and the covariance."""
    at, spread = np.zeros(6), np.zeros((6, 6))
    for i, name in enumerate(("x", "y", "psi")):
        found, covariance = np.polyfit(c["t"][rows], c[name][rows], 2, cov=True)
        own = [i, 3 + i]
        at[own], spread[np.ix_(own, own)] = found[[2, 1]], covariance[np.ix_([2, 1], [2, 1])]
    return at, spread


def check_record(
    path: str | Path, c: Mapping[str, np.ndarray], start: np.ndarray, ship: Ship
) -> None:
    """Refuse gaps, a record that is too short, and columns that do not go with each other."""
    time = ship.hull.L / float(start[3])
    steps = np.diff(c["t"])
    if (steps > EVERY * time).any():
        row = int(steps.argmax()) + 2
        raise ConfigError(
            f"{path}: a gap of {steps.max() / time:.3g} ship lengths before row {row}: allowed "
            f"are {EVERY}; cut the record there"
        )
    if len(compared(c["t"], time)) < _SHORTEST:
        raise ConfigError(
            f"{path}: {c['t'][-1] / time:.3g} ship lengths: allowed are {EVERY * _SHORTEST:.3g} "
            "or more"
        )
    most = ship.gear.delta_max + _BEYOND
    if (far := float(np.abs(c["delta"]).max())) > most:
        check_number(f"{path}: largest delta", math.degrees(far), 0.0, math.degrees(most), "deg")
    _check_heading(path, c, time)
    _check_propeller(path, float(c["n"][0]), float(start[3]), ship)


def compared(t: np.ndarray, time: float) -> np.ndarray:
    """Rows that are compared: one in `EVERY` of `time`, without the start, where all agree."""
    wanted = np.arange(EVERY * time, t[-1] * (1.0 + 1e-9), EVERY * time)
    at = np.unique(np.searchsorted(t, wanted * (1.0 - 1e-9)))
    return at[at < len(t)]


def _check_heading(path: str | Path, c: Mapping[str, np.ndarray], time: float) -> None:
    """The course of x and y turns as psi does; a drift angle changes that by little."""
    at = np.concatenate([[0], compared(c["t"], time)])
    dx, dy = (c[name][at[2:]] - c[name][at[:-2]] for name in ("x", "y"))
    course, psi = np.unwrap(np.arctan2(dy, dx)), c["psi"][at[1:-1]]
    course, psi = course - course.mean(), psi - psi.mean()
    if np.ptp(psi) < _TURNED and np.ptp(course) < _TURNED:
        return
    slope = float(course @ psi) / max(float(psi @ psi), 1e-30)
    if not _SLOPE[0] <= slope <= _SLOPE[1]:
        raise ConfigError(
            f"{path}: the course of x, y turns {slope:.3g} times as far as psi: allowed is "
            f"{_SLOPE[0]} to {_SLOPE[1]} (x north, y east, psi clockwise from north, in its unit)"
        )


def _check_propeller(path: str | Path, n: float, speed: float, ship: Ship) -> None:
    """At the start the propeller turns about as it must at that speed, or not at all."""
    with told_of(path):
        own = self_propulsion(ship, speed)
    if n != 0.0 and not own / _PULL <= n <= own * _PULL:
        raise ConfigError(
            f"{path}: n at the start = {n:.3g} rev/s, as of {ship.name}, who needs {own:.3g} at "
            f"that speed: allowed is a factor of {_PULL:.3g}, or 0; look at unit and length"
        )
