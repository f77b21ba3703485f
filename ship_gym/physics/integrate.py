"""Classical Runge-Kutta step of one ship."""

from __future__ import annotations

import math

from ship_gym.physics._kernel import kernel
from ship_gym.physics.actuators import engine_after, rudder_after
from ship_gym.physics.dynamics import accelerations, own_forces, total, water_velocity
from ship_gym.physics.quantities import Body, Controls, Motion, State


@kernel
def derivative(body, controls, load, ship, sea, tables):
    """Rates of the body, the ship's own forces, and how its units are loaded.

    `load` is the sum of what is held during this step, a Force. A uniform current enters by
    relative velocity; its rotation in body axes gives back the acceleration over ground.
    """
    u, v, r, _, _, psi = body
    u_c, v_c = water_velocity(psi, sea)
    motion = Motion(u - u_c, v - v_c, r)
    own, units = own_forces(motion, controls, ship, tables)
    F = total(own)
    du, dv, dr = accelerations(motion, F.X + load.X, F.Y + load.Y, F.N + load.N, ship.inertia)
    c, s = math.cos(psi), math.sin(psi)
    rates = Body(du + r * v_c, dv - r * u_c, dr, u * c - v * s, u * s + v * c, r)
    return rates, own, units


@kernel
def advanced(body, rates, h):
    """Body moved by h times its rates (an Euler stage)."""
    return Body(
        u=body.u + h * rates.u,
        v=body.v + h * rates.v,
        r=body.r + h * rates.r,
        x=body.x + h * rates.x,
        y=body.y + h * rates.y,
        psi=body.psi + h * rates.psi,
    )


@kernel
def simpson(a, b, c, d):
    """Sum of the four rates of a Runge-Kutta step by their weights."""
    return a + 2.0 * (b + c) + d


@kernel
def body_of(state):
    """The body in a state."""
    return Body(state.u, state.v, state.r, state.x, state.y, state.psi)


@kernel
def runge_kutta_4(state, command, load, dt, ship, sea, tables):
    """State after `dt` [s], and the ship's own forces and the loading of its units at its start.

    Parameters
    ----------
    state : State
    command : Controls
        Held during the step.
    load : Force
        Held during the step.
    """
    body, delta, n = body_of(state), state.delta, state.n
    k1, own, units = derivative(body, Controls(delta, n), load, ship, sea, tables)
    torque = units.starboard.torque + units.port.torque
    torque = 0.5 * torque if ship.propeller.y_P > 0.0 else torque  # of each shaft
    h, gear, engine = 0.5 * dt, ship.gear, ship.engine
    middle = Controls(
        rudder_after(delta, command.delta, h, gear), engine_after(n, command.n, torque, h, engine)
    )
    end = Controls(
        rudder_after(delta, command.delta, dt, gear),
        engine_after(n, command.n, torque, dt, engine),
    )
    k2, _, _ = derivative(advanced(body, k1, h), middle, load, ship, sea, tables)
    k3, _, _ = derivative(advanced(body, k2, h), middle, load, ship, sea, tables)
    k4, _, _ = derivative(advanced(body, k3, dt), end, load, ship, sea, tables)
    w = dt / 6.0
    new = State(
        u=body.u + w * simpson(k1.u, k2.u, k3.u, k4.u),
        v=body.v + w * simpson(k1.v, k2.v, k3.v, k4.v),
        r=body.r + w * simpson(k1.r, k2.r, k3.r, k4.r),
        x=body.x + w * simpson(k1.x, k2.x, k3.x, k4.x),
        y=body.y + w * simpson(k1.y, k2.y, k3.y, k4.y),
        psi=body.psi + w * simpson(k1.psi, k2.psi, k3.psi, k4.psi),
        delta=end.delta,
        n=end.n,
    )
    return new, own, units
