import math

import numpy as np
import pytest

from ship_gym.tasks.heading import (
    N_OBSERVATIONS,
    N_TERMS,
    OBSERVATIONS,
    REWARD_TERMS,
    TASK_DTYPE,
    reward_terms,
    wrapped,
)


@pytest.fixture
def task():
    record = np.zeros(1, TASK_DTYPE)[0]
    record["speed"], record["interval"], record["rudder_stroke"] = 8.0, 2.0, 0.04
    record["heading_limit"], record["termination"] = 1.0, 50.0
    for i, name in enumerate(("heading", "rudder", "rudder_rate", "speed_loss")):
        record[name] = float(i + 1)
    return record


def test_reward_terms_by_hand(task):
    terms, ended = reward_terms(0.2, -0.3, 0.02, 6.0, task)
    expected = (-2.0 * 0.04, -4.0 * 0.09, -6.0 * 0.25, -8.0 * 0.0625, 0.0)
    np.testing.assert_allclose(terms, expected)
    assert not ended


def test_limit_ends_the_episode_and_speed_gain_is_not_paid(task):
    terms, ended = reward_terms(-1.01, 0.0, 0.0, 9.0, task)
    assert ended and terms[3] == 0.0 and terms[4] == -50.0


def test_wrapped():
    assert wrapped(math.pi) == -math.pi
    assert wrapped(3.0 * math.pi + 0.1) == pytest.approx(-math.pi + 0.1)
    assert wrapped(-0.3) == pytest.approx(-0.3)


def test_sizes():
    assert N_OBSERVATIONS == len(OBSERVATIONS) == 9
    assert N_TERMS == len(REWARD_TERMS) == 5
