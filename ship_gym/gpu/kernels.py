"""One control interval of one ship: the seam between the card and the loops of the package.

No equation stands here. A thread calls the loops of the CPU for a batch of one ship (``rows``).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

from ship_gym.envs.interval import BAD_ACTION, BAD_OUTCOME, Episodes, loops_of
from ship_gym.physics._kernel import kernel
from ship_gym.physics.step import Fleet, see_waves

if TYPE_CHECKING:
    from ship_gym.tasks.base import Task

RUNNING, ENDED, REFUSED, UNNAMED = range(4)  # an action not finite; an outcome without a name
N_COUNTS = 4
_FIRST = (0,)  # the one row


class Batch(NamedTuple):
    """Everything of n episodes."""

    fleet: Fleet
    episodes: Episodes


@kernel
def give_back(fleet, episodes):
    """Give a ship that is none any more her last state, and loads that are finite."""
    for k in range(fleet.state.shape[1]):
        fleet.state[0, k] = episodes.before[0, k]
    for k in range(fleet.forces.shape[1]):
        for axis in range(fleet.forces.shape[2]):
            if not math.isfinite(fleet.forces[0, k, axis]):
                fleet.forces[0, k, axis] = 0.0
    for k in range(fleet.flow.shape[1]):
        if not math.isfinite(fleet.flow[0, k]):
            fleet.flow[0, k] = 0.0


def interval_of_one(task: Task) -> Callable:
    """Function, not yet compiled, that sails an interval of an episode, as ``EpisodeBatch.step``.

    Returns
    -------
    callable
        ``sail(batch)`` of a `Batch` of one ship: `RUNNING`, `ENDED`, `REFUSED` or `UNNAMED`.
    """
    loops = loops_of(task)
    interval, end, observe = loops["interval"], loops["end"], loops["observe"]

    def sail(batch):
        fleet, episodes = batch.fleet, batch.episodes
        lost = interval(0, 1, fleet, episodes)
        if lost == BAD_ACTION:
            return REFUSED
        if lost == BAD_OUTCOME:
            return UNNAMED
        if lost > 0:
            give_back(fleet, episodes)
            see_waves(_FIRST, fleet)
            end(_FIRST, fleet, episodes)
            observe(_FIRST, fleet, episodes)
        result = episodes.results[0]
        return ENDED if result.terminated or result.truncated else RUNNING

    return sail
