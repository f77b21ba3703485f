"""Learner: what PPO learns from one rollout, apart from the environments that it came from."""

from __future__ import annotations

import contextlib
import dataclasses
import math
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import torch
from stable_baselines3.common.buffers import RolloutBuffer
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.utils import explained_variance

# Largest weight of a sample that other weights sailed: one alone shall not decide a step.
_HEAVIEST = 2.0
_HALF_LOG_2_PI = 0.5 * math.log(2.0 * math.pi)
_COLUMNS = ("observations", "actions", "log_probs", "advantages", "returns")


@dataclasses.dataclass
class Rollout:
    """What was recorded in one rollout.

    Attributes
    ----------
    buffer : RolloutBuffer
        Without values and advantages yet: the critic gives them when learning begins.
    log_std : Tensor
        Logarithm of the standard deviation of the actions, shape (n_actions,).
    last_observations : array
        (n, n_observations), after the last step.
    last_dones : array
        (n,) bool, of the last step.
    cut_off : list of (int, int, array)
        Step, environment and last observation of the episodes that ended by time alone.
    """

    buffer: RolloutBuffer
    log_std: torch.Tensor
    last_observations: np.ndarray
    last_dones: np.ndarray
    cut_off: list[tuple[int, int, np.ndarray]] = dataclasses.field(default_factory=list)


@dataclasses.dataclass
class Learner:
    """The loss of stable-baselines3's PPO, and the steps on it.

    Values are computed once for a whole rollout and a rollout is shuffled once per epoch.

    Attributes
    ----------
    policy : ActorCriticPolicy
        Changed in place, with its optimizer.
    n_epochs, batch_size, ent_coef, vf_coef, max_grad_norm, normalize_advantage
        As in ``stable_baselines3.PPO``.
    clip : float
        Clipping of the ratio.
    seed : int
        Of the order of the samples.
    lagging : bool
        Whether earlier weights than those of `policy` sailed. The loss then has two old policies,
        as Hilton, Cobbe and Schulman, Batch size-invariance for policy optimization (NeurIPS 2022),
        decouple them: the ratio that is clipped compares with the policy as learning begins, and a
        weight, constant during learning, takes the samples from the policy that sailed to that one.
        With one ratio to the policy that sailed, clipping would let almost nothing be learned.
    """

    policy: ActorCriticPolicy
    n_epochs: int
    batch_size: int
    ent_coef: float
    vf_coef: float
    max_grad_norm: float
    normalize_advantage: bool
    clip: float
    seed: int
    lagging: bool

    def learn(self, rollout: Rollout) -> dict[str, float]:
        """Learn from a rollout.

        Returns
        -------
        dict
            Parts of the loss, means over the last epoch; ``explained_variance`` of the returns;
            ``seconds`` that it took.
        """
        began, buffer = time.perf_counter(), rollout.buffer
        self._judge(rollout)
        self.policy.set_training_mode(True)
        self._parameters = list(self.policy.parameters())
        shuffling = torch.Generator().manual_seed(self.seed)
        found: list[dict[str, float]] = []
        with self._explored(rollout.log_std):
            weights = self._weigh(buffer) if self.lagging else torch.ones(buffer.rewards.size)
            data = {name: _flat(getattr(buffer, name)) for name in _COLUMNS} | {"weights": weights}
            count = len(weights)
            for epoch in range(self.n_epochs):
                order = torch.randperm(count, generator=shuffling)
                mixed = {name: values[order] for name, values in data.items()}
                for start in range(0, count, self.batch_size):
                    rows = slice(start, start + self.batch_size)
                    parts = self._step({name: values[rows] for name, values in mixed.items()})
                    if epoch == self.n_epochs - 1:
                        found.append(parts())
        means = {name: float(np.mean([one[name] for one in found])) for name in found[0]}
        explained = explained_variance(buffer.values.flatten(), buffer.returns.flatten())
        spent = time.perf_counter() - began
        return {**means, "explained_variance": float(explained), "seconds": spent}

    def _judge(self, rollout: Rollout) -> None:
        """Set values and advantages, by the critic as it is now."""
        buffer = rollout.buffer
        self.policy.set_training_mode(False)
        values = self._values(buffer.observations.reshape(-1, *buffer.obs_shape))
        buffer.values[:] = values.reshape(buffer.values.shape)
        if rollout.cut_off:
            steps, envs, last = zip(*rollout.cut_off, strict=True)
            buffer.rewards[list(steps), list(envs)] += buffer.gamma * self._values(np.stack(last))
        after = torch.from_numpy(self._values(rollout.last_observations))
        buffer.compute_returns_and_advantage(after, rollout.last_dones)

    def _weigh(self, buffer: RolloutBuffer) -> torch.Tensor:
        """Put the log-probabilities of now in place of those of sailing; the ratio of both."""
        policy = self.policy
        with torch.no_grad():
            means, _ = outputs(policy, _flat(buffer.observations))
            away = (_flat(buffer.actions) - means) * (-policy.log_std).exp()
            now = log_density(away, policy.log_std)
        ratio = (now - _flat(buffer.log_probs)).exp()
        buffer.log_probs[:] = now.numpy().reshape(buffer.log_probs.shape)
        return ratio.clamp(max=_HEAVIEST)

    def _values(self, observations: np.ndarray) -> np.ndarray:
        with torch.no_grad():
            return self.policy.predict_values(torch.from_numpy(observations))[:, 0].numpy()

    @contextlib.contextmanager
    def _explored(self, log_std: torch.Tensor) -> Iterator[None]:
        """A width of exploration that is set, not learned, is that of the rollout."""
        own = self.policy.log_std
        if own.requires_grad:
            yield
            return
        now = own.clone()
        own.copy_(log_std)
        yield
        own.copy_(now)

    def _step(self, batch: dict[str, torch.Tensor]) -> Callable[[], dict[str, float]]:
        """One step of the optimizer on the loss of a minibatch; what gives its parts."""
        policy, low, high = self.policy, 1.0 - self.clip, 1.0 + self.clip
        means, values = outputs(policy, batch["observations"])
        away = (batch["actions"] - means) * (-policy.log_std).exp()
        advantages = batch["advantages"]
        if self.normalize_advantage and len(advantages) > 1:
            advantages = (advantages - advantages.mean()) / (advantages.std() + 1e-8)
        log_ratio = log_density(away, policy.log_std) - batch["log_probs"]
        ratio = log_ratio.exp()
        gain = torch.min(advantages * ratio, advantages * ratio.clamp(low, high))
        policy_loss = -(batch["weights"] * gain).mean()
        value_loss = torch.nn.functional.mse_loss(values, batch["returns"])
        entropy_loss = -(policy.log_std + 0.5 + _HALF_LOG_2_PI).sum()
        loss = policy_loss + self.ent_coef * entropy_loss + self.vf_coef * value_loss
        policy.optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self._parameters, self.max_grad_norm)
        policy.optimizer.step()
        return lambda: {
            "loss": loss.item(),
            "policy_gradient_loss": policy_loss.item(),
            "value_loss": value_loss.item(),
            "entropy_loss": entropy_loss.item(),
            "approx_kl": (ratio - 1.0 - log_ratio).mean().item(),
            "clip_fraction": ((ratio - 1.0).abs() > self.clip).float().mean().item(),
        }


def outputs(policy: Any, observations: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
    """Mean actions (count, n_actions) and values (count,) of a policy.

    As its ``evaluate_actions`` has them, without the objects of a distribution, which cost much
    of the time of a minibatch.
    """
    features = policy.extract_features(observations)
    if policy.share_features_extractor:
        actor, critic = policy.mlp_extractor(features)
    else:
        actor = policy.mlp_extractor.forward_actor(features[0])
        critic = policy.mlp_extractor.forward_critic(features[1])
    return policy.action_net(actor), policy.value_net(critic)[:, 0]


def log_density(away: torch.Tensor, log_std: torch.Tensor) -> torch.Tensor:
    """Logarithm of the Gaussian density of actions, the last axis summed.

    Parameters
    ----------
    away : Tensor
        From the mean, in standard deviations, shape (..., n_actions).
    log_std : Tensor
        Shape (n_actions,).
    """
    return -0.5 * away.square().sum(-1) - (log_std + _HALF_LOG_2_PI).sum()


def take_over(policy: Any, learned: Any) -> None:
    """Give a policy the weights and the optimizer's state of another one."""
    policy.load_state_dict(learned.state_dict())
    policy.optimizer.load_state_dict(learned.optimizer.state_dict())


def _flat(array: np.ndarray) -> torch.Tensor:
    """All steps and environments of a rollout in one row."""
    return torch.from_numpy(array.reshape(-1, *array.shape[2:]))
