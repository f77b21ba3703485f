"""Rudder forces: effective inflow at every angle, anchored to the CFD samples at the trained one.

Law: Yasukawa & Yoshimura (2015) (YY15). Samples: Knight (2021), rudder at 35 deg.
"""

from __future__ import annotations

import math

from ship_gym.physics._kernel import kernel
from ship_gym.physics.propeller import (
    C_FX,
    C_FY,
    TRUST,
    advance_angle,
    outside_box,
    surrogate_blend,
    surrogate_cell,
)
from ship_gym.physics.interpolate import bilinear

STALL = math.radians(35.0)  # the samples follow sin(alpha) to 33 deg, their largest inflow angle
SIN_STALL = math.sin(STALL)
C_N_PLATE = 1.17  # flat plate across the flow, Hoerner (1965) Fluid-Dynamic Drag, ch. 3


@kernel
def race_speed_squared(u, thrust, D, rho):
    """Axial speed squared [m2/s2] in the propeller race, u^2 + 8 T / (rho pi D^2), never negative.

    Momentum theory; Knight (2021) Eq. 2.20 with the square root that its print lacks, in terms of T
    so that no division by J is needed.
    """
    return max(u * abs(u) + 8.0 * thrust / (rho * math.pi * D * D), 0.0)


@kernel
def axial_inflow(u, race, ship):
    """u_R [m/s] at the rudder, YY15; astern only the race counts (not validated there)."""
    thrust, ratio, _ = race
    k = ship.rudder
    u_A = max(ratio * u, 0.0)
    u_s = math.sqrt(race_speed_squared(u_A, thrust, ship.propeller.D, ship.rho))
    u_in = u_A + k.kappa * (u_s - u_A)
    return k.epsilon * math.sqrt(k.eta * u_in * u_in + (1.0 - k.eta) * u_A * u_A)


@kernel
def lateral_inflow(u, v, r, rudder):
    """Sway velocity at the rudder before straightening, U beta - l_R r [m/s] (YY15)."""
    U = math.sqrt(u * u + v * v)
    return U * math.atan2(-v, u) - rudder.l_R * r


@kernel
def straightening(v_geometric, side, rudder):
    """gamma_R for this side of the inflow; `side` = -1 mirrors the ship."""
    return rudder.gamma_R_p if side * v_geometric > 0.0 else rudder.gamma_R_n


@kernel
def normal_force(delta, u_R, v_R, rudder, rho):
    """F_N [N] = 1/2 rho A_R f_alpha U_R^2 sin(alpha_R), alpha_R = delta - atan2(v_R, u_R) (YY15).

    Beyond 35 deg of inflow angle the coefficient falls linearly to that of a plate across the flow
    at 90 deg (estimated: the samples end at 33 deg).
    """
    alpha = delta - math.atan2(v_R, u_R)
    a = abs(alpha)
    if a <= STALL:
        s = math.sin(alpha)
    else:
        plate = C_N_PLATE / rudder.f_alpha
        s = SIN_STALL + (plate - SIN_STALL) * min((a - STALL) / (0.5 * math.pi - STALL), 1.0)
        s = math.copysign(s, alpha)
    return 0.5 * rho * rudder.A_R * rudder.f_alpha * (u_R * u_R + v_R * v_R) * s


@kernel
def rudder_on_plate(motion, controls, race, ship, table):
    """Normal force F_N and chordwise force F_T on the rudder alone [N], beta_R, outside.

    F_N is the effective-inflow law at this angle, plus a share (delta / trained angle)^2 of what the
    CFD surrogate gives beyond that law at the trained angle. So the trained angle gives the
    surrogate back exactly, and near amidships the law is left alone.
    """
    u, v, r = motion
    delta, n = controls
    k = ship.rudder
    u_R = axial_inflow(u, race, ship)
    v_g = lateral_inflow(u, v, r, k)
    F_N = normal_force(delta, u_R, straightening(v_g, 1.0, k) * v_g, k, ship.rho)
    v_local = v + k.x_R * r
    beta_R = math.atan2(-v_local, u)
    blend, side = surrogate_blend(delta, ship.surrogate)
    if blend <= 0.0:
        return F_N, 0.0, beta_R, 0.0
    trained = ship.surrogate.delta
    law = normal_force(side * trained, u_R, straightening(v_g, side, k) * v_g, k, ship.rho)
    at = surrogate_cell(advance_angle(u, n, ship.propeller.D), side * beta_R, ship.surrogate, table)
    q = race_speed_squared(u, race[0], ship.propeller.D, ship.rho) + v_local * v_local
    q *= 0.5 * ship.rho * ship.surrogate.S_R
    share = blend * bilinear(table, at, TRUST)
    F_x, F_y = q * bilinear(table, at, C_FX), q * bilinear(table, at, C_FY)  # F_y to port
    c, s = math.cos(trained), math.sin(trained)
    F_N += share * (side * (F_y * c - F_x * s) - law)
    return F_N, share * (F_x * c + F_y * s), beta_R, outside_box(u, n, side * beta_R, ship)


@kernel
def rudder_forces(motion, controls, race, ship, table):
    """Rudder and hull-rudder interaction forces.

    Parameters
    ----------
    motion, controls, ship
        As in `propeller_forces`.
    race : (float, float, float)
        Thrust [N], 1 - w_P, torque [N m] from `propeller_forces`.
    table : ndarray
        Surrogate table (count, count, 6).

    Returns
    -------
    force : (float, float, float)
        X_R = (1 - t_R) F_x, Y_R = (1 + a_H) F_y, N_R = (x_R + a_H x_H) F_y (YY15).
    F_N, beta_R, outside : float
        Normal force [N], local drift at the rudder [rad], distance outside the trained box.
    """
    delta = controls[0]
    k = ship.rudder
    F_N, F_T, beta_R, outside = rudder_on_plate(motion, controls, race, ship, table)
    c, s = math.cos(delta), math.sin(delta)
    F_x = -F_N * s + F_T * c
    F_y = -(F_N * c + F_T * s)
    N = (k.x_R + k.a_H * k.x_H) * F_y
    return ((1.0 - k.t_R) * F_x, (1.0 + k.a_H) * F_y, N), F_N, beta_R, outside
