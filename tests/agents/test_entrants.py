"""Controllers of a benchmark: what they say of themselves, and policies of one name."""

import pytest
from ship_gym_agents import make_controller
from ship_gym_agents.entrants import controllers_of, distinct, entrant
from ship_gym_agents.forms.form import Form
from ship_gym_agents.policies.policy_file import POLICY_FILE, save_policy

from ship_gym.config import ConfigError
from ship_gym.provenance import sha256


@pytest.fixture
def run(tmp_path, monkeypatch):
    """A run of two seeds, and another policy beside it."""
    monkeypatch.chdir(tmp_path)
    policy = make_controller("ppo_kcs")
    for folder in ("run", "run/seed_0", "run/seed_1"):
        save_policy(policy, tmp_path / folder / POLICY_FILE)
    policy.card["name"] = "other"
    save_policy(policy, tmp_path / "other.safetensors")
    return tmp_path


def test_policies_of_one_name_go_by_their_paths(run):
    named = ["run", "run/seed_0/", "other.safetensors", "pid", "ppo_kcs", "pid@kcs"]
    assert distinct(named) == {"run": "run", "run/seed_0/": "run/seed_0"}
    names = [controller.name for controller in controllers_of(named)]
    assert names == ["run", "run/seed_0", "other", "pid", "ppo_kcs", "pid@kcs"]
    assert distinct(["run", "pid"]) == {}


def test_other_controllers_of_one_name_are_refused():
    with pytest.raises(ConfigError, match="two controllers are named 'pid'"):
        controllers_of(["pid", "pid"])
    with pytest.raises(ConfigError, match="nothing to sail"):
        controllers_of([])
    with pytest.raises(ConfigError, match="did you mean 'pid'"):
        controllers_of(["pit"])


def test_an_entrant_tells_form_seed_and_sha(run):
    one = entrant("run", "run/median")
    assert (one.name, one.kind, one.about["file"]) == ("run/median", "policy", POLICY_FILE)
    assert one.about["sha256"] == sha256(run / "run" / POLICY_FILE)
    assert one.about["form"] == "direct, sees observation"
    assert one.about["network"] == "mlp 64 x 64, tanh, clip" and one.about["seed"] == 0
    assert one.about["trained"]["task"] == "heading_keeping" and "seed" not in one.about["trained"]
    assert one.make().card["config"]["seed"] == 0


def test_an_entrant_tells_the_gains_of_the_autopilot_it_steers_by(run):
    policy = make_controller("ppo_kcs")
    policy.form = Form("residual", "pid@kcs", 0.1)
    save_policy(policy, "residual.safetensors")
    about = entrant("residual.safetensors").about
    assert "pid_kcs.toml" in about["gains_files"] and about["form"].startswith(
        "residual on pid@kcs"
    )


def test_a_shipped_policy_tells_its_file():
    one = entrant("ppo_kcs")
    assert one.about["file"] == "ppo_kcs.safetensors" and one.kind == "policy"
