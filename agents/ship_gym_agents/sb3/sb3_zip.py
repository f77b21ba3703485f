"""Models that stable-baselines3 itself saved, as policies; reading one can run code of its author.

Such a zip archive holds pickled objects, and so does the ``vecnormalize.pkl`` beside it: whoever
made the file decides what runs when it is read. Nothing of this package reads one unasked.
"""

from __future__ import annotations

import json
import pickle
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO, SAC, TD3
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.torch_layers import FlattenExtractor
from stable_baselines3.common.vec_env import VecNormalize
from stable_baselines3.sac.policies import SACPolicy
from stable_baselines3.td3.policies import TD3Policy

from ship_gym.config import ConfigError
from ship_gym.envs.env import resolved_scenario
from ship_gym.provenance import provenance, sha256
from ship_gym.tasks.columns import action_columns, observation_columns
from ship_gym_agents.forms.form import Form
from ship_gym_agents.policies.networks import Mlp
from ship_gym_agents.policies.normaliser import Normaliser, no_scaling
from ship_gym_agents.policies.policy import Policy

NORMALISER = "vecnormalize.pkl"  # beside the zip, as VecNormalize.save writes it
# Algorithm, and the key of its saved settings by which it is known.
_KNOWN = {"n_epochs": PPO, "target_entropy": SAC, "policy_delay": TD3}
_ACTIVATIONS = {torch.nn.Tanh: "tanh", torch.nn.ReLU: "relu"}
_POLICIES = (ActorCriticPolicy, SACPolicy, TD3Policy)  # what MlpPolicy means in each
_ENDLESS = 1e30  # a normaliser's limit where there is none


def load_sb3_zip(
    path: str | Path,
    *,
    trust: bool = False,
    scenario: str | Mapping[str, Any] = "heading_keeping",
    ship: str | None = None,
    control: str | None = None,
    overrides: Mapping[str, Any] | None = None,
) -> Policy:
    """A model that stable-baselines3 saved, PPO, SAC or TD3 with an ``MlpPolicy``, as a policy.

    Parameters
    ----------
    path : str or path
        The zip archive; a ``vecnormalize.pkl`` beside it is read too.
    trust : bool
        Whether to read it although that **runs code which the file may hold**.
    scenario, ship, control, overrides
        What it was trained for, as in ``ShipEnv``: the file does not say.

    Raises
    ------
    ConfigError
        Not trusted, not such a model, one with another network, or of another shape than the
        scenario's observations and actions.
    """
    path = Path(path)
    if trust is not True:
        raise ConfigError(
            f"{path}: a model of stable-baselines3; reading it runs code which the file may hold, "
            "so say that you trust it: --trust-sb3-zip"
        )
    algorithm = _algorithm(path)
    try:
        model = algorithm.load(path, device="cpu")
    except Exception as error:  # whatever the code in the file raises
        raise ConfigError(f"{path}: stable-baselines3 cannot read it: {error}") from error
    resolved, _ = resolved_scenario(scenario, ship, control, None, None, overrides)
    features = [f"observation.{name}" for name in observation_columns(resolved)]
    decisions = list(action_columns(resolved))
    _check_spaces(path, model, len(features), len(decisions))
    card = {
        "name": path.stem,
        "config": {"algorithm": algorithm.__name__.lower(), "scenario": resolved.to_dict()},
        "source": {"file": path.name, "sha256": sha256(path), "kind": "stable-baselines3 zip"},
        "samples": int(model.num_timesteps),
        "features": features,
        "decisions": decisions,
        **provenance(),
    }
    return Policy(Form(), _normaliser(path, len(features)), _network(path, model), card)


def _algorithm(path: Path) -> Any:
    """Which algorithm a zip is of, from the names of its settings alone."""
    try:
        with zipfile.ZipFile(path) as archive:
            settings = json.loads(archive.read("data"))
    except (zipfile.BadZipFile, KeyError, ValueError, OSError) as error:
        raise ConfigError(f"{path}: not a model of stable-baselines3: {error}") from error
    found = [cls for key, cls in _KNOWN.items() if key in settings]
    if len(found) != 1:
        raise ConfigError(f"{path}: allowed are models of PPO, SAC and TD3")
    return found[0]


def _check_spaces(path: Path, model: Any, n_features: int, n_decisions: int) -> None:
    shapes = model.observation_space.shape, model.action_space.shape
    if shapes != ((n_features,), (n_decisions,)):
        raise ConfigError(
            f"{path}: made for observations {shapes[0]} and actions {shapes[1]}; the scenario has "
            f"{(n_features,)} and {(n_decisions,)}; name its own: --scenario, --control"
        )
    low, high = model.action_space.low, model.action_space.high
    if not (np.all(low == -1.0) and np.all(high == 1.0)):
        raise ConfigError(f"{path}: its actions are not within [-1, 1]")


def _network(path: Path, model: Any) -> Mlp:
    """The layers of the mean action."""
    policy = model.policy
    if type(policy) not in _POLICIES:
        raise ConfigError(f"{path}: its policy is a {type(policy).__name__}; allowed is MlpPolicy")
    if isinstance(model, PPO):
        layers, output = [*policy.mlp_extractor.policy_net, policy.action_net], "clip"
    elif isinstance(model, SAC):
        layers, output = [*policy.actor.latent_pi, policy.actor.mu], "tanh"
    else:
        layers, output = [*policy.actor.mu], "tanh"
    linear = [layer for layer in layers if isinstance(layer, torch.nn.Linear)]
    others = {type(layer) for layer in layers if not isinstance(layer, torch.nn.Linear)}
    others -= {torch.nn.Tanh} if isinstance(model, TD3) and len(others) > 1 else set()
    extractor = getattr(policy, "pi_features_extractor", None) or policy.actor.features_extractor
    plain = isinstance(extractor, FlattenExtractor) and len(others) <= 1
    if not plain or not others <= _ACTIVATIONS.keys() or getattr(model, "use_sde", False):
        raise ConfigError(f"{path}: allowed are perceptrons with tanh or relu, without gSDE")
    activation = _ACTIVATIONS[others.pop()] if others else "tanh"
    weights = (layer.weight.detach().numpy() for layer in linear)
    biases = (layer.bias.detach().numpy() for layer in linear)
    return Mlp(tuple(weights), tuple(biases), activation, output)


def _normaliser(path: Path, n_features: int) -> Normaliser:
    """The normaliser of ``vecnormalize.pkl`` beside the model; none scales nothing."""
    file = path.parent / NORMALISER
    if not file.is_file():
        return no_scaling(n_features, _ENDLESS)
    try:
        with file.open("rb") as opened:
            saved = pickle.load(opened)  # as VecNormalize.load does, which also wants environments
    except Exception as error:  # whatever the code in the file raises
        raise ConfigError(f"{file}: cannot be read: {error}") from error
    if not isinstance(saved, VecNormalize):
        raise ConfigError(f"{file}: not a VecNormalize")
    if not saved.norm_obs:
        return no_scaling(n_features, _ENDLESS)
    rms = saved.obs_rms
    return Normaliser(rms.mean, np.sqrt(rms.var + saved.epsilon), saved.clip_obs)
