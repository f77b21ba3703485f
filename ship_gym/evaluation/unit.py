"""Work units of a benchmark: some episodes of one controller, whose rows depend on nothing else.

A unit can be sailed anywhere, in any order: it holds names and seeds, makes its own controller and
gives plain values.
"""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ship_gym.conventions import polar, wrap_angle
from ship_gym.envs.episodes import EpisodeBatch
from ship_gym.envs.registration import load_task
from ship_gym.evaluation.controller import Controller
from ship_gym.evaluation.guard import ControllerFailed, ControllerRefused, Guarded, told
from ship_gym.evaluation.metrics import metrics
from ship_gym.evaluation.rollout import Rollout, begin, rollout, weather_of
from ship_gym.evaluation.suite import Entry

CHUNK = 16  # seeds of a unit at most
_TIMED = 60  # intervals over which decisions are timed
FAILED = "error"  # outcome of an episode whose controller failed


@dataclasses.dataclass(frozen=True)
class Entrant:
    """A controller that takes part.

    Attributes
    ----------
    named : str
        As it was asked for.
    name : str
        Of the controller itself: what tables show.
    make : callable
        ``make()`` is a new one. It travels to other processes: a function of a module, or a
        ``functools.partial`` of one.
    kind : str
        ``classical``, ``policy`` or ``own``.
    about : mapping
        Plain values: its source, what it was trained on, the SHA of its files.
    """

    named: str
    name: str
    make: Callable[[], Controller]
    kind: str
    about: Mapping[str, Any] = dataclasses.field(default_factory=dict)


@dataclasses.dataclass(frozen=True)
class Unit:
    """At most `CHUNK` episodes of one controller in one scenario with one ship.

    Attributes
    ----------
    suite, version : str
    entry : Entry
    tasks : tuple of str
        Files of tasks of one's own.
    ship : str
    entrant : Entrant
    seeds : tuple of int
    patience : float
        Longest mean time of a decision, in control intervals of the ship.
    """

    suite: str
    version: str
    entry: Entry
    tasks: tuple[str, ...]
    ship: str
    entrant: Entrant
    seeds: tuple[int, ...]
    patience: float

    @property
    def env(self) -> dict[str, Any]:
        """Arguments of `rollout`; one thread, since units are sailed side by side."""
        found = {"scenario": self.entry.name, "ship": self.ship, "control": self.entry.control}
        return {**found, "parallel": False}

    def __str__(self) -> str:
        return f"{self.entrant.name} in {self.entry.name} with {self.ship}"


@dataclasses.dataclass(frozen=True)
class Sailed:
    """Rows of a unit, as ``episodes_table`` has them, and how long it took [s]."""

    rows: list[dict[str, Any]]
    seconds: float


def chunks(seeds: Sequence[int]) -> list[tuple[int, ...]]:
    """Seeds in parts of at most `CHUNK`."""
    return [tuple(seeds[k : k + CHUNK]) for k in range(0, len(seeds), CHUNK)]


def sail(unit: Unit) -> Sailed:
    """Sail a unit: timed with one ship for a minute, then all its episodes together.

    Where the controller fails, each episode is sailed alone, so that only those are lost in which
    it does.

    Raises
    ------
    ConfigError
        The scenario or the ship cannot be used; whatever a controller does is in the rows.
    """
    start = time.perf_counter()
    shared, dt = _begun(unit)
    decision_ms, slow = _timed(unit, dt)
    rows = _lost(slow) if slow else _sailed(unit, unit.seeds, dt)
    every = {"decision_ms": decision_ms}
    rows = {seed: shared[seed] | every | row for seed, row in rows.items()}
    return Sailed([rows[seed] for seed in unit.seeds], time.perf_counter() - start)


def lost(unit: Unit, what: str) -> Sailed:
    """Rows of a unit that could not be sailed at all, such as one that ends its process."""
    rows = _lost(ControllerFailed(unit.entrant.name, unit.seeds, -1, what))
    return Sailed([shared | rows[seed] for seed, shared in _begun(unit)[0].items()], 0.0)


def _begun(unit: Unit) -> tuple[dict[int, dict[str, Any]], float]:
    """What rows say whatever the controller does, by seed, and the ship's control interval [s]."""
    for name in unit.tasks:
        load_task(name)
    batch = begin(unit.seeds, **unit.env)
    task = batch.task
    found = {
        "suite": unit.suite,
        "version": unit.version,
        "scenario": unit.entry.name,
        "tier": unit.entry.tier,
        "task": task.name,
        "ship": unit.ship,
        "controller": unit.entrant.name,
        "kind": unit.entrant.kind,
        "measure": unit.entry.measure or task.headline,
        "error": "",
    }
    weather = zip(unit.seeds, _weather(batch), strict=True)
    rows = {seed: {**found, "seed": seed, **row} for seed, row in weather}
    return rows, float(batch.dt[0])


def _weather(batch: EpisodeBatch) -> list[dict[str, float | None]]:
    """Weather of episodes that have begun, as columns of the table have it."""
    found, seas = weather_of(batch), batch.sim.seas
    current, current_to = polar(seas["V_north"], seas["V_east"])
    of = {
        "wave": (found["wave_height"], found["wave_direction_to"]),
        "wind": (found["wind_speed"], found["wind_direction_to"]),
        "current": (current, current_to),
    }
    columns = {"wave_height": found["wave_height"], "wave_period": found["wave_period"]}
    columns |= {"wind_speed": found["wind_speed"], "current_speed": current}
    for name, (size, to) in of.items():
        angle = np.degrees(wrap_angle(batch.tasks["psi_ordered"] - to))
        angle[angle < 1e-9 - 180.0] += 360.0  # a head sea is one at 180, however it was rounded
        columns[f"{name}_encounter_deg"] = np.where(size > 0.0, angle, math.nan)
    columns["wave_period"] = np.where(found["wave_height"] > 0.0, found["wave_period"], math.nan)
    names = list(columns)
    rows = zip(*(columns[name].tolist() for name in names), strict=True)
    return [dict(zip(names, row, strict=True)) for row in rows]


def _guarded(unit: Unit, seeds: Sequence[int], dt: float) -> Guarded:
    """A new controller under guard; dt is the control interval of the ship [s]."""
    try:
        made = unit.entrant.make()
    except (Exception, SystemExit) as error:
        raise ControllerFailed(unit.entrant.name, seeds, -1, told(error)) from error
    return Guarded(made, seeds, unit.patience * dt)


def _timed(unit: Unit, dt: float) -> tuple[float | None, ControllerFailed | None]:
    """Mean time of a decision for one ship alone [ms] and, if it is too long, that failure.

    The first decision, which may load or compile, does not count. None where the controller fails:
    the episodes tell of that.
    """
    batch = begin(unit.seeds[:1], **unit.env)
    seconds: list[float] = []
    slow = None
    try:
        guarded = _guarded(unit, unit.seeds[:1], dt)
        guarded.reset(1, batch.ship, batch.scenario)
        seconds = guarded.seconds
        for _ in range(min(_TIMED, batch.scenario.steps)):
            batch.step(guarded.act(batch.observations))
            if batch.terminated[0]:
                break
    except ControllerFailed as failed:
        if not failed.slow:
            return None, None
        slow = ControllerFailed(failed.controller, unit.seeds, failed.interval, failed.what, True)
    counted = seconds[1:] or seconds
    return 1e3 * float(np.mean(counted)), slow


def _sailed(unit: Unit, seeds: Sequence[int], dt: float) -> dict[int, dict[str, Any]]:
    """Rows of some episodes by seed: sailed together if the controller can, else one by one."""
    try:
        found = rollout(_guarded(unit, seeds, dt), seeds=seeds, **unit.env)
    except ControllerFailed as failed:
        if failed.slow or isinstance(failed, ControllerRefused) or len(seeds) == 1:
            return _lost(failed)
        return {seed: row for one in seeds for seed, row in _sailed(unit, [one], dt).items()}
    return {seed: _row(found, i, unit.entry.measure) for i, seed in enumerate(found.seeds)}


def _row(found: Rollout, i: int, measure: str | None) -> dict[str, Any]:
    """What an episode that was sailed adds to its row."""
    recorded = found.trajectory(i)
    values = metrics(recorded)
    return {
        "value": values[measure or found.task.headline],
        **values,
        "outcome": recorded.meta["outcome"],
        "failed": recorded.meta["failed"],
        "length": int(found.lengths[i]),
    }


def _lost(failed: ControllerFailed) -> dict[int, dict[str, Any]]:
    """What the episodes that a controller spoilt add to their rows, by seed."""
    row = {
        "outcome": FAILED,
        "failed": True,
        "length": max(failed.interval, 0),
        "error": f"{failed.place}: {failed.what}",
    }
    return dict.fromkeys(failed.seeds, row)
