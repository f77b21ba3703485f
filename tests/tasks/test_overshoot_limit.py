"""The limit of the overshoot: the first swing past a new order, by hand on given headings."""

import math

import numpy as np
import pytest

from ship_gym import ShipVectorEnv
from ship_gym.config import ConfigError
from ship_gym.conventions import PSI
from ship_gym.envs.env import ShipEnv
from ship_gym.scenarios.scenario import load_scenario

CALM = {"sea.states": [], "sea.gusts": False, "sea.current_speed": 0.0, "sensors.noise": False}
COURSE = CALM | {
    "course.first": 4.0,
    "course.changes": 2,
    "course.step_min_deg": 20.0,
    "course.step_max_deg": 20.0,
    "course.interval_min": 12.0,
    "course.interval_max": 12.0,
    "limits.overshoot_deg": 3.0,
}


def course(overrides=COURSE):
    env = ShipEnv(scenario="course_changing", overrides=overrides)
    env.reset(seed=1)
    return env


def put(env, beyond_deg):
    """Sail an interval from that far past the order, positive on the far side of the turn."""
    task, state = env.episodes.tasks[0], env.episodes.sim.state[0]
    side = task["swing"] if task["swing"] != 0.0 else 1.0
    state[:] = [env.ship.speed, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, task["n_order"]]
    state[PSI] = task["psi_ordered"] + side * math.radians(beyond_deg)
    _, _, terminated, _, _ = env.step(np.zeros(1))
    return terminated, env.episodes.task.all_outcomes[env.episodes.outcomes[0]].name


def until_the_first_step(env):
    for _ in range(4):
        env.step(np.zeros(1))
    task = env.episodes.tasks[0]
    assert task["active"] == 1
    return task


def test_to_swing_past_a_new_order_by_more_than_the_limit_ends_the_episode():
    env = course()
    until_the_first_step(env)
    assert [put(env, deg)[0] for deg in (-20.0, -5.0, 1.0, 2.9)] == [False] * 4
    assert put(env, 3.1) == (True, "overshoot limit")
    assert env.episodes._results["success"][0] == np.False_
    weight = env.episodes.scenario.reward.termination
    assert env.episodes.terms[0, -1] == -weight


def test_the_swing_is_over_with_the_way_back_and_the_next_order_begins_another():
    env = course()
    task = until_the_first_step(env)
    for deg in (-10.0, 2.0, -1.0, 10.0, -10.0):  # back behind the order: then it may lie anywhere
        assert not put(env, deg)[0]
    while task["active"] == 1:
        assert not put(env, 0.0)[0]
    assert task["passed"] == 0
    assert not put(env, -15.0)[0]
    assert put(env, 4.0) == (True, "overshoot limit")


def test_the_side_is_that_of_the_turn_to_either_side():
    sides = set()
    for seed in range(6):
        env = course()
        env.reset(seed=seed)
        task = until_the_first_step(env)
        turn = env.episodes.plans[0, 1, 1] - env.episodes.plans[0, 0, 1]
        side = math.copysign(1.0, (turn + math.pi) % (2.0 * math.pi) - math.pi)
        assert task["swing"] == side
        sides.add(side)
    assert sides == {1.0, -1.0}


def test_before_the_first_step_and_without_a_limit_nothing_ends():
    env = course()
    assert not put(env, 30.0)[0]
    env = course(COURSE | {"limits.overshoot_deg": None})
    until_the_first_step(env)
    assert not put(env, 100.0)[0]


def test_the_heading_limit_comes_first_where_both_are_passed():
    env = course(COURSE | {"limits.heading_error_deg": 40.0})
    until_the_first_step(env)
    assert put(env, 50.0) == (True, "heading limit")


def test_rows_of_a_batch_are_single_episodes():
    """Rudder hard over into every turn and held: all of them pass the order and fail."""
    overrides = COURSE | {"course.interval_min": 300.0, "course.interval_max": 300.0}
    many = ShipVectorEnv(4, scenario="course_changing", overrides=overrides)
    many.reset(seed=[1, 2, 3, 4])
    ones = [ShipEnv(scenario="course_changing", overrides=overrides) for _ in range(4)]
    for k, env in enumerate(ones):
        env.reset(seed=k + 1)
    ended = np.zeros(4, bool)
    for _ in range(120):
        rudder = np.sign(many.episodes.tasks["swing"])[:, None]
        _, rewards, terminated, _, _ = many.step(rudder)
        for k, env in enumerate(ones):
            if not ended[k]:
                _, reward, over, _, info = env.step(rudder[k])
                assert (reward, over) == (rewards[k], terminated[k])
                assert not over or info["outcome"] == 3
        ended |= terminated
        if ended.all():
            break
    assert ended.all()


@pytest.mark.parametrize("value", [0.0, -1.0, 181.0])
def test_a_limit_that_is_none_is_refused(value):
    with pytest.raises(ConfigError, match=r"limits\.overshoot_deg = "):
        load_scenario("course_changing", {"limits.overshoot_deg": value})


def test_a_heading_task_has_no_such_limit():
    with pytest.raises(ConfigError, match="overshoot_deg"):
        load_scenario("heading_keeping", {"limits.overshoot_deg": 3.0})
