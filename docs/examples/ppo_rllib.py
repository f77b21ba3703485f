"""PPO of RLlib on the native vector environment: each runner steps its ships in one batch.

RLlib makes vector environments with ``gym.make_vec``; given a `VECTOR_ENTRY_POINT` it takes ours as
it is, instead of a loop over single environments. Needs ``pip install "ship-gym[rllib]"``, which
brings the one version of Gymnasium that RLlib asks for. What was learned sails beside the PID at
the end.
"""

from __future__ import annotations

import logging
import time
from typing import Any

import gymnasium as gym
import ray
import torch
from judging import MeanAction, options, tell
from ray.rllib.algorithms.algorithm import Algorithm
from ray.rllib.algorithms.ppo import PPOConfig
from ray.tune.registry import register_env
from ship_gym_agents.cli.output import progress, run

from ship_gym.config import check_number
from ship_gym.envs.vector_env import ShipVectorEnv

EXAMPLES = """examples:
  python docs/examples/ppo_rllib.py
  python docs/examples/ppo_rllib.py --iterations 60 --runners 2 --envs 64 --json"""
NAME = "ship_gym"
HORIZON = 32  # intervals of each environment in one iteration


def make_env(config: dict[str, Any]) -> ShipVectorEnv:
    """What a runner of RLlib calls; `num_envs` is among the keys of `config`."""
    return ShipVectorEnv(
        config["num_envs"],
        scenario="heading_keeping",
        ship=config["ship"],
        overrides={"duration": config["episode"]},  # full-scale s
        parallel=False,
    )


def algorithm(envs: int, runners: int, ship: str, episode: float, seed: int) -> Algorithm:
    """PPO of RLlib with the hyperparameters of ``ship-gym train``, as far as both have them."""
    register_env(NAME, make_env)
    samples = HORIZON * envs * max(runners, 1)
    config = (
        PPOConfig()
        .environment(NAME, env_config={"ship": ship, "episode": episode})
        .env_runners(
            num_env_runners=runners,
            num_envs_per_env_runner=envs,
            gym_env_vectorize_mode=gym.VectorizeMode.VECTOR_ENTRY_POINT,
            rollout_fragment_length=HORIZON,
        )
        .training(
            train_batch_size_per_learner=samples,
            minibatch_size=min(1024, samples),
            num_epochs=8,
            lr=5e-4,
            gamma=0.99,
            lambda_=0.98,
            clip_param=0.2,
            grad_clip=0.5,
            use_kl_loss=False,
            vf_clip_param=1e9,  # returns reach -100; the default of 10 would cut their errors off
        )
        .debugging(seed=seed, log_level="ERROR")
    )
    return config.build_algo()


def mean_action_of(made: Algorithm) -> MeanAction:
    """The mean of the Gaussian policy: the first half of what RLlib's module gives."""
    module = made.get_module()

    def mean_action(seen: torch.Tensor) -> torch.Tensor:
        return module.forward_inference({"obs": seen})["action_dist_inputs"].chunk(2, -1)[0]

    return mean_action


def main() -> None:
    """Train, say how it went beside the PID."""
    a = options(
        __doc__, EXAMPLES, iterations=1, runners=(0, "processes; 0: this one, --envs ships in each")
    )
    check_number("runners", a.runners, 0, 1000)
    logging.disable(logging.WARNING)  # RLlib's advice on its own settings
    ray.init("local", include_dashboard=False, log_to_driver=False, logging_level="error")
    try:
        made = algorithm(a.envs, a.runners, a.ship, a.episode, a.seed)
        started = time.perf_counter()
        for _ in progress(range(a.iterations), "training"):
            found = made.train()
        seconds = time.perf_counter() - started
        samples = int(found["num_env_steps_sampled_lifetime"])
        ended = found["env_runners"].get("episode_return_mean")  # None: no episode has ended
        tell(a, mean_action_of(made), "rllib", samples, seconds, **{"return": ended})
        made.stop()
    finally:
        ray.shutdown()


if __name__ == "__main__":
    run(main)
