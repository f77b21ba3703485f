"""One control interval of one ship: the seam between the card and the kernels of the package.

No equation stands here. What a thread does is done to row i of every array, by the functions that
the loops of the CPU call, on slices of one row. It is ordinary `kernel` code, which the CPU runs as
well; only ``threads`` knows of a card.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ship_gym.physics._kernel import kernel
from ship_gym.physics.quantities import Around, Controls, Tables
from ship_gym.physics.step import see_waves, state_of, step_one, waves_of
from ship_gym.tasks import bridge, privileged

if TYPE_CHECKING:
    from ship_gym.tasks.base import Task

ENDED, REFUSED, UNNAMED = range(3)  # what is counted: episodes, actions not finite, outcomes
N_COUNTS = 3
_FIRST = (0,)  # the one row of a slice
_N_PRIVILEGED = len(privileged.OBSERVATIONS)


class Fleet(NamedTuple):
    """Arrays of n ships on the card, as ``ShipSim`` and ``EpisodeBatch`` name them."""

    states: np.ndarray
    before: np.ndarray
    commands: np.ndarray
    times: np.ndarray
    clock: np.ndarray
    ships: np.ndarray
    seas: np.ndarray
    waves: np.ndarray
    met: np.ndarray
    forces: np.ndarray
    flow: np.ndarray
    tasks: np.ndarray
    plans: np.ndarray
    terms: np.ndarray
    results: np.ndarray
    observations: np.ndarray
    lost: np.ndarray


class Shared(NamedTuple):
    """Tables that all ships share."""

    open_water: np.ndarray
    deflected: np.ndarray
    groups: np.ndarray
    response: np.ndarray
    winds: np.ndarray
    failed: np.ndarray
    reached: np.ndarray


class Failing(NamedTuple):
    """The failure of the scenario: from which interval, and what it does."""

    fails_at: int
    heading_bias: float  # [rad]
    propeller_speed: float  # of n_order; infinity: the engine is sound
    rudder_rate: float  # of the rate before


@kernel
def order_and_sail(i, fleet, shared, actions):
    """Take the action of ship i and sail one interval; 1, or 0 if the action is not finite."""
    j = i + 1
    good = bridge.command_batch(
        actions[i:j], fleet.states[i:j], fleet.ships[i:j], fleet.tasks[i:j],
        fleet.commands[i:j], fleet.before[i:j],
    )  # fmt: skip
    if good == 1:
        sail(i, fleet, shared)
    return good


@kernel
def sail(i, fleet, shared):
    """Move ship i by one control interval, as ``physics.step.step_batch`` does."""
    ship, sea = fleet.ships[i], fleet.seas[i]
    tables = Tables(shared.open_water[ship.kind], shared.deflected[ship.kind])
    around = Around(
        fleet.waves[i], shared.groups, shared.response[sea.response], shared.winds[sea.wind_table]
    )
    steps = int(fleet.clock[i, 1])
    tick = (fleet.times[i], fleet.clock[i, 0], steps)
    command = Controls(fleet.commands[i, 0], fleet.commands[i, 1])
    state, parts, flow, met = step_one(
        state_of(fleet.states, i), command, tick, ship, sea, tables, around, waves_of(fleet.met, i)
    )
    for k in range(len(state)):
        fleet.states[i, k] = state[k]
    for k in range(len(parts)):
        fleet.forces[i, k, 0], fleet.forces[i, k, 1], fleet.forces[i, k, 2] = parts[k]
    for k in range(fleet.flow.shape[1]):
        fleet.flow[i, k] = flow[k]
    for k in range(len(met)):
        fleet.met[i, k] = met[k]
    fleet.times[i] += fleet.clock[i, 0] * steps


@kernel
def see(i, fleet, shared):
    """Refresh the waves that ship i meets."""
    j = i + 1
    see_waves(
        _FIRST, fleet.times[i:j], fleet.states[i:j], fleet.seas[i:j], fleet.waves[i:j],
        shared.groups, shared.response, shared.winds, fleet.met[i:j],
    )  # fmt: skip


@kernel
def account(i, fleet, shared):
    """What the interval has cost ship i: 1 if she is lost, -1 for an outcome without a name."""
    j = i + 1
    return bridge.account_batch(
        fleet.states[i:j], fleet.before[i:j], fleet.flow[i:j], fleet.ships[i:j], fleet.seas[i:j],
        fleet.tasks[i:j], shared.failed, shared.reached, fleet.results[i:j], fleet.lost[i:j],
    )  # fmt: skip


@kernel
def end_lost(i, fleet, shared):
    """End the episode of a ship that is none any more, as ``EpisodeBatch`` does."""
    j = i + 1
    for k in range(fleet.states.shape[1]):
        fleet.states[i, k] = fleet.before[i, k]
    for k in range(fleet.forces.shape[1]):
        for axis in range(fleet.forces.shape[2]):
            if not math.isfinite(fleet.forces[i, k, axis]):
                fleet.forces[i, k, axis] = 0.0
    for k in range(fleet.flow.shape[1]):
        if not math.isfinite(fleet.flow[i, k]):
            fleet.flow[i, k] = 0.0
    see(i, fleet, shared)
    bridge.end_diverged(_FIRST, fleet.tasks[i:j], fleet.terms[i:j], fleet.results[i:j])


@kernel
def begin_failure(i, fleet, failing):
    """Let the failure of the scenario begin where it is time, as ``EpisodeBatch`` does."""
    if fleet.results[i].elapsed == failing.fails_at:
        task = fleet.tasks[i]
        task.heading_bias = failing.heading_bias
        if failing.propeller_speed < math.inf:
            task.n_limit = failing.propeller_speed * task.n_order
        fleet.ships[i].gear.rate *= failing.rudder_rate


@kernel
def see_privileged(i, fleet):
    """Sea and forces of ship i in the last columns of her observation."""
    j = i + 1
    first = fleet.observations.shape[1] - _N_PRIVILEGED
    privileged.observe_batch(
        fleet.states[i:j], fleet.forces[i:j], fleet.ships[i:j], fleet.seas[i:j],
        fleet.tasks[i:j], first, fleet.observations[i:j],
    )  # fmt: skip


@kernel
def no_error(which, states, tasks, errors):
    """Error of a task that has none: it stays."""


def settling(task: Task, with_privileged: bool) -> Callable:
    """Function, not yet compiled, that judges an interval for one ship, after `order_and_sail`.

    Returns
    -------
    callable
        ``settle(i, fleet, shared, failing)``: 1 if the episode has ended, -1 for an outcome that
        the task does not name, else 0.
    """
    judge, observe, error = task.judge, task.observe, task.error or no_error

    def settle(i, fleet, shared, failing):
        j = i + 1
        states, tasks, results = fleet.states[i:j], fleet.tasks[i:j], fleet.results[i:j]
        judge(
            states, fleet.before[i:j], fleet.seas[i:j], tasks, fleet.plans[i:j], fleet.terms[i:j],
            results,
        )  # fmt: skip
        lost = account(i, fleet, shared)
        if lost < 0:
            return -1
        if lost > 0:
            end_lost(i, fleet, shared)
            error(_FIRST, states, tasks, results["error"])
        begin_failure(i, fleet, failing)
        observe(
            states, fleet.met[i:j], fleet.commands[i:j], fleet.ships[i:j], fleet.seas[i:j], tasks,
            results["elapsed"], fleet.observations[i:j],
        )  # fmt: skip
        if with_privileged:
            see_privileged(i, fleet)
        return 1 if fleet.results[i].terminated or fleet.results[i].truncated else 0

    return settle
