"""Kutta's step of third order (1901) for the ships in a scratch, every one at once.

A fourth stage would win nothing: what is left of the error are kinks, at the end of a rudder's run
and in piecewise linear tables (docs/accuracy.md).
"""

from __future__ import annotations

from typing import NamedTuple

from ship_gym.physics._kernel import kernel
from ship_gym.physics.actuators import engine_after, rudder_after
from ship_gym.physics.angles import cos_sin
from ship_gym.physics.dynamics import accelerations, own_forces, total, water_velocity
from ship_gym.physics.parameters import of_lane, ship_at
from ship_gym.physics.quantities import Body, Controls, Force, Motion, Tables

START, MIDDLE, END = range(3)  # of a step: when controls are asked for


class Current(NamedTuple):
    """Velocity of the water to north and east [m/s]."""

    V_north: float
    V_east: float


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
    c, s = cos_sin(psi)
    rates = Body(du + r * v_c, dv - r * u_c, dr, u * c - v * s, u * s + v * c, r)
    return rates, own, units


@kernel
def body_of(rows, i):
    """Lane i of `start` or `at`."""
    return Body(rows[0, i], rows[1, i], rows[2, i], rows[3, i], rows[4, i], rows[5, i])


@kernel
def ask(x, lo, hi, weight, reach, back, tables, traits):
    """Rates at the place `at` and with the controls `now` of every lane.

    Moves the place to start + `reach` dt of them + `back` of the sum of those before, and adds
    `weight` dt of them to that sum. Leaves the ship's own forces and the loading of its units there
    in the scratch.

    Parameters
    ----------
    x : record
        ``physics.scratch.SCRATCH``.
    lo, hi : int
        First lane, and the one after the last.
    tables : Tables
        Of all kinds of ships.
    traits : Traits
    """
    common, kind = ship_at(x, lo, traits), x.kind[lo]
    for i in range(lo, hi):
        ship = of_lane(x, i, traits, common)
        if traits.each is not None:
            kind = x.kind[i]
        one = Tables(tables.open_water[kind], tables.deflected[kind])
        controls = Controls(x.now[0, i], x.now[1, i])
        load = Force(x.load[0, i], x.load[1, i], x.load[2, i])
        sea = Current(x.current[0, i], x.current[1, i])
        rates, own, units = derivative(body_of(x.at, i), controls, load, ship, sea, one)
        w, h = weight * x.dt[i], reach * x.dt[i]
        for k in range(6):
            before = x.change[k, i]
            x.at[k, i] = x.start[k, i] + h * rates[k] + back * before
            x.change[k, i] = before + w * rates[k]
        for k in range(3):
            x.own[k, i], x.own[3 + k, i] = own.hull[k], own.propeller[k]
            x.own[6 + k, i] = own.rudder[k]
        for k in range(5):
            x.units[k, i], x.units[5 + k, i] = units.starboard[k], units.port[k]


@kernel
def set_controls(x, lo, hi, traits):
    """Rudder and propeller at the middle and the end of the step; the units' torque is known."""
    common = ship_at(x, lo, traits)
    for i in range(lo, hi):
        ship = of_lane(x, i, traits, common)
        delta, n, dt = x.delta[START, i], x.n[START, i], x.dt[i]
        torque = x.units[3, i] + x.units[8, i]
        torque = 0.5 * torque if ship.propeller.y_P > 0.0 else torque  # of each shaft
        x.delta[MIDDLE, i] = rudder_after(delta, x.command[0, i], 0.5 * dt, ship.gear)
        x.n[MIDDLE, i] = engine_after(n, x.command[1, i], torque, 0.5 * dt, ship.engine)
        x.delta[END, i] = rudder_after(delta, x.command[0, i], dt, ship.gear)
        x.n[END, i] = engine_after(n, x.command[1, i], torque, dt, ship.engine)


@kernel
def set_now(x, lo, hi, when):
    """Controls of a stage: those at `START`, `MIDDLE` or `END` of the step."""
    for i in range(lo, hi):
        x.now[0, i], x.now[1, i] = x.delta[when, i], x.n[when, i]


@kernel
def begin_step(x, lo, hi):
    """Place and sum of every lane at the start of a step."""
    for k in range(6):
        for i in range(lo, hi):
            x.at[k, i], x.change[k, i] = x.start[k, i], 0.0
