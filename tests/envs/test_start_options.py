"""What an episode starts with when it is told, scalar and vector."""

import math
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest

import ship_gym
from ship_gym.config import ConfigError
from ship_gym.conventions import PSI, X, Y, wrap_angle

HEADING, TRACK = "ShipGym/HeadingKeeping-v0", "ShipGym/TrackFollowing-v0"


def error_deg(env, i=0):
    e = env.unwrapped.episodes
    return np.degrees(wrap_angle(e.sim.state[i, PSI] - e.tasks["psi_ordered"][i]))


@pytest.mark.parametrize("env_id", sorted(ship_gym.ENVIRONMENTS))
def test_heading_error_speed_and_position(env_id):
    env = gym.make(env_id, overrides={"sea.current_speed": 0.0})
    _, drawn = env.reset(seed=3)
    options = {"heading_error_deg": 30, "speed": 5.0, "position": [100.0, -50.0]}
    observation, info = env.reset(seed=3, options=options)
    state = env.unwrapped.episodes.sim.state[0]
    assert error_deg(env) == pytest.approx(30.0)
    assert math.hypot(state[0], state[1]) == pytest.approx(5.0)
    assert state[[X, Y]].tolist() == [100.0, -50.0]
    assert info["psi_ordered"] == drawn["psi_ordered"]  # all else is drawn as without options
    assert env.observation_space.contains(observation)
    assert error_deg(env) != pytest.approx(env.reset(seed=3)[0][0])


def seas(env, i=0):
    e = env.unwrapped.episodes
    waters = e.sim.water
    return np.concatenate(
        [waters.waves_of(i).ravel(), [e.sim.seas["mean_north"][i], e.sim.seas["wind_east"][i]]]
    )


def test_the_sea_of_another_seed():
    env = gym.make(HEADING)
    env.reset(seed=7)
    expected = seas(env)
    env.reset(seed=8)
    assert (seas(env) != expected).any()
    _, info = env.reset(seed=8, options={"sea_seed": 7})
    assert (seas(env) == expected).all()
    assert info["psi_ordered"] == env.reset(seed=8)[1]["psi_ordered"]


def test_a_sea_at_an_encounter_angle_counts_from_the_order_of_the_episode():
    env = gym.make(HEADING, scenario="heading_ss5_bow").unwrapped
    for options in (None, {"sea_seed": 5}):
        env.reset(seed=9, options=options)
        task = env.episodes.tasks[0]
        mu = np.degrees(wrap_angle(task["psi_ordered"] - task["wave_to"]))
        assert mu == pytest.approx(135.0)


def test_vector_is_scalar_with_one_value_for_all_or_one_for_each():
    envs = gym.make_vec(TRACK, num_envs=3)
    errors, positions = np.array([-10.0, 0.0, 20.0]), np.array([[0.0, 0.0], [5.0, 6.0], [7.0, 8.0]])
    options = {
        "heading_error_deg": errors, "speed": 6.5, "position": positions, "sea_seed": [4, 5, 6],
    }  # fmt: skip
    seen, _ = envs.reset(seed=20, options=options)
    for i in range(3):
        env = gym.make(TRACK)
        alone = {
            "heading_error_deg": errors[i], "speed": 6.5, "position": positions[i],
            "sea_seed": 4 + i,
        }  # fmt: skip
        assert (env.reset(seed=20 + i, options=alone)[0] == seen[i]).all()
        assert (seas(env) == seas(envs, i)).all()
    mask = np.array([False, True, False])
    seen, _ = envs.reset(options={"reset_mask": mask, "heading_error_deg": errors})
    assert error_deg(envs, 1) == pytest.approx(0.0)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"heading_error": 30}, "unknown option of reset 'heading_error'; did you mean"),
        ({"heading_error_deg": 200}, r"heading_error_deg.*200.*-180 to 180"),
        ({"heading_error_deg": "left"}, "must be one number"),
        ({"heading_error_deg": [1.0, 2.0]}, "must be one number"),
        ({"position": 3.0}, "must be 2 numbers"),
        ({"speed": math.nan}, "speed"),
        ({"sea_seed": 1.5}, "whole number"),
        ({"sea_seed": -1}, "sea_seed.*-1"),
        ({"speed": 25.0}, r"options\['speed'\] = 25"),
        ([1], "must be a mapping"),
    ],
)
def test_wrong_options_are_refused_and_change_nothing(options, words):
    for env in (gym.make(HEADING).unwrapped, gym.make_vec(HEADING, num_envs=3)):
        env.reset(seed=1)
        before = env.episodes.sim.state.copy()
        with pytest.raises(ConfigError, match=words):
            env.reset(seed=2, options=options)
        assert (env.episodes.sim.state == before).all()


def test_seeds_as_an_array():
    envs = gym.make_vec(HEADING, num_envs=3)
    expected, _ = envs.reset(seed=[5, 9, 2])
    for seeds in (np.array([5, 9, 2]), np.array([5, 9, 2], dtype=np.uint8), (5, 9, 2)):
        assert (envs.reset(seed=seeds)[0] == expected).all()
    for wrong, words in (
        (np.array([1.5, 2.0, 3.0]), r"seed .*1.5.*whole number"),
        (np.array(5), r"seeds of shape \(\) given for 3"),
        (np.array([[5, 9, 2]]), r"seeds of shape \(1, 3\)"),
        ([5, 9], "2 seeds given for 3"),
        ([5, -9, 2], "seed -9"),
        ([True, 1, 2], "seed True"),
        (-1, "seeds of shape|seed"),
    ):
        with pytest.raises(ConfigError, match=words):
            envs.reset(seed=wrong)


@pytest.mark.parametrize("steps", [5, 700])
def test_max_episode_steps_is_obeyed(steps):
    """Longer and shorter than the 600 of the scenario."""
    env = gym.make(HEADING, max_episode_steps=steps, overrides={"limits.heading_error_deg": 180.0})
    envs = gym.make_vec(
        HEADING, num_envs=2, max_episode_steps=steps, overrides={"limits.heading_error_deg": 180.0}
    )
    assert env.spec.max_episode_steps == steps == env.unwrapped.scenario.steps
    env.reset(seed=0)
    envs.reset(seed=0)
    for k in range(1, steps + 1):
        *_, terminated, truncated, info = env.step(np.zeros(1, np.float32))
        _, _, ended, cut, _ = envs.step(np.zeros((2, 1)))
        assert not terminated and truncated == (k == steps) == cut.all() == cut.any()
        assert not ended.any()
    assert info["is_success"]


def test_max_episode_steps_of_a_spec_and_of_the_classes_is_obeyed_too():
    env = gym.make(HEADING, max_episode_steps=900)
    assert gym.make(env.spec).unwrapped.scenario.steps == 900
    assert ship_gym.HeadingKeeping(max_episode_steps=5).scenario.steps == 5
    gym.register(
        "Mine/Long-v0",
        entry_point="ship_gym.envs.classes:HeadingKeeping",
        max_episode_steps=900,
    )
    try:
        assert gym.make("Mine/Long-v0").unwrapped.scenario.steps == 900
    finally:
        del gym.registry["Mine/Long-v0"]
    for make in (gym.make, gym.make_vec):
        assert make(HEADING, max_episode_steps=-1).unwrapped.scenario.steps == 600


def test_max_episode_steps_of_another_environment_is_not_ours():
    """An environment of somebody else that makes one of ours inside."""

    class Outer(gym.Env):
        observation_space = action_space = gym.spaces.Discrete(2)

        def __init__(self):
            self.inner = ship_gym.ShipEnv()

    gym.register("Mine/Outer-v0", entry_point=Outer)
    try:
        env = gym.make("Mine/Outer-v0", max_episode_steps=7, disable_env_checker=True)
        assert env.unwrapped.inner.scenario.steps == 600
    finally:
        del gym.registry["Mine/Outer-v0"]


def test_max_episode_steps_beside_a_shorter_duration_is_refused():
    for make in (gym.make, gym.make_vec):
        with pytest.raises(ConfigError, match=r"max_episode_steps = 5000 and overrides"):
            make(HEADING, max_episode_steps=5000, overrides={"duration": 100.0})
    for steps in (100, 50):  # as long, or shorter
        env = gym.make(HEADING, max_episode_steps=steps, overrides={"duration": 100.0})
        assert env.unwrapped.scenario.steps == steps
    assert gym.make(HEADING, max_episode_steps=-1).unwrapped.scenario.steps == 600


def test_a_ship_by_its_path(tmp_path):
    file = Path(ship_gym.__file__).parent / "ships" / "data" / "kvlcc2" / "ship.toml"
    by_name, by_path = gym.make(HEADING, ship="kvlcc2"), gym.make(HEADING, ship=file)
    assert (by_name.reset(seed=1)[0] == by_path.reset(seed=1)[0]).all()
    fleet = gym.make_vec(HEADING, num_envs=2, ship=[file, "kcs"])
    assert [s.name for s in fleet.ships] == ["kvlcc2", "kcs"]
