"""Hyperparameters: their sections, and how they are put together from partial files.

Each replaces keys of those before: ``hyperparameters/<algorithm>.toml`` and
``<algorithm>.<task>.toml`` of the package, a file of the user's, single keys.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ship_gym.config import (
    ConfigError,
    build,
    check_known,
    check_number,
    merged,
    nearest,
    shown,
    told_of,
)
from ship_gym.reading import read_toml
from ship_gym_agents.forms.form import Form
from ship_gym_agents.sb3.options import (
    OPTIONS,
    GaussNewtonOptions,
    OffPolicyOptions,
    OnPolicyOptions,
)

SECTIONS = ("form", "training", "network", "algorithm", "price")
ACTIVATIONS = ("tanh", "relu")
CRITICS = ("same", "privileged")
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
        Discount per decision.
    learning_rate : float
        At the start; it falls linearly to zero over the budget.
    validations : int
        Number of validations, evenly over the budget.
    threads : int
        Of torch.
    checkpoint : float
        Time between two checkpoints [s of wall clock].
    critic : str
        What the critic sees: ``"same"`` features as the actor, or ``"privileged"`` ones too (sea
        and forces), which the finished policy never needs.
    overrides : dict
        Keys of the scenario, dotted or nested, that hold in training only.
    wear : float
        What a deg/h of rudder travel adds to the score that chooses the best policy, in the score's
        unit (where more is better, takes from it); 0: the score alone decides.
    ships : tuple of str
        Ships that are sailed in training, in turn over the environments; none: the scenario's.
    record : int
        Record the worst episode of every so many validations into ``episodes`` of the run's folder,
        where the last five are kept; 0: none. Needs rerun-sdk.
    """

    envs: int
    episode: float
    gamma: float
    learning_rate: float
    validations: int
    threads: int
    checkpoint: float = 60.0
    critic: str = "same"
    overrides: dict[str, Any] = dataclasses.field(default_factory=dict)
    wear: float = 0.0
    ships: tuple[str, ...] = ()
    record: int = 10

    def __post_init__(self):
        check_number("training.record", self.record, 0, 1000)
        check_number("training.envs", self.envs, 1, 100_000)
        check_number("training.episode", self.episode, 0.0, 1e6, "s")
        check_number("training.gamma", self.gamma, 0.0, 1.0)
        check_number("training.learning_rate", self.learning_rate, 0.0, 1.0)
        check_number("training.validations", self.validations, 1, 1000)
        check_number("training.threads", self.threads, 1, 1024)
        check_number("training.checkpoint", self.checkpoint, 0.0, 1e6, "s")
        check_number("training.wear", self.wear, 0.0, 1e6)
        check_known("training.critic", self.critic, CRITICS)
        if len(self.ships) > self.envs:
            raise ConfigError(
                f"training.ships: {len(self.ships)} ships for training.envs = {self.envs}; allowed "
                "is at least one environment for each"
            )


@dataclasses.dataclass(frozen=True)
class Network:
    """Hidden layers and their activation.

    Attributes
    ----------
    hidden : tuple of int
        Sizes, of the actor; none: a linear one.
    activation : str
    critic : tuple of int
        Sizes, of the critic; none: those of the actor.
    """

    hidden: tuple[int, ...]
    activation: str
    critic: tuple[int, ...] = ()

    def __post_init__(self):
        check_known("network.activation", self.activation, ACTIVATIONS)
        for name in ("hidden", "critic"):
            for size in getattr(self, name):
                check_number(f"network.{name}", size, 1, 4096)


@dataclasses.dataclass(frozen=True)
class Price:
    """What a decision costs beside the reward of the environment; all zero: nothing.

    Attributes
    ----------
    travel : float
        Reward that a degree of rudder travel costs; with a `limit` only at the start.
    reversals : float
        Reward that a reversal of the rudder costs, as ``ship_gym.tasks.measures`` counts them.
    limit : str
        Travel to keep below, in deg/h or ``"base"`` for that of the base; ``""``: the price of
        travel is fixed. With a limit it is a Lagrange multiplier, which rises while the travel is
        above it and falls to zero while it is below. The travel is that of training, exploration
        included, so that the finished policy stays below.
    rate : float
        Change of the price [reward per deg] for a rollout whose travel is twice the limit.
    """

    travel: float = 0.0
    reversals: float = 0.0
    limit: str = ""
    rate: float = 0.0

    def __post_init__(self):
        for name in ("travel", "reversals", "rate"):
            check_number(f"price.{name}", getattr(self, name), 0.0, 1e6)
        if self.limit not in ("", "base"):
            try:
                check_number("price.limit", float(self.limit), 1e-6, 1e6, "deg/h")
            except ValueError as error:
                raise ConfigError(
                    f"price.limit = {shown(self.limit)}: allowed is 'base', a number of deg/h "
                    "above 0, or '' for a fixed price"
                ) from error
        if self.limit and not self.rate:
            raise ConfigError("price.limit without price.rate: allowed is a rate above 0")

    @property
    def any(self) -> bool:
        """Whether anything is priced."""
        return self.travel > 0.0 or self.reversals > 0.0 or bool(self.limit)


@dataclasses.dataclass(frozen=True)
class Hyperparameters:
    """One set of hyperparameters; `algorithm` is the options class of its algorithm."""

    training: Training
    network: Network
    algorithm: OnPolicyOptions | OffPolicyOptions | GaussNewtonOptions
    form: Form = dataclasses.field(default_factory=Form)
    price: Price = dataclasses.field(default_factory=Price)


def algorithm_name(name: str) -> str:
    """Key of `OPTIONS` for a name in any case, with hyphens, underscores or nothing between."""
    keys = {key.replace("_", ""): key for key in OPTIONS}
    plain = str(name).lower().replace("-", "_")
    return check_known("algorithm", keys.get(plain.replace("_", ""), plain), OPTIONS)


def load_hyperparameters(
    algorithm: str = "ppo",
    source: str | Path | Mapping[str, Any] | None = None,
    envs: int | None = None,
    *,
    task: str = "",
    settings: Mapping[str, Any] | None = None,
    where: str = "",
) -> Hyperparameters:
    """Hyperparameters of an algorithm.

    Parameters
    ----------
    algorithm : str
        Key of `OPTIONS`, in any case.
    source : path or mapping, optional
        A TOML file, or a nested mapping, of what shall replace the package's own.
    envs : int, optional
        Replaces ``training.envs``.
    task : str
        The package's own of this task, where it has such.
    settings : mapping, optional
        Single values by dotted key, as in ``{"training.gamma": 0.995}``; they replace all others.
    where : str
        What to call a mapping in an error.

    Raises
    ------
    ConfigError
        Unknown algorithm, section or key (with the nearest one), or a value not allowed.
    """
    algorithm = algorithm_name(algorithm)
    values = read_toml(_FOLDER / f"{algorithm}.toml")
    of_task = _FOLDER / f"{algorithm}.{task}.toml"
    if task and of_task.is_file():
        values = merged(values, read_toml(of_task))
    if isinstance(source, str | Path):
        where = Path(source).name
    where = where or f"hyperparameters of {algorithm}"
    values = merged(values, partial(source, where))
    if envs is not None:
        values = merged(values, {"training": {"envs": envs}})
    values = merged(values, _nested(settings or {}))
    return _hyperparameters(algorithm, values, where)


def _hyperparameters(algorithm: str, values: Mapping[str, Any], where: str) -> Hyperparameters:
    made = {key: dict(values.get(key, {})) for key in SECTIONS}
    limit = made["price"].get("limit")
    if isinstance(limit, int | float) and not isinstance(limit, bool):
        limit = check_number(f"{where}: price.limit", limit, unit="deg/h")
        made["price"]["limit"] = f"{limit:g}"
    made["algorithm"] = build(OPTIONS[algorithm], made["algorithm"], f"{where}: algorithm")
    hyper = build(Hyperparameters, made, where)
    with told_of(where):
        _check_together(algorithm, hyper)
    return hyper


def partial(
    source: str | Path | Mapping[str, Any] | None, where: str = "hyperparameters"
) -> Mapping[str, Any]:
    """Sections of a file or mapping, each of them a section that exists; None: no sections."""
    if isinstance(source, str | Path):
        where, source = Path(source).name, read_toml(source)
    for key, section in (source or {}).items():
        if key not in SECTIONS:
            raise ConfigError(f"{where}: unknown section {shown(key)};{nearest(key, SECTIONS)}")
        if not isinstance(section, Mapping):
            raise ConfigError(f"{where}: {key} = {shown(section)}: must be a section [{key}]")
    return source or {}


def _nested(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Dotted keys as nested sections; what follows the second dot stays one key."""
    made: dict[str, Any] = {}
    for dotted, value in settings.items():
        section, _, key = str(dotted).partition(".")
        if section not in SECTIONS or not key:
            raise ConfigError(
                f"setting {shown(dotted)}: must be section.key, as in training.gamma; sections are "
                f"{', '.join(SECTIONS)}"
            )
        first, _, rest = key.partition(".")
        if rest:  # a key of a mapping, as training.overrides.sea.states
            made.setdefault(section, {}).setdefault(first, {})[rest] = value
        else:
            made.setdefault(section, {})[key] = value
    return made


def _check_together(algorithm: str, hyper: Hyperparameters) -> None:
    """Refuse what single sections allow but cannot be combined."""
    symmetric, privileged = hyper.form.symmetric, hyper.training.critic == "privileged"
    if algorithm == "recurrent_ppo" and symmetric:
        raise ConfigError(
            "form.symmetric = true with recurrent_ppo: a network with memory is not made odd; "
            "allowed is form.symmetric = false, or ppo with form.lags"
        )
    if algorithm == "dqn" and symmetric:
        raise ConfigError(
            "form.symmetric = true with dqn: the choice of one of several decisions is not made "
            "odd; allowed is form.symmetric = false"
        )
    if algorithm in ("dqn", "gauss_newton") and privileged:
        raise ConfigError(
            f"training.critic = 'privileged' with {algorithm}, which has no critic beside its "
            "actor: allowed is 'same'"
        )
    if algorithm == "gauss_newton" and hyper.price.any:
        raise ConfigError(
            "section [price] with gauss_newton: allowed is algorithm.price, the weight of the "
            "squared rudder movement"
        )
    if hyper.price.limit == "base" and not hyper.form.base:
        raise ConfigError(
            "price.limit = 'base' without form.base: allowed is a number of deg/h, or a base"
        )
