"""The only loop over ships: one control interval of a batch, serial or parallel."""

from __future__ import annotations

import math
from typing import NamedTuple

from ship_gym.conventions import FORCE_COMPONENTS
from ship_gym.physics._kernel import batch, kernel, prange
from ship_gym.physics.disturbance import disturbance_forces
from ship_gym.physics.dynamics import OwnForces, total, vary_current, water_velocity
from ship_gym.physics.integrate import runge_kutta_4
from ship_gym.physics.waves import wave_loads
from ship_gym.physics.wind import wind_forces


class HeldLoads(NamedTuple):
    """Loads that are held during an integration step: X, Y [N], N [N m] at midship of each."""

    wave: tuple[float, float, float]
    wind: tuple[float, float, float]
    disturbance: tuple[float, float, float]


if (*OwnForces._fields, *HeldLoads._fields) != FORCE_COMPONENTS:
    raise ImportError(
        "conventions.FORCES must name the fields of OwnForces, then those of HeldLoads: "
        f"{', '.join((*OwnForces._fields, *HeldLoads._fields))}"
    )


@kernel
def waves_now(time, body, sea, around):
    """Drift and wave-frequency motion of one ship at one instant (``waves.WAVE_NAMES``)."""
    waves, groups, response, _ = around
    u_c, _ = water_velocity(body[5], sea)
    grid = (sea.speed_step, sea.speed_max, body[0] - u_c)
    X, Y, N, sway, sway_velocity, roll, yaw, yaw_rate, fast = wave_loads(
        time, body, waves, groups, response, grid, sea.mean_drift == 1
    )
    on = sea.drift
    return on * X, on * Y, on * N, sway, sway_velocity, roll, yaw, yaw_rate, fast


@kernel
def held_loads(time, dt, body, sea, seen, winds):
    """What is held during an integration step.

    Drift and wind are those of its start, the disturbance that of its middle.
    """
    wave, wind, disturbance = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    if sea.wavy == 1:
        wave = (seen[0], seen[1], seen[2])
    if sea.windy == 1:
        wind = wind_forces(time, body, sea, winds)
    if sea.disturbed == 1:
        Y, N = disturbance_forces(time + 0.5 * dt, sea)
        disturbance = (0.0, Y, N)
    return HeldLoads(wave, wind, disturbance)


@kernel
def step_one(state, command, clock, ship, sea, tables, around):
    """One control interval of one ship.

    Parameters
    ----------
    state : tuple of 8 floats
    command : (float, float)
        Rudder [rad] and propeller speed [rev/s].
    clock : (float, float, int)
        Time at the start [s], length of one integration step [s], number of steps.
    around : ((ndarray, ndarray, ndarray, ndarray), tuple of 9 floats)
        Waves, groups, response and wind table of this ship, and ``waves_now`` at the start.

    Returns
    -------
    state : tuple of 8 floats
    components : tuple of (float, float, float)
        X, Y [N], N [N m] of ``conventions.FORCE_COMPONENTS`` in the first integration step.
    flow : tuple of 7 floats
        ``conventions.FLOW_NAMES`` at the start of the interval.
    seen : tuple of 9 floats
        ``waves_now`` at the end.
    """
    time, dt, steps = clock
    field, seen = around
    vary_current(time, sea)
    held = held_loads(time, dt, state[:6], sea, seen, field[3])
    state, own, flow = runge_kutta_4(state, command, total(held), dt, ship, sea, tables)
    components = own[:] + held[:]  # numba joins plain tuples only
    for k in range(1, steps):
        now = time + k * dt
        vary_current(now, sea)
        if sea.wavy == 1:
            seen = waves_now(now, state[:6], sea, field)
        held = held_loads(now, dt, state[:6], sea, seen, field[3])
        state, _, _ = runge_kutta_4(state, command, total(held), dt, ship, sea, tables)
    if sea.wavy == 1:
        seen = waves_now(time + steps * dt, state[:6], sea, field)
    return state, components, flow, seen


@kernel
def finite(state):
    """1 if every entry of the state is finite, else 0."""
    total = 0.0
    for value in state:
        total += abs(value)
    return 1 if math.isfinite(total) else 0


@kernel
def see_waves(which, times, states, seas, waves, groups, response, winds, seen):
    """Refresh ``waves_now`` of some ships, as after a reset; `seen` (n, 9) is written."""
    for i in which:
        if seas[i].wavy == 1:
            s = states[i]
            body = (s[0], s[1], s[2], s[3], s[4], s[5])
            sea = seas[i]
            around = (waves[i], groups, response[sea.response], winds[sea.wind_table])
            found = waves_now(times[i], body, sea, around)
            for k in range(9):
                seen[i, k] = found[k]


def _step_batch(
    states, commands, times, clock, ships, seas, water, deflected,
    waves, groups, response, winds, forces, flow, seen,
):  # fmt: skip
    """Advance every ship by one control interval, in place.

    Parameters
    ----------
    states : ndarray (n, 8)
    commands : ndarray (n, 2)
    times : ndarray (n,)
        Own time of each ship [s]; advanced in place.
    clock : ndarray (n, 2)
        Integration step [s] and number of steps of each ship.
    ships, seas : structured ndarray (n,)
    water, deflected : ndarray (kinds, count, 2), (kinds, 2, count, count, 11)
        Tables of each kind of ship; ``ships.kind`` selects.
    waves, groups, response, winds : ndarray
        Of ``sea.records.Waters``; ``seas.response`` and ``seas.wind_table`` select.
    forces, flow, seen : ndarray (n, N_FORCES, 3), ndarray (n, 7), ndarray (n, 9)
        Written: at the start of the interval; `seen`, the waves, at its end. Not in a tuple,
        because numba loses what a parallel loop writes into arrays that are unpacked from one.

    Returns
    -------
    int
        Number of ships whose new state is finite.
    """
    alive = 0
    for i in prange(states.shape[0]):
        ship, sea = ships[i], seas[i]
        tables = (water[ship.kind], deflected[ship.kind])
        field = (waves[i], groups, response[sea.response], winds[sea.wind_table])
        s, w = states[i], seen[i]
        state = (s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7])
        around = (field, (w[0], w[1], w[2], w[3], w[4], w[5], w[6], w[7], w[8]))
        steps = int(clock[i, 1])
        tick = (times[i], clock[i, 0], steps)
        command = (commands[i, 0], commands[i, 1])
        state, parts, flow_i, after = step_one(state, command, tick, ship, sea, tables, around)
        for k in range(8):
            states[i, k] = state[k]
        for k in range(len(parts)):
            for axis in range(3):
                forces[i, k, axis] = parts[k][axis]
        for k in range(7):
            flow[i, k] = flow_i[k]
        for k in range(9):
            seen[i, k] = after[k]
        times[i] += clock[i, 0] * steps
        alive += finite(state)
    return alive


step_batch, step_batch_parallel = batch(_step_batch)
