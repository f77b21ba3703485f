"""What tuning makes small, of a batch of episodes, without keeping their recordings.

Headings: mean J_0.1; courses: mean settling time, tracks: mean rms distance to the route, both
with a price on the rudder's travel. Without the price a guidance is tuned to answer the noise of
the position: kcs with `drift_los` then keeps the route to 0.149 L instead of 0.170 L (24 tuning
seeds, currents up to 1 m/s) with three times the travel and six times the reversals. Measures are
the metrics of the same name, which a test compares.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.conventions import DELTA, PSI, wrap_angle
from ship_gym.envs.episodes import EpisodeBatch
from ship_gym.evaluation.controller import Controller, check_controller
from ship_gym.evaluation.rollout import begin
from ship_gym.tasks import TASKS
from ship_gym.tasks.heading.metrics import step_response

LAMBDA = 0.1  # of J; the environment's default


class Objective(NamedTuple):
    """What is made small: a metric of the task, its unit, a price on rudder travel [unit h/deg]."""

    name: str
    unit: str
    price: float
    text: str
    beside: tuple[str, ...] = ()  # metrics that are told beside it
    failed: float | None = None  # what an episode that failed counts; None: its metric

    def of(self, measures: Mapping[str, Sequence[Any]]) -> np.ndarray:
        """The objective of every episode from its metrics, shape (n,)."""
        found = np.asarray(measures[self.name])
        if self.failed is not None:
            found = np.where(np.asarray(measures["success"]) == 0.0, self.failed, found)
        return found + self.price * np.asarray(measures["rudder_travel"])


_J = Objective(
    f"J_{LAMBDA:g}", "deg2", 0.0, f"mean of J = mean(psi_e^2) + {LAMBDA:g} mean(delta^2) [deg2]"
)
_PRICE = 2e-5  # [L h/deg]: 0.02 L for 1000 deg/h, about what a heading autopilot moves the rudder
_TRACK = Objective(
    "rms_route", "L", _PRICE, f"mean of the rms distance to the route [L] + {_PRICE:g} rudder "
    "travel [deg/h]"
)  # fmt: skip

# 5 s for 1000 deg/h: so little that the turn decides, enough that holding does not chatter
_COURSE_PRICE = 5e-3  # [s h/deg]
_NEVER = 240.0  # [s]: the longest time between two orders
_COURSE = Objective(
    "settling_time",
    "s",
    _COURSE_PRICE,
    f"mean of the settling time [s], {_NEVER:g} s of an episode that failed, + "
    f"{_COURSE_PRICE:g} rudder travel [deg/h]",
    ("overshoot", _J.name),
    _NEVER,
)


def objective_of(task: str) -> Objective:
    """What controllers of a task are tuned for.

    Raises
    ------
    ConfigError
        Its metrics have neither J nor a distance to a track.
    """
    known = TASKS[task].metrics
    if getattr(TASKS[task], "headline", None) == _COURSE.name:
        return _COURSE
    for one in (_J, _TRACK):
        if one.name in known:
            return one
    able = [name for name, t in TASKS.items() for o in (_J, _TRACK) if o.name in t.metrics]
    raise ConfigError(
        f"task {task!r}: gains are tuned for {_J.text} or {_TRACK.text}, which it does not "
        f"have; allowed are {', '.join(able)}"
    )


def episode_costs(controller: Controller, seeds: Sequence[int], **env: Any) -> np.ndarray:
    """The objective of every episode, one for each seed, shape (n,).

    Parameters
    ----------
    controller : Controller
    seeds : sequence of int
        May occur more than once, as for several candidates.
    **env
        Keyword arguments of ``rollout``.
    """
    check_controller(controller, type(controller).__name__)
    # One thread: threads that wait for each other on a shared machine are slower than none.
    batch = begin(seeds, parallel=False, **env)
    name = objective_of(batch.scenario.task).name
    meter: Any = _METERS[name](batch)
    controller.reset(batch.n, batch.ship, batch.scenario)
    failing = np.array([outcome.failed for outcome in batch.task.all_outcomes])
    total, sailed, lost = np.zeros(batch.n), np.zeros(batch.n), np.zeros(batch.n)
    alive = np.ones(batch.n, dtype=np.bool_)
    for k in range(batch.scenario.steps):
        meter.begin()
        batch.step(controller.act(batch.observations))
        total += np.where(alive, meter.end(alive), 0.0)
        sailed += alive
        ended = alive & (batch.terminated | batch.truncated)
        lost[ended & failing[batch.outcomes]] = batch.scenario.steps - (k + 1)
        alive &= ~ended
        if not alive.any():
            break
    return meter.total((total + lost * meter.worst) / (sailed + lost), sailed)


class _Heading:
    """psi_e^2 + lambda delta^2 [deg2] of an interval, judged by the order that held in it."""

    def __init__(self, batch: EpisodeBatch):
        self._batch = batch
        limit = batch.scenario.limits.heading_error_deg
        self.worst = limit**2 + LAMBDA * math.degrees(batch.ship.gear.delta_max) ** 2

    def begin(self) -> None:
        self._ordered = self._batch.tasks["psi_ordered"].copy()

    def end(self, alive: np.ndarray) -> np.ndarray:
        state = self._batch.sim.state
        psi_e = np.degrees(wrap_angle(state[:, PSI] - self._ordered))
        return psi_e**2 + LAMBDA * np.degrees(state[:, DELTA]) ** 2

    def total(self, mean: np.ndarray, sailed: np.ndarray) -> np.ndarray:
        return mean


class _Track:
    """Squared distance to the route [L2] at the end of an interval, as the reward has it."""

    def __init__(self, batch: EpisodeBatch):
        weight = batch.scenario.reward.cross_track
        if weight <= 0.0:
            raise ConfigError(
                f"reward.cross_track = {weight}: tuning reads the distance to the track from this "
                "term of the reward; allowed is a positive weight"
            )
        self._batch, self._term = batch, batch.reward_terms.index("cross_track")
        self._weight = weight * batch.tasks["interval"]
        self._travel = np.zeros(batch.n)  # [rad]
        self.worst = batch.scenario.limits.cross_track**2

    def begin(self) -> None:
        self._delta = self._batch.sim.state[:, DELTA].copy()

    def end(self, alive: np.ndarray) -> np.ndarray:
        moved = np.abs(self._batch.sim.state[:, DELTA] - self._delta)
        self._travel += np.where(alive, moved, 0.0)
        return -self._batch.terms[:, self._term] / self._weight

    def total(self, mean: np.ndarray, sailed: np.ndarray) -> np.ndarray:
        hours = sailed * self._batch.scenario.control_interval / 3600.0
        return np.sqrt(mean) + _PRICE * np.degrees(self._travel) / hours


class _Course:
    """Settling time of the steps of the order [s] and the rudder's travel."""

    worst = 0.0  # what failing costs is in the total

    def __init__(self, batch: EpisodeBatch):
        self._batch = batch
        self._delta = [batch.sim.state[:, DELTA].copy()]
        self._psi: list[np.ndarray] = []
        self._ordered: list[np.ndarray] = []
        self._failed = np.zeros(batch.n, dtype=np.bool_)
        self._failing = np.array([outcome.failed for outcome in batch.task.all_outcomes])
        self._see()

    def begin(self) -> None:
        pass

    def end(self, alive: np.ndarray) -> np.ndarray:
        self._delta.append(self._batch.sim.state[:, DELTA].copy())
        self._see()
        self._failed |= alive & self._batch.terminated & self._failing[self._batch.outcomes]
        return np.zeros(self._batch.n)

    def total(self, mean: np.ndarray, sailed: np.ndarray) -> np.ndarray:
        interval, duration = self._batch.scenario.control_interval, self._batch.scenario.duration
        psi, ordered, delta = map(np.array, (self._psi, self._ordered, self._delta))
        error = np.degrees(wrap_angle(psi - ordered))
        found = np.empty(self._batch.n)
        for i, length in enumerate(sailed.astype(int)):
            own = slice(length + 1), i
            time = interval * np.arange(length + 1)
            found[i] = step_response(time, error[own], ordered[own], duration)[_COURSE.name]
            travel = np.degrees(np.abs(np.diff(delta[own])).sum()) / (time[-1] / 3600.0)
            found[i] = (_NEVER if self._failed[i] else found[i]) + _COURSE_PRICE * travel
        return found

    def _see(self) -> None:
        self._psi.append(self._batch.sim.state[:, PSI].copy())
        self._ordered.append(self._batch.tasks["psi_ordered"].copy())


_METERS = {_J.name: _Heading, _TRACK.name: _Track, _COURSE.name: _Course}
