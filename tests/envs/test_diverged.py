"""Episodes that diverge, or whose ship is none any more, end by themselves; the others sail on."""

import gymnasium as gym
import numpy as np
import pytest

from ship_gym.conventions import U
from ship_gym.evaluation import metrics, rollout
from ship_gym.evaluation.controller import ConstantController
from ship_gym.simulation import FASTEST
from ship_gym.tasks import TASKS
from ship_gym.tasks.base import DIVERGED

HEADING = "ShipGym/HeadingKeeping-v0"
# ten standard deviations of the surrogate: some of these ships are none
WILD = {"randomisation.surrogate_std": 10.0, "limits.heading_error_deg": 180.0}
FULL = {"ship": "onrt", "control": "rudder+rpm", "overrides": WILD}


def hard_over(n):
    actions = np.ones((n, 2))
    actions[::2, 0] = -1.0
    return actions


@pytest.fixture(scope="module")
def sailed():
    """Seeds 0 to 127 hard over at full speed; when each diverged, 0: not at all."""
    envs = gym.make_vec(HEADING, num_envs=128, autoreset_mode="Disabled", **FULL)
    envs.reset(seed=0)
    when, last, rewards_at = np.zeros(128, int), {}, {}
    for k in range(1, 200):
        states = envs.episodes.sim.state.copy()
        observations, rewards, terminated, truncated, info = envs.step(hard_over(128))
        assert np.isfinite(observations).all() and np.isfinite(rewards).all()
        assert envs.observation_space.contains(observations)
        for i in np.flatnonzero(terminated):
            assert info["outcome"][i] == DIVERGED and info["cost"][i] == 1.0
            assert not info["is_success"][i]
            when[i], last[i] = k, (states[i], envs.episodes.sim.state[i].copy())
            rewards_at[i] = rewards[i]
        if terminated.any():
            envs.reset(options={"reset_mask": terminated})
        assert not truncated.any()
        if when.astype(bool).sum() > 5:
            break
    return when, last, rewards_at, k


def test_some_diverge_and_keep_the_last_state_of_a_ship(sailed):
    when, last, rewards, _ = sailed
    assert 5 < np.count_nonzero(when) < 128
    for i, (before, after) in last.items():
        assert (before == after).all()
        assert rewards[i] == -200.0


def test_scalar_is_vector(sailed):
    when, last, rewards, _ = sailed
    i = int(np.flatnonzero(when)[0])
    env = gym.make(HEADING, **FULL)
    env.reset(seed=i)
    for _ in range(when[i]):
        _, reward, terminated, _, info = env.step(hard_over(128)[i])
    assert terminated and info["outcome"] == DIVERGED and reward == rewards[i]
    assert (env.unwrapped.episodes.sim.state[0] == last[i][1]).all()


def test_threads_give_the_same_to_ships_that_diverge(sailed):
    """Each keeps the states at the start of an interval for its own block only."""
    when, *_ = sailed
    steps = int(when[64:][when[64:] > 0].min())  # the second thread has one that diverges
    serial, threads = (
        gym.make_vec(HEADING, num_envs=128, autoreset_mode="SameStep", parallel=parallel, **FULL)
        for parallel in (False, True)
    )
    assert (serial.reset(seed=0)[0] == threads.reset(seed=0)[0]).all()
    ended = 0
    for _ in range(steps):
        a, b = serial.step(hard_over(128)), threads.step(hard_over(128))
        for x, y in zip(a[:4], b[:4], strict=True):
            assert (x == y).all()
        assert (serial.episodes.sim.state == threads.episodes.sim.state).all()
        ended += a[2][64:].sum()
    assert ended > 0


def test_the_others_sail_as_if_nothing_had_been(sailed):
    when, _, _, steps = sailed
    i = int(np.flatnonzero(when == 0)[0])
    env = gym.make(HEADING, **FULL)
    env.reset(seed=i)
    for _ in range(steps):
        env.step(hard_over(128)[i])
    envs = gym.make_vec(HEADING, num_envs=128, **FULL)
    envs.reset(seed=0)
    for _ in range(steps):
        envs.step(hard_over(128))
    assert (env.unwrapped.episodes.sim.state[0] == envs.episodes.sim.state[i]).all()


@pytest.mark.parametrize("value", [np.nan, np.inf, 4.0 * 7.5, -1e300])
@pytest.mark.parametrize("task", list(TASKS))
def test_a_state_that_is_none_ends_the_episode_and_only_it(task, value):
    """The state is spoilt by hand, as a kernel would do it: between two intervals."""
    envs = gym.make_vec(TASKS[task].env_id, num_envs=3, autoreset_mode="Disabled")
    envs.reset(seed=0)
    envs.step(np.zeros((3, 1)))
    envs.episodes.sim.state[1, U] = value
    observations, rewards, terminated, _, info = envs.step(np.zeros((3, 1)))
    assert terminated.tolist() == [False, True, False]
    assert info["outcome"].tolist() == [0, DIVERGED, 0]
    assert np.isfinite(rewards).all() and np.isfinite(observations[[0, 2]]).all()


def test_a_ship_at_the_limit_of_speed_is_still_one():
    env = gym.make(HEADING).unwrapped
    env.reset(seed=0, options={"speed": 0.99 * FASTEST * env.ship.speed})
    *_, info = env.step(np.zeros(1))
    assert info["outcome"] == 0
    env.reset(seed=0)
    env.episodes.sim.state[0, U] = 1.2 * FASTEST * env.ship.speed
    _, reward, terminated, _, info = env.step(np.zeros(1))
    assert terminated and info["outcome"] == DIVERGED and reward == -200.0


def test_a_recording_of_one_has_finite_columns_and_metrics():
    sailed = rollout(ConstantController(1.0), seeds=range(128), **FULL)
    lost = np.flatnonzero(sailed.outcomes == DIVERGED)
    assert len(lost) > 3
    trajectory = sailed.trajectory(int(lost[0]))
    assert trajectory.meta["outcome"] == "diverged" and trajectory.meta["failed"]
    for name in trajectory.names:
        assert np.isfinite(trajectory[name]).all(), name
    assert metrics(trajectory)["success"] == 0.0
