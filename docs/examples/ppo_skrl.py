"""PPO of skrl on the native vector environment of ``gym.make_vec``.

skrl wraps vector environments of Gymnasium as they are. Needs ``pip install skrl``. What was
learned sails beside the PID at the end.
"""

from __future__ import annotations

import time

import gymnasium as gym
import torch
from judging import LOG_STD, network, options, tell
from ship_gym_agents.cli.output import progress, run
from skrl import logger
from skrl.agents.torch.ppo import PPO, PPO_CFG
from skrl.envs.wrappers.torch import wrap_env
from skrl.memories.torch import RandomMemory
from skrl.models.torch import DeterministicMixin, GaussianMixin, Model
from skrl.trainers.torch import SequentialTrainer
from skrl.utils import set_seed

import ship_gym  # noqa: F401  registers the ids

EXAMPLES = """examples:
  python docs/examples/ppo_skrl.py
  python docs/examples/ppo_skrl.py --iterations 300 --envs 128 --json"""
HORIZON = 64  # intervals of each ship in one iteration


class Actor(GaussianMixin, Model):
    """Mean action of observations (n, n_observations)."""

    def __init__(self, **spaces):
        Model.__init__(self, **spaces)
        GaussianMixin.__init__(self)
        self.net, self.log_std = network(self.num_observations, self.num_actions), LOG_STD[0]

    def compute(self, inputs: dict, role: str = "") -> tuple[torch.Tensor, dict]:
        """What skrl asks for: the mean and the logarithm of the standard deviation."""
        mean = self.net(inputs["observations"])
        return mean, {"log_std": torch.full_like(mean, self.log_std)}


class Critic(DeterministicMixin, Model):
    """Expected discounted return, of rewards that are scaled."""

    def __init__(self, **spaces):
        Model.__init__(self, **spaces)
        DeterministicMixin.__init__(self)
        self.net = network(self.num_observations, 1)

    def compute(self, inputs: dict, role: str = "") -> tuple[torch.Tensor, dict]:
        """What skrl asks for."""
        return self.net(inputs["observations"]), {}


def agent_of(env) -> PPO:
    """PPO of skrl with the hyperparameters of ``ship-gym train``."""
    spaces = {
        "observation_space": env.observation_space,
        "action_space": env.action_space,
        "device": env.device,
    }
    samples = HORIZON * env.num_envs
    settings = PPO_CFG(
        rollouts=HORIZON,
        learning_epochs=8,
        mini_batches=max(samples // 1024, 1),
        learning_rate=5e-4,
        gae_lambda=0.98,
        value_loss_scale=0.5,
        value_clip=0.0,
        time_limit_bootstrap=True,  # an episode that is cut off goes on in thought
        rewards_shaper=lambda rewards, *_: 0.05 * rewards,  # returns of the size of 1
        experiment={"write_interval": 0, "checkpoint_interval": 0},
    )
    return PPO(
        models={"policy": Actor(**spaces), "value": Critic(**spaces)},
        memory=RandomMemory(memory_size=HORIZON, num_envs=env.num_envs, device=env.device),
        cfg=settings,
        **spaces,
    )


def train(agent: PPO, env, iterations: int) -> None:
    """Each call of skrl's trainer is a rollout and an update; the ships sail on between them."""
    settings = {"timesteps": HORIZON, "headless": True, "disable_progressbar": True}
    trainer = SequentialTrainer(env=env, agents=agent, cfg=settings)
    for k in progress(range(iterations), "training"):
        done = k / iterations
        agent.policy.log_std = LOG_STD[0] + done * (LOG_STD[1] - LOG_STD[0])
        trainer.train()


def main() -> None:
    """Train, say how it went beside the PID."""
    a = options(__doc__, EXAMPLES)
    logger.setLevel("ERROR")
    set_seed(a.seed)
    given = {"ship": a.ship, "overrides": {"duration": a.episode}}
    ships = gym.make_vec("ShipGym/HeadingKeeping-v0", num_envs=a.envs, **given)
    env = wrap_env(ships, wrapper="gymnasium")
    agent = agent_of(env)
    started = time.perf_counter()
    train(agent, env, a.iterations)
    seconds = time.perf_counter() - started
    tell(a, agent.policy.net, "skrl", a.iterations * HORIZON * a.envs, seconds)


if __name__ == "__main__":
    run(main)
