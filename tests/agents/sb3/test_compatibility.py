"""What users of stable-baselines3 do with an environment, with budgets too small to learn from."""

import functools
import warnings

import gymnasium as gym
import numpy as np
import pytest

import ship_gym

pytest.importorskip("stable_baselines3", reason="extra 'rl' not installed")

import torch
from ship_gym_agents.sb3.vec_adapter import ShipVecEnv
from stable_baselines3 import DQN, PPO, SAC, TD3
from stable_baselines3.common.env_checker import check_env
from stable_baselines3.common.env_util import make_vec_env
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.vec_env import (
    DummyVecEnv,
    SubprocVecEnv,
    VecCheckNan,
    VecFrameStack,
    VecNormalize,
    VecVideoRecorder,
)

from ship_gym import DiscreteRudder

IDS = sorted(ship_gym.ENVIRONMENTS)
HEADING = "ShipGym/HeadingKeeping-v0"
CONTROLS = ("rudder", "rudder+rpm")
SHORT = {"duration": 10.0}
BUDGET = 64
SMALL = {"seed": 0, "device": "cpu"}
OFF_POLICY = {"learning_starts": 16, "buffer_size": 200, "batch_size": 16, **SMALL}
ON_POLICY = {"n_steps": 16, "batch_size": 16, "n_epochs": 2, **SMALL}
OPTIONS = {PPO: ON_POLICY, SAC: OFF_POLICY, TD3: OFF_POLICY, DQN: OFF_POLICY}
# made by name, so that a child process need not import this file
make_short = functools.partial(gym.make, f"ship_gym:{HEADING}", ship="kcs_model", overrides=SHORT)


@pytest.fixture(autouse=True, scope="module")
def one_thread():
    """Threads of torch that wait for a busy core make tiny networks very slow."""
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(before)


def tiny(algorithm, env):
    """Model with a network of eight neurons."""
    return algorithm("MlpPolicy", env, policy_kwargs={"net_arch": [8]}, **OPTIONS[algorithm])


def assert_learns(model, path):
    """It learns, acts within the space, and a saved model acts alike."""
    before = [p.detach().clone() for p in model.policy.parameters()]
    model.learn(BUDGET)
    assert model.num_timesteps >= BUDGET
    after = list(model.policy.parameters())
    assert any((a != b).any() for a, b in zip(before, after, strict=True))
    assert all(torch.isfinite(p).all() for p in after)
    env = model.get_env()
    assert np.mean([episode["l"] for episode in model.ep_info_buffer]) == 10
    env.seed(5)
    obs = env.reset()
    action, _ = model.predict(obs, deterministic=True)
    assert all(env.action_space.contains(one) for one in action)
    model.save(path / "model.zip")
    again = type(model).load(path / "model.zip", device="cpu")
    np.testing.assert_array_equal(again.predict(obs, deterministic=True)[0], action)


# --- checker -------------------------------------------------------------------------------------


@pytest.mark.parametrize("privileged", [False, True])
@pytest.mark.parametrize("control", CONTROLS)
@pytest.mark.parametrize("env_id", IDS)
def test_check_env_is_silent(env_id, control, privileged):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gym.make(env_id, control=control, privileged=privileged).unwrapped)


@pytest.mark.parametrize("env_id", IDS)
def test_check_env_takes_chosen_angles(env_id):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(DiscreteRudder(gym.make(env_id)))


# --- algorithms ----------------------------------------------------------------------------------


@pytest.mark.parametrize("control", CONTROLS)
@pytest.mark.parametrize("algorithm", [SAC, TD3])
@pytest.mark.parametrize("env_id", IDS)
def test_off_policy_algorithms_learn(env_id, algorithm, control, tmp_path):
    env = gym.make(env_id, control=control, overrides=SHORT)
    assert_learns(tiny(algorithm, env), tmp_path)


@pytest.mark.parametrize("env_id", IDS)
def test_dqn_learns_to_choose_angles(env_id, tmp_path):
    env = DiscreteRudder(gym.make(env_id, overrides=SHORT))
    assert_learns(tiny(DQN, env), tmp_path)


@pytest.mark.parametrize("control", CONTROLS)
@pytest.mark.parametrize("env_id", IDS)
def test_ppo_learns(env_id, control, tmp_path):
    env = gym.make(env_id, control=control, overrides=SHORT)
    assert_learns(tiny(PPO, env), tmp_path)


@pytest.mark.parametrize("form", ["scalar", "vector"])
@pytest.mark.parametrize("env_id", IDS)
def test_recurrent_ppo_learns(env_id, form, tmp_path):
    contrib = pytest.importorskip("sb3_contrib", reason="extra 'rl' not installed")
    small = {"net_arch": [8], "lstm_hidden_size": 8}
    if form == "scalar":
        env = gym.make(env_id, overrides=SHORT)
    else:
        env = ShipVecEnv(2, scenario=ship_gym.ENVIRONMENTS[env_id], overrides=SHORT)
    model = contrib.RecurrentPPO("MlpLstmPolicy", env, policy_kwargs=small, **ON_POLICY)
    assert_learns(model, tmp_path)


@pytest.mark.parametrize("env_id", IDS)
@pytest.mark.parametrize("algorithm", [PPO, SAC, TD3])
def test_algorithms_learn_on_the_native_vector_environment(env_id, algorithm, tmp_path):
    """A mixed fleet in SS6, with all observations."""
    env = ShipVecEnv(
        4,
        scenario=ship_gym.ENVIRONMENTS[env_id],
        ship=["kcs", "kvlcc2_model"],
        privileged=True,
        overrides={**SHORT, "sea.states": ["ss6"]},
    )
    assert_learns(tiny(algorithm, env), tmp_path)


def test_dqn_learns_on_several_environments(tmp_path):
    env = make_vec_env(
        HEADING, 2, env_kwargs={"overrides": SHORT}, wrapper_class=DiscreteRudder, seed=0
    )
    assert_learns(tiny(DQN, env), tmp_path)


def test_a_policy_is_evaluated_with_success_of_episodes(tmp_path):
    from stable_baselines3.common.callbacks import EvalCallback

    env = gym.make(HEADING, overrides=SHORT)
    other = make_vec_env(HEADING, 1, env_kwargs={"overrides": SHORT})
    model = tiny(PPO, env)
    callback = EvalCallback(
        other, eval_freq=32, n_eval_episodes=2, log_path=str(tmp_path), verbose=0
    )
    model.learn(BUDGET, callback=callback)
    kept = np.load(tmp_path / "evaluations.npz")
    assert kept["ep_lengths"].tolist() == [[10, 10]] * 2
    assert kept["successes"].all()  # nobody fails in 10 s
    mean, std = evaluate_policy(model, other, n_eval_episodes=3)
    assert mean < 0.0 and np.isfinite(std)


# --- vector forms --------------------------------------------------------------------------------


def sail(env, steps=25):
    """Observations, rewards and ends over two ends of episodes."""
    env.seed(4)
    seen, generator = [env.reset()], np.random.default_rng(0)
    for _ in range(steps):
        actions = generator.uniform(-1.0, 1.0, (env.num_envs, 1)).astype(np.float32)
        obs, rewards, dones, infos = env.step(actions)
        # SubprocVecEnv alone leaves rewards in float64
        seen += [obs, rewards.astype(np.float32), dones]
        seen += [info["terminal_observation"] for info in infos if "terminal_observation" in info]
    return seen


@pytest.mark.parametrize(
    "start", ["fork", *(pytest.param(s, marks=pytest.mark.slow) for s in ("spawn", "forkserver"))]
)
def test_subproc_vec_env_sails_the_same_episodes(start):
    env = SubprocVecEnv([make_short] * 2, start_method=start)
    try:
        found = sail(env)
    finally:
        env.close()
    native = ShipVecEnv(2, ship="kcs_model", overrides=SHORT)
    for expected in (sail(DummyVecEnv([make_short] * 2)), sail(native)):
        assert len(found) == len(expected) == 1 + 3 * 25 + 2 * 2
        for a, b in zip(found, expected, strict=True):
            np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize(
    "wrap", [VecNormalize, VecCheckNan, functools.partial(VecFrameStack, n_stack=3)]
)
def test_wrappers_see_native_and_scalars_alike(wrap):
    a = sail(wrap(ShipVecEnv(2, ship="kcs_model", overrides=SHORT)))
    b = sail(wrap(DummyVecEnv([make_short] * 2)))
    for one, other in zip(a, b, strict=True):
        np.testing.assert_array_equal(one, other)


def scalars_with_pictures(n):
    make = functools.partial(gym.make, HEADING, render_mode="rgb_array", overrides=SHORT)
    return DummyVecEnv([make] * n)


def test_pictures_are_those_of_scalars():
    """Also in the step that ends an episode: both show the start of the next."""
    pytest.importorskip("PIL", reason="extra 'render' not installed")
    ours, theirs = ShipVecEnv(2, overrides=SHORT, render_mode="rgb_array"), scalars_with_pictures(2)
    for env in (ours, theirs):
        env.seed(3)
        env.reset()
    assert ours.render_mode == "rgb_array" and ours.metadata["render_fps"] == 10
    ended = False
    for _ in range(11):
        _, _, dones, _ = ours.step(np.ones((2, 1), np.float32))
        theirs.step(np.ones((2, 1), np.float32))
        np.testing.assert_array_equal(ours.render(), theirs.render())
        ended |= dones.all()
    assert ended


@pytest.mark.parametrize("wrap", [lambda env: env, VecNormalize])
@pytest.mark.parametrize("native", [True, False])
def test_vec_video_recorder_writes_a_video(native, wrap, tmp_path):
    moviepy = pytest.importorskip("moviepy", reason="extra 'render' not installed")
    shown = {"overrides": SHORT, "render_mode": "rgb_array"}
    env = wrap(ShipVecEnv(2, **shown) if native else scalars_with_pictures(2))
    env = VecVideoRecorder(env, str(tmp_path), lambda step: step == 0, video_length=3)
    env.reset()
    for _ in range(4):
        env.step(np.ones((2, 1), np.float32))
    height, width, _ = env.render().shape
    env.close()
    (path,) = tmp_path.glob("*.mp4")
    with moviepy.VideoFileClip(str(path)) as clip:
        frames = list(clip.iter_frames())
        assert (len(frames), clip.fps, tuple(clip.size)) == (4, 10, (width, height))
    assert all(np.ptp(ship) > 100 for ship in np.split(frames[0], 2))  # neither is blank
