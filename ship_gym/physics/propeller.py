"""Propeller forces: open water behind the hull's wake, blended into the CFD surrogate with rudder.

The surrogate of Knight (2021), PhD thesis, University of Michigan, section 3.2, knows one rudder
angle (35 deg). Straight ahead the propeller is its open-water curve in the wake; between, the two
are blended with the square of the rudder angle (our choice, physics of neither source). Where that
curve is measured, the surrogate has been shifted to it (``records.anchored``), so the blend alone
takes no thrust away. A user's surrogate may know several angles: between them its coefficients are
linear in the angle.

Open water holds for all four quadrants, the surrogate ahead only (its table ends at J > 0).
Assumed, measured for none of these ships: going astern the propeller meets undisturbed water (no
wake), braking (n < 0 < u) or idling it meets the wake of the ship ahead; the thrust deduction is
t_P throughout; a reversed propeller has no side force of its own (the paddle-wheel effect).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ship_gym.physics._kernel import kernel
from ship_gym.physics.angles import arctan2, cos_sin, exp_negative, sine
from ship_gym.physics.interpolate import bilinear, cell, linear
from ship_gym.physics.quantities import Force

# Channels of ``Ship.surrogate`` (coefficients over the advance angle) and of ``Ship.open_water``;
# the standard deviation of channel k < TRUST is channel STD + k.
C_T, C_Q, C_S, C_N, C_A, TRUST, STD = range(7)
SWAY_LIMIT = 0.3  # (v_P / U)^2 of a 35 deg turn of the S-175, the range of its wake law
J_LIMIT = 10.0  # reported advance ratio of a stopped propeller instead of infinity


class Inflow(NamedTuple):
    """Speed U [m/s] and drift angle [rad] at midship."""

    U: float
    beta: float


class Race(NamedTuple):
    """What a propeller sends to its rudder: thrust [N], 1 - w_P, torque [N m]."""

    thrust: float
    ratio: float
    torque: float


@kernel
def wake(inflow, r, propeller):
    """Effective velocity ratio 1 - w_P while manoeuvring; `inflow` is an `Inflow`.

    Four laws, by the ship file:

    - ``wake_l_P < 0``: ``w_P0 [1 - (1 - cos^2 beta_P) (1 - |beta_P|)]`` with its own lever of the
      yaw rate (KCS hull set B); beyond 1 rad of beta_P, where it is back at w_P0, it stays there;
    - ``wake_C1 > 0``: YY15;
    - ``wake_tau > 0``: ``w_P0 - wake_tau (v_P / U)^2`` (Son & Nomoto 1982), the square up to 0.3;
    - else ``w_P0 exp(-wake_beta2 beta_P^2)`` (Yoshimura et al. 2013).

    beta_P = beta - x'_P r' (YY15); v_P is the sway velocity at x_P.
    """
    U, beta = inflow
    if propeller.wake_l_P < 0.0:
        beta_P = abs(beta - propeller.wake_l_P * r * (1.0 / U)) if U > 0.0 else 0.0
        s = sine(beta_P)
        return 1.0 - propeller.w_P0 * (1.0 - s * s * max(1.0 - beta_P, 0.0))
    beta_P = beta - propeller.x_P * r * (1.0 / U) if U > 0.0 else 0.0
    if propeller.wake_C1 > 0.0:
        C2 = propeller.wake_C2_p if beta_P > 0.0 else propeller.wake_C2_n
        rise = (1.0 - exp_negative(-propeller.wake_C1 * abs(beta_P))) * (C2 - 1.0)
        return (1.0 - propeller.w_P0) * (1.0 + rise)
    if propeller.wake_tau > 0.0:
        v_P = sine(beta) - beta + beta_P
        return 1.0 - propeller.w_P0 + propeller.wake_tau * min(v_P * v_P, SWAY_LIMIT)
    return 1.0 - propeller.w_P0 * exp_negative(-propeller.wake_beta2 * beta_P * beta_P)


@kernel
def advance_pressure(u, n, propeller, rho):
    """Reference force 1/2 rho (u^2 + (0.7 pi n D)^2) pi D^2 / 4 [N] of the starred coefficients."""
    D = propeller.D
    w = 0.7 * math.pi * n * D
    return 0.125 * math.pi * rho * (u * u + w * w) * D * D


@kernel
def advance_angle(u, n, D):
    """Advance angle epsilon = atan2(u, 0.7 pi n D) [rad]; J = 0.7 pi tan(epsilon).

    Ahead 0 to pi/2, braking (n < 0) pi/2 to pi, astern -pi to -pi/2, n ahead of a ship that makes
    sternway -pi/2 to 0.
    """
    return arctan2(u, 0.7 * math.pi * n * D)


@kernel
def surrogate_plane(delta, surrogate, table):
    """Plane of the trained rudder angle at or below one [rad], and the weight of the next.

    A table (count, count, channels) knows one angle, (planes, count, count, channels) several;
    numba compiles each case by itself (``ndim`` is a constant to it), so one costs nothing more.
    """
    if table.ndim == 3:
        return 0, 0.0
    return cell(abs(delta), surrogate.delta, surrogate.delta_step, table.shape[0])


@kernel
def surrogate_cell(epsilon, beta, surrogate, table):
    """Cell of the surrogate's table at advance angle and drift, both [rad]."""
    axis = table.ndim - 3  # counted from the front: numba's simulator of a card asks for that
    i, w = cell(epsilon, surrogate.epsilon_start, surrogate.epsilon_step, table.shape[axis])
    j, q = cell(beta, surrogate.beta_start, surrogate.beta_step, table.shape[axis + 1])
    return i, w, j, q


@kernel
def of_plane(table, at, channel, z):
    """Value of a channel at one trained rudder angle, moved by z of its standard deviations."""
    value = bilinear(table, at, channel)
    return value + z * bilinear(table, at, STD + channel) if z != 0.0 else value


@kernel
def sampled(table, at, plane, channel, z):
    """Value of a surrogate's channel, moved by z; linear between two trained rudder angles."""
    if table.ndim == 3:
        return of_plane(table, at, channel, z)
    k, weight = plane
    low = of_plane(table[k], at, channel, z)
    return low + weight * (of_plane(table[k + 1], at, channel, z) - low)


@kernel
def trusted(table, at):
    """Share in which the surrogate is trusted, the same at all trained rudder angles."""
    if table.ndim == 3:
        return bilinear(table, at, TRUST)
    return bilinear(table[0], at, TRUST)


@kernel
def trained_direction(delta, side, surrogate, table):
    """Sine and cosine of the rudder angle nearest to `delta` at which the surrogate is trained."""
    if table.ndim == 3:
        return side * surrogate.sin_delta, surrogate.cos_delta
    largest = surrogate.delta + (table.shape[0] - 1) * surrogate.delta_step
    angle = min(max(abs(delta), surrogate.delta), largest)
    c, s = cos_sin(angle)
    return side * s, c


@kernel
def surrogate_unit(side):
    """Which of the surrogate's tables: that of the leeward (starboard turn) or windward unit."""
    return 0 if side > 0.0 else 1


@kernel
def surrogate_blend(delta, surrogate):
    """Share of the deflected surrogate, (delta / trained angle)^2 up to 1, and the turn's side.

    Of several trained angles the smallest; from there on the surrogate knows the rudder angle.
    """
    if surrogate.delta <= 0.0:
        return 0.0, 1.0
    s = delta * (1.0 / surrogate.delta)
    return min(s * s, 1.0), (1.0 if delta >= 0.0 else -1.0)


@kernel
def outside_box(J, beta, box):
    """Distance of (J, beta) from the trained box as a fraction of its size, 0 inside.

    Drift is a direction, so its distance goes the shorter way round: astern is one place.
    """
    turn = 2.0 * math.pi
    below, above = box.beta_min - beta, beta - box.beta_max
    dB = below if below > 0.0 else above
    dB = min(dB, turn - (box.beta_max - box.beta_min) - dB)
    dJ = max(box.J_min - J, J - box.J_max)
    return max(0.0, dJ / (box.J_max - box.J_min), dB / (box.beta_max - box.beta_min))


@kernel
def advance_ratio(u, n, D):
    """J = u / (n D), limited to +-J_LIMIT; negative where ship and propeller go opposite ways."""
    if abs(u) >= J_LIMIT * abs(n) * D:
        if u == 0.0:
            return 0.0
        return math.copysign(J_LIMIT, u if n >= 0.0 else -u)
    return u / (n * D)


@kernel
def propeller_forces(motion, controls, inflow, ship, tables):
    """Thrust, side force and torque of the propeller, of two the starboard one.

    Parameters
    ----------
    motion : Motion
        Through the water.
    controls : Controls
        Propeller speed of either sign.
    inflow : Inflow
        Drift angle atan2(-v, abs(u)).
    ship : record
    tables : Tables

    Returns
    -------
    force : Force
        With X = (1 - t_P) T.
    race : Race
    local : (float, float)
        Advance angle epsilon of the ship's speed and drift beta_P at the propeller [rad].
    """
    u, v, r = motion
    delta, n = controls
    p, axis, box = ship.propeller, ship.open_water, ship.surrogate
    u = u - p.y_P * r + 0.0  # never -0, whose drift angle would be 180 deg
    ratio = wake(inflow, r, p) if u > 0.0 else 1.0
    u_A = ratio * u
    water = tables.open_water
    i, w = cell(advance_angle(u_A, n, p.D), axis.start, axis.step, water.shape[0])
    q = advance_pressure(u_A, n, p, ship.rho)
    T, Q, S = q * linear(water, i, w, C_T), q * p.D * linear(water, i, w, C_Q), 0.0
    epsilon = advance_angle(u, n, p.D)
    beta_P = arctan2(-(v + p.x_P * r), u)
    blend, side = surrogate_blend(delta, box)
    if blend > 0.0:
        table = tables.deflected[surrogate_unit(side)]
        plane = surrogate_plane(delta, box, table)
        at = surrogate_cell(epsilon, side * beta_P, box, table)
        q = advance_pressure(u, n, p, ship.rho)
        share = blend * trusted(table, at)
        T += share * (q * sampled(table, at, plane, C_T, box.z_T) - T)
        Q += share * (q * p.D * sampled(table, at, plane, C_Q, box.z_Q) - Q)
        # the table's side force is to port
        S = -side * share * q * sampled(table, at, plane, C_S, box.z_S)
    X = (1.0 - p.t_P) * T
    force = Force(X, S, p.x_P * S - p.y_P * X)
    return force, Race(T, ratio, Q), (epsilon, beta_P)


@kernel
def shaft_power(n, torque):
    """Delivered power [W] = 2 pi n Q of rev/s and N m, numbers or arrays of one shape.

    Negative where the water drives the propeller.
    """
    return 2.0 * math.pi * n * torque
