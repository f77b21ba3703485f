"""Dear samples on top of cheap ones: the joint normal distribution, and the grids of KCS."""

import numpy as np
import pytest

from ship_gym.surrogates.base import held_out_score
from ship_gym.surrogates.gaussian_process import GaussianProcess
from ship_gym.surrogates.samples import KCS
from ship_gym.surrogates.two_fidelities import TwoFidelities

RNG = np.random.default_rng(4)
CHEAP = RNG.uniform([0.2, 0.0], [0.9, 0.8], (20, 2))
DEAR = CHEAP[:7]
Z = RNG.uniform([0.2, 0.0], [0.9, 0.8], (30, 2))


def coarse(X):
    return np.sin(3.0 * X[:, 0]) + X[:, 1] ** 2


def fine(X):
    return 1.3 * coarse(X) + 0.2 - 0.1 * X[:, 0]


@pytest.fixture(scope="module")
def both():
    cheap = GaussianProcess().fit(CHEAP, coarse(CHEAP))
    return TwoFidelities(cheap).fit(DEAR, fine(DEAR))


def squared_exponential(model, A, B):
    distance = ((A[:, None] - B[None]) / model.length_scales) ** 2
    return model.sigma_f**2 * np.exp(-0.5 * distance.sum(axis=-1))


def test_nested_sets_give_the_joint_distribution_of_kennedy_and_ohagan(both):
    """Condition the normal distribution of cheap and dear values on all of them at once.

    cov(y_c, y_c') = k_c, cov(y_c, y_d) = rho k_c, cov(y_d, y_d') = rho^2 k_c + k_f, each set with a
    constant of flat prior; rho as fitted.
    """
    cheap, rho = both.cheap, both.rho

    def k_c(A, B):
        return squared_exponential(cheap, A, B) + 1e4

    def k_d(A, B):
        return rho**2 * k_c(A, B) + squared_exponential(both, A, B) + 1e4

    C = np.block(
        [[k_c(CHEAP, CHEAP), rho * k_c(CHEAP, DEAR)], [rho * k_c(DEAR, CHEAP), k_d(DEAR, DEAR)]]
    )
    noise = np.concatenate([np.full(20, 1e-4**2), np.full(7, 1e-4**2)])
    cross = np.hstack([rho * k_c(Z, CHEAP), k_d(Z, DEAR)])
    weights = np.linalg.solve(C + np.diag(noise), cross.T)
    mean, std = both.predict(Z)
    y = np.concatenate([coarse(CHEAP), fine(DEAR)])
    np.testing.assert_allclose(mean, weights.T @ y, atol=2e-3)
    variance = np.diag(k_d(Z, Z) - cross @ weights)
    # ours has in addition what is not known of rho
    assert (std**2 > variance - 1e-5).all() and np.median(std) < 2.0 * np.sqrt(np.median(variance))


def test_the_cheap_process_carries_the_shape(both):
    """Seven dear points alone miss it by four times as much and more."""
    alone = GaussianProcess().fit(DEAR, fine(DEAR))
    error, error_alone = (np.abs(m.predict(Z)[0] - fine(Z)).max() for m in (both, alone))
    assert both.rho == pytest.approx(1.3, abs=0.1)
    assert error < 0.25 * error_alone
    mean, _ = both.predict(DEAR)
    np.testing.assert_allclose(mean, fine(DEAR), atol=1e-3)


def test_what_the_cheap_process_does_not_know_counts_as_noise():
    """Dear points far from all cheap ones: the factor and the noise of each point follow."""
    cheap = GaussianProcess().fit(CHEAP, coarse(CHEAP))
    away = np.array([[0.3, 0.2], [0.5, 0.5], [0.8, 0.3], [1.5, 1.5]])
    found = TwoFidelities(cheap, 0.01).fit(away, fine(away))
    unknown = found.rho * cheap.predict(away)[1]
    np.testing.assert_allclose(found.sigma_n, np.hypot(0.01, unknown), rtol=1e-2)
    assert found.sigma_n[3] > 5.0 * found.sigma_n[0]
    card = found.describe()
    assert card["rho"] == found.rho and card["cheap"] == cheap.describe()


@pytest.mark.parametrize(
    ("quantity", "grid", "alone", "lifted"),
    [
        ("C_Fx", "G2", 4.63, 1.62),
        ("C_Fy", "G2", 4.48, 2.62),
        ("K_T", "G2", 1.42, 2.09),
        ("C_Fy", "G3", 3.34, 9.78),
    ],
)
def test_the_coarse_grid_of_kcs_helps_the_rudder_on_the_middle_one_and_not_elsewhere(
    quantity, grid, alone, lifted
):
    """Mean error [%] at points 1-4 of eight points, and with the twelve of G1 below them."""
    low, high = KCS.read("G1", "SA"), KCS.read(grid, "SA")
    held, training = high.pick(KCS.validation), high.pick(KCS.training)
    cheap = GaussianProcess().fit(low.X, low.values[quantity])
    for model, expected in ((GaussianProcess(), alone), (TwoFidelities(cheap), lifted)):
        fitted = model.fit(training.X, training.values[quantity])
        score = held_out_score(fitted, held.X, held.values[quantity])
        assert score["mean_abs_percent"] == pytest.approx(expected, abs=0.05)
