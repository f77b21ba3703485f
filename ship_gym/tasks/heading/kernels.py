"""Headings: keeping one (``heading_keeping``) and following steps of it (``course_changing``)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ship_gym.conventions import PSI
from ship_gym.physics._kernel import kernel
from ship_gym.physics.angles import wrapped
from ship_gym.tasks.base import RUNNING, Term, check_names
from ship_gym.tasks.bridge import settle
from ship_gym.tasks.rewards import costs

HEADING_LIMIT = 2  # outcome
TERMS = (Term("heading", "psi_e^2 [rad^2]", "Of psi_e^2 [1/rad^2]."),)
FIELDS = (
    ("active", np.int64),  # number of the order that holds now, and how many there are
    ("count", np.int64),
    ("next_change", np.float64),  # interval at which the next order comes
    ("heading_limit", np.float64),  # error that ends the episode [rad]
)


class HeadingTerms(NamedTuple):
    """Terms of the reward that are a heading's own, in the order of `TERMS`."""

    heading: float


check_names("the terms of a heading", HeadingTerms._fields, TERMS)
# columns of the plan of an episode: interval from which an order holds, ordered heading [rad]
FROM, ORDER = 0, 1


@kernel
def error(state, task):
    """Heading error [rad] of one ship."""
    return wrapped(state[PSI] - task.psi_ordered)


@kernel
def give_order(task, plan, k):
    """Make order k of the plan (orders, 2) the ordered heading."""
    task.active = k
    task.psi_ordered = plan[k, ORDER]
    task.next_change = plan[k + 1, FROM] if k + 1 < task.count else -1.0


@kernel
def outcome_of(psi_e, task):
    """What a heading error [rad] comes to."""
    return HEADING_LIMIT if abs(psi_e) > task.heading_limit else RUNNING


@kernel
def judge(state, before, sea, task, plan, terms, result):
    """Terms (n,) and result of the interval just sailed by one ship, the error [rad] in it."""
    psi_e = error(state, task)
    conclude(psi_e, outcome_of(psi_e, task), state, before, sea, task, plan, terms, result)


@kernel
def conclude(psi_e, outcome, state, before, sea, task, plan, terms, result):
    """Write what an interval with the heading error psi_e [rad] at its end comes to.

    It is judged by the order that held during it; then the next one is given, if it is its time.
    """
    own = HeadingTerms(heading=-task.interval * task.heading * psi_e * psi_e)
    paid = costs(state, before, sea, task, outcome != RUNNING)
    settle(result, terms, psi_e, own, paid, outcome, task)
    if 0.0 < task.next_change <= result.elapsed:
        give_order(task, plan, task.active + 1)


@kernel
def begin(task, plan):
    """Give the first order of an episode, whose plan is written."""
    give_order(task, plan, 0)
