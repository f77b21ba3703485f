"""The kernels of the card, run by numba's simulator, beside the compiled ones of the CPU."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.gpu.voyages import LOST, LOST_AT, VOYAGES, voyage

pytest.importorskip("torch")
pytestmark = pytest.mark.compiled  # interpreted, the CPU would be compared with itself
ROOT = Path(__file__).resolve().parents[2]
SIMULATOR = {"NUMBA_ENABLE_CUDASIM": "1", "NUMBA_DISABLE_JIT": "1"}


def simulated(code, *arguments):
    environment = {**os.environ, **SIMULATOR, "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-W", "ignore", *code, *map(str, arguments)]
    return subprocess.run(command, env=environment, cwd=ROOT, capture_output=True, text=True)


@pytest.mark.parametrize("name", VOYAGES)
def test_the_card_sails_as_the_cpu(name, tmp_path):
    """Every number of every interval, over resets and a ship that is lost."""
    done = simulated([ROOT / "tests/gpu/voyages.py"], name, tmp_path / "voyage.npz")
    assert done.returncode == 0, done.stderr[-3000:]
    ours = voyage(name, "cpu")
    with np.load(tmp_path / "voyage.npz") as card:
        assert set(card) == set(ours)
        for key, value in ours.items():
            assert card[key].dtype == value.dtype
            scale = np.maximum(np.abs(value).max(axis=(0, 1)), 1e-3) if key != "seen" else 1.0
            error = np.abs(card[key].astype(float) - value.astype(float)) / scale
            assert error.max() < 1e-9 or (value.dtype == np.float32 and error.max() < 1e-6), key
    assert ours["ended"][LOST_AT, LOST]
    assert ours["ended"].sum() > 1


def test_compiled_kernels_are_refused():
    code = "import ship_gym; ship_gym.ShipTorchEnv(2, 'cuda')"
    environment = {
        **os.environ,
        "NUMBA_ENABLE_CUDASIM": "1",
        "PYTHONPATH": os.pathsep.join(sys.path),
    }
    environment.pop("NUMBA_DISABLE_JIT", None)
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True
    )
    assert "ConfigError" in done.stderr and "NUMBA_DISABLE_JIT=1" in done.stderr


BAD_ACTION = """
import torch
from ship_gym import ShipTorchEnv
from ship_gym.config import ConfigError
env = ShipTorchEnv(3, "cuda", overrides={"duration": 8.0})
env.reset(seed=1)
actions = torch.zeros(3, 1)
actions[2] = torch.nan
try:
    env.step(actions)
except ConfigError as error:
    print(error)
seen, _ = env.reset(seed=1)
again = seen.clone()
env.step(torch.zeros(3, 1))
print(bool((env.reset(seed=1)[0] == again).all()), env.tensor("elapsed").tolist())
"""


def test_an_action_that_is_not_finite():
    done = simulated(["-c", BAD_ACTION])
    lines = done.stdout.splitlines()
    assert lines[0].startswith("action 2 = [nan]: must be finite"), done.stderr[-2000:]
    assert lines[1] == "True [0, 0, 0]"
