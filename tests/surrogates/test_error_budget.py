"""Error budget and noise of the samples beside the figures that Knight (2021) prints."""

import dataclasses
import math

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.reports.surrogate_printed import printed_errors, printed_totals
from ship_gym.surrogates.base import mean_size
from ship_gym.surrogates.error_budget import error_budget, sigma_n, sigma_n_limit
from ship_gym.surrogates.fit import Options, fit, noise_of
from ship_gym.surrogates.samples import KCS, ONRT, SINGLE


def budget_of(data, quantity, side=SINGLE, options=None):
    return error_budget(data, quantity, side, fit(data, options).errors(side)[quantity])


@pytest.mark.parametrize("quantity", KCS.quantities)
def test_norm_of_kcs_is_the_printed_one(quantity):
    budget = budget_of(KCS, quantity)
    assert budget.total == pytest.approx(printed_totals(KCS)[quantity], abs=0.07)
    assert budget.turbulence_points == KCS.validation


@pytest.mark.parametrize("quantity", KCS.quantities)
def test_the_surrogate_part_is_the_mean_of_the_printed_errors(quantity):
    """Tables 3.7-3.10, 8 points, G2."""
    expected = mean_size(printed_errors(KCS, "G2", "SA", SINGLE)[quantity])
    assert budget_of(KCS, quantity).surrogate == pytest.approx(expected, abs=0.15)


def test_parts_of_k_t_by_hand():
    """K_T of KCS at points 1-4 on G2 and G3 (Tables 3.3, 3.4) and with SST (Table 3.5)."""
    g2, g3, sst = (
        np.array(x)
        for x in (
            [0.330, 0.407, 0.272, 0.237],
            [0.327, 0.404, 0.266, 0.242],
            [0.330, 0.423, 0.317, 0.254],
        )
    )
    budget = budget_of(KCS, "K_T")
    assert budget.grid == pytest.approx(100 * np.mean(np.abs(g3 - g2) / g3))
    assert budget.turbulence == pytest.approx(100 * np.mean(np.abs(sst - g2) / g2))
    norm = math.sqrt(budget.grid**2 + budget.turbulence**2 + budget.surrogate**2)
    assert budget.total == pytest.approx(norm)


@pytest.mark.parametrize("side", ONRT.sides)
def test_budgets_of_onrt_take_the_turbulence_part_from_the_training_points(side):
    """SST was run at points 5-12 only; nothing is printed to compare with but the surrogate."""
    budget = budget_of(ONRT, "K_X", side)
    assert budget.turbulence_points == ONRT.training
    expected = mean_size(printed_errors(ONRT, "G2", "SA", side)["K_X"])
    assert budget.surrogate == pytest.approx(expected, abs=0.15)
    assert budget.total > max(budget.grid, budget.turbulence, budget.surrogate)


def test_budget_of_another_family_differs_in_its_surrogate_part_only():
    process = budget_of(KCS, "K_T", options=Options("gp", noise="none"))
    regression = budget_of(KCS, "K_T")
    assert (process.grid, process.turbulence) == (regression.grid, regression.turbulence)
    assert process.surrogate == pytest.approx(1.384, abs=0.1)  # Table 3.11, sigma_n 1e-4
    row = process.as_row()
    assert row["quantity"] == "K_T" and row["total"] == process.total


ONRT_NOISE = ("K_X", "K_S", "C_Fx", "C_Fy")  # C_Mz is not printed


@pytest.mark.parametrize("quantity", KCS.quantities)
def test_noise_of_kcs_by_the_printed_rule(quantity):
    """Section 3.2.5: standard deviations of grids and of turbulence models, added."""
    printed = noise_of(KCS, "printed", SINGLE, quantity)
    assert sigma_n(KCS, quantity, SINGLE) == pytest.approx(printed, abs=0.0006)
    assert noise_of(KCS, "computed", SINGLE, quantity) == sigma_n(KCS, quantity, SINGLE)
    assert 1.05 < sigma_n_limit(KCS, quantity, SINGLE) / printed < 1.26  # ours is not the rule


def test_noise_of_k_t_by_hand():
    """Tables 3.3 and 3.5: G3 - G2 of 12 points, SST - SA on G2 of 4."""
    g2 = [0.330, 0.407, 0.272, 0.237, 0.247, 0.309, 0.423, 0.340, 0.194, 0.320, 0.394, 0.214]
    g3 = [0.327, 0.404, 0.266, 0.242, 0.235, 0.316, 0.420, 0.339, 0.183, 0.322, 0.390, 0.206]
    sst = [0.330, 0.423, 0.317, 0.254]
    expected = np.std(np.subtract(g3, g2), ddof=1) + np.std(np.subtract(sst, g2[:4]), ddof=1)
    assert sigma_n(KCS, "K_T", SINGLE) == pytest.approx(expected)


@pytest.mark.parametrize("side", ONRT.sides)
@pytest.mark.parametrize("quantity", ONRT_NOISE)
def test_noise_of_onrt_is_printed_by_another_rule(quantity, side):
    """The limit within half a printed digit, and a little for the rounding of the forces."""
    printed = noise_of(ONRT, "printed", side, quantity)
    assert sigma_n_limit(ONRT, quantity, side) == pytest.approx(printed, abs=0.0007)


def test_the_printed_rule_does_not_give_the_noise_of_onrt():
    """Section 5.3.4 describes it as 3.2.5 does: 0.72 to 0.83 of the print to leeward.

    To windward 0.75 of the print for K_S, 1.09 for K_X, 1.36 and 1.45 for the rudder.
    """
    ratio = {
        (side, q): sigma_n(ONRT, q, side) / noise_of(ONRT, "printed", side, q)
        for side in ONRT.sides
        for q in ONRT_NOISE
    }
    leeward = [ratio["leeward", q] for q in ONRT_NOISE]
    assert 0.69 < min(leeward) and max(leeward) < 0.84
    windward = [ratio["windward", q] for q in ONRT_NOISE]
    assert windward == pytest.approx([1.09, 0.75, 1.45, 1.36], abs=0.01)


def test_what_the_thesis_does_not_print_follows_the_rule_of_its_neighbours():
    assert noise_of(ONRT, "printed", "leeward", "C_Mz") == sigma_n_limit(ONRT, "C_Mz", "leeward")


def test_bad_samples(tmp_path):
    text = KCS.path.read_text()
    path = tmp_path / "samples.csv"
    own = dataclasses.replace(KCS, path=path)
    path.write_text("\n".join(x for x in text.splitlines() if not x.startswith("3,")))
    with pytest.raises(ConfigError, match=r"points \[3\] must be there once"):
        error_budget(own, "K_T", SINGLE, [1.0, 1.0, 1.0, 1.0])
    path.write_text("\n".join(x for x in text.splitlines() if ",SST," not in x))
    for rule in (sigma_n, sigma_n_limit):
        with pytest.raises(ConfigError, match="0 points with both turbulence models"):
            rule(own, "K_T", SINGLE)
    path.write_text("\n".join(x for x in text.splitlines() if ",G3," not in x))
    with pytest.raises(ConfigError, match="0 points with both grids"):
        sigma_n(own, "K_T", SINGLE)
    assert noise_of(own, "computed", SINGLE, "K_T") == sigma_n_limit(own, "K_T", SINGLE)
    path.write_text(text.replace(",turbulence,", ",model,"))
    with pytest.raises(ConfigError, match="no column 'turbulence'"):
        sigma_n(own, "K_T", SINGLE)
