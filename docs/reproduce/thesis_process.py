"""Gaussian process of Knight (2021) and its noise, beside what he prints of them."""

from __future__ import annotations

from typing import Any

import numpy as np

from reproduce.rounding import HALF_DIGIT, count_text, counted, only, reach
from reproduce.thesis_fits import fitted, label, needed, reach_of_errors
from ship_gym.reports.surrogate_printed import printed_means, printed_regression_means
from ship_gym.surrogates.base import mean_size, percent_error
from ship_gym.surrogates.error_budget import sigma_n, sigma_n_limit
from ship_gym.surrogates.fit import Options, comparable, fit, new_model, noise_of
from ship_gym.surrogates.samples import KCS, ONRT, SINGLE, DataSet, Samples
from ship_gym.text import paragraph, table


def process_errors() -> list[dict[str, Any]]:
    """Mean errors [%] of the Gaussian process on points 1-4: Table 3.11 and section 5.3.4.

    The process is given the printed sigma_n, and 1e-4; ``sigma_n`` is by the printed rule,
    ``limit`` by ours (``error_budget``). Table 3.11 has the second-order regression too.
    """
    found = []
    for data, side in ((KCS, SINGLE), *((ONRT, side) for side in ONRT.sides)):
        for quantity in printed_means(data, "printed", side):
            found.append(_process(data, side, quantity))
    return found


def _process(data: DataSet, side: str, quantity: str) -> dict[str, Any]:
    ours = [_mean_of_process(data, noise, side, quantity) for noise in ("printed", "none")]
    printed = [printed_means(data, noise, side)[quantity] for noise in ("printed", "none")]
    row = {
        "table": "3.11" if data is KCS else "5.3.4",
        "side": side,
        "quantity": quantity,
        "sigma_n": sigma_n(data, quantity, side),
        "limit": sigma_n_limit(data, quantity, side),
        "printed_sigma_n": noise_of(data, "printed", side, quantity),
        "ours": [mean for mean, _ in ours],
        "printed": printed,
    }
    if data is KCS:
        made = fit(KCS)
        mean = mean_size(np.array(made.errors(side)[quantity]))
        moved = reach_of_errors(made, side, quantity).mean()
        row["regression"] = [mean, printed_regression_means()[quantity]]
        ours, printed = [*ours, (mean, moved)], [*printed, row["regression"][1]]
    half = HALF_DIGIT if data is KCS else 10.0 * HALF_DIGIT  # three decimals, and two
    row["within"] = [
        bool(abs(mean - theirs) <= moved + half)
        for (mean, moved), theirs in zip(ours, printed, strict=True)
    ]
    return row


def _mean_of_process(data: DataSet, noise: str, side: str, quantity: str) -> tuple[float, float]:
    """Mean error of the process [%], and how far the digits of its forces move it.

    Those of the thrust, by whose rudder speed a rudder is fitted, are left out: each costs two more
    searches for the length scales.
    """
    points, options = data.read("G2", "SA", side), Options("gp", noise=noise)
    names = needed(data, quantity)
    training, held = (only(points.pick(p), *names) for p in (data.training, data.validation))
    models = fitted(data, options, side, quantity, training)
    prepared, truth = (only(comparable(data, s, models), quantity) for s in (training, held))

    def mean(model, samples: Samples) -> np.ndarray:
        errors = percent_error(samples.values[quantity], model.predict(samples.X)[0])
        return np.array([mean_size(errors)])

    def refitted(samples: Samples) -> np.ndarray:
        model = new_model(data, options, side, quantity)
        return mean(model.fit(samples.X, samples.values[quantity]), truth)

    model = models[quantity]
    moved = reach(refitted, prepared) + reach(lambda samples: mean(model, samples), truth)
    return float(mean(model, truth)[0]), float(moved[0])


def process_text(rows: list[dict[str, Any]]) -> str:
    """Process: noise by both rules, and errors, ours beside theirs."""
    cells = [
        [
            row["table"],
            label(row),
            *(f"{row[k]:.4f}" for k in ("sigma_n", "limit")),
            f"{row['printed_sigma_n']:.3f}",
            *(f"{x:.2f}" for pair in zip(row["ours"], row["printed"], strict=True) for x in pair),
            *(f"{x:.2f}" for x in row.get("regression", ())),
            *([""] * (2 - len(row.get("regression", ())))),
        ]
        for row in rows
    ]
    header = ["table", "quantity", "sigma_n, its rule", "95 % limit", "printed", "its error"]
    header += ["printed", "1e-4", "printed", "regression", "printed"]
    return "\n".join(
        [
            "Gaussian process, mean error on points 1-4 [%], with the printed sigma_n and 1e-4",
            table(header, cells, left=2),
            paragraph(
                count_text(counted(rows)) + " Its rule (3.2.5, 5.3.4): standard deviation of the "
                "differences of grids plus that of the turbulence models; it gives the values of "
                "KCS and not those of ONRT. 95 % limit: upper limit of the turbulence part alone, "
                "ours; it gives the values of ONRT and not those of KCS. As MATLAB's fitrgp: "
                "constant mean by generalised least squares, one local search from the standard "
                "deviations of inputs and output (class GaussianProcess says where scikit-learn's "
                "defaults part from it, and what that costs). Table 3.11 has the rudder's movable "
                "part, whose forces are not in the thesis."
            ),
        ]
    )
