"""Behaviour cloning from a data set: load one, learn to do what the PID does, judge the clone.

Offline learners begin with such a set (docs/datasets.md). The PID sails seeded episodes, all in one
batch, which go to Minari; a network of plain torch learns what it asked for, and then sails beside
it. With ``--noise 0 0.1`` the set shows states beside its usual ones, too; the infos keep what it
asked for there. Nothing is downloaded. Needs ``pip install "ship-gym[rl,minari]"``.

The PID filters what it sees, and so remembers; the network sees one moment only and copies it well,
not exactly.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

import minari
import numpy as np
import torch
from judging import in_words, judge
from ship_gym_agents.cli.output import progress, run, show
from ship_gym_agents.datasets import Plan, load_set, write_set
from ship_gym_agents.datasets.minari_set import is_set
from torch import nn

from ship_gym.config import check_number
from ship_gym.writing import atomic_path, check_place

EXAMPLES = """examples:
  python docs/examples/clone_pid.py
  python docs/examples/clone_pid.py --episodes 15 --noise 0 0.1 --datasets runs/sets --json"""


def recorded(plan: Plan, folder: Path) -> minari.MinariDataset:
    """The set of a plan from a folder, written if it is not there: one PID, one ship."""
    noise = "-".join(f"{std:g}".replace(".", "_") for std in plan.noise)
    name = f"ShipGym/HeadingKeeping/pid-{Path(plan.env['ship']).stem}-{plan.episodes}-{noise}-v0"
    if not is_set(folder / name):
        write_set(plan, folder, name, progress=progress)
    return load_set(name, folder)


def samples_of(dataset: minari.MinariDataset) -> tuple[torch.Tensor, torch.Tensor]:
    """Observations and what the PID asked for there, before the noise; (samples, ...).

    Row k of the infos tells of the interval that ends there, so that of action k is row k + 1.
    """
    episodes = [dataset[int(i)] for i in np.random.default_rng(0).permutation(len(dataset))]
    seen = np.vstack([one.observations[:-1] for one in episodes])
    done = np.vstack([one.infos["controller_action"][1:] for one in episodes])
    return torch.from_numpy(seen), torch.from_numpy(done.astype(np.float32))


class Normalised(nn.Module):
    """Observations to mean 0 and standard deviation 1."""

    def __init__(self, mean: torch.Tensor, std: torch.Tensor):
        super().__init__()
        self.register_buffer("mean", mean)
        self.register_buffer("std", std)

    def forward(self, seen: torch.Tensor) -> torch.Tensor:
        """Scaled observations."""
        return (seen - self.mean) / self.std


def clone(seen: torch.Tensor, done: torch.Tensor, epochs: int, seed: int):
    """A network that gives the recorded actions, and its rms error on a tenth that it never saw."""
    torch.manual_seed(seed)
    held_out = len(seen) - len(seen) // 10  # the last ones
    mean, std = seen[:held_out].mean(0), seen[:held_out].std(0) + 1e-3
    network = nn.Sequential(
        Normalised(mean, std),
        nn.Linear(seen.shape[1], 64), nn.Tanh(),
        nn.Linear(64, 64), nn.Tanh(),
        nn.Linear(64, done.shape[1]),
    )  # fmt: skip
    optimiser = torch.optim.Adam(network.parameters(), lr=2e-3)
    steps = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, epochs)
    for _ in progress(range(epochs), "cloning"):
        for rows in torch.randperm(held_out).split(512):
            loss = nn.functional.mse_loss(network(seen[rows]), done[rows])
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
        steps.step()
    with torch.no_grad():
        error = (network(seen[held_out:]) - done[held_out:]).square().mean().sqrt().item()
    return network, error


def arguments() -> argparse.Namespace:
    """Options of the command line."""
    p = argparse.ArgumentParser(
        description=__doc__.splitlines()[0],
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    p.add_argument("--episodes", type=int, default=30, help="with each noise (default 30)")
    p.add_argument("--noise", type=float, nargs="+", default=[0.0], help="on actions; default 0")
    p.add_argument("--epochs", type=int, default=30, help="over the set (default 30)")
    p.add_argument("--ship", default="kcs", help="default kcs")
    p.add_argument("--judge", type=int, default=16, help="evaluation episodes (default 16)")
    p.add_argument("--seed", type=int, default=0, help="of network and learning (default 0)")
    p.add_argument(
        "--datasets", type=Path, help="folder that keeps the set; default: a temporary one"
    )
    p.add_argument("--out", type=Path, default=Path("runs/clone_pid.pt"), help="weights")
    p.add_argument("--json", action="store_true", help="print the result as JSON on stdout")
    return p.parse_args()


def main() -> None:
    """Write or read the set, clone, say how near the clone comes."""
    a = arguments()
    check_number("episodes", a.episodes, 5, 10**5)
    check_number("epochs", a.epochs, 1, 10**5)
    check_place(a.out, "--out")
    plan = Plan(("pid",), tuple(a.noise), episodes=a.episodes, env={"ship": a.ship})
    with tempfile.TemporaryDirectory() as temporary:
        seen, done = samples_of(recorded(plan, a.datasets or Path(temporary)))
    started = time.perf_counter()
    network, error = clone(seen, done, a.epochs, a.seed)
    seconds = time.perf_counter() - started
    with atomic_path(a.out) as path:
        torch.save(network.state_dict(), path)
    judged = judge(network, "clone", a.judge, "heading_keeping", ship=a.ship)
    result = {
        "samples": len(seen),
        "seconds": round(seconds, 1),
        "rms_error_held_out": error,
        "judged": judged,
        "out": str(a.out),
    }
    text = (
        f"{len(seen)} samples of {a.episodes * len(a.noise)} episodes, cloned in {seconds:.1f} s; "
        f"rms error of the action on a tenth, held out: {error:.3f} (actions are in [-1, 1])\n"
        f"{in_words(judged, 'clone')}\nwrote {a.out}"
    )
    show(a.json, result, text)


if __name__ == "__main__":
    run(main)
