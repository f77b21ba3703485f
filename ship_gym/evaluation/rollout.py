"""Rollouts: one episode per seed under one controller, all of them sailed in one batch."""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import os
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from gymnasium.utils import seeding

from ship_gym.config import ConfigError, shown
from ship_gym.envs.env import resolved_scenario
from ship_gym.envs.episode_log import EpisodeLog
from ship_gym.envs.episode_record import (
    Conditions,
    Setting,
    conditions_of,
    currents_of,
    policy_meta,
    weather_of,
)
from ship_gym.envs.episodes import EpisodeBatch
from ship_gym.envs.streamed import Streamed, about_run
from ship_gym.evaluation.controller import Controller, check_controller
from ship_gym.evaluation.guard import Guarded
from ship_gym.evaluation.splits import (  # noqa: F401, names of old
    EVALUATION_SEED,
    TUNING_SEED,
    evaluation_seeds,
    tuning_seeds,
)
from ship_gym.provenance import provenance
from ship_gym.recording.trajectory import Trajectory
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship
from ship_gym.tasks import TASKS
from ship_gym.tasks.base import Task


@dataclasses.dataclass(frozen=True, eq=False)
class Rollout:
    """Episodes of one controller, one per seed.

    Row k of the histories is the instant at which action k is taken; T is the longest planned
    number of intervals. Episode i sails ``lengths[i]`` intervals, so its rows 0 to ``lengths[i]``
    count, the last of them being its final state; what lies behind is not part of it.

    Attributes
    ----------
    controller : str
        Name.
    scenario : Scenario
    ship : Ship
    seeds : tuple of int
        Shape (n,): episode i is that of ``ShipEnv.reset(seed=seeds[i])``, bit for bit.
    lengths : numpy.ndarray
        Intervals sailed, shape (n,).
    outcomes : numpy.ndarray
        Why each episode terminated, index of the task's outcomes, shape (n,); 0: it was
        truncated. One that terminates in its last interval counts as terminated only.
    histories : dict
        ``time`` [s] (T+1, n), ``states`` (T+1, n, 8), ``commands`` (T+1, n, 2), ``forces``
        (T+1, n, N_FORCES, 3), ``flow`` (T+1, n, 7; 19 of a ship with two propellers), ``waves``
        (T+1, n, 10), ``observations`` (T+1, n, columns), ``actions`` (T+1, n, 1 or 2), what the
        task keeps (its ``history``, such as ``psi_ordered``, T+1, n), ``terms`` (T, n, terms),
        ``rewards`` (T, n); see ``envs.episode_log``.
    plans : numpy.ndarray
        Orders or way-points of each episode, as ``EpisodeBatch.plans``.
    weather : dict
        ``wave_height`` [m], ``wave_period`` [s], ``wave_direction_to`` [rad], ``wind_speed``
        [m/s], ``wind_direction_to`` [rad], shapes (n,).
    current : numpy.ndarray
        As ``envs.episode_record.currents_of``, shape (n, 5).
    waves : numpy.ndarray
        Of each episode as ``sea.records.Waters.waves_of``, shape (n, 5, N).
    randomisation : dict
        What was drawn for the ships, by name, shapes (n,); empty if nothing is.
    given : dict
        As ``EpisodeBatch.given``.
    policy : dict or None
        ``file`` and ``sha256`` of what the controller was loaded from, if it says (`file`).
    provenance : dict
    """

    controller: str
    scenario: Scenario
    ship: Ship
    seeds: tuple[int, ...]
    lengths: np.ndarray
    outcomes: np.ndarray
    histories: dict[str, np.ndarray]
    plans: np.ndarray
    weather: dict[str, np.ndarray]
    current: np.ndarray
    waves: np.ndarray
    randomisation: dict[str, np.ndarray]
    given: dict[str, object]
    policy: dict[str, str] | None
    provenance: dict[str, object]

    def __len__(self) -> int:
        """Return the number of episodes."""
        return len(self.seeds)

    @property
    def terminated(self) -> np.ndarray:
        """Whether each episode terminated; else it was truncated. Shape (n,)."""
        return self.outcomes > 0

    @property
    def task(self) -> Task:
        """The task of the scenario."""
        return TASKS[self.scenario.task]

    @property
    def failed(self) -> np.ndarray:
        """Whether each episode ended at a limit or diverged, shape (n,)."""
        return np.array([outcome.failed for outcome in self.task.all_outcomes])[self.outcomes]

    @property
    def episodes(self) -> list[Trajectory]:
        """All episodes as recordings, made anew at each call."""
        return [self.trajectory(i) for i in range(len(self))]

    def trajectory(self, i: int) -> Trajectory:
        """Episode i as a recording from which every metric can be computed again.

        Row k holds the state at ``t[k]``, the command given then, forces and flow at that instant
        and the reward of the interval that starts there. The last row is the final state: it
        repeats the last command, its forces are those at that state, its reward is 0.
        """
        rows = slice(0, self.lengths[i] + 1)
        histories = {name: kept[rows, i] for name, kept in self.histories.items()}
        about = about_run(self.controller, self.policy, self.seeds[i], self.provenance)
        return self._conditions(i).trajectory(histories, int(self.outcomes[i]), about)

    @functools.cached_property
    def _setting(self) -> Setting:
        return Setting(self.scenario, self.ship, self.given)

    def _conditions(self, i: int) -> Conditions:
        return Conditions(
            self._setting,
            self.plans[i],
            {name: values[i].item() for name, values in self.weather.items()},
            tuple(self.current[i].tolist()),
            {name: values[i].item() for name, values in self.randomisation.items()},
            self.waves[i],
        )


def begin(
    seeds: Sequence[int],
    scenario: str | Mapping[str, Any] | Scenario = "heading_keeping",
    *,
    ship: str | Ship | None = None,
    control: str | None = None,
    surrogate: str | None = None,
    privileged: bool | None = None,
    overrides: Mapping[str, Any] | None = None,
    parallel: bool | None = None,
) -> EpisodeBatch:
    """A batch at the start of the episodes of `seeds`, as ``ShipEnv.reset(seed=...)`` draws them.

    Parameters
    ----------
    seeds : sequence of int
        Shape (n,); a seed may occur more than once.
    scenario, ship, control, surrogate, privileged, overrides
        As in ``ShipEnv``.
    parallel : bool, optional
        As in ``ShipSim``.

    Raises
    ------
    ConfigError
        No seeds, a negative one, or a scenario that cannot be used.
    """
    if len(seeds) == 0 or min(seeds) < 0:
        raise ConfigError(f"seeds = {list(seeds)}: at least one is needed, none negative")
    resolved, given = resolved_scenario(scenario, ship, control, surrogate, privileged, overrides)
    batch = EpisodeBatch(len(seeds), resolved, given, parallel)
    draws = [seeding.np_random(int(seed))[0].random(batch.n_draws) for seed in seeds]
    batch.start(np.arange(len(seeds)), np.stack(draws))
    return batch


def rollout(
    controller: Controller,
    scenario: str | Mapping[str, Any] | Scenario = "heading_keeping",
    *,
    seeds: Sequence[int],
    ship: str | Ship | None = None,
    control: str | None = None,
    surrogate: str | None = None,
    privileged: bool | None = None,
    overrides: Mapping[str, Any] | None = None,
    parallel: bool | None = None,
    progress: Any = False,
    record: Mapping[int, str | os.PathLike] | None = None,
) -> Rollout:
    """Sail one episode per seed under one controller.

    Parameters
    ----------
    controller : Controller
        Its row i must depend on row i of the observations only: episodes that have ended keep
        their row until all have.
    seeds : sequence of int
        `evaluation_seeds(n)` for anything that is reported.
    scenario, ship, control, surrogate, privileged, overrides
        As in ``ShipEnv``.
    parallel : bool, optional
        As in ``ShipSim``.
    progress : callable or False
        Wraps the iterable of control intervals, e.g. ``tqdm.tqdm``; False: nothing is shown.
    record : mapping of int to path, optional
        Index of an episode to the file ``*.rrd`` that it is recorded into while it sails. A run
        that breaks off leaves what it has as ``*.rrd.partial``.

    Returns
    -------
    Rollout

    Raises
    ------
    ConfigError
        What `begin` refuses, and what the controller itself does in its ``reset``.
    ControllerFailed
        The controller raised or gave what is no action; says where.
    OSError
        A recording cannot be written; what cannot be begun is said before the first interval.
    """
    _check_record(record, len(seeds))
    env: dict[str, Any] = {"ship": ship, "control": control, "surrogate": surrogate}
    env |= {"privileged": privileged, "overrides": overrides}
    check_controller(controller, type(controller).__name__)
    batch = begin(seeds, scenario, parallel=parallel, **env)
    if not isinstance(controller, Guarded):
        controller = Guarded(controller, seeds)
    controller.reset(batch.n, batch.ship, batch.scenario)
    current = currents_of(batch.sim.seas)
    made, policy = provenance(), policy_meta(controller.file)
    log = EpisodeLog(batch, batch.n, batch.scenario.steps)
    log.begin(np.arange(batch.n))
    abouts = {i: about_run(controller.name, policy, int(seeds[i]), made) for i in record or ()}
    with _streams(log, record or {}, abouts) as streams:
        outcomes = _sail(log, controller, streams, progress)
    return Rollout(
        controller=controller.name,
        scenario=batch.scenario,
        ship=batch.ship,
        seeds=tuple(int(seed) for seed in seeds),
        lengths=log.lengths,
        outcomes=outcomes,
        histories=log.whole(),
        plans=batch.plans,
        weather=weather_of(batch),
        current=current,
        waves=np.stack([batch.sim.water.waves_of(i) for i in range(batch.n)]),
        randomisation=batch.randomisation(),
        given=batch.given,
        policy=policy,
        provenance=made,
    )


def _check_record(record: Any, n: int) -> None:
    """Refuse what is no mapping of the indices of n episodes to files."""
    if record is None:
        return
    if not isinstance(record, Mapping):
        raise ConfigError(
            f"record = {shown(record)}: must map indices of episodes to files '*.rrd'"
        )
    for i in record:
        whole = isinstance(i, int | np.integer) and not isinstance(i, bool)
        if not (whole and 0 <= i < n):
            raise ConfigError(f"record: episode {shown(i)}: allowed are 0 to {n - 1}")


def _sail(
    log: EpisodeLog, controller: Guarded, streams: dict[int, Streamed], progress: Any
) -> np.ndarray:
    """Sail all episodes of a log to their ends; returns their outcomes, shape (n,)."""
    batch, steps = log.batch, range(log.batch.scenario.steps)
    outcomes = np.zeros(batch.n, dtype=np.int64)
    ended = np.zeros(batch.n, dtype=np.bool_)
    for _ in progress(steps) if progress else steps:
        actions = controller.act(batch.observations)
        log.before()
        batch.step(actions)
        log.after()
        new = ~ended & (batch.terminated | batch.truncated)
        if new.any():
            outcomes[new] = batch.outcomes[new]
            log.end(np.flatnonzero(new))
            ended |= new
        for i in [i for i in streams if new[i]]:
            streams.pop(i).finish(int(outcomes[i]))
        for stream in streams.values():
            if stream.is_due():
                stream.follow()
        if ended.all():
            break
    return outcomes


@contextlib.contextmanager
def _streams(
    log: EpisodeLog, record: Mapping[int, str | os.PathLike], abouts: Mapping[int, dict]
) -> Iterator[dict[int, Streamed]]:
    """Episodes on their way into files, by index; what is left at an error keeps its journal."""
    log.before()
    batch, made = log.batch, {}
    setting = Setting(batch.scenario, batch.ship, batch.given)
    try:
        for i, path in record.items():
            made[i] = Streamed(path, log, i, conditions_of(batch, i, setting), abouts[i])
        yield made
    except BaseException:
        for stream in made.values():
            with contextlib.suppress(OSError):
                stream.leave()
        raise
