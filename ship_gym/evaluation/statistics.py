"""Statistics over episodes, on plain arrays: interquartile mean, rate, intervals."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence

import numpy as np
from scipy import stats

CONFIDENCE = 0.95
_RESAMPLES = 5000
_SEED = 0  # of the bootstrap, so that a report can be made again


@dataclasses.dataclass(frozen=True)
class Estimate:
    """A statistic and its 95 % interval; None without an interval (one episode)."""

    value: float
    low: float | None
    high: float | None


def interquartile_mean(values: np.ndarray, axis: int = -1) -> np.ndarray:
    """Mean without the lowest and the highest quarter of the values (of n, n // 4 each)."""
    return stats.trim_mean(values, 0.25, axis=axis)


def estimate(
    values: Sequence[float] | np.ndarray, statistic: Callable = interquartile_mean
) -> Estimate:
    """A statistic with its 95 % interval: percentile bootstrap over episodes, seeded.

    Parameters
    ----------
    values : array_like
        One per episode, shape (n,).
    statistic : callable
        ``statistic(values, axis)``.
    """
    values = np.asarray(values, dtype=np.float64)
    value = float(statistic(values, axis=-1))
    if len(values) < 2:
        return Estimate(value, None, None)
    if np.ptp(values) == 0.0:
        return Estimate(value, value, value)
    interval = stats.bootstrap(
        (values,),
        statistic,
        n_resamples=_RESAMPLES,
        confidence_level=CONFIDENCE,
        method="percentile",
        vectorized=True,
        rng=np.random.default_rng(_SEED),
    ).confidence_interval
    return Estimate(value, float(interval.low), float(interval.high))


def rate(values: Sequence[float] | np.ndarray) -> Estimate:
    """Mean of values 0 or 1 with Wilson's 95 % interval, which stays open where all are equal."""
    values = np.asarray(values, dtype=np.float64)
    if len(values) < 2:
        return Estimate(float(values.mean()), None, None)
    test = stats.binomtest(int(values.sum()), len(values))
    interval = test.proportion_ci(CONFIDENCE, method="wilson")
    return Estimate(float(values.mean()), float(interval.low), float(interval.high))
