"""The action of rudder+rpm may brake where the scenario allows it, and nowhere else."""

import math

import gymnasium as gym
import numpy as np
import pytest

from ship_gym import action_columns, observation_columns
from ship_gym.config import ConfigError
from ship_gym.conventions import N, U
from ship_gym.envs.env import ShipEnv
from ship_gym.evaluation.controller import ConstantController
from ship_gym.simulation import self_propulsion


def braked(astern, steps, action=-1.0, **overrides):
    env = ShipEnv(
        scenario="course_calm", control="rudder+rpm", overrides={"astern": astern, **overrides}
    )
    observation, _ = env.reset(seed=0)
    seen = [observation]
    for _ in range(steps):
        observation, *_ = env.step(np.array([0.0, action]))
        seen.append(observation)
    return env, np.array(seen)


def test_braking_stops_the_ship_sooner_than_a_stopped_propeller():
    idle, _ = braked(0.0, 200)
    env, seen = braked(0.6, 200)
    assert idle.episodes.sim.state[0, N] >= 0.0 > env.episodes.sim.state[0, N]
    assert env.episodes.sim.state[0, U] < 0.8 * idle.episodes.sim.state[0, U]
    column = observation_columns(env.scenario)["propeller"]
    assert -0.6 <= seen[:, column].min() < 0.0
    assert all(env.observation_space.contains(row) for row in seen)


def test_a_propeller_driven_by_the_water_gives_no_energy_back():
    env = ShipEnv(scenario="course_calm", control="rudder+rpm", overrides={"astern": 0.6})
    env.reset(seed=0)
    energy, power = [], []
    for _ in range(120):
        *_, info = env.step(np.array([0.0, -1.0]))
        energy.append(info["energy"])
        power.append(info["power"])
    assert min(power) < 0.0 < max(power[60:])  # driven first, then working astern
    assert (np.diff(energy) >= 0.0).all()


@pytest.mark.parametrize(("action", "share"), [(-1.0, -0.5), (1.0, 1.0), (-1.0 / 3.0, 0.0)])
def test_range_of_the_command(action, share):
    env, _ = braked(0.5, 1, action)
    command = env.episodes.sim.commands[0, 1]
    assert command == pytest.approx(share * env.ship.engine.n_max, abs=1e-12)


def test_command_goes_no_further_astern_than_the_engine():
    env, _ = braked(1.0, 1)
    assert env.episodes.sim.commands[0, 1] == -env.ship.engine.n_astern


def test_a_failed_engine_is_as_weak_astern():
    failure = {"failure.time": 0.0, "failure.propeller_speed": 0.2}
    env, _ = braked(0.6, 3, **failure)
    order = self_propulsion(env.ship, env.ship.speed)
    assert env.episodes.sim.commands[0, 1] == pytest.approx(-0.2 * order)


def test_without_it_range_and_space_are_as_they_were():
    env, _ = braked(0.0, 1)
    assert env.episodes.sim.commands[0, 1] == 0.0
    column = observation_columns(env.scenario)["propeller_command"]
    assert env.observation_space.low[column] == 0.0
    braking = ShipEnv(scenario="course_calm", control="rudder+rpm", overrides={"astern": 0.6})
    assert braking.observation_space.low[column] == np.float32(-0.6)
    vector = gym.make_vec(
        "ShipGym/CourseChanging-v0", num_envs=2, control="rudder+rpm", overrides={"astern": 0.6}
    )
    assert vector.single_observation_space.low[column] == np.float32(-0.6)
    vector.close()


def test_constant_controller_keeps_self_propulsion_with_brakes_too():
    env = ShipEnv(scenario="course_calm", control="rudder+rpm", overrides={"astern": 0.6})
    still = ConstantController()
    still.reset(1, env.ship, env.scenario)
    env.reset(seed=0)
    env.step(still.act(np.empty((1, 0)))[0])
    order = self_propulsion(env.ship, env.ship.speed)
    assert env.episodes.sim.commands[0, 1] == pytest.approx(order)
    assert action_columns(env.scenario)["rpm"] == 1


@pytest.mark.parametrize("astern", [-0.1, 1.5, math.nan])
def test_bad_range_is_refused(astern):
    with pytest.raises(ConfigError, match="astern"):
        ShipEnv(overrides={"astern": astern})
