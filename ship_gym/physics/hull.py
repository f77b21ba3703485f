"""Hull forces: the MMG polynomial in its range, cross-flow drag outside it.

Yasukawa & Yoshimura (2015), J. Mar. Sci. Technol. 20:37-52 (YY15).
"""

from __future__ import annotations

import math

from ship_gym.physics._kernel import kernel
from ship_gym.physics.quantities import Force

# The cubic is fitted to drift angles and yaw rates of ordinary manoeuvres. It is used as published
# up to the first limit, left behind at the second, and blended between (our choice, not validated).
COS_DRIFT_FULL = math.cos(math.radians(30.0))
COS_DRIFT_NONE = math.cos(math.radians(60.0))
YAW_FULL = 1.2  # r' = r L / U
YAW_NONE = 2.4
STRIPS = 12  # of the cross-flow integral over the length
# A division costs as much as ten products, hence these and 1 / U below.
_STRIP = 1.0 / STRIPS
_PER_DRIFT = 1.0 / (COS_DRIFT_FULL - COS_DRIFT_NONE)
_PER_YAW = 1.0 / (YAW_NONE - YAW_FULL)


@kernel
def smoothstep(x):
    """0 for x <= 0, 1 for x >= 1, cubic with flat ends between."""
    x = min(max(x, 0.0), 1.0)
    return x * x * (3.0 - 2.0 * x)


@kernel
def polynomial_share(u, v, r, L):
    """Share of the MMG polynomial in [0, 1]: 1 in its range, 0 in large drift, spin or at rest."""
    U = math.sqrt(u * u + v * v)
    if U <= 0.0:
        return 0.0
    per_U = 1.0 / U
    drift = (COS_DRIFT_FULL - u * per_U) * _PER_DRIFT
    yaw = (abs(r) * L * per_U - YAW_FULL) * _PER_YAW
    return 1.0 - smoothstep(max(drift, yaw))


@kernel
def polynomial_forces(u, v, r, hull, rho):
    """X, Y, N of the MMG polynomial (YY15), U > 0."""
    U = math.sqrt(u * u + v * v)
    per_U = 1.0 / U
    v_ = v * per_U
    r_ = r * hull.L * per_U
    vv, vr, rr = v_ * v_, v_ * r_, r_ * r_
    X = -hull.R_0 + hull.X_vv * vv + hull.X_vr * vr + hull.X_rr * rr + hull.X_vvvv * vv * vv
    Y = hull.Y_v * v_ + hull.Y_r * r_ + hull.Y_vvv * vv * v_ + hull.Y_vvr * vv * r_
    Y += hull.Y_vrr * v_ * rr + hull.Y_rrr * rr * r_
    N = hull.N_v * v_ + hull.N_r * r_ + hull.N_vvv * vv * v_ + hull.N_vvr * vv * r_
    N += hull.N_vrr * v_ * rr + hull.N_rrr * rr * r_
    q = 0.5 * rho * hull.L * hull.d * U * U
    return q * X, q * Y, q * hull.L * N


@kernel
def crossflow_forces(u, v, r, hull, rho):
    """X, Y, N at large drift, in a spin and at rest: linear lift plus cross-flow drag.

    Sway and yaw: the linear derivatives with |u| where they damp (valid astern), u where they are
    of Munk's kind, and the drag of each strip, 1/2 rho C_D d |v + x r| (v + x r). Surge: resistance
    against the motion. Estimated; its purpose is that a drifting or stopping ship loses energy.
    """
    L, a = hull.L, abs(u)
    Y = 0.5 * rho * L * hull.d * (hull.Y_v * a * v + hull.Y_r * u * r * L)
    N = 0.5 * rho * L * L * hull.d * (hull.N_v * u * v + hull.N_r * a * r * L)
    dx, force, moment = L * _STRIP, 0.0, 0.0
    for i in range(STRIPS // 2):  # a strip before midship with the one as far behind it
        x = (i + 0.5) * dx
        fore, aft = v + x * r, v - x * r
        fore, aft = abs(fore) * fore, abs(aft) * aft
        force, moment = force + (fore + aft), moment + x * (fore - aft)
    drag = -0.5 * rho * hull.C_D * hull.d * dx
    Y, N = Y + drag * force, N + drag * moment
    return -0.5 * rho * L * hull.d * hull.R_0 * u * a, Y, N


@kernel
def hull_forces(u, v, r, hull, rho):
    """Hull forces on the bare hull, finite for every state.

    Parameters
    ----------
    u, v, r : float
        Surge, sway [m/s] and yaw rate [rad/s] through the water, at midship.
    hull : record
        ``ship_gym.ships.particulars.Hull``.
    rho : float
        Water density [kg/m3].

    Returns
    -------
    Force
    """
    share = polynomial_share(u, v, r, hull.L)
    if share >= 1.0:
        X, Y, N = polynomial_forces(u, v, r, hull, rho)
        return Force(X, Y, N)
    X, Y, N = crossflow_forces(u, v, r, hull, rho)
    if share <= 0.0:
        return Force(X, Y, N)
    X_p, Y_p, N_p = polynomial_forces(u, v, r, hull, rho)
    return Force(X + share * (X_p - X), Y + share * (Y_p - Y), N + share * (N_p - N))
