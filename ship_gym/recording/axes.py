"""Axes of a plot: a range that shows several ticks, and a corner for the legend."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

# The viewer writes ticks at whole powers of ten only, and only where they are far enough apart:
# so many on the height of a screen, shared by the plots above each other.
_TICKS, _FEWEST_TICKS = 32, 3
_ROOM = 0.04  # of the range, free above and below
USUAL = "LeftBottom"  # where the viewer puts a legend by itself
CORNERS = ("LeftTop", "RightTop", "RightBottom", "LeftBottom")
_WIDE, _LINE, _HEAD = 0.16, 0.11, 0.04  # legend: share of the width, of the height by line
_USUAL_SHARE = 0.9  # of the rows
_NEAR = 0.4  # of the range of the lines: a limit that is not farther from them is shown


def y_range(
    lines: Sequence[np.ndarray],
    limits: Sequence[np.ndarray] = (),
    robust: bool = False,
    plots: int = 4,
) -> tuple[float, float]:
    """Lower and upper end of an axis on which all lines can be read.

    Parameters
    ----------
    lines : sequence of numpy.ndarray
        Values of each line, shapes (T,).
    limits : sequence of numpy.ndarray
        Lines that count only where the others come near to them.
    robust : bool
        Leave the largest tenth of the rows out, so that the rest can be read.
    plots : int
        Above each other on the screen.

    Returns
    -------
    low, high : float
        Wide enough for three ticks, or two where a third would shrink the lines to half.
    """
    low, high = _extent(_without_peaks(lines) if robust else lines, limits)
    span = high - low
    step = 10.0 ** math.ceil(math.log10(span * plots / _TICKS) - 1e-9)
    if span / step >= _FEWEST_TICKS:
        return low - _ROOM * span, high + _ROOM * span
    first, last = math.floor(low / step + 1e-6), math.ceil(high / step - 1e-6)
    room = _ROOM * (last - first)
    return (first - room) * step, (last + room) * step


def _without_peaks(lines: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Lines cut on both sides of zero at what nine tenths of the rows of the widest stay within."""
    most = max(float(np.quantile(np.abs(line), _USUAL_SHARE)) for line in lines)
    return [np.clip(line, -most, most) for line in lines] if most > 0.0 else list(lines)


def _extent(lines: Sequence[np.ndarray], limits: Sequence[np.ndarray]) -> tuple[float, float]:
    """Smallest and largest value that must be seen; never equal."""
    low, high = _span(lines)
    ends = [float(end) for limit in limits for end in (limit.min(), limit.max())]
    near = [end for end in ends if _is_near(end, low, high)]
    low, high = min([low, *near]), max([high, *near])
    if high - low <= 1e-9 * max(abs(low), abs(high), 1e-6):
        half = 0.05 * abs(low) or 1.0
        return low - half, high + half
    return low, high


def _span(lines: Sequence[np.ndarray]) -> tuple[float, float]:
    return float(min(line.min() for line in lines)), float(max(line.max() for line in lines))


def _is_near(end: float, low: float, high: float) -> bool:
    reach = _NEAR * (high - low)
    return low - reach <= end <= high + reach


def is_shown(limit: np.ndarray, lines: Sequence[np.ndarray]) -> bool:
    """Whether a limit, shape (T,), comes near enough to the lines to be on their axis."""
    low, high = _span(lines)
    return _is_near(float(limit.min()), low, high) or _is_near(float(limit.max()), low, high)


def free_corner(
    t: np.ndarray, lines: Sequence[np.ndarray], ends: tuple[float, float], entries: int
) -> str:
    """Name of the corner in which a legend hides least of the lines.

    Parameters
    ----------
    t : numpy.ndarray
        Times [s], shape (T,).
    lines : sequence of numpy.ndarray
        Values, shapes (T,).
    ends : tuple of float
        Of the axis, as of `y_range`.
    entries : int
        Lines of the legend.
    """
    across = (t - t[0]) / max(float(t[-1] - t[0]), 1e-9)
    up = (np.concatenate(lines) - ends[0]) / (ends[1] - ends[0])
    across = np.tile(across, len(lines))
    tall = min(_HEAD + _LINE * entries, 0.9)
    hidden = {}
    for name in CORNERS:
        beside = across <= _WIDE if name.startswith("Left") else across >= 1.0 - _WIDE
        level = up >= 1.0 - tall if name.endswith("Top") else up <= tall
        hidden[name] = int(np.count_nonzero(beside & level & (up >= 0.0) & (up <= 1.0)))
    return min(CORNERS, key=lambda name: (hidden[name], name != USUAL))
