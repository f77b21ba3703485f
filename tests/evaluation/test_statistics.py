import json

import numpy as np
import pytest
from ship_gym_agents.pid import PID, Gains

from ship_gym.config import ConfigError
from ship_gym.evaluation import compare, rollout, table
from ship_gym.evaluation.controller import ConstantController
from ship_gym.evaluation.metrics import metrics_of
from ship_gym.evaluation.statistics import estimate, interquartile_mean, rate

SHORT = {"duration": 30.0}


@pytest.fixture(scope="module")
def rollouts():
    controllers = [PID(Gains(2.0, 2.0)), ConstantController()]
    return [rollout(c, seeds=[1, 2, 3, 4], overrides=SHORT) for c in controllers]


def test_interquartile_mean_drops_both_quarters():
    assert interquartile_mean(np.array([1000.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, -1000.0])) == 3.5
    assert interquartile_mean(np.array([4.0])) == 4.0


def test_interval_of_a_normal_sample():
    values = np.random.default_rng(0).normal(5.0, 2.0, 400)
    found = estimate(values, np.mean)
    half = 1.96 * values.std() / np.sqrt(400)
    assert found.value == pytest.approx(values.mean())
    assert found.low == pytest.approx(found.value - half, abs=0.03)
    assert found.high == pytest.approx(found.value + half, abs=0.03)
    assert found == estimate(values, np.mean)  # seeded


def test_intervals_without_spread_or_sample():
    same = estimate([2.0, 2.0, 2.0])
    assert (same.low, same.value, same.high) == (2.0, 2.0, 2.0)
    assert estimate([2.0]).low is None


def test_comparison_is_paired_and_can_be_stored(rollouts):
    found = compare(rollouts)
    assert json.loads(json.dumps(found, allow_nan=False)) == found
    assert found["reference"] == "pid"
    assert list(found["controllers"]) == ["pid", "constant"]
    a, b = (np.array(found["episodes"][name]["J_1"]) for name in ("constant", "pid"))
    shown = found["differences"]["constant"]["J_1"]
    assert shown["value"] == pytest.approx(interquartile_mean(a - b))
    assert set(found["metrics"]) == set(metrics_of("heading_keeping"))


def test_table_is_aligned_and_has_every_metric(rollouts):
    found = compare(rollouts, "constant")
    text, tabled = table(found), table(found, markdown=True)
    for name in metrics_of("heading_keeping"):
        assert text.count(f"\n{name} ") == 2 and tabled.count(f"\n| {name} ") == 2
    assert "pid - constant" in text
    assert len({line.count("|") for line in tabled.split("\n\n")[0].splitlines()}) == 1
    columns = [
        line.index("  ") for line in text.splitlines() if line.startswith("rudder_reversals")
    ]
    assert len(set(columns)) == 1


def test_differences_say_which_is_better(rollouts):
    text = table(compare([rollouts[1], rollouts[0]]))
    travel = next(x for x in text.split("difference")[1].splitlines() if "rudder_travel" in x)
    assert travel.endswith("worse")


def test_what_cannot_be_compared_is_refused(rollouts):
    with pytest.raises(ConfigError, match="no rollouts"):
        compare([])
    with pytest.raises(ConfigError, match="own name"):
        compare([rollouts[0], rollouts[0]])
    other = rollout(ConstantController(), seeds=[1, 2, 3, 5], overrides=SHORT)
    with pytest.raises(ConfigError, match="no paired comparison"):
        compare([rollouts[0], other])
    with pytest.raises(ConfigError, match="did you mean 'pid'"):
        compare(rollouts, "pit")


def test_rate_has_wilson_s_interval_also_when_all_are_equal():
    """Printed example of Newcombe (1998), Stat. Med. 17:857, method 3: 15 of 148 gives these."""
    found = rate([1.0] * 15 + [0.0] * 133)
    assert found.value == pytest.approx(15 / 148)
    assert (found.low, found.high) == pytest.approx((0.0624, 0.1605), abs=5e-5)
    assert (
        rate([1.0] * 128).low == pytest.approx(0.9709, abs=1e-4) and rate([1.0] * 128).high == 1.0
    )
    assert rate([1.0]).low is None
