import numpy as np
import pytest
from ship_gym_agents.sb3.rudder_price import RudderMeter, RudderPrice
from ship_gym_agents.sb3.sections import Price

from ship_gym.tasks.measures import reversals


def test_the_meter_counts_as_the_measures_of_a_trajectory():
    angles = np.cumsum(np.random.default_rng(0).normal(0.0, 0.6, (400, 5)), axis=0)
    meter = RudderMeter(5)
    meter.restart(np.arange(5), angles[0])
    travel, turns = np.zeros(5), np.zeros(5)
    for angle in angles[1:]:
        moved, turned = meter(angle)
        travel += moved
        turns += turned
    np.testing.assert_allclose(travel, np.abs(np.diff(angles, axis=0)).sum(axis=0))
    assert turns.tolist() == [reversals(column) for column in angles.T]
    assert turns.min() > 5


def test_a_row_that_restarts_has_not_moved():
    meter = RudderMeter(2)
    meter.restart(np.arange(2), np.zeros(2))
    meter(np.array([10.0, 10.0]))
    meter.restart(np.array([1]), np.array([-20.0]))
    travel, turned = meter(np.array([5.0, -25.0]))
    assert travel.tolist() == [5.0, 5.0]
    assert turned.tolist() == [True, False]  # the second one has no direction yet


def sailed(price, degrees, interval=1.0):
    """A price after one rollout in which each of 100 ships moved so many degrees an interval."""
    made = RudderPrice(price, interval)
    everyone = np.ones(100, dtype=np.bool_)
    for _ in range(200):
        made.cost(np.full(100, degrees), np.zeros(100, dtype=np.bool_), everyone)
    return made


def test_cost_of_travel_and_reversals_by_hand():
    price = RudderPrice(Price(travel=0.1, reversals=2.0), 1.0)
    live = np.array([True, True, False])
    cost = price.cost(np.array([3.0, 0.0, 9.0]), np.array([False, True, True]), live)
    np.testing.assert_allclose(cost[:2], [0.3, 2.0])
    assert price.rate_so_far() == pytest.approx(3.0 / 2 * 3600.0)  # deg/h of the live ones


def test_travel_above_the_limit_raises_the_price_and_below_lowers_it():
    config = Price(travel=0.01, limit="1800", rate=0.004)
    above = sailed(config, 1.0)  # 3600 deg/h, twice the limit
    assert above.update() and above.travel == pytest.approx(3600.0)
    assert above.travel_price == pytest.approx(0.01 + 0.004)
    below = sailed(config, 0.25)
    assert below.update() and below.travel_price == pytest.approx(0.01 - 0.002)
    still = sailed(Price(travel=0.0, limit="1800", rate=0.004), 0.25)
    assert still.update() and still.travel_price == 0.0
    fixed = sailed(Price(travel=0.01), 1.0)
    assert fixed.update() and fixed.travel_price == 0.01


def test_few_intervals_do_not_change_the_price():
    price = RudderPrice(Price(limit="1.0", rate=1.0), 1.0)
    price.cost(np.ones(10), np.zeros(10), np.ones(10, dtype=np.bool_))
    assert not price.update() and price.travel_price == 0.0


def test_the_state_of_a_price_goes_into_another():
    one = sailed(Price(travel=0.01, limit="base", rate=0.004), 1.0)
    assert one.waits_for_limit
    one.limit = 500.0
    one.update()
    other = RudderPrice(one.config, 1.0)
    other.restore(one.state())
    assert other.state() == one.state() and not other.waits_for_limit
