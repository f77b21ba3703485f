"""A benchmark: controllers in the scenarios of suites, on the same episodes, kept unit by unit."""

from __future__ import annotations

import contextlib
import dataclasses
import os
import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError, check_known, check_number
from ship_gym.envs.registration import load_task
from ship_gym.evaluation.engines import ENGINES, engine_of
from ship_gym.evaluation.episodes_table import Results, arrow, table_of, write_results
from ship_gym.evaluation.metrics import metrics_of
from ship_gym.evaluation.rollout import begin
from ship_gym.evaluation.run_folder import RunFolder
from ship_gym.evaluation.splits import evaluation_seeds
from ship_gym.evaluation.suite import ALWAYS, Entry, Suite, load_suites
from ship_gym.evaluation.unit import Entrant, Sailed, Unit, chunks
from ship_gym.provenance import provenance
from ship_gym.reports.speed import machine

PATIENCE = 1.0  # control intervals that a decision may take in the mean: real time
Progress = Callable[[Iterable, str, int], Iterable]


@dataclasses.dataclass(frozen=True)
class Plan:
    """What a benchmark sails, checked.

    Attributes
    ----------
    suites : list of Suite
    entrants : dict of str to Entrant
        By the name they were asked for.
    sailed : dict
        Suite -> pairs (controller as asked for, ship).
    seeds : tuple of int
    patience : float
    """

    suites: list[Suite]
    entrants: dict[str, Entrant]
    sailed: dict[str, list[tuple[str, str]]]
    seeds: tuple[int, ...]
    patience: float

    def units(self) -> list[Unit]:
        """Work units, in the order of the suites; their place in it is their number."""
        return [
            Unit(
                suite.name, suite.version, entry, suite.tasks, ship, self.entrants[named], part,
                self.patience,
            )
            for suite in self.suites
            for entry in suite.scenario
            for named, ship in self.sailed[suite.name]
            for part in chunks(self.seeds)
        ]  # fmt: skip

    def settings(self) -> dict[str, Any]:
        """All that decides the rows, as plain values."""
        return {
            "suite": {suite.name: suite.sha256 for suite in self.suites},
            "seeds": list(self.seeds),
            "controllers": {
                one.name: {"named": one.named, "kind": one.kind, **one.about}
                for one in self.entrants.values()
            },
            "ships": self.sailed,
            "patience": self.patience,
            **provenance(),
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
    """What a benchmark with these arguments sails, everything checked before any work.

    Parameters are those of `benchmark`.

    Raises
    ------
    ConfigError
        Unknown suite, scenario, ship, controller or measure (with the nearest one), a scenario
        that a ship cannot sail, or a number outside its range.
    """
    suites = load_suites(suite)
    numbers = tuple(evaluation_seeds(seeds) if isinstance(seeds, int) else map(int, seeds))
    if len(set(numbers)) < len(numbers) or not numbers:
        raise ConfigError(f"seeds = {list(numbers)[:8]}: at least one is needed, each once")
    check_number("patience", patience, 1e-6, 1e6)
    sailed, entrants = {}, {}
    for one in suites:
        sailed[one.name] = _pairs(one, controllers, ships)
        for task in one.tasks:
            load_task(task)
    for named in dict.fromkeys(named for pairs in sailed.values() for named, _ in pairs):
        entrants[named] = entrant(named)
    _check_names(entrants)
    made = Plan(suites, entrants, sailed, numbers, float(patience))
    cells = [
        (one, entry, ship)
        for one in suites
        for entry in one.scenario
        for ship in dict.fromkeys(ship for _, ship in sailed[one.name])
    ]
    for one, entry, ship in progress(cells, "checking", len(cells)) if progress else cells:
        _check_cell(one, entry, ship, numbers[0])
    return made


def _pairs(suite: Suite, controllers: Sequence[str], ships: Sequence[str]) -> list[tuple[str, str]]:
    """Controllers with the ships that each sails; doing nothing is always among them."""
    if suite.kind != "episodes":
        return []
    named = list(dict.fromkeys([ALWAYS, *(controllers or suite.controllers)]))
    free = bool(controllers)  # who is asked for by name sails every ship
    return [
        (name, ship)
        for ship in dict.fromkeys(ships or suite.ships)
        for name in named
        if free or suite.sails(name, ship)
    ]


def _check_names(entrants: dict[str, Entrant]) -> None:
    names = [one.name for one in entrants.values()]
    if double := sorted({name for name in names if names.count(name) > 1}):
        raise ConfigError(f"two controllers are named {double[0]!r}; give one another name")


def _check_cell(suite: Suite, entry: Entry, ship: str, seed: int) -> None:
    """Refuse a scenario that a ship cannot sail, by beginning one episode of it."""
    where = f"suite {suite.name}, scenario {entry.name}"
    try:
        batch = begin([seed], entry.name, ship=ship, control=entry.control, parallel=False)
        check_known("measure", entry.measure or batch.task.headline, metrics_of(batch.task.name))
    except ConfigError as error:
        raise ConfigError(f"{where}: {error}") from error


def benchmark(
    suite: str | Path | Sequence[str | Path],
    entrant: Callable[[str], Entrant],
    *,
    controllers: Sequence[str] = (),
    ships: Sequence[str] = (),
    seeds: int | Sequence[int] = 64,
    engine: str = "local",
    address: str | None = None,
    jobs: int = 1,
    out: str | os.PathLike = "runs/benchmark",
    fresh: bool = False,
    patience: float = PATIENCE,
    progress: Progress | None = None,
    command: str = "",
) -> Results:
    """Sail controllers in the scenarios of suites and keep one row for each episode.

    Finished units are kept in `out`: a run that was killed goes on where it was when it is asked
    for again, and gives the same rows. Rows do not depend on `engine` and `jobs`.

    Parameters
    ----------
    suite : str, path or sequence of them
        Of `available_suites()`, the path of a TOML file, or ``"all"``.
    entrant : callable
        ``entrant(name)`` is the controller of that name; ``ship_gym_agents.entrants.entrant``
        takes the names of ``make_controller``.
    controllers, ships : sequence of str
        Instead of the suite's; ``constant`` always sails, for the scores need it.
    seeds : int or sequence of int
        How many evaluation seeds, or which ones.
    engine : {"local", "ray"}
    address : str, optional
        Of a Ray cluster; without one Ray runs on this machine.
    jobs : int
        Processes; 1 (local): this one.
    out : path-like
        Folder of the run; the table is its ``episodes.parquet``.
    fresh : bool
        Begin anew where a run is.
    patience : float
        A controller whose decisions take longer than so many control intervals of the ship, in
        the mean, fails as too slow.
    progress : callable, optional
        ``progress(iterable, description, total)``.
    command : str
        Kept with the results.

    Raises
    ------
    ConfigError
        See `plan`; also a folder with another run, or one that another process uses.
    ImportError
        A library is missing; says how to install it.
    """
    check_known("engine", engine, ENGINES)
    jobs = int(check_number("jobs", jobs, 1, 1024))
    arrow()  # refuses before the work
    sail = engine_of(engine, jobs, address)
    made = plan(
        suite, entrant, controllers=controllers, ships=ships, seeds=seeds, patience=patience,
        progress=progress,
    )  # fmt: skip
    folder, start = RunFolder(out), time.perf_counter()
    with folder.locked():
        folder.begin(made.settings(), fresh)
        units = dict(enumerate(made.units()))
        found = {number: kept for number in units if (kept := folder.kept(number)) is not None}
        n_kept = len(found)
        todo = {number: unit for number, unit in units.items() if number not in found}
        running = sail(todo)
        shown = progress(running, "sailing", len(todo)) if progress else running
        try:
            with contextlib.closing(running):
                for number, sailed in shown:
                    folder.keep(number, sailed)
                    found[number] = sailed
        except KeyboardInterrupt:
            raise KeyboardInterrupt(
                f"interrupted: {len(found)} of {len(units)} units are kept in {folder.path}; the "
                "same call goes on from there"
            ) from None
        about = _about(made, found.values(), command) | {
            "engine": engine,
            "jobs": jobs,
            "wall_time": time.perf_counter() - start,
            "units": len(units),
            "units_kept": n_kept,
        }
        results = Results(table_of(row for one in found.values() for row in one.rows), about)
        write_results(folder.episodes, results)
    return results


def _about(made: Plan, sailed: Iterable[Sailed], command: str) -> dict[str, Any]:
    """What the file of results says of how it was made, but for the run itself."""
    return {
        "suites": {
            suite.name: {
                "version": suite.version,
                "title": suite.title,
                "sha256": suite.sha256,
                "scenarios": [entry.name for entry in suite.scenario],
                "controls": {e.name: e.control for e in suite.scenario if e.control},
            }
            for suite in made.suites
        },
        "seeds": list(made.seeds),
        "ships": list(dict.fromkeys(ship for pairs in made.sailed.values() for _, ship in pairs)),
        "controllers": made.settings()["controllers"],
        "patience": made.patience,
        "computing_time": sum(one.seconds for one in sailed),
        "machine": machine(),
        "command": command,
        **provenance(),
    }
