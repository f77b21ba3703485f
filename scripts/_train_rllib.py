"""Train PPO of RLlib on an id of Ship Gym, as a stranger would: `scripts/test_rllib.sh` runs it."""

from __future__ import annotations

import logging
import math
import sys
import time
from importlib import metadata

import gymnasium as gym
import ray
from ray.rllib.algorithms.ppo import PPOConfig

import ship_gym

ENV = "ShipGym/HeadingKeeping-v0"
SEED = 0


def check_pin() -> None:
    """Gymnasium is the version that RLlib asks for, so pip has found one for both."""
    wanted = [
        line.split(";")[0].partition("==")[2].strip()
        for line in metadata.requires("ray") or ()
        if line.startswith("gymnasium==") and "rllib" in line
    ]
    if wanted and gym.__version__ not in wanted:
        sys.exit(f"ray[rllib] asks for gymnasium {wanted[0]}, {gym.__version__} is installed")
    print(f"ray {ray.__version__}, gymnasium {gym.__version__}, ship_gym {ship_gym.__version__}")


def train(seconds: float) -> dict:
    """The last result of an RLlib trainer of scalar environments."""
    made = (
        PPOConfig()
        .environment(ENV, env_config={"overrides": {"duration": 100.0}})
        .env_runners(num_env_runners=0, num_envs_per_env_runner=8)
        .training(train_batch_size_per_learner=2048, minibatch_size=512, num_epochs=4)
        .debugging(seed=SEED, log_level="ERROR")
        .build_algo()
    )
    end = time.monotonic() + seconds
    while True:
        found = made.train()
        if time.monotonic() > end:
            made.stop()
            return found


def main() -> None:
    """Train for the seconds of the command line; exit code 1 if the result is not one."""
    check_pin()
    logging.disable(logging.WARNING)  # RLlib's advice on its own settings
    ray.init("local", include_dashboard=False, log_to_driver=False, logging_level="error")
    try:
        found = train(float(sys.argv[1]))
    finally:
        ray.shutdown()
    numbers = {
        "return": found["env_runners"].get("episode_return_mean", math.nan),
        "policy loss": found["learners"]["default_policy"]["policy_loss"],
        "value loss": found["learners"]["default_policy"]["vf_loss"],
    }
    print(
        f"{found['num_env_steps_sampled_lifetime']:.0f} samples of {ENV}: "
        + ", ".join(f"{name} {value:.4g}" for name, value in numbers.items())
    )
    if odd := [name for name, value in numbers.items() if not math.isfinite(value)]:
        sys.exit(f"not finite: {', '.join(odd)}")


if __name__ == "__main__":
    main()
