"""Networks in torch that ships ask for: actors that obey the mirror, critics that see more.

An observation is the features of the helm, then what only the critic sees (privileged columns, if
any): every actor takes the first columns alone. A symmetric one gives the mirrored decision in the
mirrored situation exactly, ``(f(x) + d f(s x)) / 2`` with the signs s of features and d of
decisions; the same in NumPy: ``ship_gym_agents.policies.networks``.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

import torch
from sb3_contrib.common.recurrent.policies import RecurrentActorCriticPolicy
from sb3_contrib.tqc.policies import Actor as TQCActor
from sb3_contrib.tqc.policies import TQCPolicy
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.torch_layers import (
    BaseFeaturesExtractor,
    FlattenExtractor,
    create_mlp,
)
from stable_baselines3.sac.policies import LOG_STD_MAX, LOG_STD_MIN, SACPolicy
from stable_baselines3.sac.policies import Actor as SACActor
from stable_baselines3.td3.policies import Actor as TD3Actor
from stable_baselines3.td3.policies import TD3Policy
from torch import nn

from ship_gym_agents.policies.networks import Mirror

_SMALL = 0.01  # of the first weights of the last layer: decisions begin near none


class FirstColumns(BaseFeaturesExtractor):
    """The first columns of an observation: what an actor may see."""

    def __init__(self, observation_space: Any, columns: int):
        super().__init__(observation_space, features_dim=columns)
        self.columns = columns

    def forward(self, observations: torch.Tensor) -> torch.Tensor:
        """Shape (count, columns)."""
        return observations[:, : self.columns]


class MirrorSigns(nn.Module):
    """Makes a function of features odd or even, decision by decision; without signs, nothing."""

    def __init__(self, mirror: Mirror | None):
        super().__init__()
        self.on = mirror is not None
        if mirror is not None:  # not part of the state: they belong to the form
            for name in ("features", "decisions"):
                signs = torch.as_tensor(getattr(mirror, name), dtype=torch.float32)
                self.register_buffer(name, signs, persistent=False)

    def both(self, features: torch.Tensor) -> torch.Tensor:
        """The features and, below them, the mirrored ones."""
        return torch.cat((features, features * self.features)) if self.on else features

    def mean(self, found: torch.Tensor) -> torch.Tensor:
        """Decisions of what was found for `both`."""
        if not self.on:
            return found
        seen, mirrored = found.chunk(2)
        return 0.5 * (seen + mirrored * self.decisions)

    def even(self, found: torch.Tensor) -> torch.Tensor:
        """Mean of both sides, for what has no side, such as a standard deviation."""
        if not self.on:
            return found
        seen, mirrored = found.chunk(2)
        return 0.5 * (seen + mirrored)


class ActorAndCritic(nn.Module):
    """Mean decision of the actor and last hidden values of the critic, for `ShipPolicy`.

    Takes the place of stable-baselines3's ``MlpExtractor``.
    """

    def __init__(
        self,
        width: int,
        n_features: int,
        n_decisions: int,
        net_arch: dict[str, list[int]],
        activation: type[nn.Module],
        mirror: Mirror | None,
    ):
        super().__init__()
        self.n_features = n_features
        actor = create_mlp(n_features, n_decisions, net_arch["pi"], activation)
        critic = create_mlp(width, -1, net_arch["vf"], activation)
        self.policy_net, self.value_net = nn.Sequential(*actor), nn.Sequential(*critic)
        self.signs = MirrorSigns(mirror)
        self.latent_dim_pi = n_decisions
        self.latent_dim_vf = net_arch["vf"][-1] if net_arch["vf"] else width

    def forward(self, observations: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Both, for observations of shape (count, width)."""
        return self.forward_actor(observations), self.forward_critic(observations)

    def forward_actor(self, observations: torch.Tensor) -> torch.Tensor:
        """Mean decisions, shape (count, n_decisions)."""
        features = observations[:, : self.n_features]
        return self.signs.mean(self.policy_net(self.signs.both(features)))

    def forward_critic(self, observations: torch.Tensor) -> torch.Tensor:
        """Last hidden values of the critic."""
        return self.value_net(observations)


class ShipPolicy(ActorCriticPolicy):
    """Actor and critic of PPO.

    Parameters
    ----------
    *args, **kwargs
        Of stable-baselines3's policy.
    n_features : int
        First columns of the observation, those of the actor.
    mirror : Mirror, optional
        Makes the actor symmetric.
    """

    def __init__(self, *args: Any, n_features: int, mirror: Mirror | None = None, **kwargs: Any):
        self.n_features, self.mirror = n_features, mirror
        super().__init__(*args, **kwargs)

    def _build_mlp_extractor(self) -> None:
        self.mlp_extractor = ActorAndCritic(
            self.features_dim,
            self.n_features,
            self.action_space.shape[0],
            self.net_arch,
            self.activation_fn,
            self.mirror,
        )

    def _build(self, lr_schedule: Any) -> None:
        """The extractor gives the mean itself, so nothing is left for the layer after it."""
        super()._build(lr_schedule)
        self.action_net = nn.Identity()
        self.init_weights(self.mlp_extractor.policy_net[-1], gain=_SMALL)
        self.optimizer = self.optimizer_class(
            self.parameters(), lr=lr_schedule(1), **self.optimizer_kwargs
        )


class ShipRecurrentPolicy(RecurrentActorCriticPolicy):
    """Actor and critic of RecurrentPPO, each with an LSTM. Parameters: see `ShipPolicy`."""

    optimizer: Any

    def __init__(self, *args: Any, n_features: int, **kwargs: Any):
        super().__init__(
            *args,
            features_extractor_class=FirstColumns,
            features_extractor_kwargs={"columns": n_features},
            share_features_extractor=False,
            **kwargs,
        )
        self.vf_features_extractor = FlattenExtractor(self.observation_space)
        width = self.vf_features_extractor.features_dim
        self.lstm_critic = nn.LSTM(width, self.lstm_output_dim)
        learning_rate = self.optimizer.param_groups[0]["lr"]
        self.optimizer = self.optimizer_class(
            self.parameters(), lr=learning_rate, **self.optimizer_kwargs
        )


class _GaussianMirror:
    """What SAC's and TQC's actors of ours add to theirs."""

    # of theirs
    mu: Any
    latent_pi: Any
    log_std: Any
    features_extractor: Any
    extract_features: Callable[..., Any]

    def __init__(self, *args: Any, mirror: Mirror | None = None, **kwargs: Any):
        super().__init__(*args, **kwargs)
        self.signs = MirrorSigns(mirror)
        _make_small(self.mu)

    def get_action_dist_params(self, obs):
        """Mean and logarithm of the standard deviation before the hyperbolic tangent."""
        features = self.extract_features(obs, self.features_extractor)
        latent = self.latent_pi(self.signs.both(features))
        log_std = torch.clamp(self.log_std(latent), LOG_STD_MIN, LOG_STD_MAX)
        return self.signs.mean(self.mu(latent)), self.signs.even(log_std), {}


class ShipSACActor(_GaussianMirror, SACActor):
    """SAC's actor, symmetric with a mirror."""


class ShipTQCActor(_GaussianMirror, TQCActor):
    """TQC's actor, symmetric with a mirror."""


class ShipTD3Actor(TD3Actor):
    """TD3's actor, symmetric with a mirror."""

    def __init__(self, *args: Any, mirror: Mirror | None = None, **kwargs: Any):
        super().__init__(*args, **kwargs)
        self.signs = MirrorSigns(mirror)
        _make_small(self.mu[-2])

    def forward(self, obs: torch.Tensor) -> torch.Tensor:
        """Decisions in [-1, 1]."""
        features = self.extract_features(obs, self.features_extractor)
        return torch.tanh(self.signs.mean(self.mu[:-1](self.signs.both(features))))


class _ActorOfFeatures:
    """What policies with a replay buffer have in common: the actor takes the first columns."""

    ACTOR: ClassVar[type]
    observation_space: Any  # this and the next are of the policy beside it
    device: Any
    actor_kwargs: dict[str, Any]
    _update_features_extractor: Callable[..., Any]

    def __init__(self, *args: Any, n_features: int, mirror: Mirror | None = None, **kwargs: Any):
        self.n_features, self.mirror = n_features, mirror
        super().__init__(*args, **kwargs)

    def make_actor(self, features_extractor: BaseFeaturesExtractor | None = None):
        """A new actor."""
        columns = features_extractor or FirstColumns(self.observation_space, self.n_features)
        arguments = self._update_features_extractor(self.actor_kwargs, columns)
        return self.ACTOR(mirror=self.mirror, **arguments).to(self.device)


class ShipSACPolicy(_ActorOfFeatures, SACPolicy):
    """Actor and critics of SAC."""

    ACTOR = ShipSACActor


class ShipTQCPolicy(_ActorOfFeatures, TQCPolicy):
    """Actor and critics of TQC."""

    ACTOR = ShipTQCActor


class ShipTD3Policy(_ActorOfFeatures, TD3Policy):
    """Actor and critics of TD3."""

    ACTOR = ShipTD3Actor


def _make_small(layer: nn.Linear) -> None:
    """Decisions begin near none: those of a base alone, or a rudder amidships."""
    with torch.no_grad():
        layer.weight.mul_(_SMALL)
        layer.bias.zero_()
