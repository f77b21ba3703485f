"""The examples of docs/examples run as they stand."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = [pytest.mark.slow, pytest.mark.compiled]
EXAMPLES = Path(__file__).resolve().parents[2] / "docs" / "examples"


def run(script, *arguments):
    command = [sys.executable, EXAMPLES / script, *map(str, arguments)]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    return subprocess.run(command, env=environment, capture_output=True, text=True)


def test_ppo(tmp_path):
    torch = pytest.importorskip("torch")
    out = tmp_path / "weights.pt"
    done = run("ppo_torch.py", "--envs", 8, "--iterations", 4, "--json", "--out", out)
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    assert result["samples"] == 4 * 64 * 8 and result["return_last"] < 0.0
    assert torch.load(out)["actor.0.weight"].shape == (64, 9)


def test_ppo_without_a_card():
    torch = pytest.importorskip("torch")
    if torch.cuda.is_available():
        pytest.skip("there is a card")
    done = run("ppo_torch.py", "--device", "cuda")
    assert done.returncode == 2
    assert done.stderr.startswith("error: device = 'cuda'") and done.stderr.count("\n") == 1


def test_torchrl():
    pytest.importorskip("torchrl")
    done = run("torchrl_env.py", "--envs", 4, "--steps", 10, "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout[done.stdout.index("{") :])["shape"] == [4, 10]


@pytest.mark.parametrize("script", ["ppo_torch.py", "torchrl_env.py"])
def test_help_has_two_examples(script):
    if script.startswith("torchrl"):
        pytest.importorskip("torchrl")
    done = run(script, "--help")
    assert done.returncode == 0 and done.stdout.count("python docs/examples/") == 2
