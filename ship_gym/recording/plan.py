"""Numbers behind the plan view of a run; numpy only.

A plan view has a screen's axes, right is east and down is south, so that north is up.
"""

from __future__ import annotations

import numpy as np


def to_plan(points: np.ndarray) -> np.ndarray:
    """Turn (north, east) [m], shape (..., 2 or more), into screen axes (east, -north) [m]."""
    return np.stack([points[..., 1], -points[..., 0]], axis=-1)


def plan_bounds(track: np.ndarray, margin: float) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper corner, each (2,) [m], of a square around a plan-view track."""
    low, high = track.min(axis=0), track.max(axis=0)
    half = 0.5 * (high - low).max() + margin
    centre = 0.5 * (low + high)
    return centre - half, centre + half


def grid_lines(low: np.ndarray, high: np.ndarray) -> tuple[list, np.ndarray, list[str]]:
    """Lines of a metre grid over a square of the plan view, with their labels.

    Parameters
    ----------
    low, high : numpy.ndarray, shape (2,)
        Corners of the square [m] in screen axes.

    Returns
    -------
    lines : list of numpy.ndarray, shape (2, 2)
        Ends of each line [m].
    places : numpy.ndarray, shape (K, 2)
        Where the labels go [m].
    labels : list of str
        "E 200 m" along the lower edge, "N 200 m" along the left one.
    """
    rough = (high[0] - low[0]) / 6.0
    power = 10.0 ** np.floor(np.log10(rough))
    step = power * next(k for k in (1.0, 2.0, 5.0, 10.0) if k * power >= rough)
    east, south = (
        np.arange(np.ceil(a / step), b // step + 1) * step for a, b in zip(low, high, strict=True)
    )
    lines = [np.array([[e, low[1]], [e, high[1]]]) for e in east]
    lines += [np.array([[low[0], s], [high[0], s]]) for s in south]
    inset = 0.06 * (high[0] - low[0])  # labels are centred on their place
    east = [e for e in east if e > low[0] + 2.5 * inset]  # the corner belongs to the north
    places = [[e, high[1] - inset] for e in east] + [[low[0] + inset, s] for s in south]
    labels = [f"E {e + 0.0:g} m" for e in east] + [f"N {-s + 0.0:g} m" for s in south]
    return lines, np.array(places), labels
