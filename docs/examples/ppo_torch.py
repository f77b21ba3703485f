"""PPO in one file of plain torch, on the native vector environment of ``gym.make_vec``.

In the manner of CleanRL: everything that matters stands here, to be read and changed. Proximal
policy optimisation (Schulman et al. 2017) with a Gaussian policy whose standard deviation falls
over the budget. With ``--device cuda`` the ships sail on the card too (``ShipTorchEnv``), and
nothing leaves it but what is printed. What was learned sails beside the PID at the end.
"""

from __future__ import annotations

import argparse
import dataclasses
import time
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import torch
from judging import options, tell
from ship_gym_agents.cli.output import progress, run
from torch import nn

from ship_gym import ShipTorchEnv
from ship_gym.config import check_known
from ship_gym.envs.registration import ENVIRONMENTS
from ship_gym.writing import atomic_path

EXAMPLES = """examples:
  python docs/examples/ppo_torch.py --envs 128 --minibatch 4096 --iterations 300
  python docs/examples/ppo_torch.py --device cuda --envs 16384 --minibatch 16384 --json"""
ENV_ID = "ShipGym/HeadingKeeping-v0"


@dataclasses.dataclass(frozen=True)
class Settings:
    """Hyperparameters, those of ``ship-gym train`` for PPO."""

    horizon: int = 64  # intervals of a rollout
    minibatch: int = 1024  # fewer updates, so a larger one, where a card sails thousands
    epochs: int = 8
    learning_rate: float = 5e-4
    gamma: float = 0.99  # per control interval
    gae_lambda: float = 0.98
    clip: float = 0.2
    value_weight: float = 0.5
    max_grad_norm: float = 0.5
    log_std: tuple[float, float] = (
        -1.0,
        -2.5,
    )  # at the start and at the end, of actions in [-1, 1]


class Agent(nn.Module):
    """Mean action and value of observations (n, n_observations)."""

    def __init__(self, n_observations: int, n_actions: int, hidden: int = 64):
        super().__init__()
        self.actor = _network(n_observations, hidden, n_actions, 0.01)
        self.critic = _network(n_observations, hidden, 1, 1.0)
        self.log_std = 0.0

    def policy(self, observations: torch.Tensor) -> torch.distributions.Normal:
        """Distribution of the actions."""
        mean = self.actor(observations)
        std = torch.full_like(mean, self.log_std).exp()
        return torch.distributions.Normal(mean, std, validate_args=False)

    def value(self, observations: torch.Tensor) -> torch.Tensor:
        """Expected discounted return, shape (n,)."""
        return self.critic(observations).squeeze(-1)


def _network(n_in: int, hidden: int, n_out: int, gain: float) -> nn.Sequential:
    layers = [nn.Linear(n_in, hidden), nn.Linear(hidden, hidden), nn.Linear(hidden, n_out)]
    for layer, size in zip(layers, (2.0**0.5, 2.0**0.5, gain), strict=True):
        nn.init.orthogonal_(layer.weight, size)
        nn.init.zeros_(layer.bias)
    return nn.Sequential(layers[0], nn.Tanh(), layers[1], nn.Tanh(), layers[2])


class VectorEnv:
    """``gym.make_vec`` with tensors in the place of arrays, as `ShipTorchEnv` has them."""

    def __init__(self, env_id: str, num_envs: int, **options: Any):
        self.env = gym.make_vec(env_id, num_envs, autoreset_mode="SameStep", **options)
        self.num_envs, self.device = num_envs, torch.device("cpu")
        self.single_observation_space = self.env.single_observation_space
        self.single_action_space = self.env.single_action_space

    def reset(self, *, seed: int) -> tuple[torch.Tensor, dict]:
        """Begin all episodes; environment i uses the stream seed + i."""
        seen, _ = self.env.reset(seed=seed)
        return torch.from_numpy(seen), {}

    def step(self, actions: torch.Tensor):
        """Sail one interval; ``final_obs`` counts where an episode has ended."""
        seen, rewards, terminated, truncated, more = self.env.step(actions.numpy())
        info = {}
        if "final_obs" in more:
            final = seen.copy()
            for i in np.flatnonzero(more["_final_obs"]):
                final[i] = more["final_obs"][i]
            info["final_obs"] = torch.from_numpy(final)
        return *map(torch.from_numpy, (seen, rewards, terminated, truncated)), info


def make_env(device: str, env_id: str, envs: int, ship: str, episode: float):
    """Ships in episodes of `episode` full-scale seconds, on a device."""
    options = {"ship": ship, "overrides": {"duration": episode}}
    if device == "cpu":
        return VectorEnv(env_id, envs, **options)
    return ShipTorchEnv(envs, device, scenario=ENVIRONMENTS[env_id], **options)


@dataclasses.dataclass
class Rollout:
    """What was sailed, tensors (horizon, envs, ...)."""

    observations: torch.Tensor
    actions: torch.Tensor
    log_probs: torch.Tensor
    values: torch.Tensor
    rewards: torch.Tensor
    ended: torch.Tensor

    @classmethod
    def empty(cls, env: VectorEnv | ShipTorchEnv, horizon: int) -> Rollout:
        """Room for a rollout, on the device of the environments."""

        def room(*inner: int) -> torch.Tensor:
            return torch.zeros(horizon, env.num_envs, *inner, device=env.device)

        n_seen, n_acts = env.single_observation_space.shape[0], env.single_action_space.shape[0]
        return cls(room(n_seen), room(n_acts), room(), room(), room(), room())


class Returns:
    """Returns of the episodes that have ended, summed on the device."""

    def __init__(self, env: VectorEnv | ShipTorchEnv):
        self._running = torch.zeros(env.num_envs, device=env.device, dtype=torch.float64)
        self._sums: list[torch.Tensor] = []  # of each rollout: sum of the returns, and how many
        self.begin()

    def begin(self) -> None:
        """Begin the sums of a rollout."""
        self._sums.append(self._running.new_zeros(2))

    def add(self, rewards: torch.Tensor, ended: torch.Tensor) -> None:
        """Add the rewards of an interval, shape (n,)."""
        self._running += rewards
        self._sums[-1] += torch.stack([(self._running * ended).sum(), ended.sum()])
        self._running *= ~ended

    def mean(self, part: slice) -> float | None:
        """Mean over some rollouts; None if no episode ended in them."""
        total, count = torch.stack(self._sums[part]).sum(0).tolist()
        return total / count if count else None


@torch.no_grad()
def sail(
    env: VectorEnv | ShipTorchEnv,
    agent: Agent,
    seen: torch.Tensor,
    kept: Rollout,
    returns: Returns,
    gamma: float,
) -> torch.Tensor:
    """Fill a rollout; the result is what is seen then.

    An episode that was cut off goes on in thought: its last reward holds the value of where it
    ended. The tensors of the environment change in place, so what is kept is copied.
    """
    for k in range(len(kept.rewards)):
        policy = agent.policy(seen)
        actions = policy.sample()
        kept.observations[k], kept.actions[k] = seen, actions
        kept.log_probs[k] = policy.log_prob(actions).sum(-1)
        kept.values[k] = agent.value(seen)
        seen, rewards, terminated, truncated, info = env.step(actions.clamp(-1.0, 1.0))
        ended = terminated | truncated
        kept.rewards[k], kept.ended[k] = rewards, ended
        returns.add(rewards, ended)
        if "final_obs" in info:
            beyond = agent.value(info["final_obs"])
            kept.rewards[k] += gamma * torch.where(truncated & ~terminated, beyond, 0.0)
    return seen


@torch.no_grad()
def advantages(kept: Rollout, last_value: torch.Tensor, s: Settings) -> torch.Tensor:
    """Generalised advantage estimation, shape (horizon, envs)."""
    found = torch.zeros_like(kept.rewards)
    running, value = torch.zeros_like(last_value), last_value
    for k in reversed(range(len(found))):
        goes_on = 1.0 - kept.ended[k]
        error = kept.rewards[k] + s.gamma * value * goes_on - kept.values[k]
        running = error + s.gamma * s.gae_lambda * goes_on * running
        found[k], value = running, kept.values[k]
    return found


def learn(agent: Agent, optimiser, kept: Rollout, last_value: torch.Tensor, s: Settings) -> None:
    """Some epochs of minibatches over one rollout."""
    gain = advantages(kept, last_value, s)
    target = (gain + kept.values).flatten()
    gain = gain.flatten()
    observations, actions = kept.observations.flatten(0, 1), kept.actions.flatten(0, 1)
    before = kept.log_probs.flatten()
    for _ in range(s.epochs):
        for rows in torch.randperm(len(gain), device=gain.device).split(s.minibatch):
            ratio = agent.policy(observations[rows]).log_prob(actions[rows]).sum(-1)
            ratio = (ratio - before[rows]).exp()
            a = (gain[rows] - gain[rows].mean()) / (gain[rows].std() + 1e-8)
            clipped = ratio.clamp(1.0 - s.clip, 1.0 + s.clip)
            value_error = agent.value(observations[rows]) - target[rows]
            loss = -torch.min(ratio * a, clipped * a).mean()
            loss = loss + s.value_weight * value_error.square().mean()
            optimiser.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(agent.parameters(), s.max_grad_norm)
            optimiser.step()


def train(
    env: VectorEnv | ShipTorchEnv, iterations: int, seed: int, s: Settings
) -> tuple[Agent, Returns]:
    """Train an agent; with it the returns of its episodes."""
    torch.manual_seed(seed)
    kept = Rollout.empty(env, s.horizon)
    agent = Agent(kept.observations.shape[-1], kept.actions.shape[-1]).to(env.device)
    optimiser = torch.optim.Adam(agent.parameters(), lr=s.learning_rate, eps=1e-5)
    seen, _ = env.reset(seed=seed)
    returns = Returns(env)
    for k in progress(range(iterations), "training"):
        done = k / iterations
        optimiser.param_groups[0]["lr"] = s.learning_rate * (1.0 - done)
        agent.log_std = s.log_std[0] + done * (s.log_std[1] - s.log_std[0])
        returns.begin()
        seen = sail(env, agent, seen, kept, returns, s.gamma)
        with torch.no_grad():
            last_value = agent.value(seen)
        learn(agent, optimiser, kept, last_value, s)
    return agent, returns


def arguments() -> argparse.Namespace:
    """Options of the command line."""
    return options(
        __doc__,
        EXAMPLES,
        iterations=40,
        device=("cpu", "cpu, cuda or cuda:1"),
        env=(ENV_ID, "its id for gym.make_vec"),
        minibatch=(Settings.minibatch, "samples"),
        out=(Path("runs/ppo_torch.pt"), "weights"),
    )


def main() -> None:
    """Train, save the weights, say how it went beside a classical autopilot."""
    a = arguments()
    check_known("env", a.env, ENVIRONMENTS)
    env = make_env(a.device, a.env, a.envs, a.ship, a.episode)
    settings, started = Settings(minibatch=a.minibatch), time.perf_counter()
    agent, returns = train(env, a.iterations, a.seed, settings)
    seconds = time.perf_counter() - started
    with atomic_path(a.out) as path:
        torch.save(agent.state_dict(), path)
    tenth = max(a.iterations // 10, 1)
    more = {
        "device": str(env.device),
        "return_first": returns.mean(slice(None, 2 * tenth + 1)),
        "return_last": returns.mean(slice(-tenth, None)),
    }
    samples = a.iterations * settings.horizon * a.envs
    tell(a, agent.cpu().actor, "ppo", samples, seconds, ENVIRONMENTS[a.env], **more)


if __name__ == "__main__":
    run(main)
