"""How often the 95 % intervals of the reports hold the truth: synthetic episodes, truth known."""

import math

import numpy as np
import pytest
from scipy import stats

from ship_gym.evaluation.statistics import interquartile_mean, intervals

TRIALS, N = 2000, 64


def normal(rng):
    """Samples of N(0, 1)."""
    return rng.normal(size=(TRIALS, N))


def lognormal(rng):
    """Samples of exp(N(0, 1)): as skewed as the measures of episodes in mixed seas."""
    return np.exp(rng.normal(size=(TRIALS, N)))


def paired_lognormal(rng):
    """Differences of two controllers, both lognormal, that share nothing: long tails, no skew."""
    return lognormal(rng) - lognormal(rng)


def paired_in_one_sea(rng):
    """Differences of two controllers whose ratio is exp(N(0, 0.2)) in a lognormal sea."""
    sea = lognormal(rng)
    return sea - sea * np.exp(0.2 * rng.normal(size=(TRIALS, N)))


def lognormal_mean(low, high):
    """Mean of exp(z), z standard normal between two quantiles: the partial expectation, exactly."""
    a, b = stats.norm.ppf([low, high])
    inside = stats.norm.cdf(b - 1.0) - stats.norm.cdf(a - 1.0)
    return math.exp(0.5) * inside / (high - low)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("statistic", "sample", "truth"),
    [
        (interquartile_mean, normal, 0.0),
        (interquartile_mean, lognormal, lognormal_mean(0.25, 0.75)),
        (interquartile_mean, paired_lognormal, 0.0),
        (np.mean, normal, 0.0),
        (np.mean, lognormal, lognormal_mean(0.0, 1.0)),
        (np.mean, paired_lognormal, 0.0),
        (np.mean, paired_in_one_sea, math.exp(0.5) * (1.0 - math.exp(0.02))),
    ],
)
def test_intervals_hold_the_truth_in_95_of_100_trials(statistic, sample, truth):
    """n = 64, 2,000 trials, 5,000 resamples; the trials themselves scatter by 0.5 %.

    Found, in this order: 95.2, 95.3, 94.5, 96.2, 94.4, 95.5, 95.2 %. For the mean of the lognormal
    a percentile bootstrap has 90.5 % (20,000 trials), Student's t 91 %; for that of the paired
    lognormals the studentised bootstrap alone has 92 %.
    """
    held = []
    for part in np.split(sample(np.random.default_rng(2026)), 10):
        low, high = intervals(part, statistic)
        held.append((low <= truth) & (truth <= high))
    covered = np.mean(held)
    print(f"{statistic.__name__}, {sample.__name__}: {covered:.4f}")
    assert 0.93 <= covered <= 0.97


def test_truths_are_those_of_a_large_sample():
    values = np.exp(np.random.default_rng(1).normal(size=2_000_000))
    assert lognormal_mean(0.0, 1.0) == pytest.approx(math.exp(0.5))
    assert lognormal_mean(0.0, 1.0) == pytest.approx(values.mean(), rel=3e-3)
    assert lognormal_mean(0.25, 0.75) == pytest.approx(interquartile_mean(values), rel=3e-3)
