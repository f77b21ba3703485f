"""Controllers on the same episodes: metrics with intervals, paired differences, a table."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, check_known
from ship_gym.evaluation.metrics import metrics, metrics_of
from ship_gym.evaluation.rollout import Rollout
from ship_gym.evaluation.statistics import CONFIDENCE, Estimate, estimate, rate
from ship_gym.text import table as text_table

_RATES = ("success",)  # 0 or 1 per episode: their mean is the rate, a trimmed mean says nothing


def per_episode(rollout: Rollout) -> dict[str, list[float | None]]:
    """Metrics of every episode, one list of length n for each name; None: an episode has none."""
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
        metric -> one value per seed) and versions. None where an episode has no such value, and
        in the statistics of a metric that one of the episodes has not.

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


def _minus(values: Mapping[str, list], other: Mapping[str, list]) -> dict[str, list]:
    return {
        name: [
            None if None in pair else pair[0] - pair[1]
            for pair in zip(own, other[name], strict=True)
        ]
        for name, own in values.items()
    }


def _mean(values: Sequence[float]) -> Estimate:
    """Mean with its bootstrap interval: what a difference of rates is."""
    return estimate(values, np.mean)


def _estimates(
    values: Mapping[str, list], of_rates: Callable[[Sequence[float]], Estimate]
) -> dict[str, dict]:
    """Estimate of each metric: interquartile mean, or `of_rates` for those that are 0 or 1."""
    found = {}
    for name, column in values.items():
        if None in column:
            found[name] = {"value": None, "low": None, "high": None}
        else:
            found[name] = dataclasses.asdict((of_rates if name in _RATES else estimate)(column))
    return found


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
    if low is None or high is None or low <= 0.0 <= high:
        return text
    return f"{text} {'better' if (high < 0.0) == (better == 'lower') else 'worse'}"


def _cell(found: Mapping[str, float | None]) -> str:
    if found["value"] is None:
        return "-"
    text = f"{found['value']:.4g}"
    if found["low"] is None:
        return text
    return f"{text} [{found['low']:.4g}, {found['high']:.4g}]"
