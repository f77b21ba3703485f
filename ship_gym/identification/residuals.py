"""What a fit to captive runs leaves: by file and coefficient, single runs far off, and what no
number changes.

A residual e of an axis with standard deviation sigma and leverage h is s = e / (sigma sqrt(1 - h));
with sigma found without it, s sqrt((f - 1) / (f - s^2)) is Student's t of f - 1 degrees of freedom,
f: those of the axis. A coefficient is far off if the largest of so many would be as far once in
a hundred fits (Bonferroni).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy import stats

from ship_gym.identification.captive_fit import Row
from ship_gym.text import table

_MILLE = 1e3
_RARE = 0.01  # chance that a fit without fault names a coefficient
_LEAST = 4  # runs of a file and coefficient from which their mean tells something
_NOISE = 1e-9  # of the largest coefficient: rounding, no scatter


def by_coefficient(
    rows: Sequence[Row], data: np.ndarray, before: np.ndarray, after: np.ndarray
) -> list[dict[str, Any]]:
    """Residuals before and after of each file and coefficient: root mean squares, and the mean."""
    found = []
    for (file, name), own in groups(rows).items():
        left = (data - after)[own]
        found.append(
            {
                "file": Path(file).name,
                "coefficient": name,
                "runs": len(own),
                "largest": float(np.abs(data[own]).max()),
                "rms_before": rms((data - before)[own]),
                "rms_after": rms(left),
                "mean_after": float(left.mean()),
            }
        )
    return found


def residual_table(found: Sequence[dict[str, Any]], markdown: bool = False) -> str:
    """`by_coefficient` as a table, times 1000."""
    keys = ("largest", "rms_before", "rms_after", "mean_after")
    rows = [
        [x["file"], x["coefficient"], str(x["runs"]), *(f"{_MILLE * x[k]:.2f}" for k in keys)]
        for x in found
    ]
    header = ["file", "coefficient", "runs", "largest x 1000", "rms before", "rms after", "mean"]
    return table(header, rows, left=2, markdown=markdown)


def far_off(
    rows: Sequence[Row],
    residuals: np.ndarray,
    leverage: np.ndarray,
    sigma: dict[str, float],
    freedom: dict[str, float],
    largest: float,
) -> list[tuple[Row, float]]:
    """Coefficients far off the others, with their distance in standard deviations; worst first.

    Parameters
    ----------
    rows, residuals, leverage
        Of what was fitted to, length m.
    sigma, freedom : dict
        Of each axis: standard deviation and degrees of freedom.
    largest : float
        Of the coefficients, by size.
    """
    found = []
    for k, row in enumerate(rows):
        s, f = sigma[row.axis], freedom[row.axis]
        if f <= 2.0 or s <= _NOISE * largest or leverage[k] > 1.0 - 1e-9:
            continue
        inner = float(residuals[k]) / (s * math.sqrt(1.0 - leverage[k]))
        outer = inner * math.sqrt((f - 1.0) / max(f - inner**2, 1e-12))
        if 2.0 * stats.t.sf(abs(outer), f - 1.0) * len(rows) < _RARE:
            found.append((row, inner))
    return sorted(found, key=lambda one: -abs(one[1]))


def shifted(rows: Sequence[Row], residuals: np.ndarray, largest: float) -> list[str]:
    """Files and coefficients whose residuals have a mean that their scatter does not explain.

    By Student's t of each file and coefficient, as rare as `far_off`; in words, times 1000.
    """
    words, parts = [], groups(rows)
    for (file, name), own in parts.items():
        left = residuals[own]
        if len(own) < _LEAST or abs(mean := float(left.mean())) <= _NOISE * largest:
            continue
        error = float(left.std(ddof=1)) / math.sqrt(len(own))
        chance = 2.0 * stats.t.sf(abs(mean) / max(error, 1e-300), len(own) - 1)
        if chance * len(parts) < _RARE:
            words.append(f"{name} of {Path(file).name} by {_MILLE * mean:+.2f}")
    return words


def not_fitted(
    rows: Sequence[Row], data: np.ndarray, model: np.ndarray, sigma: dict[str, float]
) -> list[dict[str, Any]]:
    """What no number changes, where the ship is further off than three times the axis' scatter.

    There propeller and rudder show what they miss; ``opposite`` is true where measured and
    computed are of opposite sign, as with a rudder angle that is positive to port. A thrust has no
    scatter of its own: a tenth of it is told.
    """
    found = []
    for (file, name), own in groups(rows).items():
        gap = rms((data - model)[own])
        least = 3.0 * sigma[name[0]] if name[0] in sigma else 0.1 * float(np.abs(data[own]).max())
        if gap > max(least, _NOISE) and (name[0] in sigma or name in ("T", "T_mean")):
            against = float(data[own] @ model[own]) < 0.0 and gap > 1.5 * rms(data[own])
            named = {"file": Path(file).name, "coefficient": name, "runs": len(own)}
            sizes = {"largest": float(np.abs(data[own]).max()), "rms": gap}
            found.append(named | sizes | {"opposite": against})
    return found


def groups(rows: Sequence[Row]) -> dict[tuple[str, str], list[int]]:
    """Places of the rows of each file and coefficient."""
    found: dict[tuple[str, str], list[int]] = {}
    for k, row in enumerate(rows):
        found.setdefault((row.file, row.name), []).append(k)
    return found


def in_words(row: Row) -> str:
    """File, coefficient and condition of a row."""
    run = row.run
    parts = [
        f"{math.degrees(run.beta):.3g} deg of drift" if run.beta else "",
        f"rudder {math.degrees(run.delta):.3g} deg" if run.delta else "",
        f"r' {run.yaw_rate:.3g}" if run.yaw_rate else "",
        f"v' {run.sway:.3g}" if run.sway else "",
    ]
    where = ", ".join(part for part in parts if part) or "straight ahead"
    return f"{row.name} of {Path(row.file).name} ({where})"


def rms(values: np.ndarray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))
