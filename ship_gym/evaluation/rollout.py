"""Rollouts: one episode per seed under one controller, all of them sailed in one batch."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from gymnasium.utils import seeding

from ship_gym.config import ConfigError
from ship_gym.conventions import polar
from ship_gym.envs.env import resolved_scenario
from ship_gym.envs.episodes import EpisodeBatch
from ship_gym.evaluation.controller import Controller, check_controller
from ship_gym.evaluation.guard import Guarded
from ship_gym.evaluation.splits import (  # noqa: F401, names of old
    EVALUATION_SEED,
    TUNING_SEED,
    evaluation_seeds,
    tuning_seeds,
)
from ship_gym.provenance import provenance
from ship_gym.recording.about import ship_meta
from ship_gym.recording.panels import plots_meta
from ship_gym.recording.trajectory import Trajectory
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship
from ship_gym.simulation import history_columns
from ship_gym.tasks import TASKS
from ship_gym.tasks.base import Task
from ship_gym.tasks.rewards import COSTS

_HISTORIES = ("time", "states", "commands", "forces", "flow", "waves")
_START = ("time", "states", "waves")  # of an interval
_DURING = ("commands", "forces", "flow")  # the engine's, at the start of the interval


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
        (T+1, n, 9), what the task keeps (its ``history``, such as ``psi_ordered``, T+1, n),
        ``terms`` (T, n, terms), ``rewards`` (T, n).
    plans : numpy.ndarray
        Orders or way-points of each episode, as ``EpisodeBatch.plans``.
    weather : dict
        ``wave_height`` [m], ``wave_period`` [s], ``wave_direction_to`` [rad], ``wind_speed``
        [m/s], ``wind_direction_to`` [rad], shapes (n,).
    current : numpy.ndarray
        Speed [m/s] and direction it flows to [rad, from north], shape (n, 2).
    randomisation : dict
        What was drawn for the ships, by name, shapes (n,); empty if nothing is.
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
    randomisation: dict[str, np.ndarray]
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
        parts = [self.histories[name][rows, i] for name in _HISTORIES]
        columns = history_columns(*parts)
        history = {name: self.histories[name][rows, i] for name in self.task.history}
        columns |= self.task.columns(columns, history, self.plans[i])
        columns["current_speed"] = np.full(len(columns["t"]), self.current[i, 0])
        columns["current_direction_to"] = np.full(len(columns["t"]), self.current[i, 1])
        if self.weather["wind_speed"][i] > 0.0:
            origin = (self.weather["wind_direction_to"][i] + math.pi) % (2.0 * math.pi)
            columns["wind_speed"] = np.full(len(columns["t"]), self.weather["wind_speed"][i])
            columns["wind_direction_from"] = np.full(len(columns["t"]), origin)
        sailed = slice(0, self.lengths[i])
        columns["reward"] = np.append(self.histories["rewards"][sailed, i], 0.0)
        for k, term in enumerate((*self.task.terms, *COSTS)):
            columns[f"reward_{term.name}"] = np.append(self.histories["terms"][sailed, i, k], 0.0)
        return Trajectory(columns, self._meta(i))

    def _meta(self, i: int) -> dict[str, Any]:
        terminated = bool(self.terminated[i])
        outcome = self.task.all_outcomes[self.outcomes[i]].name
        return {
            "task": self.scenario.task,
            "controller": self.controller,
            "seed": self.seeds[i],
            "config": self.scenario.to_dict(),
            "ship": ship_meta(self.ship),
            "randomisation": {k: z[i].item() for k, z in self.randomisation.items()},
            "sea": {k: values[i].item() for k, values in self.weather.items()},
            "terminated": terminated,
            "truncated": not terminated,
            "outcome": outcome if terminated else "end of time",
            "failed": bool(self.failed[i]),
            **self.task.meta(self.plans[i]),
            **plots_meta(self.task.plots),
            **self.provenance,
        }


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

    Returns
    -------
    Rollout

    Raises
    ------
    ConfigError
        What `begin` refuses, and what the controller itself does in its ``reset``.
    ControllerFailed
        The controller raised or gave what is no action; says where.
    """
    env = {"ship": ship, "control": control, "surrogate": surrogate}
    env |= {"privileged": privileged, "overrides": overrides}
    check_controller(controller, type(controller).__name__)
    batch = begin(seeds, scenario, parallel=parallel, **env)
    if not isinstance(controller, Guarded):
        controller = Guarded(controller, seeds)
    controller.reset(batch.n, batch.ship, batch.scenario)
    log = _Log(batch)
    steps = range(batch.scenario.steps)
    for k in progress(steps) if progress else steps:
        log.sail(k, controller.act(batch.observations))
        if log.ended.all():
            break
    log.close(k + 1)
    current = polar(batch.sim.seas["V_north"], batch.sim.seas["V_east"])
    return Rollout(
        controller=controller.name,
        scenario=batch.scenario,
        ship=batch.ship,
        seeds=tuple(int(seed) for seed in seeds),
        lengths=log.lengths,
        outcomes=log.outcomes,
        histories=log.histories,
        plans=batch.plans,
        weather=weather_of(batch),
        current=np.column_stack(current),
        randomisation=batch.randomisation(),
        provenance=provenance(),
    )


def weather_of(batch: EpisodeBatch) -> dict[str, np.ndarray]:
    """Waves and wind of episodes that have begun, as ``Rollout.weather``."""
    seas, tasks = batch.sim.seas, batch.tasks
    wind_speed, wind_to = polar(seas["wind_north"], seas["wind_east"])
    return {
        "wave_height": tasks["wave_height"].copy(),
        "wave_period": tasks["wave_period"].copy(),
        "wave_direction_to": tasks["wave_to"] % (2.0 * math.pi),
        "wind_speed": wind_speed,
        "wind_direction_to": wind_to,
    }


class _Log:
    """Histories of a batch while it sails."""

    def __init__(self, batch: EpisodeBatch):
        self.batch, sim = batch, batch.sim
        self._now = {
            "time": sim.time,
            "states": sim.state,
            "commands": sim.commands,
            "forces": sim.forces,
            "flow": sim.flow,
            "waves": sim.waves,
            **{name: batch.tasks[name] for name in batch.task.history},
        }
        self._start = (*_START, *batch.task.history)
        self._earned = {"terms": batch.terms, "rewards": batch.rewards}
        rows = batch.scenario.steps
        shapes = {name: (rows + 1, *a.shape) for name, a in self._now.items()}
        shapes.update({name: (rows, *a.shape) for name, a in self._earned.items()})
        self.histories = {name: np.zeros(shape) for name, shape in shapes.items()}
        self.lengths = np.full(batch.n, rows)
        self.ended = np.zeros(batch.n, dtype=np.bool_)
        self.outcomes = np.zeros(batch.n, dtype=np.int64)

    def sail(self, k: int, actions: np.ndarray) -> None:
        """Sail interval k and keep its start, its forces and its reward."""
        for name in self._start:
            self.histories[name][k] = self._now[name]
        self.batch.step(actions)
        for name in _DURING:
            self.histories[name][k] = self._now[name]
        for name, values in self._earned.items():
            self.histories[name][k] = values
        new = ~self.ended & (self.batch.terminated | self.batch.truncated)
        self.lengths[new] = k + 1
        self.outcomes[new] = self.batch.outcomes[new]
        self.ended |= new

    def close(self, k: int) -> None:
        """Fill row k, the final state, with the forces that one more step finds at its start."""
        sim = self.batch.sim
        for name in self._start:
            self.histories[name][k] = self._now[name]
        sim.sail()
        for name in _DURING:  # finite too where a ship has diverged
            self.histories[name][k] = np.nan_to_num(self._now[name], posinf=0.0, neginf=0.0)
        last = self.lengths, np.arange(self.batch.n)
        self.histories["commands"][last] = self.histories["commands"][last[0] - 1, last[1]]
