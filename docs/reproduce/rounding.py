"""How far the printed digits let a recomputed number move, and how many cells are within that."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from ship_gym.surrogates.samples import Samples

HALF_DIGIT = 0.0005  # of the printed forces, which have three decimals


def interval(
    compute: Callable[..., np.ndarray], *inputs: np.ndarray, half: float = HALF_DIGIT
) -> tuple[np.ndarray, np.ndarray]:
    """Least and largest value of a function of printed numbers, each true within half a digit.

    The function must be monotone in each of its inputs over that width.
    """
    moves = itertools.product((-half, half), repeat=len(inputs))
    corners = np.array([compute(*map(np.add, inputs, move)) for move in moves])
    return corners.min(axis=0), corners.max(axis=0)


def reach(
    compute: Callable[..., np.ndarray], *samples: Samples, half: float = HALF_DIGIT
) -> np.ndarray:
    """How far half a digit in every force can move each result, to first order.

    Parameters
    ----------
    compute : callable
        Of the samples; gives an array.
    samples : Samples
        Whose values are printed.
    """
    base = compute(*samples)
    moved = np.zeros_like(base)
    for i, part in enumerate(samples):
        for name, values in part.values.items():
            for k in range(len(values)):
                step = values + half * (np.arange(len(values)) == k)
                other = dataclasses.replace(part, values={**part.values, name: step})
                moved += np.abs(compute(*samples[:i], other, *samples[i + 1 :]) - base)
    return moved


def only(samples: Samples, *quantities: str) -> Samples:
    """Samples with some of their quantities."""
    return dataclasses.replace(samples, values={k: samples.values[k] for k in quantities})


def counted(rows: Iterable[dict[str, Any]], key: str = "table") -> dict[str, list[int]]:
    """Cells within rounding and all cells by table; rows have ``within``, a list of booleans."""
    found: dict[str, list[int]] = {}
    for row in rows:
        count = found.setdefault(row[key], [0, 0])
        count[0] += sum(row["within"])
        count[1] += len(row["within"])
    return found


def count_text(counts: dict[str, list[int]]) -> str:
    """Counts for people, and their sum."""
    parts = [f"{name} {good} of {total}" for name, (good, total) in counts.items()]
    good, total = np.sum(list(counts.values()), axis=0)
    whole = f"; together {good} of {total}" if len(parts) > 1 else ""
    return f"Cells within rounding: {', '.join(parts)}{whole}."
