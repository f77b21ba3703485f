"""The script that runs Gymnasium's tests with our ids, on a small checkout made here."""

import json

import pytest

MADE = """
import gymnasium as gym
import pytest
from gymnasium.envs.classic_control.cartpole import CartPoleVectorEnv


def test_good():
    assert isinstance(gym.make_vec("CartPole-v1"), CartPoleVectorEnv)


@pytest.mark.parametrize("env_id", ["CartPole-v1"])
def test_bad_with_ours(env_id):
    assert gym.make(env_id).observation_space.shape == (4,)


@pytest.mark.parametrize("env_id", ["CartPole-v1"])
def test_bad_with_theirs_too(env_id):
    assert gym.make(env_id) is None


def test_call_sync_vector_env():
    gym.make("CartPole-v1").get_wrapper_attr("gravity")
"""


@pytest.fixture
def checkout(tmp_path):
    folder = tmp_path / "checkout" / "tests"
    for place in ("vector", "wrappers"):
        (folder / place).mkdir(parents=True)
    for package in (folder, folder / "vector"):
        (package / "__init__.py").touch()
    (folder / "vector" / "test_made.py").write_text(MADE)
    (folder / "vector" / "test_without.py").write_text("def test_no_id(): assert False\n")
    return folder.parent


@pytest.mark.slow
def test_failures_are_classified(call, checkout):
    code, out, _ = call("check_gymnasium.py", str(checkout), "--json")
    found = json.loads(out)["tests"]
    assert code == 1
    classes = {}
    for one in found:
        name = one["test"].partition("::test_")[2].partition("[")[0]
        classes[one["by"], name] = one["class"]
    for by in ("ours", "native"):
        assert classes[by, "good"] == "passed"
        assert classes[by, "bad_with_ours"] == "unexplained"
        assert classes[by, "bad_with_theirs_too"] == "fails with theirs too"
        assert classes[by, "call_sync_vector_env"] == "takes another environment for granted"
    assert len(found) == 8


def test_another_folder_is_refused(call, tmp_path):
    code, out, err = call("check_gymnasium.py", str(tmp_path))
    assert (code, out) == (2, "") and err.startswith(f"error: {tmp_path}: no checkout of Gymnasium")


def test_no_file_left_is_refused(call, checkout):
    code, _, err = call("check_gymnasium.py", str(checkout), "--only", "without")
    assert code == 2 and "leave no file" in err
