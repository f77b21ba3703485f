import json

import numpy as np
import pytest
from scipy import stats
from ship_gym_agents.pid import PID, Gains

from ship_gym.config import ConfigError
from ship_gym.evaluation import compare, rollout, table
from ship_gym.evaluation.controller import ConstantController
from ship_gym.evaluation.metrics import metrics_of
from ship_gym.evaluation.statistics import (
    draws,
    estimate,
    holm,
    interquartile_mean,
    interquartile_weights,
    intervals,
    paired,
    rate,
    ratios_to_best,
    share_above,
    share_within,
)

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


@pytest.mark.parametrize("n", [2, 3, 5, 8, 64])
def test_weights_of_a_resample_are_those_of_its_interquartile_mean(n):
    values = np.sort(np.random.default_rng(n).normal(size=n))
    counts = draws(n, 50)
    found = interquartile_weights(counts) @ values
    for mean, drawn in zip(found, counts.astype(int), strict=True):
        assert mean == pytest.approx(interquartile_mean(np.repeat(values, drawn)), rel=1e-12)


@pytest.mark.parametrize("n", [8, 64])
def test_interval_of_the_interquartile_mean_is_scipy_s_percentile_bootstrap(n):
    values = np.random.default_rng(n).exponential(size=n)
    other = stats.bootstrap(
        (values,), interquartile_mean, n_resamples=20_000, method="percentile", rng=1
    ).confidence_interval
    found = estimate(values)
    width = other.high - other.low
    assert (found.low, found.high) == pytest.approx(tuple(other), abs=0.03 * width)


def test_interval_of_a_mean_is_never_shorter_than_student_s():
    values = np.random.default_rng(3).lognormal(size=(6, 20))
    low, high = intervals(values, np.mean)
    half = stats.t.ppf(0.975, 19) * values.std(axis=1, ddof=1) / np.sqrt(20)
    assert (low <= values.mean(axis=1) - half + 1e-12).all()
    assert (high > values.mean(axis=1) + 1.05 * half).any()  # skewed: the truth may lie far above
    for row, a, b in zip(values, low, high, strict=True):
        assert (estimate(row, np.mean).low, estimate(row, np.mean).high) == pytest.approx((a, b))


def test_interval_of_a_mean_of_nearly_equal_values_is_finite():
    found = estimate([0.0] * 15 + [1.0], np.mean)  # of the resamples a third is all zero
    assert found.value == 1 / 16 and found.low < 0.0 < 0.125 < found.high < 1.0


def test_paired_p_value_counts_the_flips():
    """Differences 1, 2, 3: of 8 flips of signs two have a mean of 2 or -2.

    1, 2, -1 have the sum 2; the flips 4, 2, 2, 0, 0, -2, -2, -4: six are as far from zero.
    """
    found = paired([2.0, 4.0, 6.0], [1.0, 2.0, 3.0])
    assert (found.value, found.p) == (2.0, pytest.approx(2 / 8))
    assert found.low < 2.0 < found.high
    assert paired([1.0, 2.0, -1.0], [0.0, 0.0, 0.0]).p == pytest.approx(6 / 8)
    assert paired([1.0, 2.0], [1.0, 2.0]).p == 1.0
    assert paired([1.0], [0.0]).p == 1.0 and paired([1.0], [0.0]).low is None


def test_paired_p_value_is_near_that_of_student_for_normal_differences():
    a, b = np.random.default_rng(5).normal([[0.35], [0.0]], 1.0, (2, 64))
    found = paired(a, b)
    assert found.p == pytest.approx(stats.ttest_rel(a, b).pvalue, rel=0.2)
    assert (found.p < 0.05) == (found.low > 0.0)
    assert paired(a, b) == found  # seeded
    assert paired(a + 10.0, b).p == pytest.approx(2e-4, rel=0.6)  # the least that 9999 flips show


def test_values_that_cannot_be_judged_are_refused():
    with pytest.raises(ConfigError, match="all of them finite"):
        estimate([1.0, float("nan")])
    with pytest.raises(ConfigError, match="at least one"):
        estimate([])
    with pytest.raises(ConfigError, match="2 values and 1 others"):
        paired([1.0, 2.0], [1.0])
    with pytest.raises(ConfigError, match="no interval of"):
        intervals(np.ones((1, 3)), np.median)
    with pytest.raises(ConfigError, match="allowed is 0 to 1"):
        holm([0.5, 1.5])
    with pytest.raises(ConfigError, match="positive"):
        ratios_to_best(np.array([[0.0, 1.0]]))


def test_holm_by_hand():
    """Sorted 0.005, 0.01, 0.03, 0.04 times 4, 3, 2, 1: 0.02, 0.03, 0.06, 0.04; none may fall."""
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([0.5, 0.6, 0.02]) == pytest.approx([1.0, 1.0, 0.06])
    assert holm([0.03]) == pytest.approx([0.03]) and len(holm([])) == 0


def test_holm_keeps_the_false_rejections_of_a_family_at_5_percent():
    """400 families of 20 comparisons without any difference: about 5 % of them reject one."""
    p = np.random.default_rng(0).uniform(size=(400, 20))
    rejected = np.mean([holm(row).min() < 0.05 for row in p])
    assert 0.02 < rejected < 0.08
    assert np.mean(p.min(axis=1) < 0.05) > 0.5  # without Holm


def test_profiles_by_hand():
    values = np.array([[1.0, 4.0, 3.0, np.nan], [2.0, 2.0, 3.0, np.nan], [4.0, 2.0, 30.0, 1.0]])
    ratios = ratios_to_best(values)
    assert ratios.tolist() == [[1, 2, 1, np.inf], [2, 1, 1, np.inf], [4, 1, 10, 1]]
    within = share_within(ratios, np.array([1.0, 2.0, 5.0, 1e9]))
    assert within.tolist() == [
        [0.5, 0.75, 0.75, 0.75],
        [0.5, 0.75, 0.75, 0.75],
        [0.5, 0.5, 0.75, 1],
    ]
    nobody = ratios_to_best(np.array([[np.nan], [np.nan]]))
    assert np.isinf(nobody).all()
    scores = np.array([[50.0, 100.0, 120.0, -10.0]])
    assert share_above(scores, np.array([0.0, 100.0])).tolist() == [[0.75, 0.25]]


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
