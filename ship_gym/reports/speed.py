"""How fast physics and environments step, with CartPole in the same run as yardstick."""

from __future__ import annotations

import dataclasses
import os
import platform
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np

from ship_gym.config import ConfigError
from ship_gym.envs.env import ShipEnv
from ship_gym.envs.registration import ENVIRONMENTS
from ship_gym.provenance import provenance
from ship_gym.reports.speed_child import (
    SHIP_ENV,
    YARDSTICK,
    Work,
    best_of,
    physics,
    rough_sea,
    scalar,
    vector,
)
from ship_gym.sea.state import CALM
from ship_gym.ships.loader import available_surrogates, load_ship
from ship_gym.writing import atomic_path

COUNTS = (1, 64, 4096)
GROWTH = (1, 16, 256, 1024, 4096, 16384, 65536)
WAVES = (0, 20, 60, 100, 200)
COMPARED = (*ENVIRONMENTS.values(), "heading_calm")  # scenarios whose overhead is measured
_COMPARED = 1024  # ships, to compare a table surrogate with the analytic step, and seas
_IMPORT = "import time; t = time.perf_counter(); import ship_gym; print(time.perf_counter() - t)"


@dataclasses.dataclass(frozen=True)
class Job:
    """Something that `measure` times: how to make the work, and under what name it is told.

    Attributes
    ----------
    table : str
        Which table of the result it belongs to: ``steps``, ``growth`` or ``waves``.
    name : str
    n : int
        Ships or environments, in table ``waves`` regular waves.
    make : callable
    threads : bool
        Judged by wall time, not by processor time.
    """

    table: str
    name: str
    n: int
    make: Callable[[], Work]
    threads: bool = False


def jobs(
    counts: tuple[int, ...] = COUNTS,
    growth: tuple[int, ...] = GROWTH,
    waves: tuple[int, ...] = WAVES,
    **env: Any,
) -> Iterator[Job]:
    """What is timed.

    Parameters
    ----------
    counts : tuple of int
        Ships of the table of steps.
    growth : tuple of int
        Ships of the table of growth.
    waves : tuple of int
        Regular waves of a sea.
    **env
        Arguments of ``ShipEnv``, of the environments that are timed; the ship of the physics too.
    """
    ship = env.get("ship") or "kcs"
    for n in counts:
        yield from _steps(n, ship, env)
    yield from _others(ship, env)
    seas = _seas(ship)
    for n in growth:
        for name, sea in seas.items():
            yield Job("growth", name, n, partial(physics, n, sea, False, ship))
        batch = partial(vector, SHIP_ENV, n, parallel=False, **env)
        yield Job("growth", "environment", n, batch)
        yield Job("growth", YARDSTICK, n, partial(vector, YARDSTICK, n))
    for count in waves if "waves" in seas else ():
        yield Job(
            "waves",
            "physics",
            count,
            partial(_among, count, ship),
        )


def _seas(ship: Any) -> dict[str, Any]:
    """Calm water, and for ships with a wave table a rough sea."""
    found = {"calm": CALM}
    if load_ship(ship).wave_table:
        found["waves"] = rough_sea()
    return found


def _among(count: int, ship: Any) -> Work:
    """Physics in a sea of `count` waves."""
    return physics(_COMPARED, rough_sea(count), False, ship)


def _of_surrogate(ship: Any, name: str) -> Work:
    """Physics of a ship with another surrogate."""
    return physics(_COMPARED, CALM, False, load_ship(ship, surrogate=name))


def _alone(given: dict[str, Any]) -> Work:
    """One environment."""
    return scalar(ShipEnv(**given))


def _steps(n: int, ship: Any, env: dict[str, Any]) -> Iterator[Job]:
    for mode, p in (("one core", False), ("threads", True)):
        for name, sea in _seas(ship).items():
            title = f"physics, {name}, {mode}"
            yield Job("steps", title, n, partial(physics, n, sea, p, ship), p)
        title = f"HeadingKeeping, {mode}" if "scenario" not in env else f"environment, {mode}"
        yield Job("steps", title, n, partial(vector, SHIP_ENV, n, parallel=p, **env), p)
    yield Job("steps", f"{YARDSTICK} vector", n, lambda: vector(YARDSTICK, n))


def _others(ship: Any, env: dict[str, Any]) -> Iterator[Job]:
    known = available_surrogates(ship)
    for surrogate in (name for name in ("none", "gp") if name in known):
        name = "analytic MMG rudder" if surrogate == "none" else f"surrogate {surrogate}"
        yield Job(
            "steps",
            f"physics, calm, {name}",
            _COMPARED,
            partial(_of_surrogate, ship, surrogate),
        )
    named = {env_id: {"scenario": scenario} for env_id, scenario in ENVIRONMENTS.items()}
    for name, given in ({"environment": {}} if "scenario" in env else named).items():
        yield Job("steps", f"{name} step", 1, partial(_alone, env | given))
    yield Job("steps", f"{YARDSTICK} step", 1, lambda: scalar(gym.make(YARDSTICK).unwrapped))


def measure(job: Job, repeats: int, seconds: float) -> dict[str, Any]:
    """Time one of `jobs`.

    Returns
    -------
    dict
        ``table``, ``name``, ``n``, ``threads``; ``seconds`` of one step of one ship or
        environment, processor time or with threads wall time; ``processor``, ``wall`` and
        ``spread_percent`` as in ``speed_child.best_of``.
    """
    found = best_of(job.make(), repeats, seconds)
    seconds_ = found["wall" if job.threads else "processor"]
    told = {"table": job.table, "name": job.name, "n": job.n, "threads": job.threads}
    return {**told, "seconds": seconds_, **found}


def overhead(scenario: Any, n: int, repeats: int, **env: Any) -> dict[str, Any]:
    """What a vector environment costs beside its physics, one thread, in turns.

    Returns
    -------
    dict
        ``physics`` and ``step`` [s] of one step of all n ships, processor time, best of `repeats`;
        ``percent``, 100 (step - physics) / physics.
    """
    from ship_gym.envs.vector_env import ShipVectorEnv  # late: needs a newer Gymnasium

    envs = ShipVectorEnv(n, scenario=scenario, parallel=False, **env)
    envs.reset(seed=0)
    actions = np.zeros((n, *(envs.single_action_space.shape or ())))
    calls = (envs.episodes.sim.advance, lambda: envs.step(actions))
    times: tuple[list[float], list[float]] = ([], [])
    for _ in range(repeats + 1):
        for call, found in zip(calls, times, strict=True):
            start = time.process_time()
            call()
            found.append(time.process_time() - start)
    physics_, step = (min(found[1:]) for found in times)
    percent = 100.0 * (step / physics_ - 1.0)
    return {
        "scenario": str(scenario),
        "n": n,
        "physics": physics_,
        "step": step,
        "percent": percent,
    }


def import_time() -> float:
    """Wall time [s] of ``import ship_gym`` in a fresh Python, best of three."""
    command = [sys.executable, "-c", _IMPORT]
    found = [subprocess.run(command, capture_output=True, text=True, check=True) for _ in range(3)]
    return min(float(done.stdout) for done in found)


def machine() -> dict[str, Any]:
    """Processor, usable cores, system, and versions."""
    model = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.is_file():
        lines = [line for line in info.read_text().splitlines() if line.startswith("model name")]
        model = lines[0].partition(":")[2].strip() if lines else model
    usable = getattr(os, "sched_getaffinity", None)
    cores = len(usable(0)) if usable else os.cpu_count()
    return {"processor": model, "cores": cores, "system": platform.platform(), **provenance()}


BEGIN, END = "<!-- figures: begin -->", "<!-- figures: end -->"


def parts_of_page(page: str | os.PathLike) -> tuple[str, str]:
    """What a Markdown page holds before and after its figures, which stand between two marks.

    Raises
    ------
    ConfigError
        The page does not exist or lacks the marks.
    """
    page = Path(page)
    known = page.read_text(encoding="utf-8") if page.is_file() else ""
    before, begin, rest = known.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not (begin and end):
        raise ConfigError(f"--page {page}: must be a page with the marks {BEGIN} and {END}")
    return before, after


def write_into(page: str | os.PathLike, text: str) -> None:
    """Replace the figures of a page, see `parts_of_page`, by a block of text."""
    before, after = parts_of_page(page)
    with atomic_path(page) as temporary:
        temporary.write_text(
            f"{before}{BEGIN}\n\n```text\n{text}\n```\n\n{END}{after}", encoding="utf-8"
        )
