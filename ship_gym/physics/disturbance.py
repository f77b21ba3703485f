"""Random low-frequency sway force and yaw moment, the stand-in for a seaway's slow drift."""

from __future__ import annotations

import math

from ship_gym.physics._kernel import kernel


@kernel
def disturbance_forces(time, sea):
    """Sway force [N] and yaw moment [N m] at `time` [s]: sums of cosines with phases of the reset.

    Parameters
    ----------
    sea : record
        ``ship_gym.sea.state`` record: ``Y_amplitude``, ``N_amplitude``, ``omega``, ``phase_Y``,
        ``phase_N``.
    """
    if sea.Y_amplitude == 0.0 and sea.N_amplitude == 0.0:
        return 0.0, 0.0
    Y = 0.0
    N = 0.0
    for i in range(len(sea.omega)):
        Y += math.cos(sea.omega[i] * time + sea.phase_Y[i])
        N += math.cos(sea.omega[i] * time + sea.phase_N[i])
    return sea.Y_amplitude * Y, sea.N_amplitude * N
