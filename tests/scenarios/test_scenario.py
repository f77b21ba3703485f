import json
import math
import pickle

import numpy as np
import pytest

from ship_gym import ShipEnv, ShipVectorEnv
from ship_gym.config import ConfigError
from ship_gym.envs.registration import ENVIRONMENTS
from ship_gym.scenarios import available_scenarios, load_scenario


@pytest.mark.parametrize("name", available_scenarios())
def test_every_scenario_loads_and_comes_back_from_json(name):
    scenario = load_scenario(name)
    assert load_scenario(json.loads(json.dumps(scenario.to_dict()))) == scenario


def test_every_id_has_its_scenario():
    assert set(ENVIRONMENTS.values()) <= set(available_scenarios())


@pytest.mark.parametrize("name", available_scenarios())
def test_every_scenario_sails_with_a_model_too(name):
    envs = ShipVectorEnv(3, scenario=name, ship=["kcs", "kvlcc2_model", "onrt"])
    observations, _ = envs.reset(seed=0)
    for _ in range(20):
        observations, rewards, *_ = envs.step(np.zeros(envs.action_space.shape))
    assert envs.observation_space.contains(observations) and (rewards <= 0.0).all()


def test_the_library_holds_each_wave_heading_at_sea_states_4_to_6():
    angles = {"head": 180.0, "bow": 135.0, "beam": 90.0, "quartering": 45.0, "following": 0.0}
    for state in (4, 5, 6):
        for name, angle in angles.items():
            sea = load_scenario(f"heading_ss{state}_{name}").sea
            assert sea.states == (f"ss{state}",) and sea.wave_encounter_deg == angle


def test_an_encounter_angle_is_that_of_the_ship_on_its_order():
    for angle in (180.0, 90.0, 0.0):
        env = ShipEnv(overrides={"sea.wave_encounter_deg": angle})
        for seed in range(5):
            env.reset(seed=seed)
            task = env.episodes.tasks[0]
            mu = math.degrees(task["psi_ordered"] - task["wave_to"])
            assert mu == pytest.approx(angle, abs=1e-9)


def test_states_draw_heights_periods_and_winds_of_their_table():
    env = ShipEnv(overrides={"sea.states": ["ss4", "ss6"]})
    found = []
    for seed in range(120):
        env.reset(seed=seed)
        e = env.episodes
        wind = math.hypot(e.sim.seas["wind_north"][0], e.sim.seas["wind_east"][0])
        height = 4.0 * math.sqrt(0.5 * (e.sim.water.waves_of(0)[0] ** 2).sum())
        assert height == pytest.approx(e.tasks["wave_height"][0])
        found.append((e.tasks["wave_period"][0], height, wind))
    found = np.array(found)
    assert set(found[:, 0]) == {8.8, 12.4}
    rough = found[:, 0] == 12.4
    assert 0.3 < rough.mean() < 0.7
    for pick, heights, winds_kn in ((~rough, (1.25, 2.5), (17, 21)), (rough, (4, 6), (28, 47))):
        assert heights[0] <= found[pick, 1].min() < found[pick, 1].max() <= heights[1]
        to_10_m = 0.514444 * (10.0 / 19.5) ** (1.0 / 7.0)
        low, high = (kn * to_10_m for kn in winds_kn)
        assert low - 1e-3 <= found[pick, 2].min() < found[pick, 2].max() <= high + 1e-3


def test_a_scenario_stands_on_its_base():
    a = load_scenario({"base": "heading_keeping", "duration": 50.0, "reward": {"rudder": 3.0}})
    assert a == load_scenario("heading_keeping", {"duration": 50.0, "reward.rudder": 3.0})
    with pytest.raises(ConfigError, match="did you mean 'heading_keeping'"):
        load_scenario({"base": "heading_keepin"})


def test_a_circle_of_bases_is_refused(tmp_path):
    for one, other in (("a", "b"), ("b", "a")):
        (tmp_path / f"{one}.toml").write_text(f'base = "{tmp_path / other}.toml"\n')
    with pytest.raises(ConfigError, match="circle"):
        load_scenario(tmp_path / "a.toml")


def test_overrides_nested_and_dotted():
    a = load_scenario("heading_keeping", {"reward": {"rudder": 8.0}, "duration": 100})
    b = load_scenario("heading_keeping", {"reward.rudder": 8.0, "duration": 100.0})
    assert a == b and a.reward.rudder == 8.0 and a.steps == 100
    assert a.reward.heading == load_scenario().reward.heading


def test_a_scenario_file_from_outside(tmp_path):
    from ship_gym.scenarios.scenario import _FOLDER

    text = (_FOLDER / "heading_keeping.toml").read_text()
    path = tmp_path / "mine.toml"
    path.write_text(text.replace("duration = 600.0", "duration = 60.0"))
    assert load_scenario(path).steps == 60


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        ({"reward.ruder": 1.0}, ["reward", "ruder", "did you mean 'rudder'"]),
        ({"durations": 1.0}, ["durations", "did you mean 'duration'"]),
        ({"control": "rudders"}, ["control", "did you mean 'rudder'"]),
        ({"task": "parking"}, ["task", "heading_keeping"]),
        ({"control_interval": 0.0}, ["control_interval = 0"]),
        ({"start.heading_error_deg": 70.0}, ["start.heading_error_deg = 70", "below"]),
        ({"duration": 10.4, "control_interval": 4.0}, ["duration = 10.4", "multiple"]),
        ({"reward.heading": -1.0}, ["reward.heading = -1"]),
        ({"sea.current_speed": "fast"}, ["sea.current_speed", "fast"]),
        ({"sea.states": ["ss9"]}, ["unknown sea state 'ss9'"]),
        ({"sea.states": ["ss4"], "sea.wave_height": 2.0}, ["either the states or the numbers"]),
        ({"sea.wind_encounter_deg": 700.0}, ["sea.wind_encounter_deg = 700"]),
        ({"reward.cross_track": 1.0}, ["reward", "unknown key 'cross_track'", "heading"]),
        ({"start.cross_track": 1.0}, ["start", "unknown key 'cross_track'"]),
        ({"limits.cross_track": 1.0}, ["limits", "unknown key 'cross_track'"]),
        ({"course.changes": 2}, ["unknown key 'course'"]),
        ({"track.legs": 2}, ["unknown key 'track'"]),
        ({"sensors.heading_deg": -0.1}, ["sensors.heading_deg = -0.1"]),
        ({"sensor.noise": True}, ["did you mean 'sensors'"]),
        ({"randomisation.hull_std": 0.5}, ["randomisation.hull_std = 0.5", "0 to 0.2"]),
        ({"failure.rudder_rate": 2.0}, ["failure.rudder_rate = 2", "0 to 1"]),
    ],
)
def test_bad_overrides(overrides, words):
    with pytest.raises(ConfigError) as error:
        load_scenario("heading_keeping", overrides)
    for word in words:
        assert word in str(error.value)


@pytest.mark.parametrize(
    ("task", "overrides", "words"),
    [
        ("track_following", {"track.kind": "triangle"}, ["unknown kind of track 'triangle'"]),
        ("track_following", {"track.kind": "points"}, ["track.kind = 'points'", "0 points"]),
        ("track_following", {"track.leg_min": 20.0}, ["track.leg_min = 20"]),
        ("track_following", {"start.cross_track": -1.0}, ["start.cross_track = -1"]),
        ("track_following", {"start.cross_track": 6.0}, ["start.cross_track = 6", "below"]),
        ("track_following", {"reward.heading": 1.0}, ["reward", "unknown key 'heading'"]),
        ("course_changing", {"course.step_min_deg": 70.0}, ["course.step_min_deg = 70"]),
    ],
)
def test_bad_overrides_of_a_task_s_own_keys(task, overrides, words):
    with pytest.raises(ConfigError) as error:
        load_scenario(task, overrides)
    for word in words:
        assert word in str(error.value)


def test_another_task_leaves_behind_what_only_the_old_one_knows():
    on_track = load_scenario("heading_keeping", {"task": "track_following"})
    assert not hasattr(on_track.reward, "heading") and on_track.reward.rudder == 0.1
    assert on_track.limits.cross_track == 5.0 and on_track.start.heading_error_deg == 30.0
    back = load_scenario({"base": "track_square", "task": "heading_keeping"})
    assert not hasattr(back, "track") and back.limits.heading_error_deg == 180.0


def test_scenarios_of_a_task_can_be_pickled():
    scenario = load_scenario("track_square")
    assert pickle.loads(pickle.dumps(scenario)) == scenario


def test_unknown_scenario():
    with pytest.raises(ConfigError, match="did you mean 'heading_keeping'"):
        load_scenario("heading_keepin")
