import time

import pytest
from ship_gym_agents.training.budget import Budget, default_budget

from ship_gym.config import ConfigError


def test_only_training_is_charged():
    budget = Budget(minutes=0.01, seconds_before=0.1)
    time.sleep(0.02)
    assert budget.seconds == 0.1, "the clock stands still before the start"
    budget.start()
    time.sleep(0.05)
    with budget.uncharged():
        before = budget.seconds
        time.sleep(0.1)
        with budget.uncharged():
            pass
        assert budget.seconds == before >= 0.15
    time.sleep(0.01)
    assert before < budget.seconds < before + 0.09


def test_the_nearer_limit_counts():
    budget = Budget(minutes=1.0, steps=100, seconds_before=15.0)
    assert budget.used(10) == pytest.approx(0.25) and budget.used(50) == 0.5
    assert budget.used(1000) == 1.0 and not budget.time_is_up
    assert Budget(minutes=1.0, seconds_before=60.0).time_is_up
    assert not Budget(steps=1, seconds_before=1e9).time_is_up


def test_limits_are_checked():
    with pytest.raises(ConfigError, match="a budget is needed"):
        Budget()
    with pytest.raises(ConfigError, match="steps = 0"):
        Budget(steps=0)
    assert default_budget(None, None) == {"minutes": 2.0, "steps": None}
    assert default_budget(None, 5) == {"minutes": None, "steps": 5}
