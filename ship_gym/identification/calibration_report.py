"""What a calibration to free-running records found, as data and as text, plain or in Markdown."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from ship_gym.identification.calibration import Calibration
from ship_gym.identification.report import estimate_as_dict, identifiability, number_table
from ship_gym.identification.sailed_records import GROUPS
from ship_gym.text import paragraph, table

CAVEAT = (
    "What the other numbers get wrong, and wind or current that was not measured, goes into the "
    "calibrated ones: judge them by the records that were held out."
)
_DEGREES = math.degrees(1.0)


def sources_of(found: Calibration) -> dict[str, str]:
    """Source of every calibrated number, for the ship file."""
    pairs = zip(found.estimate.names, found.estimate.errors, strict=True)
    return {
        name: f"calibrated to free-running records, see the head of this file; standard error "
        f"{error:.2g}"
        for name, error in pairs
    }


def lines_of(found: Calibration) -> list[str]:
    """Lines for the head of the ship file."""
    lines = [
        f"{', '.join(found.estimate.names)} calibrated to free-running records: "
        f"{_files(found.records)}."
    ]
    if found.held_out:
        lines.append(f"Held out: {_files(found.held_out)}.")
    return lines


def implausible(found: Calibration) -> list[str]:
    """Nothing: the numbers are bounded."""
    return []


def advice(found: Calibration) -> str:
    """Nothing to look at."""
    return ""


def as_dict(found: Calibration) -> dict[str, Any]:
    """The calibration as plain data; root mean squares of x / L, y / L, psi [deg]."""
    return estimate_as_dict(found.estimate) | {
        "ship": found.ship.name,
        "at_bound": [*found.at_bound],
        "correlation_of_neighbours": found.rho,
        "records": [
            {
                "file": record.path,
                "held_out": record in found.held_out,
                **{
                    f"rms_{when}": dict(zip(("x", "y", "psi_deg"), _shown(rms), strict=True))
                    for when, rms in _both(found, record.path).items()
                },
            }
            for record in (*found.records, *found.held_out)
        ],
    }


def as_text(found: Calibration, markdown: bool = False) -> str:
    """The calibration for people."""
    say = str if markdown else paragraph
    head = (
        f"{found.ship.name}: {len(found.estimate.names)} numbers calibrated to "
        f"{len(found.records)} records, {len(found.held_out)} held out"
    )
    rho = ", ".join(f"{name} {found.rho[name]:.2f}" for name in GROUPS)
    sentences = [
        *(f"Stopped by the range that ships have: {name}." for name in found.at_bound),
        *identifiability(found.estimate),
        f"Correlation of neighbouring residuals, by which the errors have grown: {rho}.",
        CAVEAT,
    ]
    tables = [number_table(found.estimate, markdown), "", _record_table(found, markdown)]
    return "\n".join([head, "", *tables, "", *map(say, sentences)])


def _record_table(found: Calibration, markdown: bool) -> str:
    rows = []
    for record in (*found.records, *found.held_out):
        before, after = _both(found, record.path).values()
        kind = "fitted" if record in found.records else "held out"
        cells = zip(_shown(before), _shown(after), (2, 2, 1), strict=True)
        rows.append(
            [Path(record.path).name, kind, *(f"{a:.{k}f} to {b:.{k}f}" for a, b, k in cells)]
        )
    header = ["record: rms before to after", "", "x / L", "y / L", "psi [deg]"]
    return table(header, rows, left=2, markdown=markdown)


def _both(found: Calibration, path: str) -> dict[str, Any]:
    return {"before": found.before[path], "after": found.after[path]}


def _shown(rms: Any) -> list[float]:
    return [float(rms[0]), float(rms[1]), float(rms[2]) * _DEGREES]


def _files(records: Any) -> str:
    return ", ".join(Path(record.path).name for record in records)
