"""The regressions of Knight (2021) from the printed CFD points, beside what the thesis prints."""

import dataclasses
import math

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.csv_file import read_csv
from ship_gym.reports.surrogate import SHIPPED
from ship_gym.reports.surrogate_printed import printed_errors
from ship_gym.ships import load_ship
from ship_gym.surrogates.fit import Options, fit, leave_one_out
from ship_gym.surrogates.force_table import table_of
from ship_gym.surrogates.regression import Regression, features
from ship_gym.surrogates.samples import (
    DATA_SETS,
    KCS,
    LEEWARD,
    ONRT,
    ONRT_16,
    SINGLE,
    WINDWARD,
    rudder_speed_squared,
)
from ship_gym.tables import Table

HALF_DIGIT = 0.0005  # the forces are printed with three decimals
ONRT_MODELS = [("G2", "SA"), ("G2", "SST"), ("G3", "SA")]  # Tables B.11, B.12, B.14
RUDDER = ("C_Fx", "C_Fy", "C_Mz")


def rounding_bound(X):
    """What half a digit in each printed force can move each coefficient, at most."""
    return np.abs(np.linalg.pinv(features(X))).sum(axis=1) * HALF_DIGIT


@pytest.mark.parametrize("grid", ["G2", "G3"])
@pytest.mark.parametrize("quantity", KCS.quantities)
def test_kcs_coefficients_are_the_printed_ones_within_the_rounding_of_the_points(grid, quantity):
    """Tables A.9 (G2) and A.11 (G3)."""
    found = fit(KCS, None, grid, "SA")
    ours = found.models[SINGLE][quantity].coefficients
    printed = KCS.printed(f"{grid}_SA")[quantity]
    assert (np.abs(ours - printed) <= rounding_bound(found.training[SINGLE].X)).all()


def test_kcs_sst_uses_the_printed_coefficients_and_says_so():
    """Table A.10; the forces of its training points are not printed."""
    found = fit(KCS, None, "G2", "SST")
    assert found.trained_on == "printed regression coefficients"
    for quantity, printed in KCS.printed("G2_SST").items():
        np.testing.assert_array_equal(found.models[SINGLE][quantity].coefficients, printed)
    # K_T of point 3, CFD 0.317, is predicted within the 2.4 % that the coefficients give
    assert abs(found.errors(SINGLE)["K_T"][2]) < 2.4
    card = load_ship("kcs_model", surrogate="G2_SST").surrogate.card
    assert card["trained_on"] == "printed regression coefficients"


def kcs_printed(grid, quantity):
    return np.array(printed_errors(KCS, grid, "SA", SINGLE)[quantity])


@pytest.mark.parametrize("grid", ["G1", "G2", "G3"])
@pytest.mark.parametrize("quantity", KCS.quantities)
def test_kcs_held_out_errors_are_the_printed_ones(grid, quantity):
    """Tables 3.7-3.10 within 0.4 percentage points, but for two cells that contradict the thesis.

    C_Fx and C_Fy of point 2 on G3: the coefficients that the thesis prints itself (A.11) miss its
    printed errors there by 0.8 and 1.1 points, so no fit can meet both. See the next test.
    """
    ours = np.array(fit(KCS, None, grid, "SA").errors(SINGLE)[quantity])
    difference = np.abs(ours - kcs_printed(grid, quantity))
    contradicted = grid == "G3" and quantity in ("C_Fx", "C_Fy")
    keep = [0, 2, 3] if contradicted else [0, 1, 2, 3]
    assert (difference[keep] < 0.4).all()


@pytest.mark.parametrize(("quantity", "gap"), [("C_Fx", 0.81), ("C_Fy", 1.09)])
def test_the_two_cells_contradict_the_thesis_itself(quantity, gap):
    model = Regression("second", KCS.printed("G3_SA")[quantity])
    found = dataclasses.replace(fit(KCS, None, "G3", "SA"), models={SINGLE: {quantity: model}})
    held = found.validation[SINGLE]
    held = dataclasses.replace(held, values={quantity: held.values[quantity]})
    errors = dataclasses.replace(found, validation={SINGLE: held}).errors(SINGLE)[quantity]
    difference = np.abs(np.array(errors) - kcs_printed("G3", quantity))
    # the CFD value of the point is rounded too: half a digit is 0.2 % of it
    assert difference[1] == pytest.approx(gap, abs=0.02) and difference[1] > 0.7
    assert (difference[[0, 2, 3]] < 0.25).all()


@pytest.mark.parametrize(("grid", "turbulence"), ONRT_MODELS)
@pytest.mark.parametrize("side", [LEEWARD, WINDWARD])
def test_onrt_propeller_coefficients_are_the_printed_ones(grid, turbulence, side):
    """K_X and K_S of Tables B.11, B.12, B.14 within the rounding of the points."""
    found = fit(ONRT, None, grid, turbulence)
    X = found.training[side].X
    for quantity in ("K_X", "K_S"):
        ours = found.models[side][quantity].coefficients
        printed = ONRT.printed(f"{grid}_{turbulence}", side)[quantity]
        assert (np.abs(ours - printed) <= rounding_bound(X)).all(), quantity
        assert np.abs(features(X) @ (ours - printed)).max() < 0.0006


@pytest.mark.parametrize(("grid", "turbulence"), ONRT_MODELS)
@pytest.mark.parametrize("side", [LEEWARD, WINDWARD])
def test_onrt_rudder_coefficients_are_the_printed_ones(grid, turbulence, side):
    """Within 0.0008 at the training points, with the rudder speed of the fitted K_X (5.3.1)."""
    found = fit(ONRT, None, grid, turbulence)
    matrix = features(found.training[side].X)
    for quantity in RUDDER:
        printed = ONRT.printed(f"{grid}_{turbulence}", side)[quantity]
        difference = found.models[side][quantity].coefficients - printed
        assert np.abs(matrix @ difference).max() < 0.0008, quantity


def test_another_rudder_speed_leaves_the_force_and_the_propeller_as_they_are():
    """C u_R^2 is the force; (u_R/u)^2 at J 0.6, 24.063 deg and K_X 0.388 is 3.944 by hand."""
    samples = ONRT.read("G2", "SA", LEEWARD).pick((7,))
    assert rudder_speed_squared(samples.X, samples.values["K_X"])[0] == pytest.approx(
        3.9439, abs=1e-3
    )
    other = samples.by_rudder_speed_of("K_X", np.array([0.5]))
    for quantity in RUDDER:
        forces = [
            s.values[quantity] * rudder_speed_squared(samples.X, K)
            for s, K in ((samples, samples.values["K_X"]), (other, np.array([0.5])))
        ]
        assert forces[0] == pytest.approx(forces[1])
    assert other.values["K_S"] == samples.values["K_S"]


def test_with_the_rudder_speed_of_the_cfd_they_are_not():
    """That of the file misses the printed regressions by 0.0025, a linear u_Rx by 0.0031."""
    found, worst = fit(ONRT, None, "G3", "SA"), {"file": 0.0, "linear": 0.0}
    for side, training in found.training.items():
        J, beta = training.X.T
        inflow = [
            (1.0 + 8.0 * K / (math.pi * J**2)) ** 2 + np.tan(beta) ** 2
            for K in (training.values["K_X"], found.models[side]["K_X"].predict(training.X)[0])
        ]
        for quantity in RUDDER:
            y, printed = training.values[quantity], ONRT.printed("G3_SA", side)[quantity]
            for name, values in (("file", y), ("linear", y * inflow[0] / inflow[1])):
                difference = Regression().fit(training.X, values).coefficients - printed
                size = np.abs(features(training.X) @ difference).max()
                worst[name] = max(worst[name], size)
    assert worst["file"] == pytest.approx(0.00245, abs=5e-5)
    assert worst["linear"] == pytest.approx(0.0031, abs=5e-5)


def test_the_16_points_of_onrt_are_their_printed_coefficients():
    """Table B.13 at the places of Table B.1."""
    found = fit(ONRT_16)
    assert (found.name, found.trained_on) == ("G2_SA_16", "printed regression coefficients")
    assert found.training[LEEWARD].points.tolist() == list(range(13, 29))
    printed = found.models[WINDWARD]["C_Fy"].coefficients
    assert printed[[0, 5]] == pytest.approx([-0.21386999, 0.22001389])
    with pytest.raises(ConfigError, match="'regression', 'second'"):
        fit(ONRT_16, Options("gp"))
    assert load_ship("onrt_model", surrogate="G2_SA_16").surrogate is not None


def onrt_gap(side, quantity):
    """Our held-out errors less those of Table 5.9 [percentage points], points 1-4."""
    return fit(ONRT).errors(side)[quantity] - np.array(
        printed_errors(ONRT, "G2", "SA", side)[quantity]
    )


@pytest.mark.parametrize("side", [LEEWARD, WINDWARD])
def test_onrt_axial_errors_are_the_printed_ones(side):
    """Table 5.9, K_X: 0.4 points are explained by three digits; the largest gap is 0.21."""
    assert np.abs(onrt_gap(side, "K_X")).max() < 0.25


@pytest.mark.parametrize("side", [LEEWARD, WINDWARD])
def test_onrt_side_force_errors_are_the_printed_ones_but_for_one_digit(side):
    """Table 5.9, K_S within 1.1 points; windward point 4 misses by 8.75.

    K_S is 0.006 to 0.15. At that point it is printed as 0.009, of which half a digit is 5.6 %.
    """
    gap = onrt_gap(side, "K_S")
    if side == WINDWARD:
        value = fit(ONRT).validation[side].values["K_S"][3]
        assert value == 0.009 and gap[3] == pytest.approx(-8.75, abs=0.05)
        gap = gap[:3]
    assert np.abs(gap).max() < 1.1


@pytest.mark.parametrize("side", [LEEWARD, WINDWARD])
@pytest.mark.parametrize("quantity", RUDDER)
def test_onrt_rudder_errors_are_the_printed_ones_to_half_a_point(side, quantity):
    """Table 5.9; with the coefficients printed in B.11 the 24 cells agree to 0.22 points.

    The rest is the rounding of the forces: see tests/reproduce/test_printed_findings.py.
    """
    assert np.abs(onrt_gap(side, quantity)).max() < 0.5


def test_sides_and_axes_of_onrt():
    """The port propeller is to leeward in the samples' turn to port; side forces change sign."""
    leeward, windward = (ONRT.read("G2", "SA", side) for side in (LEEWARD, WINDWARD))
    rows = read_csv(ONRT.path).where(grid="G2", turbulence="SA", side="port", point=1.0)
    assert leeward.pick((1,)).values["K_S"][0] == rows.columns["K_S"][0]
    assert ONRT.sign == -1.0 and (leeward.values["C_Fy"] < 0.0).all()
    # the leeward propeller loses thrust in the turn, the windward one gains (Table 5.3)
    assert leeward.values["K_X"].mean() < windward.values["K_X"].mean()


@pytest.mark.parametrize(
    ("name", "family", "grid", "turbulence"),
    [pytest.param(*row, marks=[pytest.mark.slow] if row[1] == "nn" else []) for row in SHIPPED],
)
def test_refitting_gives_the_shipped_table_back(name, family, grid, turbulence):
    data = DATA_SETS[name]
    found = fit(data, Options(family), grid, turbulence)
    shipped = load_ship(data.ship, surrogate=found.name).surrogate
    again = table_of(found, load_ship(data.ship, surrogate="none"))
    assert again.axes == shipped.axes and again.names == shipped.names
    atol = 1e-9 if family == "regression" else 1e-6
    np.testing.assert_allclose(again.values, shipped.values, rtol=0, atol=atol)
    assert again.card["inputs"] == shipped.card["inputs"]


def test_the_table_is_the_regression_to_half_a_percent_of_its_range():
    card = load_ship("kcs_model").surrogate.card
    errors = card["interpolation_error"]
    assert all(errors[name] < 0.005 for name in ("C_T", "C_Q", "C_S", "C_N", "C_A"))


@pytest.fixture(scope="module")
def kcs_card():
    return table_of(fit(KCS), load_ship("kcs_model", surrogate="none")).card


def test_effective_inflow_reproduces_the_normal_force(kcs_card):
    """Mean error 5 % as in the design's prototype; its 8 % everywhere is not reached.

    The law with one gamma_R misses at the edges of the box: 14 % low at 42 deg of drift (point 8),
    11 % high at J 0.24 (point 7). The other six of the eight training points are within 8 %. At the
    trained angle this does not matter: there the regression stands in for the law.
    """
    law = kcs_card["effective_inflow"]
    errors = np.abs(law["errors_percent"][SINGLE])
    assert law["mean_abs_error_percent"] == pytest.approx(errors.mean(), abs=1e-2)
    assert errors.mean() < 5.5
    edges = [KCS.training.index(7), KCS.training.index(8)]
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


def test_leave_one_out_of_a_regression_is_that_of_the_hat_matrix():
    """Residual / (1 - leverage): the textbook identity of linear least squares (PRESS)."""
    samples = fit(KCS).training[SINGLE]
    y, matrix = samples.values["K_T"], features(samples.X)
    hat = matrix @ np.linalg.pinv(matrix)
    expected = y - (y - hat @ y) / (1.0 - np.diag(hat))
    np.testing.assert_allclose(leave_one_out(Regression, samples.X, y), expected, atol=1e-9)


def test_bad_samples(tmp_path):
    with pytest.raises(ConfigError, match="did you mean 'G2'"):
        fit(KCS, None, "G22", "SA")
    with pytest.raises(ConfigError, match="regression order"):
        Options(order="fifth")
    with pytest.raises(ConfigError, match="surrogate family"):
        Options("forest")
    with pytest.raises(ConfigError, match=r"points \[.*\] must be there once"):
        fit(KCS, None, "G1", "SST")
    with pytest.raises(ConfigError, match="8 points given"):
        fit(KCS, Options(order="third"))
    with pytest.raises(ConfigError, match="6 features, but 5 points"):
        Regression().fit(np.zeros((5, 2)), np.zeros(5))
    with pytest.raises(ConfigError, match="collinear or repeated"):
        Regression().fit(np.ones((8, 2)), np.zeros(8))
    text = KCS.path.read_text()
    (tmp_path / "bare.csv").write_text("\n".join(x for x in text.split("\n") if x[:1] != "#"))
    with pytest.raises(ConfigError, match="# title"):
        fit(dataclasses.replace(KCS, path=tmp_path / "bare.csv"))
    (tmp_path / "column.csv").write_text(text.replace("C_Fy [-]", "C_Fz [-]"))
    with pytest.raises(ConfigError, match=r"no column 'C_Fy'; did you mean"):
        fit(dataclasses.replace(KCS, path=tmp_path / "column.csv"))


def test_card_says_where_the_table_comes_from(kcs_card):
    assert "Knight" in kcs_card["source"] and kcs_card["training_points"] == list(KCS.training)
    assert len(kcs_card["git_commit"]) >= 15 and "numpy" in kcs_card["versions"]
    assert kcs_card["domain"]["delta"] == math.radians(35.0)
    assert isinstance(load_ship("kcs_model").surrogate, Table)


def test_names_of_fits():
    assert fit(KCS).name == "G2_SA"
    assert fit(KCS, Options(order="first"), "G3", "SA").name == "G3_SA_first"
    assert fit(KCS, Options("gp", noise="none")).name == "gp_exact"
