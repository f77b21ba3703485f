"""Models of stable-baselines3: build one from hyperparameters, export its actor, keep its state."""

from __future__ import annotations

import dataclasses
import json
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO, SAC, TD3
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.noise import NormalActionNoise, VectorizedActionNoise
from stable_baselines3.common.save_util import load_from_zip_file, save_to_zip_file
from stable_baselines3.common.vec_env import VecNormalize

from ship_gym.config import ConfigError
from ship_gym.provenance import atomic_path
from ship_gym_agents.sb3.config import Hyperparameters
from ship_gym_agents.sb3.policy import Actor, Normaliser, SB3Policy

_TORCH_ACTIVATIONS = {"tanh": torch.nn.Tanh, "relu": torch.nn.ReLU}
_STATE = "state.json"
_REPLAY = "replay_buffer.pkl"


def _ppo_layers(policy: Any) -> list[torch.nn.Module]:
    return [*policy.mlp_extractor.policy_net, policy.action_net]


def _sac_layers(policy: Any) -> list[torch.nn.Module]:
    return [*policy.actor.latent_pi, policy.actor.mu]


def _td3_layers(policy: Any) -> list[torch.nn.Module]:
    return list(policy.actor.mu)


@dataclasses.dataclass(frozen=True)
class Algorithm:
    """A class of stable-baselines3, the layers of its actor, and how an action leaves them."""

    cls: type[BaseAlgorithm]
    layers: Callable[[Any], list[torch.nn.Module]]
    output: str


ALGORITHMS: dict[str, Algorithm] = {
    "ppo": Algorithm(PPO, _ppo_layers, "clip"),
    "sac": Algorithm(SAC, _sac_layers, "tanh"),
    "td3": Algorithm(TD3, _td3_layers, "tanh"),
}


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
    hyper : Hyperparameters
    seed : int
        Of torch, NumPy and Python.
    schedule : callable
        Learning rate; gets the progress remaining as stable-baselines3 counts it.
    log_folder : path, optional
        For tensorboard.
    """
    options = dataclasses.asdict(hyper.algorithm)
    network: dict[str, Any] = {
        "net_arch": list(hyper.network.hidden),
        "activation_fn": _TORCH_ACTIVATIONS[hyper.network.activation],
    }
    for name in ("log_std_init", "log_std_final"):  # see explore
        options.pop(name, None)
    if (sigma := options.pop("action_noise", None)) is not None:
        size = env.action_space.shape
        noise = NormalActionNoise(np.zeros(size), np.full(size, sigma))
        options["action_noise"] = VectorizedActionNoise(noise, env.num_envs)
    return ALGORITHMS[algorithm].cls(
        "MlpPolicy",
        env,
        learning_rate=schedule,
        gamma=hyper.training.gamma,
        policy_kwargs=network,
        seed=seed,
        device="cpu",
        tensorboard_log=None if log_folder is None else str(log_folder),
        **options,
    )


def explore(model: BaseAlgorithm, options: Any, used: float) -> None:
    """Set how wide PPO explores when the share `used` of the budget is used up.

    With wide noise the rate-limited rudder always moves at full speed, so that a mean action which
    chatters costs nothing more; the narrow noise of the end shows its price. Others: no change.
    """
    if hasattr(options, "log_std_final"):
        log_std = options.log_std_init + (options.log_std_final - options.log_std_init) * used
        model.policy.log_std.requires_grad_(False).fill_(log_std)


def export(
    model: BaseAlgorithm, algorithm: str, activation: str, card: Mapping[str, Any]
) -> SB3Policy:
    """The mean action of a model and the present state of its normaliser, as a controller."""
    layers = ALGORITHMS[algorithm].layers(model.policy)
    linear = [layer for layer in layers if isinstance(layer, torch.nn.Linear)]
    actor = Actor(
        tuple(_double(layer.weight) for layer in linear),
        tuple(_double(layer.bias) for layer in linear),
        activation,
        ALGORITHMS[algorithm].output,
    )
    env = model.get_vec_normalize_env()
    rms = env.obs_rms
    normaliser = Normaliser(rms.mean.copy(), np.sqrt(rms.var + env.epsilon), env.clip_obs)
    return SB3Policy(actor, normaliser, card)


def _double(parameter: torch.Tensor) -> np.ndarray:
    return parameter.detach().numpy().astype(np.float64)


def save_checkpoint(model: BaseAlgorithm, folder: Path, counters: Mapping[str, Any]) -> None:
    """Write weights, optimiser, normaliser, counters and, if there is one, the replay buffer.

    Parameters
    ----------
    model : BaseAlgorithm
    folder : path
    counters : mapping
        Plain values that `load_checkpoint` gives back.
    """
    env = model.get_vec_normalize_env()
    statistics = {
        name: {"mean": rms.mean.tolist(), "var": rms.var.tolist(), "count": float(rms.count)}
        for name, rms in (("obs_rms", env.obs_rms), ("ret_rms", env.ret_rms))
    }
    state = {**counters, **statistics, "samples": model.num_timesteps}
    _, tensors = model._get_torch_save_params()
    with atomic_path(folder / "model.zip") as temporary:
        save_to_zip_file(
            temporary,
            params=model.get_parameters(),
            pytorch_variables={name: getattr(model, name) for name in tensors},
        )
        with zipfile.ZipFile(temporary, "a") as archive:
            archive.writestr(_STATE, json.dumps(state))
    if getattr(model, "replay_buffer", None) is not None:
        with atomic_path(folder / _REPLAY) as temporary:
            model.save_replay_buffer(temporary)


def load_checkpoint(model: BaseAlgorithm, folder: Path) -> dict[str, Any]:
    """Put a model where `save_checkpoint` left it; return the counters.

    The environments are not part of it: they begin new episodes.
    """
    file = folder / "model.zip"
    try:
        _, parameters, tensors = load_from_zip_file(file, load_data=False, device="cpu")
        with zipfile.ZipFile(file) as archive:
            state = json.loads(archive.read(_STATE))
        model.set_parameters(parameters, exact_match=True, device="cpu")
    except (OSError, ValueError, KeyError, RuntimeError, zipfile.BadZipFile) as error:
        raise ConfigError(f"{file}: not a checkpoint of this run, or damaged: {error}") from error
    for name, value in (tensors or {}).items():
        if value is not None:
            getattr(model, name).data = value.data
    env = model.get_vec_normalize_env()
    for name in ("obs_rms", "ret_rms"):
        rms, saved = getattr(env, name), state[name]
        rms.mean, rms.var = np.array(saved["mean"]), np.array(saved["var"])
        rms.count = saved["count"]
    model.num_timesteps = state["samples"]
    if getattr(model, "replay_buffer", None) is not None and (folder / _REPLAY).is_file():
        model.load_replay_buffer(folder / _REPLAY)
    return state
