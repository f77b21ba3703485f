"""Knight & Maki (2020) on synthetic series: what they print of themselves, and ours beside it."""

import math

import numpy as np
import pytest

from reproduce.unsteady import (
    NETWORKS,
    ORDERS,
    REGRESSION_ORDER,
    compare,
    compare_seeds,
    loss,
    open_water_test,
    regression_row,
)
from reproduce.unsteady_printed import TESTS
from reproduce.unsteady_series import NOISE, behind_hull, eq_21, motion, series, ship_wake
from ship_gym.config import ConfigError
from ship_gym.csv_file import read_csv


def test_eq_21_at_one_point_by_hand():
    """J = 0.5, |alpha| = 0.2."""
    expected = [
        0.477 - 0.1405 - 0.01525 + 0.0268 - 0.00816 + 0.0047,
        0.320 - 0.0085 - 0.0315 + 0.3222 - 0.00112 + 0.0252,
        0.680 - 0.166 - 0.019 + 0.0324 - 0.01164 + 0.0069,
    ]
    np.testing.assert_allclose(eq_21(np.array([[0.5, -0.2]]))[0], expected, rtol=1e-12)


def test_motion_of_the_training_case_in_open_water():
    """U 1.68 (1 +- 0.476) m/s, V +- 0.84 m/s: four swings in one period of n."""
    X = motion("open water", "training", 7000)
    low, high = math.atan(-0.5 / (1 - 0.476)), math.atan(0.5 / (1 + 0.476))
    assert X[:, 1].min() == pytest.approx(low, abs=1e-5)
    assert X[:, 1].max() == pytest.approx(high, abs=1e-5)
    assert X[:, 0].max() < 1.68 * 1.476 / (32 * 0.844 * 0.105)
    assert np.sum(np.diff(np.sign(X[:, 1])) != 0) == 8


def test_printed_side_force_scaling_leaves_the_reach_of_a_sigmoid():
    """10 |K_S| + 0.3 of Eq. 21 is 1.57 at most in their own training case: a network cannot."""
    K_S = eq_21(motion("open water", "training"))[:, 1]
    assert K_S.max() == pytest.approx(1.57, abs=0.01)


def test_behind_the_hull_the_propeller_works_in_the_wake():
    """Thrust identity: straight ahead K_T(J) is the open water's K_T(J (1 - w))."""
    w, C = ship_wake()
    assert C == 4.0  # it weakens in drift: without that nothing is left for the network to find
    behind = behind_hull(np.array([[0.5 / (1 - w), 0.0]]), ship_wake())[0]
    K_T, _, K_Q = eq_21(np.array([[0.5, 0.0]]))[0]
    np.testing.assert_allclose(behind, [K_T + 0.2, 0.5, K_Q], rtol=1e-12)


def test_behind_the_hull_port_mirrors_starboard():
    X = motion("behind hull", "validation")
    there, back = behind_hull(X, ship_wake()), behind_hull(X * [1, -1], ship_wake())
    np.testing.assert_allclose(there[:, [0, 2]], back[:, [0, 2]], atol=1e-12)
    np.testing.assert_allclose(there[:, 1] - 0.5, 0.5 - back[:, 1], atol=1e-12)
    assert 0.0 < there.min() and there.max() < 1.0


def test_training_set_has_the_steady_points_twenty_times_and_the_documented_noise():
    """Section 4.1: five steady J, repeated twenty times, beside the unsteady snapshots."""
    noisy, clean = series("behind hull", "training", 5), series("behind hull", "training", 5, 0.0)
    steady = noisy.X[70:]
    assert noisy.X.shape == (170, 2) and (steady[:, 1] == 0.0).all()
    values, counts = np.unique(steady[:, 0], return_counts=True)
    assert values.tolist() == [0.1, 0.3, 0.5, 0.7, 0.9] and set(counts) == {20}
    np.testing.assert_array_equal(noisy.Y[70:], clean.Y[70:])
    assert (noisy.Y - clean.Y)[:70].std() == pytest.approx(NOISE["behind hull"], rel=0.15)
    again, other = (series("behind hull", "training", s).Y for s in (5, 6))
    np.testing.assert_array_equal(noisy.Y, again)
    assert (noisy.Y[:70] != other[:70]).all()


def test_noise_is_the_least_printed_loss():
    """1/2 of the sum of three variances."""
    least = read_csv(TESTS).where(condition="behind hull").columns["loss"].min()
    assert 1.5 * NOISE["behind hull"] ** 2 == pytest.approx(least, rel=1e-12)
    assert 1.5 * NOISE["open water"] ** 2 == pytest.approx(3.1e-5, rel=1e-12)  # section 3.1.1
    # the print has it below what the richest regression leaves in training, on a set whose steady
    # half has no noise: that residual is not noise
    rows = read_csv(REGRESSION_ORDER).where(order="network")
    assert least < rows.columns["training_loss"][0]


def test_training_loss_falls_and_validation_loss_rises_with_the_order():
    """Table 4 in kind, medians of ten seeds: a thousandfold at the end.

    Not matched: third order, four times the loss of second in the print, level with it here.
    """
    rows = {o: [] for o in ORDERS}
    for seed in range(10):
        sets = [series("behind hull", c, seed) for c in ("training", "validation")]
        for order in ORDERS:
            rows[order].append(regression_row(order, *sets))
    train, valid = (
        [float(np.median([r[k] for r in rows[o]])) for o in ORDERS]
        for k in ("training_loss", "loss")
    )
    assert (np.diff(train) < 0.0).all()
    assert valid[3] > 10.0 * valid[2] > 100.0 * valid[1]
    assert valid[1] == pytest.approx(valid[0], rel=0.1)  # the gap: fails when it closes


def test_unknown_cases():
    with pytest.raises(ConfigError, match="did you mean 'behind hull'"):
        motion("behind hul", "training")
    with pytest.raises(ConfigError, match="did you mean 'validation'"):
        motion("behind hull", "validaton")
    with pytest.raises(ConfigError, match="at least one seed"):
        compare_seeds(range(0))


def test_a_short_comparison_has_every_row():
    (found,) = compare([0], iterations=300)
    assert set(found["orders"]) == set(ORDERS)
    stopped, end = found["stopping"]["stopped"], found["stopping"]["end"]
    assert stopped["loss"] <= end["loss"]
    assert stopped["loss"] == pytest.approx(loss([stopped[k] for k in ("K_T", "K_S", "K_Q")]))


def test_in_open_water_the_regression_comes_to_the_printed_loss():
    """Section 3.2.2 prints 5.13e-5 (4.4e-5 by its own errors); the noise alone makes 3.1e-5."""
    found = [one["rows"]["test, second"]["loss"] for one in open_water_test(range(5), 10)]
    assert 3.1e-5 < np.median(found) < 5.13e-5


@pytest.mark.slow  # thirty trainings of 5000 iterations, ten at a time
def test_the_network_with_early_stopping_beats_the_second_order_on_thrust_and_torque():
    """Tables 3 and 4 and test 3 in kind, medians of ten seeds.

    Not matched: the side force, where the printed network is level with second order (1.9e-2
    against 1.8e-2) and ours is twice as far off, and with it the losses.
    """
    found = compare_seeds(range(10))
    stopped, second = found["stopping"]["stopped"], found["orders"]["second"]
    assert stopped["K_T"] < second["K_T"] and stopped["K_Q"] < second["K_Q"]
    for where in ("stopped network beats second order", "test 3: network beats second order"):
        for name in ("K_T", "K_Q"):
            assert found["held"][f"{where} on {name}"] >= 0.7, (where, name)
    # the side force is the documented gap: this fails when it closes, so that the text changes
    assert stopped["K_S"] > 1.5 * second["K_S"]
    # section 3.1.1: twice; the network with few features predicts alike
    assert found["slower"] > 1.2
    losses = [found["open_water"][f"test, {k}"]["loss"] for k in NETWORKS.values()]
    assert losses[1] == pytest.approx(losses[0], rel=0.25)
    by_level = [found["stopping"][k]["loss"] for k in ("1.0e-03", "1.0e-04", "stopped", "end")]
    assert by_level[0] > by_level[1] > by_level[2] < by_level[3]
