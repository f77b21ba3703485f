"""ship-gym export: policies for other programs, and from older kinds of files."""

import io
import json
import zipfile

import numpy as np
import pytest
from ship_gym_agents import make_controller
from ship_gym_agents.policies.policy_file import load_policy

from ship_gym.scenarios import load_scenario
from ship_gym.ships import load_ship


def test_a_shipped_policy_as_onnx(cli, tmp_path):
    pytest.importorskip("onnxruntime")
    code, out, _ = cli("export", "ppo_kcs", "--out", "a/policy.onnx", "--json")
    found = json.loads(out)
    assert code == 0 and found["largest_difference"] < 1e-5
    assert (tmp_path / "a" / "policy.onnx").stat().st_size == found["bytes"]
    code, out, _ = cli("export", "ppo_kcs")
    assert code == 0 and "wrote runs/ppo_kcs.onnx" in out and "differ by at most" in out


def old_file(path):
    """The shipped policy as version 0.1 wrote it."""
    policy = make_controller("ppo_kcs")
    observations = [name.partition(".")[2] for name in policy.card["features"]]
    network = {"layers": 3, "activation": "tanh", "output": "clip"}
    card = {**policy.card, "format": 1, "network": network, "observations": observations}
    scaling = {name: getattr(policy.normaliser, name) for name in ("mean", "scale", "limit")}
    arrays = {"actor.npz": policy.network.tensors(), "normaliser.npz": scaling}
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("card.json", json.dumps(card))
        for name, held in arrays.items():
            data = io.BytesIO()
            np.savez(data, **held)
            archive.writestr(name, data.getvalue())
    return policy


def test_a_policy_of_version_0_1_is_converted(cli, tmp_path):
    policy = old_file(tmp_path / "policy.zip")
    code, _, err = cli("evaluate", "--policy", "policy.zip")
    assert code == 2 and err.count("\n") == 1
    asked = err.split("convert it: ship-gym ")[1].split()
    code, out, _ = cli(*asked)
    assert code == 0 and "next: ship-gym evaluate --policy policy.safetensors" in out
    again = load_policy(tmp_path / "policy.safetensors")
    seen = np.random.default_rng(0).normal(0.0, 0.5, (5, 9))
    for one in (policy, again):
        one.reset(5, load_ship("kcs"), load_scenario())
    np.testing.assert_array_equal(policy.act(seen), again.act(seen))


def test_a_model_of_stable_baselines3_needs_trust(cli, tmp_path):
    sb3 = pytest.importorskip("stable_baselines3")
    import gymnasium

    env = gymnasium.make("ShipGym/HeadingKeeping-v0")
    sb3.PPO("MlpPolicy", env, policy_kwargs={"net_arch": [4]}).save(tmp_path / "model.zip")
    code, _, err = cli("evaluate", "--policy", "model.zip")
    assert code == 2 and "runs code which the file may hold" in err and err.count("\n") == 1
    code, _, err = cli("export", "model.zip", "--to", "safetensors")
    assert code == 2 and "--trust-sb3-zip" in err and not (tmp_path / "model.safetensors").exists()
    asked = err.split("convert it: ship-gym ")[1].split()
    code, out, err = cli(*asked)
    assert code == 0, err
    code, out, _ = cli("evaluate", "--policy", "model.safetensors", "--episodes", 1, "--json")
    assert code == 0 and next(iter(json.loads(out)["controllers"])) == "model"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["ppo_kc"], "did you mean 'ppo_kcs'"),
        (["pid"], "not a policy"),
        (["ppo_kcs", "--out", "policy.zip"], "allowed is a .onnx file"),
        (["ppo_kcs", "--to", "torch"], "torch"),
        (["nowhere.safetensors"], "no such policy"),
        (["nowhere.zip", "--trust-sb3-zip"], "not a model of stable-baselines3"),
    ],
)
def test_errors_are_one_line_and_leave_nothing(cli, tmp_path, arguments, words):
    if "--trust-sb3-zip" in arguments:
        pytest.importorskip("stable_baselines3")
    code, out, err = cli("export", *arguments)
    assert (code, out) == (2, "") and words in err and err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_policy_is_not_written_over_itself(cli, tmp_path):
    cli("export", "ppo_kcs", "--to", "safetensors", "--out", "run/policy.safetensors")
    for given in ("run", "run/policy.safetensors"):
        code, _, err = cli("export", given, "--to", "safetensors")
        assert code == 2 and "that is the policy itself" in err
    code, out, _ = cli("export", "run")
    assert code == 0 and "wrote run/policy.onnx" in out
