import math
import warnings

import gymnasium as gym
import numpy as np
import pytest

import ship_gym  # noqa: F401  registers the ids
from ship_gym.config import ConfigError
from ship_gym.envs.env import ShipEnv

pytest.importorskip("stable_baselines3")

from ship_gym_agents.sb3.vec_adapter import ShipVecEnv
from stable_baselines3 import PPO
from stable_baselines3.common.env_checker import check_env
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import DummyVecEnv, VecFrameStack, VecMonitor, VecNormalize

N = 3
# a narrow limit, so that episodes end both ways
SHORT = {"duration": 30.0, "start.heading_error_deg": 9.0, "limits.heading_error_deg": 10.0}


def scalar_environments(**changes):
    return DummyVecEnv([lambda: ShipEnv(overrides={**SHORT, **changes}) for _ in range(N)])


@pytest.mark.parametrize("control", ["rudder", "rudder+rpm"])
def test_same_as_dummy_vec_env_of_scalars(control):
    ours = ShipVecEnv(N, control=control, overrides=SHORT)
    theirs = VecMonitor(scalar_environments(control=control))
    for env in (ours, theirs):
        env.seed(7)
    np.testing.assert_array_equal(ours.reset(), theirs.reset())
    generator, ends = np.random.default_rng(0), []
    for _ in range(130):
        actions = generator.uniform(-1.0, 1.0, (N, ours.action_space.shape[0])).astype(np.float32)
        actions[0, 0] = 1.0  # hard over, beyond the limit
        mine, other = ours.step(actions), theirs.step(actions)
        for a, b in zip(mine[:3], other[:3], strict=True):
            np.testing.assert_array_equal(a, b)
            assert a.dtype == b.dtype
        for i in np.flatnonzero(mine[2]):
            info, expected = mine[3][i], other[3][i]
            np.testing.assert_array_equal(
                info["terminal_observation"], expected["terminal_observation"]
            )
            assert info["TimeLimit.truncated"] is expected["TimeLimit.truncated"]
            assert info["episode"]["l"] == expected["episode"]["l"]
            assert info["episode"]["r"] == pytest.approx(float(expected["episode"]["r"]), rel=1e-5)
            assert info["reward_terms"] == expected["reward_terms"]
            assert set(expected) == set(info)
            ends.append(info["TimeLimit.truncated"])
    assert len(ends) > 2 * N and set(ends) == {True, False}


def test_options_of_the_next_reset():
    envs = ShipVecEnv(2, overrides={"sensors.noise": False})
    envs.seed(4)
    envs.set_options({"heading_error_deg": 30.0})
    seen = envs.reset()
    np.testing.assert_allclose(np.degrees(np.arcsin(seen[:, 0])), 30.0, atol=1.0)
    envs.set_options([{"heading_error_deg": 10.0}, {"heading_error_deg": -10.0}])
    np.testing.assert_allclose(np.degrees(np.arcsin(envs.reset()[:, 0])), [10.0, -10.0], atol=1.0)
    assert np.ptp(envs.reset()[:, 0]) != pytest.approx(0.0)  # only the next one
    envs.set_options({"nonsense": 30.0})
    with pytest.raises(ConfigError, match="unknown option of reset 'nonsense'"):
        envs.reset()
    envs.set_options([{"speed": 5.0}, {}])
    with pytest.raises(ConfigError, match="need the same names"):
        envs.reset()


def test_running_episodes_have_empty_infos():
    env = ShipVecEnv(N, overrides=SHORT)
    env.seed(0)
    env.reset()
    _, _, dones, infos = env.step(np.zeros((N, 1)))
    assert not dones.any() and infos == [{}] * N


def test_seed_is_used_once():
    env = ShipVecEnv(N, overrides=SHORT)
    assert env.seed(5) == [5, 6, 7]
    first, second = env.reset(), env.reset()
    env.seed(5)
    np.testing.assert_array_equal(env.reset(), first)
    assert (first != second).any()


def test_staggered_episodes_end_at_different_times():
    env = ShipVecEnv(16, stagger=True, overrides={"duration": 20.0})
    env.seed(0)
    env.reset()
    first = np.zeros(16)
    for k in range(1, 41):
        _, _, dones, _ = env.step(np.zeros((16, 1)))
        first[(first == 0) & dones] = k
    assert first.min() >= 1 and first.max() <= 20 and len(set(first)) > 5


def test_attributes_and_methods():
    env = ShipVecEnv(N, overrides=SHORT)
    assert env.get_attr("scenario", indices=[0, 2]) == [env.env.scenario] * 2
    assert env.render_mode is None and env.render() is None
    assert env.env_is_wrapped(Monitor) == [True] * N
    assert env.env_is_wrapped(Monitor, indices=[0]) == [True]
    assert env.env_is_wrapped(gym.Wrapper) == [False] * N
    env.set_attr("note", "x")
    assert env.get_attr("note") == ["x"] * N
    assert env.env_method("_seeds", 3) == [[3, 4, 5]] * N
    with pytest.raises(AttributeError):
        env.get_attr("no_such_name")
    with pytest.raises(ConfigError, match="one batch"):
        env.set_attr("note", "y", indices=0)
    with pytest.raises(ConfigError, match="ShipVecEnv itself"):
        env.env_method("reset")


def test_learns_under_vec_normalize():
    env = VecNormalize(ShipVecEnv(4, overrides={"duration": 10.0}))
    model = PPO("MlpPolicy", env, n_steps=16, batch_size=32, seed=0, device="cpu")
    model.learn(128)
    assert model.num_timesteps == 128 and len(model.ep_info_buffer) >= 4


class HardOver:
    """A policy in the form that stable-baselines3 evaluates: a constant rudder."""

    def predict(self, observations, state=None, episode_start=None, deterministic=True):
        return np.full((len(observations), 1), 0.4, dtype=np.float32), state


def sailed_by_hand(seeds, action):
    """Return and length of an episode for each seed, in scalar environments."""
    found = []
    for seed in seeds:
        env = ShipEnv(overrides=SHORT)
        env.reset(seed=seed)
        rewards, over = [], False
        while not over:
            _, reward, terminated, truncated, _ = env.step(action)
            rewards.append(reward)
            over = terminated or truncated
        found.append((math.fsum(rewards), len(rewards)))
    return found


WRAPPED = {
    "bare": lambda env: env,
    "VecNormalize": VecNormalize,
    "VecFrameStack": lambda env: VecFrameStack(env, 3),
    "VecNormalize, VecFrameStack": lambda env: VecFrameStack(VecNormalize(env), 2),
    "VecMonitor, VecNormalize": lambda env: VecNormalize(VecMonitor(env)),
}


@pytest.mark.parametrize("name", WRAPPED)
@pytest.mark.filterwarnings("ignore:The environment is already wrapped:UserWarning")
def test_evaluate_policy_gives_the_raw_returns(name):
    env = WRAPPED[name](ShipVecEnv(N, overrides=SHORT))
    env.seed(11)
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # also SB3's of a missing Monitor
        returns, lengths = evaluate_policy(HardOver(), env, N, return_episode_rewards=True)
    expected = sailed_by_hand(range(11, 11 + N), np.array([0.4], dtype=np.float32))
    # the order of evaluate_policy is that in which the episodes end
    assert sorted(lengths) == sorted(length for _, length in expected)
    assert sorted(returns) == pytest.approx(sorted(total for total, _ in expected), rel=1e-6)


def test_sb3_accepts_the_scalar_environment_without_warnings():
    env = gym.make("ShipGym/HeadingKeeping-v0").unwrapped
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env)
