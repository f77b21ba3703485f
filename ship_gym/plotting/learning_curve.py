"""Learning curves: score and rudder travel of the validations of one run or of several seeds."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import EngFormatter, MaxNLocator

from ship_gym.plotting.figure import (
    AMBER,
    BLUE,
    DASHED,
    FAINT,
    RED,
    TEAL,
    VIOLET,
    headline,
    picture,
)

_REFERENCES = (AMBER, TEAL, VIOLET, RED)
_TRAVEL = "rudder_travel"
_FAR = 4.0  # times the median ends the axis: what learning began with may be awful

Curve = Mapping[str, Sequence[float | None]]


def plot_learning_curves(
    curves: Sequence[Curve],
    score: str,
    unit: str,
    path: str | os.PathLike,
    title: str = "",
    details: str = "",
    references: Mapping[str, Mapping[str, float]] | None = None,
) -> None:
    """Draw score and rudder travel over the samples; of several seeds their median and spread.

    Parameters
    ----------
    curves : sequence of mapping
        One for each seed: ``samples``, the score and ``rudder_travel`` [deg/h], one value for each
        validation, None where it has none.
    score, unit : str
        Name of the score and its unit.
    path : path-like
        PNG to write.
    title, details : str
    references : mapping, optional
        Controller to its score and ``rudder_travel``, drawn as lines.
    """
    labels = {score: f"{score} [{unit}]", _TRAVEL: "rudder travel [deg/h]"}
    with picture(path, 8.6, 4.0) as figure:
        for k, (name, label) in enumerate(labels.items()):
            axes = figure.add_subplot(1, 2, k + 1)
            _draw(axes, [_known(curve, name) for curve in curves])
            for (controller, values), colour in zip(
                (references or {}).items(), _REFERENCES, strict=False
            ):
                if values.get(name) is not None:
                    style = {"color": colour, "linestyle": DASHED, "linewidth": 1.2}
                    axes.axhline(values[name], label=controller, **style)
            _scale(axes)
            axes.xaxis.set_major_locator(MaxNLocator(5))
            axes.xaxis.set_major_formatter(EngFormatter())
            axes.set_xlabel("samples")
            axes.set_ylabel(label)
            if axes.get_legend_handles_labels()[0]:
                axes.legend()
        headline(figure, title, details)


def _known(curve: Curve, name: str) -> np.ndarray:
    """Samples and values where there is a value, shape (2, m)."""
    pairs = zip(curve["samples"], curve.get(name, ()), strict=False)
    known = [pair for pair in pairs if None not in pair]
    return np.array(known, dtype=np.float64).reshape(-1, 2).T


def _draw(axes: Axes, curves: list[np.ndarray]) -> None:
    """A line for each seed; of several also their median and, shaded, lowest to highest."""
    curves = [curve for curve in curves if curve.size]
    if len(curves) == 1:
        axes.plot(*curves[0], color=BLUE, marker="o", markersize=3, label="policy")
        return
    for curve in curves:
        axes.plot(*curve, color=FAINT, linewidth=0.8)
    if not curves:
        return
    end = min(curve[0].max() for curve in curves)
    samples = np.unique(np.concatenate([curve[0] for curve in curves]))
    samples = samples[samples <= end]
    values = np.array([np.interp(samples, *curve) for curve in curves])
    axes.fill_between(samples, values.min(0), values.max(0), color=BLUE, alpha=0.15, linewidth=0.0)
    label = f"median of {len(curves)} seeds"
    axes.plot(samples, np.median(values, axis=0), color=BLUE, label=label)


def _scale(axes: Axes) -> None:
    """Leave out first values that would press all others together; where a line ends is shown."""
    lines = [np.asarray(line.get_ydata(), dtype=np.float64) for line in axes.lines]
    values = np.concatenate([*lines, []])
    if len(values) and values.min() > 0.0:
        ends = max(line[-1] for line in lines)
        low, high = values.min(), max(ends, min(values.max(), _FAR * np.median(values)))
        room = 0.06 * (high - low) or 0.05 * high
        axes.set_ylim(low - room, high + room)
