"""Headroom of a scenario with a ship: doing nothing, the best classical controllers, the optimum.

The reference is the controller that is best by the measure on tuning seeds, so that the choice does
not look at the seeds that it is judged on. Reference, second best and doing nothing are then sailed
on test seeds, the optimum on the first of them.
"""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import json
import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, build, check_known
from ship_gym.conventions import wrap_angle
from ship_gym.envs.env import resolved_scenario
from ship_gym.evaluation.bound import ITERATIONS, optimum
from ship_gym.evaluation.controller import ConstantController, Controller
from ship_gym.evaluation.metrics import metrics, metrics_of
from ship_gym.evaluation.objectives import ERRORS, objectives_of
from ship_gym.evaluation.rollout import Rollout, rollout
from ship_gym.evaluation.score import FILE, OPTIMA, VERSION
from ship_gym.evaluation.splits import TUNING_SEED, evaluation_seeds
from ship_gym.evaluation.statistics import (
    CONFIDENCE,
    Estimate,
    Paired,
    draws,
    interquartile_mean,
    interquartile_weights,
    paired,
    tails,
)
from ship_gym.keys import read_keys
from ship_gym.provenance import provenance, sha256
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship
from ship_gym.tasks import TASKS
from ship_gym.writing import atomic_path

JUDGED = 64  # test seeds of reference, second best and doing nothing
OPTIMISED = {True: 32, False: 16}  # the first of them: of the optimum, of headings and of tracks
CHOICE = TUNING_SEED + 200_000  # first of the seeds to choose the reference on: none tunes there
LEAST = 5.0  # headroom [%] whose interval begins above this separates
PLAN, MINIMUM_TURN = OPTIMA


@dataclasses.dataclass(frozen=True)
class Cell:
    """One scenario with one ship; interquartile means over the seeds, in the unit of the measure.

    Attributes
    ----------
    measure : str
    nothing, reference : float
        Of the constant controller and of the reference.
    reference_controller : str
    second, second_controller : float and str, or None
        Of the second best controller; None if there is no other.
    difference : Paired or None
        Second best less best, mean over the seeds.
    optimum : float or None
        The reference less the headroom: the optimum brought from its seeds to those of the others.
    optimum_kind : str or None
        `PLAN`, `MINIMUM_TURN`; None: there is no optimum for this measure.
    optimum_seeds : int
    headroom : Estimate or None
        100 (1 - optimum / reference) of the same seeds [%].
    separates : bool
        Best and second best differ by more than their interval, or the interval of the headroom
        begins above `LEAST`: the search starts at the reference, so any headroom is above zero.
    inputs : str
        SHA-256 of what it was measured with, see `inputs_of`.
    """

    measure: str
    nothing: float
    reference: float
    reference_controller: str
    second: float | None
    second_controller: str | None
    difference: Paired | None
    optimum: float | None
    optimum_kind: str | None
    optimum_seeds: int
    headroom: Estimate | None
    separates: bool
    inputs: str = ""


def measure_cell(
    candidates: Mapping[str, Callable[[], Controller]],
    scenario: str | Mapping[str, Any] | Scenario,
    ship: str | Ship,
    measure: str | None = None,
    control: str | None = None,
    *,
    judged: int = JUDGED,
    optimised: int | None = None,
    iterations: int = ITERATIONS,
) -> Cell:
    """Measure one cell.

    Parameters
    ----------
    candidates : mapping
        Name to what makes the controller: every tuned classical one.
    scenario, ship, control
        As in ``rollout``.
    measure : str, optional
        A metric of which less is better; the task's headline if omitted.
    judged, optimised : int
        Seeds; the latter, those of the optimum, at most as many: `OPTIMISED` if omitted.
    iterations : int
        Of the optimum.

    Raises
    ------
    ConfigError
        No candidates, or a measure that cannot be scored.
    """
    env: dict[str, Any] = {
        "scenario": scenario,
        "ship": ship,
        "control": control,
        "parallel": False,
    }
    resolved, _ = resolved_scenario(scenario, ship, control, None, None, None)
    measure = _checked(resolved.task, measure)
    names = _ranked(candidates, measure, range(CHOICE, CHOICE + judged), env)
    seeds = evaluation_seeds(judged)
    sailed = {name: rollout(candidates[name](), seeds=seeds, **env) for name in names[:2]}
    values = {name: values_of(found, measure) for name, found in sailed.items()}
    nothing = values_of(rollout(ConstantController(), seeds=seeds, **env), measure)
    reference, second = values[names[0]], values[names[1]] if len(names) > 1 else None
    difference = None if second is None else paired(second, reference)
    starts = [candidates[name]() for name in names[:2]]
    kind, best = _optimum(starts, sailed[names[0]], measure, optimised, iterations, env)
    headroom = None if best is None else relative(best, reference[: len(best)])
    middle = float(interquartile_mean(reference))
    return Cell(
        measure=measure,
        nothing=float(interquartile_mean(nothing)),
        reference=middle,
        reference_controller=names[0],
        second=None if second is None else float(interquartile_mean(second)),
        second_controller=names[1] if len(names) > 1 else None,
        difference=difference,
        optimum=None if headroom is None else middle * (1.0 - headroom.value / 100.0),
        optimum_kind=kind,
        optimum_seeds=0 if best is None else len(best),
        headroom=headroom,
        separates=separates(difference, headroom),
    )


def separates(difference: Paired | None, headroom: Estimate | None) -> bool:
    """Whether a cell can tell controllers apart, see `Cell`."""
    apart = (
        difference is not None
        and difference.low is not None
        and difference.high is not None
        and not difference.low <= 0.0 <= difference.high
    )
    return apart or (headroom is not None and headroom.low is not None and headroom.low > LEAST)


def values_of(sailed: Rollout, measure: str) -> np.ndarray:
    """A metric of every episode, shape (n,)."""
    return np.array([metrics(sailed.trajectory(i))[measure] for i in range(len(sailed))])


def relative(values: np.ndarray, reference: np.ndarray) -> Estimate:
    """100 (1 - middle of values / middle of reference) [%], middles of the same seeds.

    The interval is the percentile bootstrap over the seeds, drawn together for both.
    """
    value = 100.0 * (1.0 - interquartile_mean(values) / interquartile_mean(reference))
    if len(values) < 2:
        return Estimate(float(value), None, None)
    counts = draws(len(values))
    low, high = tails(100.0 * (1.0 - _middles(values, counts) / _middles(reference, counts)))
    return Estimate(float(value), float(low), float(high))


def _middles(values: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """Interquartile means of resamples, shape (resamples,)."""
    order = np.argsort(values, kind="stable")
    return interquartile_weights(counts[:, order]) @ values[order]


def _checked(task: str, measure: str | None) -> str:
    """The measure, refused where less of it is not better."""
    known = metrics_of(task)
    measure = TASKS[task].headline if measure is None else measure
    check_known(f"measure of task {task!r}", measure, known)
    if known[measure].better != "lower":
        raise ConfigError(f"measure {measure!r}: more of it is better; a score needs less")
    return measure


def _ranked(candidates, measure: str, seeds: Sequence[int], env: Mapping[str, Any]) -> list[str]:
    """Names of the candidates, the best on these seeds first; those that cannot sail are left out.

    One whose measure no episode has is last.
    """
    found, refused = {}, []
    for name, make in candidates.items():
        try:
            values = values_of(rollout(make(), seeds=seeds, **env), measure)
        except ConfigError as error:  # no gains of this ship, an observation of another task
            refused.append(str(error))
            continue
        found[name] = float(interquartile_mean(values))
    if not found:
        raise ConfigError(f"no classical controller sails {env['scenario']}: {'; '.join(refused)}")
    return sorted(found, key=lambda name: (math.isnan(found[name]), found[name]))


def _optimum(starts, reference: Rollout, measure: str, n: int | None, iterations: int, env):
    """Kind and values (n,) of the optimum on the first seeds; None, None if there is none."""
    task = reference.scenario.task
    if n is None:
        n = OPTIMISED[task not in ERRORS or ERRORS[task].turns]
    n = min(n, len(reference))
    if measure == "settling_time" and task == "course_changing":
        return MINIMUM_TURN, minimum_turns(reference, n)
    if task not in ERRORS or measure not in objectives_of(task):
        return None, None
    seeds = reference.seeds[:n]
    found = optimum(starts, seeds=seeds, measure=measure, iterations=iterations, **env)
    return PLAN, values_of(found.rollout, measure)


def minimum_turns(sailed: Rollout, n: int) -> np.ndarray:
    """Mean minimum time of the steps that the first n episodes order [s], in calm water, (n,)."""
    from ship_gym.evaluation.minimum_turn import minimum_turn_time

    found = []
    for begins, orders in np.moveaxis(sailed.plans[:n], 2, 1):
        steps = np.abs(wrap_angle(np.diff(orders)))[begins[1:] < sailed.scenario.steps]
        times = [minimum_turn_time(sailed.ship, float(step)) for step in steps]
        found.append(np.mean(times))
    return np.array(found)


def inputs_of(scenario: Scenario, measure: str, named: Sequence[str], files: Sequence[Path]) -> str:
    """SHA-256 of what a cell depends on: scenario, measure, seeds, names and files of controllers.

    The code is not part of it: the commit stands in the file.

    Parameters
    ----------
    scenario : Scenario
    measure : str
    named : sequence of str
        The candidates.
    files : sequence of Path
        Of the ship and of the controllers' gains.
    """
    parts = [scenario.to_dict(), measure, sorted(named), CHOICE, JUDGED, list(OPTIMISED.values())]
    parts += [[path.name, sha256(path)] for path in sorted(files)]
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()


@functools.cache
def read(path: Path = FILE) -> dict[str, dict[str, Any]]:
    """Cells by ``scenario/ship``; none if there is no file."""
    if not path.is_file():
        return {}
    found = read_keys(path).table("cells").tables()
    cells = {name: build(Cell, cell.values, f"{path}: {cell.name}") for name, cell in found}
    return {name: dataclasses.asdict(cell) for name, cell in cells.items()}


def write(cells: Mapping[str, Mapping[str, Any]], path: Path = FILE) -> None:
    """Write cells, by name, with what made them."""
    first = evaluation_seeds(1)[0]
    data = {
        "version": VERSION,
        "seeds": [first, JUDGED],
        "choice_seeds": [CHOICE, JUDGED],
        "confidence": CONFIDENCE,
        "cells": {name: dict(cells[name]) for name in sorted(cells)},
        **provenance(),
    }
    with atomic_path(path) as temporary:
        temporary.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    read.cache_clear()
