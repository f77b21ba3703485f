"""Config of a run: algorithm, scenario, seed and hyperparameters; recipes that hold all of it."""

from __future__ import annotations

import contextlib
import dataclasses
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError, build, merged, nearest, shown, told_of
from ship_gym.envs.env import resolved_scenario
from ship_gym.evaluation.metrics import metrics_of
from ship_gym.keys import Keys
from ship_gym.reading import read_toml
from ship_gym.scenarios.scenario import Scenario, load_scenario
from ship_gym.ships.loader import load_ship
from ship_gym_agents.forms.helm import Helm
from ship_gym_agents.plugins import check_no_code
from ship_gym_agents.sb3.options import OPTIONS
from ship_gym_agents.sb3.run_card import CARD_FILE, read_run_card
from ship_gym_agents.sb3.sections import (
    SECTIONS,
    Hyperparameters,
    algorithm_name,
    load_hyperparameters,
    partial,
)

__all__ = ["OPTIONS", "Hyperparameters", "RunConfig", "load_hyperparameters", "run_config"]

RECIPES = Path(__file__).parents[1] / "recipes"


@dataclasses.dataclass(frozen=True)
class _Recipe:
    """Keys of a recipe; what they mean is checked where they are used."""

    algo: str = "ppo"
    scenario: str = ""
    ship: str = ""
    control: str = ""
    seed: int = 0
    overrides: dict[str, Any] = dataclasses.field(default_factory=dict)
    form: dict[str, Any] = dataclasses.field(default_factory=dict)
    training: dict[str, Any] = dataclasses.field(default_factory=dict)
    network: dict[str, Any] = dataclasses.field(default_factory=dict)
    algorithm: dict[str, Any] = dataclasses.field(default_factory=dict)
    price: dict[str, Any] = dataclasses.field(default_factory=dict)


@dataclasses.dataclass(frozen=True)
class RunConfig:
    """Everything that decides a run; stored in its card.

    Attributes
    ----------
    algorithm : str
        Key of `OPTIONS`.
    scenario : Scenario
        With ship and control.
    seed : int
        Of network, exploration and episodes.
    hyperparameters : Hyperparameters
    """

    algorithm: str
    scenario: Scenario
    seed: int
    hyperparameters: Hyperparameters


def run_config(
    algorithm: str | None = None,
    scenario: str | Path | Mapping[str, Any] | Scenario | None = None,
    *,
    ship: str | None = None,
    control: str | None = None,
    privileged: bool | None = None,
    overrides: Mapping[str, Any] | None = None,
    hyperparameters: str | Path | Mapping[str, Any] | None = None,
    settings: Mapping[str, Any] | None = None,
    envs: int | None = None,
    seed: int | None = None,
    recipe: str | Path | None = None,
) -> RunConfig:
    """Resolve the config of a new run.

    Parameters
    ----------
    algorithm : str, optional
        Key of `OPTIONS`, in any case; ``"ppo"`` without one.
    scenario, ship, control, privileged, overrides
        As in ``ShipEnv``; ``"heading_keeping"`` without one.
    hyperparameters, settings, envs
        As in `load_hyperparameters`.
    seed : int, optional
        0 without one.
    recipe : str or path, optional
        See `load_recipe`. What else is given replaces its keys; with another algorithm its
        section [algorithm] does not count.

    Raises
    ------
    ConfigError
        Anything unknown or not allowed.
    """
    more = (algorithm, scenario, ship, control, privileged, overrides, hyperparameters, settings)
    plan = {} if recipe is None else load_recipe(recipe)
    # With anything given beside it, what is wrong need not be of the recipe.
    alone = None if recipe is None or any((*more, envs, seed)) else Path(recipe).name
    with contextlib.nullcontext() if alone is None else told_of(alone):
        own = algorithm_name(plan.get("algo", "ppo"))
        name = own if algorithm is None else algorithm_name(algorithm)
        given = {"scenario": scenario, "ship": ship, "control": control, "seed": seed}
        plan |= {key: value for key, value in given.items() if value is not None}
        resolved = _scenario_of(plan, privileged, overrides or {})
        source = {key: plan[key] for key in SECTIONS if key in plan}
        if name != own:
            source.pop("algorithm", None)
        source = merged(source, partial(hyperparameters))
        files = [str(Path(f).name) for f in (recipe, hyperparameters) if isinstance(f, str | Path)]
        hyper = load_hyperparameters(
            name, source, envs, task=resolved.task, settings=settings, where=", ".join(files)
        )
        _check_sailing(name, resolved, hyper)
        seed = plan.get("seed", 0)
        if not isinstance(seed, int) or isinstance(seed, bool) or not 0 <= seed < 2**32:
            raise ConfigError(f"seed = {shown(seed)}: must be a whole number, 0 to {2**32 - 1}")
        return RunConfig(name, resolved, seed, hyper)


def _scenario_of(
    plan: Mapping[str, Any], privileged: bool | None, overrides: Mapping[str, Any]
) -> Scenario:
    """The scenario of a plan; refused if no policy can learn in it."""
    resolved, _ = resolved_scenario(
        plan.get("scenario", "heading_keeping"),
        plan.get("ship"),
        plan.get("control"),
        None,
        privileged,
        {**plan.get("overrides", {}), **overrides},
    )
    if resolved.privileged:
        raise ConfigError(
            "privileged = true: a policy never sees sea and forces; its critic does in training "
            "with training.critic = 'privileged'"
        )
    metrics_of(resolved.task)  # refuses a task that no validation can judge
    return resolved


def _check_sailing(algorithm: str, scenario: Scenario, hyper: Hyperparameters) -> None:
    """Refuse now what the ships, the form or the overrides of training would be refused for."""
    if algorithm == "gauss_newton" and not hyper.form.base:
        raise ConfigError(
            "form.base is empty: gauss_newton corrects a classical autopilot; allowed is a form on "
            "a base, as in --recipe heading_gauss_newton"
        )
    training = load_scenario(scenario, hyper.training.overrides)
    for ship in {scenario.ship, *hyper.training.ships}:
        Helm(hyper.form).reset(1, load_ship(ship, surrogate=scenario.surrogate), training)


def available_recipes() -> list[str]:
    """Names of the recipes that come with the package."""
    return sorted(path.stem for path in RECIPES.glob("*.toml"))


def load_recipe(name_or_path: str | Path) -> dict[str, Any]:
    """A recipe: ``algo``, ``scenario``, ``ship``, ``control`` and sections of hyperparameters.

    Parameters
    ----------
    name_or_path : str or path
        One of `available_recipes`, or a TOML file of one's own. ``algo`` is a key of `OPTIONS`;
        ``overrides`` a table of keys of the scenario.

    Raises
    ------
    ConfigError
        No such recipe, or a key that none has (with the nearest one).
    """
    path = Path(name_or_path)
    if path.suffix != ".toml":
        names = available_recipes()
        if str(name_or_path) not in names:
            raise ConfigError(
                f"unknown recipe {shown(str(name_or_path))};{nearest(path.name, names)}"
            )
        path = RECIPES / f"{name_or_path}.toml"
    values = read_toml(path)
    build(_Recipe, values, path.name)
    return values


def load_config(out: str | Path) -> RunConfig:
    """Config of the run in a folder, from its card; one that steers by Python is refused.

    Who trains by an autopilot of one's own names it; a card, which may be anybody's, does not.
    """
    file = Path(out) / CARD_FILE
    config = Keys(read_card(Path(out)), str(file)).table("config")
    algorithm, sections = config.text("algorithm"), config.table("hyperparameters").values
    with told_of(file):
        scenario = load_scenario(config.table("scenario").values)
        hyper = load_hyperparameters(algorithm, sections)
    check_no_code(hyper.form.base, file, "train anew, into another folder")
    values = {**config.values, "scenario": scenario, "hyperparameters": hyper}
    return build(RunConfig, values, str(file))


def read_card(out: Path) -> dict[str, Any]:
    """Card of the run in a folder, or a ConfigError."""
    file = out / CARD_FILE
    if not file.is_file():
        raise ConfigError(f"{out}: no run to resume here (no {CARD_FILE})")
    return read_run_card(file)


def is_config_of(out: str | Path, config: RunConfig) -> bool:
    """Whether the run in a folder has this config; keys that are newer than it are the default."""
    return plain(load_config(out)) == plain(config)


def check_free(out: str | Path) -> None:
    """Refuse a folder that holds a run."""
    if (Path(out) / CARD_FILE).exists():
        raise ConfigError(f"{out} holds a run; resume it or choose another folder")


def plain(config: RunConfig) -> dict[str, Any]:
    """Config as JSON gives it back: tuples are lists there."""
    return json.loads(json.dumps(dataclasses.asdict(config)))


def config_for(out: str | Path, resume: bool, given: Mapping[str, Any]) -> RunConfig:
    """Config from arguments of `run_config`, or that of the run in `out` if it is resumed."""
    if not resume:
        return run_config(**given)
    if given:
        raise ConfigError(f"a resumed run keeps its config; leave out: {', '.join(given)}")
    return load_config(out)
