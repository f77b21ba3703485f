"""What a fit to captive runs found, as data and as text, plain or in Markdown."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.identification import residuals
from ship_gym.identification.captive_fit import CaptiveFit
from ship_gym.identification.estimate import Estimate
from ship_gym.identification.numbers import ranges_of
from ship_gym.physics.hull import YAW_FULL
from ship_gym.text import paragraph, table

_MILLE = 1e3
_MOST = 5  # things of a kind that are named
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


def advice(fit: CaptiveFit) -> str:
    """What to look at where a fitted number is one that no ship has: one line."""
    against = _against(_judged(fit))
    signs = f"; of the other sign than the ship's own: {against}" if against else ""
    return (
        "look at signs, units, divisor and length (--help), fit fewer --numbers, or give other "
        f"runs{signs}"
    )


def by_coefficient(fit: CaptiveFit) -> list[dict[str, Any]]:
    """Residuals before and after of each file and coefficient."""
    return residuals.by_coefficient(fit.rows, fit.measured, fit.before, fit.after)


def _judged(fit: CaptiveFit) -> dict[str, Any]:
    """What of the residuals wants a look: single coefficients, means, what is not fitted to."""
    found = fit.estimate
    left, largest = fit.measured - fit.after, float(np.abs(fit.measured).max())
    spread = (found.sigma, found.freedom, largest)
    far = residuals.far_off(fit.rows, left, fit.leverage, *spread)
    return {
        "far_off": [{"what": residuals.in_words(row), "deviations": s} for row, s in far],
        "shifted": residuals.shifted(fit.rows, left, largest),
        "not_fitted": residuals.not_fitted(
            fit.aside, fit.aside_measured, fit.aside_model, found.sigma
        ),
    }


def _judgement(fit: CaptiveFit) -> list[str]:
    """The same in sentences."""
    judged, lines = _judged(fit), []
    if far := judged["far_off"]:
        told = [f"{x['what']}: {x['deviations']:+.1f}" for x in far[:_MOST]]
        lines.append(f"Far off the others, in standard deviations: {_some(told, far)}.")
    if shifted := judged["shifted"]:
        lines.append(
            f"Residuals with a mean, x 1000: {_some(shifted[:_MOST], shifted)}; a gauge's offset, "
            "or terms that the polynomial lacks."
        )
    if aside := judged["not_fitted"]:
        told = [_aside(x) for x in aside[:_MOST]]
        lines.append(
            "Not fitted to, since no number changes it, and beyond the scatter (rms of measured "
            f"minus computed, largest measured, x 1000): {_some(told, aside)}."
        )
    if against := _against(judged):
        lines.append(f"Measured against the sign of the ship's own: {against}.")
    return lines


def _aside(x: dict[str, Any]) -> str:
    sizes = f"{_MILLE * x['rms']:.2f} of {_MILLE * x['largest']:.2f}"
    return f"{x['coefficient']} of {x['file']}, {sizes}"


def _against(judged: dict[str, Any]) -> str:
    """What was measured against the sign of the ship that the fit began with, few of them."""
    found = [f"{x['coefficient']} of {x['file']}" for x in judged["not_fitted"] if x["opposite"]]
    return _some(found[:2], found)


def _some(told: list[str], whole: list) -> str:
    rest = len(whole) - len(told)
    return "; ".join(told) + (f" and {rest} more" if rest else "")


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
        "coefficients_left_out": len(fit.aside),
        **_judged(fit),
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
        f"{math.degrees(fit.drift):.3g} deg of drift or r' of {YAW_FULL}, {len(fit.aside)} "
        "coefficients that none of the numbers changes."
    )
    sigma = ", ".join(f"{k} {_MILLE * v:.2f}" for k, v in found.sigma.items())
    strange = [f"No ship has this: {line}." for line in implausible(fit)]
    scatter = f"Scatter of the residuals x 1000: {sigma}."
    sentences = [left, *identifiability(found), scatter, *_judgement(fit), *strange, CAVEAT]
    parts = [
        head,
        "",
        number_table(found, markdown),
        "",
        residuals.residual_table(by_coefficient(fit), markdown),
        "",
    ]
    return "\n".join([*parts, *map(say, sentences)])
