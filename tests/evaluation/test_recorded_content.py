"""What a recording of an episode holds beside its motion, live and read back from its file."""

import math

import numpy as np
import pytest
from ship_gym_agents.controllers import make_controller, shipped_file

from ship_gym import ShipEnv, load_ship
from ship_gym.config import ConfigError
from ship_gym.envs.episodes import EpisodeBatch
from ship_gym.evaluation import metrics, rollout
from ship_gym.evaluation.controller import ConstantController
from ship_gym.provenance import sha256
from ship_gym.recording import Trajectory
from ship_gym.tasks import TASKS, observations_of

SHORT = {"duration": 30.0}
TASKS_SAILED = ("heading_keeping", "course_changing", "track_following")


class Steps:
    """Actions beyond the limits too, another one in every interval."""

    name = "steps"

    def reset(self, count, ship, scenario):
        self.count, self.seen = count, []

    def act(self, observations):
        self.seen.append(observations.copy())
        return np.tile(1.2 * math.sin(len(self.seen)), (self.count, 1))


@pytest.mark.parametrize("task", TASKS_SAILED)
def test_metrics_computed_from_the_file_are_the_live_ones_bit_for_bit(tmp_path, task):
    pytest.importorskip("rerun")
    files = {0: tmp_path / "a.rrd", 2: tmp_path / "b.rrd"}
    given = {"seeds": [4, 5, 6], "overrides": {"duration": 120.0}}
    found = rollout(Steps(), task, record=files, **given)
    for i, file in files.items():
        live, read = found.trajectory(i), Trajectory.from_rrd(file)
        assert metrics(read) == read.meta["metrics"] == live.meta["metrics"] == metrics(live)
        assert read.meta == live.meta
        assert read.names == live.names
        assert all(read[name].tobytes() == live[name].tobytes() for name in live.names)
    again = rollout(Steps(), task, record={1: tmp_path / "c.rrd"}, **{**given, "seeds": [9, 6]})
    second, third = Trajectory.from_rrd(files[2]), again.trajectory(1)
    assert second.meta == third.meta  # two recordings of one seed
    assert all(second[name].tobytes() == third[name].tobytes() for name in second.names)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.rrd", "b.rrd", "c.rrd"]


def test_observations_are_those_the_controller_saw_and_actions_are_raw():
    steps = Steps()
    for task in TASKS_SAILED:
        t = rollout(steps, task, seeds=[3], overrides=SHORT).trajectory(0)
        seen = np.array(steps.seen)[:, 0]
        names = [row.name for row in observations_of(task, False)]
        assert t.meta["observations"] == names and t.meta["actions"] == ["rudder"]
        for k, name in enumerate(names):
            assert np.array_equal(t[f"observation_{name}"][:-1], seen[:, k]), name
        given = [1.2 * math.sin(k + 1) for k in range(30)]
        assert t["action_rudder"].tolist() == [*given, given[-1]]
        assert np.abs(t["delta_command"]).max() <= math.radians(35.0) < np.abs(given).max()


def test_the_heading_that_the_observation_shows():
    """Waves and noise and the error of the compass, 7 deg from 10 s on; float32 holds 1e-6 rad."""
    calm = {"sea.states": [], "sea.gusts": False, "sensors.noise": False, "duration": 20.0}
    t = rollout(ConstantController(), seeds=[3], overrides=calm).trajectory(0)
    np.testing.assert_allclose(t["psi_measured"], t["psi"], atol=1e-6)
    off = {"failure.heading_bias_deg": 7.0, "failure.time": 10.0}
    t = rollout(ConstantController(), seeds=[3], overrides=calm | off).trajectory(0)
    error = np.degrees(t["psi_measured"] - t["psi"])
    np.testing.assert_allclose(error, np.where(t["t"] < 10.0, 0.0, 7.0), atol=1e-4)
    sea = {"sea.states": ["ss6"], "sensors.noise": False, "duration": 60.0}
    t = rollout(ConstantController(), seeds=[3], overrides=sea).trajectory(0)
    np.testing.assert_allclose(t["psi_measured"], t["psi"] + t["wave_yaw"], atol=1e-6)
    assert np.abs(t["wave_yaw"]).max() > 1e-4


def test_a_scenario_is_recorded_by_the_name_it_was_asked_by(tmp_path):
    own = tmp_path / "mine.toml"
    own.write_text('base = "drill_thrust_loss"\nduration = 40.0\n')
    changed = {"duration": 20.0, "failure.time": 5.0}
    drill = {"duration": 20.0, "failure": {"time": 5.0}}
    for given, source, overrides, expected in (
        ("drill_thrust_loss", "drill_thrust_loss", changed, drill),
        (str(own), str(own), {}, {}),
        (str(own), str(own), {"duration": 20.0}, {"duration": 20.0}),
        ({"base": "drill_thrust_loss"}, "drill_thrust_loss", changed, drill),
    ):
        sailed = rollout(ConstantController(), given, seeds=[1], overrides=overrides)
        meta = sailed.trajectory(0).meta
        assert (meta["task"], meta["scenario"]) == ("heading_keeping", source)
        assert meta["overrides"] == expected
        assert meta["config"]["failure"]["propeller_speed"] is not None
    again = rollout(ConstantController(), meta["config"], seeds=[1]).trajectory(0).meta
    assert again["scenario"] == "heading_keeping"
    lost = {key: meta["config"]["failure"][key] for key in ("time", "propeller_speed")}
    assert again["overrides"] == {"duration": 20.0, "failure": lost}
    assert again["config"] == meta["config"]


def test_what_was_given_to_the_environment_are_overrides_too():
    env = {"ship": "kvlcc2", "control": "rudder+rpm", "overrides": SHORT}
    meta = rollout(ConstantController(), seeds=[1], **env).trajectory(0).meta
    assert meta["overrides"] == {"ship": "kvlcc2", "control": "rudder+rpm", **SHORT}
    steps = ShipEnv(max_episode_steps=25)
    assert steps.scenario.overrides() == {"duration": 25.0}


def test_the_file_of_a_policy_and_its_hash(tmp_path):
    policy = make_controller("ppo_kcs")
    meta = rollout(policy, seeds=[1], overrides=SHORT).trajectory(0).meta
    file = shipped_file("ppo_kcs")
    assert meta["policy"] == {"file": str(file), "sha256": sha256(file)}
    assert (
        rollout(ConstantController(), seeds=[1], overrides=SHORT).trajectory(0).meta["policy"]
        is None
    )


def test_the_sea_in_degrees_for_people_and_its_waves():
    given = {"sea.states": ["ss5"], "sea.wave_encounter_deg": 180.0, "duration": 10.0}
    given |= {"sea.current_speed": 1.0, "sea.current_speed_min": 1.0}
    t = rollout(ConstantController(), seeds=[2], overrides=given).trajectory(0)
    sea, waves = t.meta["sea"], t.meta["waves"]
    ordered = math.degrees(t["psi_ordered"][0]) % 360.0
    assert sea["wave_from_deg"] == pytest.approx(ordered, abs=1e-9)  # a head sea
    assert sea["wind_from_deg"] == pytest.approx(math.degrees(t["wind_direction_from"][0]))
    assert sea["current_to_deg"] == pytest.approx(math.degrees(t["current_direction_to"][0]))
    assert sea["current_speed"] == pytest.approx(1.0)
    height = 4.0 * math.sqrt(0.5 * np.square(waves["amplitude"]).sum())
    assert height == pytest.approx(sea["wave_height"], rel=1e-9)
    assert t["waves_extrapolation"].shape == t["t"].shape and "extrapolation" in t
    calm = {"sea.states": [], "sea.gusts": False, "sea.current_speed": 0.0, "duration": 10.0}
    meta = rollout(ConstantController(), seeds=[2], overrides=calm).trajectory(0).meta
    assert meta["waves"] is None
    degrees = ("wave_from_deg", "wind_from_deg", "current_to_deg")
    assert [meta["sea"][name] for name in degrees] == [None, None, None]


def test_error_and_limits_of_each_task():
    L = load_ship("kcs").hull.L
    expected = {
        "heading_keeping": ("psi_error", {"rudder_deg": 35.0, "heading_error_deg": 60.0}),
        "track_following": ("off_route", {"rudder_deg": 35.0, "cross_track": 5.0 * L}),
    }
    for task in TASKS_SAILED:
        t = rollout(ConstantController(), task, seeds=[2], overrides=SHORT).trajectory(0)
        assert t.meta["error"]["column"] in t.names
        assert t.meta["kind"] == "episode" and t.complete
        if task in expected:
            column, limits = expected[task]
            assert t.meta["error"]["column"] == column
            assert {k: t.meta["limits"].get(k) for k in limits} == pytest.approx(limits)
    batch = EpisodeBatch(1, ShipEnv(scenario="track_following").scenario)
    assert t.meta["limits"]["corridor"] == batch.tasks["corridor"][0]
    assert t.meta["limits"]["cross_track"] == batch.tasks["cross_limit"][0]


def test_a_rollout_that_breaks_off_leaves_what_it_has(tmp_path):
    pytest.importorskip("rerun")

    class Stops(Steps):
        def act(self, observations):
            if len(self.seen) == 40:
                raise KeyboardInterrupt
            return super().act(observations)

    with pytest.raises(KeyboardInterrupt):
        rollout(Stops(), seeds=[1, 2], overrides={"duration": 60.0}, record={1: tmp_path / "a.rrd"})
    (left,) = tmp_path.iterdir()
    found = Trajectory.from_file(left)
    whole = rollout(Steps(), seeds=[2], overrides={"duration": 60.0}).trajectory(0)
    assert left.name == "a.rrd.partial" and len(found) == 40 and not found.complete
    assert all(np.array_equal(found[name], whole[name][:40]) for name in whole.names)


def test_a_wrong_record_is_refused_before_sailing(tmp_path):
    class Never(ConstantController):
        def act(self, observations):
            raise AssertionError

    for record, said in (
        ({2: tmp_path / "a.rrd"}, "record: episode 2: allowed are 0 to 1"),
        ([tmp_path / "a.rrd"], "record = .* must map"),
        ({0: tmp_path / "a.csv"}, "a recording is a file"),
    ):
        with pytest.raises(ConfigError, match=said):
            rollout(Never(), seeds=[1, 2], overrides=SHORT, record=record)
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="file"):
        rollout(Never(), seeds=[1], overrides=SHORT, record={0: tmp_path / "file" / "a.rrd"})
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_every_task_says_which_column_is_its_error():
    for name in TASKS.own():
        assert TASKS[name].error_column is not None
