import dataclasses
import math

import numpy as np
import pytest
from ship_gym_agents.lqg import LQG, LQGGains, over_interval, regulator
from ship_gym_agents.wave_filter import LinearShip, Observer

from ship_gym import load_scenario, load_ship
from ship_gym.config import ConfigError

SHIP = LinearShip(Y_v=-0.75, Y_r=-0.36, Y_delta=-0.14, N_v=-4.8, N_r=-2.6, N_delta=1.1)
STEP = 1.0 / 30.0
GAINS = LQGGains(Observer(SHIP, 0.5, 2.0, 0.8, 0.05, 0.25))


def cost(K, start, rudder, rate, intervals=3000):
    """Sum of the cost of the linear ship under ``moved = -K x``, times `STEP`."""
    A, B = over_interval(SHIP, STEP)
    x, total = np.array(start), 0.0
    for _ in range(intervals):
        moved = -K @ x
        total += x[0] ** 2 + rudder * x[3] ** 2 + rate * (moved / STEP) ** 2
        x = A @ x + B[:, 0] * moved
    return total


def test_an_interval_by_small_steps():
    A, B = over_interval(SHIP, STEP)
    x, moved, fine = np.array([0.1, 0.02, -0.3, 0.05]), 0.04, 20_000
    y, h = x.copy(), STEP / fine
    for _ in range(fine):
        slope = np.array([y[2], *(SHIP.A @ y[1:3] + SHIP.B * (y[3] + 0.5 * h * moved / STEP)), 0.0])
        slope[3] = moved / STEP
        y = y + h * slope
    assert A @ x + B[:, 0] * moved == pytest.approx(y, rel=1e-5, abs=1e-7)


def test_regulator_is_the_cheapest_and_its_cost_is_as_said():
    start, weights = [0.2, 0.01, -0.1, 0.05], (0.1, 1e-4)
    K, P = regulator(SHIP, STEP, *weights)
    least = cost(K, start, *weights)
    assert least == pytest.approx(np.array(start) @ P @ np.array(start), rel=1e-8)
    for k in range(4):
        for factor in (0.9, 1.1):
            other = K.copy()
            other[k] *= factor
            assert cost(other, start, *weights) > least


def test_arrays_of_weights_give_each_row_its_own_regulator():
    ship, scenario = load_ship("kcs"), load_scenario()
    many = dataclasses.replace(GAINS, rudder=np.array([0.1, 0.4]), rate=np.array([1e-4, 1e-5]))
    both = LQG(many)
    both.reset(2, ship, scenario)
    for k in range(10):
        seen = np.random.default_rng(k).uniform(-0.2, 0.2, (2, 9))
        if k == 0:
            alone = [
                LQG(dataclasses.replace(GAINS, rudder=a, rate=b))
                for a, b in ((0.1, 1e-4), (0.4, 1e-5))
            ]
            for one in alone:
                one.reset(1, ship, scenario)
        rows = [one.act(seen[i : i + 1]) for i, one in enumerate(alone)]
        together = both.act(seen)
        assert np.array_equal(together, np.vstack(rows))
    assert together[0, 0] != together[1, 0]


def test_a_steady_bias_is_carried_by_the_rudder():
    """The linear ship under a yaw moment of 3 deg of rudder, K_b = 1: no error is left."""
    bias, limit = math.radians(3.0), load_ship("kcs").gear.delta_max
    lqg = LQG(dataclasses.replace(GAINS, K_b=1.0))
    lqg.reset(1, load_ship("kcs"), load_scenario())
    A, B = over_interval(SHIP, lqg._step)
    x = np.zeros(4)  # psi, v', r' and the rudder less the bias
    x[3] = -bias
    for _ in range(2500):
        seen = np.zeros((1, 9))
        seen[0, :3] = math.sin(x[0]), math.cos(x[0]), x[2]
        seen[0, 4:6] = x[1], (x[3] + bias) / limit
        wanted = lqg.act(seen)[0, 0] * limit
        moved = np.clip(wanted - x[3] - bias, -lqg._stroke, lqg._stroke)
        x = A @ x + B[:, 0] * moved
    assert abs(x[0]) < math.radians(0.01)
    assert x[3] == pytest.approx(0.0, abs=math.radians(0.01))


def test_wrong_weights_are_refused():
    with pytest.raises(ConfigError, match=r"gains.rate = 0.0: must be positive"):
        dataclasses.replace(GAINS, rate=0.0)
    with pytest.raises(ConfigError, match=r"gains.rudder = -1"):
        dataclasses.replace(GAINS, rudder=-1.0)
