"""Behaviour cloning from a Minari set: record an autopilot, read the set, learn to do the same.

Offline learners begin with such a set. The PID sails seeded episodes, all in one batch, which go to
Minari as buffers (its `DataCollector` does the same episode by episode, but needs JAX); a network
of plain torch learns its actions from the recorded observations and then sails beside it. Nothing
is downloaded. Needs ``pip install "ship-gym[rl,minari]"``.

The PID filters what it sees, and so remembers; the network sees one moment only and copies it well,
not exactly.
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
import warnings
from pathlib import Path

import gymnasium as gym
import minari
import numpy as np
import torch
from judging import in_words, judge
from minari.data_collector import EpisodeBuffer
from ship_gym_agents import make_controller
from ship_gym_agents.cli.output import progress, run, show
from torch import nn

from ship_gym.config import check_number
from ship_gym.writing import atomic_path, check_place

EXAMPLES = """examples:
  python docs/examples/clone_pid.py
  python docs/examples/clone_pid.py --episodes 200 --epochs 60 --datasets runs/sets --json"""
ENV_ID = "ShipGym/HeadingKeeping-v0"


def recorded(episodes: int, ship: str) -> minari.MinariDataset:
    """The set of that many episodes of a ship from the folder of Minari, recorded if not there."""
    dataset_id = f"ShipGym/HeadingKeeping/pid-{Path(ship).stem}-{episodes}-v0"
    if dataset_id not in minari.list_local_datasets():
        record(dataset_id, episodes, ship)
    return minari.load_dataset(dataset_id)


def record(dataset_id: str, episodes: int, ship: str) -> None:
    """Sail the training seeds 0, 1, ... under the PID, all at once, into a Minari set."""
    pid, env = make_controller("pid"), gym.make_vec(ENV_ID, episodes, ship=ship, parallel=False)
    seen, _ = env.reset(seed=0)
    pid.reset(episodes, env.unwrapped.ship, env.unwrapped.scenario)
    ended = np.zeros(episodes, dtype=bool)
    history = [[seen]]  # then of each interval: observations, actions, rewards, flags
    while not ended.all():
        action = pid.act(seen).astype(np.float32)
        seen, reward, terminated, truncated, _ = env.step(action)
        history.append([seen, action, reward, terminated, truncated])
        ended |= terminated | truncated
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # a set of one's own has no permanent link
        minari.create_dataset_from_buffers(
            dataset_id,
            [episode(history, i) for i in range(episodes)],
            env=gym.make(ENV_ID, ship=ship),
            algorithm_name=pid.name,
            description=f"The PID holds the heading of {ship}, seeds 0 to {episodes - 1}.",
        )


def episode(history: list[list[np.ndarray]], i: int) -> EpisodeBuffer:
    """The first episode of environment i; its seed is i."""
    _, actions, rewards, terminated, truncated = (
        np.array([row[k][i] for row in history[1:]]) for k in range(5)
    )
    length = int(np.argmax(terminated | truncated)) + 1
    return EpisodeBuffer(
        seed=i,
        observations=np.array([row[0][i] for row in history[: length + 1]]),
        actions=actions[:length],
        rewards=rewards[:length],
        terminations=terminated[:length],
        truncations=truncated[:length],
    )


def samples_of(dataset: minari.MinariDataset) -> tuple[torch.Tensor, torch.Tensor]:
    """Observations and the actions that answered them, (samples, ...)."""
    episodes = list(dataset.iterate_episodes())
    seen = np.vstack([one.observations[:-1] for one in episodes])
    return torch.from_numpy(seen), torch.from_numpy(np.vstack([one.actions for one in episodes]))


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
    held_out = len(seen) - len(seen) // 10  # the last episodes
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
    p.add_argument("--episodes", type=int, default=30, help="to record (default 30)")
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
    """Record or read the set, clone, say how near the clone comes."""
    a = arguments()
    check_number("episodes", a.episodes, 10, 10**5)
    check_number("epochs", a.epochs, 1, 10**5)
    check_place(a.out, "--out")
    with tempfile.TemporaryDirectory() as temporary:
        os.environ["MINARI_DATASETS_PATH"] = str((a.datasets or Path(temporary)).resolve())
        seen, done = samples_of(recorded(a.episodes, a.ship))
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
        f"{len(seen)} samples of {a.episodes} episodes, cloned in {seconds:.1f} s; rms error of "
        f"the action on the last tenth, held out: {error:.3f} (actions are in [-1, 1])\n"
        f"{in_words(judged, 'clone')}\nwrote {a.out}"
    )
    show(a.json, result, text)


if __name__ == "__main__":
    run(main)
