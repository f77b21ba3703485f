"""Recordings of a benchmark: the worst episode of each controller in each cell, sailed again.

Episodes are the same whatever they are sailed beside, so one that is sailed alone is that of the
table; where its value differs nevertheless (a controller that draws at random) that is told.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError
from ship_gym.envs.registration import load_task
from ship_gym.evaluation.choice import deciding, ranked
from ship_gym.evaluation.engines import Work, engine_of
from ship_gym.evaluation.guard import Guarded
from ship_gym.evaluation.metrics import all_metrics
from ship_gym.evaluation.recordings import file_name, safe, sail
from ship_gym.evaluation.run_folder import RECORDINGS
from ship_gym.evaluation.suite import ALWAYS
from ship_gym.evaluation.unit import Sailed, Unit

Key = tuple[str, ...]  # suite, scenario, control, ship, controller


@dataclasses.dataclass(frozen=True)
class Again:
    """An episode to sail again into a file.

    Attributes
    ----------
    unit : Unit
        With its one seed.
    file : str
        Absolute path.
    measure : str
    value : float or None
        Of the measure, as the table has it.
    """

    unit: Unit
    file: str
    measure: str
    value: float | None


@dataclasses.dataclass(frozen=True)
class Kept:
    """What became of it: the file, or why there is none; whether its value is the table's."""

    file: str
    error: str = ""
    same: bool = True


def record_worst(
    units: Sequence[Unit],
    sailed: Mapping[int, Sailed],
    folder: Path,
    jobs: int = 1,
    progress: Callable[[Iterable, str, int], Iterable] | None = None,
) -> dict[str, Any]:
    """Record the worst episode of each controller in each cell; failed ones are the worst.

    ``constant`` has none, for it only says what doing nothing gives, unless it sails alone.
    Where no episode has a value of the measure, since all are too short, the return decides.
    Episodes that their controller broke off with an error cannot be recorded. Files that are there
    already, from an earlier part of the run, are kept.

    Parameters
    ----------
    units : sequence of Unit
    sailed : mapping of int to Sailed
        Their rows.
    folder : path
        Of the run; the files go into its `RECORDINGS`.
    jobs : int
        Processes of this machine.
    progress : callable, optional
        As in ``benchmark``.

    Returns
    -------
    dict
        ``files``: suite -> scenario -> ship -> controller -> file, relative to `folder`;
        ``errors`` and ``differing``: lists of text.
    """
    todo = dict(enumerate(_worst(units, sailed, folder / RECORDINGS)))
    missing = {k: again for k, again in todo.items() if not Path(again.file).is_file()}
    running = engine_of("local", jobs, None, Work(_record, _lost))(missing)
    found = dict(progress(running, "recording", len(missing)) if progress else running)
    files: dict[str, Any] = {}
    for k, again in todo.items():
        if not found.get(k, Kept(again.file)).error:
            unit = again.unit
            place = files.setdefault(unit.suite, {}).setdefault(unit.entry.name, {})
            ship = place.setdefault(unit.ship, {})
            ship[unit.entrant.name] = Path(again.file).relative_to(folder.resolve()).as_posix()
    return {
        "files": files,
        "errors": [f"{todo[k].unit}: {one.error}" for k, one in found.items() if one.error],
        "differing": [str(todo[k].unit) for k, one in found.items() if not one.same],
    }


def _worst(units: Sequence[Unit], sailed: Mapping[int, Sailed], folder: Path) -> list[Again]:
    """The episodes to sail again."""
    cells: dict[Key, list[tuple[Unit, dict[str, Any]]]] = {}
    key: Key
    for number, unit in enumerate(units):
        key = unit.suite, unit.entry.name, str(unit.entry.control), unit.ship, unit.entrant.name
        cells.setdefault(key, []).extend((unit, row) for row in sailed[number].rows)
    steered = {key[:4] for key in cells if key[4] != ALWAYS}
    made = []
    for key, rows in cells.items():
        there = [pair for pair in rows if not pair[1]["error"]]
        if not there or (key[4] == ALWAYS and key[:4] in steered):
            continue
        measure = there[0][1]["measure"]
        measure = deciding(measure, {measure: [row[measure] for _, row in there]})
        values = [row[measure] for _, row in there]
        order = ranked(values, all_metrics()[measure].better, [r["failed"] for _, r in there])
        if order:
            unit, row = there[order[-1]]
            file = folder / _name(unit, row["seed"])
            one = dataclasses.replace(unit, seeds=(row["seed"],))
            made.append(Again(one, str(file.resolve()), measure, row[measure]))
    return made


def _name(unit: Unit, seed: int) -> str:
    control = f"-{unit.entry.control}" if unit.entry.control else ""
    scenario = Path(unit.entry.name).stem if unit.entry.name.endswith(".toml") else unit.entry.name
    ship = Path(unit.ship).stem if unit.ship.endswith(".toml") else unit.ship
    cell = safe(f"{unit.suite}-{scenario}{control}-{ship}")
    return f"{cell}-{file_name(unit.entrant.name, seed)}"


def _record(again: Again) -> Kept:
    """Sail an episode into its file, as a unit of work; what the disk refuses goes through."""
    unit = again.unit
    for task in unit.tasks:
        load_task(task)
    try:
        guarded = Guarded(unit.entrant.make(), unit.seeds)
        guarded.name = unit.entrant.name  # that of the table, where policies share one
        (kept,) = sail(guarded, unit.seeds, [Path(again.file)], **unit.env)
    except ConfigError as error:  # also a controller that fails
        return _lost(again, str(error))
    value = kept.metrics[again.measure]
    return Kept(again.file, same=_equal(value, again.value))


def _lost(again: Again, what: str) -> Kept:
    return Kept(again.file, f"seed {again.unit.seeds[0]}: {what}")


def _equal(one: float | None, other: float | None) -> bool:
    """Whether two values are the same, none and not a number included."""
    absent = [value is None or math.isnan(value) for value in (one, other)]
    return all(absent) if any(absent) else one == other
