"""Random streams of n environments: the states of their generators, 32 bytes each.

A generator of numpy is a kilobyte. One is enough, which takes the state of the stream it draws for.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from gymnasium.utils import seeding

_WORD = 2**64 - 1


class Streams:
    """Streams as those of ``gymnasium.utils.seeding.np_random``.

    Parameters
    ----------
    n : int

    Attributes
    ----------
    seeds : list of (int or None)
        Of each stream; None: not yet begun.
    begun : numpy.ndarray
        How often each has been drawn from since it was seeded, shape (n,).
    """

    def __init__(self, n: int):
        self.seeds: list[int | None] = [None] * n
        self.begun = np.zeros(n, dtype=np.int64)
        # high and low word of the state, then of the increment, of PCG64
        self._words = np.zeros((n, 4), dtype=np.uint64)
        self._generator = np.random.Generator(np.random.PCG64(0))

    def seed(self, seeds: Sequence[int | None], mask: np.ndarray) -> None:
        """Begin streams anew: those of the `mask` whose seed is given, or which have none yet."""
        for i in np.flatnonzero(mask).tolist():
            if seeds[i] is not None or self.seeds[i] is None:
                generator, self.seeds[i] = seeding.np_random(seeds[i])
                self.begun[i] = 0
                self._keep(i, generator)

    def random(self, which: np.ndarray, count: int) -> np.ndarray:
        """The next numbers in [0, 1) of some streams, shape (m, count)."""
        drawn = np.empty((len(which), count))
        self.begun[which] += 1
        for row, i in enumerate(which.tolist()):
            self._set(self._generator, i)
            self._generator.random(out=drawn[row])
            self._keep(i, self._generator)
        return drawn

    def generators(self) -> tuple[np.random.Generator | None, ...]:
        """Copies of the generators as they are now; None before the first seed."""
        return tuple(
            self._copy(i) if seed is not None else None for i, seed in enumerate(self.seeds)
        )

    def _copy(self, i: int) -> np.random.Generator:
        made = np.random.Generator(np.random.PCG64(0))
        self._set(made, i)
        return made

    def _keep(self, i: int, generator: np.random.Generator) -> None:
        now = generator.bit_generator.state["state"]
        state, inc = now["state"], now["inc"]
        self._words[i] = (state >> 64, state & _WORD, inc >> 64, inc & _WORD)

    def _set(self, generator: np.random.Generator, i: int) -> None:
        high, low, high_inc, low_inc = self._words[i].tolist()
        generator.bit_generator.state = {
            "bit_generator": "PCG64",
            "state": {"state": high << 64 | low, "inc": high_inc << 64 | low_inc},
            "has_uint32": 0,
            "uinteger": 0,
        }
