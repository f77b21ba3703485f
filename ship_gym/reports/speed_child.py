"""What is timed, and a process that times it in whatever checkout ``PYTHONPATH`` names.

Only numpy, Gymnasium and public calls of ship_gym, so that one file measures this package and an
older one alike: ``python -P speed_child.py`` answers each line on stdin, such as
``{"name": "waves", "n": 4096}``, with one on stdout. See ``reports.speed_against``.
"""

from __future__ import annotations

import collections.abc
import dataclasses
import gc
import json
import os
import sys
import time
import types
import weakref
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np

import ship_gym

SHIP_ENV = "ShipGym/HeadingKeeping-v0"
YARDSTICK = "CartPole-v1"
EPISODE = 600  # control intervals of SHIP_ENV
_PREPARED = 32  # different action batches, drawn before the clock starts
_MORE = 20  # times as many repeats, at most, where each is short
_SCALAR = 200  # steps of a scalar environment between two resets, which are not timed


@dataclasses.dataclass(frozen=True)
class Work:
    """Something to time.

    Attributes
    ----------
    call : callable
        Takes the running number of the call.
    items : float
        Steps of one ship or environment in one call.
    prepare : callable
        Puts everything back to the start; not timed.
    longest : int
        Calls until `prepare` is due.
    """

    call: Callable[[int], Any]
    items: float
    prepare: Callable[[], Any] = lambda: None
    longest: int = 10**9


def best_of(work: Work, repeats: int, seconds: float) -> dict[str, float]:
    """Time of one item of work, best of several repeats.

    Parameters
    ----------
    work : Work
    repeats : int
    seconds : float
        Time of one repeat [s]; the number of calls in it follows from a first trial.

    Returns
    -------
    dict
        ``processor`` and ``wall`` time [s] of one item; ``spread_percent`` of the processor time,
        100 (slowest - best) / best.
    """
    calls, done = 1, work.longest
    processor: list[float] = []
    wall: list[float] = []
    left = 3  # of one call each, to compile, warm up and estimate
    while left > 0:
        left -= 1
        if done + calls > work.longest:
            work.prepare()
            done = 0
        start = time.process_time(), time.perf_counter()
        for i in range(calls):
            work.call(i)
        processor.append(time.process_time() - start[0])
        wall.append(time.perf_counter() - start[1])
        done += calls
        if len(wall) == 3:
            calls = max(1, int(seconds / max(wall[-1], 1e-7)))
            # where `prepare` cuts repeats short there are more of them
            left = repeats * max(1, min(calls // work.longest, _MORE))
            calls = min(calls, work.longest)
    best, items = max(min(processor[3:]), 1e-9), calls * work.items
    return {
        "processor": best / items,
        "wall": min(wall[3:]) / items,
        "spread_percent": 100.0 * (max(processor[3:]) / best - 1.0),
    }


def rough_sea(wave_count: int = 60) -> ship_gym.Sea:
    """Sea state 5 with gusts and a current, as the default environment has them, held fixed.

    Parameters
    ----------
    wave_count : int
        Regular waves that the sea is made of; 0: wind and current only.
    """
    sea = dataclasses.replace(
        ship_gym.load_sea("ss5"),
        current_speed=1.0,
        current_direction_to=1.5,
        wave_direction_to=1.0,
        wind_direction_from=1.0 - np.pi,
        gusts=True,
    )
    given = {"wave_count": wave_count} if wave_count else {"waves": ()}
    return dataclasses.replace(sea, **given)


def physics(
    n: int, sea: ship_gym.Sea, parallel: bool = False, ship: Any = "kcs", seconds: float = 1.0
) -> Work:
    """``ShipSim.step`` of n ships under random rudder commands.

    Parameters
    ----------
    n : int
    sea : Sea
        At full scale.
    parallel : bool
    ship : str, path or Ship
    seconds : float
        Interval at full scale [s]; a model gets it Froude-scaled, with her sea.
    """
    ship = ship_gym.load_ship(ship)
    sim = ship_gym.ShipSim(ship, n, sea.scaled(ship.scale), parallel)
    sim.reset(0)
    dt = seconds / ship.time_unit
    random = np.random.default_rng(0)
    rudder = random.uniform(-1.0, 1.0, (_PREPARED, n)) * ship.gear.delta_max
    order = np.broadcast_to(sim.state[:, -1], (_PREPARED, n))
    commands = np.stack([rudder, order], axis=-1)
    return Work(lambda k: sim.step(commands[k % _PREPARED], dt), n, lambda: sim.reset(0), EPISODE)


def reference(n: int) -> Work:
    """Sail n ships by Nomoto's equation in NumPy: a yardstick that nobody changes."""
    random = np.random.default_rng(0)
    deltas = random.uniform(-0.6, 0.6, (_PREPARED, n))
    r, psi, north, east, part = np.zeros((5, n))

    def step(k: int) -> None:
        for _ in range(4):
            np.multiply(deltas[k % _PREPARED], 0.05, out=part)
            np.subtract(part, r, out=part)
            np.multiply(part, 0.25 / 60.0, out=part)
            np.add(r, part, out=r)
            np.multiply(r, 0.25, out=part)
            np.add(psi, part, out=psi)
            np.add(north, np.multiply(np.cos(psi, out=part), 1.75, out=part), out=north)
            np.add(east, np.multiply(np.sin(psi, out=part), 1.75, out=part), out=east)

    return Work(step, n)


def vector(env_id: str, n: int, look: bool = False, **given: Any) -> Work:
    """One step of a native vector environment under random actions.

    Parameters
    ----------
    env_id : str
    n : int
        Number of environments.
    look : bool
        Also read every entry of info, as a logger does.
    **given
        Arguments of the environment.
    """
    envs = gym.make_vec(env_id, num_envs=n, vectorization_mode="vector_entry_point", **given)
    envs.action_space.seed(0)
    actions = [envs.action_space.sample() for _ in range(_PREPARED)]

    def step(k: int) -> None:
        found = envs.step(actions[k % _PREPARED])
        if look:
            read(found[4])

    return Work(step, n, lambda: envs.reset(seed=0), EPISODE - 1)


def read(info: Any) -> int:
    """Read every entry of an info, lazily made or not; the number of entries."""
    if isinstance(info, collections.abc.Mapping):
        return sum(read(info[key]) for key in info)
    return int(np.asarray(info).size > 0)


def ending_one_by_one(n: int, **given: Any) -> Work:
    """As `vector` of the ship, where at every step other episodes end and begin anew."""
    envs = gym.make_vec(SHIP_ENV, num_envs=n, vectorization_mode="vector_entry_point", **given)
    envs.reset(seed=0)
    envs.action_space.seed(0)
    actions = [envs.action_space.sample() for _ in range(_PREPARED)]
    due = np.arange(n) % EPISODE
    for k in range(min(EPISODE, n)):
        envs.step(actions[k % _PREPARED])
        envs.reset(options={"reset_mask": due == k})
    return Work(lambda k: envs.step(actions[k % _PREPARED]), n)


def resets(n: int, **given: Any) -> Work:
    """Reset of n environments at once."""
    envs = gym.make_vec(SHIP_ENV, num_envs=n, vectorization_mode="vector_entry_point", **given)
    envs.reset(seed=0)
    return Work(lambda k: envs.reset(), n)


def scalar(env: gym.Env, look: bool = False) -> Work:
    """Steps of a scalar environment, without its resets; an episode must last `_SCALAR` steps."""
    actions = balancing(env) if env.spec and env.spec.id == YARDSTICK else random_actions(env)

    def steps(k: int) -> None:
        for action in actions:
            found = env.step(action)
            if look:
                read(found[4])

    return Work(steps, len(actions), lambda: env.reset(seed=0), 1)


def random_actions(env: gym.Env) -> list:
    """Actions drawn from the middle of the space, so that no ship leaves her limits."""
    env.action_space.seed(0)
    return [0.3 * env.action_space.sample() for _ in range(_SCALAR)]


def balancing(env: gym.Env) -> list:
    """Actions that keep the pole of CartPole up from ``reset(seed=0)`` on."""
    observation, _ = env.reset(seed=0)
    actions: list = []
    while len(actions) < _SCALAR:
        actions.append(int(observation[2] + 0.5 * observation[3] + 0.02 * observation[0] > 0.0))
        observation, _, ended, _, _ = env.step(actions[-1])
        if ended:
            return actions[:-1]
    return actions


def ship_env(ship: Any, bare: bool = True) -> gym.Env:
    """The scalar environment, as ``gym.make`` gives it or without wrappers."""
    env = gym.make(SHIP_ENV, ship=ship)
    return env.unwrapped if bare else env


# name -> (does it use threads, how the work is made from n and ship)
MEASURES: dict[str, tuple[bool, Callable[[int, Any], Work]]] = {
    "calm": (False, lambda n, s: physics(n, ship_gym.Sea(), False, s)),
    "waves": (False, lambda n, s: physics(n, rough_sea(), False, s)),
    "heading": (False, lambda n, s: vector(SHIP_ENV, n, ship=s, parallel=False)),
    "heading, info read": (
        False,
        lambda n, s: vector(SHIP_ENV, n, True, ship=s, parallel=False),
    ),
    "heading, ends spread": (False, lambda n, s: ending_one_by_one(n, ship=s, parallel=False)),
    "reset": (False, lambda n, s: resets(n, ship=s, parallel=False)),
    "scalar": (False, lambda n, s: scalar(ship_env(s))),
    "scalar, info read": (False, lambda n, s: scalar(ship_env(s), True)),
    "scalar, gym.make": (False, lambda n, s: scalar(ship_env(s, bare=False))),
    "CartPole scalar": (False, lambda n, s: scalar(gym.make(YARDSTICK).unwrapped)),
    "CartPole scalar, gym.make": (False, lambda n, s: scalar(gym.make(YARDSTICK))),
    "CartPole vector": (False, lambda n, s: vector(YARDSTICK, n)),
    "NumPy reference": (False, lambda n, s: reference(512)),  # few: the cache matters less
    "calm, threads": (True, lambda n, s: physics(n, ship_gym.Sea(), True, s)),
    "waves, threads": (True, lambda n, s: physics(n, rough_sea(), True, s)),
    "heading, threads": (True, lambda n, s: vector(SHIP_ENV, n, ship=s, parallel=True)),
}


def bytes_of_arrays(*roots: Any) -> int:
    """Bytes of all numpy arrays that can be reached from some objects, each memory once.

    Follows attributes, slots, containers, closures and arrays of objects, not modules, classes
    and the globals of functions.
    """
    seen: dict[int, Any] = {}  # with the object, so that no other one gets its id
    found, waiting = 0, list(roots)
    while waiting:
        one = waiting.pop()
        if id(one) in seen or type(one) in weakref.ProxyTypes:  # a proxy's own may be gone
            continue
        if isinstance(one, type | types.ModuleType | str | bytes | int | float):
            continue
        seen[id(one)] = one
        if isinstance(one, np.ndarray):
            if isinstance(one.base, np.ndarray):
                waiting.append(one.base)  # a view: what it looks at counts
                continue
            found += one.nbytes
            waiting += one.ravel().tolist() if one.dtype == object else []
        else:
            waiting += _parts(one)
    return found


def _parts(one: Any) -> list:
    if isinstance(one, dict | types.MappingProxyType):
        return [*one.keys(), *one.values()]
    if isinstance(one, list | tuple | set | frozenset):
        return list(one)
    if isinstance(one, types.MethodType):
        return [one.__self__, one.__func__]
    if isinstance(one, types.FunctionType):
        return [cell.cell_contents for cell in one.__closure__ or () if _filled(cell)]
    slots = [name for kind in type(one).__mro__ for name in getattr(kind, "__slots__", ())]
    values = [getattr(one, name) for name in slots if isinstance(name, str) and hasattr(one, name)]
    own = getattr(one, "__dict__", None)
    return values + (list(own.values()) if isinstance(own, dict) else [])


def _filled(cell: Any) -> bool:
    try:
        return cell.cell_contents is not None
    except ValueError:
        return False


def memory(n: int = 4096, **env: Any) -> dict[str, float | None]:
    """Bytes that one environment more takes: the growth from 64 environments to 64 + n.

    Parameters
    ----------
    n : int
    **env
        Arguments of the environment.

    Returns
    -------
    dict
        ``simulation``: arrays of the physics; ``batch``: and of task, observation and infos;
        ``environment``: and of the spaces; ``resident``: what the process grew by, Python's objects
        and random generators included (None where the system does not tell).
    """

    def made(count: int):
        envs = gym.make_vec(
            SHIP_ENV,
            num_envs=count,
            vectorization_mode="vector_entry_point",
            parallel=False,
            **env,
        )
        envs.reset(seed=0)
        envs.step(np.zeros(envs.action_space.shape, np.float32))
        gc.collect()
        whole = envs.unwrapped
        batch = getattr(whole, "episodes", whole)
        sim = getattr(batch, "sim", batch)
        return envs, [bytes_of_arrays(x) for x in (sim, batch, whole)]

    small, few = made(64)
    before = resident()
    large, many = made(64 + n)
    after = resident()
    del small, large
    names = ("simulation", "batch", "environment")
    found = {k: (b - a) / n for k, a, b in zip(names, few, many, strict=True)}
    grown = None if before is None or after is None else (after - before) / (64 + n)
    return {**found, "resident": grown}


def resident() -> int | None:
    """Memory of this process [bytes]; None where the system does not tell."""
    status = Path("/proc/self/statm")
    if not status.is_file():
        return None
    return int(status.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def measure(
    name: str, n: int, ship: Any = "kcs", repeats: int = 3, seconds: float = 0.2, kept: Any = None
) -> dict:
    """Time one of `MEASURES`: ``seconds`` is processor time, of threads wall time.

    Parameters
    ----------
    name : str
    n : int
        Ships or environments; scalar work does without.
    ship : str or path
    repeats, seconds
        As in `best_of`.
    kept : dict, optional
        Where work that was made is kept for the next time.
    """
    threads, make = MEASURES[name]
    kept = {} if kept is None else kept
    if (name, n) not in kept:
        kept[name, n] = make(n, ship)
    found = best_of(kept[name, n], repeats, seconds)
    return {"seconds": found["wall" if threads else "processor"], **found}


def _serve() -> None:
    kept: dict = {}
    answers, sys.stdout = sys.stdout, sys.stderr  # whatever prints does not disturb
    for line in sys.stdin:
        try:
            found = _answer(json.loads(line), kept)
        except ValueError as error:  # a ConfigError of whatever checkout
            found = {"error": str(error)}
        print(json.dumps(found), file=answers, flush=True)


def _answer(asked: dict, kept: dict) -> dict:
    if asked["name"] == "where":
        return {"file": ship_gym.__file__}
    if asked["name"] == "memory":
        return memory(**{key: value for key, value in asked.items() if key != "name"})
    return measure(**asked, kept=kept)


if __name__ == "__main__":
    _serve()
