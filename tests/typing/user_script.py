"""A user's typed script: never run, checked by mypy --strict in test_typing.py.

``assert_type`` fails the check where a public name has become ``Any`` or another type.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, assert_type

import gymnasium as gym
import numpy as np
import ship_gym_agents

import ship_gym
from ship_gym import Route, Sea, Ship, ShipEnv, ShipSim, ShipVectorEnv, Track, Trajectory
from ship_gym.evaluation import Rollout, metrics, rollout
from ship_gym.evaluation.controller import Controller
from ship_gym.manoeuvres import TurningCircle, turning_circle
from ship_gym.scenarios import Scenario


class Bow:
    """A controller of one's own, with the types of the protocol."""

    name = "bow"

    def reset(self, count: int, ship: Ship, scenario: Scenario) -> None:
        """Begin `count` episodes."""
        self.gain = ship.hull.L

    def act(self, observations: np.ndarray[Any, np.dtype[Any]]) -> np.ndarray[Any, np.dtype[Any]]:
        """Actions, shape (count, 1)."""
        return observations[:, :1]


def ships_and_seas() -> None:
    """Look-ups by name."""
    assert_type(ship_gym.available_ships(), list[str])
    assert_type(ship_gym.load_ship("kvlcc2_model"), Ship)
    assert_type(ship_gym.load_ship("kvlcc2_model").hull.L, float)
    assert_type(ship_gym.load_sea("calm"), Sea)
    assert_type(ship_gym.load_track([[0.0, 0.0], [100.0, 0.0]]), Track)
    assert_type(ship_gym.load_route(Path("route.rtz")), Route)
    assert_type(ship_gym.load_scenario("heading_keeping"), Scenario)


def sailing() -> None:
    """Environments, the simulator, a manoeuvre."""
    env = ShipEnv(ship="kvlcc2_model", scenario="heading_keeping")
    assert_type(env.ship, Ship)
    _, info = env.reset(seed=0, options={"heading_error_deg": 10.0})
    assert_type(info, dict[str, Any])
    _, reward, terminated, truncated, _ = env.step(env.action_space.sample())
    assert_type(reward, float)
    assert_type(terminated, bool)
    assert_type(truncated, bool)
    made: gym.Env[Any, Any] = ship_gym.HeadingKeeping(ship="kvlcc2_model")
    made.close()
    many = ShipVectorEnv(4, scenario="heading_keeping")
    many.reset(seed=0)
    assert_type(many.ships, list[Ship])
    ship = ship_gym.load_ship("kvlcc2_model")
    assert_type(turning_circle(ship, delta=math.radians(35.0)), TurningCircle)
    simulation = ShipSim(ship)
    assert_type(simulation, ShipSim)


def judging() -> None:
    """Controllers, rollouts, recordings."""
    own: Controller = Bow()
    pid = ship_gym_agents.make_controller("pid")
    assert_type(pid, Controller)
    for controller in (own, pid):
        sailed = rollout(controller, "heading_keeping", seeds=[1, 2])
        assert_type(sailed, Rollout)
        assert_type(sailed.trajectory(0), Trajectory)
        assert_type(metrics(sailed.trajectory(0)), dict[str, float | None])
    assert_type(Trajectory.from_file("a.rrd")["psi"].tolist(), Any)
