"""TorchRL's `GymWrapper` over the native vector environment: all ships step in one compiled loop.

Run it for a check of the specs and a short rollout, with what the infos say in it. Needs
``pip install torchrl``; for ships on a graphics card see ``torchrl_env.py``.
"""

from __future__ import annotations

import argparse
import time

import gymnasium as gym
from ship_gym_agents.cli.output import run, show
from torchrl.envs import GymWrapper
from torchrl.envs.utils import check_env_specs

import ship_gym  # noqa: F401  registers the ids

EXAMPLES = """examples:
  python docs/examples/torchrl_gym.py
  python docs/examples/torchrl_gym.py --autoreset SameStep --envs 256 --steps 1000 --json"""


def make(env_id: str, num_envs: int, autoreset: str, **options) -> GymWrapper:
    """The environments as TorchRL wants them, with the infos in their tensordicts.

    Parameters
    ----------
    env_id : str
    num_envs : int
    autoreset : str
        ``"Disabled"``: TorchRL resets the ships that have ended, by a mask; ``"SameStep"``: they
        are reset in the step that ends them. TorchRL takes no other.
    **options
        Of ``gym.make_vec``.
    """
    ships = gym.make_vec(
        env_id, num_envs=num_envs, autoreset_mode=autoreset, info="flat", **options
    )
    env = GymWrapper(ships)
    return env if autoreset == "SameStep" else env.auto_register_info_dict()


def main() -> None:
    """Check the specs, sail at random."""
    p = argparse.ArgumentParser(
        description=__doc__.splitlines()[0],
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    p.add_argument("--env", default="ShipGym/HeadingKeeping-v0", help="id (default HeadingKeeping)")
    p.add_argument("--autoreset", default="Disabled", help="Disabled (default) or SameStep")
    p.add_argument("--envs", type=int, default=64, help="environments (default 64)")
    p.add_argument("--steps", type=int, default=200, help="intervals (default 200)")
    p.add_argument("--seed", type=int, default=0, help="of ship 0, ship i has i more (default 0)")
    p.add_argument("--json", action="store_true", help="print the result as JSON on stdout")
    a = p.parse_args()
    env = make(a.env, a.envs, a.autoreset)
    check_env_specs(env)
    env.set_seed(a.seed)
    begun = time.perf_counter()
    sailed = env.rollout(a.steps, break_when_any_done=False)["next"]
    seconds = time.perf_counter() - begun
    result = {
        "shape": list(sailed.shape),
        "mean_reward": sailed["reward"].mean().item(),
        "mean_power": sailed["power"].mean().item(),  # of the infos [W]
        "episodes_ended": sailed["done"].sum().item(),
        "intervals_per_second": round(sailed.numel() / seconds),
    }
    text = (
        f"rollout of shape {tuple(sailed.shape)}: mean reward {result['mean_reward']:.4g}, mean "
        f"power {result['mean_power'] / 1e6:.3g} MW, {result['episodes_ended']} episodes ended, "
        f"{result['intervals_per_second']} intervals a second"
    )
    show(a.json, result, text)


if __name__ == "__main__":
    run(main)
