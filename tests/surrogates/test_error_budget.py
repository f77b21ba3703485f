"""Error budget and noise of the samples beside the figures that Knight (2021) prints."""

import math
from pathlib import Path

import numpy as np
import pytest

from ship_gym.config import ConfigError, read_csv
from ship_gym.surrogates.error_budget import error_budget, error_budgets, sigma_n
from ship_gym.surrogates.gaussian_process import GaussianProcess

PRINTED = Path(__file__).parents[1] / "data"
SAMPLES = Path(__file__).parents[2] / "ship_gym" / "surrogates" / "data"
KCS_QUANTITIES = ("K_T", "10K_Q", "C_Fx", "C_Fy")
ONRT_QUANTITIES = ("K_X", "K_S", "C_Fx", "C_Fy", "C_Mz")
VALIDATION, TRAINING = (1, 2, 3, 4), (5, 6, 7, 8, 9, 10, 11, 12)


@pytest.fixture(scope="module")
def kcs():
    return read_csv(SAMPLES / "kcs_propeller_rudder_cfd.csv")


@pytest.fixture(scope="module")
def onrt():
    return read_csv(SAMPLES / "onrt_propeller_rudder_cfd.csv")


def printed(quantity, column):
    return float(read_csv(PRINTED / "error_budget.csv").where(quantity=quantity).columns[column][0])


@pytest.mark.parametrize("quantity", KCS_QUANTITIES)
def test_norm_of_kcs_is_the_printed_one(kcs, quantity):
    budget = error_budget(kcs, quantity)
    assert budget.total == pytest.approx(printed(quantity, "total"), abs=0.07)
    assert budget.turbulence_points == VALIDATION


@pytest.mark.parametrize("quantity", KCS_QUANTITIES)
def test_the_surrogate_part_is_the_mean_of_the_printed_errors(kcs, quantity):
    """Tables 3.7-3.10, 8 points, G2."""
    errors = read_csv(PRINTED / "kcs_regression_error.csv").where(quantity=quantity)
    expected = np.abs(errors.columns["8pt G2"]).mean()
    assert error_budget(kcs, quantity).surrogate == pytest.approx(expected, abs=0.15)


def test_parts_of_k_t_by_hand(kcs):
    """K_T of KCS at points 1-4 on G2 and G3 (Tables 3.3, 3.4) and with SST (Table 3.5)."""
    g2, g3, sst = (
        np.array(x)
        for x in (
            [0.330, 0.407, 0.272, 0.237],
            [0.327, 0.404, 0.266, 0.242],
            [0.330, 0.423, 0.317, 0.254],
        )
    )
    budget = error_budget(kcs, "K_T")
    assert budget.grid == pytest.approx(100 * np.mean(np.abs(g3 - g2) / g3))
    assert budget.turbulence == pytest.approx(100 * np.mean(np.abs(sst - g2) / g2))
    norm = math.sqrt(budget.grid**2 + budget.turbulence**2 + budget.surrogate**2)
    assert budget.total == pytest.approx(norm)


def test_budgets_of_onrt_take_the_turbulence_part_from_the_training_points(onrt):
    """SST was run at points 5-12 only; nothing is printed to compare with but the surrogate."""
    budgets = error_budgets(onrt, ONRT_QUANTITIES, ("port", "starboard"))
    assert [(b.side, b.quantity) for b in budgets] == [
        (side, q) for side in ("port", "starboard") for q in ONRT_QUANTITIES
    ]
    assert all(b.turbulence_points == TRAINING for b in budgets)
    rows = read_csv(PRINTED / "onrt_regression_error.csv").where(set=8.0, quantity="K_X")
    for side in ("port", "starboard"):
        mine = rows.where(side=side)
        expected = np.mean([abs(mine.columns[f"point {i}"][0]) for i in VALIDATION])
        ours = next(b for b in budgets if b.side == side and b.quantity == "K_X")
        assert ours.surrogate == pytest.approx(expected, abs=0.15)
        assert ours.total > max(ours.grid, ours.turbulence, ours.surrogate)


def test_budget_of_another_family_differs_in_its_surrogate_part_only(kcs):
    process, regression = error_budget(kcs, "K_T", model=GaussianProcess), error_budget(kcs, "K_T")
    assert (process.grid, process.turbulence) == (regression.grid, regression.turbulence)
    assert process.surrogate == pytest.approx(1.384, abs=0.1)  # Table 3.11, sigma_n 1e-4
    row = process.as_row()
    assert row["quantity"] == "K_T" and row["total"] == process.total


@pytest.mark.parametrize("side", ["port", "starboard"])
@pytest.mark.parametrize("quantity", ["K_X", "K_S", "C_Fx", "C_Fy"])
def test_noise_of_onrt_is_the_printed_one(onrt, quantity, side):
    """Within half a printed digit, and a little for the rounding of the forces."""
    rows = read_csv(PRINTED / "onrt_surrogate_comparison.csv").where(side=side, quantity=quantity)
    assert sigma_n(onrt, quantity, side) == pytest.approx(rows.columns["sigma_n"][0], abs=0.0007)


@pytest.mark.parametrize(
    ("quantity", "ours"),
    [("K_T", 0.0286), ("10K_Q", 0.0424), ("C_Fx", 0.0565), ("C_Fy", 0.0836)],
)
def test_noise_of_kcs_is_not_the_printed_one(kcs, quantity, ours):
    """6 to 25 % above: the thesis' SST forces at its training points are not printed."""
    value = sigma_n(kcs, quantity)
    assert value == pytest.approx(ours, abs=1e-4)
    assert 1.05 < value / printed(quantity, "sigma_n") < 1.26


def test_bad_samples(kcs, onrt):
    with pytest.raises(ConfigError, match="no column 'K_X'"):
        error_budget(kcs, "K_X")
    with pytest.raises(ConfigError, match="no column 'side'"):
        error_budget(kcs, "K_T", "port")
    with pytest.raises(ConfigError, match=r"points \[3\] of G2 SA must be there once for K_T"):
        error_budget(kcs.select(kcs.columns["point"] != 3), "K_T")
    with pytest.raises(ConfigError, match="0 points with both SA and SST"):
        sigma_n(onrt.where(turbulence="SA"), "K_X", "port")
    with pytest.raises(ConfigError, match="unknown side"):
        sigma_n(onrt, "K_X", "bow")
    with pytest.raises(ConfigError, match=r"unknown side .* Known: port, starboard"):
        sigma_n(onrt, "K_X")
