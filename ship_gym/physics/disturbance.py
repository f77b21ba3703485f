"""Random low-frequency sway force and yaw moment, the stand-in for a seaway's slow drift."""

from __future__ import annotations

import math

from ship_gym.physics._kernel import kernel


@kernel
def disturbance_forces(time, sea):
    """Sway force [N] and yaw moment [N m] at `time` [s]: two sums of harmonics of one frequency.

    Parameters
    ----------
    sea : record
        ``ship_gym.sea.records.SEA_DTYPE``: ``omega_1`` [rad/s] and the coefficients of
        cos(k omega_1 t), sin(k omega_1 t) for k = 1..N.
    """
    c1, s1 = math.cos(sea.omega_1 * time), math.sin(sea.omega_1 * time)
    c, s = c1, s1
    Y = 0.0
    N = 0.0
    for k in range(len(sea.Y_cos)):
        Y += sea.Y_cos[k] * c + sea.Y_sin[k] * s
        N += sea.N_cos[k] * c + sea.N_sin[k] * s
        c, s = c * c1 - s * s1, s * c1 + c * s1  # the next harmonic by the addition theorem
    return Y, N


@kernel
def set_harmonics(seas, uniform):
    """Set the harmonics of every row from uniform numbers in [0, 1).

    Parameters
    ----------
    seas : structured ndarray (n,)
    uniform : ndarray (n, 2 N or more)
        Phases of the sway force, then of the yaw moment, as fractions of a turn; what follows is
        for ``sea.records.set_phases`` and ``waves.set_waves``.
    """
    for i in range(len(seas)):
        sea = seas[i]
        count = len(sea.amplitude)
        for k in range(count):
            phase_Y = 2.0 * math.pi * uniform[i, k]
            phase_N = 2.0 * math.pi * uniform[i, count + k]
            sea.Y_cos[k] = sea.Y_std * sea.amplitude[k] * math.cos(phase_Y)
            sea.Y_sin[k] = -sea.Y_std * sea.amplitude[k] * math.sin(phase_Y)
            sea.N_cos[k] = sea.N_std * sea.amplitude[k] * math.cos(phase_N)
            sea.N_sin[k] = -sea.N_std * sea.amplitude[k] * math.sin(phase_N)
