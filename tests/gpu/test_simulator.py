"""The kernels of the card, run by numba's simulator, beside the compiled ones of the CPU."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import ship_gym
from ship_gym.config import ConfigError
from tests.gpu.voyages import LOST, LOST_AT, VOYAGES, voyage

pytest.importorskip("torch")
# interpreted, the CPU would be compared with itself
pytestmark = [pytest.mark.compiled, pytest.mark.slow]
ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def card(tmp_path_factory):
    """Folder with the voyages as the simulated card sails them."""
    folder = tmp_path_factory.mktemp("card")
    settings = {"NUMBA_ENABLE_CUDASIM": "1", "NUMBA_DISABLE_JIT": "1"}
    environment = {**os.environ, **settings, "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-W", "ignore", ROOT / "tests/gpu/voyages.py", folder]
    done = subprocess.run(command, env=environment, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-3000:]
    return folder


@pytest.mark.parametrize("name", VOYAGES)
def test_the_card_sails_as_the_cpu(name, card):
    """Every number of every interval, over resets and a ship that is lost.

    To 1e-9 of the largest that stands in its column; observations are float32.
    """
    ours = voyage(name, "cpu")
    with np.load(card / f"{name}.npz") as theirs:
        assert set(theirs) == set(ours)
        for key, value in ours.items():
            assert theirs[key].dtype == value.dtype and theirs[key].shape == value.shape
            scale = np.maximum(np.abs(value).max(axis=(0, 1)).astype(float), 1e-3)
            error = np.abs(theirs[key].astype(float) - value.astype(float)) / scale
            assert error.max() <= (1e-6 if value.dtype == np.float32 else 1e-9), key
    assert ours["ended"][LOST_AT, LOST]
    assert ours["ended"].sum() > 1


def test_an_action_that_is_not_finite(card):
    text = (card / "bad_action.txt").read_text()
    assert text == "action 2 = [nan]: must be finite, in [-1, 1]; then as before"


def test_compiled_kernels_are_refused(monkeypatch):
    monkeypatch.setenv("NUMBA_ENABLE_CUDASIM", "1")
    monkeypatch.delenv("NUMBA_DISABLE_JIT", raising=False)
    with pytest.raises(ConfigError, match="NUMBA_DISABLE_JIT=1"):
        ship_gym.ShipTorchEnv(2, "cuda")
