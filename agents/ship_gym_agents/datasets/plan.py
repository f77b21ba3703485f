"""What a data set holds: which controllers, with which noise, in which episodes."""

from __future__ import annotations

import dataclasses
import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ship_gym.config import ConfigError, check_number, shown
from ship_gym.evaluation.controller import Controller
from ship_gym.evaluation.guard import Guarded
from ship_gym.evaluation.rollout import begin
from ship_gym.evaluation.splits import split_of
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship
from ship_gym.tasks import TASKS
from ship_gym.tasks.base import Task
from ship_gym.tasks.columns import ACTIONS
from ship_gym_agents.controllers import make_controller
from ship_gym_agents.datasets.action_noise import uniform_actions
from ship_gym_agents.entrants import controllers_of

RANDOM = "random"  # the controller that draws its actions uniformly


@dataclasses.dataclass(frozen=True)
class Plan:
    """Who sails what.

    Each controller sails `episodes` episodes with each noise; no two of them share a seed.

    Parameters
    ----------
    controllers : tuple of str
        As ``make_controller`` takes them, or `RANDOM`; none: the usual one of the task.
    noise : tuple of float
        Standard deviations of what is added to the actions, which are in [-1, 1].
    noise_time : float
        Its correlation time [full-scale s]; 0: white noise.
    episodes : int
    seed : int
        Of the first episode; the others follow.
    env : mapping
        ``scenario``, ``ship``, ``control``, ``surrogate``, ``privileged``, ``overrides`` as in
        ``ShipEnv``.
    expert : str, optional
        Whose mean return is the score 1 of ``minari.get_normalized_score``; the usual controller
        of the task.
    infos : bool
        Whether the infos of all steps are kept.
    """

    controllers: tuple[str, ...] = ()
    noise: tuple[float, ...] = (0.0,)
    noise_time: float = 10.0
    episodes: int = 100
    seed: int = 0
    env: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    expert: str | None = None
    infos: bool = True

    def __post_init__(self):
        for name in ("controllers", "noise"):
            if not isinstance(given := getattr(self, name), tuple | list):
                raise ConfigError(f"{name} = {shown(given)}: must be a tuple")
        if isinstance(self.env.get("ship"), Ship):
            raise ConfigError("ship: the environment of a data set needs its name or file")
        for std in self.noise:
            check_number("noise", std, 0.0, 2.0)
        if not self.noise or len(set(self.noise)) < len(self.noise):
            raise ConfigError(f"noise = {shown(self.noise)}: must be different numbers, at least 1")
        check_number("noise_time", self.noise_time, 0.0, 3600.0, "s")
        check_number("episodes", self.episodes, 1, 100_000)
        check_number("seed", self.seed, 0, 2**32 - 1)


class Entry(NamedTuple):
    """Episodes of one controller with one noise."""

    controller: Controller
    named: str
    noise: float
    seeds: tuple[int, ...]

    @property
    def label(self) -> str:
        """In words."""
        return f"{self.controller.name}, noise {self.noise:g}"


class Prepared(NamedTuple):
    """A plan that can be sailed: everything that could be refused is checked."""

    plan: Plan
    env: dict[str, Any]
    scenario: Scenario
    ship: Ship
    entries: list[Entry]
    expert: Controller
    expert_named: str

    @property
    def task(self) -> Task:
        """The task of the scenario."""
        return TASKS[self.scenario.task]

    @property
    def memory(self) -> float:
        """Correlation time of the noise in control intervals."""
        return self.plan.noise_time / self.scenario.control_interval


class UniformActions:
    """Actions drawn uniformly from [-1, 1], fixed by the seeds of the episodes."""

    name = RANDOM

    def __init__(self):
        self.seeds: tuple[int, ...] = ()

    def reset(self, count: int, ship: Ship, scenario: Scenario) -> None:
        """Draw all actions of the episodes."""
        columns = len(ACTIONS[scenario.control])
        self._drawn = uniform_actions(self.seeds or range(count), scenario.steps, columns)
        self._next = 0

    def act(self, observations: np.ndarray) -> np.ndarray:
        """The next ones."""
        self._next += 1
        return self._drawn[self._next - 1]


def prepared(plan: Plan) -> Prepared:
    """Make controllers and scenario, and try them on the first episode.

    Raises
    ------
    ConfigError
        Unknown names, keys or values; a controller that cannot steer this; seeds that belong to
        two purposes (``evaluation.splits``).
    """
    env = {**plan.env}
    if isinstance(env.get("ship"), str | os.PathLike) and os.path.isfile(env["ship"]):
        env["ship"] = os.path.abspath(env["ship"])
    start = begin([plan.seed], **env)
    usual = start.task.controllers[0]
    named = plan.controllers or (usual,)
    expert_named = plan.expert or usual
    expert = make_controller(expert_named)
    entries = _entries(plan, named)
    first, last = entries[0].seeds[0], entries[-1].seeds[-1]
    if split_of(first) != split_of(last):
        raise ConfigError(
            f"seeds {first} to {last}: some are of {split_of(first)}, others of {split_of(last)}; "
            "give fewer episodes or another seed"
        )
    for controller in [*(entry.controller for entry in entries), expert]:
        Guarded(controller, [plan.seed]).reset(1, start.ship, start.scenario)
    return Prepared(plan, env, start.scenario, start.ship, entries, expert, expert_named)


def _entries(plan: Plan, named: tuple[str, ...]) -> list[Entry]:
    others = [one for one in named if one != RANDOM]
    made = dict(zip(others, controllers_of(others), strict=True)) if others else {}
    if len(named) - len(others) > 1:
        raise ConfigError(f"two controllers are named {RANDOM!r}; name it once")
    made[RANDOM] = UniformActions()
    first, entries = plan.seed, []
    for name in named:
        for std in plan.noise:
            seeds = tuple(range(first, first + plan.episodes))
            entries.append(Entry(made[name], name, float(std), seeds))
            first += plan.episodes
    return entries


def usual_id(ready: Prepared) -> str:
    """Id of a data set that says what is in it, such as ``ShipGym/HeadingKeeping/pid-kcs-v0``."""
    words = [] if ready.scenario.source == ready.task.name else [Path(ready.scenario.source).stem]
    words += dict.fromkeys(entry.controller.name for entry in ready.entries)
    if any(ready.plan.noise):
        words += ["noise", *(f"{std:g}" for std in ready.plan.noise)]
    words.append(ready.ship.name)
    name = "-".join(re.sub(r"\W+", "_", word).strip("_") for word in words)
    return f"ShipGym/{ready.task.class_name}/{name}-v0"
