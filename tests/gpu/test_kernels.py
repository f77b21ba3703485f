"""What a thread does for one ship, done by the CPU one by one: the same bits as its own step."""

import numpy as np
import pytest

from ship_gym.conventions import U
from ship_gym.envs.vector_env import ShipVectorEnv
from ship_gym.gpu.batch import failing_of, fleet_of, shared_of
from ship_gym.gpu.kernels import order_and_sail, settling
from tests.gpu.voyages import VOYAGES

N, LOST, INTERVALS = 3, 1, 6
# a ship that is lost may overflow, which numpy tells where Python runs the kernels
pytestmark = pytest.mark.filterwarnings("ignore::RuntimeWarning")


def made(name):
    options = {"scenario": None, **VOYAGES[name]}
    envs = ShipVectorEnv(N, autoreset_mode="Disabled", **options)
    envs.reset(seed=7)
    return envs


# m/s of the ship that is lost; at the second her loads are not finite, and Python's math refuses
SPEEDS = [(name, 1e4) for name in VOYAGES]
SPEEDS += [pytest.param("heading", 1e200, marks=pytest.mark.compiled)]


@pytest.mark.parametrize("name, speed", SPEEDS)
def test_one_ship_after_the_other(name, speed):
    ours, theirs = made(name), made(name)
    episodes = ours.episodes
    fleet, shared, failing = fleet_of(episodes), shared_of(episodes), failing_of(episodes)
    settle = settling(episodes.task, ours.scenario.privileged)
    expected = fleet_of(theirs.episodes)
    generator = np.random.default_rng(5)
    for k in range(INTERVALS):
        if k == INTERVALS - 1:
            fleet.states[LOST, U] = expected.states[LOST, U] = speed
        actions = generator.uniform(-1.0, 1.0, ours.action_space.shape)
        ended = []
        for i in range(N):
            assert order_and_sail(i, fleet, shared, actions) == 1
            ended.append(settle(i, fleet, shared, failing))
        theirs.episodes.step(actions)
        for field, a, b in zip(fleet._fields, fleet, expected, strict=True):
            np.testing.assert_array_equal(a, b, err_msg=field, strict=True)
        ends = expected.results["terminated"] | expected.results["truncated"]
        np.testing.assert_array_equal(ended, ends)
    assert ended[LOST] == 1 and expected.lost.tolist() == [False, True, False]


def test_an_action_that_is_not_finite_is_not_sailed():
    envs = made("calm")
    fleet, shared = fleet_of(envs.episodes), shared_of(envs.episodes)
    before = fleet.states.copy()
    assert order_and_sail(0, fleet, shared, np.full((N, 1), np.nan)) == 0
    np.testing.assert_array_equal(fleet.states, before)
