"""Thrust and torque of KCS in the measured turns, Knight (2021) Tables 3.12-3.15 and 4.5-4.7.

The thesis prints what regressions give in the measured motion, not the motion. Those whose
coefficients or points are printed fix it: one propeller speed, J and oblique angle for all numbers.
"""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from reproduce.measured_cells import error_cells, implied_normal_force
from reproduce.rounding import count_text, counted
from ship_gym.csv_file import read_csv
from ship_gym.reports.balance import last_turn
from ship_gym.reports.case import sail_trial
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Ship
from ship_gym.surrogates.fit import fit
from ship_gym.surrogates.regression import Regression
from ship_gym.surrogates.samples import KCS, SINGLE
from ship_gym.text import paragraph, table

_DATA = Path(__file__).parent / "data"
CALM, WAVES = _DATA / "knight_forces.csv", _DATA / "knight_forces_in_waves.csv"
_START = (10.2, 0.35, 0.6)  # n [rev/s], J, beta_P [rad] where the search begins
_FORCES = ("T", "Q")


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


def models(path: Path = CALM) -> dict[str, dict[str, Regression]]:
    """The regressions of K_T and 10K_Q that can be made, by their name in the data file.

    Of 4 points with the features 1, J, beta, J beta; of 8 by their printed coefficients, else by
    their printed points. The forces of the 16 points are not in the thesis.
    """
    rows, found = read_csv(path).columns, {}
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


def state(ship: Ship, path: Path = CALM, n: float | None = None) -> State:
    """Least squares of the relative errors of the forces over n, J and beta_P; n may be given."""
    rows, made = read_csv(path), models(path)
    printed = {k: {q: float(rows.where(model=k).columns[q][0]) for q in _FORCES} for k in made}
    fixed = () if n is None else (n,)

    def errors(p: np.ndarray) -> np.ndarray:
        found = {k: forces_of(m, ship, *fixed, *p) for k, m in made.items()}
        return np.array([found[k][q] / printed[k][q] - 1.0 for k in made for q in _FORCES])

    start = _START[len(fixed) :]
    result = least_squares(errors, start, x_scale=start)
    squares, free = float(result.fun @ result.fun), len(result.fun) - len(start)
    spread = np.sqrt(np.diag(np.linalg.inv(result.jac.T @ result.jac)) * squares / free)
    rms = 100.0 * math.sqrt(squares / len(result.fun))
    std = (*(0.0 for _ in fixed), *map(float, spread))
    return State(*fixed, *map(float, result.x), std=std, rms_percent=rms)


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


def forces(ship: Ship, found: State, path: Path = CALM) -> list[dict[str, Any]]:
    """Forces of the regressions in a state beside the printed ones."""
    rows, result = read_csv(path), []
    for name, made in models(path).items():
        ours = forces_of(made, ship, found.n, found.J, found.beta_P)
        mine = rows.where(model=name).columns
        printed = {q: float(mine[q][0]) for q in ours}
        result.append({"model": name, "ours": ours, "printed": printed})
    return result


def as_dict() -> dict[str, Any]:
    """State, forces and drift as plain data, for ``--json``; ``printed_n`` has n as printed."""
    ship, data = load_ship("kcs_model"), {}
    for name, path, n in (("calm", CALM, 10.2), ("waves", WAVES, 13.2)):
        found = state(ship, path)
        data[name] = {
            "state": dataclasses.asdict(found),
            "printed_n": dataclasses.asdict(state(ship, path, n)),
            "forces": forces(ship, found, path),
        }
    return data | {
        "rho": ship.rho,
        "drift_deg": drift(ship, state(ship)),
        "cells": error_cells(CALM) + error_cells(WAVES),
        "implied_F_N": implied_normal_force(CALM),
    }


def as_text(data: dict[str, Any]) -> str:
    """Forces and states for people, from `as_dict`."""
    heads = {"calm": "calm water, Tables 3.13 and 3.14", "waves": "waves, Tables 4.5 and 4.6"}
    angle = data["drift_deg"]
    return "\n\n".join(
        [
            *(_run_text(heads[name], data[name]) for name in heads),
            paragraph(
                f"The density is {data['rho']:g} kg/m3, which the thesis leaves out; n goes with "
                "one over its root. In waves the same search finds the printed 13.2 rev/s, in calm "
                "water not the printed 10.2. J_B = U/(nD) = 0.372 of Stern et al. gives 10.49."
            ),
            paragraph(
                f"Drift of the measured turn in calm water: {angle['by_speed']:.1f} deg by u = J n "
                f"D and the measured speed, {angle['by_angle']:.1f} deg by beta_P and the measured "
                f"yaw rate; our own turn has {angle['ours']:.1f} deg."
            ),
            paragraph(
                count_text(counted(data["cells"])) + " Those are the columns of errors, from the "
                "printed means. All of 3.15 go with a measured mean of "
                f"{data['implied_F_N']:.4f} N, where Table 3.12 has 2.923. F_N itself is of the "
                "movable part: its regression is not in the thesis, nor are those of 16 points."
            ),
        ]
    )


def _run_text(head: str, run: dict[str, Any]) -> str:
    """Forces of one run, and its state."""
    cells, s, other = [], run["state"], run["printed_n"]
    for row in run["forces"]:
        line = [row["model"]]
        for q, digits in (("T", 3), ("Q", 4)):
            ours, theirs = row["ours"][q], row["printed"][q]
            line += [f"{ours:.{digits}f}", f"{theirs:.{digits}f}"]
            line.append(f"{100.0 * (ours / theirs - 1.0):+.2f}")
        cells.append(line)
    header = ["points, grid", "T [N]", "printed", "[%]", "Q [N m]", "printed", "[%]"]
    return "\n".join(
        [
            f"KCS, mean forces after 40 s of the measured 35 deg turn in {head}",
            table(header, cells),
            paragraph(
                f"All at one state: n {s['n']:.2f} +- {s['std'][0]:.2f} rev/s, J {s['J']:.3f} +- "
                f"{s['std'][1]:.3f}, beta_P {math.degrees(s['beta_P']):.1f} +- "
                f"{math.degrees(s['std'][2]):.1f} deg; rms {s['rms_percent']:.2f} %. With n as the "
                f"thesis gives it, {other['n']:g}: rms {other['rms_percent']:.2f} %."
            ),
        ]
    )
