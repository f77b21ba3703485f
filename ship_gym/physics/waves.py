"""Waves at the ship: slowly varying drift and wave-frequency motion.

Two time scales (White 2020): the drift, of second order in the wave amplitude, acts on the ship of
the manoeuvring model; the wave-frequency motion, of first order, is what its sensors see on top of
that and is never integrated.

The motion is that of now; the drift is the mean over the coming integration step, during which it
is held.

For speed, eight sums are formed side by side, which is compiled to vector instructions; those eight
are added in a fixed order, so that every processor gets the same bits.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ship_gym.physics._kernel import kernel, loop
from ship_gym.physics.angles import cos_sin, cos_sin_of_turns, wrapped
from ship_gym.physics.interpolate import cell
from ship_gym.physics.quantities import record_type
from ship_gym.physics.scratch import EIGHT, N_SUMS

# Rows of the waves of a sea: amplitude [m], frequency [rad/s], wave number [1/m]; of those of one
# ship (`waves_of`) further the phase [turns] and the direction they go to [rad].
AMPLITUDE, OMEGA, NUMBER, PHASE, DIRECTION = range(5)
# Channels of a response: drift X, Y, N, and real and imaginary part of sway, roll and yaw
DRIFT_X, DRIFT_Y, DRIFT_N, SWAY, SWAY_, ROLL, ROLL_, YAW, YAW_ = range(9)


# Response to eight waves, channel by channel
EIGHT_WAVES = record_type([("of", np.float64, (9, int(EIGHT)))])


class Waves(NamedTuple):
    """The waves of all ships of a batch.

    Attributes
    ----------
    components : ndarray (kinds, 3, N)
        Amplitude, frequency and wave number of the waves of each sea, sorted by direction; those of
        one direction filled up with waves of no height to a multiple of 8.
    offsets, turns, groups : ndarray (G,), (G, 2), ndarray of np.uint64 (G + 1,)
        Directions relative to the main one of their system [rad], their cosines and sines; first
        eight of each, and N / 8.
    swell : ndarray of bool (G,)
        Whether it belongs to a swell that goes its own way in each episode (``sea.swell_to``).
    response : structured ndarray (kinds, speeds, headings, N / 8)
        `EIGHT_WAVES` of the ship in that sea: what eight waves need lies together. Headings from 0
        to pi; sway, roll, yaw and their drift change sign with the side.
    phases : ndarray of float32 (n, N)
        Of each ship [turns].
    """

    components: np.ndarray
    offsets: np.ndarray
    turns: np.ndarray
    groups: np.ndarray
    swell: np.ndarray
    response: np.ndarray
    phases: np.ndarray


class WaveState(NamedTuple):
    """What waves do to a ship at one instant.

    Drift X, Y [N], N [N m], its mean over the coming integration step; wave-frequency sway [m],
    its velocity [m/s], roll, yaw [rad] and yaw rate [rad/s]; how far the ship is faster than its
    table goes, 0 inside; and the length of that step, `ahead` [s].
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
    ahead: float


WAVE_NAMES = WaveState._fields
N_WAVE_STATE = len(WAVE_NAMES)
WAVE_X, WAVE_Y, WAVE_N = range(3)
WAVE_SWAY, WAVE_SWAY_VELOCITY, WAVE_ROLL, WAVE_YAW, WAVE_YAW_RATE = range(3, 8)
WAVE_EXTRAPOLATION, WAVE_AHEAD = 8, 9
_PER_TURN = 0.5 / math.pi


class Sums(NamedTuple):
    """What is summed over the waves.

    Complex numbers at two instants of the coming step (1 and 2; real and imaginary part):
    P = sum a T exp(i theta) of each drift coefficient T (X, Y, N), and Q = sum a exp(i theta).
    Then the motions now.
    """

    X1: float
    X1_: float
    Y1: float
    Y1_: float
    N1: float
    N1_: float
    Q1: float
    Q1_: float
    X2: float
    X2_: float
    Y2: float
    Y2_: float
    N2: float
    N2_: float
    Q2: float
    Q2_: float
    sway: float
    sway_velocity: float
    roll: float
    yaw: float
    yaw_rate: float


@kernel
def relative_heading(psi, direction):
    """Mu = psi - wave_direction_to in [0, pi] and the side, 1 or -1, on which the waves come in."""
    mu = wrapped(psi - direction)
    return (mu, 1.0) if mu >= 0.0 else (-mu, -1.0)


class Path(NamedTuple):
    """Place [m] and velocity over ground [m/s] of a ship in the direction of some waves."""

    along: float
    speed: float


class Corners(NamedTuple):
    """Where a ship is in its table of responses.

    Attributes
    ----------
    side : float
        1 or -1, on which the waves come in.
    i, j : int
        Cell in speed and heading.
    a, b, c, d : float
        Weights of its corners (i, j), (i, j + 1), (i + 1, j), (i + 1, j + 1).
    """

    side: float
    i: int
    j: int
    a: float
    b: float
    c: float
    d: float


@kernel
def corners(psi, direction, surge, response):
    """`Corners` of a ship on a heading in waves that go to a direction, both [rad].

    `surge` is the cell of her speed through the water and the weight of its upper end; `response`
    has the shape (speeds, headings, N / 8).
    """
    headings = response.shape[1]
    mu, side = relative_heading(psi, direction)
    j, q = cell(mu * ((headings - 1) / math.pi), 0.0, 1.0, headings)
    i, w = surge
    p = 1.0 - w
    return Corners(side, i, j, p * (1.0 - q), p * q, w * (1.0 - q), w * q)


@kernel
def mirrored(at):
    """Corners with weights for what changes sign with the side."""
    side = at.side
    return Corners(side, at.i, at.j, side * at.a, side * at.b, side * at.c, side * at.d)


@kernel
def mixed(response, at, eight, channel, lane):
    """A channel of one wave's response between four `Corners`."""
    i, j = at.i, at.j
    low = at.a * response[i, j, eight].of[channel, lane]
    low += at.b * response[i, j + 1, eight].of[channel, lane]
    low += at.c * response[i + 1, j, eight].of[channel, lane]
    return low + at.d * response[i + 1, j + 1, eight].of[channel, lane]


@kernel
def of_wave(
    eight, lane, time, dt, path, share, components, phase, response, now, later, across, mean
):  # fmt: skip
    """`Sums` of one wave alone, that of a lane of an eight, of a sea of unit height.

    A wave of amplitude a has the phase theta = omega t - k_w place + phase at the ship, and the
    frequency omega_e at a place that moves with her, which turns the phase to that of the coming
    step's first and third quarter.

    Parameters
    ----------
    time, dt : float
        Now, and the length of the coming step [s].
    path : Path
    share : float
        Height of the waves of its system by that of their components, beside ``sea.wave_share``.
    components : ndarray (3, N)
    phase : ndarray (N,)
    now, later, across : Corners
        For the motions now; at the heading of the middle of the coming step, for the drift in surge
        and, `mirrored`, in sway and yaw.
    mean : bool
        Only the constant part of the drift, a^2 T, for Q = 1.
    """
    k = eight * EIGHT + lane
    a = share * components[AMPLITUDE, k]
    omega, number = components[OMEGA, k], components[NUMBER, k]
    omega_e = omega - number * path.speed
    c, s = cos_sin_of_turns((omega * time - number * path.along) * _PER_TURN + phase[k])
    c, s = a * c, a * s
    re, im = mixed(response, now, eight, SWAY, lane), mixed(response, now, eight, SWAY_, lane)
    sway, sway_velocity = re * c - im * s, -omega_e * (re * s + im * c)
    roll = (
        mixed(response, now, eight, ROLL, lane) * c - mixed(response, now, eight, ROLL_, lane) * s
    )
    re, im = mixed(response, now, eight, YAW, lane), mixed(response, now, eight, YAW_, lane)
    yaw, yaw_rate = re * c - im * s, -omega_e * (re * s + im * c)
    c_q, s_q = cos_sin_of_turns(0.25 * dt * _PER_TURN * omega_e)
    c_h, s_h = c_q * c_q - s_q * s_q, 2.0 * c_q * s_q
    c1, s1 = c * c_q - s * s_q, s * c_q + c * s_q
    c2, s2 = c1 * c_h - s1 * s_h, s1 * c_h + c1 * s_h
    if mean:
        c1, s1, c2, s2 = a * a, 0.0, a * a, 0.0
    X, Y = (
        mixed(response, later, eight, DRIFT_X, lane),
        mixed(response, across, eight, DRIFT_Y, lane),
    )
    N = mixed(response, across, eight, DRIFT_N, lane)
    return Sums(
        X * c1, X * s1, Y * c1, Y * s1, N * c1, N * s1, c1, s1,
        X * c2, X * s2, Y * c2, Y * s2, N * c2, N * s2, c2, s2,
        sway, sway_velocity, roll, yaw, yaw_rate,
    )  # fmt: skip


@kernel
def lane_sum(lanes):
    """Sum of the eight lanes of a row, by halves."""
    low = (lanes[0] + lanes[4]) + (lanes[2] + lanes[6])
    return low + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]))


@kernel
def lane_sums(lanes):
    """`Sums` of all lanes, shape (N_SUMS, EIGHT)."""
    return Sums(
        lane_sum(lanes[0]),
        lane_sum(lanes[1]),
        lane_sum(lanes[2]),
        lane_sum(lanes[3]),
        lane_sum(lanes[4]),
        lane_sum(lanes[5]),
        lane_sum(lanes[6]),
        lane_sum(lanes[7]),
        lane_sum(lanes[8]),
        lane_sum(lanes[9]),
        lane_sum(lanes[10]),
        lane_sum(lanes[11]),
        lane_sum(lanes[12]),
        lane_sum(lanes[13]),
        lane_sum(lanes[14]),
        lane_sum(lanes[15]),
        lane_sum(lanes[16]),
        lane_sum(lanes[17]),
        lane_sum(lanes[18]),
        lane_sum(lanes[19]),
        lane_sum(lanes[20]),
    )


@kernel
def sum_waves(
    first, last, time, dt, path, share, components, phase, response, now, later, across, mean, lanes
):  # fmt: skip
    """Add what the waves of one direction bring to the sums in `lanes`, eight side by side.

    `first` and `last` count eights; what is left out is as in `of_wave`. All indices are
    unsigned: for others numba looks whether they count from the end, in every wave.
    """
    for eight in range(first, last):
        for k in range(EIGHT):
            one = of_wave(
                eight, k, time, dt, path, share, components, phase, response, now, later, across,
                mean,
            )  # fmt: skip
            # line by line: an index into a tuple is a switch, which cannot be vectorised
            lanes[0, k] += one.X1
            lanes[1, k] += one.X1_
            lanes[2, k] += one.Y1
            lanes[3, k] += one.Y1_
            lanes[4, k] += one.N1
            lanes[5, k] += one.N1_
            lanes[6, k] += one.Q1
            lanes[7, k] += one.Q1_
            lanes[8, k] += one.X2
            lanes[9, k] += one.X2_
            lanes[10, k] += one.Y2
            lanes[11, k] += one.Y2_
            lanes[12, k] += one.N2
            lanes[13, k] += one.N2_
            lanes[14, k] += one.Q2
            lanes[15, k] += one.Q2_
            lanes[16, k] += one.sway
            lanes[17, k] += one.sway_velocity
            lanes[18, k] += one.roll
            lanes[19, k] += one.yaw
            lanes[20, k] += one.yaw_rate


@kernel
def wave_loads(time, dt, body, sea, waves, ship, lanes):
    """Drift on one ship in the coming step and its wave-frequency motion now.

    Newman's approximation with the arithmetic mean of the two drift coefficients, which factorises:
    F = Re[P Q*], P = sum a T e^(i theta), Q = sum a e^(i theta). One wave alone gives a^2 T. With
    ``sea.mean_drift`` only the constant part, sum a^2 T.

    The drift is the mean of those at a quarter and three quarters of the step, for a ship that goes
    on as she does. One sample a second would make a constant force of difference frequencies of
    2 pi rad/s, which a seaway met at speed has; two do not (docs/accuracy.md).

    Parameters
    ----------
    time, dt : float
        Now, and the length of the coming step [s].
    body : Body
    sea : record
        Current, kind and height of the waves and where they go to.
    waves : Waves
    ship : int
        Row of her phases.
    lanes : ndarray (N_SUMS, EIGHT)
        Scratch.

    Returns
    -------
    WaveState
    """
    kind = sea.response
    components, response, phase = waves.components[kind], waves.response[kind], waves.phases[ship]
    c, s = cos_sin(body.psi)
    u = body.u - (sea.V_north * c + sea.V_east * s)
    north, east = body.u * c - body.v * s, body.u * s + body.v * c
    surge = cell(min(u, sea.speed_max), 0.0, sea.speed_step, response.shape[0])
    psi = body.psi + 0.5 * dt * body.r
    for j in range(N_SUMS):
        for k in range(EIGHT):
            lanes[j, k] = 0.0
    for g in range(waves.offsets.shape[0]):
        main, ahead, aside, share = sea.wave_to, sea.wave_north, sea.wave_east, sea.wind_sea
        if waves.swell[g]:
            main, ahead, aside, share = sea.swell_to, sea.swell_north, sea.swell_east, sea.swell
        direction = main + waves.offsets[g]
        c, s = waves.turns[g, 0], waves.turns[g, 1]
        to_north, to_east = ahead * c - aside * s, ahead * s + aside * c
        path = Path(body.x * to_north + body.y * to_east, north * to_north + east * to_east)
        now = mirrored(corners(body.psi, direction, surge, response))
        later = corners(psi, direction, surge, response)
        sum_waves(
            waves.groups[g], waves.groups[g + 1], time, dt, path, share, components, phase,
            response, now, later, mirrored(later), sea.mean_drift == 1, lanes,
        )  # fmt: skip
    return of_sums(lane_sums(lanes), sea, max(0.0, u / sea.speed_max - 1.0), dt)


@kernel
def of_sums(total, sea, extrapolation, dt):
    """`WaveState` of the sums over all waves; `sea` says how high the waves are."""
    t, height = total, sea.wave_share
    Q1, Q1_, Q2, Q2_ = t.Q1, t.Q1_, t.Q2, t.Q2_
    if sea.mean_drift == 1:
        Q1, Q1_, Q2, Q2_ = 1.0, 0.0, 1.0, 0.0
    force = 0.5 * sea.drift * height * height
    return WaveState(
        X=force * (t.X1 * Q1 + t.X1_ * Q1_ + t.X2 * Q2 + t.X2_ * Q2_),
        Y=force * (t.Y1 * Q1 + t.Y1_ * Q1_ + t.Y2 * Q2 + t.Y2_ * Q2_),
        N=force * (t.N1 * Q1 + t.N1_ * Q1_ + t.N2 * Q2 + t.N2_ * Q2_),
        sway=height * t.sway,
        sway_velocity=height * t.sway_velocity,
        roll=height * t.roll,
        yaw=height * t.yaw,
        yaw_rate=height * t.yaw_rate,
        extrapolation=extrapolation,
        ahead=dt,
    )


@loop
def set_direction(which, seas, direction_to):
    """Set where the waves of some ships go to, from north [rad]."""
    for row in range(len(which)):
        sea = seas[which[row]]
        sea.wave_to = direction_to[row]
        sea.wave_north, sea.wave_east = cos_sin(direction_to[row])
