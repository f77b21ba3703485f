"""A scenario at a share of the ship's nominal speed: that share is U0 everywhere."""

import math

import numpy as np
import pytest

from ship_gym import ShipVectorEnv
from ship_gym.config import ConfigError
from ship_gym.conventions import N, U
from ship_gym.envs.env import ShipEnv
from ship_gym.evaluation.controller import ConstantController
from ship_gym.evaluation.rollout import rollout
from ship_gym.scenarios.scenario import load_scenario
from ship_gym.ships import load_ship
from ship_gym.simulation import longest_step, self_propulsion
from ship_gym.tasks.columns import observation_columns

CALM = {"sea.states": [], "sea.gusts": False, "sea.current_speed": 0.0, "sensors.noise": False}
SLOW = CALM | {"speed": 0.4, "start.heading_error_deg": 0.0}
COLUMNS = observation_columns(load_scenario("heading_keeping"))


@pytest.mark.parametrize("ship", ["kcs", "kvlcc2_model", "onrt"])
def test_she_sails_at_the_share_and_holds_it(ship):
    env = ShipEnv(ship=ship, overrides=SLOW)
    obs, _ = env.reset(seed=1)
    speed = 0.4 * load_ship(ship).speed
    state = env.episodes.sim.state[0]
    assert env.ship.speed == pytest.approx(speed, rel=1e-15) and state[U] == env.ship.speed
    assert state[N] == self_propulsion(load_ship(ship), env.ship.speed)
    assert obs[COLUMNS["surge"]] == 1.0
    before = state[N]
    for _ in range(60):
        obs, _, _, _, info = env.step(np.zeros(1))
    assert obs[COLUMNS["surge"]] == pytest.approx(1.0, abs=2e-3)
    assert state[N] == pytest.approx(before, rel=1e-4)
    assert info["reward_terms"]["speed_loss"] == pytest.approx(0.0, abs=1e-6)


def test_the_same_motion_reads_the_same_at_another_speed():
    """r' = r L / U0 and u' = u / U0 with U0 of the scenario: turns are alike."""
    found = []
    for speed in (1.0, 0.5):
        env = ShipEnv(overrides=SLOW | {"speed": speed, "duration": 600.0})
        env.reset(seed=1)
        for _ in range(round(60.0 / speed)):
            obs, *_ = env.step(np.array([0.2]))
        found.append(COLUMNS.view(obs[None]))
    fast, slow = found
    # gear and engine keep their own rates, so not the same
    for name, tolerance in (("yaw_rate", 0.03), ("surge", 0.01), ("sway", 0.03)):
        a, b = getattr(fast, name)[0], getattr(slow, name)[0]
        assert b == pytest.approx(a, rel=tolerance), name


def test_full_ahead_from_a_low_speed_is_no_divergence():
    """The fastest that a ship may be counts by her own nominal speed."""
    env = ShipEnv(control="rudder+rpm", overrides=SLOW | {"speed": 0.3, "duration": 1500.0})
    env.reset(seed=1)
    terminated, fastest = False, 0.0
    for _ in range(1500):
        _, _, terminated, truncated, info = env.step(np.array([0.0, 1.0]))
        fastest = max(fastest, env.episodes.sim.state[0, U] / env.ship.speed)
        if terminated or truncated:
            break
    assert fastest > 3.0
    assert env.episodes.task.all_outcomes[info["outcome"]].name != "diverged"


def test_a_ship_given_back_is_not_slowed_down_twice():
    ship = load_ship("kcs")
    slow = ship.at_share(0.4)
    assert slow.at_share(0.4) is slow and slow.at_share(1.0).speed == pytest.approx(ship.speed)
    assert slow.share == 0.4 and slow.file_speed == pytest.approx(ship.speed, rel=1e-15)
    assert ship.at_share(1.0) is ship
    first = ShipEnv(overrides=SLOW)
    again = ShipEnv(ship=first.ship, overrides=SLOW)
    assert again.ship.speed == first.ship.speed
    assert ShipEnv(ship=first.ship).ship.speed == pytest.approx(ship.speed)


def test_integration_steps_are_no_longer_than_those_of_the_ship_herself():
    ship = load_ship("kcs")
    assert longest_step(ship.at_share(0.5)) == longest_step(ship)
    assert longest_step(ship.at_share(2.0)) == pytest.approx(0.5 * longest_step(ship))


def test_rows_are_scalars_and_a_fleet_has_the_speed_of_each():
    overrides = {"speed": 0.6, "duration": 6.0}
    ships = ["kcs", "kvlcc2"]
    many = ShipVectorEnv(4, ship=ships, overrides=overrides)
    ones = [ShipEnv(ship=ships[k % 2], overrides=overrides) for k in range(4)]
    seen = many.reset(seed=[4, 5, 6, 7])[0]
    np.testing.assert_array_equal(seen, [e.reset(seed=4 + k)[0] for k, e in enumerate(ones)])
    for _ in range(5):
        seen = many.step(np.full((4, 1), 0.3))[0]
        np.testing.assert_array_equal(seen, [e.step(np.array([0.3]))[0] for e in ones])
    for k, name in enumerate(ships):
        expected = 0.6 * load_ship(name).speed
        assert many.episodes.tasks["speed"][k] == pytest.approx(expected)
        assert many.episodes.ships[k].speed == pytest.approx(expected)


@pytest.mark.parametrize("control", ["rudder", "rudder+rpm"])
def test_a_recording_and_the_constant_controller_know_the_speed(control):
    scenario = load_scenario("heading_keeping", SLOW | {"control": control, "duration": 30.0})
    trajectory = rollout(ConstantController(), scenario, seeds=[1]).trajectory(0)
    assert trajectory.meta["ship"]["speed"] == pytest.approx(0.4 * load_ship("kcs").speed)
    assert trajectory.meta["config"]["speed"] == 0.4
    n = self_propulsion("kcs", trajectory.meta["ship"]["speed"])
    np.testing.assert_allclose(trajectory["n_command"], n, rtol=1e-9)


def test_a_speed_that_the_engine_cannot_give_is_told():
    with pytest.raises(ConfigError, match=r"kvlcc2 cannot hold .* m/s"):
        ShipEnv(ship="kvlcc2", overrides=CALM | {"speed": 2.0})


@pytest.mark.parametrize("speed", [0.0, 0.09, 2.1, math.nan])
def test_a_share_that_is_none_is_refused(speed):
    with pytest.raises(ConfigError, match="speed = "):
        load_scenario("heading_keeping", {"speed": speed})
