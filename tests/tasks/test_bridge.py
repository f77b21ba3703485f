import math
from typing import NamedTuple

import numpy as np
import pytest

from ship_gym.conventions import DELTA, N_STATES, N, R, U, V
from ship_gym.envs.env import ShipEnv
from ship_gym.tasks import TASKS, observations_of
from ship_gym.tasks.bridge import N_BRIDGE, record_dtype
from ship_gym.tasks.columns import observation_columns
from ship_gym.tasks.rewards import COSTS, Costs, costs


@pytest.fixture
def task():
    record = np.zeros(1, record_dtype(TASKS["heading_keeping"]))[0]
    record["speed"], record["interval"], record["rudder_stroke"] = 8.0, 2.0, 0.04
    record["termination"] = 50.0
    for i, name in enumerate(("heading", "rudder", "rudder_rate", "speed_loss")):
        record[name] = float(i + 1)
    return record


class Calm(NamedTuple):
    V_north: float = 0.0
    V_east: float = 0.0


def state(u=0.0, delta=0.0):
    found = np.zeros(N_STATES)
    found[[U, DELTA]] = u, delta
    return found


def test_cost_terms_by_hand(task):
    terms = costs(state(6.0, -0.3), state(9.0, -0.32), Calm(), task, False)
    expected = (-4.0 * 0.09, -6.0 * 0.25, -8.0 * 0.0625, 0.0)
    np.testing.assert_allclose(terms, expected)
    assert Costs._fields == tuple(term.name for term in COSTS)


def test_failing_costs_once_and_speed_gain_is_not_paid(task):
    terms = costs(state(9.0), state(), Calm(), task, True)
    assert terms.speed_loss == 0.0 and terms.termination == -50.0


def test_observations_are_limited_to_their_bounds():
    env = ShipEnv(overrides={"sensors.noise": False})
    env.reset(seed=0)
    episodes = env.episodes
    U0, L = episodes.tasks["speed"][0], episodes.tasks["L"][0]
    for sign in (-1.0, 1.0):
        episodes.sim.state[0, [U, V, R]] = 9.0 * sign * U0, 9.0 * sign * U0, 9.0 * sign * U0 / L
        episodes.observe()
        seen = dict(zip(observation_columns(env.scenario), episodes.observations[0], strict=True))
        assert (seen["surge"], seen["sway"], seen["yaw_rate"]) == (
            3.0 * sign,
            3.0 * sign,
            5.0 * sign,
        )


def test_sizes_of_every_task():
    for name in TASKS.own():
        one = TASKS[name]
        assert len(one.terms) == 1
        assert len(one.observations) == {"track_following": 6}.get(name, 0)
        rows = observations_of(name, True)
        assert len(rows) == N_BRIDGE + len(one.observations) + 26
        assert len({row.name for row in rows}) == len(rows)
        for row in rows:
            assert row.name.isidentifier() and row.symbol and row.meaning and row.low < row.high


def test_power_is_that_of_torque_and_propeller_speed_at_one_instant():
    env = ShipEnv(control="rudder+rpm", overrides={"control_interval": 5.0})
    env.reset(seed=0)
    for action in (-1.0, 1.0):
        n = env.episodes.sim.state[0, N]
        *_, info = env.step(np.array([0.0, action]))
        assert info["power"] == pytest.approx(2.0 * math.pi * n * info["flow"]["torque"])
        assert env.episodes.sim.state[0, N] != pytest.approx(n, rel=0.01)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_actions_beyond_their_bounds_are_commands_at_the_bounds(sign):
    env = ShipEnv(control="rudder+rpm")
    env.reset(seed=0)
    env.step(np.array([3.0 * sign, 3.0 * sign]))
    rudder, propeller = env.episodes.sim.commands[0]
    assert rudder == sign * env.ship.gear.delta_max
    assert propeller == (env.ship.engine.n_max if sign > 0.0 else 0.0)
