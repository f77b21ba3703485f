"""What the uniform numbers of one ship's sea are for, in their order.

Phases of the disturbance, of the current, of the gusts and of the waves, as fractions of a turn; a
sea without waves, wind and variation of the current has those of the disturbance only.
"""

from __future__ import annotations

import numpy as np

from ship_gym.physics.scratch import N_GUSTS

N_HARMONICS = 16  # of the disturbance
N_DISTURBANCE = 2 * N_HARMONICS  # phases of sway force and yaw moment
BEFORE_WAVES = N_DISTURBANCE + 1 + N_GUSTS


def uniform_of(seed: int | None, count: int) -> np.ndarray:
    """The numbers of a ship with a seed, as ``ShipSim.reset`` draws them, shape (count,)."""
    return np.random.default_rng(seed).random(count)


def wave_phases(seed: int | None, n_waves: int) -> np.ndarray:
    """Phases of the waves of a ship with a seed [turns], shape (n_waves,).

    In single precision, as the kernels have them.
    """
    drawn = uniform_of(seed, BEFORE_WAVES + n_waves)[BEFORE_WAVES:]
    return drawn.astype(np.float32).astype(np.float64)
