"""Columns of errors in Tables 3.13-3.15 and 4.5-4.7 of Knight (2021), from the printed means."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from reproduce.rounding import HALF_DIGIT, interval
from ship_gym.csv_file import CsvTable, read_csv

# column, its table in calm water and in waves
TABLES = {"T": ("3.13", "4.5"), "Q": ("3.14", "4.6"), "F_N": ("3.15", "4.7")}


def _percent(measured: np.ndarray, force: np.ndarray) -> np.ndarray:
    return 100.0 * (measured - force) / measured


def _ratio(measured: np.ndarray, force: np.ndarray, sigma: np.ndarray) -> np.ndarray:
    return (measured - force) / sigma


def error_cells(path: Path) -> list[dict[str, Any]]:
    """Columns eps, and in calm water their ratio to the standard error, one entry per column.

    Parameters
    ----------
    path : Path
        Data file; the digits of its means are those of the table.

    Returns
    -------
    list of dict
        ``table``, ``column``, ``ours``, ``printed`` and ``within`` (rounding).
    """
    rows = read_csv(path)
    calm = "sigma" in rows.columns["model"].tolist()
    found = []
    for quantity, tables in TABLES.items():
        shown = rows.select((rows.columns["points"] > 0.0) & (rows.columns[quantity] > 0.0))
        ones = np.ones(len(shown.rows))
        mean = rows.where(model="measured").columns[quantity] * ones
        force, name = shown.columns[quantity], tables[0 if calm else 1]
        half = 0.5 * 10.0 ** -(4 if (calm and quantity == "Q") else 3)
        column = f"eps_{quantity[0]}"
        found.append(_column(shown, name, column, _percent, (mean, force), half))
        if calm:
            sigma = rows.where(model="sigma").columns[quantity] * ones
            column, inputs = f"ratio_{quantity[0]}", (mean, force, sigma)
            found.append(_column(shown, name, column, _ratio, inputs, half))
    return found


def _column(
    shown: CsvTable, name: str, column: str, compute: Any, inputs: tuple, half: float
) -> dict[str, Any]:
    low, high = interval(compute, *inputs, half=half)
    printed = shown.columns[column]
    within = (printed >= low - HALF_DIGIT) & (printed <= high + HALF_DIGIT)
    return {
        "table": name,
        "column": column,
        "ours": compute(*inputs).tolist(),
        "printed": printed.tolist(),
        "within": within.tolist(),
    }


def implied_normal_force(path: Path) -> float:
    """Measured mean F_N [N] with which the column eps of F_N was made."""
    rows = read_csv(path)
    rows = rows.select((rows.columns["points"] > 0.0) & (rows.columns["F_N"] > 0.0))
    return float(np.mean(rows.columns["F_N"] / (1.0 - 0.01 * rows.columns["eps_F"])))
