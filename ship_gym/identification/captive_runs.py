"""Captive runs of some files: each once, and only those in the range of the hull's polynomial."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from ship_gym.captive import Condition
from ship_gym.config import ConfigError, check_number
from ship_gym.physics.hull import COS_DRIFT_FULL, YAW_FULL
from ship_gym.reports.captive_file import Measured, read_measured
from ship_gym.ships.particulars import Ship

FULL_DRIFT = math.acos(COS_DRIFT_FULL)  # the polynomial's range in the simulation, 30 deg
_ROUND = 1e-6  # of an angle [rad]
_ENOUGH = 9  # digits of a row that no other row has by chance


def read_runs(
    files: Sequence[str | Path], ship: Ship, drift: float = FULL_DRIFT
) -> tuple[list[tuple[str, Measured]], int, int]:
    """Runs with their files, and how many were left out: copies, and those out of range.

    Parameters
    ----------
    files : sequence of path
        As ``reports.captive_file.read_measured`` reads them.
    ship : Ship
    drift : float
        Largest drift angle [rad], at most `FULL_DRIFT`.

    Raises
    ------
    ConfigError
        A file that is none, or no run in range.
    """
    drift = check_number("largest drift", drift, 0.0, FULL_DRIFT + _ROUND, "rad")
    given = [(str(f), one) for f in files for one in read_measured(f, ship)]
    runs = _different(given)
    within = [pair for pair in runs if _in_range(pair[1].condition, drift)]
    if not within:
        told = f"{math.degrees(drift):.3g} deg of drift and r' of {YAW_FULL}"
        raise ConfigError(f"no captive run within {told}")
    return within, len(given) - len(runs), len(runs) - len(within)


def _in_range(run: Condition, drift: float) -> bool:
    """Whether the MMG polynomial is the whole of the hull's force in a run, and it is wanted."""
    most = abs(run.beta) + math.atan(abs(run.sway))
    return most <= drift + _ROUND and abs(run.yaw_rate) <= YAW_FULL


def _different(runs: list[tuple[str, Measured]]) -> list[tuple[str, Measured]]:
    """Runs without those that an earlier file has, or an earlier row under another condition.

    No two runs of a tank have all their digits in common: such a row was copied. But few values
    of few digits may agree by chance, as the X of a drift to either side: there the condition has
    to be the same too.
    """
    seen, kept = set(), []
    for file, one in runs:
        values = tuple(sorted(one.values.items()))
        told = sum(_digits(value) for value in one.values.values()) >= _ENOUGH
        key = (values, None if told else one.condition)
        if key not in seen:
            seen.add(key)
            kept.append((file, one))
    return kept


def _digits(value: float) -> int:
    """Significant digits with which a number was written."""
    return len(f"{abs(value):.15g}".partition("e")[0].replace(".", "").strip("0"))
