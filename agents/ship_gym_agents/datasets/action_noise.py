"""Noise on actions: white, or coloured as an Ornstein-Uhlenbeck process; fixed by episode's seed.

A learner that has seen one way of steering only knows nothing of the states beside it. Noise leads
there, the further the longer it lasts.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

_NOISE, _UNIFORM = 0x5EA0, 0x5EA1  # so that noise and uniform actions are other streams than a sea


def action_noise(
    seeds: Sequence[int], steps: int, columns: int, std: float, memory: float
) -> np.ndarray:
    """Noise of episodes, the same for a seed whatever other episodes are beside it.

    e_0 = s w_0, e_k = a e_(k-1) + s sqrt(1 - a^2) w_k with a = exp(-1 / memory) and w standard
    normal: the Ornstein-Uhlenbeck process of standard deviation s at the intervals, stationary
    from the first one; its correlation falls to 1/e within `memory` intervals.

    Parameters
    ----------
    seeds : sequence of int
        Of the episodes, shape (n,).
    steps, columns : int
        Control intervals; numbers of an action.
    std : float
        Standard deviation s, of actions in [-1, 1].
    memory : float
        Correlation time in control intervals; 0: white.

    Returns
    -------
    numpy.ndarray
        Shape (steps, n, columns).
    """
    shape = (steps, len(seeds), columns)
    if std == 0.0:
        return np.zeros(shape)
    noise = np.empty(shape)
    for i, seed in enumerate(seeds):
        noise[:, i] = np.random.default_rng([_NOISE, seed]).standard_normal((steps, columns))
    if memory > 0.0:
        kept = math.exp(-1.0 / memory)
        fresh = math.sqrt(1.0 - kept * kept)
        for k in range(1, steps):
            noise[k] = kept * noise[k - 1] + fresh * noise[k]
    return std * noise


def uniform_actions(seeds: Sequence[int], steps: int, columns: int) -> np.ndarray:
    """Actions drawn uniformly from [-1, 1], as Minari's random policy does; shapes as above."""
    drawn = np.empty((steps, len(seeds), columns))
    for i, seed in enumerate(seeds):
        drawn[:, i] = np.random.default_rng([_UNIFORM, seed]).uniform(-1.0, 1.0, (steps, columns))
    return drawn
