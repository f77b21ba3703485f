"""Propeller forces: open water behind the hull's wake, blended into the CFD surrogate with rudder.

The surrogate of Knight (2021), PhD thesis, University of Michigan, section 3.2, knows one rudder
angle (35 deg). Straight ahead the propeller is its open-water curve in the wake; between, the two
are blended with the square of the rudder angle (our choice, physics of neither source).
"""

from __future__ import annotations

import math

from ship_gym.physics._kernel import kernel
from ship_gym.physics.interpolate import bilinear, cell, linear

# Channels of ``Ship.surrogate`` (coefficients over the advance angle) and of ``Ship.open_water``.
C_T, C_Q, C_S, C_N, C_A, TRUST = range(6)
J_LIMIT = 10.0  # reported advance ratio of a stopped propeller instead of infinity


@kernel
def wake(flow, r, propeller):
    """Effective velocity ratio 1 - w_P while manoeuvring.

    YY15 if ``wake_C1 > 0``; otherwise ``w_P = w_P0 exp(-wake_beta2 beta_P^2)`` (Yoshimura et al.
    2013). beta_P = beta - x'_P r' (YY15); `flow` is (U [m/s], beta [rad]).
    """
    U, beta = flow
    beta_P = beta - propeller.x_P * r / U if U > 0.0 else 0.0
    if propeller.wake_C1 > 0.0:
        C2 = propeller.wake_C2_p if beta_P > 0.0 else propeller.wake_C2_n
        rise = (1.0 - math.exp(-propeller.wake_C1 * abs(beta_P))) * (C2 - 1.0)
        return (1.0 - propeller.w_P0) * (1.0 + rise)
    return 1.0 - propeller.w_P0 * math.exp(-propeller.wake_beta2 * beta_P * beta_P)


@kernel
def advance_pressure(u, n, propeller, rho):
    """Reference force 1/2 rho (u^2 + (0.7 pi n D)^2) pi D^2 / 4 [N] of the starred coefficients."""
    D = propeller.D
    w = 0.7 * math.pi * n * D
    return 0.125 * math.pi * rho * (u * u + w * w) * D * D


@kernel
def advance_angle(u, n, D):
    """Advance angle epsilon = atan2(u, 0.7 pi n D) [rad]; J = 0.7 pi tan(epsilon)."""
    return math.atan2(u, 0.7 * math.pi * n * D)


@kernel
def surrogate_cell(epsilon, beta, surrogate, table):
    """Cell of the surrogate's table at advance angle and drift, both [rad]."""
    i, w = cell(epsilon, surrogate.epsilon_start, surrogate.epsilon_step, table.shape[0])
    j, q = cell(beta, surrogate.beta_start, surrogate.beta_step, table.shape[1])
    return i, w, j, q


@kernel
def surrogate_blend(delta, surrogate):
    """Share of the deflected surrogate, (delta / trained angle)^2 up to 1, and the turn's side."""
    if surrogate.delta <= 0.0:
        return 0.0, 1.0
    s = delta / surrogate.delta
    return min(s * s, 1.0), (1.0 if delta >= 0.0 else -1.0)


@kernel
def outside_box(J, beta, box):
    """Distance of (J, beta) from the trained box as a fraction of its size, 0 inside."""
    dJ = max(box.J_min - J, J - box.J_max) / (box.J_max - box.J_min)
    dB = max(box.beta_min - beta, beta - box.beta_max) / (box.beta_max - box.beta_min)
    return max(0.0, dJ, dB)


@kernel
def advance_ratio(u, n, D):
    """J = u / (n D), limited to +-J_LIMIT."""
    if abs(u) >= J_LIMIT * n * D:
        return math.copysign(J_LIMIT, u) if u != 0.0 else 0.0
    return u / (n * D)


@kernel
def propeller_forces(motion, controls, flow, ship, tables):
    """Thrust, side force and torque of the propeller behind the hull.

    Parameters
    ----------
    motion : (float, float, float)
        u, v [m/s], r [rad/s] through the water.
    controls : (float, float)
        Rudder angle [rad], propeller speed [rev/s] >= 0.
    flow : (float, float)
        Speed U [m/s] and drift angle atan2(-v, abs(u)) [rad] at midship.
    ship : record
    tables : (ndarray, ndarray)
        Open-water table (count, 2) and surrogate table (count, count, 6) of this ship.

    Returns
    -------
    force : (float, float, float)
        X = (1 - t_P) T, Y [N] and N [N m].
    race : (float, float, float)
        Thrust T [N], velocity ratio 1 - w_P, torque Q [N m].
    local : (float, float)
        Advance angle epsilon of the ship's speed and drift beta_P at the propeller [rad].
    """
    u, v, r = motion
    n = controls[1]
    p, axis = ship.propeller, ship.open_water
    ratio = wake(flow, r, p)
    u_A = ratio * u
    water = tables[0]
    i, w = cell(advance_angle(u_A, n, p.D), axis.start, axis.step, water.shape[0])
    q = advance_pressure(u_A, n, p, ship.rho)
    T, Q, S = q * linear(water, i, w, C_T), q * p.D * linear(water, i, w, C_Q), 0.0
    epsilon = advance_angle(u, n, p.D)
    beta_P = math.atan2(-(v + p.x_P * r), u)
    blend, side = surrogate_blend(controls[0], ship.surrogate)
    if blend > 0.0:
        at = surrogate_cell(epsilon, side * beta_P, ship.surrogate, tables[1])
        q = advance_pressure(u, n, p, ship.rho)
        share = blend * bilinear(tables[1], at, TRUST)
        T += share * (q * bilinear(tables[1], at, C_T) - T)
        Q += share * (q * p.D * bilinear(tables[1], at, C_Q) - Q)
        S = -side * share * q * bilinear(tables[1], at, C_S)  # the source's side force is to port
    return ((1.0 - p.t_P) * T, S, p.x_P * S), (T, ratio, Q), (epsilon, beta_P)
