"""Models of stable-baselines3: build one from hyperparameters, explore, export its actor."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import torch
from sb3_contrib import TQC, RecurrentPPO
from stable_baselines3 import DQN, SAC, TD3
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.noise import NormalActionNoise, VectorizedActionNoise
from stable_baselines3.common.vec_env import VecNormalize

from ship_gym.config import ConfigError
from ship_gym_agents.policies.networks import Lstm, Mlp, Network
from ship_gym_agents.policies.normaliser import Normaliser
from ship_gym_agents.policies.policy import Policy
from ship_gym_agents.sb3 import networks
from ship_gym_agents.sb3.checkpoint import load_checkpoint, save_checkpoint
from ship_gym_agents.sb3.environments import form_env
from ship_gym_agents.sb3.overlapped import OverlappedPPO
from ship_gym_agents.sb3.sections import Hyperparameters

__all__ = ["ALGORITHMS", "export", "load_checkpoint", "make_model", "save_checkpoint"]

TORCH_ACTIVATIONS = {"tanh": torch.nn.Tanh, "relu": torch.nn.ReLU}
_SEEN_BEFORE = 1e5  # samples that the normaliser of a policy to begin with counts as


@dataclasses.dataclass(frozen=True)
class Algorithm:
    """A class of stable-baselines3 and its actor.

    Attributes
    ----------
    cls : type
        The algorithm.
    policy : type or str
        Actor and critic.
    layers : callable
        Modules of the actor, from features to decision, of a policy.
    output : str
        How a decision leaves them, as ``policies.networks`` has it.
    critic : str
        Name of the critic in a description of the architecture; empty: there is none.
    """

    cls: type[BaseAlgorithm]
    policy: type | str
    layers: Callable[[Any], list[torch.nn.Module]]
    output: str
    critic: str


ALGORITHMS: dict[str, Algorithm] = {
    "ppo": Algorithm(
        OverlappedPPO,
        networks.ShipPolicy,
        lambda policy: [*policy.mlp_extractor.policy_net],
        "clip",
        "vf",
    ),
    "recurrent_ppo": Algorithm(
        RecurrentPPO,
        networks.ShipRecurrentPolicy,
        lambda policy: [*policy.mlp_extractor.policy_net, policy.action_net],
        "clip",
        "vf",
    ),
    "sac": Algorithm(
        SAC,
        networks.ShipSACPolicy,
        lambda policy: [*policy.actor.latent_pi, policy.actor.mu],
        "tanh",
        "qf",
    ),
    "td3": Algorithm(TD3, networks.ShipTD3Policy, lambda policy: [*policy.actor.mu], "tanh", "qf"),
    "tqc": Algorithm(
        TQC,
        networks.ShipTQCPolicy,
        lambda policy: [*policy.actor.latent_pi, policy.actor.mu],
        "tanh",
        "qf",
    ),
    "dqn": Algorithm(DQN, "MlpPolicy", lambda policy: [*policy.q_net.q_net], "argmax", ""),
}
# Options that are ours: not arguments of stable-baselines3, see explore, make_env and _network.
_OURS = (
    "log_std_init",
    "log_std_final",
    "lstm",
    "levels",
    "exploration_init",
    "exploration_final",
    "exploration_share",
)
_OF_POLICY = ("n_quantiles", "n_critics")  # those that TQC's policy takes


def make_model(
    algorithm: str,
    env: VecNormalize,
    hyper: Hyperparameters,
    seed: int,
    schedule: Callable[[float], float],
    log_folder: Path | None = None,
) -> BaseAlgorithm:
    """An untrained model.

    Parameters
    ----------
    algorithm : str
        Key of `ALGORITHMS`.
    env : VecNormalize
        Of ``environments.make_env``.
    hyper : Hyperparameters
    seed : int
        Of torch, NumPy and Python.
    schedule : callable
        Learning rate; gets the progress remaining as stable-baselines3 counts it.
    log_folder : path, optional
        For tensorboard.
    """
    given = dataclasses.asdict(hyper.algorithm)
    options = {name: value for name, value in given.items() if name not in (*_OURS, *_OF_POLICY)}
    if (sigma := options.pop("action_noise", None)) is not None:
        size = env.action_space.shape
        noise = NormalActionNoise(np.zeros(size), np.full(size, sigma))
        options["action_noise"] = VectorizedActionNoise(noise, env.num_envs)
    made = ALGORITHMS[algorithm]
    return made.cls(
        made.policy,
        env,
        learning_rate=schedule,
        gamma=hyper.training.gamma,
        policy_kwargs=_network(algorithm, env, hyper),
        seed=seed,
        device="cpu",
        tensorboard_log=None if log_folder is None else str(log_folder),
        **options,
    )


def _network(algorithm: str, env: VecNormalize, hyper: Hyperparameters) -> dict[str, Any]:
    """Arguments of the policy of stable-baselines3."""
    found: dict[str, Any] = {"activation_fn": TORCH_ACTIVATIONS[hyper.network.activation]}
    hidden, critic = list(hyper.network.hidden), ALGORITHMS[algorithm].critic
    if not critic:
        return {**found, "net_arch": hidden}
    found["net_arch"] = {"pi": hidden, critic: list(hyper.network.critic or hidden)}
    first = form_env(env)
    found["n_features"] = first.n_features
    given = dataclasses.asdict(hyper.algorithm)
    if algorithm == "recurrent_ppo":
        return {**found, "lstm_hidden_size": given["lstm"]}
    found |= {name: given[name] for name in _OF_POLICY if name in given}
    return {**found, "mirror": first.mirror}


def explore(model: BaseAlgorithm, options: Any, used: float) -> None:
    """Before a rollout: how widely to explore, and what the rudder's travel costs.

    With wide noise the rate-limited rudder always moves at full speed, so that a mean action which
    chatters costs nothing more; the narrow noise of the end shows its price.

    Parameters
    ----------
    model : BaseAlgorithm
    options : dataclass
        Of the algorithm.
    used : float
        Share of the budget that is used up.
    """
    if hasattr(options, "log_std_final"):
        log_std = options.log_std_init + (options.log_std_final - options.log_std_init) * used
        model.policy.log_std.requires_grad_(False).fill_(log_std)
    if hasattr(options, "exploration_final"):
        gone = min(1.0, used / options.exploration_share)
        change = options.exploration_final - options.exploration_init
        rate = options.exploration_init + change * gone
        model.exploration_schedule = lambda _: rate
    price = form_env(model.get_env()).price
    if price.update():
        model.logger.record("price/travel", price.travel)
        model.logger.record("price/travel_price", price.travel_price)


def export(
    model: BaseAlgorithm, algorithm: str, hyper: Hyperparameters, card: Mapping[str, Any]
) -> Policy:
    """The mean decision of a model and the present state of its normaliser, as a controller."""
    env = model.get_vec_normalize_env()
    part = form_env(env)
    n, rms = part.n_features, env.obs_rms
    scale = np.sqrt(rms.var + env.epsilon)[:n]
    names = {"features": list(part.helm.names), "decisions": list(part.helm.decisions)}
    return Policy(
        part.form,
        Normaliser(rms.mean[:n].copy(), scale, env.clip_obs),
        _exported_network(model, algorithm, hyper),
        {**card, **names},
    )


def _exported_network(model: BaseAlgorithm, algorithm: str, hyper: Hyperparameters) -> Network:
    part = form_env(model.get_env())
    linear = _linear_layers(model, algorithm)
    mirror = part.mirror if algorithm != "recurrent_ppo" else None
    mlp = Mlp(
        tuple(_numbers(layer.weight) for layer in linear),
        tuple(_numbers(layer.bias) for layer in linear),
        hyper.network.activation,
        ALGORITHMS[algorithm].output,
        mirror,
        part.choices,
    )
    if algorithm != "recurrent_ppo":
        return mlp
    memory = model.policy.lstm_actor
    bias = _numbers(memory.bias_ih_l0) + _numbers(memory.bias_hh_l0)
    return Lstm(_numbers(memory.weight_ih_l0), _numbers(memory.weight_hh_l0), bias, mlp)


def _linear_layers(model: BaseAlgorithm, algorithm: str) -> list[torch.nn.Linear]:
    layers = ALGORITHMS[algorithm].layers(model.policy)
    return [layer for layer in layers if isinstance(layer, torch.nn.Linear)]


def _numbers(parameter: torch.Tensor) -> np.ndarray:
    return parameter.detach().numpy().astype(np.float64)


def warm_start(
    model: BaseAlgorithm, algorithm: str, hyper: Hyperparameters, policy: Policy
) -> None:
    """Begin with the actor and the normaliser of a policy; the critic is new.

    Raises
    ------
    ConfigError
        A policy of another form or network.
    """
    own = export(model, algorithm, hyper, {"name": "the run"})
    for what, theirs, ours in (
        ("form", policy.form, own.form),
        ("features", policy.card.get("features"), own.card["features"]),
        ("decisions", policy.card.get("decisions"), own.card["decisions"]),
        ("network", policy.network.about(), own.network.about()),
    ):
        if theirs != ours:
            raise ConfigError(
                f"cannot begin with policy {policy.name}: its {what} is {theirs}, that of the run "
                f"{ours}; allowed is the same"
            )
    env = model.get_vec_normalize_env()
    rms, n = env.obs_rms, len(policy.normaliser.mean)
    rms.mean[:n] = policy.normaliser.mean
    rms.var[:n] = policy.normaliser.scale**2 - env.epsilon
    rms.count = _SEEN_BEFORE
    tensors = policy.network.tensors()
    with torch.no_grad():
        for k, layer in enumerate(_linear_layers(model, algorithm)):
            layer.weight.copy_(torch.as_tensor(tensors[f"weight_{k}"]))
            layer.bias.copy_(torch.as_tensor(tensors[f"bias_{k}"]))
        if algorithm == "recurrent_ppo":
            memory = model.policy.lstm_actor
            memory.weight_ih_l0.copy_(torch.as_tensor(tensors["input_weight"]))
            memory.weight_hh_l0.copy_(torch.as_tensor(tensors["hidden_weight"]))
            memory.bias_ih_l0.copy_(torch.as_tensor(tensors["gate_bias"]))
            memory.bias_hh_l0.zero_()
    for target in ("actor_target", "q_net_target"):
        if hasattr(model.policy, target):
            source = getattr(model.policy, target.removesuffix("_target"))
            getattr(model.policy, target).load_state_dict(source.state_dict())
