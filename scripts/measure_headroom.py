"""Measure the reference values of the standard suites: doing nothing, references, optima."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from _cli import parser, progress, run, show
from ship_gym_agents import make_controller

from ship_gym.config import ConfigError
from ship_gym.envs.env import resolved_scenario
from ship_gym.evaluation import headroom
from ship_gym.evaluation.suite import ALWAYS, load_suites
from ship_gym.ships.files import DATA
from ship_gym.tasks import TASKS
from ship_gym.text import table
from ship_gym.writing import check_place

GAINS = Path(__file__).resolve().parents[1] / "agents" / "ship_gym_agents" / "gains"
EXAMPLES = (
    "python scripts/measure_headroom.py --only heading_keeping/kcs   # one cell, half a minute",
    "python scripts/measure_headroom.py --write --jobs 2             # what has changed, of all",
)


@dataclasses.dataclass(frozen=True)
class Job:
    """One cell to measure: its key, what is sailed, the names of the classical controllers."""

    key: str
    scenario: str
    ship: str
    measure: str | None
    control: str | None
    controllers: tuple[str, ...]


def arguments():
    p = parser(__doc__, EXAMPLES)
    p.add_argument("--suite", nargs="*", default=["all"], help="names (default: all)")
    p.add_argument("--ships", nargs="*", help="default: those of the suites")
    p.add_argument("--only", nargs="*", metavar="SCENARIO/SHIP", help="these cells, even if known")
    p.add_argument("--jobs", type=int, default=1, help="processes (default 1)")
    p.add_argument("--write", action="store_true", help=f"write {headroom.FILE.name}, cell by cell")
    p.add_argument("--again", action="store_true", help="measure what is known too")
    return p.parse_args()


def jobs(suites: list[str], ships: list[str] | None) -> dict[str, Job]:
    """Cells of the suites by key; the classical controllers are those of all suites that have it.

    Raises
    ------
    ConfigError
        Two suites score one cell by different measures.
    """
    found: dict[str, Job] = {}
    for suite in load_suites(suites):
        if suite.kind != "episodes":
            continue
        for entry in suite.scenario:
            for ship in ships or entry.ships or suite.ships:
                key = "/".join((" ".join(filter(None, (entry.name, entry.control))), ship))
                named = classical(entry.controllers or suite.controllers)
                made = Job(key, entry.name, ship, entry.measure, entry.control, named)
                known = found.setdefault(key, made)
                if known.measure != made.measure:
                    raise ConfigError(
                        f"cell {key}: suites score it by {known.measure} and {made.measure}"
                    )
                every = dict.fromkeys((*known.controllers, *named))
                found[key] = dataclasses.replace(known, controllers=tuple(every))
    return found


def classical(named: tuple[str, ...]) -> tuple[str, ...]:
    """The tuned classical controllers among names: no policies, no foreign gains."""
    own = [name for name in named if name != ALWAYS and "@" not in name]
    return tuple(name for name in own if not hasattr(make_controller(name), "card"))


def inputs(job: Job) -> str:
    """SHA-256 of what the cell of a job depends on."""
    scenario, _ = resolved_scenario(job.scenario, job.ship, job.control, None, None, None)
    files = [path for name in (job.ship, f"{job.ship}_model") for path in files_of(name)]
    gains = GAINS.glob(f"*_{job.ship}.toml")
    files += [path for path in gains if path.stem.rpartition(f"_{job.ship}")[0]]
    files += GAINS.glob(f"*_{job.ship}.{scenario.task}.toml")  # those of the task
    measure = job.measure or TASKS[scenario.task].headline
    return headroom.inputs_of(scenario, measure, job.controllers, files)


def files_of(ship: str) -> list[Path]:
    """Files of a ship of the package."""
    return [path for path in (DATA / ship).glob("*") if path.is_file()]


def measure(job: Job) -> dict[str, Any]:
    """The cell of a job as plain values."""
    made = {name: functools.partial(make_controller, name) for name in job.controllers}
    cell = headroom.measure_cell(made, job.scenario, job.ship, job.measure, job.control)
    return dataclasses.asdict(dataclasses.replace(cell, inputs=inputs(job)))


def measured(todo: list[Job], processes: int) -> Iterator[tuple[Job, dict[str, Any] | str]]:
    """Cells as they are finished; in place of one that cannot be measured, why."""
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        sent = {pool.submit(measure, job): job for job in todo}
        for done in progress(as_completed(sent), "cells", len(sent)):
            try:
                yield sent[done], done.result()
            except ConfigError as error:
                yield sent[done], str(error)


def main() -> None:
    args = arguments()
    if args.write:
        check_place(headroom.FILE, "--write")
    known, every = dict(headroom.read()), jobs(args.suite, args.ships)
    if args.only:
        wanted = {key: find(key, every) for key in args.only}
    else:
        wanted = {
            key: job
            for key, job in every.items()
            if args.again or known.get(key, {}).get("inputs") != inputs(job)
        }
    found, refused = {}, {}
    for job, cell in measured(list(wanted.values()), args.jobs):
        if isinstance(cell, str):
            refused[job.key] = cell
            continue
        found[job.key] = cell
        if args.write:
            headroom.write(known | found)
    kept = [key for key in every if key in known and key not in found]
    lines = [as_table(found)] if found else []
    lines += [f"{key}: {why}" for key, why in refused.items()]
    lines.append(f"{len(found)} cells measured, {len(kept)} kept, {len(refused)} refused")
    lines += [f"wrote {headroom.FILE}"] if args.write and found else []
    show(args.json, {"cells": found, "kept": kept, "refused": refused}, "\n".join(lines))


def find(key: str, every: dict[str, Job]) -> Job:
    """The job of a cell, of the suites or, with the same controllers, of any ship."""
    from ship_gym.config import check_known

    return every[check_known("cell", key, every)]


def as_table(cells: dict[str, dict[str, Any]]) -> str:
    """Cells for people."""
    header = ("cell", "measure", "nothing", "reference", "", "second", "", "second - best")
    header += ("optimum", "headroom [%]", "separates")
    rows = []
    for key, c in sorted(cells.items()):
        row = [key, c["measure"], number(c["nothing"]), number(c["reference"])]
        row += [c["reference_controller"], number(c["second"]), c["second_controller"] or ""]
        row += [interval(c["difference"]), number(c["optimum"]), interval(c["headroom"])]
        rows.append([*row, "yes" if c["separates"] else "no"])
    return table(header, rows)


def number(value: float | None) -> str:
    return "" if value is None else f"{value:.4g}"


def interval(found: dict[str, float] | None) -> str:
    """Value and interval."""
    if found is None:
        return ""
    text = f"{found['value']:.3g}"
    return text if found["low"] is None else f"{text} [{found['low']:.3g}, {found['high']:.3g}]"


if __name__ == "__main__":
    run(main)
