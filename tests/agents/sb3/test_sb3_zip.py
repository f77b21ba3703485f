"""Models that stable-baselines3 saved: read only when trusted, and then with the same actions."""

import pickle
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest
from ship_gym_agents.policies.policy_file import load_policy, save_policy

from ship_gym.config import ConfigError
from ship_gym.scenarios import load_scenario
from ship_gym.ships import load_ship

pytest.importorskip("stable_baselines3")

import torch
from ship_gym_agents.sb3.sb3_zip import NORMALISER, load_sb3_zip
from stable_baselines3 import DQN, PPO, SAC, TD3
from stable_baselines3.common.vec_env import DummyVecEnv, VecNormalize

SMALL = {"net_arch": [8, 6]}


@pytest.fixture(autouse=True, scope="module")
def one_thread():
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(before)


def environment(**options):
    return DummyVecEnv([lambda: gym.make("ShipGym/HeadingKeeping-v0", **options)])


def saved(path, algorithm, env=None, **kwargs):
    """An untrained model, saved; its weights are random."""
    model = algorithm("MlpPolicy", env or environment(), policy_kwargs=SMALL | kwargs, seed=1)
    model.save(path)
    return model


@pytest.mark.parametrize("algorithm", [PPO, SAC, TD3])
@pytest.mark.parametrize("normalised", [False, True])
def test_a_trusted_model_acts_as_in_stable_baselines3(tmp_path, algorithm, normalised):
    env = environment()
    if normalised:
        env = VecNormalize(env, clip_obs=2.0)
        env.reset()
        for _ in range(5):
            env.step(np.zeros((1, 1)))
        env.save(tmp_path / NORMALISER)
    model = saved(tmp_path / "model.zip", algorithm, env)
    policy = load_sb3_zip(tmp_path / "model.zip", trust=True)
    seen = np.random.default_rng(0).normal(0.0, 0.5, (20, 9)).astype(np.float32)
    wanted, _ = model.predict(env.normalize_obs(seen) if normalised else seen, deterministic=True)
    policy.reset(20, load_ship("kcs"), load_scenario())
    np.testing.assert_allclose(policy.act(seen), wanted, atol=2e-6)
    assert np.ptp(wanted) > 1e-3
    save_policy(policy, tmp_path / "policy.safetensors")
    again = load_policy(tmp_path / "policy.safetensors")
    assert again.name == "model" and again.card["source"]["kind"] == "stable-baselines3 zip"
    assert again.card["config"]["algorithm"] == algorithm.__name__.lower()


def test_nothing_is_read_without_trust(tmp_path, monkeypatch):
    saved(tmp_path / "model.zip", PPO)
    monkeypatch.setattr(PPO, "load", lambda *_, **__: pytest.fail("it was read"))
    for trust in (False, "yes", 1):
        with pytest.raises(ConfigError, match=r"runs code .* --trust-sb3-zip"):
            load_sb3_zip(tmp_path / "model.zip", trust=trust)


def test_the_activation_is_kept(tmp_path):
    saved(tmp_path / "model.zip", PPO, activation_fn=torch.nn.ReLU)
    assert load_sb3_zip(tmp_path / "model.zip", trust=True).network.activation == "relu"


def test_what_cannot_be_a_policy_is_refused(tmp_path):
    path = tmp_path / "model.zip"
    path.write_bytes(b"no zip")
    with pytest.raises(ConfigError, match="not a model of stable-baselines3"):
        load_sb3_zip(path, trust=True)
    DQN("MlpPolicy", gym.make("CartPole-v1"), policy_kwargs=SMALL).save(path)
    with pytest.raises(ConfigError, match="allowed are models of PPO, SAC and TD3"):
        load_sb3_zip(path, trust=True)
    saved(path, PPO, environment(control="rudder+rpm"))
    with pytest.raises(ConfigError, match=r"actions \(2,\); the scenario has \(9,\) and \(1,\)"):
        load_sb3_zip(path, trust=True)
    assert load_sb3_zip(path, trust=True, control="rudder+rpm").card["decisions"][1] == "rpm"
    saved(path, PPO, activation_fn=torch.nn.ELU)
    with pytest.raises(ConfigError, match="perceptrons with tanh or relu"):
        load_sb3_zip(path, trust=True)


def test_a_recurrent_model_is_refused(tmp_path):
    contrib = pytest.importorskip("sb3_contrib")
    model = contrib.RecurrentPPO("MlpLstmPolicy", environment(), policy_kwargs=SMALL)
    model.save(tmp_path / "model.zip")
    with pytest.raises(ConfigError):
        load_sb3_zip(tmp_path / "model.zip", trust=True)


def test_another_pickle_beside_it_is_refused(tmp_path):
    saved(tmp_path / "model.zip", PPO)
    Path(tmp_path / NORMALISER).write_bytes(pickle.dumps([1]))
    with pytest.raises(ConfigError, match="not a VecNormalize"):
        load_sb3_zip(tmp_path / "model.zip", trust=True)
