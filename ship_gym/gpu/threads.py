"""The kernel of the card: thread i sails an interval of ship i.

Import this only once ``card.card`` has found everything.
"""

from __future__ import annotations

import contextlib
import types
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numba import cuda

from ship_gym.conventions import N_STATES
from ship_gym.gpu.card import simulated
from ship_gym.gpu.kernels import RUNNING, Batch, interval_of_one
from ship_gym.gpu.rows import of_one_ship
from ship_gym.physics import _kernel
from ship_gym.physics.quantities import record_type
from ship_gym.physics.scratch import LANES, SCRATCH

if TYPE_CHECKING:
    from ship_gym.tasks.base import Task

THREADS = 64  # of one block


def one_lane(scratch: np.dtype) -> np.dtype:
    """Type of a scratch like ``physics.scratch.SCRATCH``, but for one ship: what a thread needs."""
    fields = []
    for name in scratch.names or ():
        subdtype = scratch[name].subdtype
        assert subdtype is not None  # all fields are arrays
        kind, shape = subdtype
        fields.append((name, kind, (*shape[:-1], 1) if shape[-1] == LANES else shape))
    return record_type(fields)


LANE = one_lane(SCRATCH)


def one(values, i, j, scratch, before):
    """Stands for that of ``rows.of_one_ship``."""


def sail(batch):
    """Stands for that of ``kernels.interval_of_one``."""


def _sail_all(values, n, counts):
    """Sail an interval of n episodes; `counts` how many came to what, by the codes of `kernels`."""
    i = cuda.grid(1)
    if i < n:
        scratch = cuda.local.array(1, LANE)
        before = cuda.local.array((1, N_STATES), np.float64)
        came = sail(one(values, i, i + 1, scratch, before))
        if came != RUNNING:
            cuda.atomic.add(counts, came, 1)


@contextlib.contextmanager
def _kept_with_our_kernels() -> Iterator[None]:
    """Keep machine code of the card where that of the CPU is, see ``physics._cache``."""
    if simulated():
        yield
        return
    from numba.cuda.core import config

    before = config.CACHE_DIR
    config.CACHE_DIR = str(Path(_kernel._CACHE_FOLDER) / "cuda")
    try:
        yield
    finally:
        config.CACHE_DIR = before


def kernel_of(task: Task, batch: Batch) -> Any:
    """Kernel ``(values, n, counts)`` of a task for batches of this form.

    Its machine code is kept on disk if all of its sources are the package's: under a name that says
    what the functions are that it calls, since numba does not look into those.
    """
    put_together, form = of_one_ship(batch)
    device = cuda.jit(device=True)
    scope = {**_sail_all.__globals__, "one": device(put_together)}
    scope["sail"] = device(interval_of_one(task))
    name = f"sail_{task.name}_{form}"
    made = types.FunctionType(_sail_all.__code__, scope, name)
    made.__qualname__ = name
    with _kept_with_our_kernels():
        return cuda.jit(cache=task.scenario is None)(made)
