"""How policies of a run are compared: one stated score, on validation seas."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ship_gym.evaluation.choice import deciding, ranked
from ship_gym.evaluation.controller import Controller
from ship_gym.evaluation.metrics import metrics, metrics_of
from ship_gym.evaluation.rollout import Rollout, rollout
from ship_gym.recording.trajectory import Trajectory
from ship_gym.scenarios.scenario import Scenario
from ship_gym.tasks import TASKS

_ENERGY = "voyage_energy"
_BESIDE = ("return", "success", "rudder_travel", "rudder_reversals")


class Score(NamedTuple):
    """The measure that policies are chosen by.

    Attributes
    ----------
    name, unit, better : str
        As in the metrics of the task; `better` is "lower" or "higher".
    limit : float, optional
        Rudder travel that should not be exceeded [deg/h].
    wear : float
        What a deg/h of rudder travel counts, in the unit of the measure.
    """

    name: str
    unit: str
    better: str
    limit: float | None = None
    wear: float = 0.0

    @property
    def text(self) -> str:
        """The rule in words."""
        unit = "" if self.unit == "-" else f" [{self.unit}]"
        held = "" if self.limit is None else f"rudder travel up to {self.limit:.4g} deg/h, then "
        sign = "+" if self.better == "lower" else "-"
        wear = f" {sign} {self.wear:.3g} rudder travel [deg/h]" if self.wear else ""
        return f"fewest failures, then {held}mean {self.name}{unit}{wear}, {self.better} is better"

    def key(self, found: Mapping[str, Any]) -> tuple[float, bool, float, float]:
        """Sort key of a validation: the best is the smallest.

        Where no episode has a value, since all are too short, the return decides.
        """
        value, sign = found.get(self.name), 1.0 if self.better == "lower" else -1.0
        above = self.limit is not None and found["rudder_travel"] > self.limit
        return (
            -found["success"],
            above,
            np.inf if value is None else sign * value + self.wear * found["rudder_travel"],
            -found["return"],
        )


def score_of(scenario: Scenario, wear: float = 0.0) -> Score:
    """The score of a scenario: the headline of its task; the energy of a voyage at free speed.

    Parameters
    ----------
    scenario : Scenario
    wear : float
        See `Score`.
    """
    known, name = metrics_of(scenario.task), TASKS[scenario.task].headline
    if scenario.control == "rudder+rpm" and _ENERGY in known:
        name = _ENERGY
    return Score(name, known[name].unit, known[name].better, wear=wear)


class Validation(NamedTuple):
    """Sailed validation episodes: means, values of each episode, and how long it took [s].

    Attributes
    ----------
    means, each : dict
    seconds : float
    worst : Trajectory or None
        The worst episode, if it was asked for; None also where none could be judged.
    """

    means: dict[str, float | None]
    each: dict[str, list[float | None]]
    seconds: float
    worst: Trajectory | None = None


def validate(
    policy: Controller,
    scenario: Scenario,
    seeds: Sequence[int],
    score: Score | None = None,
    ships: Sequence[str] = (),
    worst: bool = False,
) -> Validation:
    """Sail one episode per seed; with `ships` these take turns, so each counts as much.

    Episodes that failed count as their metric says (``tasks.measures``); those without a value of
    one are left out of its mean.

    Parameters
    ----------
    policy, scenario, seeds, score, ships
    worst : bool
        Give the worst episode too: of those that failed, else by the score's measure, where no
        episode has a value of that by the return.

    Returns
    -------
    Validation
        Means of the score, return, success, rudder's travel and reversals; None where no episode
        has a value.
    """
    began = time.monotonic()
    score = score_of(scenario) if score is None else score
    # One thread: threads that wait for each other on a shared machine are slower than none.
    found: list[Any] = [None] * len(seeds)
    sailed: list[Any] = [None] * len(seeds)
    for k, ship in enumerate(ships or (None,)):
        own = slice(k, None, len(ships) or 1)
        if seeds[own]:
            one = rollout(policy, scenario, seeds=seeds[own], ship=ship, parallel=False)
            found[own] = [metrics(episode) for episode in one.episodes]
            sailed[own] = [(one, i) for i in range(len(one))]
    columns = {n: [row[n] for row in found] for n in dict.fromkeys((score.name, *_BESIDE))}
    means = {name: _mean(column) for name, column in columns.items()}
    shown = _worst(scenario.task, score.name, columns, sailed) if worst else None
    return Validation(means, columns, time.monotonic() - began, shown)


def _worst(
    task: str, name: str, columns: dict[str, list], sailed: Sequence[tuple[Rollout, int]]
) -> Trajectory | None:
    """The worst of the episodes, each given as its rollout and its number in that."""
    by = deciding(name, columns)
    failed = [bool(one.failed[i]) for one, i in sailed]
    order = ranked(columns[by], metrics_of(task)[by].better, failed)
    if not order:
        return None
    one, i = sailed[order[-1]]
    return one.trajectory(i)


def _mean(column: Sequence[float | None]) -> float | None:
    known = [value for value in column if value is not None]
    return float(np.mean(known)) if known else None
