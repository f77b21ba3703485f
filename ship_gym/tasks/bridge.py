"""What every task has in common: commands, the measurements of a bridge, how an interval ends.

Kernels of one ship; the loop over ships that calls them is ``envs.interval``.
"""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np

from ship_gym.conventions import DELTA, FLOW_TORQUE, N
from ship_gym.physics._kernel import kernel
from ship_gym.physics.angles import cos_sin
from ship_gym.physics.propeller import shaft_power
from ship_gym.physics.quantities import record_type
from ship_gym.tasks.base import DIVERGED, RUNNING, Row, check_names
from ship_gym.tasks.rewards import COSTS
from ship_gym.tasks.sensors import measured

# psi_e as the task has it
OBSERVATIONS = (
    Row("sin_error", "sin(psi_e)", "-", -1.0, 1.0, "sine of the heading error", -1),
    Row("cos_error", "cos(psi_e)", "-", -1.0, 1.0, "cosine of the heading error", 1),
    Row("yaw_rate", "r L / U0", "-", -5.0, 5.0, "yaw rate, positive to starboard", -1),
    Row("surge", "u / U0", "-", -3.0, 3.0, "surge velocity through the water", 1),
    Row(
        "sway",
        "v / U0",
        "-",
        -3.0,
        3.0,
        "sway velocity through the water, positive to starboard",
        -1,
    ),
    Row("rudder", "delta / delta_max", "-", -1.0, 1.0, "rudder angle achieved", -1),
    Row("propeller", "n / n_max", "-", 0.0, 1.0, "propeller speed achieved", 1),
    Row("rudder_command", "delta_c / delta_max", "-", -1.0, 1.0, "last rudder command", -1),
    Row("propeller_command", "n_c / n_max", "-", 0.0, 1.0, "last propeller speed command", 1),
)


class BridgeView(NamedTuple):
    """The measurements of one ship, in the order of `OBSERVATIONS`."""

    sin_error: float
    cos_error: float
    yaw_rate: float
    surge: float
    sway: float
    rudder: float
    propeller: float
    rudder_command: float
    propeller_command: float


check_names("the rows of the bridge", BridgeView._fields, OBSERVATIONS)
N_BRIDGE = len(OBSERVATIONS)
# below zero only where the scenario lets the propeller brake
ASTERN_ROWS = ("propeller", "propeller_command")
_LOW = tuple(-1.0 if row.name in ASTERN_ROWS else row.low for row in OBSERVATIONS)
_HIGH = tuple(row.high for row in OBSERVATIONS)
_ASTERN = tuple(k for k, row in enumerate(OBSERVATIONS) if row.name in ASTERN_ROWS)

SATURATED = 0.999  # share of the largest rudder angle that counts as hard over

# What the record of every episode holds; a task adds its own fields and the weights of its terms.
_COMMON_FIELDS = (
    ("psi_ordered", np.float64),  # ordered heading or bearing of the active leg [rad]
    ("speed", np.float64),  # nominal speed U0 of the scenario [m/s]
    ("file_speed", np.float64),  # nominal speed of the ship herself [m/s]
    ("L", np.float64),  # length of the ship [m]
    ("n_order", np.float64),  # propeller speed without rpm control [rev/s]
    ("n_limit", np.float64),  # what the engine can still turn, either way [rev/s]
    ("astern", np.float64),  # largest propeller speed astern with rpm control, by n_max
    ("interval", np.float64),  # control interval [full-scale s]
    ("dt", np.float64),  # the same of the ship [s]
    ("steps", np.int64),  # intervals of an episode
    ("rudder_stroke", np.float64),  # largest rudder change in one interval [rad]
    ("noisy", np.int64),
    ("noise_key", np.int64),
    ("heading_bias", np.float64),  # [rad]
    ("gyro_fails", np.int64),  # whether it may lose heading and yaw rate: by chance, by failure
    ("dropout_chance", np.float64),  # that it does in an interval
    ("dropout_steps", np.int64),  # for how many intervals
    ("lost_until", np.int64),  # interval from which it shows them again
    ("held_heading", np.float64),  # what it showed last [rad], [rad/s]
    ("held_yaw_rate", np.float64),
    ("heading_noise", np.float64),  # standard deviations [rad], [rad/s], [m/s], [m]
    ("yaw_rate_noise", np.float64),
    ("speed_noise", np.float64),
    ("position_noise", np.float64),
    ("wave_height", np.float64),  # what the sea of this episode is: H_s [m], T_p [s],
    ("wave_period", np.float64),
    ("wave_to", np.float64),  # direction the waves go to [rad]
)


COMMON_FIELDS = tuple(name for name, _ in _COMMON_FIELDS)


def record_dtype(task) -> np.dtype:
    """Type of the record of one episode: common fields, weights of the reward, the task's own."""
    weights = ((term.name, np.float64) for term in (*task.terms, *COSTS))
    return _record_dtype((*_COMMON_FIELDS, *weights, *task.fields))


@functools.cache
def _record_dtype(fields: tuple) -> np.dtype:
    """One object for each layout: numba takes 6 us a step to see that two are equal."""
    return record_type(list(fields))


# What an interval comes to and has cost, one record an episode.
RESULT_DTYPE = record_type(
    [
        ("reward", np.float64),
        ("error", np.float64),  # in the unit of the task
        ("power", np.float64),  # delivered at the start of the interval [W]
        ("energy", np.float64),  # since the reset [J]
        ("psi_ordered", np.float64),  # now, as in the record of the episode [rad]
        ("waves_outside", np.float64),  # as in the record of the sea
        ("cost", np.float64),  # safety cost: 1 for a saturated rudder or a failure
        ("elapsed", np.int64),  # intervals since the reset
        ("outcome", np.int64),
        ("terminated", np.bool_),
        ("truncated", np.bool_),
        ("success", np.bool_),
        ("failed", np.bool_),  # whether the failure of the scenario has begun
    ]
)


@kernel
def clear(result):
    """Make a result that of an episode which has just begun; nothing has failed."""
    result.reward, result.error = 0.0, 0.0
    result.power, result.energy, result.cost = 0.0, 0.0, 0.0
    result.elapsed, result.outcome = 0, RUNNING
    result.terminated, result.truncated, result.success = False, False, False
    result.failed = False


@kernel
def clipped(value, low, high):
    """Value limited to [low, high]."""
    return min(max(value, low), high)


@kernel
def command(action, ship, task):
    """Rudder [rad] and propeller speed [rev/s] of an action in [-1, 1].

    That is rudder / delta_max and, if there, rpm over [-astern n_max, n_max], but no further astern
    than the engine goes.
    """
    n = task.n_order
    if len(action) > 1:
        astern, engine = task.astern, ship.engine
        share = 0.5 * (clipped(action[1], -1.0, 1.0) + 1.0) * (1.0 + astern) - astern
        n = max(share * engine.n_max, -min(engine.n_astern, task.n_limit))
    return clipped(action[0], -1.0, 1.0) * ship.gear.delta_max, min(n, task.n_limit)


@kernel
def observe_bridge(state, waves, command, ship, sea, task, interval, row):
    """Write the measurements of one ship into `row`, limited to their declared bounds.

    That is what a task without rows of its own observes.

    Parameters
    ----------
    state : ndarray (8,)
    waves : ndarray (9,)
        ``physics.waves.WAVE_NAMES``.
    command : ndarray (2,)
        Rudder [rad], propeller speed [rev/s].
    ship, sea, task : record
        Of the ship, of its sea, of the episode (`record_dtype`).
    interval : int
        Intervals sailed since the reset.
    row : ndarray (rows,)
        Of the observation, float32; its first columns are written.

    Returns
    -------
    Measured
    """
    seen = measured(state, waves, sea, task, interval)
    cos_error, sin_error = cos_sin(seen.psi - task.psi_ordered)
    values = BridgeView(
        sin_error=sin_error,
        cos_error=cos_error,
        yaw_rate=seen.r * ship.hull.L / task.speed,
        surge=seen.u / task.speed,
        sway=seen.v / task.speed,
        rudder=state[DELTA] / ship.gear.delta_max,
        propeller=state[N] / ship.engine.n_max,
        rudder_command=command[0] / ship.gear.delta_max,
        propeller_command=command[1] / ship.engine.n_max,
    )
    for k in range(N_BRIDGE):
        row[k] = clipped(values[k], _LOW[k], _HIGH[k])
    for k in _ASTERN:  # the flow may drive a stopped propeller backwards
        if row[k] < -task.astern:
            row[k] = -task.astern
    return seen


@kernel
def settle(result, terms, error, own, paid, outcome, task):
    """Write what the interval just sailed comes to for one ship.

    Parameters
    ----------
    result : record
        `RESULT_DTYPE`; reward, error, flags and intervals are written.
    terms : ndarray (len(own) + len(paid),)
        Written.
    error : float
        In the task's own unit.
    own : tuple of float
        The task's terms.
    paid : Costs
        The cost terms.
    outcome : int
        `RUNNING` while the episode goes on.
    task : record
        Of the episode.
    """
    total = 0.0
    for k in range(len(own)):
        terms[k] = own[k]
        total += own[k]
    for k in range(len(paid)):
        terms[len(own) + k] = paid[k]
        total += paid[k]
    result.reward = total
    result.error = error
    result.terminated = outcome != RUNNING
    result.outcome = outcome
    result.elapsed += 1
    result.truncated = result.elapsed >= task.steps


@kernel
def account(state, before, flow, ship, task, good, failure, success, result):
    """Write what an interval has cost one ship into its result.

    Power is that at the start of the interval, of which torque and propeller speed `before` are.

    Parameters
    ----------
    state, before : ndarray (8,)
        At the end of the interval and at its start.
    flow : ndarray
        At the start, ``conventions.FLOW_OF_UNITS``.
    ship, task : record
    good : bool
        Whether the ship is one still, and what she has earned a number.
    failure, success : bool
        Whether the episode ends by a failure, and as it should.
    result : record
    """
    result.power = shaft_power(before[N], flow[FLOW_TORQUE]) if good else 0.0
    result.energy += max(result.power, 0.0) * task.dt  # a driven shaft gives nothing back
    saturated = abs(state[DELTA]) >= SATURATED * ship.gear.delta_max
    result.cost = 1.0 if saturated or failure else 0.0
    result.success = success


@kernel
def end_diverged(task, terms, result):
    """End the episode of one ship as diverged: nothing is paid for the interval but failing."""
    last = len(terms) - 1
    for k in range(last):
        terms[k] = 0.0
    terms[last] = -task.termination
    result.reward = terms[last]
    result.terminated, result.success = True, False
    result.outcome, result.cost = DIVERGED, 1.0
