"""What a benchmark sails, checked before any of it is sailed."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError, check_known, check_number
from ship_gym.envs.episodes import EpisodeBatch
from ship_gym.envs.registration import load_task
from ship_gym.evaluation.guard import ControllerFailed, ControllerRefused, Guarded
from ship_gym.evaluation.metrics import metrics_of
from ship_gym.evaluation.rollout import begin
from ship_gym.evaluation.splits import evaluation_seeds
from ship_gym.evaluation.suite import ALWAYS, Entry, Suite, load_suites
from ship_gym.evaluation.unit import Entrant, Unit, chunks
from ship_gym.provenance import provenance

PATIENCE = 1.0  # control intervals that a decision may take in the mean: real time
Progress = Callable[[Iterable, str, int], Iterable]


@dataclasses.dataclass(frozen=True)
class Cell:
    """One scenario with one ship, and the controllers that sail it, as they were asked for."""

    suite: Suite
    entry: Entry
    ship: str
    controllers: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.suite.name}: {self.entry.name} with {self.ship}"


@dataclasses.dataclass(frozen=True)
class Plan:
    """What a benchmark sails.

    Attributes
    ----------
    suites : list of Suite
    cells : list of Cell
    entrants : dict of str to Entrant
        By the name they were asked for.
    refused : list of dict
        Controllers that say themselves that they cannot sail a cell: ``controller``, ``scenario``,
        ``ship``, ``why``.
    seeds : tuple of int
    patience : float
    """

    suites: list[Suite]
    cells: list[Cell]
    entrants: dict[str, Entrant]
    refused: list[dict[str, str]]
    seeds: tuple[int, ...]
    patience: float

    def units(self) -> list[Unit]:
        """Work units, in the order of the suites; their place in it is their number."""
        return [
            Unit(
                suite=cell.suite.name,
                version=cell.suite.version,
                entry=cell.entry,
                tasks=cell.suite.tasks,
                ship=cell.ship,
                entrant=self.entrants[named],
                seeds=part,
                patience=self.patience,
            )
            for cell in self.cells
            for named in cell.controllers
            for part in chunks(self.seeds)
        ]

    def settings(self) -> dict[str, Any]:
        """All that decides the rows, as plain values."""
        ships: dict[str, list[str]] = {}
        for cell in self.cells:
            ships.setdefault(cell.suite.name, []).append(cell.ship)
        return {
            "suite": {suite.name: suite.sha256 for suite in self.suites},
            "seeds": list(self.seeds),
            "controllers": self.about_controllers(),
            "ships": {suite: list(dict.fromkeys(names)) for suite, names in ships.items()},
            "cells": {str(cell): list(cell.controllers) for cell in self.cells},
            "patience": self.patience,
            **provenance(),
        }

    def about_controllers(self) -> dict[str, dict[str, Any]]:
        """What the controllers are, by their own names."""
        return {
            one.name: {"named": one.named, "kind": one.kind, **one.about}
            for one in self.entrants.values()
        }


def plan(
    suite: str | Path | Sequence[str | Path],
    entrant: Callable[[str], Entrant],
    *,
    controllers: Sequence[str] = (),
    ships: Sequence[str] = (),
    seeds: int | Sequence[int] = 64,
    patience: float = PATIENCE,
    progress: Progress | None = None,
) -> Plan:
    """What a benchmark with these arguments sails.

    Parameters are those of ``benchmark.benchmark``.

    Raises
    ------
    ConfigError
        Unknown suite, scenario, ship, controller or measure (with the nearest one), a scenario
        that a ship cannot sail, a controller that can sail nothing, or a number outside its range.
    """
    suites = load_suites(suite)
    numbers = tuple(evaluation_seeds(seeds) if isinstance(seeds, int) else map(int, seeds))
    if len(set(numbers)) < len(numbers) or not numbers:
        raise ConfigError(f"seeds = {list(numbers)[:8]}: at least one is needed, each once")
    check_number("patience", patience, 1e-6, 1e6)
    for task in itertools.chain(*(one.tasks for one in suites)):
        load_task(task)
    cells = [cell for one in suites for cell in _cells(one, controllers, ships)]
    if not cells:  # suites of another kind have their own way
        raise ConfigError(
            f"suite {suites[0].name}: kind {suites[0].kind!r} has no episodes to sail"
        )
    named = dict.fromkeys(itertools.chain(*(cell.controllers for cell in cells)))
    entrants = {name: entrant(name) for name in named}
    _check_names(entrants)
    kept, refused = [], []
    judge = _Judge(entrants)
    for cell in progress(cells, "checking", len(cells)) if progress else cells:
        batch = _begun(cell, numbers[0])
        why = {name: judge.refuses(name, batch, numbers[0]) for name in cell.controllers}
        where = {"scenario": cell.entry.name, "ship": cell.ship}
        refused += [{"controller": n, **where, "why": text} for n, text in why.items() if text]
        sails = tuple(name for name, text in why.items() if not text)
        kept.append(dataclasses.replace(cell, controllers=sails))
    _check_someone_sails(kept, refused)
    return Plan(suites, kept, entrants, refused, numbers, float(patience))


def _cells(suite: Suite, controllers: Sequence[str], ships: Sequence[str]) -> list[Cell]:
    """Cells of a suite; doing nothing is always among the controllers."""
    found = []
    for entry in suite.scenario:
        named = dict.fromkeys([ALWAYS, *(controllers or entry.controllers or suite.controllers)])
        for ship in dict.fromkeys(ships or entry.ships or suite.ships):
            # who is asked for by name sails every ship
            sails = [name for name in named if controllers or suite.sails(name, ship)]
            found.append(Cell(suite, entry, ship, tuple(sails)))
    return found


def _check_names(entrants: dict[str, Entrant]) -> None:
    names = [one.name for one in entrants.values()]
    if double := sorted({name for name in names if names.count(name) > 1}):
        raise ConfigError(f"two controllers are named {double[0]!r}; give one another name")


def _begun(cell: Cell, seed: int) -> EpisodeBatch:
    """An episode of a cell; refused where the ship cannot sail it or the measure is unknown."""
    entry = cell.entry
    try:
        batch = begin([seed], entry.name, ship=cell.ship, control=entry.control, parallel=False)
        check_known("measure", entry.measure or batch.task.headline, metrics_of(batch.task.name))
    except ConfigError as error:
        raise ConfigError(f"suite {cell.suite.name}, scenario {entry.name}: {error}") from error
    return batch


class _Judge:
    """Asks controllers whether they sail something, once for everything that is alike to them."""

    def __init__(self, entrants: dict[str, Entrant]):
        self._entrants = entrants
        self._known: dict[Any, Any] = {}

    def refuses(self, named: str, batch: EpisodeBatch, seed: int) -> str:
        """Why a controller says that it cannot steer this; "" if it does not.

        One that fails in another way is not asked twice: its episodes will tell.
        """
        scenario = batch.scenario
        alike = (scenario.task, scenario.control, scenario.privileged, scenario.ship)
        if (named, *alike) not in self._known:
            self._known[named, *alike] = ""
            try:
                guarded = Guarded(self._entrants[named].make(), [seed])
                guarded.reset(1, batch.ship, scenario)
            except ControllerRefused as error:
                self._known[named, *alike] = error.what
            except ControllerFailed:
                pass
        return self._known[named, *alike]


def _check_someone_sails(cells: Sequence[Cell], refused: Sequence[dict[str, str]]) -> None:
    """Refuse a controller that can sail none of the cells."""
    sails = set(itertools.chain(*(cell.controllers for cell in cells)))
    for one in refused:
        if one["controller"] not in sails:
            raise ConfigError(f"controller {one['controller']} sails nothing here: {one['why']}")
