"""Tune the gains of a controller on tuning seeds: of several structures the best one is kept.

All candidates of a generation sail the same episodes in one batch, each with its own gains.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ship_gym.config import check_known
from ship_gym.evaluation.comparison import per_episode
from ship_gym.evaluation.rollout import begin, rollout, tuning_seeds
from ship_gym.evaluation.statistics import Estimate, estimate
from ship_gym.provenance import sha256
from ship_gym.ships import load_ship
from ship_gym.ships.particulars import Ship
from ship_gym_agents.gains_files import find_gains, load_gains
from ship_gym_agents.tuning.objective import Objective, episode_costs, objective_of
from ship_gym_agents.tuning.ranges import (
    Range,
    at_bounds,
    can_widen,
    has_leaf,
    leaf,
    ranges_of,
    with_leaves,
)
from ship_gym_agents.tuning.search import Size, need_optuna, search
from ship_gym_agents.tuning.structures import own_task_of, scenario_for, structures_of

VALIDATION = 3  # times as many episodes to choose the structure as to tune its gains
_REPORTED = (
    *("J_0.1", "J_1", "J_steady", "rms_error", "rms_route", "rms_cross_track", "corridor"),
    "settling_time",
    "overshoot",
    "voyage_time",
    "success",
    "rudder_travel",
    "rudder_reversals",
)


@dataclasses.dataclass(frozen=True)
class Tuned:
    """Best gains of one structure.

    Attributes
    ----------
    structure : str
        Empty if the controller has but one.
    gains : object
        Dataclass of the controller.
    cost_tuning : float
        Mean objective on the tuning episodes.
    episodes : dict
        Metrics of every validation episode, lists of length n.
    cost : float
        Mean objective on the validation episodes.
    at_bounds : dict
        Gains that lie at a bound of their range and could be beyond it, with that bound.
    """

    structure: str
    gains: Any
    cost_tuning: float
    cost: float
    episodes: dict[str, list[Any]]
    at_bounds: dict[str, float] = dataclasses.field(default_factory=dict)

    @property
    def validation(self) -> dict[str, float]:
        """Means of metrics on the validation episodes, in their units."""
        known = {key: [x for x in values if x is not None] for key, values in self.episodes.items()}
        return {key: float(np.mean(values)) for key, values in known.items() if values}


@dataclasses.dataclass(frozen=True)
class Tuning:
    """What a tuning found.

    Attributes
    ----------
    controller : str
        Kind, or ``file.py:Class``.
    ship : str
    objective : Objective
    ranking : tuple of Tuned
        The best on the validation episodes first.
    before : str
        What the gain counts from: the file of the gains of before, or the start of the search.
    begun : str
        File of gains that the search began at, else as `before`.
    cost_before : float
        Mean objective of the gains of before on the validation episodes.
    gained : Estimate
        Mean of the objective after less before on the validation episodes, paired, with its 95 %
        interval; below zero is better. The structure was chosen on these episodes, so of several
        close ones it flatters a little.
    changed : dict
        The same of the metric, of those told beside it and of the rudder's travel.
    task : str, optional
        See `own_task_of`.
    """

    controller: str
    ship: str
    objective: Objective
    ranking: tuple[Tuned, ...]
    before: str
    begun: str
    cost_before: float
    gained: Estimate
    changed: dict[str, Estimate]
    task: str | None = None

    @property
    def best(self) -> Tuned:
        """The winner."""
        return self.ranking[0]


def mean_costs(
    controller: type[Any],
    gains: Any,
    candidates: Sequence[Mapping[str, float]],
    seeds: Sequence[int],
    **env: Any,
) -> np.ndarray:
    """Mean objective of every candidate over the same episodes, shape (m,).

    Parameters
    ----------
    controller : type
    gains : dataclass
        The gains that are not free.
    candidates : sequence of mapping
        Values of the free gains by dotted name, m of them.
    seeds : sequence of int
    **env
        Keyword arguments of ``rollout``.
    """
    rows = {
        name: np.repeat([candidate[name] for candidate in candidates], len(seeds))
        for name in candidates[0]
    }
    sailing = controller(with_leaves(gains, rows))
    costs = episode_costs(sailing, list(seeds) * len(candidates), **env)
    return costs.reshape(len(candidates), len(seeds)).mean(axis=1)


def tune(
    controller: type[Any],
    ship: str,
    size: Size | None = None,
    *,
    name: str | None = None,
    structures: Iterable[str] | None = None,
    begin_at: str | Path | None = None,
    progress: Callable[[Iterable], Iterable] | None = None,
    **env: Any,
) -> Tuning:
    """Tune every structure of a controller for a ship.

    A structure begins at the gains of `begin_at` or the tuned gains that there are, else at what
    the structures before it found, else at its own start.

    Parameters
    ----------
    controller : type
        With `KIND`, `TUNED`, ``first_gains(ship)`` and a constructor that takes gains; with
        ``structures(ship)`` if it has several.
    ship : str
        Name or file.
    size : Size, optional
    name : str, optional
        Of the controller in the file of gains: its `KIND` if omitted, ``file.py:Class`` of one's
        own.
    structures : iterable of str, optional
        Those to tune; all if omitted.
    begin_at : path, optional
        File of gains to begin at, as of another ship or guidance.
    progress : callable, optional
        Wraps an iterable of as many parts as the work has.
    **env
        Keyword arguments of ``rollout``; the scenario by default that of `scenario_for`.
    """
    size = size or Size()
    need_optuna()
    env = {"scenario": scenario_for(controller)} | env | {"ship": ship}
    task = begin(tuning_seeds(1), **env).scenario.task
    objective, known = objective_of(task), structures_of(controller, load_ship(ship), task)
    names = list(known if structures is None else structures)
    for structure in names:
        check_known("structure", structure, known)
    seeds = tuning_seeds((1 + VALIDATION) * size.episodes)
    tick = _ticker(progress, len(names) * (size.generations + bool(size.polish) + 1))
    of_task = own_task_of(controller, task)
    before, what = _read(find_gains(load_ship(ship).name, controller.KIND, of_task), controller)
    begun, where = _read(begin_at, controller) if begin_at else (before, what)
    ranking = []
    found: dict[str, Any] = {}
    for structure in names:
        gains, free = known[structure]
        ranges = _begun_at(ranges_of(controller, gains, free), begun, found)
        job = _Job(controller, objective, structure, gains, ranges, env)
        tuned, values = _tune_one(job, size, seeds, tick)
        ranking.append(tuned)
        found |= values
    ranking.sort(key=lambda tuned: tuned.cost)
    start = before or _starts(controller, load_ship(ship))
    old, new = _sail(controller(start), seeds[size.episodes :], env), ranking[0].episodes
    return Tuning(
        controller=name or controller.KIND,
        ship=load_ship(ship).name,
        objective=objective,
        ranking=tuple(ranking),
        before=what,
        begun=where,
        cost_before=float(objective.of(old).mean()),
        gained=estimate(objective.of(new) - objective.of(old), np.mean),
        changed={
            key: estimate(np.subtract(new[key], old[key]), np.mean)
            for key in (objective.name, *objective.beside, "rudder_travel")
        },
        task=of_task,
    )


def _read(path: str | Path | None, controller: type[Any]) -> tuple[Any, str]:
    """Gains of a file and what to call them; None without a file."""
    if path is None:
        return None, "the gains that tuning begins at"
    return load_gains(path, controller).gains, f"{Path(path).name}, sha256 {sha256(path)[:12]}"


def _sail(controller: Any, seeds: list[int], env: dict) -> dict[str, list[Any]]:
    """Metrics of every episode; those of a task's objective are numbers."""
    rows = per_episode(rollout(controller, seeds=seeds, parallel=False, **env))
    return {key: rows[key] for key in _REPORTED if key in rows}


def _starts(controller: type[Any], ship: Ship) -> Any:
    """Gains that tuning begins at where there are none."""
    gains = controller.first_gains(ship)
    starts = {name: start for name, (_, _, start) in controller.TUNED.items()}
    given = {k: v for k, v in starts.items() if v is not None and has_leaf(gains, k)}
    return with_leaves(gains, given)


def _begun_at(
    ranges: Mapping[str, Range], before: Any, found: Mapping[str, float]
) -> dict[str, Range]:
    """Ranges that begin at the gains of before, where they have such and it is in the range."""
    begun = {}
    for name, one in ranges.items():
        start = leaf(before, name) if has_leaf(before, name) else None
        if start is None or not one.low <= start <= one.high:
            start = found.get(name, one.start)
        begun[name] = one._replace(start=float(start))
    return begun


class _Job(NamedTuple):
    """One structure to be tuned."""

    controller: type[Any]
    objective: Objective
    structure: str
    gains: Any
    ranges: dict[str, Range]
    env: dict[str, Any]


def _tune_one(job: _Job, size: Size, seeds: list[int], tick: Callable[[], None]):
    """One structure tuned and validated, and its free gains by name."""
    kind, tuning, validation = job.controller, seeds[: size.episodes], seeds[size.episodes :]
    found, cost = search(
        lambda candidates: mean_costs(kind, job.gains, candidates, tuning, **job.env),
        job.ranges,
        size,
        tick,
    )
    best = with_leaves(job.gains, found)
    rows = _sail(kind(best), validation, job.env)
    tick()
    judged, bounds = float(job.objective.of(rows).mean()), at_bounds(found, job.ranges)
    bounds = {name: bounds[name] for name in can_widen(best, bounds, job.ranges)}
    return Tuned(job.structure, best, cost, judged, rows, bounds), found


def _ticker(progress: Callable | None, parts: int) -> Callable[[], None]:
    """What is called after each part of the work, to move a bar."""
    bar = iter(progress(range(parts)) if progress else range(parts))
    next(bar, None)
    return lambda: next(bar, None) and None
