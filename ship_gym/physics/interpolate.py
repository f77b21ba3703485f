"""Linear lookup on regular tables, the only way a kernel sees a surrogate."""

from __future__ import annotations

from ship_gym.physics._kernel import kernel


@kernel
def cell(x, start, step, count):
    """Cell index and upper weight of x on a regular axis, clamped to the axis' ends.

    Parameters
    ----------
    x, start, step : float
        Coordinate, first grid point and grid distance, in one unit.
    count : int
        Number of grid points.

    Returns
    -------
    (int, float)
        Index of the lower grid point and weight of the upper one in [0, 1].
    """
    s = (x - start) * (1.0 / step)  # the reciprocal is one for all ships of a kind
    if not s > 0.0:  # also catches nan, which the caller reports as a diverged state
        return 0, 0.0
    if s >= count - 1.0:
        return count - 2, 1.0
    i = int(s)
    return i, s - i


@kernel
def linear(table, i, w, channel):
    """Value of one channel of a table (count, channels) at cell i and weight w."""
    return (1.0 - w) * table[i, channel] + w * table[i + 1, channel]


@kernel
def bilinear(table, at, channel):
    """Value of one channel of a table (count, count, channels) at cell ``at = (i, w, j, q)``."""
    i, w, j, q = at
    low = (1.0 - q) * table[i, j, channel] + q * table[i, j + 1, channel]
    high = (1.0 - q) * table[i + 1, j, channel] + q * table[i + 1, j + 1, channel]
    return (1.0 - w) * low + w * high
