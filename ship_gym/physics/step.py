"""The only loop over ships: one control interval of a batch, serial or parallel."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ship_gym.conventions import DELTA, FORCE_COMPONENTS, PSI, N, R, U, V, X, Y
from ship_gym.physics._kernel import kernel, loop
from ship_gym.physics.disturbance import disturbance_forces
from ship_gym.physics.dynamics import OwnForces, flow_of, total, vary_current, water_velocity
from ship_gym.physics.integrate import body_of, runge_kutta_4
from ship_gym.physics.quantities import Around, Controls, Force, Motion, State, Tables
from ship_gym.physics.waves import (
    WAVE_EXTRAPOLATION,
    WAVE_N,
    WAVE_ROLL,
    WAVE_SWAY,
    WAVE_SWAY_VELOCITY,
    WAVE_X,
    WAVE_Y,
    WAVE_YAW,
    WAVE_YAW_RATE,
    WaveState,
    wave_loads,
)
from ship_gym.physics.wind import wind_forces


class HeldLoads(NamedTuple):
    """Loads that are held during an integration step."""

    wave: Force
    wind: Force
    disturbance: Force


NOTHING = Force(0.0, 0.0, 0.0)
if (*OwnForces._fields, *HeldLoads._fields) != FORCE_COMPONENTS:
    raise ImportError(
        "conventions.FORCES must name the fields of OwnForces, then those of HeldLoads: "
        f"{', '.join((*OwnForces._fields, *HeldLoads._fields))}"
    )


@kernel
def waves_now(time, body, sea, around):
    """Drift and wave-frequency motion of one ship at one instant, a `WaveState`."""
    u_c, _ = water_velocity(body.psi, sea)
    grid = (sea.speed_step, sea.speed_max, body.u - u_c)
    X, Y, N, sway, sway_velocity, roll, yaw, yaw_rate, fast = wave_loads(
        time, body, around.waves, around.groups, around.response, grid, sea.mean_drift == 1
    )
    on = sea.drift
    return WaveState(on * X, on * Y, on * N, sway, sway_velocity, roll, yaw, yaw_rate, fast)


@kernel
def held_loads(time, dt, body, sea, met, around):
    """What is held during an integration step.

    Drift and wind are those of its start, the disturbance that of its middle.
    """
    wave, wind, disturbance = NOTHING, NOTHING, NOTHING
    if sea.wavy == 1:
        wave = Force(met.X, met.Y, met.N)
    if sea.windy == 1:
        wind = wind_forces(time, body, sea, around.wind)
    if sea.disturbed == 1:
        Y, N = disturbance_forces(time + 0.5 * dt, sea)
        disturbance = Force(0.0, Y, N)
    return HeldLoads(wave, wind, disturbance)


@kernel
def step_one(state, command, clock, ship, sea, tables, around, met):
    """One control interval of one ship.

    Parameters
    ----------
    state : State
    command : Controls
    clock : (float, float, int)
        Time at the start [s], length of one integration step [s], number of steps.
    around : Around
    met : WaveState
        At the start.

    Returns
    -------
    state : State
    components : tuple of Force
        Of ``conventions.FORCE_COMPONENTS`` in the first integration step.
    flow : Flow
        At the start of the interval.
    met : WaveState
        At the end.
    """
    time, dt, steps = clock
    vary_current(time, sea)
    held = held_loads(time, dt, body_of(state), sea, met, around)
    u_c, v_c = water_velocity(state.psi, sea)
    start, motion = Controls(state.delta, state.n), Motion(state.u - u_c, state.v - v_c, state.r)
    state, own, units = runge_kutta_4(state, command, total(held), dt, ship, sea, tables)
    flow = flow_of(motion, start, units, ship)
    components = own[:] + held[:]  # numba joins plain tuples only
    for k in range(1, steps):
        now = time + k * dt
        vary_current(now, sea)
        if sea.wavy == 1:
            met = waves_now(now, body_of(state), sea, around)
        held = held_loads(now, dt, body_of(state), sea, met, around)
        state, _, _ = runge_kutta_4(state, command, total(held), dt, ship, sea, tables)
    if sea.wavy == 1:
        met = waves_now(time + steps * dt, body_of(state), sea, around)
    return state, components, flow, met


@kernel
def state_of(states, i):
    """Row i of the states by name; a view of the row would cost its counted references."""
    return State(
        states[i, U], states[i, V], states[i, R], states[i, X], states[i, Y], states[i, PSI],
        states[i, DELTA], states[i, N],
    )  # fmt: skip


@kernel
def waves_of(met, i):
    """Row i of the wave states by name."""
    return WaveState(
        met[i, WAVE_X], met[i, WAVE_Y], met[i, WAVE_N], met[i, WAVE_SWAY],
        met[i, WAVE_SWAY_VELOCITY], met[i, WAVE_ROLL], met[i, WAVE_YAW], met[i, WAVE_YAW_RATE],
        met[i, WAVE_EXTRAPOLATION],
    )  # fmt: skip


@kernel
def finite(state):
    """1 if every entry of the state is finite, else 0."""
    total = 0.0
    for value in state:
        total += abs(value)
    return 1 if math.isfinite(total) else 0


@kernel
def see_waves(which, times, states, seas, waves, groups, response, winds, met):
    """Refresh ``waves_now`` of some ships, as after a reset; `met` (n, 9) is written."""
    for i in which:
        if seas[i].wavy == 1:
            sea, body = seas[i], body_of(state_of(states, i))
            around = Around(waves[i], groups, response[sea.response], winds[sea.wind_table])
            found = waves_now(times[i], body, sea, around)
            for k in range(len(found)):
                met[i, k] = found[k]


class Fleet(NamedTuple):
    """Everything of n ships that a step reads and writes.

    ``state`` (n, 8); ``commands`` (n, 2); ``time`` (n,), own time of each ship [s]; ``clock``
    (n, 2), integration step [s] and number of steps of each; ``ships``, ``seas``, structured (n,);
    ``open_water`` (kinds, count, 2) and ``deflected`` (kinds, 2, count, count, 11), tables of each
    kind of ship, which ``ships.kind`` selects; ``waves``, ``groups``, ``response``, ``winds`` of
    ``sea.records.Waters``, where ``seas.response`` and ``seas.wind_table`` select; ``forces``
    (n, N_FORCES, 3) and ``flow`` (n, 7 or 19) at the start of an interval, ``met`` (n, 9), the
    waves at its end, are written.
    """

    state: np.ndarray
    commands: np.ndarray
    time: np.ndarray
    clock: np.ndarray
    ships: np.ndarray
    seas: np.ndarray
    open_water: np.ndarray
    deflected: np.ndarray
    waves: np.ndarray
    groups: np.ndarray
    response: np.ndarray
    winds: np.ndarray
    forces: np.ndarray
    flow: np.ndarray
    met: np.ndarray


@loop
def sail(first, last, fleet):
    """Advance the ships from `first` up to `last` by one control interval, in place.

    Parameters
    ----------
    first, last : int
    fleet : Fleet

    Returns
    -------
    int
        Number of them whose new state is finite.
    """
    states, commands, times, clock, ships, seas = fleet[:6]
    open_water, deflected, waves, groups, response, winds, forces, flow, met = fleet[6:]
    alive = 0
    for i in range(first, last):
        ship, sea = ships[i], seas[i]
        tables = Tables(open_water[ship.kind], deflected[ship.kind])
        around = Around(waves[i], groups, response[sea.response], winds[sea.wind_table])
        steps = int(clock[i, 1])
        tick = (times[i], clock[i, 0], steps)
        command = Controls(commands[i, 0], commands[i, 1])
        state, parts, flow_i, after = step_one(
            state_of(states, i), command, tick, ship, sea, tables, around, waves_of(met, i)
        )
        for k in range(len(state)):
            states[i, k] = state[k]
        for k in range(len(parts)):
            forces[i, k, 0], forces[i, k, 1], forces[i, k, 2] = parts[k]
        for k in range(flow.shape[1]):
            flow[i, k] = flow_i[k]
        for k in range(len(after)):
            met[i, k] = after[k]
        times[i] += clock[i, 0] * steps
        alive += finite(state)
    return alive
