from typing import ClassVar

import numpy as np
import pytest
from ship_gym_agents.pid import PID, Gains
from ship_gym_agents.tuning.ranges import (
    Range,
    at_bounds,
    can_widen,
    from_shares,
    leaf,
    ranges_of,
    to_shares,
    with_leaves,
)
from ship_gym_agents.wave_filter import LowPass

from ship_gym.config import ConfigError

RANGES = {"K_p": Range(0.2, 20.0, 3.0), "K_d": Range(0.0, 10.0, 1.5), "K_v": Range(-8, 4.0, -2.0)}


def test_gains_as_shares_of_their_ranges():
    """Linear from 0 or below on, logarithmic above; limited to the range, and back again."""
    values = {"K_p": 2.0, "K_d": 2.5, "K_v": -2.0}
    shares = to_shares(values, RANGES)
    assert shares == pytest.approx([0.5, 0.25, 0.5])
    assert from_shares(shares, RANGES) == pytest.approx(values)
    outside = {"K_p": 0.01, "K_d": 99.0, "K_v": 0.0}
    assert to_shares(outside, RANGES) == pytest.approx([0.0, 1.0, 8.0 / 12.0])


def test_an_optimum_at_a_bound_is_seen():
    assert at_bounds({"K_p": 2.0, "K_d": 0.05, "K_v": 4.0}, RANGES) == {"K_d": 0.0, "K_v": 4.0}


def test_a_bound_of_the_gains_themselves_is_not_that_of_a_range():
    """No wider range has a negative K_p; one of K_d has."""
    ranges = {"K_p": Range(0.0, 5.0, 1.0), "K_d": Range(0.0, 10.0, 1.5)}
    bounds = at_bounds({"K_p": 0.01, "K_d": 0.05}, ranges)
    assert bounds == {"K_p": 0.0, "K_d": 0.0}
    assert can_widen(Gains(0.01, 0.05), bounds, ranges) == ["K_d"]
    assert can_widen(Gains(5.0, 0.05), {"K_p": 5.0}, ranges) == ["K_p"]


def test_gains_by_dotted_name():
    gains = Gains(1.0, 2.0, low_pass=LowPass(0.0, 0.1, 0.2))
    changed = with_leaves(gains, {"K_p": np.array([3.0, 4.0]), "low_pass.T_r": 0.5})
    assert changed.K_p.tolist() == [3.0, 4.0] and changed.K_d == 2.0
    assert changed.low_pass == LowPass(0.0, 0.5, 0.2)
    assert leaf(changed, "low_pass.T_v") == 0.2
    with pytest.raises(ConfigError, match=r"no 'observer.yaw_noise' to tune"):
        with_leaves(gains, {"observer.yaw_noise": 1.0})


def test_ranges_of_a_controller():
    """A start of None is what the gains have; one outside the range is moved into it."""

    class Mine(PID):
        TUNED: ClassVar = {
            "K_p": (0.2, 20.0, None),
            "K_d": (-3.0, 1.0, None),
            "K_i": (1.0, 1.0, 1.0),
        }

    found = ranges_of(Mine, Gains(2.5, 4.0), ("K_p", "K_d"))
    assert found == {"K_p": Range(0.2, 20.0, 2.5), "K_d": Range(-3.0, 1.0, 1.0)}
    with pytest.raises(ConfigError, match=r"TUNED\['K_i'\]: 1.0 to 1.0 is no range"):
        ranges_of(Mine, Gains(2.5, 4.0), ("K_i",))
    with pytest.raises(ConfigError, match=r"Mine.TUNED has no 'K_q'; did you mean"):
        ranges_of(Mine, Gains(2.5, 4.0), ("K_q",))
