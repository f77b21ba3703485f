"""Rudder forces: effective inflow at every angle, anchored to the CFD samples at the trained one.

Law: Yasukawa & Yoshimura (2015) (YY15), with the constants of the ship's captive tests; of a ship
without any, fitted to the samples (``loader.attach_surrogate``). Samples: Knight (2021), rudder at
35 deg.
"""

from __future__ import annotations

import math

from ship_gym.physics._kernel import kernel
from ship_gym.physics.angles import arctan2, cos_sin
from ship_gym.physics.propeller import (
    C_A,
    C_N,
    sampled,
    surrogate_blend,
    surrogate_cell,
    surrogate_plane,
    surrogate_unit,
    trained_direction,
    trusted,
)
from ship_gym.physics.quantities import Force

STALL = math.radians(35.0)  # the samples follow sin(alpha) to 33 deg, their largest inflow angle
SIN_STALL = math.sin(STALL)
COS_STALL = math.cos(STALL)
_STALL_WIDTH = 0.5 * math.pi - STALL
_PER_STALL = 1.0 / _STALL_WIDTH
C_N_PLATE = 1.17  # flat plate across the flow, Hoerner (1965) Fluid-Dynamic Drag, ch. 3
# Beaufoy's formula as Stern et al. (2021) print it: 58.8 kgf s2/m4, and the race of a single screw
BEAUFOY = 58.8 * 9.80665  # kg/m3
BEAUFOY_RACE = 1.15
# Share of the far race's velocity that a reversed propeller draws past the rudder: the suction of
# an actuator disc one radius before it, (1 - 1 / sqrt(2)) / 2, by the vortex cylinder. Estimated:
# no test of these ships with a reversed propeller is at hand.
KAPPA_ASTERN = 0.5 * (1.0 - math.sqrt(0.5))


@kernel
def race_square(u, thrust, D, rho):
    """Axial speed squared [m2/s2] in the propeller race, u^2 + 8 T / (rho pi D^2), with its sign.

    Momentum theory; Knight (2021) Eq. 2.20 with the square root that its print lacks, in terms of T
    so that no division by J is needed.
    """
    return u * abs(u) + thrust * (8.0 / (rho * math.pi * D * D))


@kernel
def race_speed_squared(u, thrust, D, rho):
    """`race_square`, but zero where a braking propeller has stopped its race."""
    return max(race_square(u, thrust, D, rho), 0.0)


@kernel
def race_inflow(u_A, thrust, k, D, rho):
    """Axial velocity [m/s] in the propeller's stream at the rudder, positive towards the stern.

    Thrust ahead: YY15, u_A + kappa (u_s - u_A). A propeller that brakes slows that race; once it
    has stopped it, and going astern, it draws water past the rudder the other way, of which
    `KAPPA_ASTERN` arrives there (estimated).
    """
    square = race_square(u_A, thrust, D, rho)
    u_s = math.copysign(math.sqrt(abs(square)), square)
    if thrust > 0.0 or square >= 0.0:
        return u_A + k.kappa * (u_s - u_A)
    if u_A > 0.0:
        return u_A - k.kappa * u_A + KAPPA_ASTERN * u_s
    return u_A + KAPPA_ASTERN * (u_s - u_A)


@kernel
def axial_inflow(u, race, ship):
    """u_R [m/s] at the rudder, YY15; negative where the flow comes from astern (estimated there).

    u_R^2 = epsilon^2 (eta u_in^2 + (1 - eta) u_A^2), each square with the sign of its velocity.
    """
    thrust, ratio, _ = race
    k = ship.rudder
    u_A = ratio * u
    u_in = race_inflow(u_A, thrust, k, ship.propeller.D, ship.rho)
    if u_A >= 0.0 and u_in >= 0.0:
        return k.epsilon * math.sqrt(k.eta * u_in * u_in + (1.0 - k.eta) * u_A * u_A)
    square = k.eta * u_in * abs(u_in) + (1.0 - k.eta) * u_A * abs(u_A)
    return k.epsilon * math.copysign(math.sqrt(abs(square)), square)


@kernel
def lateral_inflow(inflow, r, rudder):
    """Sway velocity at the rudder before straightening, U beta - l_R r [m/s] (YY15)."""
    U, beta = inflow
    return U * beta - rudder.l_R * r


@kernel
def straightening(v_geometric, U, side, rudder):
    """gamma_R at this inflow; `side` = -1 mirrors the ship.

    Each side's own from ``gamma_R_over`` of inflow angle on; between, a cubic through their mean.
    So a small motion to either side is answered alike (our choice: YY15 jumps at zero).
    """
    v = side * v_geometric
    within = rudder.gamma_R_over * U
    if v >= within:
        return rudder.gamma_R_p
    if v <= -within:
        return rudder.gamma_R_n
    t = v / within
    mean = 0.5 * (rudder.gamma_R_p + rudder.gamma_R_n)
    return mean + 0.25 * (rudder.gamma_R_p - rudder.gamma_R_n) * t * (3.0 - t * t)


@kernel
def cross_inflow(v_geometric, U, u_R, side, rudder):
    """v_R [m/s] at the rudder: straightened, and the race's swirl that a neutral angle cancels."""
    gamma_R = straightening(v_geometric, U, side, rudder)
    return gamma_R * v_geometric + side * rudder.neutral * u_R


@kernel
def cubic_inflow(motion, U, ship):
    """Further v_R [m/s] of Son & Nomoto (1982), cubic in r' and v'; r' up to 1, their turns' range.

    They print v_R' = g_a v' + c_Rr r' + c_Rrrr r'^3 + c_Rrrv r'^2 v', of the other sign than v_R.
    """
    _, v, r = motion
    k = ship.rudder
    if U <= 0.0 or (k.v_rrr == 0.0 and k.v_rrv == 0.0):
        return 0.0
    r_ = max(min(r * ship.hull.L / U, 1.0), -1.0)
    return -r_ * r_ * (k.v_rrr * r_ * U + k.v_rrv * v)


@kernel
def stalled(alpha, f_alpha):
    """Beyond 35 deg of inflow angle, what replaces sin(alpha_R): no kink, a plate at 90 deg.

    Cubic Hermite polynomial from the sine's value and slope to the plate's value, level there.
    """
    t = min((abs(alpha) - STALL) * _PER_STALL, 1.0)
    rest = 1.0 - t
    start = rest * rest * ((1.0 + 2.0 * t) * SIN_STALL + t * _STALL_WIDTH * COS_STALL)
    end = t * t * (3.0 - 2.0 * t) * (C_N_PLATE / f_alpha)
    return math.copysign(start + end, alpha)


@kernel
def normal_force(direction, u_R, v_R, rudder, rho):
    """F_N [N] = 1/2 rho A_R f_alpha U_R^2 sin(alpha_R), alpha_R = delta - atan2(v_R, u_R) (YY15).

    Parameters
    ----------
    direction : (float, float)
        sin and cos of the rudder angle: U_R sin(alpha_R) is a component of the inflow, so the
        angle itself is needed in stall only (estimated: the samples end at 33 deg).
    u_R, v_R : float
        Inflow along and across the ship [m/s].
    """
    s, c = direction
    across, along = u_R * s - v_R * c, u_R * c + v_R * s
    U_R = math.sqrt(u_R * u_R + v_R * v_R)
    along = abs(along)  # from astern the blade works like from ahead (estimated)
    if along < COS_STALL * U_R:
        across = U_R * stalled(arctan2(across, along), rudder.f_alpha)
    return 0.5 * rho * rudder.A_R * rudder.f_alpha * U_R * across


@kernel
def beaufoy(U, sin_delta, A_R):
    """F_N [N] = 58.8 g A_R (1.15 U)^2 sin(delta), Beaufoy's formula in Stern et al. (2021).

    For a single screw and rudder in sea water; U [m/s] is the ship's speed: drift, yaw and
    propeller load do not enter, so it is a formula to compare with, not to steer by.
    """
    U_R = BEAUFOY_RACE * U
    return BEAUFOY * A_R * U_R * U_R * sin_delta


@kernel
def rudder_on_plate(motion, delta, inflow, wash, ship, tables):
    """Normal force F_N and chordwise force F_A on the rudder alone [N], and beta_R.

    F_N is the effective-inflow law at this angle, plus a share (delta / trained angle)^2 of what
    the CFD surrogate gives beyond that law at the trained angle. So the trained angle gives the
    surrogate back exactly (a single one to port: mirrored, plus what the law's two gamma_R and its
    neutral angle make of it; two have a table for each side), and near amidships the law is left
    alone.
    """
    race, epsilon, direction = wash
    u, v, r = motion
    k, box = ship.rudder, ship.surrogate
    u = u - k.y_R * r + 0.0  # never -0, as in `propeller_forces`
    v_local = v + k.x_R * r
    beta_R = arctan2(-v_local, u)
    U, _ = inflow
    if k.beaufoy > 0.0:
        return beaufoy(U, direction[0], k.A_R), 0.0, beta_R
    u_R = axial_inflow(u, race, ship)
    v_g = lateral_inflow(inflow, r, k)
    v_3 = cubic_inflow(motion, U, ship)
    v_R = cross_inflow(v_g, U, u_R, 1.0, k) + v_3
    F_N = normal_force(direction, u_R, v_R, k, ship.rho)
    blend, side = surrogate_blend(delta, box)
    doubt = box.z_N * box.law_std  # a draw moves the law too, by what such a law misses samples
    if blend <= 0.0:
        return F_N * (1.0 + doubt), 0.0, beta_R
    table = tables.deflected[surrogate_unit(side)]
    plane = surrogate_plane(delta, box, table)
    trained = trained_direction(delta, side, box, table)
    mirror = 1.0 if k.y_R > 0.0 else side
    v_R = cross_inflow(v_g, U, u_R, mirror, k) + v_3
    law = normal_force(trained, u_R, v_R, k, ship.rho)
    at = surrogate_cell(epsilon, side * beta_R, box, table)
    q = race_speed_squared(u, race.thrust, ship.propeller.D, ship.rho) + v_local * v_local
    q *= 0.5 * ship.rho * box.S_R
    share = blend * trusted(table, at)
    F_N *= 1.0 + doubt * (1.0 - share)
    F_N += share * (side * q * sampled(table, at, plane, C_N, box.z_N) - law)
    return F_N, share * q * sampled(table, at, plane, C_A, box.z_A), beta_R


@kernel
def rudder_forces(motion, controls, inflow, race, epsilon, ship, tables):
    """Rudder and hull-rudder interaction forces, of two rudders the starboard one's.

    Parameters
    ----------
    motion, controls, inflow, ship, tables
        As in `propeller_forces`.
    race : Race
        From `propeller_forces`.
    epsilon : float
        Advance angle [rad] from `propeller_forces`.

    Returns
    -------
    force : Force
        X_R = (1 - t_R) F_x, Y_R = (1 + a_H) F_y, N_R = (x_R + a_H x_H) F_y (YY15), of two rudders
        - y_R X_R in addition.
    F_N, beta_R : float
        Normal force [N], local drift at the rudder [rad].
    """
    k = ship.rudder
    delta, _ = controls
    c, s = cos_sin(delta)
    wash = (race, epsilon, (s, c))
    F_N, F_A, beta_R = rudder_on_plate(motion, delta, inflow, wash, ship, tables)
    X = (1.0 - k.t_R) * (-F_N * s + F_A * c)
    F_y = -(F_N * c + F_A * s)
    N = (k.x_R + k.a_H * k.x_H) * F_y - k.y_R * X
    return Force(X, (1.0 + k.a_H) * F_y, N), F_N, beta_R
