"""The only loop over ships: one control interval of a batch, serial or parallel."""

from __future__ import annotations

import math

from ship_gym.physics._kernel import batch, kernel, prange
from ship_gym.physics.disturbance import disturbance_forces
from ship_gym.physics.integrate import runge_kutta_4


@kernel
def step_one(state, command, clock, ship, sea, tables):
    """One control interval of one ship.

    Parameters
    ----------
    state : tuple of 8 floats
    command : (float, float)
        Rudder [rad] and propeller speed [rev/s].
    clock : (float, float, int)
        Time at the start [s], length of one integration step [s], number of steps.

    Returns
    -------
    state : tuple of 8 floats
    components : 4 x (float, float, float)
        X, Y [N], N [N m] of hull, propeller, rudder at the start of the interval and of the
        disturbance, which is held during an integration step at its value in the middle.
    flow : tuple of 7 floats
        ``conventions.FLOW_NAMES`` at the start of the interval.
    """
    time, dt, steps = clock
    load = disturbance_forces(time + 0.5 * dt, sea)
    state, components, flow = runge_kutta_4(state, command, load, dt, ship, sea, tables)
    for k in range(1, steps):
        later = disturbance_forces(time + (k + 0.5) * dt, sea)
        state, _, _ = runge_kutta_4(state, command, later, dt, ship, sea, tables)
    return state, components, flow


@kernel
def finite(state):
    """1 if every entry of the state is finite, else 0."""
    total = 0.0
    for value in state:
        total += abs(value)
    return 1 if math.isfinite(total) else 0


def _step_batch(states, commands, times, clock, ships, seas, water, deflected, forces, flow):
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
    forces, flow : ndarray (n, 4, 3), ndarray (n, 7)
        Written: at the start of the interval. Not in a tuple, because numba loses what a parallel
        loop writes into arrays that are unpacked from one.

    Returns
    -------
    int
        Number of ships whose new state is finite.
    """
    alive = 0
    for i in prange(states.shape[0]):
        ship = ships[i]
        tables = (water[ship.kind], deflected[ship.kind])
        s = states[i]
        state = (s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7])
        steps = int(clock[i, 1])
        tick = (times[i], clock[i, 0], steps)
        command = (commands[i, 0], commands[i, 1])
        state, components, flow_i = step_one(state, command, tick, ship, seas[i], tables)
        for k in range(8):
            states[i, k] = state[k]
        for k in range(4):
            for axis in range(3):
                forces[i, k, axis] = components[k][axis]
        for k in range(7):
            flow[i, k] = flow_i[k]
        times[i] += clock[i, 0] * steps
        alive += finite(state)
    return alive


step_batch, step_batch_parallel = batch(_step_batch)
