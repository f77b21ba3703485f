"""Wind force and moment from tabulated coefficients, and the gusts along the mean wind."""

from __future__ import annotations

import math

from ship_gym.conventions import RHO_AIR
from ship_gym.physics._kernel import kernel
from ship_gym.physics.angles import cos_sin_of_turns
from ship_gym.physics.interpolate import cell, linear
from ship_gym.physics.quantities import Force

_TURN = 2.0 * math.pi


@kernel
def gust_factor(time, sea):
    """Wind speed over its mean, 1 + sum share cos(omega t + phase)."""
    factor = 1.0
    for k in range(len(sea.gust_share)):
        turns = sea.gust_omega[k] * time / _TURN + sea.gust_phase[k]
        factor += sea.gust_share[k] * cos_sin_of_turns(turns)[0]
    return factor


@kernel
def wind_forces(time, body, sea, table):
    """Force X, Y [N] and moment N [N m] of the wind relative to the ship.

    gamma_w = atan2(v - v_wind, u - u_wind): 0 is a head wind, 90 deg from starboard.

    Parameters
    ----------
    time : float
        [s]
    body : Body
    sea : record
        Mean wind, gusts, areas A_F, A_L [m2] and length L_oa [m].
    table : ndarray (count, 3)
        CX, CY, CN over gamma_w from 0 to 2 pi.
    """
    u, v, _, _, _, psi = body
    factor = gust_factor(time, sea)
    north, east = sea.wind_north * factor, sea.wind_east * factor
    c, s = math.cos(psi), math.sin(psi)
    du, dv = u - (north * c + east * s), v - (east * c - north * s)
    gamma = math.atan2(dv, du)
    if gamma < 0.0:
        gamma += _TURN
    count = table.shape[0]
    i, w = cell(gamma, 0.0, _TURN / (count - 1), count)
    q = 0.5 * RHO_AIR * (du * du + dv * dv)
    X, Y = q * sea.A_F * linear(table, i, w, 0), q * sea.A_L * linear(table, i, w, 1)
    return Force(X, Y, q * sea.A_L * sea.L_oa * linear(table, i, w, 2))
