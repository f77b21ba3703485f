"""Data sets: what is in them is what the environments do, and what is read is what was written."""

import json
import shutil
import socket
import sys
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest
from ship_gym_agents import make_controller

import ship_gym
from ship_gym.config import ConfigError
from ship_gym.evaluation import rollout
from ship_gym.ships import load_ship

minari = pytest.importorskip("minari")

from ship_gym_agents.datasets import Plan, load_set, read_set, select, write_set  # noqa: E402
from ship_gym_agents.datasets import write as writing  # noqa: E402
from ship_gym_agents.datasets.action_noise import action_noise  # noqa: E402
from ship_gym_agents.datasets.minari_set import room_of  # noqa: E402
from ship_gym_agents.datasets.plan import prepared  # noqa: E402
from ship_gym_agents.datasets.sail import batches, sail  # noqa: E402

SHORT = {"overrides": {"duration": 60.0}}
NAME = "ShipGym/HeadingKeeping/pid-lqg-noise-0-0_1-kcs-v0"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with one set: two controllers, with and without noise, three episodes of each."""
    folder = tmp_path_factory.mktemp("sets")
    plan = Plan(("pid", "lqg"), (0.0, 0.1), episodes=3, seed=5, env=SHORT)
    assert write_set(plan, folder).name == NAME
    return folder


@pytest.fixture(scope="module")
def dataset(folder):
    return load_set(NAME, folder)


def told_of(dataset):
    return list(dataset.storage.get_episode_metadata(dataset.episode_indices))


def replayed(dataset, i, make=gym.make):
    """Sail an episode's actions in the recovered environment; what came, as the set has it."""
    episode, told = dataset[i], told_of(dataset)[i]
    env = dataset.recover_environment()
    seen, info = env.reset(seed=told["seed"])
    rows = [(seen, 0.0, False, False, info)]
    rows += [env.step(action) for action in episode.actions]
    return episode, [np.array(column) for column in list(zip(*rows, strict=True))[:4]], rows


@pytest.mark.parametrize("i", [0, 4, 11])
def test_stored_actions_give_the_episode_again_bit_for_bit(dataset, i):
    episode, (seen, rewards, terminated, truncated), rows = replayed(dataset, i)
    assert np.array_equal(episode.observations, seen)
    assert np.array_equal(episode.rewards, rewards[1:])
    assert np.array_equal(episode.terminations, terminated[1:])
    assert np.array_equal(episode.truncations, truncated[1:])
    infos = dict(episode.infos)
    clean = infos.pop("controller_action")
    assert infos.keys() == rows[0][4].keys()
    for key, values in infos.items():
        assert np.array_equal(values, np.array([row[4][key] for row in rows])), key
    noise = told_of(dataset)[i]["noise"]
    assert np.array_equal(clean[1:].astype(np.float32), episode.actions) == (noise == 0.0)


def test_the_environment_is_the_one_that_sailed(dataset):
    env = dataset.recover_environment()
    assert env.spec.id == "ShipGym/HeadingKeeping-v0"
    assert env.spec.kwargs == {"scenario": "heading_keeping", "info": "flat", **SHORT}
    assert env.unwrapped.scenario.duration == 60.0 and env.spec.max_episode_steps == 60
    assert dataset.observation_space == env.observation_space
    assert dataset.action_space == env.action_space
    vector = gym.make_vec(dataset.env_spec, num_envs=2)
    assert isinstance(vector.unwrapped, ship_gym.ShipVectorEnv)
    assert vector.single_observation_space == dataset.observation_space


def test_everything_is_in_minaris_spaces(dataset):
    for episode in dataset:
        n = len(episode)
        assert all(map(dataset.observation_space.contains, episode.observations))
        assert all(map(dataset.action_space.contains, episode.actions))
        assert len(episode.observations) == n + 1 == 61
        assert not episode.terminations.any()
        assert episode.truncations[-1] and not episode.truncations[:-1].any()
        for values in episode.infos.values():
            assert isinstance(values, np.ndarray) and len(values) == n + 1
            assert values.dtype != object and np.isfinite(values).all()


def test_without_noise_it_is_the_rollout_of_the_controller(dataset):
    """But for the rounding of actions to float32."""
    for name in ("pid", "lqg"):
        own = select(dataset, name, 0.0)
        seeds = [one["seed"] for one in told_of(own)]
        sailed = rollout(make_controller(name), seeds=seeds, **SHORT)
        for i, episode in enumerate(own):
            given = sailed.histories["actions"][:60, i]
            assert np.allclose(episode.actions, given, rtol=0.0, atol=1e-6)
            seen = sailed.histories["observations"][:61, i]
            assert np.allclose(episode.observations, seen, rtol=0.0, atol=1e-5)


def test_select_and_metadata_of_episodes(dataset):
    assert dataset.total_episodes == 12 and dataset.total_steps == 720
    told = told_of(dataset)
    assert [one["seed"] for one in told] == [*range(5, 17)]
    assert [one["controller"] for one in told] == ["pid"] * 6 + ["lqg"] * 6
    assert told_of(select(dataset, noise=0.1)) == [one for one in told if one["noise"] == 0.1]
    one = told[7]
    assert one["return"] == dataset[7].rewards.sum() and one["outcome"] == "truncated"
    assert not one["failed"]
    with pytest.raises(ConfigError, match="controller = 'mpc': the data set has pid, lqg"):
        select(dataset, "mpc")


def test_the_scores_of_minari(dataset, folder):
    card = json.loads((folder / NAME / "card.json").read_text())
    scores = card["reference_scores"]
    seeds = list(range(*np.add(scores["seeds"], [0, 1])))
    sailed = rollout(make_controller("pid"), seeds=seeds, **SHORT)
    expert = sailed.histories["rewards"].sum(axis=0).mean()
    assert scores["expert"] == pytest.approx(expert, abs=1e-4) and scores["expert_name"] == "pid"
    normalised = minari.get_normalized_score(
        dataset, np.array([scores["random"], scores["expert"]])
    )
    assert np.allclose(normalised, [0.0, 1.0])
    row = card["entries"][0]
    returns = [one["return"] for one in told_of(dataset)[:3]]
    assert row["returns"]["mean"] == pytest.approx(np.mean(returns))
    score = minari.get_normalized_score(dataset, np.mean(returns))
    assert row["normalised_mean"] == pytest.approx(score)


def test_no_score_where_the_expert_is_no_better_than_chance(tmp_path):
    """In 20 s on a heading a still rudder earns no more than one that is moved at random."""
    plan = Plan(episodes=1, env={"overrides": {"duration": 20.0}}, infos=False)
    made = write_set(plan, tmp_path)
    assert made.card["reference_scores"]["expert"] < made.card["reference_scores"]["random"]
    assert made.card["entries"][0]["normalised_mean"] is None
    assert "No normalised scores" in (made.path / "README.md").read_text()
    assert "ref_max_score" not in load_set(made.name, tmp_path).storage.metadata


def test_the_card_and_what_minari_knows(dataset, folder):
    card = json.loads((folder / NAME / "card.json").read_text())
    known = dataset.storage.metadata
    assert known["ship_gym"] == card
    assert (
        known["author"] == {"Ship Gym"}
        and known["algorithm_name"] == "pid, lqg; action noise 0, 0.1"
    )
    assert known["requirements"] == ["ship-gym==0.1.0"] and known["license"] == "Apache-2.0"
    assert [row["seeds"] for row in card["entries"]] == [[5, 7], [8, 10], [11, 13], [14, 16]]
    assert card["steps"] == 720 and card["seeds"]["split"] == "training"
    assert card["controllers"]["pid"]["gains_files"].keys() >= {"pid_kcs.toml"}
    assert {"minari", "numpy", "ship-gym"} <= card["versions"].keys() and card["git_commit"]
    text = (folder / NAME / "README.md").read_text()
    assert text.startswith(f"# {NAME}\n") and "| lqg | 0.1 | 3 | 14 to 16 | 180 |" in text


def test_minari_itself_finds_and_reads_it_without_network(folder, monkeypatch):
    def refused(*_, **__):
        raise AssertionError("network")

    monkeypatch.setattr(socket, "socket", refused)
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(folder))
    assert [*minari.list_local_datasets()] == [NAME]
    loaded = minari.load_dataset(NAME)
    assert len(loaded) == 12 and loaded[0].infos["forces.hull"].shape == (61, 3)
    assert minari.namespace.list_local_namespaces() == ["ShipGym", "ShipGym/HeadingKeeping"]
    assert load_set(NAME).total_steps == 720


def test_the_same_plan_gives_the_same_set_whatever_the_batches(tmp_path, monkeypatch):
    plan = Plan(("random", "pid"), (0.3,), noise_time=0.0, episodes=3, env=SHORT, infos=False)
    first = load_set(write_set(plan, tmp_path / "a").name, tmp_path / "a")
    monkeypatch.setattr(writing, "batches", lambda seeds, _: [seeds[:1], seeds[1:]])
    second = load_set(write_set(plan, tmp_path / "b").name, tmp_path / "b")
    assert told_of(first) == told_of(second)
    for one, other in zip(first, second, strict=True):
        assert np.array_equal(one.actions, other.actions)
        assert np.array_equal(one.observations, other.observations)
        assert not one.infos
    assert np.ptp(first[0].actions) > 1.0
    assert not np.array_equal(first[0].actions, first[1].actions)


def test_an_episode_that_ends_at_a_limit_is_terminated_and_cut(tmp_path):
    env = {"overrides": {"duration": 300.0, "limits.heading_error_deg": 35.0}}
    plan = Plan(("constant", "pid"), episodes=4, env=env)
    dataset = load_set(write_set(plan, tmp_path, "cut-v0").name, tmp_path)
    ends = [(e.terminations[-1], e.truncations[-1], len(e)) for e in dataset]
    assert any(terminated for terminated, *_ in ends)
    for (terminated, truncated, length), told in zip(ends, told_of(dataset), strict=True):
        assert terminated != truncated and told["failed"] == terminated
        assert length == told["total_steps"] and (length < 300 or truncated)
    i = [terminated for terminated, *_ in ends].index(True)
    episode, (seen, _, terminated, _), _ = replayed(dataset, i)
    assert np.array_equal(episode.observations, seen) and terminated[-1]


def test_coloured_noise_is_what_it_is_called():
    """Standard deviation and correlation of an Ornstein-Uhlenbeck process, exp(-k / memory)."""
    noise = action_noise(range(40), 5000, 2, 0.2, 8.0)
    assert noise.shape == (5000, 40, 2)
    assert noise[0].std() == pytest.approx(0.2, rel=0.2)  # stationary from the first interval
    assert noise.std() == pytest.approx(0.2, rel=0.01)
    for lag in (1, 8, 16):
        found = np.mean(noise[lag:] * noise[:-lag]) / 0.04
        assert found == pytest.approx(np.exp(-lag / 8.0), abs=0.02)
    assert abs(np.mean(noise[..., 0] * noise[..., 1])) < 0.01 * 0.04 * 10
    white = action_noise(range(40), 5000, 2, 0.2, 0.0)
    assert abs(np.mean(white[1:] * white[:-1])) < 0.02 * 0.04
    assert np.array_equal(action_noise([7], 50, 2, 0.2, 8.0)[:, 0], noise[:50, 7])


def test_noise_reaches_the_rudder(tmp_path):
    still, moved = (sail(make_controller("pid"), [0], SHORT, std)[0] for std in (0.0, 0.5))
    assert not np.allclose(still.observations, moved.observations)
    assert np.abs(moved.actions).max() <= 1.0
    assert len(batches(range(100_000), 600)) > 1


@pytest.mark.parametrize(
    ("plan", "words"),
    [
        ({"noise": (-0.1,)}, "noise = -0.1: allowed is 0 to 2"),
        ({"noise": 0.1}, "noise = 0.1: must be a tuple"),
        ({"controllers": "pid"}, "controllers = 'pid': must be a tuple"),
        ({"env": {"ship": load_ship("kcs")}}, "needs its name or file"),
        ({"noise": (0.1, 0.1)}, "must be different numbers"),
        ({"episodes": 0}, "episodes = 0: allowed is 1 to"),
        ({"controllers": ("pit",)}, "did you mean 'pid'"),
        ({"controllers": ("random", "random")}, "two controllers are named 'random'"),
        ({"controllers": ("drift_los",)}, ""),
        ({"seed": 399_990, "episodes": 20}, "some are of training, others of validation"),
        ({"expert": "none.toml"}, "no such file"),
        ({"env": {"ship": "kcz"}}, "did you mean 'kcs'"),
    ],
)
def test_a_plan_that_cannot_be_sailed_is_refused(tmp_path, plan, words):
    with pytest.raises(ConfigError) as error:
        write_set(Plan(**{"episodes": 2, **plan}), tmp_path)
    assert words in str(error.value) and len(str(error.value)) <= 300
    assert not list(tmp_path.iterdir())


def test_nothing_is_replaced_unasked(tmp_path):
    plan = Plan(episodes=1, env=SHORT, infos=False)
    name = write_set(plan, tmp_path, "own/pid-v0").name
    with pytest.raises(ConfigError, match="--force replaces it"):
        write_set(plan, tmp_path, name)
    longer = Plan(episodes=2, env=SHORT, infos=False)
    write_set(longer, tmp_path, name, force=True)
    assert len(load_set(name, tmp_path)) == 2
    (tmp_path / "own" / "other-v0").mkdir()
    for taken, words in (
        ("own/other-v0", "no data set of Minari"),
        (f"{name}/inner-v0", "none can be inside another"),
        ("pid", "allowed is"),
        ("../pid-v0", "allowed is"),
        ("a//pid-v0", "allowed is"),
    ):
        with pytest.raises(ConfigError, match=words):
            write_set(plan, tmp_path, taken, force=True)
    assert not list(tmp_path.rglob(".*"))


@pytest.mark.parametrize("there", [False, True])
def test_a_controller_that_breaks_leaves_what_was_there(tmp_path, there):
    plan = Plan(episodes=1, env=SHORT, infos=False)
    if there:
        write_set(plan, tmp_path, "own/pid-v0")
    (tmp_path / "mine.py").write_text(
        "class Breaks:\n    name = 'breaks'\n    def reset(self, *_): self.k = 0\n"
        "    def act(self, seen):\n        self.k += 1\n        assert self.k < 9\n"
        "        return seen[:, :1] * 0.0\n"
    )
    broken = Plan((f"{tmp_path}/mine.py:Breaks",), episodes=1, env=SHORT)
    with pytest.raises(ConfigError, match="interval 8"):
        write_set(broken, tmp_path, "own/pid-v0", force=True)
    assert not list(tmp_path.rglob(".*"))
    if there:
        assert told_of(load_set("own/pid-v0", tmp_path))[0]["controller"] == "pid"
    else:
        assert [path.name for path in tmp_path.iterdir()] == ["mine.py"]


def test_what_a_killed_writer_left_is_removed_and_one_at_a_time_writes(tmp_path):
    left = tmp_path / ".pid-v0.ship_gym.tmp" / "new"
    left.mkdir(parents=True)
    (left / "half").write_text("")
    plan = Plan(episodes=1, env=SHORT, infos=False)
    from ship_gym.locks import held

    with held(tmp_path / "pid-v0", "writes"), pytest.raises(ConfigError, match="another process"):
        write_set(plan, tmp_path, "pid-v0")
    write_set(plan, tmp_path, "pid-v0")
    assert [path.name for path in tmp_path.iterdir()] == ["pid-v0"]
    left.parent.mkdir()
    (tmp_path / "pid-v0").rename(left.parent / "old")  # killed between two renames
    with pytest.raises(ConfigError, match="it is back"):
        write_set(plan, tmp_path, "pid-v0")
    assert len(load_set("pid-v0", tmp_path)) == 1


def test_the_room_that_is_asked_for_is_enough_and_not_twice_too_much(dataset, folder):
    file = folder / NAME / "data" / "main_data.hdf5"
    asked = sum(map(room_of, dataset))
    assert file.stat().st_size < asked < 2 * file.stat().st_size


@pytest.mark.skipif(sys.platform != "linux", reason="limits of files as on Linux")
def test_a_disk_that_fills_up_is_one_line_and_leaves_nothing(tmp_path):
    """HDF5 itself ends the whole process then."""
    import resource
    import signal

    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    plan = Plan(("pid", "lqg"), episodes=2, env=SHORT)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (300_000, before[1]))
        with pytest.raises(OSError, match="file too large; nothing was written to it"):
            write_set(plan, tmp_path / "new")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, ignored)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("observation_space", None, "missing key 'observation_space'"),
        ("data_format", "arrow", "data_format = 'arrow'"),
        ("minari_version", "9.9", "minari_version = '9.9'"),
        ("env_spec", {"entry_point": "os:system"}, "env_spec makes 'os:system', no environment"),
        ("env_spec", {"vector_entry_point": "os:system"}, "env_spec makes 'os:system'"),
        ("env_spec", {"kwargs": {"record": "/tmp/x"}}, "unknown argument of env_spec"),
        ("env_spec", {"additional_wrappers": [{"name": "x"}]}, "has wrappers"),
        ("total_episodes", "many", ""),
        ("total_episodes", 13, "or damaged"),
        ("requirements", [["ship-gym"]], "requirements has ['ship-gym']"),
    ],
)
def test_a_set_of_others_is_one_line_and_runs_nothing(folder, tmp_path, key, value, words):
    shutil.copytree(folder / NAME, tmp_path / "set")
    file = tmp_path / "set" / "data" / "metadata.json"
    told = json.loads(file.read_text())
    told[key] = json.dumps(json.loads(told[key]) | value) if isinstance(value, dict) else value
    if value is None:
        del told[key]
    file.write_text(json.dumps(told))
    with pytest.raises(ConfigError) as error:
        read_set(tmp_path / "set")
    assert words in str(error.value) and "\n" not in str(error.value)
    assert len(str(error.value)) <= 300


def test_a_set_that_is_not_there_names_the_nearest(folder):
    with pytest.raises(ConfigError, match="did you mean 'ShipGym/HeadingKeeping/pid-lqg"):
        load_set("ShipGym/HeadingKeeping/pid-lqg-kcs-v0", folder)
    (folder / "other").mkdir(exist_ok=True)
    with pytest.raises(ConfigError, match="unknown data set in"):
        load_set("other/y-v0", folder)


@pytest.mark.slow
def test_files_that_a_scenario_names_are_found_from_another_folder(tmp_path, monkeypatch):
    way = {"type": "LineString", "coordinates": [[0, 0], [0, 5000], [2000, 9000]], "units": "m"}
    (tmp_path / "way.geojson").write_text(json.dumps(way))
    shipped = Path(ship_gym.__file__).parent / "ships" / "data" / "kcs"
    shutil.copytree(shipped, tmp_path / "mine")
    monkeypatch.chdir(tmp_path)
    overrides = {"track.kind": "points", "track.file": "way.geojson"}
    env = {"scenario": "track_following", "overrides": overrides}
    spec = writing.env_spec(prepared(Plan(("drift_los",), env=env)))
    assert spec.kwargs["scenario"]["track"]["file"] == str(tmp_path / "way.geojson")
    spec = writing.env_spec(
        prepared(Plan(("pid@kcs",), env={"ship": "mine/ship.toml"}, expert="pid@kcs"))
    )
    assert spec.kwargs["scenario"] == "heading_keeping"
    assert spec.kwargs["ship"] == str(tmp_path / "mine" / "ship.toml")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("controller", "env"),
    [
        ("lqg", {"scenario": "course_changing", "ship": "kvlcc2"}),
        ("drift_los", {"scenario": "track_following", "ship": "onrt"}),
        ("economy_kcs", {}),
        ("pid", {"control": "rudder+rpm", "privileged": True}),
    ],
)
def test_other_tasks_ships_and_policies(tmp_path, controller, env):
    from ship_gym_agents.controllers import trained_for

    env = {**trained_for(make_controller(controller)), **env, "overrides": {"duration": 60.0}}
    plan = Plan((controller,), (0.0, 0.2), episodes=2, env=env)
    dataset = load_set(write_set(plan, tmp_path).name, tmp_path)
    for i in (0, 3):
        episode, (seen, rewards, *_), _ = replayed(dataset, i)
        assert np.array_equal(episode.observations, seen)
        assert np.array_equal(episode.rewards, rewards[1:])
