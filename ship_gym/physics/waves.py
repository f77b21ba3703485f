"""Waves at the ship: slowly varying drift and wave-frequency motion.

Two time scales (White 2020): the drift, of second order in the wave amplitude, acts on the ship of
the manoeuvring model; the wave-frequency motion, of first order, is what its sensors see on top of
that and is never integrated.

Two loops over the waves, for speed: the first, `met_waves`, has no sums and reads rows of numbers
that lie side by side, so that it is compiled to vector instructions, without which the cosines and
sines are half of the time; the second forms the sums.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ship_gym.conventions import G
from ship_gym.physics._kernel import kernel
from ship_gym.physics.angles import cos_sin_of_turns, wrapped
from ship_gym.physics.interpolate import cell

# Rows of the waves of one ship: amplitude [m], frequency [rad/s], wave number north and east [1/m],
# phase [turns] and direction it goes to [rad]. ``sea.wave_response`` has the number of rows and the
# channels of the response.
AMPLITUDE, OMEGA, K_NORTH, K_EAST, PHASE, DIRECTION = range(6)


class WaveState(NamedTuple):
    """What waves do to a ship at one instant.

    Drift X, Y [N], N [N m]; wave-frequency sway [m], its velocity [m/s], roll, yaw [rad] and yaw
    rate [rad/s]; and how far the ship is faster than its table goes, 0 inside.
    """

    X: float
    Y: float
    N: float
    sway: float
    sway_velocity: float
    roll: float
    yaw: float
    yaw_rate: float
    extrapolation: float


WAVE_NAMES = WaveState._fields
N_WAVE_STATE = len(WAVE_NAMES)
WAVE_X, WAVE_Y, WAVE_N = range(3)
WAVE_SWAY, WAVE_SWAY_VELOCITY, WAVE_ROLL, WAVE_YAW, WAVE_YAW_RATE, WAVE_EXTRAPOLATION = range(3, 9)
_TURN = 2.0 * math.pi


@kernel
def relative_heading(psi, direction):
    """Mu = psi - wave_direction_to in [0, pi] and the side, 1 or -1, on which the waves come in."""
    mu = wrapped(psi - direction)
    return (mu, 1.0) if mu >= 0.0 else (-mu, -1.0)


@kernel
def met_waves(time, body, waves):
    """Each wave as the ship meets it: a cos theta, a sin theta [m] and omega_e, shape (3, N).

    Theta = omega t - k . place + phase, of a wave of amplitude a; omega_e [rad/s] is its frequency
    at a place that moves with the ship. `time`, `body` and `waves` as in `wave_loads`.
    """
    u, v, _, x, y, psi = body
    c_psi, s_psi = math.cos(psi), math.sin(psi)
    north, east = u * c_psi - v * s_psi, u * s_psi + v * c_psi
    met = np.empty((3, waves.shape[1]))
    for k in range(waves.shape[1]):
        a, omega = waves[AMPLITUDE, k], waves[OMEGA, k]
        k_north, k_east = waves[K_NORTH, k], waves[K_EAST, k]
        along = k_north * x + k_east * y
        c, s = cos_sin_of_turns((omega * time - along) / _TURN + waves[PHASE, k])
        met[0, k], met[1, k] = a * c, a * s
        met[2, k] = omega - k_north * north - k_east * east
    return met


@kernel
def mixed(response, at, k, channel):
    """A channel of wave k's response between four corners of the table (speed by heading)."""
    i, j, a, b, c, d = at
    low = a * response[i, j, k, channel] + b * response[i, j + 1, k, channel]
    return low + c * response[i + 1, j, k, channel] + d * response[i + 1, j + 1, k, channel]


@kernel
def set_waves(components, direction_to, uniform, waves):
    """Set the waves of one ship's sea.

    Parameters
    ----------
    components : ndarray (N, 3)
        Amplitude [m], frequency [rad/s] and direction relative to the sea's main one [rad].
    direction_to : float
        Where the sea goes to, from north [rad].
    uniform : ndarray (N,)
        Phases as fractions of a turn.
    waves : ndarray (6, N)
        Written.
    """
    for n in range(components.shape[0]):
        amplitude, omega, offset = components[n, 0], components[n, 1], components[n, 2]
        direction = direction_to + offset
        k = omega * omega / G
        waves[AMPLITUDE, n] = amplitude
        waves[OMEGA, n] = omega
        waves[K_NORTH, n] = k * math.cos(direction)
        waves[K_EAST, n] = k * math.sin(direction)
        waves[PHASE, n] = uniform[n]
        waves[DIRECTION, n] = direction


@kernel
def wave_loads(time, body, waves, groups, response, grid, mean_only):
    """Drift on one ship and its wave-frequency motion at one instant.

    Newman's approximation with the arithmetic mean of the two drift coefficients, which factorises:
    F = Re[P Q*], P = sum a T e^(i theta), Q = sum a e^(i theta). One wave alone gives a^2 T.

    Parameters
    ----------
    time : float
        [s]
    body : Body
    waves : ndarray (6, N)
        Sorted by direction.
    groups : ndarray of int (G + 1,)
        First wave of each direction, and N.
    response : ndarray (speeds, headings, N, 9)
        Headings from 0 to pi; sway, roll, yaw and their drift change sign with the side.
    grid : (float, float, float)
        Speed step of the table, its largest speed and surge velocity through the water [m/s].
    mean_only : bool
        Only the constant part of the drift, sum a^2 T.

    Returns
    -------
    WaveState
    """
    _, _, _, _, _, psi = body
    met = met_waves(time, body, waves)
    speeds, headings = response.shape[0], response.shape[1]
    speed_step, speed_max, u = grid
    i, w = cell(min(u, speed_max), 0.0, speed_step, speeds)
    PX = PX_ = PY = PY_ = PN = PN_ = Q = Q_ = 0.0
    sway = sway_rate = roll = yaw = yaw_rate = 0.0
    for g in range(len(groups) - 1):
        mu, side = relative_heading(psi, waves[DIRECTION, groups[g]])
        j, q = cell(mu, 0.0, math.pi / (headings - 1), headings)
        p = 1.0 - w
        at = (i, j, p * (1.0 - q), p * q, w * (1.0 - q), w * q)
        for k in range(groups[g], groups[g + 1]):
            c, s, omega_e = met[0, k], met[1, k], met[2, k]
            TX = mixed(response, at, k, 0)
            TY = side * mixed(response, at, k, 1)
            TN = side * mixed(response, at, k, 2)
            if mean_only:
                a2 = waves[AMPLITUDE, k] * waves[AMPLITUDE, k]
                PX, PY, PN = PX + a2 * TX, PY + a2 * TY, PN + a2 * TN
            else:
                PX, PX_ = PX + TX * c, PX_ + TX * s
                PY, PY_ = PY + TY * c, PY_ + TY * s
                PN, PN_ = PN + TN * c, PN_ + TN * s
                Q, Q_ = Q + c, Q_ + s
            c, s = side * c, side * s
            re, im = mixed(response, at, k, 3), mixed(response, at, k, 4)
            sway += re * c - im * s
            sway_rate -= omega_e * (re * s + im * c)
            roll += mixed(response, at, k, 5) * c - mixed(response, at, k, 6) * s
            re, im = mixed(response, at, k, 7), mixed(response, at, k, 8)
            yaw += re * c - im * s
            yaw_rate -= omega_e * (re * s + im * c)
    if not mean_only:
        PX, PY, PN = PX * Q + PX_ * Q_, PY * Q + PY_ * Q_, PN * Q + PN_ * Q_
    outside = max(0.0, u / speed_max - 1.0)
    return WaveState(PX, PY, PN, sway, sway_rate, roll, yaw, yaw_rate, outside)
