"""Trials of a search for hyperparameters: the score in their order, and over each of the values."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from ship_gym.plotting.figure import AMBER, BLUE, FAINT, headline, picture

_COLUMNS = 4
_FAR = 4.0  # a score this many times the median ends the axis: a failed run may be awful

# number, score (None: none), complete, values by name
Row = tuple[int, float | None, bool, Mapping[str, Any]]
_Known = tuple[int, float, bool, Mapping[str, Any]]


def plot_search(
    rows: Sequence[Row], label: str, lower: bool, path: str | os.PathLike, title: str
) -> None:
    """Draw the trials of a search.

    Parameters
    ----------
    rows : sequence of tuple
        Number, score, whether the trial is complete (else its score is what a pruned one showed
        last), values by name.
    label : str
        Of the score, with its unit.
    lower : bool
        Whether a lower score is better.
    path : path-like
        PNG to write.
    title : str
    """
    known: list[_Known] = [(k, v, whole, of) for k, v, whole, of in rows if v is not None]
    names = list(dict.fromkeys(name for row in known for name in row[3]))
    lines = math.ceil((1 + len(names)) / _COLUMNS)
    with picture(path, 11.0, 0.7 + 2.3 * lines) as figure:
        axes = [figure.add_subplot(lines, _COLUMNS, k + 1) for k in range(1 + len(names))]
        _draw_history(axes[0], known, lower)
        for own, name in zip(axes[1:], names, strict=True):
            _draw_values(own, known, name)
        for own in axes:
            _limit(own, [row[1] for row in known])
        for k in range(0, len(axes), _COLUMNS):
            axes[k].set_ylabel(label)
        headline(figure, title, "filled: complete trials; hollow: pruned, the score shown last")


def _scatter(axes: Axes, x: Sequence[float], rows: Sequence[_Known]) -> None:
    for complete, face in ((True, BLUE), (False, "none")):
        own = [(a, row[1]) for a, row in zip(x, rows, strict=True) if row[2] is complete]
        if own:
            style = {"facecolors": face, "edgecolors": BLUE if complete else FAINT}
            axes.scatter(*zip(*own, strict=True), s=18, linewidths=0.9, **style)


def _draw_history(axes: Axes, rows: Sequence[_Known], lower: bool) -> None:
    """Scores in the order of the trials, and the best so far."""
    _scatter(axes, [row[0] for row in rows], rows)
    complete = [row for row in rows if row[2]]
    if complete:
        best = (np.minimum if lower else np.maximum).accumulate([row[1] for row in complete])
        axes.step([row[0] for row in complete], best, where="post", color=AMBER, label="best")
        axes.legend()
    axes.xaxis.set_major_locator(MaxNLocator(5, integer=True))
    axes.set_xlabel("trial")


def _draw_values(axes: Axes, rows: Sequence[_Known], name: str) -> None:
    """Scores over one hyperparameter; choices that are no numbers stand side by side."""
    values: list[Any] = [row[3].get(name) for row in rows]
    numbers = all(isinstance(value, int | float) for value in values)
    if numbers:
        x = values
        if min(values) > 0.0 and max(values) > 8.0 * min(values):
            axes.set_xscale("log")
        else:
            axes.xaxis.set_major_locator(MaxNLocator(4))
    else:
        texts = [json.dumps(value) for value in values]
        places = sorted(set(texts), key=lambda text: (len(text), text))
        x = [places.index(text) for text in texts]
        axes.set_xticks(range(len(places)), places, fontsize=7)
    _scatter(axes, x, rows)
    axes.set_xlabel(name)


def _limit(axes: Axes, scores: Sequence[float]) -> None:
    """Leave out what would press all others together."""
    if scores and min(scores) > 0.0:
        low, high = min(scores), min(max(scores), _FAR * float(np.median(scores)))
        room = 0.08 * (high - low) or 0.05 * high
        axes.set_ylim(low - room, high + room)
