"""Statistics over episodes, on plain arrays: means with intervals, paired differences, profiles.

The intervals are bootstraps over the episodes, seeded, so that a report can be made again. That of
the interquartile mean is the percentile bootstrap. That of the mean, which the tails of a measure
move, takes at each end the farther one of the studentised bootstrap (Efron and Tibshirani 1993,
chapter 12) and of Student's t: the one is too short where tails are long on both sides, the other
where a measure is skewed. ``tests/evaluation/test_coverage.py`` has how often they hold the truth.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Sequence

import numpy as np
from scipy import stats

from ship_gym.config import ConfigError

CONFIDENCE = 0.95
RESAMPLES = 5000
FLIPS = 9999  # of the signs of paired differences: p is 1e-4 at least
_SEED = 0
_TAILS = (0.5 * (1.0 - CONFIDENCE), 0.5 * (1.0 + CONFIDENCE))


@dataclasses.dataclass(frozen=True)
class Estimate:
    """A statistic and its 95 % interval; None without an interval (one episode)."""

    value: float
    low: float | None
    high: float | None


@dataclasses.dataclass(frozen=True)
class Paired:
    """Mean of paired differences, its 95 % interval and the p-value of "no difference"."""

    value: float
    low: float | None
    high: float | None
    p: float


def interquartile_mean(values: np.ndarray, axis: int = -1) -> np.ndarray:
    """Mean without the lowest and the highest quarter of the values (of n, n // 4 each)."""
    return stats.trim_mean(values, 0.25, axis=axis)


@functools.lru_cache(maxsize=4)  # a report asks for the same ones thousands of times
def draws(n: int, resamples: int = RESAMPLES) -> np.ndarray:
    """How often each of `n` episodes is drawn in each resample, shape (resamples, n), read only."""
    rng = np.random.default_rng((_SEED, n))
    found = rng.multinomial(n, np.full(n, 1.0 / n), size=resamples).astype(np.float64)
    found.setflags(write=False)
    return found


def tails(resampled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Ends of the middle 95 % of resamples, those along the first axis."""
    low, high = np.quantile(resampled, _TAILS, axis=0)
    return low, high


def interquartile_weights(counts: np.ndarray) -> np.ndarray:
    """Weights of sorted values in the interquartile mean of resamples, shape (resamples, n).

    Parameters
    ----------
    counts : numpy.ndarray
        How often each value is drawn, in the order of the sorted values, shape (resamples, n).
    """
    n = counts.shape[1]
    cut = n // 4
    below = np.clip(np.cumsum(counts, axis=1), cut, n - cut)
    return np.diff(below, axis=1, prepend=float(cut)) / (n - 2 * cut)


def intervals(
    values: np.ndarray, statistic: Callable = interquartile_mean, resamples: int = RESAMPLES
) -> tuple[np.ndarray, np.ndarray]:
    """Ends of the 95 % intervals of many samples at once.

    Parameters
    ----------
    values : numpy.ndarray
        Shape (samples, n), n at least 2.
    statistic : callable
        `interquartile_mean` (percentile bootstrap) or ``numpy.mean`` (studentised bootstrap, the
        percentile one where more than 2.5 % of the resamples have no spread, and Student's t).
    resamples : int

    Returns
    -------
    low, high : numpy.ndarray
        Shape (samples,).
    """
    counts = draws(values.shape[1], resamples)
    if statistic is interquartile_mean:
        found = interquartile_weights(counts) @ np.sort(values, axis=1).T
        return tails(found)
    if statistic is not np.mean:
        raise ConfigError(f"no interval of {statistic!r}: allowed are interquartile_mean, np.mean")
    return _intervals_of_means(values, counts)


def _intervals_of_means(values: np.ndarray, counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    n = values.shape[1]
    mean = np.mean(values, axis=1)
    deviations = (values - mean[:, None]).T
    shift = counts @ deviations / n  # of the mean in each resample
    spread = np.sqrt(np.maximum(counts @ deviations**2 / n - shift**2, 0.0))
    scale = np.sqrt(np.mean(deviations**2, axis=0))
    flat = spread <= 1e-9 * scale
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(flat, np.copysign(np.inf, shift), shift / spread)
    few, many = np.quantile(ratio, _TAILS, axis=0, method="nearest")
    sound = np.isfinite(few) & np.isfinite(many)
    low, high = tails(shift)
    low = np.where(sound, -scale * np.where(sound, many, 0.0), low)
    high = np.where(sound, -scale * np.where(sound, few, 0.0), high)
    student = stats.t.ppf(_TAILS[1], n - 1) * scale / np.sqrt(n - 1)
    return mean + np.minimum(low, -student), mean + np.maximum(high, student)


def estimate(
    values: Sequence[float] | np.ndarray, statistic: Callable = interquartile_mean
) -> Estimate:
    """A statistic with its 95 % interval.

    Parameters
    ----------
    values : array_like
        One per episode, shape (n,).
    statistic : callable
        `interquartile_mean` or ``numpy.mean``, see `intervals`.
    """
    values = _finite("values", values)
    value = float(statistic(values))
    if len(values) < 2:
        return Estimate(value, None, None)
    if np.ptp(values) == 0.0:
        return Estimate(value, value, value)
    low, high = intervals(values[None], statistic)
    return Estimate(value, float(low[0]), float(high[0]))


def rate(values: Sequence[float] | np.ndarray) -> Estimate:
    """Mean of values 0 or 1 with Wilson's 95 % interval, which stays open where all are equal."""
    values = np.asarray(values, dtype=np.float64)
    if len(values) < 2:
        return Estimate(float(values.mean()), None, None)
    test = stats.binomtest(int(values.sum()), len(values))
    interval = test.proportion_ci(CONFIDENCE, method="wilson")
    return Estimate(float(values.mean()), float(interval.low), float(interval.high))


def paired(
    values: Sequence[float] | np.ndarray,
    other: Sequence[float] | np.ndarray,
    statistic: Callable = np.mean,
) -> Paired:
    """Mean of values - other, episode by episode, with its interval and a p-value.

    The p-value is that of the sign-flip permutation test: were the two alike, each episode's
    difference could as well have the other sign. It needs no distribution, and is exact up to 13
    episodes (all flips are tried); beyond, `FLIPS` random ones, seeded.

    Parameters
    ----------
    values, other : array_like
        Of the same episodes in the same order, shape (n,).
    statistic : callable
        ``numpy.mean``, or `interquartile_mean` of the differences, which a few episodes that went
        wrong do not decide.
    """
    values, other = _finite("values", values), _finite("other", other)
    if values.shape != other.shape:
        raise ConfigError(f"{len(values)} values and {len(other)} others: no paired difference")
    found = estimate(values - other, statistic)
    if len(values) < 2:
        return Paired(found.value, None, None, 1.0)
    test = stats.permutation_test(
        (values - other,),
        statistic,
        permutation_type="samples",
        n_resamples=FLIPS,
        vectorized=True,
        rng=np.random.default_rng(_SEED),
    )
    return Paired(found.value, found.low, found.high, float(test.pvalue))


def holm(p_values: Sequence[float] | np.ndarray) -> np.ndarray:
    """p-values adjusted for the size of their family (Holm 1979), shape (m,).

    Rejecting where an adjusted one is below 5 % makes any false rejection at most 5 % likely,
    whatever the tests have in common.
    """
    p = np.asarray(p_values, dtype=np.float64)
    if not ((p >= 0.0) & (p <= 1.0)).all():
        raise ConfigError(f"p_values = {p.tolist()}: allowed is 0 to 1")
    order = np.argsort(p)
    steps = np.arange(len(p), 0, -1) * p[order]
    adjusted = np.empty_like(p)
    adjusted[order] = np.minimum(np.maximum.accumulate(steps), 1.0)
    return adjusted


def ratios_to_best(values: np.ndarray) -> np.ndarray:
    """Ratio of each controller's measure to the best one's of the episode (Dolan and More 2002).

    Parameters
    ----------
    values : numpy.ndarray
        Positive, lower is better, shape (controllers, episodes); nan where an episode has none,
        which is infinitely worse than the best.
    """
    values = np.asarray(values, dtype=np.float64)
    if not (np.isnan(values) | (values > 0.0)).all():
        raise ConfigError("ratios to the best need positive values")
    worst = np.where(np.isnan(values), np.inf, values)
    best = worst.min(axis=0)
    return np.where(np.isinf(worst), np.inf, worst / np.where(np.isinf(best), 1.0, best))


def share_within(values: np.ndarray, limits: np.ndarray) -> np.ndarray:
    """Performance profile of ratios: share of the episodes (last axis) at most each limit."""
    values = np.asarray(values, dtype=np.float64)
    return np.mean(values[..., None] <= np.asarray(limits), axis=-2)


def share_above(values: np.ndarray, limits: np.ndarray) -> np.ndarray:
    """Performance profile of scores: share of the episodes (last axis) above each limit."""
    values = np.asarray(values, dtype=np.float64)
    return np.mean(values[..., None] > np.asarray(limits), axis=-2)


def _finite(what: str, values: Sequence[float] | np.ndarray) -> np.ndarray:
    found = np.asarray(values, dtype=np.float64)
    if found.ndim != 1 or len(found) == 0 or not np.isfinite(found).all():
        raise ConfigError(f"{what} = {found.tolist()}: at least one is needed, all of them finite")
    return found
