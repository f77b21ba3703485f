import dataclasses
import math

import numpy as np
import pytest
from ship_gym_agents.adaptive import Adaptive, YawEstimate
from ship_gym_agents.lqg import LQG, over_interval
from ship_gym_agents.mpc import MPC
from ship_gym_agents.pid import PID
from ship_gym_agents.rudder_effect import effect_table, interpolated
from ship_gym_agents.wave_filter import LinearShip

from ship_gym import linearise, load_scenario, load_ship
from ship_gym.conventions import DELTA, PSI
from ship_gym.evaluation.rollout import rollout, tuning_seeds

SHIP = LinearShip(Y_v=-0.75, Y_r=-0.36, Y_delta=-0.14, N_v=-4.8, N_r=-2.6, N_delta=1.1)
STEP = 1.0 / 30.0


def estimated(ship, amplitude, intervals=1500, bias=0.0, trust=1e-3, noise=0.0, seed=0):
    """k and a over the nominal ones after a rudder that swings, on the linear ship `ship`."""
    found = YawEstimate(SHIP, 1, STEP, 30.0, 0.3, trust)
    A, B = over_interval(ship, STEP)
    x, rng = np.zeros(4), np.random.default_rng(seed)
    for k in range(intervals):
        wanted = amplitude * math.sin(0.05 * k) + 0.5 * amplitude * math.sin(0.013 * k)
        x[3] += bias
        x = A @ x + B[:, 0] * (wanted - (x[3] - bias))
        x[3] -= bias
        r = x[2] + noise * rng.standard_normal()
        k_hat, a_hat = found(np.array([r]), np.array([x[1]]), np.array([x[3]]))
    return k_hat[0], a_hat[0]


@pytest.mark.parametrize(("k", "a"), [(1.0, 1.0), (1.4, 1.0), (0.7, 1.3), (1.2, 0.8)])
def test_another_ship_is_found(k, a):
    """Effect of the rudder and damping from a swinging rudder, under a steady moment too."""
    ship = dataclasses.replace(SHIP, N_delta=k * SHIP.N_delta, N_r=a * SHIP.N_r)
    for bias in (0.0, 0.02):
        assert estimated(ship, 0.15, bias=bias) == pytest.approx((k, a), rel=0.05)


def test_without_excitation_the_nominal_ship_is_believed():
    """Sensor noise alone, rudder amidships: no estimate that could do harm."""
    ship = dataclasses.replace(SHIP, N_delta=2.0 * SHIP.N_delta)
    for seed in range(5):
        found = estimated(ship, 0.0, trust=0.5, noise=1e-3, seed=seed)
        assert found == pytest.approx((1.0, 1.0), abs=0.05)


def test_estimates_are_bounded():
    wild = dataclasses.replace(SHIP, N_delta=4.0 * SHIP.N_delta)
    k, a = estimated(wild, 0.05)
    assert 0.5 <= a <= 2.0 and k == 2.0
    broken = YawEstimate(SHIP, 1, STEP, 30.0, 0.3, 0.1)
    for value in (0.1, math.nan):
        k, a = broken(np.array([value]), np.array([0.0]), np.array([0.1]))
    assert (k[0], a[0]) == (1.0, 1.0)


def test_table_of_effects_in_numbers():
    """At the nominal point 1; at another that of the linearised ship; held beyond the edges."""
    ship = load_ship("kcs")
    table, n0 = effect_table(ship), linearise(ship).n0
    one = interpolated(table, np.array([1.0, 0.7, 9.0]), np.array([1.0, 0.5, 9.0]))
    assert one[0] == pytest.approx(1.0)
    other = linearise(ship, 0.7 * ship.speed, 0.5 * n0).B[2, 0] / linearise(ship).B[2, 0]
    assert one[1] == pytest.approx(other) and other < 0.5
    assert one[2] == table[-1, -1]
    between = interpolated(table, np.array([0.925]), np.array([1.0]))[0]
    assert between == pytest.approx(0.5 * (table[3, 3] + table[4, 3]))


def test_without_schedule_and_learning_it_is_the_pid():
    gains = Adaptive.first_gains(load_ship("kcs"))
    still = dataclasses.replace(gains, schedule=0.0, learning=0.0)
    both = [
        rollout(c, seeds=tuning_seeds(2), parallel=False, overrides={"duration": 120.0})
        for c in (PID(gains.pid), Adaptive(still))
    ]
    assert np.array_equal(*(sailed.histories["states"] for sailed in both))


@pytest.mark.parametrize(("kind", "within"), [(Adaptive, 1e-9), (LQG, 1e-9), (MPC, 1e-3)])
def test_half_the_effect_calls_for_twice_the_rudder(kind, within):
    """At 70 % of the speed and half the propeller speed, small error, no bias yet."""
    ship, scenario = load_ship("kcs"), load_scenario()
    gains = kind.first_gains(ship)
    if kind is Adaptive:
        gains = dataclasses.replace(gains, learning=0.0)
    seen = np.zeros((1, 9))
    seen[0, :2] = math.sin(0.002), math.cos(0.002)
    found = []
    for surge, share in ((1.0, 1.0), (0.7, 0.5)):
        made = kind(gains)
        made.reset(1, ship, scenario)
        seen[0, 3], seen[0, 6] = surge, share / made._schedule.turns_by
        found.append(made.act(seen)[0, 0])
    effect = interpolated(effect_table(ship), np.array([0.7]), np.array([0.5]))[0]
    assert found[1] / found[0] == pytest.approx(1.0 / effect, rel=within)


def test_scheduling_pays_in_a_thrust_loss():
    """Mean J of the drill on 16 tuning seeds; on 64 it was 53.8 against 62.2 of the pid."""
    gains = Adaptive.first_gains(load_ship("kcs"))
    costs = []
    for controller in (PID(gains.pid), Adaptive(gains)):
        sailed = rollout(controller, "drill_thrust_loss", seeds=tuning_seeds(16), parallel=False)
        states = sailed.histories["states"][1:]
        error = states[:, :, PSI] - sailed.histories["psi_ordered"][:-1]
        error = np.angle(np.exp(1j * error))
        costs.append(np.mean(error**2 + 0.1 * states[:, :, DELTA] ** 2))
    assert costs[1] < costs[0]
