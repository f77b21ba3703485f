"""Compile beforehand what ships and tasks need, in several processes, and keep it.

Code is compiled for what a ship has (``physics.parameters.Traits``: two screws, one of the wake
laws and so on), so that one ship stands for all that have the same.
"""

from __future__ import annotations

import dataclasses
import multiprocessing
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.envs.classes import class_of
from ship_gym.envs.registration import load_task
from ship_gym.physics import _compiler, _kernel
from ship_gym.physics._cache import candidates
from ship_gym.physics.parameters import traits_of
from ship_gym.sea.state import load_sea
from ship_gym.ships.files import available_ships
from ship_gym.ships.loader import load_ship
from ship_gym.ships.records import fleet
from ship_gym.simulation import ShipSim
from ship_gym.tasks import TASKS

PHYSICS = "physics"
_WAVY = "ss5"
_DIFFERENT = {"randomisation": {"hull_std": 0.01}}  # ships that differ: other code


@dataclasses.dataclass(frozen=True)
class Job:
    """What one process compiles at a time.

    Attributes
    ----------
    ships : tuple of str
        That have the same traits; the first is taken.
    part : str
        A task, by name or file as ``load_task`` takes it, or ``PHYSICS``.
    mixed : bool
        For ships that differ, as a randomised fleet's do.
    """

    ships: tuple[str, ...]
    part: str
    mixed: bool = False


@dataclasses.dataclass(frozen=True)
class Done:
    """A job with its processor time [s] and the functions that were compiled; the rest was kept."""

    job: Job
    seconds: float
    compiled: tuple[str, ...]


def sets_of(ships: Sequence[str]) -> list[tuple[str, ...]]:
    """Names or files of ships, those with the same traits together."""
    found: dict[Any, list[str]] = {}
    for name in dict.fromkeys(ships):
        found.setdefault(traits_of(fleet([load_ship(name)]).records), []).append(name)
    return [tuple(names) for names in found.values()]


def jobs_of(ships: Sequence[str] = (), tasks: Sequence[str] = (), mixed: bool = False) -> list[Job]:
    """Jobs for ships and tasks, all of the package where none are named; physics first.

    Parameters
    ----------
    ships, tasks : sequence of str
        Names or files.
    mixed : bool
        Also for ships that differ.

    Raises
    ------
    ConfigError
        An unknown name, or a place where nothing would be kept.
    """
    check_kept()
    for name in tasks:
        load_task(name)  # refuses before the work
    parts = [PHYSICS, *dict.fromkeys(tasks or TASKS.own())]
    sets = sets_of(ships or available_ships())
    kinds = (False, True) if mixed else (False,)
    return [Job(names, part, kind) for part in parts for names in sets for kind in kinds]


def check_kept() -> None:
    """Refuse where nothing is compiled, or kept when the process ends."""
    if not _kernel.compiles():
        raise ConfigError("NUMBA_DISABLE_JIT = 1: nothing is compiled; unset it")
    if folder().parent not in candidates():
        raise ConfigError(
            "no folder of yours can keep machine code: set NUMBA_CACHE_DIR to one that you own and "
            "nobody else can write to"
        )


def folder() -> Path:
    """Where the machine code lies."""
    return _kernel.code_folder()


def warm(job: Job) -> Done:
    """Compile what a job needs, or load what is kept of it."""
    before, start = len(_compiler.saved), time.process_time()
    if job.part == PHYSICS:
        _sail(job)
    else:
        _play(job)
    return Done(job, time.process_time() - start, tuple(_compiler.saved[before:]))


def _sail(job: Job) -> None:
    """One step of a simulation in waves: its code is that of any water and number of ships."""
    sim = ShipSim(job.ships[0], sea=load_sea(_WAVY))
    if job.mixed:
        sim.expect("each")
    state = sim.reset(seed=0)
    sim.step(np.array([[0.0, state[0, -1]]]), 1.0)


def _play(job: Job) -> None:
    """One step of a task's environment."""
    env = class_of(load_task(job.part))(job.ships[0], overrides=_DIFFERENT if job.mixed else None)
    env.reset(seed=0)
    env.step(np.zeros(env.action_space.shape))
    env.episodes.compile()


def run(jobs: Sequence[Job], processes: int) -> Iterator[Done]:
    """Do jobs in so many processes of their own; yields each that is done."""
    processes = min(processes, len(jobs))
    if processes == 1:
        yield from map(warm, jobs)
        return
    with ProcessPoolExecutor(processes, multiprocessing.get_context("spawn")) as pool:
        try:
            for one in as_completed([pool.submit(warm, job) for job in jobs]):
                yield one.result()
        finally:
            pool.shutdown(cancel_futures=True)


def as_text(done: Sequence[Done], wall: float) -> str:
    """Seconds of each set, in total, and where the code lies."""
    rows = [["ships", "for", "seconds", "compiled"]]
    for one in done:
        ships = ", ".join(one.job.ships) + (" (different ones)" if one.job.mixed else "")
        rows.append([ships, one.job.part, f"{one.seconds:.1f}", str(len(one.compiled))])
    widths = [max(len(row[k]) for row in rows) for k in range(4)]
    lines = [
        f"{row[0]:{widths[0]}}  {row[1]:{widths[1]}}  {row[2]:>{widths[2]}}  {row[3]:>{widths[3]}}"
        for row in rows
    ]
    count = sum(len(one.compiled) for one in done)
    what = f"compiled {count} functions" if count else "everything was there already"
    used = sum(one.seconds for one in done)
    return "\n".join(
        [*lines, "", f"{what}: {wall:.1f} s, of processors {used:.1f} s", f"kept in {folder()}"]
    )


def as_data(done: Sequence[Done], wall: float) -> dict[str, Any]:
    """The same for JSON."""
    return {
        "sets": [
            {
                "ships": list(one.job.ships),
                "part": one.job.part,
                "mixed": one.job.mixed,
                "processor_s": one.seconds,
                "compiled": list(one.compiled),
            }
            for one in done
        ],
        "compiled": sum(len(one.compiled) for one in done),
        "wall_s": wall,
        "processor_s": sum(one.seconds for one in done),
        "folder": str(folder()),
    }
