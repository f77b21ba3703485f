"""Which episodes of many to look at: the best, the median, the worst, the failed ones."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from ship_gym.config import check_known

WHICH = ("worst", "best", "median", "failed", "all")
EXTREMES = ("best", "median", "worst")


def ranked(
    values: Sequence[float | None], better: str, failed: Sequence[bool] | None = None
) -> list[int]:
    """Episodes from the best to the worst.

    Those that failed are the worst, whatever their value; among them one without a value is the
    last. One that did not fail and has no value is neither good nor bad: it is left out. Of equal
    ones the earlier counts as the better.

    Parameters
    ----------
    values : sequence of float or None
        Of a metric, shape (n,); None or NaN: the episode has no such value.
    better : {"lower", "higher"}
        Which values of the metric are better.
    failed : sequence of bool, optional
        Shape (n,); none if omitted.

    Returns
    -------
    list of int
        Indices, n at most.
    """
    sign = 1.0 if check_known("better", better, ("lower", "higher")) == "lower" else -1.0
    lost = [False] * len(values) if failed is None else [bool(each) for each in failed]
    known = {i: v for i, v in enumerate(values) if v is not None and not math.isnan(v)}
    counted = [i for i in range(len(values)) if i in known or lost[i]]
    return sorted(counted, key=lambda i: (lost[i], sign * known[i] if i in known else math.inf))


def chosen(
    which: str,
    values: Sequence[float | None],
    better: str,
    failed: Sequence[bool],
    count: int = 1,
) -> list[int]:
    """Indices of the episodes of `which`.

    Parameters
    ----------
    which : {"worst", "best", "median", "failed", "all"}
        ``worst``: the worst first; ``best``: the best first; ``median``: the one in the middle, of
        two the better.
    values, better, failed
        As in `ranked`.
    count : int
        Of the best or the worst, at most.

    Raises
    ------
    ConfigError
        An unknown word.
    """
    check_known("choice of episodes", which, WHICH)
    if which == "all":
        return list(range(len(values)))
    if which == "failed":
        return [i for i, lost in enumerate(failed) if lost]
    order = ranked(values, better, failed)
    if which == "median":
        return order[(len(order) - 1) // 2 :][:1]
    return order[:count] if which == "best" else order[::-1][:count]


def deciding(name: str, columns: Mapping[str, Sequence[float | None]]) -> str:
    """The metric that decides: `name`, or the return if no episode has a value of it.

    Parameters
    ----------
    name : str
    columns : mapping
        Metric to its values, shapes (n,); ``return`` is among them.
    """
    known = any(value is not None and not math.isnan(value) for value in columns[name])
    return name if known else "return"


def extremes(
    seeds: Sequence[int],
    values: Sequence[float | None],
    better: str,
    failed: Sequence[bool],
) -> dict[str, dict[str, Any]]:
    """Seed and value of the best, the median and the worst episode; empty if there is none.

    Parameters
    ----------
    seeds : sequence of int
        Shape (n,).
    values, better, failed
        As in `ranked`.
    """
    found = {which: chosen(which, values, better, failed) for which in EXTREMES}
    return {which: _told(seeds, values, i[0]) for which, i in found.items() if i}


def _told(seeds: Sequence[int], values: Sequence[float | None], i: int) -> dict[str, Any]:
    value = values[i]
    known = None if value is None or math.isnan(value) else float(value)
    return {"seed": int(seeds[i]), "value": known}
