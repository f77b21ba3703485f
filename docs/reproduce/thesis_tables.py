"""Tables that Knight (2021) prints of his surrogates, recomputed from his printed points.

What cannot be recomputed is said in the text, with the reason.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ship_gym.reports.surrogate_printed import (
    printed_errors,
    printed_means,
    printed_regression_means,
    printed_totals,
)
from ship_gym.surrogates.base import mean_size, percent_error
from ship_gym.surrogates.error_budget import error_budget, sigma_n
from ship_gym.surrogates.fit import fit, noise_of
from ship_gym.surrogates.gaussian_process import GaussianProcess
from ship_gym.surrogates.regression import features
from ship_gym.surrogates.samples import KCS, ONRT, SINGLE, DataSet
from ship_gym.text import paragraph, table

_MISSING = (
    "all 16- and 24-point sets (B.13, 5.10, half of 3.7-3.10, most of 3.11), KCS with k-omega SST "
    "(A.10), and the rudder rows of Table 3.11, which use the force on the movable part."
)
COEFFICIENTS = (
    ("A.9", KCS, "G2", "SA"),
    ("A.11", KCS, "G3", "SA"),
    ("B.11", ONRT, "G2", "SA"),
    ("B.12", ONRT, "G2", "SST"),
    ("B.14", ONRT, "G3", "SA"),
)


def coefficients() -> list[dict[str, Any]]:
    """Regression coefficients beside the printed ones, one entry per quantity and propeller.

    Returns
    -------
    list of dict
        ``table``, ``model``, ``side``, ``quantity``, ``ours`` and ``printed``, shapes (6,), and
        ``largest_difference`` of the two regressions at the training points.
    """
    found = []
    for name, data, grid, turbulence in COEFFICIENTS:
        made = fit(data, grid=grid, turbulence=turbulence)
        for side in data.sides:
            printed = data.printed(made.name, side)
            matrix = features(made.training[side].X)
            for quantity in data.quantities:
                ours = made.models[side][quantity].coefficients
                gap = np.abs(matrix @ (ours - printed[quantity])).max()
                found.append(
                    {
                        "table": name,
                        "model": f"{data.name} {made.name}",
                        "side": side,
                        "quantity": quantity,
                        "ours": ours.tolist(),
                        "printed": printed[quantity].tolist(),
                        "largest_difference": float(gap),
                    }
                )
    return found


def held_out_errors() -> list[dict[str, Any]]:
    """Errors [%] of the 8-point regressions on points 1-4, Tables 3.7-3.10 and 5.9."""
    found = []
    for data, grid in ((KCS, "G1"), (KCS, "G2"), (KCS, "G3"), (ONRT, "G2")):
        made = fit(data, grid=grid, turbulence="SA")
        for side in data.sides:
            printed = printed_errors(data, grid, "SA", side)
            for quantity, ours in made.errors(side).items():
                found.append(
                    {
                        "table": "3.7-3.10" if data is KCS else "5.9",
                        "model": f"{data.name} {grid}_SA",
                        "side": side,
                        "quantity": quantity,
                        "ours": ours,
                        "printed": printed[quantity],
                    }
                )
    return found


def process_errors() -> list[dict[str, Any]]:
    """Mean errors [%] of the Gaussian process on points 1-4: Table 3.11 and chapter 5.

    The process is given the printed sigma_n, and 1e-4; ``sigma_n`` is ours beside it. Table 3.11
    has the second-order regression too.
    """
    found = []
    for data, side in ((KCS, SINGLE), *((ONRT, side) for side in ONRT.sides)):
        for quantity in printed_means(data, "printed", side):
            found.append(_process(data, side, quantity))
    return found


def _process(data: DataSet, side: str, quantity: str) -> dict[str, Any]:
    points = data.read("G2", "SA", side)
    training, held = points.pick(data.training), points.pick(data.validation)
    ours = []
    for noise in ("printed", "none"):
        model = GaussianProcess(noise_of(data, noise, side, quantity))
        model.fit(training.X, training.values[quantity])
        ours.append(mean_size(percent_error(held.values[quantity], model.predict(held.X)[0])))
    row = {
        "table": "3.11" if data is KCS else "chapter 5",
        "side": side,
        "quantity": quantity,
        "sigma_n": sigma_n(data, quantity, side),
        "printed_sigma_n": noise_of(data, "printed", side, quantity),
        "ours": ours,
        "printed": [printed_means(data, noise, side)[quantity] for noise in ("printed", "none")],
    }
    if data is KCS:
        mean = mean_size(fit(KCS).errors(side)[quantity])
        row["regression"] = [mean, printed_regression_means()[quantity]]
    return row


def budgets() -> list[dict[str, Any]]:
    """Grid, turbulence and regression error and their norm [%], with the printed norm of KCS."""
    found = []
    for data in (KCS, ONRT):
        printed, made = printed_totals(data), fit(data)
        for side in data.sides:
            for quantity in data.quantities:
                budget = error_budget(data, quantity, side, made.models[side][quantity])
                beside = {"model": data.name, "printed": printed.get(quantity)}
                found.append(budget.as_row() | beside)
    return found


def as_dict() -> dict[str, Any]:
    """All tables as plain data, for ``--json``."""
    return {
        "coefficients": coefficients(),
        "held_out_errors_percent": held_out_errors(),
        "process_errors_percent": process_errors(),
        "error_budget_percent": budgets(),
    }


def as_text(data: dict[str, Any]) -> str:
    """All tables for people, from `as_dict`: ours beside theirs."""
    missing = "Not recomputable, because the forces of their points are not printed: " + _MISSING
    return "\n\n".join(
        [
            _coefficient_text(data["coefficients"]),
            _error_text(data["held_out_errors_percent"]),
            _process_text(data["process_errors_percent"]),
            _budget_text(data["error_budget_percent"]),
            paragraph(missing),
        ]
    )


def _label(row: dict[str, Any]) -> str:
    """Propeller and quantity of a row."""
    side = row["side"]
    return row["quantity"] if side in ("", SINGLE) else f"{side} {row['quantity']}"


def _coefficient_text(rows: list[dict[str, Any]]) -> str:
    cells = []
    for row in rows:
        head = [row["table"], row["model"], _label(row)]
        cells.append(head + ["ours", *(f"{c:.4f}" for c in row["ours"]), ""])
        gap = f"{row['largest_difference']:.4f}"
        cells.append(["", "", "", "printed", *(f"{c:.4f}" for c in row["printed"]), gap])
    header = ["table", "model", "quantity", "", "1", "J", "J^2", "beta", "beta^2", "J beta"]
    return "\n".join(
        [
            "second-order regression of the 8 printed points, coefficients (beta in rad)",
            table([*header, "largest difference"], cells, left=4),
            paragraph(
                "largest difference: of the two regressions at the training points; the "
                "coefficients themselves are strongly correlated. The points have three printed "
                "decimals: half a digit is 0.0005. ONRT's rudder columns with Spalart-Allmaras "
                "differ by up to 0.0025: their fit used forces that are not printed. With k-omega "
                "SST they agree."
            ),
        ]
    )


def _error_text(rows: list[dict[str, Any]]) -> str:
    cells = []
    for row in rows:
        pairs = zip(row["ours"], row["printed"], strict=True)
        beside = [text for a, b in pairs for text in (f"{a:.2f}", f"{b:.2f}")]
        gap = max(abs(a - b) for a, b in zip(row["ours"], row["printed"], strict=True))
        cells.append([row["table"], row["model"], _label(row), *beside, f"{gap:.2f}"])
    points = [text for k in (1, 2, 3, 4) for text in (f"point {k}", "printed")]
    return "\n".join(
        [
            "error on points not trained on, 100 (CFD - model)/CFD [%]",
            table(["table", "model", "quantity", *points, "largest difference"], cells, left=3),
            paragraph(
                "C_Fx and C_Fy of point 2 on G3 contradict the thesis itself: its own coefficients "
                "(A.11) miss its printed errors there by 0.8 and 1.1 points. K_S of point 4, "
                "windward, is 0.009 with one printed digit: half a digit is 6 % of it."
            ),
        ]
    )


def _process_text(rows: list[dict[str, Any]]) -> str:
    cells = [
        [
            row["table"],
            _label(row),
            f"{row['sigma_n']:.4f}",
            f"{row['printed_sigma_n']:.3f}",
            *(f"{x:.2f}" for pair in zip(row["ours"], row["printed"], strict=True) for x in pair),
            *(f"{x:.2f}" for x in row.get("regression", ())),
            *([""] * (2 - len(row.get("regression", ())))),
        ]
        for row in rows
    ]
    header = ["table", "quantity", "sigma_n", "printed", "its error", "printed", "1e-4", "printed"]
    header += ["regression", "printed"]
    return "\n".join(
        [
            "Gaussian process, mean error on points 1-4 [%], with the printed sigma_n and 1e-4",
            table(header, cells, left=2),
            paragraph(
                "As MATLAB's fitrgp: constant mean by generalised least squares, one local search "
                "from the standard deviations of inputs and output (class GaussianProcess says "
                "where scikit-learn's defaults part from it, and what that costs)."
            ),
        ]
    )


def _budget_text(rows: list[dict[str, Any]]) -> str:
    cells = [
        [
            row["model"],
            _label(row),
            *(f"{row[k]:.2f}" for k in ("grid", "turbulence", "surrogate", "total")),
            "" if row["printed"] is None else f"{row['printed']:.2f}",
            f"{row['turbulence_points'][0]}-{row['turbulence_points'][-1]}",
        ]
        for row in rows
    ]
    header = ["ship", "quantity", "grid", "turbulence", "regression", "norm", "printed", "points"]
    return "\n".join(
        [
            "error budget, means over points 1-4 [%]; points: of the turbulence part",
            table(header, cells, left=2),
        ]
    )
