"""The kernels of the card: thread i does to ship i what ``kernels`` says.

Two for a step, because sailing is the same for all tasks: it is by far the longer to compile, and
its machine code is kept on disk. Import this only once ``card.card`` has found everything.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from numba import cuda

from ship_gym.gpu.card import simulated
from ship_gym.gpu.kernels import ENDED, REFUSED, UNNAMED, order_and_sail, settling
from ship_gym.physics import _kernel

if TYPE_CHECKING:
    from ship_gym.tasks.base import Task

THREADS = 64  # of one block


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


with _kept_with_our_kernels():

    @cuda.jit(cache=True)
    def sail_all(fleet, shared, actions, counts):
        """Sail one interval under actions (n, n_actions); refused ones are counted."""
        i = cuda.grid(1)
        if i < actions.shape[0] and order_and_sail(i, fleet, shared, actions) == 0:
            cuda.atomic.add(counts, REFUSED, 1)


def settle_all(task: Task, with_privileged: bool) -> Callable:
    """Kernel that judges the interval of a task and counts the episodes that have ended."""
    settle = cuda.jit(device=True)(settling(task, with_privileged))

    def settle_each(fleet, shared, failing, counts):
        i = cuda.grid(1)
        if i < fleet.states.shape[0] and counts[REFUSED] == 0:
            end = settle(i, fleet, shared, failing)
            if end > 0:
                cuda.atomic.add(counts, ENDED, 1)
            if end < 0:
                cuda.atomic.add(counts, UNNAMED, 1)

    return cuda.jit(settle_each)
