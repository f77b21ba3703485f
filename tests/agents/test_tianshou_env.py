"""The adapter for Tianshou, against Tianshou's own vector of scalar environments."""

import numpy as np
import pytest

pytest.importorskip("tianshou", reason="extra 'clients' not installed")

from ship_gym_agents.tianshou_env import ShipTianshouEnv
from tianshou.data import Collector, VectorReplayBuffer
from tianshou.env import DummyVectorEnv

from ship_gym.config import ConfigError
from ship_gym.envs.env import ShipEnv

N = 3
# a narrow limit, so that episodes end both ways
SHORT = {"duration": 30.0, "start.heading_error_deg": 9.0, "limits.heading_error_deg": 10.0}


def both():
    return (
        ShipTianshouEnv(N, overrides=SHORT),
        DummyVectorEnv([lambda: ShipEnv(overrides=SHORT)] * N),
    )


def test_same_as_dummy_vector_env_of_scalars():
    envs = both()
    for env in envs:
        assert env.seed(7) == [[7], [8], [9]] and len(env) == N
    ours, theirs = envs
    seen = [env.reset()[0] for env in envs]
    np.testing.assert_array_equal(*seen)
    generator, ends = np.random.default_rng(0), set()
    for _ in range(100):
        actions = generator.uniform(-1.0, 1.0, (N, 1)).astype(np.float32)
        actions[0] = 1.0  # hard over, beyond the limit
        mine, other = ours.step(actions), theirs.step(actions)
        for a, b in zip(mine[:4], other[:4], strict=True):
            np.testing.assert_array_equal(a, b)
        assert mine[4].dtype == other[4].dtype == object
        ended = np.flatnonzero(mine[2] | mine[3])
        ends |= set(mine[2][ended].tolist())
        if len(ended):
            np.testing.assert_array_equal(ours.reset(ended)[0], theirs.reset(ended)[0])
    assert ends == {True, False}


def test_ids_come_back_in_their_order():
    ours, theirs = both()
    for env in (ours, theirs):
        env.seed(1)
        env.reset()
    mine, other = (env.step(np.array([[1.0], [-1.0]]), [2, 0]) for env in (ours, theirs))
    for a, b in zip(mine[:4], other[:4], strict=True):
        np.testing.assert_array_equal(a, b)
    with pytest.raises(ConfigError, match=r"ships \[1\] were left out of a step: reset them"):
        ours.step(np.zeros((N, 1)))
    np.testing.assert_array_equal(ours.reset(1)[0], theirs.reset(1)[0])
    assert ours.step(np.zeros((N, 1)))[0].shape == (N, 9)
    assert ours.info["time"].tolist() == [2.0, 1.0, 2.0]


def test_an_ended_ship_must_be_reset():
    env = ShipTianshouEnv(2, overrides={"duration": 2.0})
    env.seed(0)
    for _ in range(2):
        *_, truncated, _ = env.step(np.zeros((2, 1)))
    assert truncated.all()
    with pytest.raises(ConfigError, match="have ended: reset them"):
        env.step(np.zeros((2, 1)))
    env.reset([0])
    for _ in range(5):  # ship 1 sails on unseen, its episodes end and begin
        if env.step(np.zeros((1, 1)), [0])[3][0]:
            env.reset([0])


def test_spaces_and_attributes():
    env = ShipTianshouEnv(2, overrides=SHORT)
    assert [space.shape for space in env.action_space] == [(1,)] * 2
    assert [space.shape for space in env.observation_space] == [(9,)] * 2
    assert env.get_env_attr("scenario", 1) == [env.env.scenario]
    env.seed(3)
    samples = [space.sample() for space in env.action_space]
    assert samples[0] != samples[1]
    env.seed(3)
    assert [space.sample() for space in env.action_space] == samples
    env.set_env_attr("note", "x")
    assert env.get_env_attr("note") == ["x", "x"]
    with pytest.raises(ConfigError, match="one batch"):
        env.set_env_attr("note", "y", [0])
    with pytest.raises(ConfigError, match="autoreset_mode of ShipTianshouEnv"):
        ShipTianshouEnv(2, autoreset_mode="SameStep")
    env.close()
    with pytest.raises(AssertionError, match="after close"):
        env.reset()


def collected(env, **amount):
    """Returns of the episodes and the buffer of a collector."""
    from tianshou.algorithm.algorithm_base import Policy
    from tianshou.data import Batch

    class Steering(Policy):
        def forward(self, batch, state=None, **kwargs):
            return Batch(act=np.clip(batch.obs[:, :1] * 2.0, -1.0, 1.0), state=None)

    policy = Steering(action_space=env.action_space[0], observation_space=env.observation_space[0])
    env.seed(5)
    collector = Collector(policy, env, VectorReplayBuffer(400, N))
    collector.reset()
    return collector.collect(**amount), collector.buffer


@pytest.mark.parametrize("amount", [{"n_step": 150}, {"n_episode": 5}, {"n_episode": 2}])
def test_a_collector_gathers_the_same(amount):
    (mine, ours), (other, theirs) = (collected(env, **amount) for env in both())
    assert mine.n_collected_steps == other.n_collected_steps > 0
    np.testing.assert_array_equal(mine.returns, other.returns)
    for name in ("obs", "act", "rew", "obs_next", "terminated", "truncated"):
        np.testing.assert_array_equal(ours[:][name], theirs[:][name])
