"""Thrust and torque of KCS in the measured turn, Knight (2021) Tables 3.12-3.15.

The thesis prints what eight regressions give in the measured motion, not the motion. The six whose
coefficients or points are printed fix it: one propeller speed, J and oblique angle for 12 numbers.
"""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from reproduce.rounding import count_text, counted, interval
from ship_gym.csv_file import CsvTable, read_csv
from ship_gym.reports.balance import last_turn
from ship_gym.reports.case import sail_trial
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Ship
from ship_gym.surrogates.fit import fit
from ship_gym.surrogates.regression import Regression
from ship_gym.surrogates.samples import KCS, SINGLE
from ship_gym.text import paragraph, table

DATA = Path(__file__).parent / "data" / "knight_forces.csv"
FORCES = {"T": ("N", 0.0005, "3.13"), "Q": ("N m", 0.00005, "3.14"), "F_N": ("N", 0.0005, "3.15")}
_START = (10.2, 0.35, 0.6)  # n [rev/s], J, beta_P [rad] where the search begins


@dataclasses.dataclass(frozen=True)
class State:
    """Motion at the propeller that the printed forces fix.

    Attributes
    ----------
    n, J, beta_P : float
        Propeller speed [rev/s], advance ratio u/(nD) [-], oblique angle at the propeller [rad].
    std : tuple of float
        Their standard deviations, from the residuals.
    rms_percent : float
        Root mean square of the residuals [%].
    """

    n: float
    J: float
    beta_P: float
    std: tuple[float, float, float]
    rms_percent: float


def models() -> dict[str, dict[str, Regression]]:
    """The six regressions of K_T and 10K_Q that can be made, by their name in the data file."""
    rows, found = read_csv(DATA).columns, {}
    for name, count, grid, turbulence in zip(
        *(rows[k].tolist() for k in ("model", "points", "grid", "turbulence")), strict=True
    ):
        if count == 4.0:
            points = KCS.read(grid, turbulence).pick(KCS.validation)
            found[name] = {
                q: Regression("first").fit(points.X, points.values[q]) for q in ("K_T", "10K_Q")
            }
        elif count == 8.0:
            printed = KCS.printed(f"{grid}_{turbulence}")
            made = {q: Regression("second", printed[q]) for q in printed}
            found[name] = made or fit(KCS, None, grid, turbulence).models[SINGLE]
    return found


def forces_of(
    made: dict[str, Regression], ship: Ship, n: float, J: float, beta: float
) -> dict[str, float]:
    """Thrust [N] and torque [N m] of one regression."""
    place, D = np.array([[J, beta]]), ship.propeller.D
    K_T, K_Q10 = (float(made[q].predict(place)[0][0]) for q in ("K_T", "10K_Q"))
    load = ship.rho * n**2 * D**4
    return {"T": K_T * load, "Q": 0.1 * K_Q10 * load * D}


def state(ship: Ship) -> State:
    """Least squares of the relative errors of the 12 numbers over n, J and beta_P."""
    rows, made = read_csv(DATA), models()
    printed = {k: {q: float(rows.where(model=k).columns[q][0]) for q in ("T", "Q")} for k in made}

    def errors(p: np.ndarray) -> np.ndarray:
        found = {k: forces_of(m, ship, *p) for k, m in made.items()}
        return np.array([found[k][q] / printed[k][q] - 1.0 for k in made for q in ("T", "Q")])

    result = least_squares(errors, _START, x_scale=(1.0, 0.1, 0.1))
    squares, free = float(result.fun @ result.fun), len(result.fun) - len(result.x)
    spread = np.sqrt(np.diag(np.linalg.inv(result.jac.T @ result.jac)) * squares / free)
    rms = 100.0 * math.sqrt(squares / len(result.fun))
    return State(*map(float, result.x), std=tuple(map(float, spread)), rms_percent=rms)


def drift(ship: Ship, found: State) -> dict[str, float]:
    """Drift angle amidships [deg] of the measured turn, from the state and the trial.

    ``by_speed`` from u = J n D and the measured speed U: acos(u/U). ``by_angle`` from beta_P, the
    yaw rate 2 U/diameter and the distance of the propeller: v = u tan(beta_P) - d r (Eq. 2.11).
    ``ours`` of the model's own steady turn.
    """
    trial = ship.trials[0]
    U = trial.measures["steady_speed_ratio"] * trial.speed
    r = 2.0 * U / (trial.measures["steady_diameter"] * ship.hull.L)
    u = found.J * found.n * ship.propeller.D
    v = u * math.tan(found.beta_P) - (ship.hull.x_G - ship.propeller.x_P) * r
    mean = last_turn(sail_trial(ship, trial).result.trajectory)
    return {
        "by_speed": math.degrees(math.acos(u / U)),
        "by_angle": math.degrees(math.atan2(v, u)),
        "ours": math.degrees(math.atan2(-mean["v"], mean["u"])),
    }


def rows_of(ship: Ship, found: State) -> list[dict[str, Any]]:
    """Forces of the six regressions in that state beside the printed ones."""
    rows, result = read_csv(DATA), []
    for name, made in models().items():
        ours = forces_of(made, ship, found.n, found.J, found.beta_P)
        mine = rows.where(model=name).columns
        result.append(
            {"model": name, "ours": ours, "printed": {q: float(mine[q][0]) for q in ours}}
        )
    return result


def error_cells() -> list[dict[str, Any]]:
    """Columns eps and ratio of the three tables from the printed means, all eight regressions."""
    rows = read_csv(DATA)
    printed = rows.select(rows.columns["points"] > 0.0)
    return [cell for quantity in FORCES for cell in _error_cells(rows, printed, quantity)]


def _error_cells(rows: CsvTable, printed: CsvTable, quantity: str) -> list[dict[str, Any]]:
    unit, half, name = FORCES[quantity]
    mean, error = (rows.where(model=k).columns[quantity][0] for k in ("measured", "sigma"))
    force, found = printed.columns[quantity], []
    columns = {
        f"eps_{quantity[0]}": (lambda t, f: 100.0 * (t - f) / t, (mean + 0.0 * force, force)),
        f"ratio_{quantity[0]}": (
            lambda t, f, e: (t - f) / e,
            (mean + 0.0 * force, force, error + 0.0 * force),
        ),
    }
    for column, (compute, inputs) in columns.items():
        low, high = interval(compute, *inputs, half=half)
        theirs = printed.columns[column]
        good = (theirs >= low - 0.0005) & (theirs <= high + 0.0005)
        found.append(
            {
                "table": name,
                "column": column,
                "unit": unit,
                "ours": compute(*inputs).tolist(),
                "printed": theirs.tolist(),
                "within": good.tolist(),
            }
        )
    return found


def implied_normal_force() -> float:
    """Measured mean F_N [N] with which the column eps of Table 3.15 was made."""
    rows = read_csv(DATA)
    rows = rows.select(rows.columns["points"] > 0.0)
    return float(np.mean(rows.columns["F_N"] / (1.0 - 0.01 * rows.columns["eps_F"])))


def as_dict() -> dict[str, Any]:
    """State, forces and drift as plain data, for ``--json``."""
    ship = load_ship("kcs_model")
    found = state(ship)
    return {
        "state": dataclasses.asdict(found) | {"rho": ship.rho},
        "forces": rows_of(ship, found),
        "drift_deg": drift(ship, found),
        "cells": error_cells(),
        "implied_F_N": implied_normal_force(),
    }


def as_text(data: dict[str, Any]) -> str:
    """Forces and state for people, from `as_dict`."""
    cells, s, angle = [], data["state"], data["drift_deg"]
    for row in data["forces"]:
        line = [row["model"]]
        for q, digits in (("T", 3), ("Q", 4)):
            ours, theirs = row["ours"][q], row["printed"][q]
            line += [f"{ours:.{digits}f}", f"{theirs:.{digits}f}"]
            line.append(f"{100.0 * (ours / theirs - 1.0):+.2f}")
        cells.append(line)
    header = ["points, grid", "T [N]", "printed", "[%]", "Q [N m]", "printed", "[%]"]
    return "\n".join(
        [
            "KCS, mean forces after 40 s of the measured 35 deg turn, Tables 3.13 and 3.14",
            table(header, cells),
            paragraph(
                f"All twelve numbers at one state: n {s['n']:.3f} +- {s['std'][0]:.3f} rev/s, J "
                f"{s['J']:.4f} +- {s['std'][1]:.4f}, beta_P {math.degrees(s['beta_P']):.2f} +- "
                f"{math.degrees(s['std'][2]):.2f} deg; rms {s['rms_percent']:.2f} %. Density "
                f"{s['rho']:g} kg/m3, which the thesis leaves out; n goes with 1/sqrt of it. The "
                "thesis gives the trial 10.2 rev/s (4.2.3). J_B = U/(nD) = 0.372 of Stern et al. "
                "gives 10.49."
            ),
            paragraph(
                f"Drift of the measured turn: {angle['by_speed']:.1f} deg by u = J n D and the "
                f"measured speed, {angle['by_angle']:.1f} deg by beta_P and the measured yaw rate; "
                f"our own turn has {angle['ours']:.1f} deg."
            ),
            paragraph(
                count_text(counted(data["cells"])) + " Those are the columns of errors, from the "
                "printed means. All of 3.15 go with a measured mean of "
                f"{data['implied_F_N']:.4f} N, where Table 3.12 has 2.923. F_N itself is of the "
                "movable part: its regression is not in the thesis, nor are those of 16 points."
            ),
        ]
    )
