"""One chunk of the soak: which ship, scenario, sea and actions it has, and what is looked at."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.conventions import DELTA, PSI, G, N, R, U, V
from ship_gym.scenarios.sections import LARGEST

SHIPS_OF_A_CHUNK = 125
INTERVALS = 800
STEPS = SHIPS_OF_A_CHUNK * INTERVALS  # ship-steps of a chunk
SEAS = ("its own", *(f"ss{k}" for k in range(2, 9)))
HELMS = ("random", "bang-bang", "zig-zag", "roll")
DRAWS = ("its own", "extreme")
_STRIDE = 7919  # prime: neighbouring chunks differ in everything
_ZIG_ZAG = math.radians(10.0)
_ROUNDING = 1e-9


class Chunk(NamedTuple):
    """What a chunk sails."""

    number: int
    ship: str
    scenario: str
    sea: str
    helm: str
    draw: str

    def options(self, astern: bool, fitted: bool) -> dict[str, Any]:
        """Arguments of the environment; `fitted`: the ship's surrogate has standard deviations."""
        changes: dict[str, Any] = {"astern": 1.0} if astern else {}
        if self.sea != SEAS[0]:
            changes |= {
                "sea.states": [self.sea],
                "sea.wave_height": 0.0,
                "sea.wave_height_min": 0.0,
            }
            changes |= {"sea.wind_speed": 0.0, "sea.wind_speed_min": 0.0, "sea.peak_period": 8.8}
            changes |= {"sea.gusts": True, "sea.current_speed": 2.0}
        if self.draw == DRAWS[1]:
            changes |= {f"randomisation.{name}": size for name, size in LARGEST.items()}
            if not fitted:
                del changes["randomisation.surrogate_std"]
        return {"ship": self.ship, "scenario": self.scenario, "control": "rudder+rpm",
                "overrides": changes}  # fmt: skip


def scenarios() -> list[str]:
    """Names of the scenarios of the package, without those of tasks from outside."""
    from ship_gym import available_scenarios
    from ship_gym.tasks import TASKS

    return sorted(set(available_scenarios()) - set(TASKS.outside()))


def chunk_of(number: int) -> Chunk:
    """The chunk of a number: its digits, of which every value comes up as often as the others."""
    from ship_gym import available_ships

    lists = (available_ships(), scenarios(), SEAS, HELMS, DRAWS)
    rest, digits = number * _STRIDE, []
    for values in lists:
        rest, k = divmod(rest, len(values))
        digits.append(values[k])
    return Chunk(number, *digits)


class Helm:
    """Actions of n ships: rudder and propeller, in [-1, 1].

    ``random``, uniform; ``bang-bang``, hard over with random reversals of rudder and engine;
    ``zig-zag``, hard over until the heading is 10 deg past the order, at which she swings by
    herself; ``roll``, to and fro at about her roll period, each ship at another one.
    """

    def __init__(self, kind: str, ship: Any, n: int, rng: np.random.Generator):
        self._kind, self._rng = kind, rng
        self._rudder, self._engine = np.ones(n), np.ones(n)
        self._omega = roll_frequency(ship) * rng.uniform(0.7, 1.3, n)

    def act(self, sim: Any, errors: np.ndarray) -> np.ndarray:
        """Actions (n, 2) of ships, `errors` from their ordered heading [rad]."""
        rng, n = self._rng, len(errors)
        if self._kind == "random":
            return rng.uniform(-1.0, 1.0, (n, 2))
        self._engine[rng.random(n) < 0.05] *= -1.0
        if self._kind == "bang-bang":
            self._rudder[rng.random(n) < 0.1] *= -1.0
        elif self._kind == "zig-zag":
            past = np.abs(errors) > _ZIG_ZAG
            self._rudder[past] = -np.sign(errors[past])
        else:
            self._rudder = np.sin(self._omega * sim.time)
        return np.stack([self._rudder, self._engine], axis=1)


def roll_frequency(ship: Any) -> float:
    """Natural frequency of roll [rad/s], sqrt(g GM) / k_xx, without added inertia."""
    if ship.form is None:
        return 2.0 * math.pi / (10.0 / ship.time_unit)
    return math.sqrt(G * ship.form.GM) / ship.form.k_xx


def sail(chunk: Chunk, seed: int, n: int = SHIPS_OF_A_CHUNK, intervals: int = INTERVALS) -> dict:
    """Sail a chunk and look at every step of it.

    Returns
    -------
    dict
        What it was, ``steps`` sailed, ``ended`` and ``diverged`` episodes, the ``fastest`` ship
        through the water by U0 and the largest ``turn`` r L / U0 of those that are ships still,
        steps ``above`` 2 U0, ``bad``: what must not be, counted by name. ``refused``: why it could
        not be made, instead.
    """
    import gymnasium as gym

    import ship_gym

    told = chunk._asdict()
    rng = np.random.default_rng((seed, chunk.number))
    scenario = ship_gym.load_scenario(chunk.scenario)
    known = ship_gym.load_ship(chunk.ship)
    options = chunk.options(bool(chunk.number % 2), _has_std(known))
    env_id = ship_gym.tasks.TASKS[scenario.task].env_id
    try:
        env = gym.make_vec(env_id, num_envs=n, autoreset_mode="Disabled", **options)
    except ConfigError as refused:
        return told | {"refused": str(refused)}
    watch = Watch(env)
    helm = Helm(chunk.helm, env.episodes.ships[0], n, rng)
    observations, _ = env.reset(seed=int(rng.integers(2**31)))
    watch.seen(observations)
    for _ in range(intervals):
        result = env.step(helm.act(env.episodes.sim, _errors(env.episodes)))
        watch.look(*result)
        over = result[2] | result[3]
        if over.any():
            watch.seen(env.reset(options={"reset_mask": over})[0])
    return told | {"steps": n * intervals} | watch.told()


def _has_std(ship: Any) -> bool:
    from ship_gym.envs.randomisation import check_has_std

    try:
        check_has_std(ship)
    except ConfigError:
        return False
    return True


def _errors(episodes: Any) -> np.ndarray:
    """Heading errors from the order or the leg [rad], in [-pi, pi)."""
    error = episodes.sim.state[:, PSI] - episodes.tasks["psi_ordered"]
    return (error + math.pi) % (2.0 * math.pi) - math.pi


class Watch:
    """Looks at every step of a vector environment and counts what must not be."""

    def __init__(self, env: Any):
        self._env, self._batch = env, env.episodes
        ships = self._batch.ships
        self._speed = np.array([ship.file_speed for ship in ships])
        self._length = np.array([ship.hull.L for ship in ships])
        self._rudder = np.array([ship.gear.delta_max for ship in ships])
        self._n = np.array([ship.engine.n_max for ship in ships])
        self._astern = np.array([ship.engine.n_astern for ship in ships])
        self._low, self._high = env.single_observation_space.low, env.single_observation_space.high
        self.bad: dict[str, int] = {}
        self.ended = self.diverged = self.above = 0
        self.fastest = self.turn = 0.0

    def seen(self, observations: np.ndarray) -> None:
        """Look at observations after a reset."""
        inside = (observations >= self._low) & (observations <= self._high)  # nan: neither
        self._count("observation outside its space", ~inside.all(axis=1))

    def look(self, observations, rewards, terminated, truncated, info: Mapping) -> None:
        """Look at what a step has given."""
        batch, sim = self._batch, self._batch.sim
        self.seen(observations)
        state, diverged = sim.state, batch.outcomes == 1
        self._count("state not finite", ~np.isfinite(state).all(axis=1))
        self._count("reward not finite", ~np.isfinite(rewards))
        self._count("term of the reward not finite", ~np.isfinite(batch.terms).all(axis=1))
        for name in ("errors", "power", "energy", "cost"):
            self._count(f"{name} not finite", ~np.isfinite(getattr(batch, name)))
        for name in ("forces", "flow", "waves"):
            array = getattr(sim, name).reshape(len(state), -1)
            self._count(f"{name} not finite", ~np.isfinite(array).all(axis=1))
        over = 1.0 + _ROUNDING
        self._count("rudder over its limit", np.abs(state[:, DELTA]) > over * self._rudder)
        beyond = (state[:, N] > over * self._n) | (state[:, N] < -over * self._astern)
        self._count("propeller over its limit", beyond)
        self._count("diverged, but goes on", diverged & ~terminated)
        self._speeds(state, ~diverged)
        self.ended += int(np.sum(terminated | truncated))
        self.diverged += int(np.sum(diverged))

    def _speeds(self, state: np.ndarray, ships: np.ndarray) -> None:
        """Speeds through the water and yaw rates of those that are ships still."""
        seas = self._batch.sim.seas
        current = np.hypot(seas["V_north"], seas["V_east"])
        own = (np.hypot(state[:, U], state[:, V]) - current) / self._speed
        turn = np.abs(state[:, R]) * self._length / self._speed
        self.above += int(np.sum(own[ships] > 2.0))
        self.fastest = max(self.fastest, float(own[ships].max(initial=0.0)))
        self.turn = max(self.turn, float(turn[ships].max(initial=0.0)))

    def _count(self, what: str, rows: np.ndarray) -> None:
        if rows.any():
            self.bad[what] = self.bad.get(what, 0) + int(rows.sum())

    def told(self) -> dict[str, Any]:
        """What was counted."""
        return {
            "ended": self.ended,
            "diverged": self.diverged,
            "fastest": round(self.fastest, 4),
            "turn": round(self.turn, 4),
            "above": self.above,
            "bad": self.bad,
        }
