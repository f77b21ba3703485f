"""How fast ShipTorchEnv sails on a device: ship-steps a second over the number of ships.

Says which card or processor it is, and whether the numbers of a short voyage are those of the CPU.
"""

from __future__ import annotations

import argparse
import platform
import time

import torch
from ship_gym_agents.cli.output import progress, run, show

from ship_gym import ShipTorchEnv

EXAMPLES = """examples:
  python docs/examples/torch_speed.py
  python docs/examples/torch_speed.py --device cuda --ships 4096 65536 --json"""
VOYAGE = 20  # intervals, and ships, of the comparison


def device_name(device: torch.device) -> str:
    """Name of the card, or of the machine."""
    if device.type == "cuda" and torch.cuda.is_available():
        return torch.cuda.get_device_name(device)
    return platform.processor() or platform.machine()


def speed(env: ShipTorchEnv, steps: int) -> float:
    """Ship-steps a second of a stretch without resets, best of three."""
    actions = torch.zeros(env.action_space.shape, device=env.device)
    times = []
    for _ in range(3):
        env.reset(seed=0)
        env.step(actions)  # compiles, the first time
        started = time.perf_counter()
        for _ in range(steps):
            env.step(actions)
        times.append(time.perf_counter() - started)
    return env.num_envs * steps / min(times)


def largest_difference(device: str, scenario: str) -> float:
    """Largest difference of an observation from that of the CPU after a short voyage."""
    both = [ShipTorchEnv(VOYAGE, where, scenario=scenario) for where in (device, "cpu")]
    for env in both:
        env.reset(seed=0)
    generator = torch.Generator().manual_seed(0)
    for _ in range(VOYAGE):
        actions = 2.0 * torch.rand(both[0].action_space.shape, generator=generator) - 1.0
        seen = [env.step(actions.to(env.device))[0].cpu() for env in both]
    return float((seen[0] - seen[1]).abs().max())


def main() -> None:
    """Measure and print."""
    p = argparse.ArgumentParser(
        description=__doc__.splitlines()[0],
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    p.add_argument("--device", default="cpu", help="cpu, cuda or cuda:1 (default cpu)")
    p.add_argument("--ships", type=int, nargs="+", default=[64, 4096], help="default 64 4096")
    p.add_argument("--steps", type=int, default=50, help="intervals of one stretch (default 50)")
    p.add_argument("--scenario", default="heading_keeping", help="default heading_keeping")
    p.add_argument("--json", action="store_true", help="print the result as JSON on stdout")
    a = p.parse_args()
    difference = largest_difference(a.device, a.scenario)
    found = {}
    for n in progress(a.ships, "sailing"):
        found[n] = speed(ShipTorchEnv(n, a.device, scenario=a.scenario), a.steps)
    name = device_name(torch.device(a.device))
    result = {"device": name, "ship_steps_per_second": found, "difference": difference}
    lines = [f"{n:>8} ships: {rate:,.0f} ship-steps a second" for n, rate in found.items()]
    text = f"{name}, largest difference of an observation from the CPU's: {difference:.1e}"
    show(a.json, result, "\n".join([text, *lines]))


if __name__ == "__main__":
    run(main)
