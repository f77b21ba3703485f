import json
import shutil

import numpy as np
import pytest
from ship_gym_agents.policies.policy_file import load_policy
from ship_gym_agents.sb3.config import run_config
from ship_gym_agents.training.candidates import Voyages
from ship_gym_agents.training.train import train

from ship_gym.config import ConfigError
from ship_gym.evaluation.metrics import metrics
from ship_gym.evaluation.rollout import rollout

FORM = {"action": "residual", "base": "pid", "scale": 0.3, "symmetric": True}
OPTIONS = {"episodes": 6, "iterations": 2, "relative": False, "ridge": 0.0, "price": 0.0}


def config_of(features=("observer",), hidden=(), **options):
    hyper = {
        "form": {**FORM, "features": list(features)},
        "network": {"hidden": list(hidden)},
        "training": {"episode": 0.0, "validations": 2},
        "algorithm": {**OPTIONS, **options},
    }
    overrides = {"duration": 120.0}
    return run_config("Gauss-Newton", overrides=overrides, hyperparameters=hyper)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A run of two iterations: config, folder, card."""
    out = tmp_path_factory.mktemp("runs") / "tiny"
    config = config_of()
    return config, out, train(config, out, steps=10**9, final=False)


def last_state(out):
    (folder,) = (out / "checkpoint").glob("0*")
    with np.load(folder / "gauss_newton.npz") as state:
        return dict(state)


def cost_of(policy, config):
    """J of the training episodes, sailed by the evaluation."""
    seeds = Voyages(config).seeds
    sailed = rollout(policy, config.scenario, seeds=seeds, parallel=False)
    return np.mean([metrics(episode)["J_0.1"] for episode in sailed.episodes])


def test_finished_policy_costs_what_the_search_says_and_less_than_its_base(made):
    config, out, card = made
    told = [v for v in card["validations"] if "cost" in v]
    state = last_state(out)
    assert state["counts"][0] == 2
    policy = load_policy(out)
    assert told[-1]["iteration"] == 2.0
    policy.network = type(policy.network)(
        (state["vector"][None],), (np.zeros(1),), output="tanh", mirror=policy.network.mirror
    )
    assert cost_of(policy, config) == pytest.approx(told[-1]["cost"], rel=1e-5)
    base = cost_of(zeroed(policy), config)
    assert told[-1]["cost"] < base * (1.0 - 1e-3)


def zeroed(policy):
    """The same policy with a decision that is always zero: its base."""
    shape = policy.network.weights[0].shape
    policy.network = type(policy.network)(
        (np.zeros(shape),), (np.zeros(1),), output="tanh", mirror=policy.network.mirror
    )
    return policy


def test_folder_card_and_file(made):
    _, out, card = made
    assert json.loads((out / "card.json").read_text()) == card
    assert card["status"] == "complete" and card["samples"] > 0
    assert card["name"].startswith("gauss_newton")
    policy = load_policy(out)
    assert policy.card["features"][0].startswith("observer.")
    assert policy.network.about()["symmetric"] and policy.network.output == "tanh"
    assert policy.card["best"] == card["best"]


def test_run_that_broke_off_goes_on_where_it_was(made, tmp_path):
    _, whole, card = made
    first = config_of(iterations=2)
    out = tmp_path / "run"

    def stop(share, score):
        raise KeyboardInterrupt

    per_iteration = card["samples"] // 3
    with pytest.raises(KeyboardInterrupt):
        train(first, out, steps=3 * per_iteration, report=stop, final=False)
    assert json.loads((out / "card.json").read_text())["status"] == "interrupted"
    before = last_state(out)
    assert before["counts"][0] == 1
    found = train(first, out, steps=10**9, resume=True, final=False)
    assert found["status"] == "complete"
    assert found["samples"] > before["counts"][2]
    np.testing.assert_allclose(last_state(out)["vector"], last_state(whole)["vector"], atol=1e-6)


def test_budget_that_ends_in_an_iteration_leaves_it_out(made, tmp_path):
    config, _, card = made
    out = tmp_path / "run"
    found = train(config, out, steps=card["samples"] // 8, final=False)
    assert found["status"] == "complete"
    assert last_state(out)["counts"][0] == 0 and np.all(last_state(out)["vector"] == 0.0)


def test_run_can_begin_with_a_policy(made, tmp_path):
    _, whole, _ = made
    out = tmp_path / "run"
    train(config_of(iterations=1), out, steps=1, init=whole, final=False)
    np.testing.assert_allclose(
        last_state(out)["vector"], load_policy(whole).network.weights[0][0], atol=1e-6
    )
    with pytest.raises(ConfigError, match="this run has another form"):
        train(config_of(("observer", "soft")), tmp_path / "other", steps=1, init=whole)


def test_episodes_can_count_by_what_they_cost_at_first(tmp_path):
    config = config_of(relative=True, iterations=1)
    train(config, tmp_path / "run", steps=10**9, final=False)
    weights = last_state(tmp_path / "run")["weights"]
    assert weights.max() > 1.5 * weights.min() and np.all(weights > 0.0)
    halved = config_of(relative=True, relative_power=0.5, iterations=1)
    train(halved, tmp_path / "halved", steps=10**9, final=False)
    roots = last_state(tmp_path / "halved")["weights"]
    np.testing.assert_allclose(roots / roots[0], np.sqrt(weights / weights[0]), rtol=1e-6)


def test_policies_are_chosen_with_the_price_of_the_cost(tmp_path):
    config = config_of(price=0.6, iterations=1)
    card = train(config, tmp_path / "run", steps=10**9, final=False)
    assert "+ 0.000167 rudder travel [deg/h]" in card["score"]


def test_hidden_layer_learns_too(tmp_path):
    train(config_of(hidden=[2], iterations=1), tmp_path / "run", steps=10**9, final=False)
    state = last_state(tmp_path / "run")
    assert state["counts"][0] == 1 and len(state["vector"]) == 6 * 2 + 2 + 2 + 1


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("vector", np.zeros(1), "vector has shape (1,)"),
        ("damping", np.array(np.nan), "damping[] = nan: allowed"),
        ("scale", None, "no array 'scale'"),
        ("limit", np.array("ten"), "limit is of type"),
        ("counts", np.array([-1, 0, 0]), "counts[0] = -1: allowed"),
        ("weights", np.full(3, object()), "not a state of Gauss-Newton, or damaged"),
    ],
)
def test_a_damaged_state_is_one_line(made, tmp_path, name, value, words):
    config, whole, _ = made
    out = shutil.copytree(whole, tmp_path / "run")
    (file,) = out.rglob("gauss_newton.npz")
    state = dict(np.load(file)) | {name: value}
    np.savez(file, **{k: v for k, v in state.items() if v is not None})
    with pytest.raises(ConfigError) as error:
        train(config, out, steps=10**9, resume=True, final=False)
    assert words in str(error.value) and "gauss_newton.npz" in str(error.value)
