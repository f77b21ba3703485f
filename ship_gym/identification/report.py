"""What a fit to captive runs found, as data and as text, plain or in Markdown."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.identification.captive_fit import CaptiveFit
from ship_gym.identification.estimate import Estimate
from ship_gym.identification.numbers import ranges_of
from ship_gym.physics.hull import YAW_FULL
from ship_gym.text import paragraph, table

_MILLE = 1e3
ALIKE = 0.9  # correlation from which two numbers are told to go together
CAVEAT = (
    "Standard errors are those of the residuals' scatter, as if each coefficient erred by itself. "
    "They know nothing of what all runs have in common: the gauge, the propeller's and the "
    "rudder's law that was taken off, terms that the polynomial lacks."
)


def sources_of(fit: CaptiveFit) -> dict[str, str]:
    """Source of every fitted number, for the ship file."""
    values = zip(fit.estimate.names, fit.estimate.errors, strict=True)
    return {
        name: f"fitted to captive tests, see the head of this file; standard error {error:.2g}"
        for name, error in values
    }


def lines_of(fit: CaptiveFit) -> list[str]:
    """Lines for the head of the ship file."""
    files = ", ".join(Path(file).name for file in fit.files)
    sigma = ", ".join(f"{k} {v:.2g}" for k, v in fit.estimate.sigma.items())
    return [
        f"{len(fit.estimate.names)} numbers fitted to {len(fit.rows)} coefficients of captive "
        f"tests up to {math.degrees(fit.drift):.3g} deg of drift: {files}.",
        f"Scatter of the residuals (by 1/2 rho L d U^2, moments by that times L): {sigma}.",
    ]


def implausible(fit: CaptiveFit) -> list[str]:
    """Fitted numbers that no ship has, in words."""
    values = dict(zip(fit.estimate.names, fit.estimate.values.tolist(), strict=True))
    ranges = ranges_of(fit.ship, fit.estimate.names)
    return [
        f"{name} = {value:.4g}: ships have {ranges[name][0]:.4g} to {ranges[name][1]:.4g}"
        for name, value in values.items()
        if not ranges[name][0] <= value <= ranges[name][1]
    ]


def by_coefficient(fit: CaptiveFit) -> list[dict[str, Any]]:
    """Root mean square of the residuals before and after, of each file and coefficient."""
    keys = list(dict.fromkeys((row.file, row.name) for row in fit.rows))
    found = []
    for file, name in keys:
        own = np.array([(row.file, row.name) == (file, name) for row in fit.rows])
        data = fit.measured[own]
        found.append(
            {
                "file": Path(file).name,
                "coefficient": name,
                "runs": int(own.sum()),
                "largest": float(np.abs(data).max()),
                "rms_before": _rms(data - fit.before[own]),
                "rms_after": _rms(data - fit.after[own]),
            }
        )
    return found


def estimate_as_dict(found: Estimate) -> dict[str, Any]:
    """Numbers, their errors, and how well the data tell them apart."""
    numbers = zip(found.names, found.start, found.values, found.errors, strict=True)
    interval = found.interval()
    return {
        "numbers": [
            {
                "name": name,
                "before": float(start),
                "value": float(value),
                "standard_error": float(error),
                "low_95": float(interval[k, 0]),
                "high_95": float(interval[k, 1]),
            }
            for k, (name, start, value, error) in enumerate(numbers)
        ],
        "condition": found.condition,
        "correlation": found.correlation.tolist(),
        "sigma": {k: float(v) for k, v in found.sigma.items()},
        "rows": found.rows,
        "freedom": found.freedom,
    }


def as_dict(fit: CaptiveFit) -> dict[str, Any]:
    """The fit as plain data."""
    return estimate_as_dict(fit.estimate) | {
        "ship": fit.ship.name,
        "files": [*fit.files],
        "basis": "forces by 1/2 rho L d U^2, moments by that times L",
        "residuals": by_coefficient(fit),
        "largest_drift_deg": math.degrees(fit.drift),
        "runs_twice": fit.copies,
        "runs_outside": fit.outside,
        "coefficients_left_out": fit.silent,
        "implausible": implausible(fit),
    }


def number_table(found: Estimate, markdown: bool = False) -> str:
    """Numbers before and after with standard errors and 95 % intervals."""
    interval = found.interval()
    rows = [
        [
            name.removeprefix("hull."),
            f"{found.start[k]:.4f}",
            f"{found.values[k]:.4f}",
            f"{found.errors[k]:.4f}",
            f"{interval[k, 0]:.4f} to {interval[k, 1]:.4f}",
        ]
        for k, name in enumerate(found.names)
    ]
    header = ["number", "before", "fitted", "standard error", "95 % interval"]
    return table(header, rows, markdown=markdown)


def residual_table(fit: CaptiveFit, markdown: bool = False) -> str:
    """Residuals of each file and coefficient, times 1000."""
    rows = [
        [
            x["file"],
            x["coefficient"],
            str(x["runs"]),
            *(f"{_MILLE * x[k]:.2f}" for k in ("largest", "rms_before", "rms_after")),
        ]
        for x in by_coefficient(fit)
    ]
    header = ["file", "coefficient", "runs", "largest x 1000", "rms before", "rms after"]
    return table(header, rows, left=2, markdown=markdown)


def identifiability(found: Estimate) -> list[str]:
    """How well the data tell the numbers apart, in sentences."""
    lines = [f"Condition of the scaled normal equations: {found.condition:.3g}."]
    if len(found.names) > 1:
        one, other, rho = found.closest_pair()
        together = " (the data tell a mix of both better than either)" if abs(rho) > ALIKE else ""
        lines.append(f"Largest correlation: {one} and {other}, {rho:+.2f}{together}.")
    weak = [
        name
        for name, value, error in zip(found.names, found.values, found.errors, strict=True)
        if abs(value) < 2.0 * error
    ]
    if weak:
        lines.append(f"Not told from zero (within two standard errors): {', '.join(weak)}.")
    return lines


def as_text(fit: CaptiveFit, markdown: bool = False) -> str:
    """The fit for people."""
    say = str if markdown else paragraph
    found = fit.estimate
    head = (
        f"{fit.ship.name}: {len(found.names)} numbers fitted to {len(fit.rows)} coefficients of "
        f"{len({row.run for row in fit.rows})} captive runs"
    )
    left = (
        f"Left out: {fit.copies} runs that stand twice, {fit.outside} beyond "
        f"{math.degrees(fit.drift):.3g} deg of drift or r' of {YAW_FULL}, {fit.silent} "
        "coefficients that none of the numbers changes."
    )
    sigma = ", ".join(f"{k} {_MILLE * v:.2f}" for k, v in found.sigma.items())
    strange = [f"No ship has this: {line}." for line in implausible(fit)]
    scatter = f"Scatter of the residuals x 1000: {sigma}."
    sentences = [left, *identifiability(found), scatter, *strange, CAVEAT]
    parts = [head, "", number_table(found, markdown), "", residual_table(fit, markdown), ""]
    return "\n".join([*parts, *map(say, sentences)])


def _rms(values: Sequence[float] | np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
