"""Episodes that begin while others go on: what of a memory is to be begun anew.

Whatever remembers the measurement before asks a `Fresh` which episodes have none.
"""

from __future__ import annotations

import numpy as np

_NONE = np.zeros(0, dtype=np.int64)


class Fresh:
    """Episodes whose next measurement is their first: all of them, later those restarted."""

    def __init__(self):
        self._rows: slice | np.ndarray = slice(None)

    def add(self, rows: np.ndarray) -> None:
        """These episodes begin anew; indices, or a mask of shape (count,)."""
        if not isinstance(self._rows, slice):
            self._rows = np.union1d(self._rows, indices(rows))

    def take(self) -> slice | np.ndarray:
        """Those that are fresh, for indexing; from now on none is."""
        rows, self._rows = self._rows, _NONE
        return rows


def indices(rows: np.ndarray) -> np.ndarray:
    """Indices of rows that are given as indices or as a mask."""
    rows = np.atleast_1d(rows)
    return np.flatnonzero(rows) if rows.dtype == np.bool_ else rows.astype(np.int64)


def begun(before: np.ndarray | None, rows: slice | np.ndarray, now: np.ndarray) -> np.ndarray:
    """What was before, with `now` in the fresh rows; the last axis is that of the episodes.

    `before` stays as it is; it is None at the very first.
    """
    if before is None:
        return now
    if isinstance(rows, np.ndarray) and not len(rows):
        return before
    before = before.copy()
    before[..., rows] = now[..., rows]
    return before


def zeroed(memory: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """A copy whose last axis, that of the episodes, is zero in these rows."""
    memory = memory.copy()
    memory[..., rows] = 0.0
    return memory
