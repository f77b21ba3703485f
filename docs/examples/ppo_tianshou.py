"""PPO of Tianshou on the native vector environment: its collector steps all ships in one batch.

Tianshou makes vectors of functions for single environments; `ShipTianshouEnv` gives it ours. Needs
``pip install tianshou``. What was learned sails beside the PID at the end.
"""

from __future__ import annotations

import time

import numpy as np
import torch
from judging import LOG_STD, network, options, tell
from ship_gym_agents.cli.output import progress, run
from ship_gym_agents.tianshou_env import ShipTianshouEnv
from tianshou.algorithm.modelfree.ppo import PPO
from tianshou.algorithm.modelfree.reinforce import ProbabilisticActorPolicy
from tianshou.algorithm.optim import AdamOptimizerFactory
from tianshou.data import Collector, VectorReplayBuffer
from tianshou.utils.net.common import AbstractContinuousActorProbabilistic
from tianshou.utils.torch_utils import policy_within_training_step, torch_train_mode

EXAMPLES = """examples:
  python docs/examples/ppo_tianshou.py
  python docs/examples/ppo_tianshou.py --iterations 300 --envs 128 --json"""
HORIZON = 64  # intervals of each ship in one iteration


class Actor(AbstractContinuousActorProbabilistic):
    """Mean action and standard deviation of observations (n, n_observations)."""

    def __init__(self, n_observations: int, n_actions: int):
        super().__init__(n_actions)
        self.net, self.log_std = network(n_observations, n_actions), LOG_STD[0]

    def forward(self, obs, state=None, info=None):
        """What Tianshou asks for: parameters of the distribution, and a hidden state."""
        mean = self.net(torch.as_tensor(obs))
        return (mean, torch.full_like(mean, self.log_std).exp()), state

    def get_preprocess_net(self):
        """None is shared with the critic."""
        return torch.nn.Identity()


class Critic(torch.nn.Module):
    """Expected discounted return, in units of Tianshou's scale of returns."""

    def __init__(self, n_observations: int):
        super().__init__()
        self.net = network(n_observations, 1)

    def forward(self, obs, act=None, info=None):
        """What Tianshou asks for."""
        return self.net(torch.as_tensor(obs))


def gaussian(parameters: tuple[torch.Tensor, torch.Tensor]) -> torch.distributions.Distribution:
    """Distribution of the actions from what the actor gives."""
    return torch.distributions.Independent(torch.distributions.Normal(*parameters), 1)


def algorithm(env: ShipTianshouEnv) -> PPO:
    """PPO of Tianshou with the hyperparameters of ``ship-gym train``."""
    seen, acts = env.observation_space[0], env.action_space[0]
    policy = ProbabilisticActorPolicy(
        actor=Actor(seen.shape[0], acts.shape[0]),
        dist_fn=gaussian,
        action_space=acts,
        observation_space=seen,
        action_scaling=False,
    )
    return PPO(
        policy=policy,
        critic=Critic(seen.shape[0]),
        optim=AdamOptimizerFactory(lr=5e-4, eps=1e-5),
        ent_coef=0.0,
        max_grad_norm=0.5,
        gae_lambda=0.98,
        gamma=0.99,
        return_scaling=True,
    )


def train(ppo: PPO, env: ShipTianshouEnv, iterations: int, seed: int) -> None:
    """Collect and learn."""
    env.seed(seed)
    collector = Collector(ppo, env, VectorReplayBuffer(HORIZON * len(env), len(env)))
    collector.reset()
    for k in progress(range(iterations), "training"):
        done = k / iterations
        ppo.policy.actor.log_std = LOG_STD[0] + done * (LOG_STD[1] - LOG_STD[0])
        with policy_within_training_step(ppo.policy):
            collector.collect(n_step=HORIZON * len(env))
            with torch_train_mode(ppo):
                ppo.update(buffer=collector.buffer, batch_size=1024, repeat=8)
        collector.reset_buffer(keep_statistics=True)


def main() -> None:
    """Train, say how it went beside the PID."""
    a = options(__doc__, EXAMPLES)
    torch.manual_seed(a.seed)
    np.random.seed(a.seed)  # noqa: NPY002  Tianshou draws its minibatches so
    env = ShipTianshouEnv(a.envs, ship=a.ship, overrides={"duration": a.episode})
    ppo = algorithm(env)
    started = time.perf_counter()
    train(ppo, env, a.iterations, a.seed)
    seconds = time.perf_counter() - started
    tell(a, ppo.policy.actor.net, "tianshou", a.iterations * HORIZON * a.envs, seconds)


if __name__ == "__main__":
    run(main)
