"""Numbers that Knight & Maki (2020) print twice, recomputed: losses from errors, amplitudes."""

from __future__ import annotations

from typing import Any

import numpy as np

from reproduce.unsteady import EARLY_STOPPING, OUTPUTS, REGRESSION_ORDER, loss
from reproduce.unsteady_series import DATA
from ship_gym.csv_file import CsvTable, read_csv

TESTS = DATA / "km20_tests.csv"
AMPLITUDES = DATA / "km20_amplitudes.csv"
_THREE_DIGITS = (2.58e-4,)  # of Tables 3 and 4, where all other numbers have two


def tests(condition: str) -> dict[str, dict[str, float]]:
    """Printed errors and losses of the test cases by ``case, model``."""
    rows = read_csv(TESTS).where(condition=condition)
    return {
        f"{case}, {model}": {name: float(rows.columns[name][i]) for name in (*OUTPUTS, "loss")}
        for i, (case, model) in enumerate(
            zip(rows.columns["case"], rows.columns["model"], strict=True)
        )
    }


def losses() -> list[dict[str, Any]]:
    """Every printed loss beside the one that its three printed errors make (Eqs. 12, 15).

    Returns
    -------
    list of dict
        ``place``, ``printed``, ``computed``, the ``low`` and ``high`` that the rounding of the
        errors allows, and ``agrees``: whether that range meets the printed loss and its rounding.
    """
    found = []
    for path, place in ((EARLY_STOPPING, "Table 3"), (REGRESSION_ORDER, "Table 4")):
        rows = read_csv(path)
        names = rows.columns["order" if "order" in rows.columns else "training_loss"]
        for i, name in enumerate(names):
            label = name if isinstance(name, str) else f"{name:.1e}"
            errors = np.array([rows.columns[k][i] for k in OUTPUTS])
            printed = float(rows.columns["loss"][i])
            unit = _unit(printed, 3 if printed in _THREE_DIGITS else 2)
            found.append(_row(f"{place}, {label}", errors, _units(errors), printed, unit))
    rows = read_csv(TESTS)
    for i in range(len(rows.rows)):
        place = ", ".join(rows.columns[k][i] for k in ("condition", "case", "model"))
        errors, units = (
            np.array([rows.columns[f"{k}{end}"][i] for k in OUTPUTS]) for end in ("", " unit")
        )
        printed, unit = (float(rows.columns[k][i]) for k in ("loss", "loss unit"))
        found.append(_row(place, errors, units, printed, unit))
    return found


def _units(values: np.ndarray) -> np.ndarray:
    return np.array([_unit(float(v), 2) for v in values])


def _unit(value: float, digits: int) -> float:
    """Worth of the last of some significant digits."""
    return float(10.0 ** (np.floor(np.log10(value)) - digits + 1))


def _row(
    place: str, errors: np.ndarray, units: np.ndarray, printed: float, unit: float
) -> dict[str, Any]:
    low, high = (loss(errors + side * 0.5 * units) for side in (-1.0, 1.0))
    agrees = low <= printed + 0.5 * unit and printed - 0.5 * unit <= high
    limits = {"low": low, "high": high, "agrees": bool(agrees)}
    return {"place": place, "printed": printed, "computed": loss(errors), **limits}


def amplitudes() -> list[dict[str, Any]]:
    """Velocity ratio that each printed amplitude and frequency make, beside the printed ratio."""
    rows: CsvTable = read_csv(AMPLITUDES)
    found = []
    for i in range(len(rows.rows)):
        place = ", ".join(rows.columns[k][i] for k in ("condition", "case", "motion"))
        A, omega, mean, printed, digits = (
            float(rows.columns[k][i]) for k in ("A", "omega", "mean", "ratio", "digits")
        )
        computed = A * omega / mean
        agrees = abs(computed - printed) <= 0.5 * 10.0**-digits + 1e-9
        found.append(
            {"place": place, "printed": printed, "computed": computed, "agrees": bool(agrees)}
        )
    return found
