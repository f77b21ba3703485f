import numpy as np
import pytest
from ship_gym_agents.sb3.config import run_config

from ship_gym.config import ConfigError

pytest.importorskip("stable_baselines3")

import torch
from ship_gym_agents.sb3.algorithms import (
    ALGORITHMS,
    explore,
    export,
    load_checkpoint,
    make_model,
    save_checkpoint,
    warm_start,
)
from ship_gym_agents.sb3.environments import MirrorMeanStd, form_env, make_env
from ship_gym_agents.sb3.vec_adapter import ShipVecEnv

ON_POLICY = {"n_steps": 16, "batch_size": 64, "n_epochs": 2}
OFF_POLICY = {"learning_starts": 32, "buffer_size": 500}
OPTIONS = {"ppo": ON_POLICY, "recurrent_ppo": {**ON_POLICY, "lstm": 6}}
TRAINING = {"envs": 8, "episode": 20.0, "threads": 1}
RESIDUAL = {"action": "residual", "base": "pid", "scale": 0.3, "features": ["observer", "speed"]}
SYMMETRIC = [name for name in ALGORITHMS if name not in ("recurrent_ppo", "dqn")]
WITH_CRITIC = [name for name in ALGORITHMS if name != "dqn"]
LOUD = 0.3  # of random weights: decisions that are neither small nor all at their limits


@pytest.fixture(autouse=True, scope="module")
def one_thread():
    """Threads of torch that wait for a busy core make tiny networks very slow."""
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(before)


def tiny(algorithm="ppo", form=RESIDUAL, critic="same", scenario="heading_keeping", **given):
    sections = {
        "training": {**TRAINING, "critic": critic},
        "network": {"hidden": [8, 8]},
        "algorithm": OPTIONS.get(algorithm, OFF_POLICY),
        "form": form,
        "price": given.pop("price", {}),
    }
    given = {"overrides": {"duration": 20.0}, **given}
    return run_config(algorithm, scenario, hyperparameters=sections, **given)


def model_of(config, seed=0):
    env = make_env(config)
    env.seed(seed)
    return make_model(config.algorithm, env, config.hyperparameters, seed, lambda _: 1e-3)


def learned(config, samples=128, seed=0):
    """A model after a few updates, its weights then moved so that decisions differ."""
    model = model_of(config, seed)
    explore(model, config.hyperparameters.algorithm, 0.0)
    model.learn(samples)
    generator = torch.Generator().manual_seed(seed)
    with torch.no_grad():
        for parameter in model.policy.parameters():
            parameter.add_(LOUD * torch.randn(parameter.shape, generator=generator))
    return model


def policy_of(model, config):
    return export(model, config.algorithm, config.hyperparameters, {"name": "made"})


def observations_of(model, count=40):
    """Features as they might be, with what the critic sees behind."""
    env = model.get_vec_normalize_env()
    size = (count, env.observation_space.shape[0])
    return np.random.default_rng(0).normal(0.1, 0.5, size).astype(np.float32)


def decided(model, observations):
    """Deterministic decisions of a model, for observations before the normaliser."""
    env = model.get_vec_normalize_env()
    found, _ = model.predict(env.normalize_obs(observations), deterministic=True)
    choices = form_env(env).choices
    return found if choices is None else choices[found]


@pytest.mark.parametrize("algorithm", list(ALGORITHMS))
def test_exported_policy_decides_as_the_model(algorithm):
    critic = "privileged" if algorithm in WITH_CRITIC else "same"
    form = {**RESIDUAL, "symmetric": algorithm in SYMMETRIC, "lags": [2], "scale_rpm": 0.1}
    config = tiny(algorithm, form, critic, control="rudder+rpm")
    model = learned(config)
    policy, seen = policy_of(model, config), observations_of(model)
    features = seen[:, : form_env(model.get_env()).n_features].astype(np.float64)
    found, _ = policy.network.step(policy.normaliser(features), policy.network.start(len(seen)))
    expected = decided(model, seen)
    np.testing.assert_allclose(found, expected, atol=1e-5)
    assert found.shape == (40, 2) and np.std(found, axis=0).min() > 0.02
    assert policy.card["decisions"] == ["rudder", "rpm"] and len(policy.card["features"]) == 16


def test_exported_memory_is_that_of_the_model():
    config = tiny("recurrent_ppo")
    model = learned(config)
    policy, env = policy_of(model, config), model.get_vec_normalize_env()
    state, mine = None, policy.network.start(5)
    for k in range(6):
        seen = observations_of(model, 5) + 0.3 * k
        starts = np.array([k == 0, False, k == 3, False, False])
        mine[:, starts] = 0.0
        expected, state = model.predict(env.normalize_obs(seen), state, starts, deterministic=True)
        found, mine = policy.network.step(policy.normaliser(seen.astype(np.float64)), mine)
        np.testing.assert_allclose(found, expected, atol=1e-5)
    assert np.ptp(found) > 0.02


@pytest.mark.parametrize("algorithm", SYMMETRIC)
def test_mirrored_features_give_the_mirrored_decision(algorithm):
    form = {**RESIDUAL, "symmetric": True, "scale_rpm": 0.1}
    config = tiny(algorithm, form, "privileged", control="rudder+rpm")
    model = learned(config)
    part, seen = form_env(model.get_env()), observations_of(model)
    mirrored = seen.copy()
    mirrored[:, : part.n_features] *= part.helm.signs.astype(np.float32)
    decisions, others = decided(model, seen), decided(model, mirrored)
    assert part.helm.decision_signs.tolist() == [-1.0, 1.0]
    np.testing.assert_allclose(others, decisions * part.helm.decision_signs, atol=1e-6)
    assert np.std(decisions, axis=0).min() > 0.02 and np.abs(decisions[:, 0]).max() < 1.0


def test_without_symmetry_they_do_not():
    config = tiny("ppo")
    model = learned(config)
    seen = observations_of(model)
    mirrored = seen * form_env(model.get_env()).helm.signs.astype(np.float32)
    assert np.abs(decided(model, seen) + decided(model, mirrored)).max() > 0.02


@pytest.mark.parametrize("algorithm", WITH_CRITIC)
def test_privileged_columns_reach_the_critic_only(algorithm):
    model = learned(tiny(algorithm, critic="privileged"))
    n = form_env(model.get_env()).n_features
    seen = torch.as_tensor(observations_of(model, 6)).requires_grad_()
    for output, reaches in ((_actor, False), (_critic, True)):
        gradient = torch.autograd.grad(output(model, seen).sum(), seen)[0]
        assert gradient[:, :n].abs().max() > 1e-6
        assert (gradient[:, n:].abs().max() > 1e-6) == reaches


def _actor(model, seen):
    policy = model.policy
    if hasattr(policy, "lstm_actor"):
        found, _ = policy.get_distribution(seen, _memory(policy, len(seen)), torch.zeros(len(seen)))
        return found.mode()
    return policy.actor(seen) if hasattr(policy, "actor") else policy.get_distribution(seen).mode()


def _critic(model, seen):
    policy = model.policy
    if hasattr(policy, "lstm_critic"):
        return policy.predict_values(seen, _memory(policy, len(seen)), torch.zeros(len(seen)))
    if hasattr(policy, "actor"):
        found = policy.critic(seen, torch.zeros((len(seen), 1)))
        return found[0] if isinstance(found, tuple) else found
    return policy.predict_values(seen)


def _memory(policy, count):
    layers, _, size = policy.lstm_hidden_state_shape
    return torch.zeros(layers, count, size), torch.zeros(layers, count, size)


def test_the_normaliser_of_odd_features_has_no_mean():
    numbers = np.random.default_rng(0).normal(2.0, 3.0, (500, 2))
    mirrored = MirrorMeanStd(np.array([-1.0, 1.0]))
    for part in np.split(numbers, 5):
        mirrored.update(part)
    assert mirrored.mean[0] == 0.0 and mirrored.mean[1] == pytest.approx(
        numbers[:, 1].mean(), rel=1e-5
    )
    assert mirrored.var[0] == pytest.approx(np.mean(numbers[:, 0] ** 2), rel=1e-5)
    assert mirrored.var[1] == pytest.approx(numbers[:, 1].var(), rel=1e-5)


@pytest.mark.parametrize("algorithm", ["ppo", "recurrent_ppo"])
def test_the_exported_policy_sails_as_the_model_in_training(algorithm):
    config = tiny(algorithm, {**RESIDUAL, "every": 2, "lags": [1]})
    model = learned(config)
    policy, env = policy_of(model, config), model.get_vec_normalize_env()
    env.training = env.norm_reward = False
    form_env(env).venv.stagger = False
    env.seed(5)
    seen, state, start, total = env.reset(), None, np.ones(8, dtype=np.bool_), np.zeros(8)
    for _ in range(10):
        decisions, state = model.predict(seen, state, start, deterministic=True)
        seen, rewards, start, _ = env.step(decisions)
        total += rewards
    assert start.all()
    plain = ShipVecEnv(8, scenario=config.scenario)
    plain.seed(5)
    observations, expected = plain.reset(), np.zeros(8)
    policy.reset(8, plain.env.ship, config.scenario)
    for _ in range(20):
        observations, rewards, *_ = plain.step(policy.act(observations))
        expected += rewards
    np.testing.assert_allclose(total, expected, rtol=1e-4)


@pytest.mark.parametrize("algorithm", list(ALGORITHMS))
def test_a_run_may_begin_with_a_policy(algorithm):
    config = tiny(algorithm)
    policy = policy_of(learned(config), config)
    fresh = model_of(config, seed=1)
    warm_start(fresh, algorithm, config.hyperparameters, policy)
    features = np.random.default_rng(0).normal(0.0, 0.5, (20, policy.network.n_features))
    again = policy_of(fresh, config)
    for one, other in ((policy, again), (again, policy)):
        start = one.network.start(20), other.network.start(20)
        found, _ = one.network.step(one.normaliser(features), start[0])
        expected, _ = other.network.step(other.normaliser(features), start[1])
        np.testing.assert_allclose(found, expected, atol=1e-6)


def test_another_form_or_network_is_no_beginning():
    config = tiny("ppo")
    policy = policy_of(model_of(config), config)
    for other, word in (
        (tiny("ppo", {**RESIDUAL, "scale": 0.2}), "its form is"),
        (tiny("sac"), "its network is"),
    ):
        with pytest.raises(ConfigError, match=word):
            warm_start(model_of(other), other.algorithm, other.hyperparameters, policy)


def test_a_checkpoint_keeps_price_normaliser_and_weights(tmp_path):
    price = {"travel": 0.01, "limit": "base", "rate": 0.002}
    config = tiny("ppo", {**RESIDUAL, "symmetric": True}, price=price)
    model = learned(config)
    form_env(model.get_env()).price.travel_price = 0.7
    save_checkpoint(model, tmp_path, {"status": "running"})
    other = model_of(config, seed=1)
    assert load_checkpoint(other, tmp_path)["status"] == "running"
    mine, theirs = (form_env(m.get_env()).price.state() for m in (other, model))
    assert mine == theirs and mine["travel_price"] == 0.7 and mine["limit"] > 0.0
    seen = observations_of(model)
    np.testing.assert_array_equal(decided(model, seen), decided(other, seen))
    assert other.num_timesteps == 128


def test_what_changes_over_the_budget():
    model, config = model_of(tiny("dqn")), tiny("dqn")
    options = config.hyperparameters.algorithm
    for used, expected in ((0.0, 1.0), (0.15, 0.525), (0.3, 0.05), (1.0, 0.05)):
        explore(model, options, used)
        assert model.exploration_schedule(0.5) == pytest.approx(expected)
    model, options = model_of(tiny("ppo")), tiny("ppo").hyperparameters.algorithm
    explore(model, options, 0.5)
    middle = 0.5 * (options.log_std_init + options.log_std_final)
    np.testing.assert_allclose(model.policy.log_std.detach().numpy(), middle, rtol=1e-6)


def test_ships_overrides_and_a_linear_actor():
    settings = {
        "training.ships": ["kcs", "onrt"],
        "training.overrides.sea.states": ["ss6"],
        "network.hidden": [],
        "network.critic": [8],
    }
    config = tiny("ppo", {**RESIDUAL, "symmetric": True}, "privileged", settings=settings)
    model = learned(config)
    venv = form_env(model.get_env()).venv
    assert [ship.name for ship in venv.env.ships] == ["kcs", "onrt"] * 4
    assert venv.env.scenario.sea.states == ("ss6",) != config.scenario.sea.states
    policy, seen = policy_of(model, config), observations_of(model)
    assert len(policy.network.weights) == 1
    features = seen[:, : policy.network.n_features].astype(np.float64)
    found = policy.network(policy.normaliser(features))
    np.testing.assert_allclose(found, decided(model, seen), atol=1e-5)


@pytest.mark.parametrize("algorithm", ["ppo", "sac", "td3", "tqc"])
def test_an_untrained_residual_is_nearly_the_base(algorithm):
    model = model_of(tiny(algorithm))
    assert np.abs(decided(model, observations_of(model))).max() < 0.05
