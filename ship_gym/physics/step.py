"""The only loop over ships: one control interval of a batch, in blocks of 64 ships."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ship_gym.conventions import DELTA, FORCE_COMPONENTS, PSI, N, R, U, V, X, Y
from ship_gym.physics._kernel import kernel, loop
from ship_gym.physics.disturbance import disturbance_forces
from ship_gym.physics.dynamics import (
    Loading,
    OwnForces,
    Units,
    flow_of,
    vary_current,
    water_velocity,
)
from ship_gym.physics.integrate import (
    END,
    MIDDLE,
    START,
    Current,
    ask,
    begin_step,
    body_of,
    set_controls,
    set_now,
)
from ship_gym.physics.parameters import N_PARAMETERS, of_lane, ship_at
from ship_gym.physics.quantities import Body, Controls, Force, Motion, Tables
from ship_gym.physics.scratch import LANES
from ship_gym.physics.waves import WAVE_AHEAD, WAVE_N, WAVE_X, WAVE_Y, Waves, wave_loads
from ship_gym.physics.wind import gust_factor, wind_forces


class HeldLoads(NamedTuple):
    """Loads that are held during an integration step."""

    wave: Force
    wind: Force
    disturbance: Force


class Water(NamedTuple):
    """What surrounds the ships of a batch.

    Attributes
    ----------
    seas : structured ndarray (n,)
        ``ship_gym.sea.records.SEA_DTYPE``.
    waves : Waves
    winds : ndarray (kinds, count, 3)
        Wind coefficients; ``seas.wind_table`` selects.
    gusts, gust_phases : ndarray (kinds, 2, K), ndarray (n, K)
        ``wind.gust_factor``.
    harmonics : ndarray (n, 4, H)
        ``disturbance.disturbance_forces``; H = 0 where no ship is disturbed.
    """

    seas: np.ndarray
    waves: Waves
    winds: np.ndarray
    gusts: np.ndarray
    gust_phases: np.ndarray
    harmonics: np.ndarray


class Course(NamedTuple):
    """Ships under way, one row each; everything but commands, clock and ships is written.

    Attributes
    ----------
    states : ndarray (n, 8)
    commands : ndarray (n, 2)
    times : ndarray (n,)
        Own time of each ship [s].
    clock : ndarray (n, 2)
        Integration step [s] and number of steps of each interval.
    ships, parameters : structured ndarray (n,), ndarray (n, 2 + N_PARAMETERS)
        Records of the ships, and the same as numbers.
    forces, flow, met : ndarray (n, N_FORCES, 3), ndarray (n, 7 or 19), ndarray (n, 10)
        Of the first integration step: own forces and flow at its start, those from outside at its
        middle; `met`, the waves, ``waves.WaveState``, at the end of the interval.
    """

    states: np.ndarray
    commands: np.ndarray
    times: np.ndarray
    clock: np.ndarray
    ships: np.ndarray
    parameters: np.ndarray
    forces: np.ndarray
    flow: np.ndarray
    met: np.ndarray


NOTHING = Force(0.0, 0.0, 0.0)
OUTSIDE = len(OwnForces._fields)
if (*OwnForces._fields, *HeldLoads._fields) != FORCE_COMPONENTS:
    raise ImportError(
        "conventions.FORCES must name the fields of OwnForces, then those of HeldLoads: "
        f"{', '.join((*OwnForces._fields, *HeldLoads._fields))}"
    )


@kernel
def held_loads(time, dt, body, water, ship, met, x):
    """What is held during an integration step, as it is at its middle.

    Parameters
    ----------
    time, dt : float
        Start and length of the step [s].
    body : Body
        At its start.
    water : Water
    ship : int
        Row of the ship.
    met : ndarray (10,)
        What waves do to it.
    x : record
        Scratch.
    """
    sea = water.seas[ship]
    wave, wind, disturbance = NOTHING, NOTHING, NOTHING
    if sea.wavy == 1:
        wave = Force(met[WAVE_X], met[WAVE_Y], met[WAVE_N])
    if sea.windy == 1:
        kind, middle = sea.wind_table, time + 0.5 * dt
        phases = water.gust_phases[ship]
        factor = gust_factor(middle, sea.gust_scale, water.gusts[kind], phases, x.gust)
        psi = body.psi + 0.5 * dt * body.r
        wind = wind_forces(body.u, body.v, psi, factor, sea, water.winds[kind])
    if sea.disturbed == 1:
        Y, N = disturbance_forces(time + 0.5 * dt, sea.omega_1, water.harmonics[ship])
        disturbance = Force(0.0, Y, N)
    return HeldLoads(wave, wind, disturbance)


@kernel
def see(time, dt, body, water, ship, x, met):
    """Write what waves do to one ship into `met`: motion now, drift during the coming `dt` [s]."""
    sea = water.seas[ship]
    if sea.wavy == 1:
        found = wave_loads(time, dt, body, sea, water.waves, ship, x.wave)
        for k in range(len(found)):
            met[k] = found[k]


@kernel
def state_body(states, ship):
    """The body in a row of the states."""
    return Body(
        states[ship, U], states[ship, V], states[ship, R],
        states[ship, X], states[ship, Y], states[ship, PSI],
    )  # fmt: skip


@loop
def see_waves(which, course, water, scratch):
    """Refresh `met` of some ships, as after a reset."""
    for ship in which:
        dt, body = course.clock[ship, 0], state_body(course.states, ship)
        see(course.times[ship], dt, body, water, ship, scratch[0], course.met[ship])


@kernel
def board(x, lo, hi, first, course, traits):
    """Bring ships from row `first` on into the lanes; returns the largest number of steps."""
    most = 0
    for i in range(lo, hi):
        ship = first + i
        for k in range(6):
            x.start[k, i] = course.states[ship, k]
        x.delta[START, i], x.n[START, i] = course.states[ship, DELTA], course.states[ship, N]
        x.command[0, i], x.command[1, i] = course.commands[ship, 0], course.commands[ship, 1]
        x.dt[i], x.steps[i] = course.clock[ship, 0], int(course.clock[ship, 1])
        x.kind[i] = course.ships[ship].kind
        most = max(most, x.steps[i])
        if traits.each is not None or i == lo:
            x.ship[0, i] = course.parameters[ship, 0]
            for k in range(1, N_PARAMETERS):
                x.ship[k, i] = course.parameters[ship, k + 1]
    return most


@kernel
def load_lanes(x, lo, hi, first, step, course, water):
    """Loads and current of every lane for its next step; those of the first one are kept."""
    for i in range(lo, hi):
        ship = first + i
        sea, met, dt = water.seas[ship], course.met[ship], x.dt[i]
        time = course.times[ship] + step * dt
        vary_current(time, sea)
        x.current[0, i], x.current[1, i] = sea.V_north, sea.V_east
        body = body_of(x.start, i)
        if sea.wavy == 1 and met[WAVE_AHEAD] != dt:  # the interval has changed
            see(time, dt, body, water, ship, x, met)
        held = held_loads(time, dt, body, water, ship, met, x)
        for k in range(3):
            x.load[k, i] = held.wave[k] + held.wind[k] + held.disturbance[k]
        if step == 0:
            for k in range(3):
                course.forces[ship, OUTSIDE, k] = held.wave[k]
                course.forces[ship, OUTSIDE + 1, k] = held.wind[k]
                course.forces[ship, OUTSIDE + 2, k] = held.disturbance[k]


@kernel
def report(x, lo, hi, first, course, traits):
    """Write own forces and flow of every lane, which are those at the start of the interval."""
    common = ship_at(x, lo, traits)
    for i in range(lo, hi):
        ship = first + i
        parameters = of_lane(x, i, traits, common)
        for k in range(OUTSIDE):
            for axis in range(3):
                course.forces[ship, k, axis] = x.own[3 * k + axis, i]
        q = x.units
        units = Units(
            Loading(q[0, i], q[1, i], q[2, i], q[3, i], q[4, i]),
            Loading(q[5, i], q[6, i], q[7, i], q[8, i], q[9, i]),
        )
        u_c, v_c = water_velocity(x.start[PSI, i], Current(x.current[0, i], x.current[1, i]))
        motion = Motion(x.start[U, i] - u_c, x.start[V, i] - v_c, x.start[R, i])
        flow = flow_of(motion, Controls(x.delta[START, i], x.n[START, i]), units, parameters)
        for k in range(course.flow.shape[1]):
            course.flow[ship, k] = flow[k]


@kernel
def move(x, lo, hi, step):
    """Put every lane that sails this step at its end."""
    for i in range(lo, hi):
        if step < x.steps[i]:
            for k in range(6):
                x.start[k, i] += x.sum[k, i]
            x.delta[START, i], x.n[START, i] = x.delta[END, i], x.n[END, i]


@kernel
def look(x, lo, hi, first, step, course, water):
    """What waves do to every lane that sails this step, at its end."""
    for i in range(lo, hi):
        if step < x.steps[i]:
            ship, dt = first + i, x.dt[i]
            time = course.times[ship] + (step + 1) * dt
            see(time, dt, body_of(x.start, i), water, ship, x, course.met[ship])


@kernel
def land(x, lo, hi, first, course):
    """Write the states back and let time go on; returns how many of the lanes' are finite."""
    alive = 0
    for i in range(lo, hi):
        ship, total = first + i, abs(x.delta[START, i]) + abs(x.n[START, i])
        for k in range(6):
            course.states[ship, k] = x.start[k, i]
            total += abs(x.start[k, i])
        course.states[ship, DELTA], course.states[ship, N] = x.delta[START, i], x.n[START, i]
        course.times[ship] += x.dt[i] * x.steps[i]
        alive += 1 if math.isfinite(total) else 0
    return alive


# The stages of `integrate.ask`, k1 at the start y, k2 at y + dt/2 k1, k3 at y + 2 dt k2 - dt k1 (the
# sum before it is dt k1 / 6); the step is dt (k1 + 4 k2 + k3) / 6
WHEN = (START, MIDDLE, END)
WEIGHT = (1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0)
REACH = (0.5, 2.0, 0.0)
BACK = (0.0, -6.0, 0.0)


@kernel
def sail_block(x, lo, hi, first, course, water, tables, traits):
    """Advance some ships by one control interval; the first lane holds the ship of row `first`.

    Parameters
    ----------
    x : record
        ``physics.scratch.SCRATCH``.
    lo, hi : int
        First lane, and the one after the last.
    first : int
        Row of the ship in lane 0.
    course : Course
    water : Water
    tables : Tables
        Of all kinds of ships: open water (kinds, count, 2), surrogate (kinds, 2, ..., 11).
    traits : parameters.Traits

    Returns
    -------
    int
        Number of ships whose new state is finite.
    """
    most = board(x, lo, hi, first, course, traits)
    for step in range(most):
        load_lanes(x, lo, hi, first, step, course, water)
        begin_step(x, lo, hi)
        for stage in range(len(WHEN)):
            set_now(x, lo, hi, WHEN[stage])
            ask(x, lo, hi, WEIGHT[stage], REACH[stage], BACK[stage], tables, traits)
            if stage == 0:
                set_controls(x, lo, hi, traits)
                if step == 0:
                    report(x, lo, hi, first, course, traits)
        move(x, lo, hi, step)
        look(x, lo, hi, first, step, course, water)
    return land(x, lo, hi, first, course)


@kernel
def sail(first, last, course, water, tables, traits, scratch):
    """As `sail_block`, of the rows from `first` to `last`."""
    x, alive = scratch[0], 0
    for begin in range(first, last, LANES):
        count = min(LANES, last - begin)
        alive += sail_block(x, 0, count, begin, course, water, tables, traits)
    return alive


@loop
def sail_rows(first, last, course, water, tables, traits, scratch):
    """`sail` for a caller in Python."""
    return sail(first, last, course, water, tables, traits, scratch)
