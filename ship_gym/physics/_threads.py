"""Parts of a batch in threads of Python: compiled loops let other threads run meanwhile."""

from __future__ import annotations

import functools
import itertools
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait

from ship_gym.physics.scratch import LANES

BLOCK = LANES  # ships that a loop takes at once; no two threads share one


def usable_cores() -> int:
    """Number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):  # not on macOS and Windows
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def parts_of(n: int, parts: int) -> list[tuple[int, int]]:
    """Ranges (first, last) that cover n ships: about equal, whole blocks but for the last."""
    blocks = -(-n // BLOCK)
    parts = max(min(parts, blocks), 1)
    ends = [k * blocks // parts * BLOCK for k in range(parts)] + [n]
    return list(itertools.pairwise(ends))


def in_parts(call: Callable[[int, int], int], n: int, parts: int) -> list[int]:
    """What ``call(first, last)`` returns for each part of n ships; one part in this thread.

    Parameters
    ----------
    call : callable
        Compiled, with Python's lock let go.
    n : int
        Number of ships.
    parts : int
        Number of parts, if there are blocks enough.
    """
    if parts == 1:
        return [call(0, n)]
    (first, last), *others = parts_of(n, parts)
    waiting = [_pool(os.getpid()).submit(call, *part) for part in others]
    try:
        return [call(first, last), *(one.result() for one in waiting)]
    except BaseException:
        wait(waiting)  # none goes on to write where the caller may begin anew
        raise


@functools.lru_cache(maxsize=1)
def _pool(process: int) -> ThreadPoolExecutor:
    """Threads of this process; a fork has none of those of its parent and makes its own."""
    del process
    return ThreadPoolExecutor(max(usable_cores() - 1, 1), thread_name_prefix="ship_gym")
