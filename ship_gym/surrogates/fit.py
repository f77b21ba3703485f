"""From printed CFD samples to the surrogate table that a ship reads."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from ship_gym.config import ConfigError, CsvTable, check_known, read_csv
from ship_gym.provenance import provenance, sha256
from ship_gym.ships.open_water import starred
from ship_gym.ships.particulars import Ship
from ship_gym.ships.records import SURROGATE_NAMES
from ship_gym.surrogates.base import held_out_score, percent_error
from ship_gym.surrogates.effective_inflow import (
    RudderSamples,
    fit_effective_inflow,
    rudder_frame,
)
from ship_gym.surrogates.regression import FEATURES, Regression
from ship_gym.tables import Axis, Table, tabulate

DATA = Path(__file__).parent / "data"
KCS_SAMPLES = DATA / "kcs_propeller_rudder_cfd.csv"
KCS_COEFFICIENTS = DATA / "kcs_regression_coefficients.csv"
QUANTITIES = ("K_T", "10K_Q", "C_Fx", "C_Fy")
VALIDATION, TRAINING = (1, 2, 3, 4), (5, 6, 7, 8, 9, 10, 11, 12)

# The surrogate fades into open water and the effective-inflow law over these margins of its box.
J_MARGIN = (0.1, 0.2)  # below and above
BETA_MARGIN = math.radians(10.0)
# It is trusted fully a little beyond the box, so that interpolation keeps it whole inside.
J_FULL, BETA_FULL = 0.02, math.radians(1.5)
GRID = (61, 53)  # points over advance angle and drift: 0.5 % of each range, checked by `tabulate`


def sample_set(samples: CsvTable, grid: str, turbulence: str, points) -> CsvTable:
    """Rows of some points on one grid with one turbulence model, in the order of the points."""
    check_known("grid", grid, sorted(set(samples.require("grid").columns["grid"])))
    check_known("turbulence model", turbulence, sorted(set(samples.columns["turbulence"])))
    rows = samples.where(grid=grid, turbulence=turbulence)
    order = [np.flatnonzero(rows.columns["point"] == point) for point in points]
    missing = [p for p, found in zip(points, order, strict=True) if len(found) != 1]
    if missing:
        raise ConfigError(
            f"{samples.path}: points {missing} of grid {grid}, {turbulence} must be there once"
        )
    return rows.select(np.concatenate(order))


def inputs(rows: CsvTable) -> np.ndarray:
    """Regression inputs (J [-], beta [rad]), shape (n, 2)."""
    rows.require("J", "beta")
    return np.stack([rows.si("J"), rows.si("beta")], axis=1)


def fit_regressions(rows: CsvTable, order: str = "second") -> dict[str, Regression]:
    """One regression for each of K_T, 10K_Q, C_Fx, C_Fy, from the rows of a training set."""
    rows.require(*QUANTITIES)
    check_known("regression order", order, FEATURES)
    X = inputs(rows)
    return {name: Regression(order).fit(X, rows.columns[name]) for name in QUANTITIES}


def printed_regressions(coefficients: CsvTable, model: str) -> dict[str, Regression]:
    """Regressions from the printed coefficients of one model (``"G2 SA"``), K_S included."""
    coefficients.require("model", "feature", "-10K_S", *QUANTITIES)
    check_known("printed model", model, sorted(set(coefficients.columns["model"])))
    rows = coefficients.where(model=model)
    found = {name: Regression("second", rows.columns[name]) for name in QUANTITIES}
    found["K_S"] = Regression("second", -0.1 * rows.columns["-10K_S"])
    return found


def trust(J, beta, box: dict[str, float]):
    """1 inside the trained box, falling smoothly to 0 over its margins."""

    def fade(x):
        x = np.clip(x, 0.0, 1.0)
        return 1.0 - x * x * (3.0 - 2.0 * x)

    low = (box["J_min"] - J - J_FULL) / (J_MARGIN[0] - J_FULL)
    high = (J - box["J_max"] - J_FULL) / (J_MARGIN[1] - J_FULL)
    left = (box["beta_min"] - beta - BETA_FULL) / (BETA_MARGIN - BETA_FULL)
    right = (beta - box["beta_max"] - BETA_FULL) / (BETA_MARGIN - BETA_FULL)
    return fade(np.maximum(low, high)) * fade(np.maximum(left, right))


def table_axes(box: dict[str, float]) -> tuple[Axis, Axis]:
    """Axes that end exactly where trust has fallen to zero, so that no kink lies inside."""
    low, high = (
        math.atan(J / (0.7 * math.pi))
        for J in (box["J_min"] - J_MARGIN[0], box["J_max"] + J_MARGIN[1])
    )
    left, right = box["beta_min"] - BETA_MARGIN, box["beta_max"] + BETA_MARGIN
    return (
        Axis("advance angle", low, (high - low) / (GRID[0] - 1), GRID[0]),
        Axis("drift angle", left, (right - left) / (GRID[1] - 1), GRID[1]),
    )


def surrogate_table(models: dict[str, Regression], box: dict[str, float], card: dict) -> Table:
    """Tabulate fitted models over their box and its margins; the table ends where trust is zero.

    Parameters
    ----------
    models : dict
        K_T, 10K_Q, C_Fx, C_Fy and, if known, K_S.
    box : dict
        Trained domain: J_min, J_max, beta_min, beta_max [rad], delta [rad], S_R [m2].
    card : dict
        Provenance.
    """

    def model(epsilon, beta):
        J = 0.7 * math.pi * np.tan(epsilon)
        X = np.stack([J.ravel(), beta.ravel()], axis=1)

        def value(name):
            return models[name].predict(X)[0].reshape(J.shape)

        C_N, C_A = rudder_frame(value("C_Fx"), value("C_Fy"), box["delta"])
        K_S = value("K_S") if "K_S" in models else np.zeros_like(J)
        return np.stack(
            [
                starred(value("K_T"), J),
                starred(0.1 * value("10K_Q"), J),
                starred(K_S, J),
                C_N,
                C_A,
                trust(J, beta, box),
            ],
            axis=-1,
        )

    # the weight of the fade is our own choice, so its interpolation error is no error of physics
    table = tabulate(model, table_axes(box), SURROGATE_NAMES, card, unchecked=("trust",))
    return Table(table.axes, table.names, table.values, {**table.card, "domain": box})


def fit_kcs(
    ship: Ship,
    *,
    grid: str = "G2",
    turbulence: str = "SA",
    order: str = "second",
    samples_path: str | Path = KCS_SAMPLES,
) -> Table:
    """Surrogate of KCS from the eight-point training set of Knight (2021).

    Where the forces of the training points are not printed (k-omega SST), the printed regression
    coefficients take their place. The side force K_S is known by its printed coefficients only.

    Parameters
    ----------
    ship : Ship
        ``load_ship("kcs_model", surrogate="none")``: wake and rudder constants of the law.
    grid, turbulence : str
        ``G1``, ``G2``, ``G3`` and ``SA``, ``SST``.
    """
    samples, printed = read_csv(samples_path), read_csv(KCS_COEFFICIENTS)
    name = f"{grid} {turbulence}"
    validation = sample_set(samples, grid, turbulence, VALIDATION)
    from_points = turbulence == "SA"
    if from_points:
        training = sample_set(samples, grid, turbulence, TRAINING)
        models = fit_regressions(training, order)
    else:
        training = sample_set(samples, grid, "SA", TRAINING)  # the places of the points only
        models = printed_regressions(printed, name)
    if name in set(printed.columns["model"]):
        models["K_S"] = printed_regressions(printed, name)["K_S"]
    return _table_with_card(ship, models, training, validation, from_points, order, samples_path)


def _table_with_card(ship, models, training, validation, from_points, order, samples_path) -> Table:
    X, delta = inputs(training), math.radians(35.0)
    law_samples = RudderSamples(
        J=X[:, 0],
        beta=X[:, 1],
        **{k: models[k].predict(X)[0] for k in ("K_T", "C_Fx", "C_Fy")}
        if not from_points
        else {k: training.columns[k] for k in ("K_T", "C_Fx", "C_Fy")},
        delta=delta,
        S_R=ship.rudder.A_R,
    )
    box = {
        "delta": delta,
        "S_R": ship.rudder.A_R,
        "J_min": 0.2,
        "J_max": 0.9,
        "beta_min": 0.0,
        "beta_max": math.radians(45.0),
    }
    X_v = inputs(validation)
    card = {
        "title": f"KCS propeller and rudder behind hull, rudder 35 deg, {order} order regression",
        "source": training.header["source"],
        "inputs": {Path(p).name: sha256(p) for p in (samples_path, KCS_COEFFICIENTS)},
        "training_points": [int(p) for p in training.columns["point"]],
        "trained_on": "printed forces" if from_points else "printed regression coefficients",
        "coefficients": {k: [float(c) for c in m.coefficients] for k, m in models.items()},
        "features": [f"J^{i} beta^{j}" for i, j in FEATURES[models["K_T"].order]],
        "held_out_points": [int(p) for p in validation.columns["point"]],
        "held_out_scores": {
            k: held_out_score(models[k], X_v, validation.columns[k]) for k in QUANTITIES
        },
        "held_out_errors_percent": {
            k: [
                round(float(e), 3)
                for e in percent_error(validation.columns[k], models[k].predict(X_v)[0])
            ]
            for k in QUANTITIES
        },
        "effective_inflow": fit_effective_inflow(law_samples, ship),
        "made_for": {
            "ship": ship.name,
            "L": ship.hull.L,
            "D": ship.propeller.D,
            **{k: getattr(ship.rudder, k) for k in ("A_R", "f_alpha", "eta")},
        },
        **provenance(),
    }
    return surrogate_table(models, box, card)
