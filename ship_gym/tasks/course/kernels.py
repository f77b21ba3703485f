"""Steps of the ordered heading: judged as a heading, and by how far the ship swings past one."""

from __future__ import annotations

import math

import numpy as np

from ship_gym.physics._kernel import kernel
from ship_gym.tasks.base import RUNNING
from ship_gym.tasks.heading import kernels as heading

OVERSHOOT_LIMIT = 3  # outcome, behind that of a heading
# Before those of a heading: numba would take a record that begins like another one for it.
FIELDS = (
    ("overshoot_limit", np.float64),  # how far past the order a turn may swing [rad]; inf: any
    ("swing", np.float64),  # side of the turn to the order, 1 starboard; 0 once it is over
    ("passed", np.int64),  # whether the ship has passed the order on it
    *heading.FIELDS,
)


@kernel
def overshot(psi_e, task):
    """Whether the first swing past the order has gone too far; it is over with the way back."""
    beyond = task.swing * psi_e
    if beyond > 0.0:
        task.passed = 1
    elif beyond < 0.0 and task.passed == 1:
        task.swing = 0.0
    return beyond > task.overshoot_limit


@kernel
def judge(state, before, sea, task, plan, terms, result):
    """As ``heading.kernels.judge``, with the limit of the overshoot."""
    psi_e = heading.error(state, task)
    outcome = heading.outcome_of(psi_e, task)
    if overshot(psi_e, task) and outcome == RUNNING:
        outcome = OVERSHOOT_LIMIT
    order = task.active
    heading.conclude(psi_e, outcome, state, before, sea, task, plan, terms, result)
    if task.active != order:
        task.swing, task.passed = -math.copysign(1.0, heading.error(state, task)), 0


@kernel
def begin(task, plan):
    """Give the first order of an episode, whose plan is written; that is no step."""
    heading.give_order(task, plan, 0)
    task.swing, task.passed = 0.0, 0
