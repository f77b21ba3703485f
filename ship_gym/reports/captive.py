"""Captive tests of a ship beside measured ones, as data and text."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.captive import AXES, Condition, kind, measure, programme
from ship_gym.reports.captive_file import read_measured
from ship_gym.ships.particulars import Ship
from ship_gym.text import paragraph, table

NAMES = {
    "drift": "static drift",
    "rudder": "static rudder",
    "yaw": "pure yaw",
    "yaw_drift": "yaw with drift",
}
# of a swinging model: centrifugal and Coriolis force, then inertia and damping in sway and yaw
SWINGING = ("X_out", "X_in2", "Y_in", "Y_out", "N_in", "N_out")
BASIS = "coefficients x 1000, forces by 1/2 rho L d U^2, moments by that times L"
_MILLE = 1e3


@dataclasses.dataclass(frozen=True)
class CaptiveCase:
    """Runs of one captive test, computed, and measured where a file has them.

    Attributes
    ----------
    test : str
        One of ``captive.TESTS``.
    runs : tuple of captive.Condition
    computed, measured : tuple of dict
        Coefficients of each run by name; `measured` is empty without a file.
    source : str
        The file of measured runs; empty without one.
    """

    ship: Ship
    test: str
    runs: tuple[Condition, ...]
    computed: tuple[dict[str, float], ...]
    measured: tuple[dict[str, float], ...] = ()
    source: str = ""

    @property
    def shown(self) -> tuple[str, ...]:
        """Names of the coefficients in table and picture."""
        return SWINGING if self.runs[0].omega > 0.0 else AXES


def tow(ship: Ship, test: str, speed: float | None = None, n: float | None = None) -> CaptiveCase:
    """A usual captive test, ``captive.programme``."""
    runs = programme(ship, test, speed, n)
    return CaptiveCase(ship, test, tuple(runs), tuple(measure(ship, runs)))


def tow_as_measured(ship: Ship, path: str | Path) -> CaptiveCase:
    """The runs of a file of measured ones, ``captive_file.read_measured``."""
    found = read_measured(path, ship)
    runs = [each.condition for each in found]
    values = tuple(each.values for each in found)
    return CaptiveCase(ship, kind(runs), tuple(runs), tuple(measure(ship, runs)), values, str(path))


@dataclasses.dataclass(frozen=True)
class Gap:
    """Difference of one coefficient over all measured runs.

    Attributes
    ----------
    rms : float
        Root mean square of computed minus measured.
    largest : float
        Largest measured magnitude.
    slope : float
        Computed over measured, by least squares through the origin.
    """

    runs: int
    rms: float
    largest: float
    slope: float


def gaps(case: CaptiveCase) -> dict[str, Gap]:
    """Gap of every coefficient that is measured in all runs and computed."""
    if not case.measured:
        return {}
    found = {}
    for name in case.computed[0]:
        if all(name in row for row in case.measured):
            ours = np.array([row[name] for row in case.computed])
            theirs = np.array([row[name] for row in case.measured])
            square = float(theirs @ theirs)
            found[name] = Gap(
                len(ours),
                float(np.sqrt(np.mean((ours - theirs) ** 2))),
                float(np.abs(theirs).max()),
                float(ours @ theirs) / square if square > 0.0 else math.nan,
            )
    return found


def as_dict(case: CaptiveCase) -> dict[str, Any]:
    """The case as plain data; angles in degrees, coefficients as they are, without the 1000."""
    return {
        "ship": case.ship.name,
        "test": case.test,
        "basis": "forces by 1/2 rho L d U^2, moments by that times L",
        "source": case.source or None,
        "runs": [
            {
                "speed": run.speed,
                "n": run.n,
                "beta_deg": math.degrees(run.beta),
                "delta_deg": math.degrees(run.delta),
                "yaw_rate": run.yaw_rate,
                "omega": run.omega,
                "computed": case.computed[k],
                "measured": case.measured[k] if case.measured else {},
            }
            for k, run in enumerate(case.runs)
        ],
        "gaps": {
            name: dataclasses.asdict(gap) | {"slope": gap.slope if gap.largest else None}
            for name, gap in gaps(case).items()
        },
    }


def title(case: CaptiveCase) -> str:
    """Ship and test in words."""
    return f"{case.ship.name}: {NAMES[case.test]}, {len(case.runs)} runs"


def as_text(case: CaptiveCase) -> str:
    """The case as a report for people."""
    lines = [title(case), BASIS, "", _run_table(case)]
    if case.runs[0].omega > 0.0:
        about = "out goes with the yaw rate, in with its derivative, 2 with twice the frequency; "
        lines.append(paragraph(f"{about}the inertia of the model is in them, as a gauge feels it"))
    if found := gaps(case):
        lines += ["", _gap_table(found), paragraph(f"measured: {case.source}")]
    return "\n".join(lines)


def all_as_text(cases: Sequence[CaptiveCase], files: Sequence[str]) -> str:
    """Reports of several cases, and where the picture of each was written."""
    pairs = zip(cases, files, strict=True)
    return "\n\n".join(f"{as_text(case)}\nwrote {path}" for case, path in pairs)


def _run_table(case: CaptiveCase) -> str:
    motions = {
        "beta": [f"{math.degrees(run.beta):.1f}" for run in case.runs],
        "delta": [f"{math.degrees(run.delta):.1f}" for run in case.runs],
        "r'": [f"{run.yaw_rate:.3f}" for run in case.runs],
        "U": [f"{run.speed:.3g}" for run in case.runs],
        "n": [f"{run.n:.3g}" for run in case.runs],
    }
    told = {name: cells for name, cells in motions.items() if any(float(cell) for cell in cells)}
    header = list(told)
    columns = list(told.values())
    for name in case.shown:
        header.append(name)
        columns.append([f"{_MILLE * row[name]:.2f}" for row in case.computed])
        if any(name in row for row in case.measured):
            header.append("meas.")
            columns.append(
                [f"{_MILLE * row[name]:.2f}" if name in row else "" for row in case.measured]
            )
    return table(header, list(zip(*columns, strict=True)), left=0)


def _gap_table(found: dict[str, Gap]) -> str:
    rows = [
        [
            name,
            str(gap.runs),
            f"{_MILLE * gap.rms:.2f}",
            f"{_MILLE * gap.largest:.2f}",
            f"{gap.slope:.2f}",
        ]
        for name, gap in found.items()
    ]
    header = ["coefficient", "runs", "rms difference", "largest measured", "computed / measured"]
    return table(header, rows)
