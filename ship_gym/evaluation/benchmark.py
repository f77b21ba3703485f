"""A benchmark: controllers in the scenarios of suites, on the same episodes, kept unit by unit."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from ship_gym.config import check_number
from ship_gym.envs.registration import load_task
from ship_gym.evaluation.engines import engine_of
from ship_gym.evaluation.episodes_table import Results, arrow, table_of, write_results
from ship_gym.evaluation.plan import PATIENCE, Plan, Progress, plan
from ship_gym.evaluation.run_folder import RunFolder
from ship_gym.evaluation.unit import Entrant, Sailed
from ship_gym.evaluation.worst_recordings import record_worst
from ship_gym.provenance import provenance
from ship_gym.recording.trajectory import import_rerun_export
from ship_gym.reports.speed import machine


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
    record: bool = False,
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
    record : bool
        Record the worst episode of each controller in each cell into the folder, see
        ``worst_recordings``; ``about["recordings"]`` of the results says where.

    Raises
    ------
    ConfigError
        See ``plan.plan``; also a folder with another run, or one that another process uses.
    ImportError
        A library is missing; says how to install it.
    """
    jobs = int(check_number("jobs", jobs, 1, 1024))
    sail = engine_of(engine, jobs, address)
    arrow()  # refuses before the work
    if record:
        import_rerun_export()
    made = plan(
        suite, entrant, controllers=controllers, ships=ships, seeds=seeds, patience=patience,
        progress=progress,
    )  # fmt: skip
    folder, start = RunFolder(out), time.perf_counter()
    with folder.locked():
        folder.begin(made.settings(), fresh)
        units = dict(enumerate(made.units()))
        there = {number: folder.kept(number, unit.seeds) for number, unit in units.items()}
        found = {number: kept for number, kept in there.items() if kept is not None}
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
        if record:  # the table is safe by now
            made_files = record_worst(list(units.values()), found, folder.path, jobs, progress)
            results.about["recordings"] = made_files
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
                "tasks": {load_task(file).name: file for file in suite.tasks},
            }
            for suite in made.suites
        },
        "seeds": list(made.seeds),
        "ships": list(dict.fromkeys(cell.ship for cell in made.cells)),
        "controllers": made.about_controllers(),
        "refused": made.refused,
        "patience": made.patience,
        "computing_time": sum(one.seconds for one in sailed),
        "machine": machine(),
        "command": command,
        **provenance(),
    }
