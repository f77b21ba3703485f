"""Shipped policies against the PID on evaluation seeds, which none of them was trained on."""

import numpy as np
import pytest
from ship_gym_agents import make_controller, pretrained, trained_for
from ship_gym_agents.pid import PID

from ship_gym.config import ConfigError
from ship_gym.evaluation import evaluation_seeds, metrics, rollout
from ship_gym.evaluation.controller import ConstantController
from ship_gym.scenarios import load_scenario


def mean_cost(controller, seeds):
    return np.mean([metrics(e)["J_0.1"] for e in rollout(controller, seeds=seeds).episodes])


@pytest.mark.parametrize("name", pretrained())
def test_two_minutes_of_training_come_within_ten_percent_of_the_pid(name):
    seeds = evaluation_seeds(32)
    policy = make_controller(name)
    J = mean_cost(policy, seeds)
    assert J < 1.10 * mean_cost(PID(), seeds)
    assert J < 0.1 * mean_cost(ConstantController(), seeds)
    card = policy.card
    assert policy.name == name
    found = trained_for(policy)
    assert (found["ship"], found["control"]) == ("kcs", "rudder") and trained_for(PID()) == {}
    assert load_scenario(found["scenario"]) == load_scenario()  # keys that came later: default
    assert card["config"]["seed"] == 0 and card["seconds"] < 130.0
    assert "torch" in card["versions"] and len(card["git_commit"]) >= 40


def test_unknown_names_are_refused_with_the_nearest():
    with pytest.raises(ConfigError, match="did you mean 'ppo_kcs'"):
        make_controller("ppo_kc")
