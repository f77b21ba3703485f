"""PPO of TorchRL on the native vector environment of ``gym.make_vec``.

TorchRL's `GymWrapper` takes it as it is, its collector resets the ships that have ended by a mask.
Needs ``pip install torchrl``. What was learned sails beside the PID at the end.
"""

from __future__ import annotations

import time

import gymnasium as gym
import torch
from judging import LOG_STD, network, options, tell
from ship_gym_agents.cli.output import progress, run
from tensordict.nn import TensorDictModule
from torchrl.collectors import Collector
from torchrl.envs import GymWrapper, RewardScaling, TransformedEnv
from torchrl.modules import IndependentNormal, ProbabilisticActor, ValueOperator
from torchrl.objectives import ClipPPOLoss
from torchrl.objectives.value import GAE

import ship_gym  # noqa: F401  registers the ids

EXAMPLES = """examples:
  python docs/examples/ppo_torchrl.py
  python docs/examples/ppo_torchrl.py --iterations 300 --envs 128 --json"""
HORIZON = 64  # intervals of each ship in one iteration
EPOCHS, MINIBATCH = 8, 1024


class Actor(torch.nn.Module):
    """Mean and standard deviation of the actions for observations (..., n_observations)."""

    def __init__(self, n_observations: int, n_actions: int):
        super().__init__()
        self.net, self.log_std = network(n_observations, n_actions), LOG_STD[0]

    def forward(self, observations: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """What the distribution takes."""
        mean = self.net(observations)
        return mean, torch.full_like(mean, self.log_std).exp()


def environment(envs: int, ship: str, episode: float) -> TransformedEnv:
    """Ships in episodes of `episode` full-scale seconds, with returns of the size of 1."""
    given = {"ship": ship, "overrides": {"duration": episode}}
    ships = gym.make_vec(
        "ShipGym/HeadingKeeping-v0", num_envs=envs, autoreset_mode="Disabled", **given
    )
    return TransformedEnv(GymWrapper(ships), RewardScaling(loc=0.0, scale=0.05))


def train(env: TransformedEnv, iterations: int, seed: int) -> Actor:
    """Collect and learn; with the hyperparameters of ``ship-gym train``."""
    n_seen = env.observation_spec["observation"].shape[-1]
    actor = Actor(n_seen, env.action_spec.shape[-1])
    policy = ProbabilisticActor(
        TensorDictModule(actor, ["observation"], ["loc", "scale"]),
        in_keys=["loc", "scale"],
        spec=env.action_spec_unbatched,
        distribution_class=IndependentNormal,
        return_log_prob=True,
    )
    critic = ValueOperator(network(n_seen, 1), in_keys=["observation"])
    advantages = GAE(gamma=0.99, lmbda=0.98, value_network=critic)
    loss = ClipPPOLoss(
        policy, critic, clip_epsilon=0.2, entropy_bonus=False, critic_coeff=0.5,
        normalize_advantage=True, loss_critic_type="l2",
    )  # fmt: skip
    optimiser = torch.optim.Adam(loss.parameters(), lr=5e-4, eps=1e-5)
    frames = HORIZON * env.batch_size[0]
    env.set_seed(seed)
    collector = Collector(
        env,
        policy,
        frames_per_batch=frames,
        total_frames=frames * iterations,
        auto_register_policy_transforms=False,  # those of recurrent policies
    )
    for k, sailed in enumerate(progress(collector, "training", iterations)):
        advantages(sailed)
        sailed = sailed.reshape(-1)
        for _ in range(EPOCHS):
            for rows in torch.randperm(len(sailed)).split(MINIBATCH):
                found = loss(sailed[rows])
                optimiser.zero_grad()
                (found["loss_objective"] + found["loss_critic"]).backward()
                torch.nn.utils.clip_grad_norm_(loss.parameters(), 0.5)
                optimiser.step()
        done = (k + 1) / iterations
        actor.log_std = LOG_STD[0] + done * (LOG_STD[1] - LOG_STD[0])
    collector.shutdown()
    return actor


def main() -> None:
    """Train, say how it went beside the PID."""
    a = options(__doc__, EXAMPLES)
    torch.manual_seed(a.seed)
    env = environment(a.envs, a.ship, a.episode)
    started = time.perf_counter()
    actor = train(env, a.iterations, a.seed)
    seconds = time.perf_counter() - started
    tell(a, actor.net, "torchrl", a.iterations * HORIZON * a.envs, seconds)


if __name__ == "__main__":
    run(main)
