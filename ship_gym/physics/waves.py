"""Waves at the ship: slowly varying drift and wave-frequency motion.

Two time scales (White 2020): the drift, of second order in the wave amplitude, acts on the ship of
the manoeuvring model; the wave-frequency motion, of first order, is what its sensors see on top of
that and is never integrated.

The motion is that of now; the drift is that of half an integration step later, where ship and
waves will be if she goes on as she does: held during the step, it is then right to second order.

For speed, each wave's share in every sum is written to a row of numbers first: that loop has no
sums and is compiled to vector instructions. The rows are then summed in a fixed order.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ship_gym.physics._kernel import kernel
from ship_gym.physics.angles import cos_sin, cos_sin_of_turns, wrapped
from ship_gym.physics.dynamics import water_velocity
from ship_gym.physics.interpolate import cell
from ship_gym.physics.quantities import Body
from ship_gym.physics.scratch import N_SUMS, N_TOGETHER

# Rows of the waves of a sea: amplitude [m], frequency [rad/s], wave number [1/m]; of those of one
# ship (`waves_of`) further the phase [turns] and the direction they go to [rad].
AMPLITUDE, OMEGA, NUMBER, PHASE, DIRECTION = range(5)
# Channels of a response: drift X, Y, N, and real and imaginary part of sway, roll and yaw
DRIFT_X, DRIFT_Y, DRIFT_N, SWAY, SWAY_, ROLL, ROLL_, YAW, YAW_ = range(9)


class Waves(NamedTuple):
    """The waves of all ships of a batch.

    Attributes
    ----------
    components : ndarray (kinds, 3, N)
        Amplitude, frequency and wave number of the waves of each sea, sorted by direction.
    offsets, groups : ndarray (G,), ndarray of int (G + 1,)
        Directions relative to the sea's main one [rad]; first wave of each, and N.
    response : ndarray (kinds, speeds, headings, 9, N)
        Of the ship in that sea. Headings from 0 to pi; sway, roll, yaw and their drift change sign
        with the side.
    phases : ndarray (n, N)
        Of each ship [turns].
    """

    components: np.ndarray
    offsets: np.ndarray
    groups: np.ndarray
    response: np.ndarray
    phases: np.ndarray


class WaveState(NamedTuple):
    """What waves do to a ship at one instant.

    Drift X, Y [N], N [N m], half an integration step later; wave-frequency sway [m], its velocity
    [m/s], roll, yaw [rad] and yaw rate [rad/s]; how far the ship is faster than its table goes, 0
    inside; and that half step, `lead` [s].
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
    lead: float


WAVE_NAMES = WaveState._fields
N_WAVE_STATE = len(WAVE_NAMES)
WAVE_X, WAVE_Y, WAVE_N = range(3)
WAVE_SWAY, WAVE_SWAY_VELOCITY, WAVE_ROLL, WAVE_YAW, WAVE_YAW_RATE = range(3, 8)
WAVE_EXTRAPOLATION, WAVE_LEAD = 8, 9
_PER_TURN = 0.5 / math.pi


class Sums(NamedTuple):
    """What is summed over the waves, each `P` and `Q` a complex number.

    P = sum a T exp(i theta) of each drift coefficient T and Q = sum a exp(i theta), half a step
    later; then the motions now.
    """

    X: float
    X_: float
    Y: float
    Y_: float
    N: float
    N_: float
    Q: float
    Q_: float
    sway: float
    sway_velocity: float
    roll: float
    yaw: float
    yaw_rate: float


NO_WAVES = Sums(*[0.0] * N_SUMS)


@kernel
def relative_heading(psi, direction):
    """Mu = psi - wave_direction_to in [0, pi] and the side, 1 or -1, on which the waves come in."""
    mu = wrapped(psi - direction)
    return (mu, 1.0) if mu >= 0.0 else (-mu, -1.0)


class Encounter(NamedTuple):
    """How one ship meets the waves of one direction.

    Attributes
    ----------
    along, speed : float
        Her place [m] and velocity over ground [m/s] in that direction.
    side : float
        1 or -1, on which the waves come in.
    i, j : int
        Cell of the response, in speed and heading.
    a, b, c, d : float
        Weights of its corners (i, j), (i, j + 1), (i + 1, j), (i + 1, j + 1).
    """

    along: float
    speed: float
    side: float
    i: int
    j: int
    a: float
    b: float
    c: float
    d: float


@kernel
def encounter(body, direction, surge, response):
    """`Encounter` of one ship with the waves that go to a direction [rad].

    Parameters
    ----------
    body : Body
    surge : (int, float)
        Cell of her speed through the water, and the weight of its upper end.
    response : ndarray (speeds, headings, 9, N)
    """
    u, v, _, x, y, psi = body
    c, s = cos_sin(direction)
    c_mu, s_mu = cos_sin(psi - direction)
    headings = response.shape[1]
    mu, side = relative_heading(psi, direction)
    j, q = cell(mu, 0.0, math.pi / (headings - 1), headings)
    i, w = surge
    p = 1.0 - w
    speed = u * c_mu - v * s_mu
    return Encounter(
        x * c + y * s, speed, side, i, j, p * (1.0 - q), p * q, w * (1.0 - q), w * q
    )


@kernel
def mixed(response, at, channel, k):
    """A channel of wave k's response between the four corners of an `Encounter`."""
    i, j = at.i, at.j
    low = at.a * response[i, j, channel, k] + at.b * response[i, j + 1, channel, k]
    return low + at.c * response[i + 1, j, channel, k] + at.d * response[i + 1, j + 1, channel, k]


@kernel
def of_wave(k, time, lead, components, phase, response, now, later, mean):
    """`Sums` of wave k alone, of a sea of unit height.

    A wave of amplitude a has the phase theta = omega t - k_w place + phase at the ship, and the
    frequency omega_e at a place that moves with her.

    Parameters
    ----------
    time, lead : float
        Now, and how much later the drift is [s].
    components : ndarray (3, N)
    phase : ndarray (N,)
    now, later : Encounter
    mean : bool
        Only the constant part of the drift, a^2 T, for Q = 1.
    """
    a, omega, number = components[AMPLITUDE, k], components[OMEGA, k], components[NUMBER, k]
    turns = (omega * (time + lead) - number * later.along) * _PER_TURN + phase[k]
    c, s = cos_sin_of_turns(turns)
    c, s = a * c, a * s
    p, p_ = (a * a, 0.0) if mean else (c, s)
    X = mixed(response, later, DRIFT_X, k)
    Y = later.side * mixed(response, later, DRIFT_Y, k)
    N = later.side * mixed(response, later, DRIFT_N, k)
    drift = (X * p, X * p_, Y * p, Y * p_, N * p, N * p_, c, s)
    c, s = cos_sin_of_turns((omega * time - number * now.along) * _PER_TURN + phase[k])
    c, s = now.side * a * c, now.side * a * s
    omega_e = omega - number * now.speed
    re, im = mixed(response, now, SWAY, k), mixed(response, now, SWAY_, k)
    sway, sway_velocity = re * c - im * s, -omega_e * (re * s + im * c)
    roll = mixed(response, now, ROLL, k) * c - mixed(response, now, ROLL_, k) * s
    re, im = mixed(response, now, YAW, k), mixed(response, now, YAW_, k)
    X, X_, Y, Y_, N, N_, c_, s_ = drift
    return Sums(
        X, X_, Y, Y_, N, N_, c_, s_,
        sway, sway_velocity, roll, re * c - im * s, -omega_e * (re * s + im * c),
    )  # fmt: skip


@kernel
def lane_sum(row):
    """Sum of a row of `N_TOGETHER` lanes, by halves."""
    half = N_TOGETHER // 2
    while half > 0:
        for k in range(half):
            row[k] += row[k + half]
        half //= 2
    return row[0]


@kernel
def summed(
    first, count, time, lead, components, phase, response, now, later, mean, lanes
):  # fmt: skip
    """Add what some waves of one direction bring, at most `N_TOGETHER`, to the sums in `lanes`.

    `first` and `count` are unsigned, for which no index from the end is looked for in the loop;
    else as in `of_wave`.
    """
    for k in range(count):
        one = of_wave(first + k, time, lead, components, phase, response, now, later, mean)
        for j in range(N_SUMS):
            lanes[j, k] += one[j]


@kernel
def ahead_of(body, time):
    """Body that has gone on for `time` [s] with its present velocities in body axes."""
    u, v, r, x, y, psi = body
    c, s = cos_sin(psi + 0.5 * r * time)
    return Body(
        u, v, r, x + time * (u * c - v * s), y + time * (u * s + v * c), psi + time * r
    )


@kernel
def wave_loads(time, lead, body, sea, waves, ship, lanes):
    """Drift on one ship and its wave-frequency motion.

    Newman's approximation with the arithmetic mean of the two drift coefficients, which factorises:
    F = Re[P Q*], P = sum a T e^(i theta), Q = sum a e^(i theta). One wave alone gives a^2 T. With
    ``sea.mean_drift`` only the constant part, sum a^2 T.

    Parameters
    ----------
    time, lead : float
        Now, and how much later the drift is [s].
    body : Body
    sea : record
        Current, kind and height of the waves and where they go to.
    waves : Waves
    ship : int
        Row of her phases.
    lanes : ndarray (N_SUMS, N_TOGETHER)
        Scratch.

    Returns
    -------
    WaveState
    """
    kind = sea.response
    components, response, phase = waves.components[kind], waves.response[kind], waves.phases[ship]
    u_c, _ = water_velocity(body.psi, sea)
    u = body.u - u_c
    surge = cell(min(u, sea.speed_max), 0.0, sea.speed_step, response.shape[0])
    later = ahead_of(body, lead)
    for j in range(N_SUMS):
        for k in range(N_TOGETHER):
            lanes[j, k] = 0.0
    for g in range(waves.offsets.shape[0]):
        direction = sea.wave_to + waves.offsets[g]
        at = encounter(body, direction, surge, response)
        then = encounter(later, direction, surge, response)
        last = waves.groups[g + 1]
        for a in range(waves.groups[g], last, N_TOGETHER):
            count = min(N_TOGETHER, last - a)
            summed(
                np.uint64(a), np.uint64(count), time, lead, components, phase, response, at, then,
                sea.mean_drift == 1, lanes,
            )  # fmt: skip
    total = Sums(
        lane_sum(lanes[0]), lane_sum(lanes[1]), lane_sum(lanes[2]), lane_sum(lanes[3]),
        lane_sum(lanes[4]), lane_sum(lanes[5]), lane_sum(lanes[6]), lane_sum(lanes[7]),
        lane_sum(lanes[8]), lane_sum(lanes[9]), lane_sum(lanes[10]), lane_sum(lanes[11]),
        lane_sum(lanes[12]),
    )  # fmt: skip
    return of_sums(total, sea, max(0.0, u / sea.speed_max - 1.0), lead)


@kernel
def of_sums(total, sea, extrapolation, lead):
    """`WaveState` of the sums over all waves; `sea` says how high the waves are."""
    t, height = total, sea.wave_share
    Q, Q_ = (1.0, 0.0) if sea.mean_drift == 1 else (t.Q, t.Q_)
    force = sea.drift * height * height
    return WaveState(
        X=force * (t.X * Q + t.X_ * Q_),
        Y=force * (t.Y * Q + t.Y_ * Q_),
        N=force * (t.N * Q + t.N_ * Q_),
        sway=height * t.sway,
        sway_velocity=height * t.sway_velocity,
        roll=height * t.roll,
        yaw=height * t.yaw,
        yaw_rate=height * t.yaw_rate,
        extrapolation=extrapolation,
        lead=lead,
    )
