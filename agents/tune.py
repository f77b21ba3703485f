"""Tune the gains of the PID on tuning seeds: several structures, the best one is kept.

All candidates of a generation sail the same episodes in one batch, each with its own gains.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import differential_evolution

from agents.pid import PID, Gains, GainsFile, gains_path
from ship_gym.config import ConfigError, check_number
from ship_gym.conventions import DELTA, PSI, wrap_angle
from ship_gym.evaluation.metrics import control_cost
from ship_gym.evaluation.rollout import Rollout, begin, rollout, tuning_seeds
from ship_gym.provenance import atomic_path, versions
from ship_gym.ships import load_ship

# structure -> gains that are free in it; the others keep their defaults
STRUCTURES: dict[str, tuple[str, ...]] = {
    "PD": ("K_p", "K_d"),
    "PID": ("K_p", "K_d", "K_i"),
    "PID + error limit": ("K_p", "K_d", "K_i", "error_limit"),
    "PD + sway": ("K_p", "K_d", "K_v"),
    "PID + sway": ("K_p", "K_d", "K_i", "K_v"),
}
_BOUNDS = {
    "K_p": (0.2, 20.0),
    "K_d": (0.0, 25.0),
    "K_i": (0.0, 1.0),
    "K_v": (-8.0, 4.0),
    "error_limit": (0.05, 0.6),
}
LAMBDA = 0.1  # of the objective; the environment's default
_CANDIDATES = 20  # in a generation
_VALIDATION = 3  # times as many episodes to choose the structure as to tune its gains


@dataclasses.dataclass(frozen=True)
class Tuned:
    """Best gains of one structure and their mean J [deg2] on tuning and validation episodes."""

    structure: str
    gains: Gains
    J_tuning: float
    J_validation: float


def episode_costs(sailed: Rollout, lam: float = LAMBDA) -> np.ndarray:
    """J [deg2] of every episode, shape (n,), as ``ship_gym.evaluation.metrics`` defines it."""
    states = sailed.histories["states"][1:]
    alive = np.arange(len(states))[:, None] < sailed.lengths
    limit = math.radians(sailed.scenario.limits.heading_error_deg)
    psi_e = wrap_angle(states[:, :, PSI] - sailed.histories["orders"][:-1])
    psi_e = np.where(alive, psi_e, limit)
    delta = np.where(alive, states[:, :, DELTA], sailed.ship.gear.delta_max)
    return control_cost(psi_e, delta, lam)


def mean_costs(candidates: np.ndarray, free: Sequence[str], seeds: Sequence[int], **env: Any):
    """Mean J [deg2] of every candidate over the same episodes.

    Parameters
    ----------
    candidates : numpy.ndarray
        Values of the free gains, shape (m, len(free)).
    free : sequence of str
        Their names.
    seeds : sequence of int
        Episodes.
    **env
        Keyword arguments of ``rollout``.

    Returns
    -------
    numpy.ndarray
        Shape (m,).
    """
    rows = np.repeat(candidates, len(seeds), axis=0)
    gains = {"K_p": 0.0, "K_d": 0.0} | {name: rows[:, k] for k, name in enumerate(free)}
    # One thread: threads that wait for each other on a shared machine are slower than none.
    everyone = list(seeds) * len(candidates)
    sailed = rollout(PID(Gains(**gains)), seeds=everyone, parallel=False, **env)
    return episode_costs(sailed).reshape(len(candidates), len(seeds)).mean(axis=1)


def tune_structure(
    structure: str, episodes: int = 32, generations: int = 25, seed: int = 0, **env: Any
) -> Tuned:
    """Tune the free gains of one structure by differential evolution.

    Parameters
    ----------
    structure : str
        Key of `STRUCTURES`.
    episodes : int
        Tuning seeds; the next ``3 * episodes`` of them validate.
    generations : int
    seed : int
        Of the search.
    **env
        Keyword arguments of ``rollout`` (ship, control, scenario, overrides).
    """
    free = STRUCTURES[structure]
    seeds = tuning_seeds((1 + _VALIDATION) * episodes)
    found = differential_evolution(
        lambda x: mean_costs(x.T, free, seeds[:episodes], **env),
        [_BOUNDS[name] for name in free],
        maxiter=generations,
        popsize=math.ceil(_CANDIDATES / len(free)),
        tol=1e-4,
        rng=np.random.default_rng(seed),
        polish=False,
        vectorized=True,
        updating="deferred",
    )
    best = np.array([float(f"{x:.4g}") for x in found.x])  # the digits that the file keeps
    costs = [
        mean_costs(best[None], free, s, **env)[0] for s in (seeds[:episodes], seeds[episodes:])
    ]
    gains = {"K_d": 0.0} | dict(zip(free, best.tolist(), strict=True))
    return Tuned(structure, Gains(**gains), float(costs[0]), float(costs[1]))


def tune(
    ship: str,
    *,
    structures: Iterable[str] = tuple(STRUCTURES),
    episodes: int = 32,
    generations: int = 25,
    seed: int = 0,
    progress: Callable[[Iterable], Iterable] | None = None,
    **env: Any,
) -> list[Tuned]:
    """Tune every structure for a ship; the best on the validation episodes comes first.

    Parameters
    ----------
    ship : str
    structures, episodes, generations, seed
        See `tune_structure`.
    progress : callable, optional
        Wraps the iterable of structures.
    **env
        Keyword arguments of ``rollout``.
    """
    check_number("episodes", episodes, 2, 10_000)
    check_number("generations", generations, 1, 10_000)
    begin(tuning_seeds(1), ship=ship, **env)  # scipy would wrap the error of a wrong name
    names = list(structures)
    done = [
        tune_structure(name, episodes, generations, seed, ship=ship, **env)
        for name in (progress(names) if progress else names)
    ]
    return sorted(done, key=lambda tuned: tuned.J_validation)


def gains_file(ship: str, ranking: Sequence[Tuned], episodes: int, how: str) -> GainsFile:
    """The winner of a ranking with what reproduces it."""
    best, first = ranking[0], tuning_seeds(1)[0]
    tuning = {
        "structure": best.structure,
        "objective": f"mean of J = mean(psi_e^2) + {LAMBDA:g} mean(delta^2) [deg2]",
        "method": how,
        "scenario": "heading_keeping",
        "seeds_tuning": [first, first + episodes - 1],
        "seeds_validation": [first + episodes, first + (1 + _VALIDATION) * episodes - 1],
        "J_tuning": round(best.J_tuning, 4),
        "J_validation": round(best.J_validation, 4),
        "J_validation_of": {tuned.structure: round(tuned.J_validation, 4) for tuned in ranking},
    }
    used = {k: v for k, v in versions().items() if k in ("ship-gym", "python", "numpy", "scipy")}
    return GainsFile(load_ship(ship).name, best.gains, tuning, used)


def write_gains(found: GainsFile, path: str | Path | None = None) -> Path:
    """Write a file of gains, by default where the PID looks for those of the ship."""
    path = gains_path(found.ship) if path is None else Path(path)
    data = dataclasses.asdict(found)
    lines = ["# PID gains, see agents/pid.py; written by scripts/tune.py", *_toml(data)]
    with atomic_path(path) as temporary:
        temporary.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def _toml(data: Mapping[str, Any], section: str = "") -> list[str]:
    """Lines of a nested mapping of strings, numbers and lists of numbers."""
    lines = [f"{_key(k)} = {_literal(v)}" for k, v in data.items() if not isinstance(v, Mapping)]
    for key, value in data.items():
        if isinstance(value, Mapping):
            name = f"{section}{_key(key)}"
            lines += ["", f"[{name}]", *_toml(value, f"{name}.")]
    return lines


def _key(name: str) -> str:
    return name if name.replace("_", "").replace("-", "").isalnum() else f'"{name}"'


def _literal(value: object) -> str:
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, int | float | list):
        return repr(value)
    raise ConfigError(f"cannot write {value!r} to a gains file")
