"""What the sensors of a bridge measure: the slow motion, the wave-frequency motion, white noise.

A gyro that is lost goes on showing its last heading and yaw rate, as a repeater without a signal
does; nothing in the observation says so but that both are exactly what they were.

The noise is no stream of random numbers but a hash of (key of the episode, interval, pair), so
that any batch, in any order, gives the same numbers. 32-bit words in 64-bit integers: nothing
overflows, and plain Python gives the same bits.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ship_gym.conventions import PSI, R, U, V, X, Y
from ship_gym.physics._kernel import kernel
from ship_gym.physics.angles import cos_sin, cos_sin_of_turns
from ship_gym.physics.dynamics import water_velocity
from ship_gym.physics.waves import WAVE_SWAY, WAVE_SWAY_VELOCITY, WAVE_YAW, WAVE_YAW_RATE

_WORD = 0xFFFFFFFF
_PAIRS = 4  # pairs of normal numbers for one interval
_CHANCE = 3  # the pair that is none of noise: its first word decides whether the gyro is lost


class Measured(NamedTuple):
    """Motion as the sensors see it.

    Heading [rad] and yaw rate [rad/s]; velocities through the water [m/s]; position [m].
    """

    psi: float
    r: float
    u: float
    v: float
    north: float
    east: float


@kernel
def mixed_bits(x):
    """A 32-bit word mixed so that each bit of x moves about half of the bits of the result."""
    x = (((x >> 16) ^ x) * 0x45D9F3B) & _WORD
    x = (((x >> 16) ^ x) * 0x45D9F3B) & _WORD
    return (x >> 16) ^ x


@kernel
def normal_pair(key, interval, pair):
    """Two independent standard normal numbers (Box-Muller) of one episode and interval."""
    first = mixed_bits(mixed_bits(key) ^ ((interval * _PAIRS + pair + 1) & _WORD))
    second = mixed_bits((first + 0x3C6EF372) & _WORD)
    size = math.sqrt(-2.0 * math.log((first + 0.5) / 4294967296.0))
    c, s = cos_sin_of_turns((second + 0.5) / 4294967296.0)
    return size * c, size * s


@kernel
def chance(key, interval):
    """Uniform number in [0, 1) of one episode and interval."""
    word = mixed_bits(mixed_bits(key) ^ ((interval * _PAIRS + _CHANCE + 1) & _WORD))
    return word / 4294967296.0


@kernel
def gyro(task, interval, psi, r):
    """Heading [rad] and yaw rate [rad/s] that the gyro shows: psi and r, or what it showed last.

    It is not lost at the start. To ask twice in one interval gives the same.
    """
    if interval > 0 and interval >= task.lost_until and task.dropout_chance > 0.0:
        if chance(task.noise_key, interval) < task.dropout_chance:
            task.lost_until = interval + task.dropout_steps
    if 0 < interval < task.lost_until:
        return task.held_heading, task.held_yaw_rate
    task.held_heading, task.held_yaw_rate = psi, r
    return psi, r


@kernel
def measured(state, waves, sea, task, interval):
    """Motion as the sensors of one ship see it.

    Parameters
    ----------
    state : ndarray (8,)
    waves : ndarray (9,)
        ``physics.waves.WAVE_NAMES``.
    task : record
        Of the episode, ``tasks.bridge.record_dtype``.
    interval : int
        Intervals sailed since the reset.

    Returns
    -------
    Measured
    """
    psi = state[PSI]
    u_c, v_c = water_velocity(psi, sea)
    u, v = state[U] - u_c, state[V] - v_c + waves[WAVE_SWAY_VELOCITY]
    c, s = cos_sin(psi)
    north, east = state[X] - waves[WAVE_SWAY] * s, state[Y] + waves[WAVE_SWAY] * c
    psi, r = psi + waves[WAVE_YAW] + task.heading_bias, state[R] + waves[WAVE_YAW_RATE]
    if task.noisy == 1:
        a, b = normal_pair(task.noise_key, interval, 0)
        psi, r = psi + task.heading_noise * a, r + task.yaw_rate_noise * b
        a, b = normal_pair(task.noise_key, interval, 1)
        u, v = u + task.speed_noise * a, v + task.speed_noise * b
        if task.position_noise > 0.0:
            a, b = normal_pair(task.noise_key, interval, 2)
            north, east = north + task.position_noise * a, east + task.position_noise * b
    if task.gyro_fails == 1:
        psi, r = gyro(task, interval, psi, r)
    return Measured(psi, r, u, v, north, east)
