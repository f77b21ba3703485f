"""Shipped policies beside the usual controller of their task, on seeds none was trained on."""

import json
import subprocess
import sys

import numpy as np
import pytest
from ship_gym_agents import make_controller, pretrained, trained_for
from ship_gym_agents.controllers import shipped_file
from ship_gym_agents.pid import PID
from ship_gym_agents.policies.policy_file import load_policy, read_card
from ship_gym_agents.training.score import score_of

from ship_gym.config import ConfigError
from ship_gym.evaluation import evaluation_seeds, metrics, rollout
from ship_gym.evaluation.controller import ConstantController
from ship_gym.scenarios import load_scenario
from ship_gym.tasks import TASKS

NAIVE = "ppo_kcs"  # what two minutes of plain PPO reach: it chatters
SHIPPED = [name for name in pretrained() if name != NAIVE]


def means(controller, seeds, names, **env):
    found = [metrics(episode) for episode in rollout(controller, seeds=seeds, **env).episodes]
    return [np.mean([one[name] for one in found]) for name in names]


@pytest.mark.parametrize("name", pretrained())
def test_a_shipped_policy_is_small_and_says_where_it_comes_from(name):
    file = shipped_file(name)
    assert file.stat().st_size < 300_000
    policy, card = make_controller(name), read_card(file)
    assert policy.name == name and policy.card == card
    assert {"form", "network", "features", "decisions", "config", "git_commit"} <= set(card)
    assert card["versions"]["ship-gym"] and len(card["git_commit"]) >= 40
    assert name == NAIVE or card["command"].startswith("ship-gym train")
    load_scenario(trained_for(policy)["scenario"])  # keys that came later: default
    assert json.loads(json.dumps(card)) == load_policy(file).card


@pytest.mark.parametrize("name", SHIPPED)
def test_a_shipped_policy_is_beside_the_usual_controller_of_its_task(name):
    policy, seeds = make_controller(name), evaluation_seeds(16)
    env = trained_for(policy)
    score = score_of(load_scenario(env["scenario"]))  # as its training chose it
    assert score.better == "lower"
    asked = [score.name, "success"]
    free = score.name == "voyage_energy"
    other = "just_in_time" if free else TASKS[env["scenario"]["task"]].controllers[0]
    own, success = means(policy, seeds, asked, **env)
    usual, usual_success = means(make_controller(other), seeds, asked, **env)
    assert own < 1.1 * usual and success >= usual_success


@pytest.mark.parametrize("name", SHIPPED)
def test_a_shipped_policy_has_learned_something(name):
    """A run that found nothing keeps its base as the best policy."""
    network = make_controller(name).network
    assert max(np.abs(weight).max() for weight in network.weights) > 1e-3


def test_two_minutes_of_plain_ppo_come_within_ten_percent_of_the_pid():
    seeds, policy = evaluation_seeds(32), make_controller(NAIVE)
    J, travel = means(policy, seeds, ["J_0.1", "rudder_travel"])
    of_pid, travel_of_pid = means(PID(), seeds, ["J_0.1", "rudder_travel"])
    assert J < 1.10 * of_pid
    assert J < 0.1 * means(ConstantController(), seeds, ["J_0.1"])[0]
    assert travel > 2.0 * travel_of_pid, "if it no longer chatters, say so where it is named"
    card = policy.card
    found = trained_for(policy)
    assert (found["ship"], found["control"]) == ("kcs", "rudder") and trained_for(PID()) == {}
    assert load_scenario(found["scenario"]) == load_scenario()
    assert card["config"]["seed"] == 0 and card["seconds"] < 130.0
    assert "torch" in card["versions"]


def test_unknown_names_are_refused_with_the_nearest():
    with pytest.raises(ConfigError, match="did you mean 'ppo_kcs'"):
        make_controller("ppo_kc")


def test_a_policy_needs_no_library_of_learning():
    code = (
        "import sys\n"
        "from ship_gym_agents import make_controller\n"
        f"make_controller({NAIVE!r})\n"
        "heavy = {'torch', 'stable_baselines3', 'onnx', 'onnxruntime', 'matplotlib'}\n"
        "print(sorted(heavy & set(sys.modules)))\n"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"
