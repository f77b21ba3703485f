"""How fast physics and environments step, with CartPole in the same run as yardstick."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np

from ship_gym.envs.env import ShipEnv
from ship_gym.envs.registration import ENVIRONMENTS
from ship_gym.envs.vector_env import ShipVectorEnv
from ship_gym.provenance import provenance
from ship_gym.sea.state import load_sea
from ship_gym.ships.files import Named
from ship_gym.ships.loader import available_surrogates, load_ship
from ship_gym.ships.particulars import Ship
from ship_gym.simulation import ShipSim
from ship_gym.text import table

COUNTS = (1, 64, 4096)
SHIP_ENV = "ShipGym/HeadingKeeping-v0"
YARDSTICK = "CartPole-v1"
SEA = "ss5"
COMPARED = (*ENVIRONMENTS.values(), "heading_calm")  # scenarios whose overhead is measured
_COMPARED = 1024  # ships, to compare a table surrogate with the analytic step
_PREPARED = 32  # different action batches, drawn before the clock starts
_FIRST_STEP = (
    "import time; t = time.perf_counter(); import gymnasium as gym, ship_gym; "
    f"env = gym.make({SHIP_ENV!r}); env.reset(seed=0); env.step(env.action_space.sample()); "
    "print(time.perf_counter() - t)"
)
_IMPORT = "import time; t = time.perf_counter(); import ship_gym; print(time.perf_counter() - t)"


def best_of(call: Callable[[int], Any], repeats: int, seconds: float) -> dict[str, float]:
    """Time of one call: best of several repeats, and how much the slowest took longer.

    Parameters
    ----------
    call : callable
        Takes the running number of the call.
    repeats : int
    seconds : float
        Time of one repeat [s]; the number of calls in it follows from a first trial.

    Returns
    -------
    dict
        ``seconds`` of one call and ``spread_percent``, 100 (slowest - best) / best.
    """
    for k in range(3):  # compile and warm up
        call(k)
    start = time.perf_counter()
    call(0)
    calls = max(1, int(seconds / max(time.perf_counter() - start, 1e-9)))
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        for k in range(calls):
            call(k)
        times.append((time.perf_counter() - start) / calls)
    return {"seconds": min(times), "spread_percent": 100.0 * (max(times) / min(times) - 1.0)}


def physics_step(
    n: int,
    parallel: bool,
    surrogate: str | None = None,
    sea: str = "disturbed_current",
    ship: Named | Ship = "kcs",
) -> Callable[[int], Any]:
    """One ``ShipSim.step`` of n ships by one control interval (1 s) under random commands."""
    ship = load_ship(ship, surrogate=surrogate)
    sim = ShipSim(ship, n, load_sea(sea), parallel)
    sim.reset(0)
    rudder = np.random.default_rng(0).uniform(-1.0, 1.0, (_PREPARED, n)) * ship.gear.delta_max
    order = np.broadcast_to(sim.state[:, -1], (_PREPARED, n))
    commands = np.stack([rudder, order], axis=-1)
    return lambda k: sim.step(commands[k % _PREPARED], 1.0)


def vector_step(env_id: str, n: int, **kwargs) -> Callable[[int], Any]:
    """One step of a native vector environment with infos and autoreset under random actions."""
    envs = gym.make_vec(env_id, num_envs=n, vectorization_mode="vector_entry_point", **kwargs)
    envs.reset(seed=0)
    envs.action_space.seed(0)
    actions = [envs.action_space.sample() for _ in range(_PREPARED)]
    return lambda k: envs.step(actions[k % _PREPARED])


def scalar_step(env: gym.Env) -> Callable[[int], Any]:
    """One step of a scalar environment under random actions, reset when an episode ends."""
    env.reset(seed=0)
    env.action_space.seed(0)
    actions = [env.action_space.sample() for _ in range(_PREPARED)]

    def step(k: int) -> None:
        _, _, terminated, truncated, _ = env.step(actions[k % _PREPARED])
        if terminated or truncated:
            env.reset()

    return step


def jobs(
    counts: tuple[int, ...] = COUNTS, **env: Any
) -> Iterator[tuple[str, int, Callable[[], Callable]]]:
    """What is timed: name, number of ships or environments, and how to make the call.

    Parameters
    ----------
    counts : tuple of int
    **env
        Arguments of ``ShipEnv``, of the environments that are timed; the ship of the physics too.
    """
    ship = env.get("ship") or "kcs"
    wavy = bool(load_ship(ship).wave_table)
    for n in counts:
        for mode, parallel in (("serial", False), ("parallel", True)):
            yield f"ShipSim.step, {mode}", n, lambda n=n, p=parallel: physics_step(n, p, ship=ship)
        for mode, parallel in (("serial", False), ("parallel", True)) if wavy else ():
            yield (
                f"ShipSim.step in waves, {mode}",
                n,
                lambda n=n, p=parallel: physics_step(n, p, sea=SEA, ship=ship),
            )
        for mode, parallel in (("serial", False), ("parallel", True)):
            yield (
                f"ShipVectorEnv.step, {mode}",
                n,
                lambda n=n, p=parallel: vector_step(SHIP_ENV, n, parallel=p, **env),
            )
        yield f"{YARDSTICK} vector step", n, lambda n=n: vector_step(YARDSTICK, n)
    known = available_surrogates(ship)
    for surrogate in (name for name in ("none", "gp") if name in known):
        name = "analytic MMG rudder" if surrogate == "none" else f"surrogate {surrogate}"
        yield (
            f"ShipSim.step, serial, {name}",
            _COMPARED,
            lambda s=surrogate: physics_step(_COMPARED, False, s, ship=ship),
        )
    named = {env_id: {"scenario": scenario} for env_id, scenario in ENVIRONMENTS.items()}
    for name, given in ({"environment": {}} if "scenario" in env else named).items():
        yield f"{name} step", 1, lambda given=given: scalar_step(ShipEnv(**env | given))
    yield f"gym.make({YARDSTICK}).step", 1, lambda: scalar_step(gym.make(YARDSTICK))


def measure(job: tuple[str, int, Callable[[], Callable]], repeats: int, seconds: float) -> dict:
    """Time one of `jobs`; adds steps per second over all ships or environments."""
    name, n, make = job
    found = best_of(make(), repeats, seconds)
    return {"name": name, "n": n, **found, "steps_per_second": n / found["seconds"]}


def overhead(scenario: Any, n: int, repeats: int, **env: Any) -> dict[str, Any]:
    """What a vector environment costs beside its physics, one thread, in turns.

    Returns
    -------
    dict
        ``physics`` and ``step`` [s] of one step of all n ships, processor time, best of `repeats`;
        ``percent``, 100 (step - physics) / physics.
    """
    envs = ShipVectorEnv(n, scenario=scenario, parallel=False, **env)
    envs.reset(seed=0)
    actions = np.zeros(envs.action_space.shape)
    calls = (envs.episodes.sim.advance, lambda: envs.step(actions))
    times: tuple[list[float], list[float]] = ([], [])
    for _ in range(repeats + 1):
        for call, found in zip(calls, times, strict=True):
            start = time.process_time()
            call()
            found.append(time.process_time() - start)
    physics, step = (min(found[1:]) for found in times)
    percent = 100.0 * (step / physics - 1.0)
    return {"scenario": str(scenario), "n": n, "physics": physics, "step": step, "percent": percent}


def start_times(cold: bool = True) -> dict[str, float]:
    """Times [s] of a fresh Python: import, and import plus first step with cold and warm cache.

    Parameters
    ----------
    cold : bool
        Also compile everything anew, which takes a minute.
    """
    found = {"import": min(_fresh(_IMPORT) for _ in range(3))}
    if cold:
        with tempfile.TemporaryDirectory(prefix="ship_gym-") as folder:
            found["first_step_cold_cache"] = _fresh(_FIRST_STEP, folder)
            found["first_step_warm_cache"] = min(_fresh(_FIRST_STEP, folder) for _ in range(3))
    return found


def _fresh(code: str, cache: str | None = None) -> float:
    """Number that a line of Python prints in a process of its own."""
    environment = {**os.environ, **({"NUMBA_CACHE_DIR": cache} if cache else {})}
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return float(done.stdout)


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


def as_text(data: dict[str, Any]) -> str:
    """Timings as an aligned table, from ``{"machine", "steps", "overhead", "start"}``."""
    host = data["machine"]
    cells = [
        [
            row["name"],
            str(row["n"]),
            f"{row['steps_per_second']:,.0f}",
            f"{1e6 * row['seconds']:,.1f}",
            f"{row['spread_percent']:.0f} %" if row["spread_percent"] < 1000.0 else "> 1000 %",
        ]
        for row in data["steps"]
    ]
    lines = [
        f"{host['processor']}, {host['cores']} cores, Python {host['versions']['python']}",
        "one step = one control interval (1 s at sea) of one ship; best of several repeats",
        "",
        table(["", "n", "steps/s", "us per call", "spread"], cells),
        "",
        *(
            f"{o['scenario']}, n = {o['n']}: task, observation, reward and info cost "
            f"{o['percent']:.0f} % of the physics ({1e6 * o['physics'] / o['n']:.2f} us a ship)"
            for o in data["overhead"]
        ),
        "",
        *(f"{name.replace('_', ' ')}: {t:.2f} s" for name, t in data["start"].items()),
    ]
    return "\n".join(lines)
