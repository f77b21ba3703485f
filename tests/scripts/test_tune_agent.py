"""``ship-gym tune-agent``: what is refused at once, and what a search with the formula says."""

import json

import pytest
from ship_gym_agents.sb3.config import run_config
from ship_gym_agents.training import agent_search, search_confirm
from ship_gym_agents.training.score import Validation

pytest.importorskip("optuna")
pytest.importorskip("stable_baselines3")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--algo", "pppo"], "did you mean 'ppo'"),
        (["--pruner", "medium"], "did you mean 'median'"),
        (["--ranges", "no.toml"], "no.toml"),
        (["--set", "training.gama=0.9"], "did you mean 'gamma'"),
        (["--engine", "rey"], "did you mean 'ray'"),
        (["--trials", "0"], "--trials = 0: allowed is 1 to 100000"),
        (["--address", "auto"], "only the engine 'ray' has one"),
    ],
)
def test_what_cannot_be_searched_is_refused(cli, arguments, words):
    code, out, err = cli("tune-agent", *arguments)
    assert (code, out, err.count("\n")) == (2, "", 1) and words in err


def test_a_search_ends_with_the_command_that_trains(cli, monkeypatch, tmp_path):
    """Options that all trials share are in best.toml, those of the scenario in the command."""

    def trained(plan, given, folder, judging, report=None):
        rate = run_config(**given).hyperparameters.training.learning_rate
        value = 1.0 + 100.0 * rate
        means = {"J_steady": value, "success": 1.0, "rudder_travel": 900.0}
        return Validation(means, {"J_steady": [value] * len(judging)}, 0.0)

    monkeypatch.setattr(agent_search, "trained", trained)
    monkeypatch.setattr(search_confirm, "trained", trained)
    (tmp_path / "r.toml").write_text("[training]\nlearning_rate = { choices = [5e-4, 1e-4] }\n")
    options = [
        "--algo",
        "PPO",
        "--ship",
        "kvlcc2",
        "--set",
        "training.gamma=0.98",
        "sea.gusts=false",
    ]
    options += ["--ranges", "r.toml", "--trials", 4, "--confirm", 1, "--episodes", 3, "--out", "o"]
    code, out, err = cli("tune-agent", *options)
    assert code == 0, err
    assert err.count("\n") == 4 and "trial 0 complete: 1.05 deg2" in err
    assert "J_steady 1.01 against 1.05 deg2" in out and ": better (" in out
    last = out.rstrip().splitlines()[-1]
    assert last.startswith("next: ship-gym train --ship kvlcc2 --algo PPO --hyperparameters o/best")
    assert "--set sea.gusts=false" in last
    best = (tmp_path / "o" / "best.toml").read_text()
    assert "gamma = 0.98" in best and "learning_rate = 0.0001" in best
    code, out, err = cli("tune-agent", *options, "--resume", "--json")
    assert code == 0, err
    assert json.loads(out)["confirmed"]["verdict"] == "better"
    code, _, err = cli("tune-agent", *options)
    assert code == 2 and "holds a search; resume it" in err
