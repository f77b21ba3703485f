"""What every task has in common: commands, the nine measurements of a bridge, the reward's form.

Scalar kernels and the loops over them; the scalar environment is a batch of one. The loops are
serial: they take a fraction of the physics, and each start of threads is a place to wait where
cores are shared.
"""

from __future__ import annotations

import math

import numpy as np

from ship_gym.conventions import DELTA, FLOW_TORQUE, N
from ship_gym.physics._kernel import kernel
from ship_gym.physics.angles import wrapped
from ship_gym.physics.propeller import shaft_power
from ship_gym.tasks.sensors import measured

# symbol, unit, low, high, meaning; psi_e as the task has it
OBSERVATIONS = (
    ("sin(psi_e)", "-", -1.0, 1.0, "sine of the heading error"),
    ("cos(psi_e)", "-", -1.0, 1.0, "cosine of the heading error"),
    ("r L / U0", "-", -5.0, 5.0, "yaw rate, positive to starboard"),
    ("u / U0", "-", -3.0, 3.0, "surge velocity through the water"),
    ("v / U0", "-", -3.0, 3.0, "sway velocity through the water, positive to starboard"),
    ("delta / delta_max", "-", -1.0, 1.0, "rudder angle achieved"),
    ("n / n_max", "-", 0.0, 1.0, "propeller speed achieved"),
    ("delta_c / delta_max", "-", -1.0, 1.0, "last rudder command"),
    ("n_c / n_max", "-", 0.0, 1.0, "last propeller speed command"),
)
N_BRIDGE = len(OBSERVATIONS)
_LOW = tuple(row[2] for row in OBSERVATIONS)
_HIGH = tuple(row[3] for row in OBSERVATIONS)

# the first term is that of the task's error
COST_TERMS = ("rudder", "rudder_rate", "speed_loss", "termination")
N_TERMS = 1 + len(COST_TERMS)

RUNNING, HEADING_LIMIT, TRACK_LIMIT, ARRIVED = 0, 1, 2, 3
SATURATED = 0.999  # share of the largest rudder angle that counts as hard over
OUTCOMES = ("running", "heading limit", "cross-track limit", "arrived")

TASK_DTYPE = np.dtype(
    (
        np.record,
        [
            ("psi_ordered", np.float64),  # ordered heading or bearing of the active leg [rad]
            ("speed", np.float64),  # nominal speed U0 [m/s]
            ("L", np.float64),  # length of the ship [m]
            ("n_order", np.float64),  # propeller speed without rpm control [rev/s]
            ("n_limit", np.float64),  # what the engine can still turn [rev/s]
            ("interval", np.float64),  # control interval [full-scale s]
            ("rudder_stroke", np.float64),  # largest rudder change in one interval [rad]
            ("heading_limit", np.float64),  # error that ends the episode: [rad] ...
            ("cross_limit", np.float64),  # ... and [m]
            ("error", np.float64),  # weights of the reward terms
            *((name, np.float64) for name in COST_TERMS),
            ("noisy", np.int64),
            ("noise_key", np.int64),
            ("heading_bias", np.float64),  # [rad]
            ("heading_noise", np.float64),  # standard deviations [rad], [rad/s], [m/s], [m]
            ("yaw_rate_noise", np.float64),
            ("speed_noise", np.float64),
            ("position_noise", np.float64),
            ("active", np.int64),  # active leg or order, and how many there are
            ("count", np.int64),
            ("next_change", np.float64),  # course: interval at which the next order comes
            ("x_a", np.float64),  # track: ends of the active leg [m]
            ("y_a", np.float64),
            ("x_b", np.float64),
            ("y_b", np.float64),
            ("turn", np.float64),  # course change at its end [rad]
            ("acceptance", np.float64),  # [m]
            ("look_ahead", np.float64),  # [m]
            ("wave_height", np.float64),  # what the sea of this episode is: H_s [m], T_p [s],
            ("wave_period", np.float64),
            ("wave_to", np.float64),  # direction the waves go to [rad]
        ],
    )
)


@kernel
def clipped(value, low, high):
    """Value limited to [low, high]."""
    return min(max(value, low), high)


@kernel
def reward_terms(error, delta, stroke, u, task, failed):
    """The five terms of one interval, each <= 0: error, rudder, rudder rate, speed, termination.

    Parameters
    ----------
    error : float
        Heading error [rad] or cross-track error [L].
    delta, stroke : float
        Rudder angle and its change during the interval [rad].
    u : float
        Surge velocity through the water [m/s].
    failed : bool
        The episode ends because a limit was exceeded.
    """
    loss = max(0.0, 1.0 - u / task.speed)
    rate = stroke / task.rudder_stroke
    return (
        -task.interval * task.error * error * error,
        -task.interval * task.rudder * delta * delta,
        -task.interval * task.rudder_rate * rate * rate,
        -task.interval * task.speed_loss * loss * loss,
        -task.termination if failed else 0.0,
    )


@kernel
def command_batch(actions, states, ships, tasks, commands, rudder_before, n_before):
    """Actions in [-1, 1] to commands: rudder / delta_max and, if there, rpm from [0, n_max].

    Keeps rudder angle and propeller speed at the start of the interval. Returns how many rows are
    finite.
    """
    good = 0
    for i in range(actions.shape[0]):
        rudder_before[i], n_before[i] = states[i, DELTA], states[i, N]
        commands[i, 0] = clipped(actions[i, 0], -1.0, 1.0) * ships[i].gear.delta_max
        n = tasks[i].n_order
        finite = math.isfinite(actions[i, 0])
        if actions.shape[1] > 1:
            n = 0.5 * (clipped(actions[i, 1], -1.0, 1.0) + 1.0) * ships[i].engine.n_max
            finite = finite and math.isfinite(actions[i, 1])
        commands[i, 1] = min(n, tasks[i].n_limit)
        good += 1 if finite else 0
    return good


@kernel
def observe_bridge(state, waves, command, ship, sea, task, interval, row):
    """Write the nine measurements of one ship into `row`, limited to their declared bounds.

    Returns what `measured` saw.
    """
    seen = measured(state, waves, sea, task, interval)
    psi_e = wrapped(seen[0] - task.psi_ordered)
    values = (
        math.sin(psi_e),
        math.cos(psi_e),
        seen[1] * ship.hull.L / task.speed,
        seen[2] / task.speed,
        seen[3] / task.speed,
        state[DELTA] / ship.gear.delta_max,
        state[N] / ship.engine.n_max,
        command[0] / ship.gear.delta_max,
        command[1] / ship.engine.n_max,
    )
    for k in range(9):
        row[k] = clipped(values[k], _LOW[k], _HIGH[k])
    return seen


@kernel
def settle(i, error, found, outcome, verdict, terms):
    """Write reward, terms and flags of the interval just sailed by ship i.

    `verdict` holds rewards, terminated, truncated, elapsed, outcomes and errors, each (n,) and
    written, and the number of intervals of an episode.
    """
    rewards, terminated, truncated, elapsed, outcomes, errors, steps = verdict
    errors[i] = error
    total = 0.0
    for k in range(5):
        terms[i, k] = found[k]
        total += found[k]
    rewards[i] = total
    terminated[i] = outcome != 0
    outcomes[i] = outcome
    elapsed[i] += 1
    truncated[i] = elapsed[i] >= steps


@kernel
def account_batch(states, n_before, flow, ships, dt, verdict, must_arrive, ledger):
    """Write what an interval has cost: `ledger` holds power [W], energy since the reset [J], the
    safety cost and success, each (n,).

    Power is that at the start of the interval, of which torque and `n_before` [rev/s] are. Success
    is to reach the end of the episode in `heading` tasks, the last way-point in tracks.
    """
    _, _, truncated, _, outcomes, _, _ = verdict
    power, energy, cost, success = ledger
    for i in range(states.shape[0]):
        power[i] = shaft_power(n_before[i], flow[i, FLOW_TORQUE])
        energy[i] += power[i] * dt[i]
        limit = outcomes[i] == HEADING_LIMIT or outcomes[i] == TRACK_LIMIT
        saturated = abs(states[i, DELTA]) >= SATURATED * ships[i].gear.delta_max
        cost[i] = 1.0 if saturated or limit else 0.0
        success[i] = outcomes[i] == ARRIVED if must_arrive else truncated[i] and not limit
