"""Config of a run: hyperparameters from ``hyperparameters/<algorithm>.toml``, scenario, seed."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ship_gym.config import (
    ConfigError,
    build,
    check_known,
    check_number,
    merged,
    read_text,
    read_toml,
)
from ship_gym.envs.env import resolved_scenario
from ship_gym.evaluation.metrics import metrics_of
from ship_gym.scenarios.scenario import Scenario, load_scenario
from ship_gym.ships.loader import load_ship
from ship_gym_agents.sb3.policy import ACTIVATIONS

CARD_FILE = "card.json"
_FOLDER = Path(__file__).with_name("hyperparameters")


@dataclasses.dataclass(frozen=True)
class Training:
    """What every algorithm needs.

    Attributes
    ----------
    envs : int
        Environments in the batch.
    episode : float
        Length of a training episode [full-scale s]; 0: the scenario's. An episode that is cut off
        is bootstrapped with the value of its last state, so the task stays the same; shorter ones
        hold more of the transient from which there is most to learn.
    gamma : float
        Discount per control interval.
    learning_rate : float
        At the start; it falls linearly to zero over the budget.
    validations : int
        Number of validations, evenly over the budget.
    threads : int
        Of torch.
    """

    envs: int
    episode: float
    gamma: float
    learning_rate: float
    validations: int
    threads: int

    def __post_init__(self):
        check_number("training.envs", self.envs, 1, 100_000)
        check_number("training.episode", self.episode, 0.0, 1e6, "s")
        check_number("training.gamma", self.gamma, 0.0, 1.0)
        check_number("training.learning_rate", self.learning_rate, 0.0, 1.0)
        check_number("training.validations", self.validations, 1, 1000)
        check_number("training.threads", self.threads, 1, 1024)


@dataclasses.dataclass(frozen=True)
class Network:
    """Sizes and activation of the hidden layers, the same for actor and critic."""

    hidden: tuple[int, ...]
    activation: str

    def __post_init__(self):
        check_known("network.activation", self.activation, ACTIVATIONS)
        for size in self.hidden:
            check_number("network.hidden", size, 1, 4096)


@dataclasses.dataclass(frozen=True)
class PPOOptions:
    """Arguments of stable-baselines3's PPO, and how wide it explores.

    The logarithm of the standard deviation of the actions goes linearly from `log_std_init` to
    `log_std_final` over the budget; it is not learned.
    """

    n_steps: int
    batch_size: int
    n_epochs: int
    gae_lambda: float
    clip_range: float
    ent_coef: float
    vf_coef: float
    max_grad_norm: float
    log_std_init: float
    log_std_final: float

    def __post_init__(self):
        for name in ("n_steps", "batch_size", "n_epochs"):
            check_number(f"algorithm.{name}", getattr(self, name), 1, 1e7)
        if self.batch_size < 2:
            raise ConfigError("algorithm.batch_size = 1: allowed is 2 and more")
        for name in ("gae_lambda", "clip_range"):
            check_number(f"algorithm.{name}", getattr(self, name), 0.0, 1.0)
        for name in ("ent_coef", "vf_coef", "max_grad_norm"):
            check_number(f"algorithm.{name}", getattr(self, name), 0.0, 1e3)
        for name in ("log_std_init", "log_std_final"):
            check_number(f"algorithm.{name}", getattr(self, name), -10.0, 2.0)


@dataclasses.dataclass(frozen=True)
class OffPolicyOptions:
    """Arguments that SAC and TD3 of stable-baselines3 share."""

    buffer_size: int
    learning_starts: int
    batch_size: int
    tau: float
    train_freq: int
    gradient_steps: int

    def __post_init__(self):
        for name in ("buffer_size", "batch_size", "train_freq", "gradient_steps"):
            low = -1 if name == "gradient_steps" else 1  # -1: as many as samples
            check_number(f"algorithm.{name}", getattr(self, name), low, 1e8)
        check_number("algorithm.learning_starts", self.learning_starts, 0, self.buffer_size)
        check_number("algorithm.tau", self.tau, 0.0, 1.0)


@dataclasses.dataclass(frozen=True)
class SACOptions(OffPolicyOptions):
    """Arguments of stable-baselines3's SAC; the entropy coefficient is learned."""


@dataclasses.dataclass(frozen=True)
class TD3Options(OffPolicyOptions):
    """Arguments of stable-baselines3's TD3, and the standard deviation of its exploration."""

    policy_delay: int
    action_noise: float


OPTIONS: dict[str, type] = {"ppo": PPOOptions, "sac": SACOptions, "td3": TD3Options}


@dataclasses.dataclass(frozen=True)
class Hyperparameters:
    """One file of hyperparameters; `algorithm` is the options class of its algorithm."""

    training: Training
    network: Network
    algorithm: PPOOptions | SACOptions | TD3Options


def load_hyperparameters(
    algorithm: str = "ppo",
    source: str | Path | Mapping[str, Any] | None = None,
    envs: int | None = None,
) -> Hyperparameters:
    """Hyperparameters of an algorithm.

    Parameters
    ----------
    algorithm : str
        Key of `OPTIONS`.
    source : path or mapping, optional
        A TOML file instead of the one that comes with the package, or a nested mapping of keys to
        replace in that one.
    envs : int, optional
        Replaces ``training.envs``.

    Raises
    ------
    ConfigError
        Unknown algorithm or key (with the nearest one), missing key, or a value not allowed.
    """
    check_known("algorithm", algorithm, OPTIONS)
    own = isinstance(source, str | Path)
    file = Path(source) if own else _FOLDER / f"{algorithm}.toml"
    values = merged(read_toml(file), source if isinstance(source, Mapping) else {})
    if envs is not None:
        values = merged(values, {"training": {"envs": envs}})
    for section in ("training", "network", "algorithm"):
        if not isinstance(values.get(section), Mapping):
            raise ConfigError(f"{file}: no section [{section}]")
    options = build(OPTIONS[algorithm], values["algorithm"], f"{file.name}: algorithm")
    return build(Hyperparameters, {**values, "algorithm": options}, file.name)


@dataclasses.dataclass(frozen=True)
class RunConfig:
    """Everything that decides a run; stored in its card.

    Attributes
    ----------
    algorithm : str
        Key of ``ship_gym_agents.sb3.config.OPTIONS``.
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
    algorithm: str = "ppo",
    scenario: str | Path | Mapping[str, Any] | Scenario = "heading_keeping",
    *,
    ship: str | None = None,
    control: str | None = None,
    privileged: bool | None = None,
    overrides: Mapping[str, Any] | None = None,
    hyperparameters: str | Path | Mapping[str, Any] | None = None,
    envs: int | None = None,
    seed: int = 0,
) -> RunConfig:
    """Resolve the config of a new run.

    Parameters
    ----------
    algorithm : str
        ``"ppo"``, ``"sac"`` or ``"td3"``.
    scenario, ship, control, privileged, overrides
        As in ``ShipEnv``.
    hyperparameters, envs
        As in `load_hyperparameters`.
    seed : int

    Raises
    ------
    ConfigError
        Anything unknown or not allowed.
    """
    hyper = load_hyperparameters(algorithm, hyperparameters, envs)
    resolved, _ = resolved_scenario(scenario, ship, control, None, privileged, overrides)
    load_ship(resolved.ship, surrogate=resolved.surrogate)  # refuses an unknown one now
    metrics_of(resolved.task)  # and a task that no validation can judge
    if seed < 0:
        raise ConfigError(f"seed = {seed}: must not be negative")
    return RunConfig(algorithm, resolved, seed, hyper)


def load_config(out: str | Path) -> RunConfig:
    """Config of the run in a folder, from its card."""
    values = dict(read_card(Path(out))["config"])
    scenario = load_scenario(values["scenario"])
    hyper = load_hyperparameters(values["algorithm"], values["hyperparameters"])
    values |= {"scenario": scenario, "hyperparameters": hyper}
    return build(RunConfig, values, str(Path(out) / CARD_FILE))


def read_card(out: Path) -> dict[str, Any]:
    """Card of the run in a folder, or a ConfigError."""
    file = out / CARD_FILE
    if not file.is_file():
        raise ConfigError(f"{out}: no run to resume here (no {CARD_FILE})")
    try:
        return json.loads(read_text(file))
    except json.JSONDecodeError as error:
        raise ConfigError(f"{file}: not valid JSON: {error}") from None


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
