"""Heading keeping: what the agent sees, what it is paid for, when the episode ends.

Scalar kernels and the loops over them; the scalar environment is a batch of one. The loops are
serial: they take a tenth of the physics, and each start of threads is a place to wait where cores
are shared.
"""

from __future__ import annotations

import math

import numpy as np

from ship_gym.conventions import DELTA, PSI, N, R, U, V
from ship_gym.physics._kernel import kernel
from ship_gym.physics.angles import wrapped
from ship_gym.physics.dynamics import water_velocity
from ship_gym.physics.waves import WAVE_SWAY_VELOCITY, WAVE_YAW, WAVE_YAW_RATE

# symbol, unit, low, high, meaning
OBSERVATIONS = (
    ("sin(psi_e)", "-", -1.0, 1.0, "sine of the heading error psi - psi_ordered"),
    ("cos(psi_e)", "-", -1.0, 1.0, "cosine of the heading error"),
    ("r L / U0", "-", -5.0, 5.0, "yaw rate, positive to starboard"),
    ("u / U0", "-", -3.0, 3.0, "surge velocity through the water"),
    ("v / U0", "-", -3.0, 3.0, "sway velocity through the water, positive to starboard"),
    ("delta / delta_max", "-", -1.0, 1.0, "rudder angle achieved"),
    ("n / n_max", "-", 0.0, 1.0, "propeller speed achieved"),
    ("delta_c / delta_max", "-", -1.0, 1.0, "last rudder command"),
    ("n_c / n_max", "-", 0.0, 1.0, "last propeller speed command"),
)
LOW = tuple(row[2] for row in OBSERVATIONS)
HIGH = tuple(row[3] for row in OBSERVATIONS)
OBSERVATION_LOW = np.array(LOW, dtype=np.float32)
OBSERVATION_HIGH = np.array(HIGH, dtype=np.float32)
N_OBSERVATIONS = len(OBSERVATIONS)

REWARD_TERMS = ("heading", "rudder", "rudder_rate", "speed_loss", "termination")
N_TERMS = len(REWARD_TERMS)

TASK_DTYPE = np.dtype(
    (
        np.record,
        [
            (name, np.float64)
            for name in (
                "psi_ordered",  # ordered heading [rad]
                "speed",  # nominal speed U0 [m/s]
                "n_order",  # propeller speed that an agent without rpm control gets [rev/s]
                "interval",  # control interval [full-scale s]
                "rudder_stroke",  # largest rudder change in one interval [rad]
                "heading_limit",  # heading error that ends the episode [rad]
                "heading",  # weights of the reward terms
                "rudder",
                "rudder_rate",
                "speed_loss",
                "termination",
            )
        ],
    )
)


@kernel
def clipped(value, low, high):
    """Value limited to [low, high]."""
    return min(max(value, low), high)


@kernel
def reward_terms(psi_e, delta, stroke, u, task):
    """The five terms of one interval, each <= 0, and whether the episode terminates.

    Parameters
    ----------
    psi_e, delta, stroke : float
        Heading error, rudder angle and its change during the interval [rad].
    u : float
        Surge velocity through the water [m/s].
    """
    loss = max(0.0, 1.0 - u / task.speed)
    rate = stroke / task.rudder_stroke
    ended = abs(psi_e) > task.heading_limit
    terms = (
        -task.interval * task.heading * psi_e * psi_e,
        -task.interval * task.rudder * delta * delta,
        -task.interval * task.rudder_rate * rate * rate,
        -task.interval * task.speed_loss * loss * loss,
        -task.termination if ended else 0.0,
    )
    return terms, ended


@kernel
def command_batch(actions, states, ships, tasks, commands, rudder_before):
    """Actions in [-1, 1] to commands: rudder / delta_max and, if there, rpm from [0, n_max].

    Keeps the rudder angle at the start of the interval. Returns how many rows are finite.
    """
    good = 0
    for i in range(actions.shape[0]):
        rudder_before[i] = states[i, DELTA]
        commands[i, 0] = clipped(actions[i, 0], -1.0, 1.0) * ships[i].gear.delta_max
        commands[i, 1] = tasks[i].n_order
        total = actions[i, 0]
        if actions.shape[1] > 1:
            commands[i, 1] = 0.5 * (clipped(actions[i, 1], -1.0, 1.0) + 1.0) * ships[i].engine.n_max
            total += actions[i, 1]
        good += 1 if math.isfinite(total) else 0
    return good


@kernel
def observe(state, waves, command, ship, sea, task, row):
    """Write the observation of one ship into `row` (9,), limited to its declared bounds.

    Heading, yaw rate and sway velocity are measured with the wave-frequency motion on top.
    """
    psi = state[PSI]
    u_c, v_c = water_velocity(psi, sea)
    psi_e = wrapped(psi + waves[WAVE_YAW] - task.psi_ordered)
    values = (
        math.sin(psi_e),
        math.cos(psi_e),
        (state[R] + waves[WAVE_YAW_RATE]) * ship.hull.L / task.speed,
        (state[U] - u_c) / task.speed,
        (state[V] + waves[WAVE_SWAY_VELOCITY] - v_c) / task.speed,
        state[DELTA] / ship.gear.delta_max,
        state[N] / ship.engine.n_max,
        command[0] / ship.gear.delta_max,
        command[1] / ship.engine.n_max,
    )
    for k in range(9):
        row[k] = clipped(values[k], LOW[k], HIGH[k])


@kernel
def observe_batch(states, waves, commands, ships, seas, tasks, observations):
    """Observation of every ship, shape (n, 9), float32."""
    for i in range(states.shape[0]):
        observe(states[i], waves[i], commands[i], ships[i], seas[i], tasks[i], observations[i])


@kernel
def judge_batch(states, rudder_before, seas, tasks, terms, verdict):
    """Reward terms (n, 5) of the interval just sailed and the verdict on it.

    `verdict` holds rewards, terminated, truncated and elapsed, each (n,) and written, and the
    number of intervals of an episode.
    """
    rewards, terminated, truncated, elapsed, steps = verdict
    for i in range(states.shape[0]):
        psi, delta = states[i, PSI], states[i, DELTA]
        u_c, _ = water_velocity(psi, seas[i])
        psi_e = wrapped(psi - tasks[i].psi_ordered)
        stroke = delta - rudder_before[i]
        found, ended = reward_terms(psi_e, delta, stroke, states[i, U] - u_c, tasks[i])
        total = 0.0
        for k in range(5):
            terms[i, k] = found[k]
            total += found[k]
        rewards[i] = total
        terminated[i] = ended
        elapsed[i] += 1
        truncated[i] = elapsed[i] >= steps
