"""Many voyages of the same episodes in one batch, each with a rudder correction of its own."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np
from gymnasium.utils import seeding

from ship_gym.conventions import DELTA, PSI, R, wrap_angle
from ship_gym.envs.episodes import EpisodeBatch
from ship_gym.evaluation.controller import Controller
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship
from ship_gym.tasks.columns import action_columns

# Feedback of `Helm`: rudder by heading error [rad / rad] and by yaw rate r' = r L / U0 [rad]. With
# Nomoto's K' = T' = 2 both poles lie at -U0 / L. It only carries the corrections, which decide.
_K_P, _K_D = 1.0, 1.5
_ERROR_LIMIT = math.radians(30.0)


class Pilot(Protocol):
    """What steers before the correction is added."""

    name: str

    def begin(self, batch: EpisodeBatch) -> None:
        """Begin the episodes of a batch."""

    def act(self, batch: EpisodeBatch) -> np.ndarray:
        """Actions (m, n_actions) of the interval to come."""


class Steered:
    """A controller as pilot.

    Parameters
    ----------
    controller : Controller
    """

    def __init__(self, controller: Controller):
        self.controller, self.name = controller, controller.name

    def begin(self, batch: EpisodeBatch) -> None:
        """See `Pilot`."""
        self.controller.reset(batch.n, batch.ship, batch.scenario)

    def act(self, batch: EpisodeBatch) -> np.ndarray:
        """See `Pilot`."""
        return self.controller.act(batch.observations)


class Helm:
    """Feedback of the true heading and yaw rate, which no waves and no sensor's noise disturb.

    Rudder alone: the other actions are those of `other`, a controller such as the constant one.
    """

    name = "helm"

    def __init__(self, other: Controller):
        self._other = other

    def begin(self, batch: EpisodeBatch) -> None:
        """See `Pilot`."""
        ship = batch.ship
        self._other.reset(batch.n, ship, batch.scenario)
        self._rudder = action_columns(batch.scenario)["rudder"]
        self._limit = ship.gear.delta_max
        self._time = batch.tasks["L"] / batch.tasks["speed"]

    def act(self, batch: EpisodeBatch) -> np.ndarray:
        """See `Pilot`."""
        actions = np.array(self._other.act(batch.observations), dtype=np.float64)
        error = wrap_angle(batch.sim.state[:, PSI] - batch.tasks["psi_ordered"])
        error = np.clip(error, -_ERROR_LIMIT, _ERROR_LIMIT)
        delta = -(_K_P * error + _K_D * self._time * batch.sim.state[:, R])
        actions[:, self._rudder] = np.clip(delta / self._limit, -1.0, 1.0)
        return actions


class Beside:
    """A pilot, and what another one would do beside it.

    Attributes
    ----------
    differences : list of numpy.ndarray
        Rudder command of the first less that of the second [rad], (m,), of each interval.
    """

    def __init__(self, first: Pilot, second: Pilot):
        self._first, self._second, self.name = first, second, first.name
        self.differences: list[np.ndarray] = []

    def begin(self, batch: EpisodeBatch) -> None:
        """See `Pilot`."""
        self._first.begin(batch)
        self._second.begin(batch)
        self.differences = []

    def act(self, batch: EpisodeBatch) -> np.ndarray:
        """See `Pilot`."""
        found, other = self._first.act(batch), self._second.act(batch)
        rudder = action_columns(batch.scenario)["rudder"]
        limit = batch.ship.gear.delta_max
        self.differences.append((found[:, rudder] - other[:, rudder]) * limit)
        return found


@dataclasses.dataclass(frozen=True, eq=False)
class Voyages:
    """m voyages of T intervals.

    Attributes
    ----------
    error : numpy.ndarray
        Of the task at the ends of the intervals, as ``EpisodeBatch.errors``, shape (T, m).
    delta : numpy.ndarray
        Rudder angle at the ends of the intervals [rad], shape (T, m).
    lengths : numpy.ndarray
        Intervals until the episode terminated, else T; shape (m,).
    failed : numpy.ndarray
        Whether it terminated as failed, shape (m,).
    actions : numpy.ndarray or None
        Shape (T, m, n_actions), where asked for.
    """

    error: np.ndarray
    delta: np.ndarray
    lengths: np.ndarray
    failed: np.ndarray
    actions: np.ndarray | None = None


class Sailings:
    """Sails episodes of given seeds, as often as asked, with corrections of the rudder.

    Parameters
    ----------
    seeds : sequence of int
    scenario : Scenario
    ship : Ship or None
        None: the scenario's.
    knots : numpy.ndarray
        Intervals at whose start the corrections are given, between them linear; rising, (K,).
    steps : int
        Intervals to sail, which may be more than the episode has.
    parallel : bool, optional
        As in ``ShipSim``.
    """

    def __init__(
        self,
        seeds: Sequence[int],
        scenario: Scenario,
        ship: Ship | None,
        knots: np.ndarray,
        steps: int,
        parallel: bool | None = None,
    ):
        self.seeds, self.scenario, self.steps = list(seeds), scenario, steps
        self.knots = np.asarray(knots, dtype=np.float64)
        self._given, self._parallel = ship, parallel
        self._batches: dict[int, EpisodeBatch] = {}
        n_draws = self._batch(len(self.seeds)).n_draws
        draws = [seeding.np_random(int(seed))[0].random(n_draws) for seed in self.seeds]
        self._draws = np.stack(draws)
        self._shape = _hats(self.knots, steps)

    @property
    def ship(self) -> Ship:
        """The ship that sails."""
        return self._batch(len(self.seeds)).ship

    @property
    def speed(self) -> float:
        """Nominal speed of the episodes [m/s]."""
        return float(self._batch(len(self.seeds)).tasks["speed"][0])

    def begin(self, rows: np.ndarray) -> EpisodeBatch:
        """A batch at the start of the episodes of some seeds, by their numbers, shape (m,)."""
        batch = self._batch(len(rows))
        batch.start(np.arange(len(rows)), self._draws[rows])
        return batch

    def sail(
        self, pilot: Pilot, rows: np.ndarray, corrections: np.ndarray, keep_actions: bool = False
    ) -> Voyages:
        """Sail episodes under a pilot with corrections.

        Parameters
        ----------
        pilot : Pilot
        rows : numpy.ndarray
            Numbers of the seeds, shape (m,).
        corrections : numpy.ndarray
            Rudder angle that is added at the knots [rad], shape (m, K).
        keep_actions : bool
        """
        batch = self.begin(rows)
        pilot.begin(batch)
        added = self._shape @ corrections.T / batch.ship.gear.delta_max
        rudder = action_columns(self.scenario)["rudder"]
        error, delta = np.zeros((2, self.steps, batch.n))
        actions = np.zeros((self.steps, batch.n, batch.n_actions)) if keep_actions else None
        lengths, failed = np.full(batch.n, self.steps), np.zeros(batch.n, dtype=np.bool_)
        for k in range(self.steps):
            action = np.array(pilot.act(batch), dtype=np.float64)
            action[:, rudder] = np.clip(action[:, rudder] + added[k], -1.0, 1.0)
            batch.step(action)
            error[k], delta[k] = batch.errors, batch.sim.state[:, DELTA]
            if actions is not None:
                actions[k] = action
            new = batch.terminated & (lengths > k + 1)
            if new.any():
                lengths[new], failed[new] = k + 1, self._is_failure(batch)[new]
                if lengths.max() <= k + 1:
                    break
        return Voyages(error, delta, lengths, failed, actions)

    def at_knots(self, angles: np.ndarray) -> np.ndarray:
        """Corrections (m, K) nearest to angles of the intervals (T, m), by least squares."""
        shape = self._shape[: len(angles)]
        return np.linalg.lstsq(shape, angles, rcond=None)[0].T

    def _is_failure(self, batch: EpisodeBatch) -> np.ndarray:
        return np.array([one.failed for one in batch.task.all_outcomes])[batch.outcomes]

    def _batch(self, m: int) -> EpisodeBatch:
        """The batch of m episodes, made once."""
        if m not in self._batches:
            self._batches[m] = EpisodeBatch(m, self.scenario, self._given, self._parallel)
        return self._batches[m]


def _hats(knots: np.ndarray, steps: int) -> np.ndarray:
    """Share of each knot in the correction of each interval, linear between them, (steps, K)."""
    times = np.arange(steps, dtype=np.float64)
    return np.stack([np.interp(times, knots, one) for one in np.eye(len(knots))], axis=1)
