"""Statistics over episodes: interquartile mean, rate, intervals, paired difference, table."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from scipy import stats

from ship_gym.config import ConfigError, check_known
from ship_gym.evaluation.metrics import metrics, metrics_of
from ship_gym.evaluation.rollout import Rollout
from ship_gym.text import table as text_table

CONFIDENCE = 0.95
_RESAMPLES = 5000
_SEED = 0  # of the bootstrap, so that a report can be made again
_RATES = ("success",)  # 0 or 1 per episode: their mean is the rate, a trimmed mean says nothing


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


def per_episode(rollout: Rollout) -> dict[str, list[float]]:
    """Metrics of every episode, one list of length n for each name."""
    rows = [metrics(rollout.trajectory(i)) for i in range(len(rollout))]
    return {name: [row[name] for row in rows] for name in rows[0]}


def compare(rollouts: Sequence[Rollout], reference: str | None = None) -> dict[str, Any]:
    """Controllers side by side on the same episodes.

    Parameters
    ----------
    rollouts : sequence of Rollout
        Of the same scenario, ship and seeds.
    reference : str, optional
        Controller that the paired differences are taken from; the first one if omitted.

    Returns
    -------
    dict
        Plain values for JSON: ``scenario`` (config), ``ship``, ``seeds``, ``reference``,
        ``metrics`` (unit, meaning, better), ``controllers`` (name -> metric -> value, low, high),
        ``differences`` (the same for controller - reference, seed by seed), ``episodes`` (name ->
        metric -> one value per seed) and versions.

    Raises
    ------
    ConfigError
        Nothing to compare, or rollouts that cannot be compared.
    """
    _check_comparable(rollouts)
    names = [r.controller for r in rollouts]
    reference = names[0] if reference is None else check_known("controller", reference, names)
    episodes = {r.controller: per_episode(r) for r in rollouts}
    first = rollouts[0]
    return {
        "scenario": first.scenario.to_dict(),
        "ship": first.ship.name,
        "seeds": list(first.seeds),
        "confidence": CONFIDENCE,
        "reference": reference,
        "metrics": {k: m._asdict() for k, m in metrics_of(first.scenario.task).items()},
        "controllers": {name: _estimates(values, rate) for name, values in episodes.items()},
        "differences": {
            name: _estimates(_minus(values, episodes[reference]), _mean)
            for name, values in episodes.items()
            if name != reference
        },
        "episodes": episodes,
        **first.provenance,
    }


def _check_comparable(rollouts: Sequence[Rollout]) -> None:
    if not rollouts:
        raise ConfigError("no rollouts to compare")
    names = [r.controller for r in rollouts]
    if len(set(names)) < len(names):
        raise ConfigError(f"controllers {names}: each needs its own name")
    first = rollouts[0]
    for other in rollouts[1:]:
        same = other.seeds == first.seeds and other.scenario == first.scenario
        if not (same and other.ship.name == first.ship.name):
            raise ConfigError(
                f"{other.controller} and {first.controller} sailed different seeds, scenarios or "
                "ships: no paired comparison"
            )


def _minus(values: Mapping[str, list[float]], other: Mapping[str, list[float]]):
    return {k: np.subtract(values[k], other[k]).tolist() for k in values}


def _mean(values: Sequence[float]) -> Estimate:
    """Mean with its bootstrap interval: what a difference of rates is."""
    return estimate(values, np.mean)


def _estimates(
    values: Mapping[str, list[float]], of_rates: Callable[[Sequence[float]], Estimate]
) -> dict[str, dict]:
    """Estimate of each metric: interquartile mean, or `of_rates` for those that are 0 or 1."""
    return {
        name: dataclasses.asdict((of_rates if name in _RATES else estimate)(column))
        for name, column in values.items()
    }


def table(comparison: Mapping[str, Any], markdown: bool = False) -> str:
    """A comparison as text: metrics of the controllers, then differences from the reference.

    Parameters
    ----------
    comparison : mapping
        From `compare`, or read back from its JSON file.
    markdown : bool
        With column rules for a README, else aligned plain text.
    """
    units, found = comparison["metrics"], comparison["controllers"]
    header, rows = ["metric", "unit", "better", *found], []
    for name, metric in units.items():
        cells = [_cell(column[name]) for column in found.values()]
        rows.append([name, metric["unit"], metric["better"], *cells])
    text = text_table(header, rows, None, markdown=markdown)
    differences = comparison["differences"]
    if not differences:
        return text
    reference = comparison["reference"]
    header = ["difference", "unit", *(f"{name} - {reference}" for name in differences)]
    rows = []
    for name, metric in units.items():
        cells = [_judged_cell(column[name], metric["better"]) for column in differences.values()]
        rows.append([name, metric["unit"], *cells])
    return f"{text}\n\n{text_table(header, rows, None, markdown=markdown)}"


def _judged_cell(difference: Mapping[str, float | None], better: str) -> str:
    """Cell of a paired difference; says better or worse where the interval leaves out zero."""
    low, high, text = difference["low"], difference["high"], _cell(difference)
    if low is None or low <= 0.0 <= high:
        return text
    return f"{text} {'better' if (high < 0.0) == (better == 'lower') else 'worse'}"


def _cell(found: Mapping[str, float | None]) -> str:
    text = f"{found['value']:.4g}"
    if found["low"] is None:
        return text
    return f"{text} [{found['low']:.4g}, {found['high']:.4g}]"
