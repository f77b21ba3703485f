"""Policies as controllers: intervals, memory, and what they refuse to steer."""

import dataclasses

import numpy as np
import pytest
from ship_gym_agents.forms.form import Form
from ship_gym_agents.pid import PID
from ship_gym_agents.policies.policy import Policy

from ship_gym.config import ConfigError
from ship_gym.evaluation.controller import Controller
from ship_gym.scenarios import load_scenario
from ship_gym.ships import load_ship

from .conftest import COLUMNS, FEATURES, KINDS, begun, observations, random_policy, sailed


@pytest.mark.parametrize("kind", KINDS)
def test_an_episode_is_the_same_in_a_batch_of_any_size(kind):
    policy = random_policy(kind)
    assert isinstance(policy, Controller)
    seen = observations(37, 6)
    together = sailed(policy, seen)
    assert together.shape == (6, 37, 1) and np.abs(together).max() <= 1.0
    for k in range(37):
        np.testing.assert_array_equal(sailed(policy, seen[:, [k]])[:, 0], together[:, k])


def test_reset_forgets(policy):
    seen = observations()
    np.testing.assert_array_equal(sailed(policy, seen), sailed(policy, seen))


def test_a_decision_is_held():
    policy = random_policy("linear", Form(every=3))
    every, seen = random_policy("linear"), observations(2, 7)
    held, free = sailed(policy, seen), sailed(every, seen)
    for k in range(7):
        np.testing.assert_array_equal(held[k], free[k - k % 3])


def test_rows_that_restart_remember_nothing():
    policy, seen = random_policy("lstm"), observations(3, 8)
    begun(policy, 3)
    for row in seen[:4]:
        policy.act(row)
    policy.restart(np.array([1]))
    found = np.stack([policy.act(row) for row in seen[4:]])
    fresh, old = sailed(random_policy("lstm"), seen[4:]), sailed(random_policy("lstm"), seen)[4:]
    np.testing.assert_allclose(found[:, 1], fresh[:, 1], atol=1e-15)
    np.testing.assert_allclose(found[:, [0, 2]], old[:, [0, 2]], atol=1e-15)
    assert np.abs(old[:, 1] - fresh[:, 1]).max() > 1e-3


def test_what_it_says_of_itself():
    about = random_policy("lstm", Form(every=2)).about()
    assert about["form"] == "direct every 2 intervals, sees observation"
    assert about["network"] == "lstm 5, mlp 4, tanh, clip" and "seed" not in about
    assert random_policy("linear").network.in_words == "linear, clip"
    assert random_policy("symmetric").network.in_words == "mlp 8, tanh, clip, symmetric"


def other(policy, **card):
    return Policy(policy.form, policy.normaliser, policy.network, {**policy.card, **card})


def test_other_scenarios_are_refused():
    policy = random_policy("linear")
    both = load_scenario(overrides={"control": "rudder+rpm"})
    with pytest.raises(ConfigError, match=r"for control = 'rudder\+rpm': rpm new"):
        begun(policy, scenario=both)
    trained = other(policy, config={"scenario": {"task": "heading_keeping", "control": "rudder"}})
    with pytest.raises(ConfigError, match=r"trained for control = 'rudder', not 'rudder\+rpm'"):
        begun(trained, scenario=both)
    with pytest.raises(ConfigError, match="trained on 'heading_keeping', not 'track"):
        begun(trained, scenario=load_scenario("track_following"))


def test_a_ship_without_gains_of_the_base_is_refused():
    policy = begun(random_policy("linear", Form("residual", "pid", 0.2)))
    ship = dataclasses.replace(load_ship("kcs"), name="mine")
    with pytest.raises(ConfigError, match=r"policy tiny-linear: no pid gains for ship 'mine'"):
        policy.reset(1, ship, load_scenario())


def test_a_residual_adds_its_share_to_the_rudder_of_the_base():
    seen = 0.02 * observations()
    seen[..., COLUMNS.index("cos_error")] = 1.0
    both = sailed(random_policy("symmetric", Form("residual", "pid", 0.2)), seen)
    base, own = sailed(PID(), seen), sailed(random_policy("symmetric"), seen)
    inside = (np.abs(both) < 1.0) & (np.abs(base) < 1.0)
    assert inside.mean() > 0.5 and np.abs(own).max() > 0.01
    np.testing.assert_allclose((both - base)[inside], 0.2 * own[inside], atol=1e-12)


def test_other_features_than_this_version_makes_are_refused():
    policy = random_policy("linear")
    renamed = other(policy, features=["sine", *FEATURES[1:]])
    with pytest.raises(ConfigError, match=r"made for other features .* sine missing"):
        begun(renamed)
    with pytest.raises(ConfigError, match="another order"):
        begun(other(policy, features=FEATURES[::-1]))


def test_parts_that_do_not_fit_are_refused():
    policy = random_policy("linear")
    with pytest.raises(ConfigError, match="8 features, a normaliser of 9"):
        other(policy, features=FEATURES[:8])
    with pytest.raises(ConfigError, match="2 decisions and a network of 1"):
        other(policy, decisions=["rudder", "rpm"])


def test_without_names_the_first_reset_sets_them():
    policy = random_policy("linear")
    policy.card.pop("features"), policy.card.pop("decisions")
    begun(policy)
    assert policy.card["features"] == FEATURES and policy.card["decisions"] == ["rudder"]
