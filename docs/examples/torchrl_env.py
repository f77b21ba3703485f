"""ShipTorchEnv as an environment of TorchRL: a batch of n, on the CPU or a graphics card.

Run it for a check of the specs and a short rollout; import `ShipTorchRLEnv` for collectors and
losses. Needs ``pip install torchrl``.
"""

from __future__ import annotations

import argparse
from typing import Any

import torch
from ship_gym_agents.cli.output import run, show
from tensordict import TensorDict, TensorDictBase
from torchrl.data import Binary, Bounded, Composite, Unbounded
from torchrl.envs import EnvBase
from torchrl.envs.utils import check_env_specs

from ship_gym import ShipTorchEnv

EXAMPLES = """examples:
  python docs/examples/torchrl_env.py
  python docs/examples/torchrl_env.py --device cuda --envs 4096 --steps 600 --json"""


class ShipTorchRLEnv(EnvBase):
    """A batch of ships for TorchRL, which says itself when an ended episode begins anew.

    Parameters
    ----------
    num_envs : int
    device : str
    **options
        Of `ShipTorchEnv`.
    """

    def __init__(self, num_envs: int, device: str = "cpu", **options: Any):
        self.ships = ShipTorchEnv(num_envs, device, autoreset=False, **options)
        super().__init__(device=self.ships.device, batch_size=(num_envs,))
        seen, acts = self.ships.observation_space, self.ships.action_space
        at = {"device": self.device, "dtype": torch.float32}
        self.observation_spec = Composite(
            observation=Bounded(
                torch.as_tensor(seen.low), torch.as_tensor(seen.high), seen.shape, **at
            ),
            shape=self.batch_size,
        )
        self.action_spec = Bounded(-1.0, 1.0, acts.shape, **at)
        self.reward_spec = Unbounded((num_envs, 1), **at)
        flag = Binary(shape=(num_envs, 1), dtype=torch.bool, device=self.device)
        self.full_done_spec = Composite(
            {name: flag.clone() for name in ("done", "terminated", "truncated")},
            shape=self.batch_size,
        )
        self._seed: int | None = None

    def _reset(self, tensordict: TensorDictBase | None = None, **_: Any) -> TensorDictBase:
        mask = None
        if tensordict is not None and "_reset" in tensordict.keys():
            mask = tensordict["_reset"].reshape(self.batch_size)
        seen, _ = self.ships.reset(seed=self._seed, mask=mask)
        self._seed = None  # later episodes go on with the same streams
        return self._answer({"observation": seen.clone()}, reset=True)

    def _step(self, tensordict: TensorDictBase) -> TensorDictBase:
        seen, rewards, terminated, truncated, _ = self.ships.step(tensordict["action"])
        values = {
            "observation": seen.clone(),
            "reward": rewards.to(torch.float32).unsqueeze(-1),
            "terminated": terminated.clone().unsqueeze(-1),
            "truncated": truncated.clone().unsqueeze(-1),
        }
        return self._answer(values)

    def _answer(self, values: dict[str, torch.Tensor], reset: bool = False) -> TensorDictBase:
        if reset:
            off = torch.zeros(*self.batch_size, 1, dtype=torch.bool, device=self.device)
            values |= {"terminated": off, "truncated": off.clone()}
        values["done"] = values["terminated"] | values["truncated"]
        return TensorDict(values, self.batch_size, device=self.device)

    def _set_seed(self, seed: int | None) -> None:
        self._seed = seed


def main() -> None:
    """Check the specs, sail at random."""
    p = argparse.ArgumentParser(
        description=__doc__.splitlines()[0],
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    p.add_argument("--device", default="cpu", help="cpu, cuda or cuda:1 (default cpu)")
    p.add_argument("--envs", type=int, default=64, help="environments (default 64)")
    p.add_argument("--steps", type=int, default=200, help="intervals (default 200)")
    p.add_argument("--scenario", default="heading_keeping", help="default heading_keeping")
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--json", action="store_true", help="print the result as JSON on stdout")
    a = p.parse_args()
    env = ShipTorchRLEnv(a.envs, a.device, scenario=a.scenario)
    env.set_seed(a.seed)
    check_env_specs(env)
    sailed = env.rollout(a.steps, break_when_any_done=False)
    reward, ended = sailed["next", "reward"].mean().item(), sailed["next", "done"].sum().item()
    result = {"shape": list(sailed.shape), "mean_reward": reward, "episodes_ended": ended}
    text = (
        f"rollout of shape {tuple(sailed.shape)}: mean reward {reward:.4g}, {ended} episodes ended"
    )
    show(a.json, result, text)


if __name__ == "__main__":
    run(main)
