"""Fewer rows of a run that was kept at every step: as many as a reader needs."""

from __future__ import annotations

import math

import numpy as np

from ship_gym.recording.trajectory import Trajectory

_MOST = 4000  # rows; a plot on a wide screen has fewer pixels
_ORDERS = ("delta_command", "n_command")


def thinned(trajectory: Trajectory, interval: float, most: int = _MOST) -> Trajectory:
    """Keep every k-th row, the last one, and those round each change of an order.

    Parameters
    ----------
    trajectory : Trajectory
        Rows at equal steps of time, but for the last ones.
    interval : float
        Time between rows that are kept [s], at most; more where the run is longer than `most` rows
        of it.
    most : int
        Rows that are kept besides the last one and those of the orders.

    Returns
    -------
    Trajectory
        Its ``meta["interval"]`` is the time between rows [s].
    """
    t, rows = trajectory["t"], len(trajectory)
    step = float(np.median(np.diff(t))) if rows > 1 else interval
    every = max(1, math.floor(interval / step + 1e-9), math.ceil(rows / most))
    kept = np.zeros(rows, dtype=bool)
    kept[::every] = kept[-1] = True
    for name in _ORDERS:
        if name in trajectory:
            changed = np.flatnonzero(np.diff(trajectory[name]))
            kept[changed] = kept[changed + 1] = True
    columns = {name: values[kept] for name, values in trajectory.columns.items()}
    return Trajectory(columns, trajectory.meta | {"interval": every * step})
