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

from ship_gym.config import ConfigError, check_number
from ship_gym.conventions import DELTA, PSI, wrap_angle
from ship_gym.evaluation.metrics import metrics
from ship_gym.evaluation.rollout import Rollout, begin, rollout, tuning_seeds
from ship_gym.provenance import atomic_path, versions
from ship_gym.ships import load_ship
from ship_gym.tasks import TASKS
from ship_gym.tasks.measures import control_cost
from ship_gym_agents.pid import PID, Gains, GainsFile, load_gains, place_for_gains
from ship_gym_agents.wave_filter import LinearShip, LowPass, Observer, identify

_FEEDBACK = ("K_p", "K_d", "K_v")
_OBSERVER = (*_FEEDBACK, "K_b", "observer.sway_noise", "observer.yaw_noise", "observer.bias_noise")
# structure -> gains that are free in it; the others keep their defaults
STRUCTURES: dict[str, tuple[str, ...]] = {
    "PD": ("K_p", "K_d"),
    "PID + sway": (*_FEEDBACK, "K_i"),
    "PID + sway, low-pass": (*_FEEDBACK, "K_i", "low_pass.T_r", "low_pass.T_v"),
    "PD + sway, observer": _OBSERVER,
    "PD + sway, observer with waves": (
        *_OBSERVER,
        "observer.wave_frequency",
        "observer.wave_noise",
    ),
}
# gain -> lowest, highest, where the search begins; on a logarithmic scale if the lowest is positive
_BOUNDS = {
    "K_p": (0.2, 20.0, 3.0),
    "K_d": (0.0, 10.0, 1.5),
    "K_i": (0.0, 1.0, 0.1),
    "K_v": (-8.0, 4.0, -2.0),
    "K_b": (0.0, 1.5, 0.8),
    "low_pass.T_r": (0.01, 1.0, 0.1),
    "low_pass.T_v": (0.01, 2.0, 0.2),
    "observer.sway_noise": (0.02, 20.0, 0.5),
    "observer.yaw_noise": (0.05, 50.0, 2.0),
    "observer.bias_noise": (0.02, 20.0, 0.8),
    "observer.wave_frequency": (8.0, 30.0, 18.0),
    "observer.wave_noise": (1.0, 300.0, 30.0),
}
# Of the measured heading and sway over the yaw rate: about what waves of sea state 5 make of them
# and what sensors add. Free, they brought nothing.
_ERRORS = {"heading_error": 0.05, "sway_error": 0.25}
LAMBDA = 0.1  # of the objective; the environment's default
_CANDIDATES = 20  # in a generation
_SPREAD = 0.15  # standard deviation of the first generation, over the range of each gain
_VALIDATION = 3  # times as many episodes to choose the structure as to tune its gains
_REPORTED = ("J_0.1", "J_1", "rms_error", "rudder_travel", "rudder_reversals")


@dataclasses.dataclass(frozen=True)
class Tuned:
    """Best gains of one structure.

    Attributes
    ----------
    structure : str
    gains : Gains
    J_tuning : float
        Mean J [deg2] on the tuning episodes.
    validation : dict
        Means of metrics on the validation episodes, in their units.
    """

    structure: str
    gains: Gains
    J_tuning: float
    validation: dict[str, float]

    @property
    def J_validation(self) -> float:
        """Mean J [deg2] on the validation episodes."""
        return self.validation["J_0.1"]

    def __str__(self) -> str:
        reversals = self.validation["rudder_reversals"]
        return f"  J {self.J_validation:8.3f} deg2, {reversals:5.0f} reversals/h  {self.structure}"


def check_tunable(task: str) -> None:
    """Refuse a task that is not judged by J, which gains are tuned for.

    Raises
    ------
    ConfigError
        Its metrics have no J.
    """
    if f"J_{LAMBDA:g}" not in TASKS[task].metrics:
        able = [name for name, one in TASKS.items() if f"J_{LAMBDA:g}" in one.metrics]
        raise ConfigError(
            f"task {task!r}: gains are tuned for J = mean(psi_e^2) + {LAMBDA:g} mean(delta^2), "
            f"which it does not have; allowed are {', '.join(able)}"
        )


def episode_costs(sailed: Rollout, lam: float = LAMBDA) -> np.ndarray:
    """J [deg2] of every episode, shape (n,), as ``ship_gym.evaluation.metrics`` defines it."""
    states = sailed.histories["states"][1:]
    alive = np.arange(len(states))[:, None] < sailed.lengths
    limit = math.radians(sailed.scenario.limits.heading_error_deg)
    psi_e = wrap_angle(states[:, :, PSI] - sailed.histories["psi_ordered"][:-1])
    psi_e = np.where(alive, psi_e, limit)
    delta = np.where(alive, states[:, :, DELTA], sailed.ship.gear.delta_max)
    return control_cost(psi_e, delta, lam)


def make_gains(values: Mapping[str, Any], linear: LinearShip | None = None) -> Gains:
    """Gains from values by name as in `STRUCTURES`; what they need and do not name is filled in.

    Parameters
    ----------
    values : mapping
        Numbers, or arrays of shape (count,).
    linear : LinearShip, optional
        For an observer.
    """
    parts: dict[str, dict[str, Any]] = {"": {"K_p": 0.0, "K_d": 0.0}}
    for name, value in values.items():
        part, _, key = name.rpartition(".")
        parts.setdefault(part, {})[key] = value
    made = parts[""]
    if "low_pass" in parts:
        made["low_pass"] = LowPass(**{"T_psi": 0.0} | parts["low_pass"])
    if "observer" in parts:
        made["observer"] = Observer(linear, **_ERRORS | parts["observer"])
    return Gains(**made)


def mean_costs(
    candidates: np.ndarray,
    free: Sequence[str],
    seeds: Sequence[int],
    linear: LinearShip | None = None,
    **env: Any,
):
    """Mean J [deg2] of every candidate over the same episodes.

    Parameters
    ----------
    candidates : numpy.ndarray
        Values of the free gains, shape (m, len(free)).
    free : sequence of str
        Their names.
    seeds : sequence of int
        Episodes.
    linear : LinearShip, optional
        For an observer.
    **env
        Keyword arguments of ``rollout``.

    Returns
    -------
    numpy.ndarray
        Shape (m,).
    """
    rows = np.repeat(candidates, len(seeds), axis=0)
    gains = make_gains({name: rows[:, k] for k, name in enumerate(free)}, linear)
    # One thread: threads that wait for each other on a shared machine are slower than none.
    everyone = list(seeds) * len(candidates)
    sailed = rollout(PID(gains), seeds=everyone, parallel=False, **env)
    return episode_costs(sailed).reshape(len(candidates), len(seeds)).mean(axis=1)


def tune_structure(
    structure: str,
    episodes: int = 24,
    generations: int = 16,
    seed: int = 0,
    *,
    begin_at: Mapping[str, float] | None = None,
    linear: LinearShip | None = None,
    **env: Any,
) -> tuple[Tuned, dict[str, float]]:
    """Tune the free gains of one structure by differential evolution around a start.

    Parameters
    ----------
    structure : str
        Key of `STRUCTURES`.
    episodes : int
        Tuning seeds; the next ``3 * episodes`` of them validate.
    generations : int
    seed : int
        Of the search.
    begin_at : mapping, optional
        Gains by name to begin at, where they are free.
    linear : LinearShip, optional
        For an observer.
    **env
        Keyword arguments of ``rollout`` (ship, control, scenario, overrides).

    Returns
    -------
    tuple
        What was found, and its free gains by name.
    """
    free = STRUCTURES[structure]
    seeds = tuning_seeds((1 + _VALIDATION) * episodes)
    rng, start = np.random.default_rng(seed), begin_at or {}
    centre = _to_unit([start.get(name, _BOUNDS[name][2]) for name in free], free)
    cloud = centre + _SPREAD * rng.standard_normal((_CANDIDATES, len(free)))
    cloud[0] = centre
    found = differential_evolution(
        lambda x: mean_costs(_from_unit(x.T, free), free, seeds[:episodes], linear, **env),
        [(0.0, 1.0)] * len(free),
        maxiter=generations,
        init=np.clip(cloud, 0.0, 1.0),
        tol=1e-4,
        rng=rng,
        polish=False,
        vectorized=True,
        updating="deferred",
    )
    # the digits that the file keeps
    best = {k: float(f"{x:.4g}") for k, x in zip(free, _from_unit(found.x, free), strict=True)}
    gains = make_gains(best, linear)
    J = mean_costs(np.array([list(best.values())]), free, seeds[:episodes], linear, **env)[0]
    judged = rollout(PID(gains), seeds=seeds[episodes:], parallel=False, **env)
    rows = [metrics(trajectory) for trajectory in judged.episodes]
    validation = {name: float(np.mean([row[name] for row in rows])) for name in _REPORTED}
    return Tuned(structure, gains, float(J), validation), best


def _to_unit(values: Sequence[float], free: Sequence[str]) -> np.ndarray:
    """Gains, shape (..., len(free)), as shares of their ranges."""
    columns = []
    for value, (low, high, _) in zip(values, map(_BOUNDS.get, free), strict=True):
        scale = math.log if low > 0.0 else float
        share = (scale(max(value, low)) - scale(low)) / (scale(high) - scale(low))
        columns.append(min(share, 1.0))
    return np.array(columns)


def _from_unit(shares: np.ndarray, free: Sequence[str]) -> np.ndarray:
    """Gains from shares of their ranges, shape (..., len(free)) both."""
    low, high, _ = np.array([_BOUNDS[name] for name in free]).T
    lifted = np.where(low > 0.0, low, 1.0)
    return np.where(low > 0.0, low * (high / lifted) ** shares, low + (high - low) * shares)


def tune(
    ship: str,
    *,
    structures: Iterable[str] = tuple(STRUCTURES),
    episodes: int = 24,
    generations: int = 16,
    seed: int = 0,
    progress: Callable[[Iterable], Iterable] | None = None,
    **env: Any,
) -> list[Tuned]:
    """Tune every structure for a ship; the best on the validation episodes comes first.

    Each structure begins at what the ones before it found.

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
    # scipy would wrap the error of a wrong name
    check_tunable(begin(tuning_seeds(1), ship=ship, **env).scenario.task)
    linear = identify(load_ship(ship))
    names, done, best = list(structures), [], {}
    for name in progress(names) if progress else names:
        found, gains = tune_structure(
            name, episodes, generations, seed, begin_at=best, linear=linear, ship=ship, **env
        )
        done.append(found)
        best |= gains
    return sorted(done, key=lambda tuned: tuned.J_validation)


def settings(
    episodes: int = 24,
    generations: int = 16,
    seed: int = 0,
    scenario: str = "heading_keeping",
    structures: Iterable[str] = tuple(STRUCTURES),
    **more: Any,
) -> dict[str, Any]:
    """What a tuning depends on, as a file of gains tells it; `more`: control, overrides."""
    first = tuning_seeds(1)[0]
    return {
        "objective": f"mean of J = mean(psi_e^2) + {LAMBDA:g} mean(delta^2) [deg2]",
        "method": f"scipy differential evolution, {generations} generations, seed {seed}",
        "scenario": str(scenario),
        "structures": list(structures),
        "seeds_tuning": [first, first + episodes - 1],
        "seeds_validation": [first + episodes, first + (1 + _VALIDATION) * episodes - 1],
        **more,
    }


def is_tuned(ship: str, how: Mapping[str, Any], path: str | Path | None = None) -> bool:
    """Whether a file of gains of this ship by these `settings` and this version is there."""
    name = load_ship(ship).name
    path = place_for_gains(name) if path is None else Path(path)
    if not path.is_file():
        return False
    found = load_gains(path)
    same = all(found.tuning.get(key) == value for key, value in how.items())
    return same and found.ship == name and found.versions == _versions()


def gains_file(ship: str, ranking: Sequence[Tuned], how: Mapping[str, Any]) -> GainsFile:
    """The winner of a ranking with what reproduces it.

    Parameters
    ----------
    ship : str
    ranking : sequence of Tuned
        The winner first.
    how : mapping
        `settings` of the tuning.
    """
    best = ranking[0]
    tuning = {
        "structure": best.structure,
        **how,
        "J_tuning": round(best.J_tuning, 4),
        "J_validation": round(best.J_validation, 4),
        "validation_of": {
            tuned.structure: {k: round(v, 4) for k, v in tuned.validation.items()}
            for tuned in ranking
        },
    }
    return GainsFile(load_ship(ship).name, best.gains, tuning, _versions())


def _versions() -> dict[str, str]:
    return {k: v for k, v in versions().items() if k in ("ship-gym", "python", "numpy", "scipy")}


def write_gains(found: GainsFile, path: str | Path | None = None) -> Path:
    """Write a file of gains, by default to ``pid.place_for_gains``, where the PID finds them."""
    path = place_for_gains(found.ship) if path is None else Path(path)
    data = _given(dataclasses.asdict(found))
    lines = ["# PID gains, see ship_gym_agents/pid.py; written by ship-gym tune", *_toml(data)]
    with atomic_path(path) as temporary:
        temporary.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def _given(data: Mapping[str, Any]) -> dict[str, Any]:
    """Nested mapping without what is None, for which TOML has no word."""
    nested = {k: _given(v) if isinstance(v, Mapping) else v for k, v in data.items()}
    return {k: v for k, v in nested.items() if v is not None}


def _toml(data: Mapping[str, Any], section: str = "") -> list[str]:
    """Lines of a nested mapping of strings, numbers and lists."""
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
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list):
        return "[" + ", ".join(map(_literal, value)) + "]"
    if isinstance(value, int | float):
        return repr(value)
    raise ConfigError(f"cannot write {value!r} to a gains file")
