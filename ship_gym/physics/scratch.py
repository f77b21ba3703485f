"""Scratch of the loop over ships: numbers of 64 ships side by side, so that it is vectorised.

One record whose fields are arrays of constant size: the compiler then knows that they do not
overlap. A lane is a ship's place in it.
"""

from __future__ import annotations

import numpy as np

from ship_gym.physics.parameters import N_PARAMETERS
from ship_gym.physics.quantities import record_type

LANES = 64
EIGHT = np.uint64(8)  # waves side by side in a sum; see waves.sum_waves
N_SUMS = 21  # waves.Sums
N_GUSTS = 20
GUST_COLUMNS = 24  # filled up to three eights, see wind.gust_factor

_FIELDS = [
    ("ship", (N_PARAMETERS, LANES)),  # parameters.ship_at
    ("start", (6, LANES)),  # Body at the start of the step,
    ("at", (6, LANES)),  # where the rates are asked for,
    ("change", (6, LANES)),  # and the weighted sum of the rates; `sum` is a method of records
    ("delta", (3, LANES)),  # Controls at start, middle and end of the step
    ("n", (3, LANES)),
    ("now", (2, LANES)),  # those of a stage
    ("command", (2, LANES)),
    ("load", (3, LANES)),  # sum of the loads that are held
    ("current", (2, LANES)),  # north and east [m/s]
    ("own", (9, LANES)),  # OwnForces at the last asked place
    ("units", (10, LANES)),  # Units there
    ("dt", (LANES,)),  # integration step [s]
    ("gust", (GUST_COLUMNS,)),
    ("wave", (N_SUMS, int(EIGHT))),  # waves.sum_waves
]
SCRATCH = record_type(
    [(name, np.float64, shape) for name, shape in _FIELDS]
    + [("kind", np.int64, (LANES,)), ("steps", np.int64, (LANES,))]
    # largest speed squared over ground and yaw rate before the last step
    + [("most", np.float64, (2, LANES))]
)

LINE = 64  # bytes of a cache line; a vector that lies across two is read twice


def in_lines(values: np.ndarray) -> np.ndarray:
    """Copy of an array that begins with a cache line."""
    room = np.empty(values.nbytes + LINE, np.uint8)
    first = -room.ctypes.data % LINE
    found = room[first : first + values.nbytes].view(values.dtype).reshape(values.shape)
    found[...] = values
    return found


def scratch_for(threads: int) -> np.ndarray:
    """Scratch of a number of threads, shape (threads,)."""
    return in_lines(np.zeros(threads, SCRATCH))
