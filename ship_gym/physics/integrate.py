"""Classical Runge-Kutta step of one ship."""

from __future__ import annotations

import math

from ship_gym.physics._kernel import kernel
from ship_gym.physics.actuators import engine_after, governed_command, rudder_after
from ship_gym.physics.dynamics import accelerations, forces, total, water_velocity


@kernel
def derivative(body, controls, load, ship, sea, tables):
    """Time derivative of (u, v, r, x, y, psi), the ship's own forces, and the flow.

    `load` is the sum of what is held during this step, X, Y [N] and N [N m]. A uniform current
    enters by relative velocity; its rotation in body axes gives back the acceleration over ground.
    """
    u, v, r, _, _, psi = body
    u_c, v_c = water_velocity(psi, sea)
    motion = (u - u_c, v - v_c, r)
    own, flow = forces(motion, controls, ship, tables)
    X, Y, N = total(own)
    du, dv, dr = accelerations(motion, X + load[0], Y + load[1], N + load[2], ship.inertia)
    c, s = math.cos(psi), math.sin(psi)
    rates = (du + r * v_c, dv - r * u_c, dr, u * c - v * s, u * s + v * c, r)
    return rates, own, flow


@kernel
def advanced(body, rates, h):
    """Body state moved by h times its rates (an Euler stage)."""
    return (
        body[0] + h * rates[0],
        body[1] + h * rates[1],
        body[2] + h * rates[2],
        body[3] + h * rates[3],
        body[4] + h * rates[4],
        body[5] + h * rates[5],
    )


@kernel
def runge_kutta_4(state, command, load, dt, ship, sea, tables):
    """State after `dt` [s], and the ship's own forces and flow at its start.

    Parameters
    ----------
    state : tuple of 8 floats
        In the order of ``conventions.STATE_NAMES``.
    command : (float, float)
        Rudder [rad] and propeller speed [rev/s] commands, held during the step.
    """
    body, delta, n = state[:6], state[6], state[7]
    k1, own, flow = derivative(body, (delta, n), load, ship, sea, tables)
    target = governed_command(n, command[1], flow[4], ship.engine)
    h = 0.5 * dt
    middle = rudder_after(delta, command[0], h, ship.gear), engine_after(n, target, h, ship.engine)
    end = rudder_after(delta, command[0], dt, ship.gear), engine_after(n, target, dt, ship.engine)
    k2, _, _ = derivative(advanced(body, k1, h), middle, load, ship, sea, tables)
    k3, _, _ = derivative(advanced(body, k2, h), middle, load, ship, sea, tables)
    k4, _, _ = derivative(advanced(body, k3, dt), end, load, ship, sea, tables)
    w = dt / 6.0
    new = (
        body[0] + w * (k1[0] + 2.0 * (k2[0] + k3[0]) + k4[0]),
        body[1] + w * (k1[1] + 2.0 * (k2[1] + k3[1]) + k4[1]),
        body[2] + w * (k1[2] + 2.0 * (k2[2] + k3[2]) + k4[2]),
        body[3] + w * (k1[3] + 2.0 * (k2[3] + k3[3]) + k4[3]),
        body[4] + w * (k1[4] + 2.0 * (k2[4] + k3[4]) + k4[4]),
        body[5] + w * (k1[5] + 2.0 * (k2[5] + k3[5]) + k4[5]),
        end[0],
        end[1],
    )
    return new, own, flow
