import math

import numpy as np
import pytest

from ship_gym.conventions import N
from ship_gym.envs.env import ShipEnv
from ship_gym.tasks import TASKS, observations_of
from ship_gym.tasks.bridge import N_BRIDGE, N_TERMS, TASK_DTYPE, reward_terms


@pytest.fixture
def task():
    record = np.zeros(1, TASK_DTYPE)[0]
    record["speed"], record["interval"], record["rudder_stroke"] = 8.0, 2.0, 0.04
    record["termination"] = 50.0
    for i, name in enumerate(("error", "rudder", "rudder_rate", "speed_loss")):
        record[name] = float(i + 1)
    return record


def test_reward_terms_by_hand(task):
    terms = reward_terms(0.2, -0.3, 0.02, 6.0, task, False)
    expected = (-2.0 * 0.04, -4.0 * 0.09, -6.0 * 0.25, -8.0 * 0.0625, 0.0)
    np.testing.assert_allclose(terms, expected)


def test_failing_costs_once_and_speed_gain_is_not_paid(task):
    terms = reward_terms(-1.01, 0.0, 0.0, 9.0, task, True)
    assert terms[3] == 0.0 and terms[4] == -50.0


def test_sizes_of_every_task():
    for name, one in TASKS.items():
        assert len(one.reward_terms) == N_TERMS
        assert len(one.observations) == {"track_following": N_BRIDGE + 6}.get(name, N_BRIDGE)
        assert len(observations_of(name, True)) == len(one.observations) + 26
        for symbol, _, low, high, meaning in observations_of(name, True):
            assert symbol and meaning and low < high


def test_power_is_that_of_torque_and_propeller_speed_at_one_instant():
    env = ShipEnv(control="rudder+rpm", overrides={"control_interval": 5.0})
    env.reset(seed=0)
    for action in (-1.0, 1.0):
        n = env.episodes.sim.state[0, N]
        *_, info = env.step(np.array([0.0, action]))
        assert info["power"] == pytest.approx(2.0 * math.pi * n * info["flow"]["torque"])
        assert env.episodes.sim.state[0, N] != pytest.approx(n, rel=0.01)
