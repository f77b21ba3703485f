"""Random low-frequency sway force and yaw moment, the stand-in for a seaway's slow drift."""

from __future__ import annotations

from ship_gym.physics._kernel import kernel, loop
from ship_gym.physics.angles import cos_sin, cos_sin_of_turns

Y_COS, Y_SIN, N_COS, N_SIN = range(4)  # rows of the harmonics of one ship


@kernel
def disturbance_forces(time, omega_1, harmonics):
    """Sway force [N] and yaw moment [N m] at `time` [s]: two sums of harmonics of one frequency.

    Parameters
    ----------
    time, omega_1 : float
        [s], [rad/s]
    harmonics : ndarray (4, N)
        Coefficients of cos(k omega_1 t), sin(k omega_1 t) for k = 1..N, of force and moment.
    """
    c1, s1 = cos_sin(omega_1 * time)
    c, s = c1, s1
    Y = 0.0
    N = 0.0
    for k in range(harmonics.shape[1]):
        Y += harmonics[Y_COS, k] * c + harmonics[Y_SIN, k] * s
        N += harmonics[N_COS, k] * c + harmonics[N_SIN, k] * s
        c, s = c * c1 - s * s1, s * c1 + c * s1  # the next harmonic by the addition theorem
    return Y, N


@kernel
def set_harmonics(harmonics, sea, amplitude, uniform):
    """Set the harmonics of one ship from uniform numbers in [0, 1).

    Parameters
    ----------
    harmonics : ndarray (4, N)
        Written.
    sea : record
        With the standard deviations ``Y_std`` [N], ``N_std`` [N m].
    amplitude : ndarray (N,)
        Of each harmonic, for a unit variance.
    uniform : ndarray (2 N or more,)
        Phases of the sway force, then of the yaw moment, as fractions of a turn; what follows is
        for current, gusts and waves.
    """
    count = harmonics.shape[1]
    for k in range(count):
        c, s = cos_sin_of_turns(uniform[k])
        harmonics[Y_COS, k] = sea.Y_std * amplitude[k] * c
        harmonics[Y_SIN, k] = -sea.Y_std * amplitude[k] * s
        c, s = cos_sin_of_turns(uniform[count + k])
        harmonics[N_COS, k] = sea.N_std * amplitude[k] * c
        harmonics[N_SIN, k] = -sea.N_std * amplitude[k] * s


@loop
def draw_disturbance(which, harmonics, seas, amplitude, uniform):
    """`set_harmonics` of some ships: harmonics (n, 4, N), uniform (m, 2 N or more)."""
    for row in range(len(which)):
        ship = which[row]
        set_harmonics(harmonics[ship], seas[ship], amplitude, uniform[row])
