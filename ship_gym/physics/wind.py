"""Wind force and moment from tabulated coefficients, and the gusts along the mean wind."""

from __future__ import annotations

import math

from ship_gym.conventions import RHO_AIR
from ship_gym.physics._kernel import kernel
from ship_gym.physics.angles import arctan2, cos_sin, cos_sin_of_turns
from ship_gym.physics.interpolate import cell, linear
from ship_gym.physics.quantities import Force
from ship_gym.physics.scratch import GUST_COLUMNS
from ship_gym.physics.waves import lane_sum

_TURN = 2.0 * math.pi
_PER_TURN = 1.0 / _TURN


@kernel
def gust_factor(time, scale, gusts, phases, work):
    """Wind speed over its mean, 1 + scale sum share cos(omega t + phase).

    Parameters
    ----------
    time, scale : float
        [s], -
    gusts : ndarray (2, GUST_COLUMNS)
        Share of each harmonic, zero where they fill up, and its frequency [rad/s].
    phases : ndarray (GUST_COLUMNS,) or (0,)
        Fractions of a turn; none where no ship of the batch has gusts.
    work : ndarray (GUST_COLUMNS,)
        Scratch.
    """
    if phases.shape[0] == 0:
        return 1.0
    for k in range(GUST_COLUMNS):  # no sum yet: vector instructions
        turns = gusts[1, k] * time * _PER_TURN + phases[k]
        work[k] = gusts[0, k] * cos_sin_of_turns(turns)[0]
    for k in range(8):
        work[k] = (work[k] + work[k + 8]) + work[k + 16]
    return 1.0 + scale * lane_sum(work)


@kernel
def wind_forces(u, v, psi, factor, sea, table):
    """Force X, Y [N] and moment N [N m] of the wind relative to the ship.

    gamma_w = atan2(v - v_wind, u - u_wind): 0 is a head wind, 90 deg from starboard.

    Parameters
    ----------
    u, v, psi : float
        Velocities over ground [m/s] and heading [rad].
    factor : float
        Wind speed over its mean.
    sea : record
        Mean wind, areas A_F, A_L [m2] and length L_oa [m].
    table : ndarray (count, 3)
        CX, CY, CN over gamma_w from 0 to 2 pi.
    """
    north, east = sea.wind_north * factor, sea.wind_east * factor
    c, s = cos_sin(psi)
    du, dv = u - (north * c + east * s), v - (east * c - north * s)
    gamma = arctan2(dv, du)
    if gamma < 0.0:
        gamma += _TURN
    count = table.shape[0]
    i, w = cell(gamma, 0.0, _TURN / (count - 1), count)
    q = 0.5 * RHO_AIR * (du * du + dv * dv)
    X, Y = q * sea.A_F * linear(table, i, w, 0), q * sea.A_L * linear(table, i, w, 1)
    return Force(X, Y, q * sea.A_L * sea.L_oa * linear(table, i, w, 2))
