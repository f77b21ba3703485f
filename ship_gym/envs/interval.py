"""One control interval of a batch in one compiled call, and what begins an episode.

The loops here call the kernels of a task by name; `kernels_of` makes them the task's own.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ship_gym.conventions import DELTA, PSI, N, R, U, V, X, Y
from ship_gym.physics._kernel import direct, kernel, specialised
from ship_gym.physics._threads import BLOCK
from ship_gym.physics.dynamics import water_velocity
from ship_gym.physics.step import Fleet, sail, thread_of
from ship_gym.tasks import privileged
from ship_gym.tasks.base import Task
from ship_gym.tasks.bridge import account, clear, command, end_diverged

_NONE = np.zeros(0, np.int64)
BAD_ACTION, BAD_OUTCOME = -(2**62), -(2**31)  # instead of how many have diverged


class Failure(NamedTuple):
    """The failure of the scenario.

    The interval at which it begins, -1: never; error of the compass [rad]; share of the
    self-propulsion speed that the engine can still turn, -1: as before; share of the rudder rate
    that is left; for how many intervals the gyro is lost.
    """

    at: int
    heading_bias: float
    propeller: float
    rudder: float
    dropout: int


class Episodes(NamedTuple):
    """Everything of n episodes that an interval reads and writes beside the `Fleet`.

    ``actions`` (n, 1 or 2); ``before`` (threads * BLOCK, 8), the states of one block of each thread
    at its start; ``tasks``, ``results``, structured (n,), ``tasks.bridge``; ``plans`` (n, rows,
    columns); ``terms`` (n, terms); ``observations`` (n, rows), float32; ``failed``, ``reached``
    (outcomes,), which outcomes are failures and which the aim, none of the latter: a task without;
    ``diverged`` (n,), written: the ships that are none any more; the `Failure`; the first
    privileged column, 0: none.
    """

    actions: np.ndarray
    before: np.ndarray
    tasks: np.ndarray
    results: np.ndarray
    plans: np.ndarray
    terms: np.ndarray
    observations: np.ndarray
    failed: np.ndarray
    reached: np.ndarray
    diverged: np.ndarray
    failure: Failure
    privileged_from: int


# What a task without these has; the names stand in the loops for the kernels of a task.


@kernel
def begin(task, plan):
    """Nothing to begin."""


@kernel
def error(state, task):
    """No error."""
    return 0.0


@kernel
def observe(state, waves, command, ship, sea, task, interval, row):
    """Nothing to see; every task has its own."""


@kernel
def judge(state, before, sea, task, plan, terms, result):
    """Nothing to judge; every task has its own."""


@kernel
def fail(task, ship, failure, result):
    """Let the failure of the scenario begin where it is time."""
    result.failed = 0 <= failure.at <= result.elapsed
    if result.elapsed == failure.at:
        task.heading_bias = failure.heading_bias
        if failure.propeller >= 0.0:
            task.n_limit = failure.propeller * task.n_order
        ship.gear.rate *= failure.rudder
        if failure.dropout > 0:
            task.lost_until = result.elapsed + failure.dropout


@kernel
def all_finite(values):
    """Whether all numbers of an array (n, m) are finite."""
    total = 0.0
    for i in range(values.shape[0]):
        for k in range(values.shape[1]):
            total += 0.0 * values[i, k]  # nan of what is not finite
    return total == 0.0


@kernel
def keep(state, kept):
    """Copy a row."""
    for k in range(len(kept)):
        kept[k] = state[k]


@kernel
def any_of(flags):
    """Whether any of them is set; numpy's would load numba's linear algebra in each process."""
    for k in range(len(flags)):
        if flags[k]:
            return True
    return False


def _interval(first, last, fleet, episodes):
    """Sail one control interval of the episodes from `first` up to `last`.

    A block of ships at a time, which stays near the processor from its actions to what is seen. A
    ship that is none any more (``fleet.lost``), or whose reward or error is no number, gets back
    its last state; it is not observed, and its episode not ended: `diverged` tells.

    Returns
    -------
    int
        How many have diverged; `BAD_ACTION`, where any action of the whole batch is not finite:
        nothing is sailed; `BAD_OUTCOME`: an outcome that the task does not name.
    """
    e = episodes
    if not all_finite(e.actions):
        return BAD_ACTION
    has_aim, lost = any_of(e.reached), 0
    thread = thread_of(first, e.actions.shape[0], e.before.shape[0] // BLOCK)
    for start in range(first, last, BLOCK):
        stop, kept = min(start + BLOCK, last), thread * BLOCK - start  # row kept + i of `before`
        for i in range(start, stop):
            keep(fleet.state[i], e.before[kept + i])
            rudder, rpm = command(e.actions[i], fleet.ships[i], e.tasks[i])
            fleet.commands[i, 0], fleet.commands[i, 1] = rudder, rpm
        sail(start, stop, fleet)
        for i in range(start, stop):
            state, ship, sea = fleet.state[i], fleet.ships[i], fleet.seas[i]
            task, result, before = e.tasks[i], e.results[i], e.before[kept + i]
            judge(state, before, sea, task, e.plans[i], e.terms[i], result)
            if result.outcome < 0 or result.outcome >= len(e.failed):
                return BAD_OUTCOME
            good = not fleet.lost[i] and math.isfinite(result.reward + result.error)
            failure = e.failed[result.outcome]
            success = result.truncated and not failure
            if has_aim:
                success = e.reached[result.outcome]
            account(state, before, fleet.flow[i], ship, task, good, failure, success, result)
            fail(task, ship, e.failure, result)
            result.psi_ordered = task.psi_ordered
            e.diverged[i] = not good
            if not good:
                lost += 1
                keep(before, state)
                continue
            row, interval = e.observations[i], result.elapsed
            observe(state, fleet.met[i], fleet.commands[i], ship, sea, task, interval, row)
            if e.privileged_from > 0:
                privileged.observe(state, fleet.forces[i], ship, sea, task, e.privileged_from, row)
    return lost


def _begin(which, fleet, episodes):
    """Begin episodes whose plans are written: the first order, the first leg."""
    for i in which:
        begin(episodes.tasks[i], episodes.plans[i])


def _start(which, starts, fleet, episodes):
    """Put ships of some episodes where these start; ``tasks``, ships and currents are set before.

    Parameters
    ----------
    which : ndarray (m,)
    starts : ndarray (m, 4)
        North, east [m], heading [rad] and speed through the water [m/s].
    """
    e = episodes
    for row in range(len(which)):
        i = which[row]
        state, task, result = fleet.state[i], e.tasks[i], e.results[i]
        u_c, v_c = water_velocity(starts[row, 2], fleet.seas[i])
        state[U], state[V], state[R] = starts[row, 3] + u_c, 0.0 + v_c, 0.0
        state[X], state[Y], state[PSI] = starts[row, 0], starts[row, 1], starts[row, 2]
        state[DELTA], state[N] = 0.0, task.n_order
        fleet.time[i] = 0.0
        fleet.commands[i, 0], fleet.commands[i, 1] = 0.0, task.n_order
        fleet.forces[i, :, :] = 0.0
        fleet.flow[i, :] = 0.0
        e.terms[i, :] = 0.0
        task.n_limit, task.heading_bias, task.lost_until = np.inf, 0.0, 0
        clear(result)
        result.error = error(state, task)
        result.psi_ordered, result.waves_outside = task.psi_ordered, fleet.seas[i].waves_outside
        fail(task, fleet.ships[i], e.failure, result)


def _observe(which, fleet, episodes):
    """Refresh the observations of some episodes."""
    e = episodes
    for i in which:
        state, ship, sea, task = fleet.state[i], fleet.ships[i], fleet.seas[i], e.tasks[i]
        row, interval = e.observations[i], e.results[i].elapsed
        observe(state, fleet.met[i], fleet.commands[i], ship, sea, task, interval, row)
        if e.privileged_from > 0:
            privileged.observe(state, fleet.forces[i], ship, sea, task, e.privileged_from, row)


def _end(which, fleet, episodes):
    """End some episodes as diverged, whose ships have their last states back."""
    e = episodes
    for i in which:
        end_diverged(e.tasks[i], e.terms[i], e.results[i])
        found = error(fleet.state[i], e.tasks[i])
        e.results[i].error = found if math.isfinite(found) else 0.0


@functools.cache
def loops_of(task: Task) -> dict[str, Callable]:
    """The loops with the kernels of a task, by name; compiled at their first use."""
    own = {"judge": task.judge, "observe": task.observe}
    if task.begin is not None:
        own["begin"] = task.begin
    if task.error is not None:
        own["error"] = task.error
    loops: dict[str, Callable] = {
        "interval": _interval,
        "begin": _begin,
        "start": _start,
        "observe": _observe,
    }
    loops["end"] = _end
    return {name: specialised(loop, f"{name}_{task.name}", **own) for name, loop in loops.items()}


class Loops:
    """The loops of a task over the arrays of one batch, by their names.

    Parameters
    ----------
    task : Task
    fleet : Fleet
    episodes : Episodes
    """

    def __init__(self, task: Task, fleet: Fleet, episodes: Episodes):
        self._task, self.fleet, self.episodes = task, fleet, episodes

    def _bound(self, name: str, *first: Any) -> Callable:
        """A loop, to be called with what stands before the arrays and has the types of `first`."""
        arrays = (self.fleet, self.episodes)
        run = direct(loops_of(self._task)[name], (*first, *arrays))
        return lambda *given: run(*given, *arrays)

    @functools.cached_property
    def interval(self) -> Callable[[int, int], int]:
        """`_interval` of a range of episodes."""
        return self._bound("interval", 0, 0)

    @functools.cached_property
    def begin(self) -> Callable[[np.ndarray], None]:
        """`_begin` of some episodes."""
        return self._bound("begin", _NONE)

    @functools.cached_property
    def start(self) -> Callable[[np.ndarray, np.ndarray], None]:
        """`_start` of some episodes."""
        return self._bound("start", _NONE, np.zeros((0, 4)))

    @functools.cached_property
    def observe(self) -> Callable[[np.ndarray], None]:
        """`_observe` of some episodes."""
        return self._bound("observe", _NONE)

    @functools.cached_property
    def end(self) -> Callable[[np.ndarray], None]:
        """`_end` of some episodes."""
        return self._bound("end", _NONE)
