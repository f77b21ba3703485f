"""The examples of docs/examples run as they stand."""

import importlib.util
import json
import math
import runpy
import sys
from pathlib import Path

import pytest

torch = pytest.importorskip("torch")
pytestmark = pytest.mark.compiled
EXAMPLES = Path(__file__).resolve().parents[2] / "docs" / "examples"
NEEDS = {
    "torchrl_env": "torchrl",
    "torchrl_gym": "torchrl",
    "ppo_rllib": "tree",
    "ppo_skrl": "skrl",
    "ppo_tianshou": "tianshou",
    "ppo_torchrl": "torchrl",
    "clone_pid": "minari",
}  # tree: dm-tree


@pytest.fixture
def example(monkeypatch, tmp_path, capsys):
    """Run an example in this process, in an empty folder: exit code, stdout, stderr."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(EXAMPLES))

    def call(name, *arguments):
        pytest.importorskip(NEEDS.get(name, "torch"))
        monkeypatch.setattr(sys, "argv", [f"{name}.py", *map(str, arguments)])
        code = 0
        try:
            runpy.run_path(str(EXAMPLES / f"{name}.py"), run_name="__main__")
        except SystemExit as end:
            code = end.code or 0
        return code, *capsys.readouterr()

    return call


def judged_metrics(result, name):
    """Every metric has a value of both controllers, or says that there is none."""
    metrics = result["judged"]["metrics"]
    assert set(metrics) == {"J_steady", "rudder_travel", "success"}
    for row in metrics.values():
        assert {"unit", "pid", name, "difference"} <= set(row)
        assert row["pid"] is None or math.isfinite(row["pid"])
    return metrics


def test_ppo(example):
    code, out, err = example(
        "ppo_torch", "--envs", 8, "--iterations", 2, "--episode", 50, "--judge", 2, "--json"
    )
    assert code == 0, err
    result = json.loads(out)
    assert result["samples"] == 2 * 64 * 8 and result["return_last"] < 0.0
    assert torch.load(result["out"])["actor.0.weight"].shape == (64, 9)
    judged_metrics(result, "ppo")


def test_the_end_of_an_episode_is_seen(monkeypatch):
    """Where an episode has ended, `final_obs` is its end and what is seen the next one's start."""
    monkeypatch.syspath_prepend(str(EXAMPLES))
    made = runpy.run_path(str(EXAMPLES / "ppo_torch.py"))
    env = made["VectorEnv"]("ShipGym/HeadingKeeping-v0", 2, overrides={"duration": 3.0})
    start, _ = env.reset(seed=0)
    start = start.clone()
    for _ in range(2):
        before, *_, info = env.step(torch.ones(2, 1))
        assert info == {}
    seen, rewards, terminated, truncated, info = env.step(torch.ones(2, 1))
    assert truncated.all() and not terminated.any() and rewards.shape == (2,)
    assert torch.allclose(info["final_obs"], before, atol=0.2)
    assert not torch.allclose(seen, info["final_obs"], atol=0.2)


@pytest.mark.slow
def test_ppo_learns(example):
    """Two minutes of training steer; ten seconds are enough to see that it learns."""
    code, out, err = example("ppo_torch", "--envs", 64, "--iterations", 30, "--json")
    assert code == 0, err
    result = json.loads(out)
    assert result["return_last"] > 0.6 * result["return_first"]  # both are negative


def test_ppo_refuses_what_is_none(example):
    code, out, err = example("ppo_torch", "--env", "ShipGym/HeadingKeepin-v0")
    assert (code, out) == (2, "") and "did you mean 'ShipGym/HeadingKeeping-v0'" in err


@pytest.mark.skipif(torch.cuda.is_available(), reason="there is a card")
def test_ppo_without_a_card(example):
    code, _, err = example("ppo_torch", "--device", "cuda")
    assert code == 2
    assert err.startswith("error: device = 'cuda'") and err.count("\n") == 1


def test_cloning(example, tmp_path):
    """A clone of few episodes stays on the heading; its set is read again, not sailed again."""
    pytest.importorskip("minari")
    from ship_gym_agents.datasets import load_set

    options = ["--episodes", 6, "--noise", 0, 0.1, "--epochs", 12, "--judge", 3]
    options += ["--datasets", "sets", "--json"]
    code, out, err = example("clone_pid", *options)
    assert code == 0, err
    result = json.loads(out)
    assert result["samples"] == 12 * 600
    assert result["rms_error_held_out"] < 0.1
    metrics = judged_metrics(result, "clone")
    assert metrics["success"]["clone"] == 1.0 and metrics["J_steady"]["clone"] < 20.0
    name = "ShipGym/HeadingKeeping/pid-kcs-6-0-0_1-v0"
    dataset = load_set(name, "sets")
    assert dataset[0].observations.shape == (601, 9) and dataset[0].truncations[-1]
    assert dataset.recover_environment().unwrapped.ship.name == "kcs"
    written = (tmp_path / "sets" / name / "card.json").stat().st_mtime_ns
    code, again, err = example("clone_pid", *options)
    assert code == 0, err
    assert (tmp_path / "sets" / name / "card.json").stat().st_mtime_ns == written
    timed = ("seconds",)
    assert {k: v for k, v in json.loads(again).items() if k not in timed} == {
        k: v for k, v in result.items() if k not in timed
    }


@pytest.mark.slow
@pytest.mark.skipif(not importlib.util.find_spec("ray"), reason="ray is not installed")
def test_rllib(example):
    code, out, err = example("ppo_rllib", "--envs", 8, "--judge", 2, "--json")
    assert code == 0, err
    result = json.loads(out[out.index("{") :])
    assert result["samples"] == 8 * 32
    judged_metrics(result, "rllib")


@pytest.mark.parametrize("name", ["skrl", "tianshou", "torchrl"])
def test_ppo_of_other_libraries(example, name):
    options = ["--envs", 8, "--iterations", 2, "--episode", 50, "--judge", 2, "--json"]
    code, out, err = example(f"ppo_{name}", *options)
    assert code == 0, err
    result = json.loads(out[out.index("{") :])
    assert result["samples"] == 2 * 64 * 8
    judged_metrics(result, name)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["skrl", "tianshou", "torchrl"])
def test_ppo_of_other_libraries_learns(example, name):
    """100 iterations come near the PID; these see at least that the ship is steered at all."""
    code, out, err = example(f"ppo_{name}", "--iterations", 60, "--judge", 8, "--json")
    assert code == 0, err
    metrics = judged_metrics(json.loads(out[out.index("{") :]), name)
    assert metrics["success"][name] > 0.5


def test_options_of_ppo_are_checked(example):
    code, out, err = example("ppo_skrl", "--envs", 0)
    assert (code, out) == (2, "") and err.startswith("error: envs = 0")


@pytest.mark.slow
def test_torchrl(example):
    code, out, err = example("torchrl_env", "--envs", 4, "--steps", 10, "--json")
    assert code == 0, err
    assert json.loads(out[out.index("{") :])["shape"] == [4, 10]


@pytest.mark.slow
@pytest.mark.parametrize("mode", ["SameStep", "Disabled"])
def test_torchrl_over_the_vector_environment(example, mode):
    code, out, err = example(
        "torchrl_gym", "--envs", 4, "--steps", 10, "--autoreset", mode, "--json"
    )
    assert code == 0, err
    result = json.loads(out[out.index("{") :])
    assert result["shape"] == [4, 10] and result["mean_power"] > 0.0


@pytest.mark.parametrize(
    "name",
    [
        "ppo_torch",
        "clone_pid",
        "ppo_rllib",
        "ppo_skrl",
        "ppo_tianshou",
        "ppo_torchrl",
        "torchrl_env",
        "torchrl_gym",
    ],
)
def test_help_has_two_examples(example, name):
    code, out, _ = example(name, "--help")
    assert code == 0 and out.count("python docs/examples/") == 2
