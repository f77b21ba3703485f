"""What a fitted propeller and rudder surrogate says of itself, beside what the thesis prints."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.reports.case import sail, sail_trial
from ship_gym.reports.surrogate_printed import (
    printed_errors,
    printed_means,
    printed_totals,
)
from ship_gym.ships.loader import attach_surrogate
from ship_gym.ships.particulars import Ship
from ship_gym.surrogates.base import percent_error
from ship_gym.surrogates.error_budget import GRID, TURBULENCE, error_budget
from ship_gym.surrogates.fit import Fit, Options, leave_one_out, new_model
from ship_gym.surrogates.regression import FEATURES, Regression
from ship_gym.surrogates.samples import DATA_SETS
from ship_gym.surrogates.sampling import proposals
from ship_gym.tables import Table

# data set, family, grid and turbulence model of the tables that come with the package
SHIPPED = (
    ("kcs", "regression", "G1", "SA"),
    ("kcs", "regression", "G2", "SA"),
    ("kcs", "regression", "G2", "SST"),
    ("kcs", "regression", "G3", "SA"),
    ("kcs", "gp", "G2", "SA"),
    ("kcs", "nn", "G2", "SA"),
    ("onrt", "regression", "G1", "SA"),
    ("onrt", "regression", "G2", "SA"),
    ("onrt", "regression", "G2", "SST"),
    ("onrt", "regression", "G3", "SA"),
    ("onrt", "gp", "G2", "SA"),
    ("onrt", "nn", "G2", "SA"),
    ("onrt_16", "regression", "G2", "SA"),
)


def as_dict(fit: Fit, table: Table) -> dict[str, Any]:
    """A fit and its table as plain numbers, for ``--json``, the text and the page.

    Parameters
    ----------
    fit : Fit
    table : Table
        Of ``force_table.table_of``.
    """
    card = table.card
    sides = {side: _of_side(fit, side) for side in fit.models}
    return {
        "name": fit.name,
        "title": card["title"],
        "source": card["source"],
        "options": card["options"],
        "grid": fit.grid,
        "turbulence": fit.turbulence,
        "trained_on": fit.trained_on,
        "features": list(_labels(fit)),
        "training_points": card["training_points"],
        "held_out_points": card["held_out_points"],
        "sides": sides,
        "error_budget": _budgets(fit),
        "interpolation_error": card["interpolation_error"],
        "effective_inflow": card["effective_inflow"],
        "torque": card["torque"],
        "domain": card["domain"],
        "rudder_angles": [plane["delta"] for plane in card.get("planes", ())],
        "next_samples": proposals(fit, seed=fit.options.seed),
        "made_for": card["made_for"],
        "inputs": card["inputs"],
        "versions": card["versions"],
        "git_commit": card["git_commit"],
    }


def _labels(fit: Fit) -> list[str]:
    """Names of the features of the regressions in a fit."""
    models = next(iter(fit.models.values())).values()
    order = next((m.order for m in models if isinstance(m, Regression)), None)
    return [_monomial(i, j) for i, j in FEATURES[order]] if order else []


def _monomial(i: int, j: int) -> str:
    def power(x: str, k: int) -> str:
        return "" if k == 0 else x if k == 1 else f"{x}^{k}"

    return " ".join(p for p in (power("J", i), power("beta", j)) if p) or "1"


def _of_side(fit: Fit, side: str) -> dict[str, Any]:
    """Everything about one propeller and rudder."""
    models, errors, options = fit.models[side], fit.errors(side), fit.options
    of_thesis = options.family == "regression" and options.order == "second"
    by_point = printed_errors(fit.data, fit.grid, fit.turbulence, side)
    means = {}
    if options.family == "gp" and (fit.grid, fit.turbulence) == ("G2", "SA"):
        means = printed_means(fit.data, options.noise, side)
    left_out, refused = ({}, "") if errors else _left_out(fit, side)
    return {
        "coefficients": {
            name: [float(c) for c in model.coefficients]
            for name, model in models.items()
            if isinstance(model, Regression) and model.coefficients is not None
        },
        "printed_coefficients": (
            {
                k: v.tolist()
                for k, v in fit.data.printed(f"{fit.grid}_{fit.turbulence}", side).items()
            }
            if of_thesis
            else {}
        ),
        "fitted": list(fit.training[side].values),
        "models": {name: model.describe() for name, model in models.items()},
        "held_out_errors_percent": errors,
        "printed_errors_percent": by_point if of_thesis else {},
        "held_out_scores": fit.scores(side),
        "printed_mean_errors_percent": means,
        "leave_one_out_errors_percent": left_out,
        "leave_one_out_refused": refused,
    }


def _left_out(fit: Fit, side: str) -> tuple[dict[str, list[float]], str]:
    """Leave-one-out errors [%] at the training points, or why there are none."""
    samples, found = fit.training[side], {}
    if not samples.values:
        return {}, "the forces of the training points are not printed"
    if fit.options.family == "nn":
        return {}, "not done for networks: each point would cost another training"
    try:
        for name, y in samples.values.items():
            model = fit.models[side][name]
            if hasattr(model, "leave_one_out"):  # in closed form, its length scales held
                found[name] = (100.0 * model.leave_one_out()[0] / y).tolist()
                continue
            make = partial(new_model, fit.data, fit.options, side, name)
            found[name] = percent_error(y, leave_one_out(make, samples.X, y)).tolist()
    except ConfigError as error:
        return {}, str(error)
    return found, ""


def _budgets(fit: Fit) -> list[dict[str, Any]]:
    """Error budget of a project data set, with the surrogate part of this very fit.

    Empty on other grids and for a user's samples, which need not have the grids it is made of.
    """
    if fit.data.name not in DATA_SETS or (fit.grid, fit.turbulence) != (GRID, TURBULENCE):
        return []
    totals = printed_totals(fit.data) if fit.name == "G2_SA" else {}
    rows = []
    for side in fit.data.sides:
        for quantity, errors in fit.errors(side).items():
            budget = error_budget(fit.data, quantity, side, errors)
            points = list(budget.turbulence_points)
            extra = {"turbulence_points": points, "printed_total": totals.get(quantity)}
            rows.append(budget.as_row() | extra)
    return rows


def turning_check(ship: Ship, table: Table, name: str) -> dict[str, Any]:
    """Turning circle of the ship's trial, or of its largest rudder angle, with this surrogate.

    Returns
    -------
    dict
        ``delta_deg``, ``measures``, and ``trial``, the measured ones, empty without a trial.
    """
    measured = next((t for t in ship.trials if t.manoeuvre == "turning_circle"), None)
    delta_deg = measured.delta_deg if measured else float(np.degrees(ship.gear.delta_max))
    vessel = attach_surrogate(ship, table, name)
    case = sail_trial(vessel, measured) if measured else sail(vessel, delta_deg=delta_deg)
    return {
        "delta_deg": delta_deg,
        "measures": case.result.measures(),
        "trial": dict(case.trial.measures) if case.trial else {},
    }


def file_stem(fit: Fit) -> str:
    """Name of the files of a fit, e.g. ``surrogate_kcs_G2_SA``."""
    same = fit.name.startswith(fit.data.name)
    return f"surrogate_{fit.name}" if same else f"surrogate_{fit.data.name}_{fit.name}"


def how_to_use(path: str | Path, fit: Fit, ship: str) -> str:
    """Lines of Python that attach a table file to a ship, or load it where it is shipped.

    Parameters
    ----------
    path : path-like
        Table file.
    fit : Fit
    ship : str
        Name of the ship or its file.
    """
    lines = f"""next, in Python:
  import gymnasium as gym, ship_gym
  from ship_gym.ships.loader import attach_surrogate
  from ship_gym.tables import Table
  ship = attach_surrogate(ship_gym.load_ship("{ship}"), Table.load("{path}"), "{fit.name}")
  env = gym.make("ShipGym/HeadingKeeping-v0", ship=ship)"""
    shipped = {(name, family, *choice) for name, family, *choice in SHIPPED}
    mine = (fit.data.name, fit.options.family, fit.grid, fit.turbulence)
    if mine in shipped and fit.options == Options(fit.options.family):
        lines += f"""
the same table comes with the package:
  env = gym.make("ShipGym/HeadingKeeping-v0", ship="{ship}", surrogate="{fit.name}")"""
    return lines
