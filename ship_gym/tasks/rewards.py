"""Terms of the reward that every task has: what steering costs, and what failing does.

One more term for all tasks is a row of `COSTS`, a field of `Costs` and its line in `costs`, before
those of the termination; its weight is then a key of the section ``reward``.
"""

from __future__ import annotations

import dataclasses
from typing import NamedTuple

from ship_gym.config import check_fields
from ship_gym.conventions import DELTA, PSI, U
from ship_gym.physics._kernel import kernel
from ship_gym.physics.dynamics import water_velocity
from ship_gym.tasks.base import Term, check_names

HEAVIEST = 1e9  # weight: the sum of all terms stays a number

COSTS = (
    Term("rudder", "delta^2 [rad^2]", "Of delta^2 [1/rad^2].", None),
    Term(
        "rudder_rate",
        "(rudder change / largest change in one interval)^2",
        "Of (rudder change / largest change in one interval)^2.",
        None,
    ),
    Term("speed_loss", "(1 - u / U0)^2 where u < U0", "Of (1 - u / U0)^2 where u < U0.", None),
    Term(
        "termination",
        "once, where a limit ends the episode",
        "Once, where a limit ends the episode.",
        None,
    ),
)


class Costs(NamedTuple):
    """The cost terms of one interval, each <= 0, in the order of `COSTS`."""

    rudder: float
    rudder_rate: float
    speed_loss: float
    termination: float


check_names("the terms of COSTS", Costs._fields, COSTS)


@kernel
def costs(state, before, sea, task, failed):
    """The cost terms of one interval.

    Parameters
    ----------
    state, before : ndarray (8,)
        At its end and at its start.
    sea : record
        Of the ship.
    task : record
        Of the episode, with the weights.
    failed : bool
        The episode ends because a limit was exceeded.
    """
    delta = state[DELTA]
    u_c, _ = water_velocity(state[PSI], sea)
    loss = max(0.0, 1.0 - (state[U] - u_c) / task.speed)
    rate = (delta - before[DELTA]) / task.rudder_stroke
    return Costs(
        rudder=-task.interval * task.rudder * delta * delta,
        rudder_rate=-task.interval * task.rudder_rate * rate * rate,
        speed_loss=-task.interval * task.speed_loss * loss * loss,
        termination=-task.termination if failed else 0.0,
    )


def reward_section(own: tuple[Term, ...]) -> type:
    """Frozen dataclass of the section ``reward`` of a task with terms of its `own`."""
    terms = sorted((*COSTS, *own), key=lambda term: term.default is not None)  # stable
    fields = [
        (term.name, float)
        if term.default is None
        else (term.name, float, dataclasses.field(default=term.default))
        for term in terms
    ]

    def check(self):
        ranges = dict.fromkeys((term.name for term in terms), (0.0, HEAVIEST, "-"))
        check_fields("reward", self, ranges)

    text = "\n".join(f"{term.name} : float\n    {term.meaning}" for term in terms)
    doc = f"Weights of the reward terms, per full-scale second.\n\nAttributes\n----------\n{text}\n"
    return dataclasses.make_dataclass(
        "Reward",
        fields,
        frozen=True,
        namespace={"__post_init__": check, "__doc__": doc, "__module__": __name__},
    )
