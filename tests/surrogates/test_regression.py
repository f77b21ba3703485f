"""Feature sets of the regression."""

import math

import numpy as np
import pytest

from reproduce.unsteady import eq_21, motion
from ship_gym.config import ConfigError
from ship_gym.surrogates.regression import FEATURES, Regression, features


@pytest.mark.parametrize(
    ("order", "count"),
    [("first", 4), ("second", 6), ("third", 10), ("fourth", 15), ("network", 21)],
)
def test_feature_sets_have_the_size_of_their_polynomial(order, count):
    assert len(set(FEATURES[order])) == len(FEATURES[order]) == count


def test_network_features_as_the_source_lists_them():
    """[1, J, J^2, a..a^6, J a..J a^6, J^2 a..J^2 a^6]."""
    J, a = 0.5, 0.3
    powers = [a**k for k in range(1, 7)]
    expected = [1, J, J**2, *powers, *(J * p for p in powers), *(J**2 * p for p in powers)]
    np.testing.assert_allclose(features([[J, a]], "network")[0], expected, rtol=1e-14)


@pytest.mark.parametrize("order", ["second", "third", "fourth", "network"])
def test_every_set_gives_the_printed_polynomial_back_from_the_70_snapshots(order):
    """All sets contain the second order, so without noise Eq. 21 must return, to rounding."""
    X = np.abs(motion("open water", "training"))
    test = np.abs(motion("open water", "test"))
    model = Regression(order).fit(X, eq_21(X)[:, 0])
    mean, std = model.predict(test)
    np.testing.assert_allclose(mean, eq_21(test)[:, 0], atol=1e-8)
    assert np.isfinite(std).all() and (std < 1e-8).all()


def test_the_spread_of_the_mean_is_that_of_repeated_fits():
    """sigma^2 x (X^T X)^-1 x, in the badly conditioned set too."""
    X = np.abs(motion("open water", "training"))
    place = np.array([[0.5, 0.35]])
    rng = np.random.default_rng(3)
    found = [
        Regression("network").fit(X, 0.01 * rng.standard_normal(len(X))).predict(place)
        for _ in range(400)
    ]
    means, stds = np.array(found)[:, :, 0].T
    assert math.sqrt(np.mean(stds**2)) == pytest.approx(means.std(), rel=0.15)


def test_points_at_one_J_do_not_span_the_cross_term():
    X = motion("behind hull", "training")
    with pytest.raises(ConfigError, match="collinear or repeated"):
        Regression("second").fit(X, X[:, 1])
    with pytest.raises(ConfigError, match="15 features, but 10 points"):
        Regression("fourth").fit(X[:10], X[:10, 1])
