"""What an optimum is sought for: measures that are means of squares, as residuals.

A measure with an objective here can be bounded by ``ship_gym.evaluation.bound``; a task needs an
entry in `ERRORS` for it.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.envs.episodes import EpisodeBatch
from ship_gym.evaluation.voyages import Voyages
from ship_gym.scenarios.scenario import Scenario
from ship_gym.tasks import TASKS
from ship_gym.tasks.measures import LAMBDAS, turning

RATE_TIME = 10.0  # [full-scale s] that makes of a rudder rate an angle: of a weight on the rate
_BEYOND = 60.0  # sailed after the end, so that letting go before it does not pay [full-scale s]
_TURNING = (
    0.001  # weight of the turns where the steady part is judged: it settles what else is free
)
# Of delta [1/rad^2] where the measure has none, so that the optimum is one: 1e-3 of (e / L)^2.
_TINY = 1e-3


class Error(NamedTuple):
    """The error of a task, from ``EpisodeBatch.errors``.

    ``unit(scenario, batch)``: what one unit of the measure is in that of the batch, a number or
    (m,); ``limit(scenario)``: error at which an episode fails, in the unit of the measure;
    ``turns``: whether there are orders, with a turn after each.
    """

    unit: Callable[[Scenario, EpisodeBatch], float | np.ndarray]
    limit: Callable[[Scenario], float]
    turns: bool


_HEADING = Error(
    unit=lambda scenario, batch: math.radians(1.0),
    limit=lambda scenario: scenario.limits.heading_error_deg,
    turns=True,
)
ERRORS: dict[str, Error] = {
    "heading_keeping": _HEADING,
    "course_changing": _HEADING,
    "track_following": Error(
        unit=lambda scenario, batch: batch.tasks["L"],
        limit=lambda scenario: scenario.limits.cross_track,
        turns=False,
    ),
}


@dataclasses.dataclass(frozen=True)
class Objective:
    """mean(e^2 + rudder delta^2 + rate (RATE_TIME d delta / dt)^2) over the intervals that count.

    Attributes
    ----------
    rudder, rate : float
        Weights, e and delta in the unit of the measure and in degrees.
    steady : bool
        Whether the first ``measures.TURN`` after the start and each order hardly count.
    beyond : float
        How long the voyage goes on, and counts, after the end of the episode [full-scale s].
    """

    rudder: float
    rate: float = 0.0
    steady: bool = False
    beyond: float = _BEYOND


_OF_HEADINGS = {
    **{f"J_{lam:g}": Objective(lam) for lam in LAMBDAS},
    "J_steady": Objective(LAMBDAS[0], steady=True),
    "rms_error": Objective(_TINY),
}
_OF_TRACKS = {"rms_route": Objective(_TINY * math.radians(1.0) ** 2, beyond=0.0)}


def objectives_of(task: str) -> dict[str, Objective]:
    """Measures of a task that an optimum can be sought for, with what is minimised.

    Raises
    ------
    ConfigError
        A task without an error in `ERRORS`.
    """
    if task not in ERRORS:
        raise ConfigError(
            f"task {task!r} has no residuals to minimise; it needs an entry in "
            f"ship_gym.evaluation.objectives.ERRORS, as have {', '.join(ERRORS)}"
        )
    known = _OF_HEADINGS if ERRORS[task].turns else _OF_TRACKS
    return {name: one for name, one in known.items() if name in TASKS[task].metrics}


def objective_of(task: str, measure: str) -> Objective:
    """What is minimised for a measure of a task.

    Raises
    ------
    ConfigError
        There is none: the message names those that there are.
    """
    known = objectives_of(task)
    if measure not in known:
        raise ConfigError(
            f"measure {measure!r} of task {task!r} is no mean of squares; allowed are "
            f"{', '.join(known)}"
        )
    return known[measure]


def traded(task: str, measure: str, lam: float) -> Objective:
    """The objective of a measure with lambda of delta^2 and of (RATE_TIME d delta / dt)^2.

    For the front of error against wear. e is in deg or in L, delta in deg or, beside L, in rad, as
    in the rewards.
    """
    known = objective_of(task, measure)
    unit = 1.0 if ERRORS[task].turns else math.radians(1.0) ** 2
    return dataclasses.replace(known, rudder=lam * unit, rate=lam * unit)


class Scale(NamedTuple):
    """What turns m voyages into residuals.

    ``unit`` of the error, (m,); ``counts`` (T, m), weights of the intervals; ``worst``, error at
    the limit in the unit of the measure and the largest rudder angle [deg]; ``interval``
    [full-scale s].
    """

    unit: np.ndarray
    counts: np.ndarray
    worst: tuple[float, float]
    interval: float

    def rows(self, which: np.ndarray) -> Scale:
        """The same of some of the rows."""
        return self._replace(unit=self.unit[which], counts=self.counts[:, which])


def scale_of(objective: Objective, batch: EpisodeBatch, steps: int) -> Scale:
    """Scale of the episodes of a batch that has just begun, T = `steps`."""
    scenario, error = batch.scenario, ERRORS[batch.scenario.task]
    counts = np.ones((steps, batch.n))
    if objective.steady:
        counts = _after_turns(batch, steps)
    unit = np.broadcast_to(error.unit(scenario, batch), batch.n).astype(np.float64)
    worst = error.limit(scenario), math.degrees(batch.ship.gear.delta_max)
    return Scale(unit, counts, worst, scenario.control_interval)


def _after_turns(batch: EpisodeBatch, steps: int) -> np.ndarray:
    """Weights of the intervals, (steps, n): 1 of those of the steady part."""
    orders = np.zeros((batch.n, 1))
    if batch.plans.shape[2] == 2:  # course_changing: from when they hold, and the headings
        orders = batch.plans[:, :, 0]
    interval = batch.scenario.control_interval
    turns = np.stack([turning(row, steps, interval) for row in orders.tolist()], axis=1)
    return np.where(turns, _TURNING, 1.0)


def residuals(objective: Objective, scale: Scale, sailed: Voyages) -> tuple[np.ndarray, np.ndarray]:
    """Residuals and their mean square.

    Intervals that a failure cost count with the error at the limit and the rudder hard over, as in
    ``tasks.measures``; those after an arrival do not count.

    Returns
    -------
    parts : numpy.ndarray
        Shape (2 or 3, T, m).
    costs : numpy.ndarray
        Shape (m,).
    """
    alive = np.arange(len(sailed.error))[:, None] < sailed.lengths
    lost = ~alive & sailed.failed
    error = np.where(lost, scale.worst[0], sailed.error / scale.unit)
    delta = np.where(lost, scale.worst[1], np.degrees(sailed.delta))
    parts = [error, math.sqrt(objective.rudder) * delta]
    if objective.rate > 0.0:
        rate = np.diff(delta, axis=0, prepend=delta[:1]) / scale.interval
        parts.append(math.sqrt(objective.rate) * RATE_TIME * rate)
    counts = scale.counts * (alive | lost)
    found = np.stack(parts) * np.sqrt(counts)
    return found, (found**2).sum(axis=(0, 1)) / np.maximum(counts.sum(axis=0), 1.0)
