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

from ship_gym.config import ConfigError
from ship_gym.locks import locked

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
    # the first kills fall into the first second, into imports and into the first validation; those
    # just before a change of a file are of scripts/check_kills.py
    for seconds in (0.5, 1.0, 3.0, 6.0, *(chance.uniform(4.0, 12.0) for _ in range(2))):
        process = start(tmp_path)
        time.sleep(seconds)
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


@pytest.mark.slow
@pytest.mark.compiled
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM])
def test_seeds_side_by_side_end_with_their_run(tmp_path, how):
    out = tmp_path / "run"
    process = start(tmp_path, "--seeds", "3", "--jobs", "2")
    try:
        wait_for(lambda: all(state(out / f"seed_{k}")["samples"] for k in (0, 1)), 180.0)
        kept = [state(out / f"seed_{k}")["samples"] for k in (0, 1)]
    finally:
        process.send_signal(how)
    wait_for(lambda: not any(is_held(out / f"seed_{k}") for k in (0, 1)), 30.0)
    process.wait(timeout=30)
    assert not (out / "seed_2").exists(), "none is begun after the end"
    assert all(state(out / f"seed_{k}")["samples"] >= kept[k] for k in (0, 1))
    if how is signal.SIGTERM:
        folders = (out, out / "seed_0", out / "seed_1")
        cards = [json.loads((folder / "card.json").read_text()) for folder in folders]
        assert [card["status"] for card in cards] == 3 * ["interrupted"]


def wait_for(condition, seconds):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "waited too long"
        time.sleep(0.1)


def is_held(folder):
    try:
        with locked(folder / "lock", "trains"):
            return False
    except ConfigError:
        return True


def start(folder, *more):
    """The run, begun or gone on with."""
    command = [*COMMAND, "--resume", *more]
    return subprocess.Popen(command, cwd=folder, stderr=subprocess.PIPE, text=True)
