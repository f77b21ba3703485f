"""Which rows of a run are sent for the eye, and how."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

import numpy as np
import rerun as rr

from ship_gym.conventions import G
from ship_gym.recording.rerun_export.log import Output, clock

SLOW = 0.6  # [sqrt(L/g)]: 2.9 s of a ship of 230 m
MOST_ROWS = 1500  # of a run that is over; a screen is not wider


def shown_rows(rows: int, live: bool) -> np.ndarray:
    """Mask of the rows that a picture needs, shape (rows,): all, or evenly so many, with the ends.

    Of a run that goes on all rows are needed, as its length is not known.
    """
    if live or rows <= MOST_ROWS:
        return np.ones(rows, dtype=bool)
    found = np.zeros(rows, dtype=bool)
    found[np.unique(np.linspace(0, rows - 1, MOST_ROWS).astype(int))] = True
    return found


def slow_rows(t: np.ndarray, length: float) -> np.ndarray:
    """Mask of rows for what needs no more than a few pictures in a ship's time, shape (T,)."""
    return first_in_step(t, SLOW * math.sqrt(length / G))


def first_in_step(t: np.ndarray, step: float) -> np.ndarray:
    """Mask of the first row in each step [s] from the first time, shape (T,)."""
    if math.isinf(step):
        return np.arange(len(t)) == 0
    number = np.floor((t - t[0]) / step + 1e-9)
    return np.append(True, np.diff(number) > 0.0)


def changes(*values: np.ndarray) -> np.ndarray:
    """Mask of the rows in which something differs from the row before; the first is one."""
    found = np.zeros(len(values[0]), dtype=bool)
    found[0] = True
    for array in values:
        array = array.reshape(len(array), -1)
        found[1:] |= (array[1:] != array[:-1]).any(axis=1)
    return found


def send_chosen(
    out: Output,
    path: str,
    t: np.ndarray,
    chosen: np.ndarray,
    rows: Callable[[np.ndarray], Iterable],
) -> None:
    """Send `rows` of a mask, shape (T,): those of the `chosen` ones that are new."""
    new = chosen & (t > out.sent)
    if new.any():
        rr.send_columns(path, [clock(t[new])], rows(new), recording=out.stream, strict=True)
