"""The only loop over ships: one control interval of a batch, in blocks of 64 ships."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ship_gym.conventions import DELTA, FORCE_COMPONENTS, PSI, N, R, U, V, X, Y
from ship_gym.physics._kernel import composed, kernel, loop
from ship_gym.physics.disturbance import disturbance_forces
from ship_gym.physics.dynamics import (
    Loading,
    OwnForces,
    Units,
    flow_of,
    total,
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
from ship_gym.physics.parameters import Traits, fill_lane, of_lane, ship_at
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
    """What surrounds the ships of a batch, beside their seas' records.

    Attributes
    ----------
    waves : Waves
    winds : ndarray (kinds, count, 3)
        Wind coefficients; ``seas.wind_table`` selects.
    gusts, gust_phases : ndarray (kinds, 2, K), ndarray (n, K)
        ``wind.gust_factor``.
    harmonics : ndarray (n, 4, H)
        ``disturbance.disturbance_forces``; H = 0 where no ship is disturbed.
    """

    waves: Waves
    winds: np.ndarray
    gusts: np.ndarray
    gust_phases: np.ndarray
    harmonics: np.ndarray


class Fleet(NamedTuple):
    """Everything of n ships that a step reads and writes.

    Attributes
    ----------
    state : ndarray (n, 8)
    commands : ndarray (n, 2)
    time : ndarray (n,)
        Own time of each ship [s].
    clock : ndarray (n, 2)
        Integration step [s] and number of steps of each interval.
    limits, lost : ndarray (n, 2), ndarray (n,)
        Speed through the water [m/s] and yaw rate [rad/s] beyond which nothing is a ship; written:
        whether she was beyond them at any step of the interval, or is not finite.
    ships, seas : structured ndarray (n,)
        ``ships.records.SHIP_DTYPE``, ``sea.records.SEA_DTYPE``.
    forces, flow, met : ndarray (n, N_FORCES, 3), ndarray (n, 7 or 19), ndarray (n, 10)
        Of the first integration step: own forces and flow at its start, those from outside during
        it; `met`, what the waves do, ``waves.WaveState``, at the end of the interval.
    tables : Tables
        Of all kinds of ships: open water (kinds, count, 2), surrogate (kinds, 2, ..., 11);
        ``ships.kind`` selects.
    traits : parameters.Traits
    water : Water
    scratch : structured ndarray (threads,)
        ``physics.scratch.SCRATCH``; each thread has its own.
    """

    state: np.ndarray
    commands: np.ndarray
    time: np.ndarray
    clock: np.ndarray
    limits: np.ndarray
    lost: np.ndarray
    ships: np.ndarray
    seas: np.ndarray
    forces: np.ndarray
    flow: np.ndarray
    met: np.ndarray
    tables: Tables
    traits: Traits
    water: Water
    scratch: np.ndarray


NOTHING = Force(0.0, 0.0, 0.0)
OUTSIDE = len(OwnForces._fields)
if (*OwnForces._fields, *HeldLoads._fields) != FORCE_COMPONENTS:
    raise ImportError(
        "conventions.FORCES must name the fields of OwnForces, then those of HeldLoads: "
        f"{', '.join((*OwnForces._fields, *HeldLoads._fields))}"
    )


@kernel
def held_loads(time, dt, body, sea, water, ship, met, x):
    """What is held during an integration step, as it is at its middle.

    Parameters
    ----------
    time, dt : float
        Start and length of the step [s].
    body : Body
        At its start.
    sea : record
    water : Water
    ship : int
        Row of the ship.
    met : ndarray (10,)
        What waves do to it.
    x : record
        Scratch.
    """
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


@composed
def see(time, dt, body, sea, water, ship, x, met):
    """Write what waves do to one ship into `met`: motion now, drift during the coming `dt` [s]."""
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
def see_waves(which, fleet):
    """Refresh `met` of some ships, as after a reset."""
    for ship in which:
        dt, body = fleet.clock[ship, 0], state_body(fleet.state, ship)
        sea, met = fleet.seas[ship], fleet.met[ship]
        see(fleet.time[ship], dt, body, sea, fleet.water, ship, fleet.scratch[0], met)


@composed
def board(x, lo, hi, first, fleet):
    """Bring ships from row `first` on into the lanes; returns the largest number of steps."""
    most = 0
    for i in range(lo, hi):
        ship = first + i
        for k in range(6):
            x.start[k, i] = fleet.state[ship, k]
        x.delta[START, i], x.n[START, i] = fleet.state[ship, DELTA], fleet.state[ship, N]
        x.command[0, i], x.command[1, i] = fleet.commands[ship, 0], fleet.commands[ship, 1]
        x.dt[i], x.steps[i] = fleet.clock[ship, 0], int(fleet.clock[ship, 1])
        x.kind[i] = fleet.ships[ship].kind
        x.most[0, i], x.most[1, i] = 0.0, 0.0
        most = max(most, x.steps[i])
        if fleet.traits.each is not None or i == lo:
            fill_lane(x, i, fleet.ships[ship])
    return most


@composed
def load_lanes(x, lo, hi, first, step, fleet):
    """Loads and current of every lane that sails this step; those of the first one are kept."""
    for i in range(lo, hi):
        if step >= x.steps[i]:
            continue
        ship = first + i
        sea, met, dt = fleet.seas[ship], fleet.met[ship], x.dt[i]
        time, body = fleet.time[ship] + step * dt, body_of(x.start, i)
        if sea.wavy == 1 and met[WAVE_AHEAD] != dt:  # the interval has changed
            see(time, dt, body, sea, fleet.water, ship, x, met)
        vary_current(time + 0.5 * dt, sea)
        x.current[0, i], x.current[1, i] = sea.V_north, sea.V_east
        held = held_loads(time, dt, body, sea, fleet.water, ship, met, x)
        load = total(held)
        for k in range(3):
            x.load[k, i] = load[k]
        if step == 0:
            for j in range(len(held)):
                for k in range(3):
                    fleet.forces[ship, OUTSIDE + j, k] = held[j][k]


@composed
def report(x, lo, hi, first, fleet):
    """Write own forces and flow of every lane, which are those at the start of the interval."""
    common = ship_at(x, lo, fleet.traits)
    for i in range(lo, hi):
        ship = first + i
        parameters = of_lane(x, i, fleet.traits, common)
        for k in range(OUTSIDE):
            for axis in range(3):
                fleet.forces[ship, k, axis] = x.own[3 * k + axis, i]
        q = x.units
        units = Units(
            Loading(q[0, i], q[1, i], q[2, i], q[3, i], q[4, i]),
            Loading(q[5, i], q[6, i], q[7, i], q[8, i], q[9, i]),
        )
        u_c, v_c = water_velocity(x.start[PSI, i], Current(x.current[0, i], x.current[1, i]))
        motion = Motion(x.start[U, i] - u_c, x.start[V, i] - v_c, x.start[R, i])
        flow = flow_of(motion, Controls(x.delta[START, i], x.n[START, i]), units, parameters)
        for k in range(fleet.flow.shape[1]):
            fleet.flow[ship, k] = flow[k]


@kernel
def move(x, lo, hi, step):
    """Put every lane that sails this step at its end."""
    for i in range(lo, hi):
        if step < x.steps[i]:
            for k in range(6):
                x.start[k, i] += x.change[k, i]
            x.delta[START, i], x.n[START, i] = x.delta[END, i], x.n[END, i]


@kernel
def watch(x, lo, hi):
    """Keep the largest speed squared and yaw rate of every lane in the steps before its last."""
    for i in range(lo, hi):
        u, v, r = x.start[U, i], x.start[V, i], x.start[R, i]
        x.most[0, i] = max(x.most[0, i], u * u + v * v)
        x.most[1, i] = max(x.most[1, i], abs(r))


@composed
def look(x, lo, hi, first, step, fleet):
    """Current and what waves do to every lane that sails this step, at its end."""
    for i in range(lo, hi):
        if step < x.steps[i]:
            ship, dt = first + i, x.dt[i]
            time, sea, met = fleet.time[ship] + (step + 1) * dt, fleet.seas[ship], fleet.met[ship]
            vary_current(time, sea)
            see(time, dt, body_of(x.start, i), sea, fleet.water, ship, x, met)


@kernel
def within(x, i, fastest, turn):
    """Whether speed and yaw rate of a lane have been those of a ship in every step.

    Speeds are over ground; the current's parts are added to what is allowed: that takes no root.
    """
    u, v, r = x.start[U, i], x.start[V, i], x.start[R, i]
    fastest += abs(x.current[0, i]) + abs(x.current[1, i])
    fast = max(x.most[0, i], u * u + v * v) <= fastest * fastest
    return fast and max(x.most[1, i], abs(r)) <= turn


@composed
def land(x, lo, hi, first, fleet):
    """Write the states back and let time go on; returns how many of the lanes are ships still."""
    alive = 0
    for i in range(lo, hi):
        ship, total = first + i, abs(x.delta[START, i]) + abs(x.n[START, i])
        for k in range(6):
            fleet.state[ship, k] = x.start[k, i]
            total += abs(x.start[k, i])
        fleet.state[ship, DELTA], fleet.state[ship, N] = x.delta[START, i], x.n[START, i]
        fleet.time[ship] += x.dt[i] * x.steps[i]
        good = math.isfinite(total) and within(x, i, fleet.limits[ship, 0], fleet.limits[ship, 1])
        fleet.lost[ship] = not good
        alive += 1 if good else 0
    return alive


# The stages of `integrate.ask`: k1 at the start y, k2 at y + dt/2 k1, k3 at y + 2 dt k2 - dt k1
# (the sum before it is dt k1 / 6); the step is dt (k1 + 4 k2 + k3) / 6
WHEN = (START, MIDDLE, END)
WEIGHT = (1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0)
REACH = (0.5, 2.0, 0.0)
BACK = (0.0, -6.0, 0.0)


@composed
def sail_block(x, lo, hi, first, fleet):
    """Advance some ships by one control interval.

    Parameters
    ----------
    x : record
        ``physics.scratch.SCRATCH``.
    lo, hi : int
        First lane, and the one after the last.
    first : int
        Row of the ship in lane 0.
    fleet : Fleet

    Returns
    -------
    int
        Number of ships that are ships still: finite and within their limits.
    """
    traits, most = fleet.traits, board(x, lo, hi, first, fleet)
    for step in range(most):
        load_lanes(x, lo, hi, first, step, fleet)
        begin_step(x, lo, hi)
        for stage in range(len(WHEN)):
            set_now(x, lo, hi, WHEN[stage])
            ask(x, lo, hi, WEIGHT[stage], REACH[stage], BACK[stage], fleet.tables, traits)
            if stage == 0:
                set_controls(x, lo, hi, traits)
                if step == 0:
                    report(x, lo, hi, first, fleet)
        move(x, lo, hi, step)
        if step + 1 < most:
            watch(x, lo, hi)
        look(x, lo, hi, first, step, fleet)
    return land(x, lo, hi, first, fleet)


@kernel
def thread_of(row, n, threads):
    """Which of the threads has a row, where ``_threads.parts_of`` shares n rows among them."""
    blocks = (n + LANES - 1) // LANES
    parts = max(min(threads, blocks), 1)
    return ((row // LANES + 1) * parts - 1) // blocks


@composed
def sail(first, last, fleet):
    """Advance the ships from `first` up to `last` by one control interval, in place.

    Returns how many of them are ships still.
    """
    x, alive = fleet.scratch[thread_of(first, fleet.state.shape[0], fleet.scratch.shape[0])], 0
    for begin in range(first, last, LANES):
        alive += sail_block(x, 0, min(LANES, last - begin), begin, fleet)
    return alive


@loop
def sail_rows(first, last, fleet):
    """`sail` for a caller in Python; the rows are those of one thread."""
    return sail(first, last, fleet)
