"""Any gymnasium from the lowest that pyproject.toml allows: what works with it, and what says no.

``scripts/test_lowest.sh`` runs these with that version.
"""

import subprocess
import sys
import warnings

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import ship_gym

IDS = sorted(ship_gym.ENVIRONMENTS)
SHORT = {"duration": 4.0}


@pytest.mark.parametrize("env_id", IDS)
def test_a_scalar_environment_passes_the_checker(env_id):
    with warnings.catch_warnings():
        warnings.simplefilter("error", category=UserWarning)
        check_env(gym.make(env_id, overrides=SHORT).unwrapped, skip_render_check=True)


def test_single_environments_side_by_side_sail_as_each_alone():
    """Also with the gymnasium without native vectors, whose `make_vec` this is."""
    envs = gym.make_vec(IDS[0], num_envs=2, vectorization_mode="sync")
    seen, _ = envs.reset(seed=3)
    action = np.full(envs.action_space.shape, 0.25, dtype=np.float32)
    stepped, rewards, *_ = envs.step(action)
    for i in range(2):
        env = gym.make(IDS[0])
        np.testing.assert_array_equal(env.reset(seed=3 + i)[0], seen[i])
        one, reward, *_ = env.step(action[i])
        np.testing.assert_array_equal(one, stepped[i])
        assert reward == rewards[i]


def test_a_scalar_environment_records(tmp_path):
    pytest.importorskip("rerun", reason="extra 'rerun' not installed")
    env = ship_gym.RecordRerun(gym.make(IDS[0], overrides=SHORT), tmp_path, picture=False)
    env.reset(seed=0)
    while not any(env.step(env.action_space.sample())[2:4]):
        pass
    env.close()
    assert len(env.files) == 1


WITHOUT_MODES = """
import gymnasium as gym
if hasattr(gym.vector, "AutoresetMode"):
    del gym.vector.AutoresetMode
gym.__version__ = "1.0.0"
import ship_gym
env = gym.make("ShipGym/HeadingKeeping-v0")
assert env.reset(seed=0)[0].shape == (9,)
for make in (
    lambda: ship_gym.ShipVectorEnv(2),
    lambda: ship_gym.RecordRerunVector,
    lambda: gym.make_vec(env.spec.id, num_envs=2, vectorization_mode=MODE),
):
    try:
        make()
    except ImportError as error:
        print(error)
"""


def test_a_gymnasium_without_autoreset_modes_gets_one_clear_word():
    """It names the version that is needed and what to use instead; scalars go on."""
    modes = getattr(gym, "VectorizeMode", None)  # before 1.0: "custom"
    mode = "custom" if modes is None else modes.VECTOR_ENTRY_POINT.value
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT_MODES.replace("MODE", repr(mode))],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    words = done.stdout.splitlines()
    assert len(words) == 3 and len(set(words)) == 1
    assert "gymnasium 1.1 or newer, 1.0.0 is installed" in words[0]
    assert 'vectorization_mode="sync"' in words[0]
