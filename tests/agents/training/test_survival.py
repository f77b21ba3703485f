"""Runs that are killed at any moment go on, and lose at most what was learned in one interval."""

import itertools
import json
import random
import signal
import subprocess
import sys
import time

import pytest
from ship_gym_agents.policies.policy_file import load_policy

pytest.importorskip("stable_baselines3")

INTERVAL = 1.0  # between two checkpoints [s]
COMMAND = [
    *(sys.executable, "-c", "from ship_gym_agents.cli import main; main()"),
    *("train", "--out", "run", "--steps", "20000"),
    *("--envs", "8", "--set", "duration=20", f"training.checkpoint={INTERVAL}"),
    *("training.episode=20", "training.validations=4", "training.threads=1"),
    *("algorithm.n_steps=16", "algorithm.batch_size=64", "algorithm.n_epochs=2"),
]


def state(folder):
    """Samples and seconds of the last complete checkpoint."""
    found = sorted(folder.glob("checkpoint/[0-9]*/run.json"))
    return json.loads(found[-1].read_text()) if found else {"samples": 0, "seconds": 0.0}


@pytest.mark.slow
@pytest.mark.compiled
def test_kills_at_any_moment_lose_at_most_an_interval(tmp_path):
    chance, folder = random.Random(0), tmp_path / "run"
    before = state(folder)
    for k in range(8):
        # the first kills fall into the first second, into imports and into the first validation
        process = start(tmp_path)
        time.sleep((0.5, 1.0, 3.0, 6.0)[k] if k < 4 else chance.uniform(4.0, 14.0))
        killed = process.poll() is None
        process.send_signal(signal.SIGKILL)
        process.wait()
        now = state(folder)
        assert now["samples"] >= before["samples"], "a kill took what had been kept"
        before = now
        if not killed:
            break
    done = start(tmp_path)
    _, error = done.communicate(timeout=300)
    if "used up" not in error:
        assert done.returncode == 0, error
    card = json.loads((folder / "card.json").read_text())
    assert card["status"] == "complete" and card["samples"] >= 20_000
    samples = [found["samples"] for found in card["validations"]]
    assert samples == sorted(samples) and samples[0] == 0
    load_policy(folder)
    assert len(list(folder.glob("checkpoint/*"))) == 1


@pytest.mark.slow
@pytest.mark.compiled
def test_checkpoints_are_written_in_time(tmp_path):
    process = start(tmp_path)
    seen = {}
    try:
        end = time.monotonic() + 120.0
        while process.poll() is None and time.monotonic() < end and len(seen) < 5:
            seen.setdefault(state(tmp_path / "run")["seconds"], time.monotonic())
            time.sleep(0.05)
    finally:
        process.send_signal(signal.SIGTERM)  # ends as Ctrl-C does
        process.wait()
    kept = sorted(seconds for seconds in seen if seconds > 0.0)
    assert len(kept) >= 3
    assert max(b - a for a, b in itertools.pairwise(kept)) < INTERVAL + 1.0
    assert json.loads((tmp_path / "run" / "card.json").read_text())["status"] == "interrupted"


def start(folder):
    """The run, begun or gone on with."""
    return subprocess.Popen([*COMMAND, "--resume"], cwd=folder, stderr=subprocess.PIPE, text=True)
