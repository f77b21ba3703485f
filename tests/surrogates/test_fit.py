"""The regression of Knight (2021) from the printed CFD points, beside what the thesis prints."""

import math
from pathlib import Path

import numpy as np
import pytest

from ship_gym.config import ConfigError, read_csv
from ship_gym.ships import load_ship
from ship_gym.surrogates.base import percent_error
from ship_gym.surrogates.fit import (
    KCS_COEFFICIENTS,
    KCS_SAMPLES,
    QUANTITIES,
    TRAINING,
    VALIDATION,
    fit_kcs,
    fit_regressions,
    inputs,
    printed_regressions,
    sample_set,
)
from ship_gym.surrogates.regression import Regression, features
from ship_gym.tables import Table

HALF_DIGIT = 0.0005  # the forces are printed with three decimals
PRINTED_ERRORS = Path(__file__).parents[1] / "data" / "kcs_regression_error.csv"


@pytest.fixture(scope="module")
def samples():
    return read_csv(KCS_SAMPLES)


def fitted(samples, grid):
    return fit_regressions(sample_set(samples, grid, "SA", TRAINING))


@pytest.mark.parametrize("grid", ["G2", "G3"])
@pytest.mark.parametrize("quantity", QUANTITIES)
def test_coefficients_are_the_printed_ones_within_the_rounding_of_the_points(
    samples, grid, quantity
):
    """Tables A.9 (G2) and A.11 (G3): what half a digit in each printed force can move, at most."""
    ours = fitted(samples, grid)[quantity].coefficients
    printed = printed_regressions(read_csv(KCS_COEFFICIENTS), f"{grid} SA")[quantity].coefficients
    X = inputs(sample_set(samples, grid, "SA", TRAINING))
    bound = np.abs(np.linalg.pinv(features(X))).sum(axis=1) * HALF_DIGIT
    assert (np.abs(ours - printed) <= bound).all()


def printed_errors(grid, quantity):
    table = read_csv(PRINTED_ERRORS).where(quantity=quantity)
    return table.columns[f"8pt {grid}"]


@pytest.mark.parametrize("grid", ["G1", "G2", "G3"])
@pytest.mark.parametrize("quantity", QUANTITIES)
def test_held_out_errors_are_the_printed_ones(samples, grid, quantity):
    """Tables 3.7-3.10 within 0.5 percentage points, but for two cells that contradict the thesis.

    C_Fx and C_Fy of point 2 on G3: the coefficients that the thesis prints itself (A.11) miss its
    printed errors there by 0.8 and 1.1 points, so no fit can meet both. See the next test.
    """
    rows = sample_set(samples, grid, "SA", VALIDATION)
    model = fitted(samples, grid)[quantity]
    ours = percent_error(rows.columns[quantity], model.predict(inputs(rows))[0])
    difference = np.abs(ours - printed_errors(grid, quantity))
    contradicted = grid == "G3" and quantity in ("C_Fx", "C_Fy")
    keep = [0, 2, 3] if contradicted else [0, 1, 2, 3]
    assert (difference[keep] < 0.5).all()


@pytest.mark.parametrize(("quantity", "gap"), [("C_Fx", 0.81), ("C_Fy", 1.09)])
def test_the_two_cells_contradict_the_thesis_itself(samples, quantity, gap):
    rows = sample_set(samples, "G3", "SA", VALIDATION)
    printed = printed_regressions(read_csv(KCS_COEFFICIENTS), "G3 SA")[quantity]
    errors = percent_error(rows.columns[quantity], printed.predict(inputs(rows))[0])
    difference = np.abs(errors - printed_errors("G3", quantity))
    # the CFD value of the point is rounded too: half a digit is 0.2 % of it
    assert difference[1] == pytest.approx(gap, abs=0.02) and difference[1] > 0.7
    assert (difference[[0, 2, 3]] < 0.25).all()


@pytest.mark.parametrize(("grid", "turbulence"), [("G1", "SA"), ("G2", "SA"), ("G3", "SA")])
def test_refitting_gives_the_shipped_table_back(grid, turbulence):
    ship = load_ship("kcs_model", surrogate="none")
    shipped = load_ship("kcs_model", surrogate=f"{grid}_{turbulence}").surrogate
    again = fit_kcs(ship, grid=grid, turbulence=turbulence)
    assert again.axes == shipped.axes and again.names == shipped.names
    np.testing.assert_allclose(again.values, shipped.values, rtol=0, atol=1e-9)
    assert again.card["inputs"] == shipped.card["inputs"]


def test_sst_uses_the_printed_coefficients_and_says_so():
    shipped = load_ship("kcs_model", surrogate="G2_SST").surrogate
    assert shipped.card["trained_on"] == "printed regression coefficients"
    # K_T of point 3, CFD 0.317, is predicted within the 2.4 % that the coefficients give
    assert abs(shipped.card["held_out_errors_percent"]["K_T"][2]) < 2.4


def test_the_table_is_the_regression_to_half_a_percent_of_its_range():
    card = load_ship("kcs_model").surrogate.card
    errors = card["interpolation_error"]
    assert all(errors[name] < 0.005 for name in ("C_T", "C_Q", "C_S", "C_N", "C_A"))


def test_effective_inflow_reproduces_the_normal_force():
    """Mean error 5 % as in the design's prototype; its 8 % everywhere is not reached.

    The law with one gamma_R misses at the edges of the box: 14 % low at 42 deg of drift (point 8),
    11 % high at J 0.24 (point 7). The other six of the eight training points are within 8 %. At the
    trained angle this does not matter: there the regression stands in for the law.
    """
    law = load_ship("kcs_model").surrogate.card["effective_inflow"]
    errors = np.abs(law["errors_percent"])
    assert law["mean_abs_error_percent"] == pytest.approx(errors.mean(), abs=1e-2)
    assert errors.mean() < 5.5
    edges = [TRAINING.index(7), TRAINING.index(8)]
    assert (np.delete(errors, edges) < 8.0).all() and (errors[edges] < 15.0).all()


def test_regression_predicts_its_own_polynomial_with_no_spread():
    rng = np.random.default_rng(1)
    X = rng.uniform([0.2, 0.0], [0.9, 0.8], (12, 2))
    truth = Regression(coefficients=[1.0, -2.0, 0.5, 0.3, -0.1, 0.7])
    y = truth.predict(X)[0]
    model = Regression().fit(X, y)
    np.testing.assert_allclose(model.coefficients, truth.coefficients, atol=1e-9)
    mean, std = model.predict(X)
    np.testing.assert_allclose(mean, y, atol=1e-12)
    assert (std < 1e-9).all()


def test_bad_samples(samples, tmp_path):
    ship = load_ship("kcs_model", surrogate="none")
    with pytest.raises(ConfigError, match="did you mean 'G2'"):
        fit_kcs(ship, grid="G22")
    with pytest.raises(ConfigError, match="regression order"):
        fit_kcs(ship, order="fifth")
    with pytest.raises(ConfigError, match="6 features, but 5 points"):
        Regression().fit(np.zeros((5, 2)), np.zeros(5))
    with pytest.raises(ConfigError, match="collinear or repeated"):
        Regression().fit(np.ones((8, 2)), np.zeros(8))
    text = KCS_SAMPLES.read_text()
    (tmp_path / "bare.csv").write_text("\n".join(x for x in text.split("\n") if x[:1] != "#"))
    with pytest.raises(ConfigError, match="# title"):
        fit_kcs(ship, samples_path=tmp_path / "bare.csv")
    (tmp_path / "column.csv").write_text(text.replace("C_Fy [-]", "C_Fz [-]"))
    with pytest.raises(ConfigError, match=r"no column 'C_Fy'; did you mean"):
        fit_kcs(ship, samples_path=tmp_path / "column.csv")


def test_card_says_where_the_table_comes_from():
    card = load_ship("kcs_model").surrogate.card
    assert "Knight" in card["source"] and card["training_points"] == list(TRAINING)
    assert len(card["git_commit"]) >= 15 and "numpy" in card["versions"]
    assert card["domain"]["delta"] == math.radians(35.0)
    assert isinstance(load_ship("kcs_model").surrogate, Table)
