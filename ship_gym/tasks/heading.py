"""Headings: keeping one (``heading_keeping``) and following steps of it (``course_changing``)."""

from __future__ import annotations

from ship_gym.conventions import DELTA, PSI, U
from ship_gym.physics._kernel import kernel
from ship_gym.physics.angles import wrapped
from ship_gym.physics.dynamics import water_velocity
from ship_gym.tasks.bridge import (
    COST_TERMS,
    HEADING_LIMIT,
    RUNNING,
    observe_bridge,
    reward_terms,
    settle,
)

REWARD_TERMS = ("heading", *COST_TERMS)
# columns of the plan of an episode: interval from which an order holds, ordered heading [rad]
FROM, ORDER = 0, 1


@kernel
def observe_batch(states, waves, commands, ships, seas, tasks, elapsed, observations):
    """Observation of every ship, float32, into the first nine columns."""
    for i in range(states.shape[0]):
        observe_bridge(
            states[i], waves[i], commands[i], ships[i], seas[i], tasks[i], elapsed[i],
            observations[i],
        )  # fmt: skip


@kernel
def give_order(task, plan, k):
    """Make order k of the plan (orders, 2) the ordered heading."""
    task.active = k
    task.psi_ordered = plan[k, ORDER]
    task.next_change = plan[k + 1, FROM] if k + 1 < task.count else -1.0


@kernel
def judge_batch(states, rudder_before, seas, tasks, plans, terms, verdict):
    """Reward terms (n, 5) and verdict (``bridge.settle``) of the interval just sailed.

    It is judged by the order that held during it; then the next one is given, if it is its time.
    """
    _, _, _, elapsed, _, _, _ = verdict
    for i in range(states.shape[0]):
        task, psi, delta = tasks[i], states[i, PSI], states[i, DELTA]
        u_c, _ = water_velocity(psi, seas[i])
        psi_e = wrapped(psi - task.psi_ordered)
        outcome = HEADING_LIMIT if abs(psi_e) > task.heading_limit else RUNNING
        stroke = delta - rudder_before[i]
        found = reward_terms(psi_e, delta, stroke, states[i, U] - u_c, task, outcome != RUNNING)
        settle(i, psi_e, found, outcome, verdict, terms)
        if 0.0 < task.next_change <= elapsed[i]:
            give_order(task, plans[i], task.active + 1)


@kernel
def begin_batch(which, tasks, plans):
    """Give the first order of some episodes, whose plans are written."""
    for i in which:
        give_order(tasks[i], plans[i], 0)
