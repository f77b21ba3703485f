"""RecordRerun and the option ``record``: which episodes have a file, and that it is the episode."""

import copy
import os
import signal
import subprocess
import sys
import textwrap
from types import SimpleNamespace

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.vector import SyncVectorEnv

import ship_gym  # noqa: F401  registers the ids
from ship_gym import RecordRerun, RecordRerunVector, ShipEnv, ShipVectorEnv, Trajectory
from ship_gym.config import ConfigError
from ship_gym.evaluation import metrics, rollout
from ship_gym.evaluation.controller import ConstantController
from ship_gym.recording.journal import Journal
from ship_gym.scenarios.sections import LARGEST

pytest.importorskip("rerun")
ID = "ShipGym/HeadingKeeping-v0"
SHORT = {"duration": 12.0}
FAST = {"picture": False}


def sail(env, seed=None, rudder=0.0):
    """One episode of a scalar environment."""
    env.reset(seed=seed)
    over = False
    while not over:
        *_, terminated, truncated, _ = env.step(np.array([rudder], np.float32))
        over = terminated or truncated


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def same(one, other, about=()):
    """Two recordings are equal in every bit of every column, and in the meta but `about`."""
    assert one.names == other.names
    assert all(one[name].tobytes() == other[name].tobytes() for name in one.names)
    differ = {
        k for k in one.meta.keys() | other.meta.keys() if one.meta.get(k) != other.meta.get(k)
    }
    assert differ == set(about)


def test_make_records_every_episode_as_a_rollout_would(tmp_path):
    env = gym.make(ID, record=tmp_path, overrides=SHORT)
    sail(env, 5)
    sail(env)
    env.close()
    assert names(tmp_path) == ["episode-000000-seed-5.rrd", "episode-000001-seed-5-reset-1.rrd"]
    first = Trajectory.from_rrd(tmp_path / "episode-000000-seed-5.rrd")
    path = tmp_path / "rollout.rrd"
    rollout(ConstantController(), seeds=[5], overrides=SHORT, record={0: path})
    same(first, Trajectory.from_rrd(path), {"controller", "episode"})
    assert metrics(first) == first.meta["metrics"]
    second = Trajectory.from_rrd(tmp_path / "episode-000001-seed-5-reset-1.rrd")
    assert second.meta["seed"] is None
    assert second.meta["stream"] == {"seed": 5, "resets": 1}


def test_an_episode_that_was_not_seeded_is_reproduced_by_what_its_meta_says(tmp_path):
    env = RecordRerun(ShipEnv(overrides=SHORT), tmp_path, **FAST)
    for _ in range(3):
        sail(env)
    env.close()
    first, *_, last = (Trajectory.from_rrd(file) for file in env.files)
    again = ShipEnv(overrides=SHORT, record={"folder": tmp_path / "again", **FAST})
    again.reset(seed=first.meta["seed"])
    again.reset()
    sail(again)
    again.close()
    assert last.meta["stream"] == {"seed": first.meta["seed"], "resets": 2}
    (found,) = (tmp_path / "again").iterdir()
    same(last, Trajectory.from_rrd(found), {"episode"})


def test_every_third_and_those_of_a_function(tmp_path):
    for folder, episodes, expected in (
        ("third", 3, [0, 3]),
        ("odd", lambda k: k % 2 == 1, [1, 3]),
        ("none", lambda k: False, []),
    ):
        env = RecordRerun(ShipEnv(overrides=SHORT), tmp_path / folder, episodes=episodes, **FAST)
        for seed in range(5):
            sail(env, seed)
        env.close()
        assert [Trajectory.from_rrd(file).meta["episode"] for file in env.files] == expected
        assert [Trajectory.from_rrd(file).meta["seed"] for file in env.files] == expected


def test_the_worst_so_far_stay(tmp_path):
    """J_1 of six episodes; two stay, and they are the largest two."""
    env = RecordRerun(ShipEnv(overrides=SHORT), tmp_path, keep="worst", by="J_1", most=2, **FAST)
    for seed in range(6):
        sail(env, seed)
    env.close()
    all_of_them = rollout(ConstantController(), seeds=range(6), overrides=SHORT)
    worst = np.argsort([t.meta["metrics"]["J_1"] for t in all_of_them.episodes])[-2:]
    assert len(names(tmp_path)) == 2
    assert [Trajectory.from_rrd(file).meta["seed"] for file in env.files] == worst.tolist()
    about = {"controller", "episode"}
    same(Trajectory.from_rrd(env.files[1]), all_of_them.trajectory(int(worst[1])), about)


def test_failed_ones_and_those_of_a_function_of_the_trajectory(tmp_path):
    early = {"limits.heading_error_deg": 30.0, "start.heading_error_deg": 1.0, "duration": 90.0}
    hard = [rollout(ConstantController(r), seeds=range(3), overrides=early) for r in (1.0, 0.0)]
    failed = np.stack([sailed.failed for sailed in hard], axis=1).ravel()  # in the order sailed
    assert 0 < failed.sum() < 6
    for folder, keep in (("failed", "failed"), ("own", lambda t: t.meta["failed"])):
        env = RecordRerun(ShipEnv(overrides=early), tmp_path / folder, keep=keep, **FAST)
        for seed in range(3):
            sail(env, seed, rudder=1.0)
            sail(env, seed, rudder=0.0)
        env.close()
        found = [Trajectory.from_rrd(file) for file in env.files]
        assert [t.meta["episode"] for t in found] == np.flatnonzero(failed).tolist()
        assert {t.meta["outcome"] for t in found} == {"heading limit"}


def test_failed_ones_are_the_worst_as_everywhere(tmp_path):
    """Two turn to the limit with the rudder hard over; two weave, with far more rudder travel."""
    early = {"limits.heading_error_deg": 30.0, "start.heading_error_deg": 1.0, "duration": 150.0}
    found = {}
    for keep in ("all", "worst"):
        of_worst = {"by": "rudder_travel", "most": 3} if keep == "worst" else {}
        calm = ShipEnv(scenario="heading_calm", overrides=early)
        env = RecordRerun(calm, tmp_path / keep, keep=keep, **of_worst, **FAST)
        for seed in (0, 1):
            sail(env, seed, rudder=1.0)
            env.reset(seed=seed)
            for k in range(150):
                env.step(np.array([0.4 * (-1) ** k], np.float32))
        env.close()
        found[keep] = [Trajectory.from_rrd(file) for file in env.files]
    failed = [t.meta["failed"] for t in found["all"]]
    travel = [t.meta["metrics"]["rudder_travel"] for t in found["all"]]
    assert failed == [True, False, True, False]
    assert max(travel[::2]) < min(travel[1::2])
    worst = [t.meta["episode"] for t in found["worst"]]
    assert worst == [1, 0, 2]  # the least bad first; of equal ones the earlier stays


def test_the_latest_stay_and_nothing_is_overwritten(tmp_path):
    for _ in range(2):
        env = RecordRerun(ShipEnv(overrides=SHORT), tmp_path, most=1, name="run", **FAST)
        sail(env, 1)
        sail(env, 2)
        env.close()
    assert names(tmp_path) == ["run-000001-seed-2-again-2.rrd", "run-000001-seed-2.rrd"]


@pytest.mark.parametrize("keep", ["all", lambda t: True], ids=["streamed", "in memory"])
def test_environments_of_one_folder_overwrite_nothing(tmp_path, keep):
    """They sail side by side, without seeds, so that all of them would take the same name."""
    record = {"folder": tmp_path, "keep": keep, **FAST}
    envs = SyncVectorEnv([lambda: ShipEnv(overrides=SHORT, record=record) for _ in range(3)])
    envs.reset()
    for _ in range(12):
        envs.step(np.zeros((3, 1)))
    envs.close()
    assert names(tmp_path) == [f"episode-000000{k}.rrd" for k in ("-again-2", "-again-3", "")]
    files = [Trajectory.from_rrd(path) for path in tmp_path.iterdir()]
    assert len({file["psi_ordered"][0] for file in files}) == 3


def test_a_file_that_another_process_has_just_begun_is_left_to_it(tmp_path, monkeypatch):
    """Both have looked whether it is there before either has made it."""
    from ship_gym.envs import recording

    held = Journal(tmp_path / "episode-000000-seed-1.rrd.partial", ["t"], {})
    held.append(np.zeros((1, 1)))
    monkeypatch.setattr(recording, "journal_path", lambda path: tmp_path / "unseen")
    env = ShipEnv(overrides=SHORT, record={"folder": tmp_path, **FAST})
    sail(env, 1)
    env.close()
    held.close()
    assert names(tmp_path) == ["episode-000000-seed-1-again-2.rrd", held.path.name]


def test_a_function_that_fails_costs_only_the_episodes_of_its_step(tmp_path):
    def wanted(number):
        if number == 1:
            raise RuntimeError("not this one")
        return True

    record = {"folder": tmp_path, "episodes": wanted, **FAST}
    env = ShipVectorEnv(2, overrides=SHORT, record=record)
    env.reset(seed=4)
    with pytest.raises(RuntimeError, match="not this one"):
        env.step(np.zeros((2, 1)))
    env.reset(seed=6)
    for _ in range(12):
        env.step(np.zeros((2, 1)))
    env.close()
    expected = ["episode-000002-env-0000-seed-6.rrd", "episode-000003-env-0001-seed-7.rrd"]
    assert names(tmp_path) == expected


@pytest.mark.parametrize("mode", ["NextStep", "SameStep", "Disabled"])
def test_a_vector_environment_records_each_episode_of_each_environment(tmp_path, mode):
    """Some of them end early; each is that of a scalar one, whatever the reset mode."""
    given = {"limits.heading_error_deg": 9.0, "start.heading_error_deg": 8.0, "duration": 25.0}
    options = {"overrides": given, "autoreset_mode": mode}
    env = gym.make_vec(ID, 3, record={"folder": tmp_path, **FAST}, **options)
    env.reset(seed=10)
    for _ in range(55):
        *_, terminated, truncated, _ = env.step(np.ones((3, 1), np.float32))
        over = terminated | truncated
        if mode == "Disabled" and over.any():
            env.reset(options={"reset_mask": over})
    env.close()
    found = [Trajectory.from_rrd(p) for p in sorted(tmp_path.glob("*.rrd"))]
    assert [t.meta["episode"] for t in found[:3]] == [0, 1, 2]
    assert [t.meta["environment"] for t in found[:3]] == [0, 1, 2]
    assert len({len(t) for t in found}) > 1
    for t in found:
        stream = t.meta.get("stream", {"seed": t.meta["seed"], "resets": 0})
        assert stream["seed"] == 10 + t.meta["environment"]
        one = ShipEnv(overrides=given, record={"folder": tmp_path / "one", **FAST})
        one.reset(seed=stream["seed"])
        for _ in range(stream["resets"]):
            one.reset()
        over = False
        while not over:
            *_, terminated, truncated, _ = one.step(np.ones(1, np.float32))
            over = terminated or truncated
        (alone,) = one._recording.files
        one.close()
        alone = Trajectory.from_rrd(alone)
        assert t.names == alone.names
        assert all(t[name].tobytes() == alone[name].tobytes() for name in t.names)
        assert t.meta["metrics"] == alone.meta["metrics"]


def test_ships_of_a_mixed_fleet_are_recorded_each_as_alone(tmp_path):
    """Another ship by chance in each episode; one propeller beside two has no port side."""
    given = {"scenario": "heading_unknown_ship", "overrides": SHORT}
    env = RecordRerunVector(ShipVectorEnv(4, ship=["kcs", "onrt"], **given), tmp_path, **FAST)
    env.reset(seed=30)
    for _ in range(12):
        env.step(np.zeros((4, 1), np.float32))
    env.close()
    about = {"controller", "episode", "environment"}
    for i, file in enumerate(env.files):
        found, ship = Trajectory.from_rrd(file), ("kcs", "onrt")[i % 2]
        alone = rollout(ConstantController(), seeds=[30 + i], ship=ship, **given).trajectory(0)
        assert ("thrust_port" in found) == (ship == "onrt")
        assert found.meta["randomisation"] and found.meta["scenario"] == "heading_unknown_ship"
        # the scenario of a fleet names the first of its ships
        same(found, alone, about | ({"config", "overrides"} if ship == "onrt" else set()))


def test_options_of_a_reset_are_in_the_recording(tmp_path):
    env = ShipEnv(overrides=SHORT, record={"folder": tmp_path, **FAST})
    env.reset(seed=3, options={"heading_error_deg": 4.0, "position": (10.0, -5.0)})
    with pytest.raises(ConfigError, match="speed"):
        env.reset(options={"speed": 99.0})  # refused: the episode goes on
    for _ in range(12):
        env.step(np.zeros(1))
    env.close()
    (file,) = tmp_path.iterdir()
    t = Trajectory.from_rrd(file)
    assert t.meta["reset_options"] == {"heading_error_deg": 4.0, "position": [10.0, -5.0]}
    assert (t["x"][0], t["y"][0]) == (10.0, -5.0) and len(t) == 13


def test_a_ship_that_diverges_is_recorded_as_in_a_rollout(tmp_path, monkeypatch):
    monkeypatch.setitem(LARGEST, "surrogate_std", 10.0)
    wild = {"randomisation.surrogate_std": 10.0, "limits.heading_error_deg": 180.0}
    env = {"ship": "onrt", "control": "rudder+rpm", "overrides": wild | {"duration": 60.0}}

    class HardOver(ConstantController):
        def act(self, observations):
            return np.ones((len(observations), 2))

    sailed = rollout(HardOver(), seeds=range(40), **env)
    lost = [i for i, name in enumerate(sailed.outcomes) if name == 1][:2]
    assert lost
    for i in lost:
        one = ShipEnv(record={"folder": tmp_path, **FAST}, **env)
        one.reset(seed=i)
        while not one.step(np.ones(2))[2]:
            pass
        one.close()
        (file,) = tmp_path.glob(f"*seed-{i}.rrd")
        same(Trajectory.from_rrd(file), sailed.trajectory(i), {"controller", "episode"})


def test_the_vector_wrapper_keeps_the_worst_of_all_environments(tmp_path):
    env = RecordRerunVector(
        ShipVectorEnv(4, overrides=SHORT), tmp_path, keep="worst", by="max_error", **FAST
    )
    env.reset(seed=20)
    for _ in range(12):
        env.step(np.zeros((4, 1), np.float32))
    env.close()
    sailed = rollout(ConstantController(), seeds=range(20, 24), overrides=SHORT)
    values = [t.meta["metrics"]["max_error"] for t in sailed.episodes]
    (file,) = env.files
    assert Trajectory.from_rrd(file).meta["seed"] == 20 + int(np.argmax(values))
    assert names(tmp_path) == [file.name]


def test_it_stands_under_and_over_other_wrappers(tmp_path):
    """Normalised observations outside, a time limit that ends the episode before its own end."""
    base = ShipEnv(overrides=SHORT)
    env = gym.wrappers.TimeLimit(RecordRerun(base, tmp_path / "under", **FAST), 5)
    env = gym.wrappers.NormalizeObservation(gym.wrappers.RecordEpisodeStatistics(env))
    env = RecordRerun(env, tmp_path / "over", controller="mine", **FAST)
    sail(env, 3)
    sail(env, 4)
    env.reset()
    env.close()
    for folder in ("under", "over"):
        files = sorted((tmp_path / folder).glob("*.rrd"))
        found = [Trajectory.from_rrd(file) for file in files]
        assert [t.meta["seed"] for t in found] == [3, 4]
        assert {t.meta["outcome"] for t in found} == {"cut short"}
        assert all(len(t) == 6 and t.meta["truncated"] and not t.meta["failed"] for t in found)
    whole = rollout(ConstantController(), seeds=[3], overrides=SHORT).trajectory(0)
    first = Trajectory.from_rrd(tmp_path / "over" / "episode-000000-seed-3.rrd")
    for name in whole.names:
        if not name.startswith(("reward", "action", "delta_command")):
            assert np.array_equal(first[name], whole[name][:6]), name
    assert first.meta["controller"] == "mine"


def test_it_works_with_the_monitor_of_stable_baselines3(tmp_path):
    monitor = pytest.importorskip("stable_baselines3.common.monitor")
    env = monitor.Monitor(gym.make(ID, record={"folder": tmp_path, **FAST}, overrides=SHORT))
    sail(env, 1)
    sail(env, 2)
    env.close()
    found = [Trajectory.from_rrd(path) for path in sorted(tmp_path.glob("*.rrd"))]
    assert [float(np.float32(t["reward"].sum())) for t in found] == pytest.approx(
        env.get_episode_rewards(), abs=1e-5
    )


def test_an_unfinished_episode_keeps_its_journal(tmp_path):
    env = ShipEnv(overrides={"duration": 60.0}, record={"folder": tmp_path, **FAST})
    env.reset(seed=8)
    for _ in range(20):
        env.step(np.zeros(1))
    env.close()
    (left,) = tmp_path.iterdir()
    assert left.name == "episode-000000-seed-8.rrd.partial"
    found = Trajectory.from_file(left)
    assert not found.complete and len(found) == 20
    whole = rollout(ConstantController(), seeds=[8], overrides={"duration": 60.0}).trajectory(0)
    assert all(np.array_equal(found[name], whole[name][:20]) for name in whole.names)
    env.reset(seed=9)  # closed: records no more
    env.step(np.zeros(1))
    assert names(tmp_path) == [left.name]


@pytest.mark.parametrize("way", ["interrupted", "killed"])
def test_a_process_that_is_ended_leaves_the_rows_so_far(tmp_path, way):
    """Ctrl-C leaves all of them, a kill all but those of the last chunk of 16."""
    script = f"""
        import numpy as np, os, signal
        from ship_gym import ShipEnv
        env = ShipEnv(overrides={{"duration": 600.0}}, record={str(tmp_path)!r})
        env.reset(seed=1)
        for k in range(100):
            env.step(np.zeros(1))
        os.kill(os.getpid(), signal.{"SIGINT" if way == "interrupted" else "SIGKILL"})
        env.step(np.zeros(1))
    """
    ended = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(script)], capture_output=True, text=True, check=False
    )
    killed = way == "killed"
    assert ended.returncode == -(signal.SIGKILL if killed else signal.SIGINT), ended.stderr
    (left,) = tmp_path.iterdir()
    found = Trajectory.from_file(left)
    assert len(found) == 96 if killed else len(found) in (100, 101)
    assert found.meta["seed"] == 1 and not found.complete


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_a_forked_process_leaves_the_journal_alone(tmp_path):
    script = f"""
        import numpy as np, os, sys
        from ship_gym import ShipEnv
        env = ShipEnv(overrides={{"duration": 600.0}}, record={str(tmp_path)!r})
        env.reset(seed=1)
        for k in range(40):
            if k == 20 and (child := os.fork()) == 0:
                sys.exit(0)  # which leaves the journals
            env.step(np.zeros(1))
        os.waitpid(child, 0)
    """
    subprocess.run([sys.executable, "-c", textwrap.dedent(script)], check=True)
    (left,) = tmp_path.iterdir()
    assert len(Trajectory.from_file(left)) == 40


def test_the_spec_of_a_wrapped_environment_makes_it_again(tmp_path):
    env = RecordRerun(gym.make(ID, overrides=SHORT), tmp_path, **FAST)
    spec = gym.envs.registration.EnvSpec.from_json(env.spec.to_json())
    again = gym.make(spec)
    assert isinstance(again, RecordRerun)
    sail(again, 3)
    again.close()
    assert names(tmp_path) == ["episode-000000-seed-3.rrd"]


def test_after_an_error_a_reset_goes_on_as_if_there_had_been_none(tmp_path):
    def keep(trajectory):
        raise RuntimeError("no")

    env = ShipVectorEnv(2, overrides=SHORT, record={"folder": tmp_path, "keep": keep, **FAST})
    plain = ShipVectorEnv(2, overrides=SHORT)
    env.reset(seed=1)
    with pytest.raises(RuntimeError, match="no"):
        for _ in range(12):
            env.step(np.zeros((2, 1)))
    for one in (env, plain):
        one.reset(seed=9)
    for _ in range(11):
        seen, expected = (one.step(np.full((2, 1), 0.3))[0] for one in (env, plain))
        assert np.array_equal(seen, expected)


def test_a_copy_of_the_environment_records_nothing(tmp_path):
    env = ShipEnv(overrides=SHORT, record={"folder": tmp_path, **FAST})
    env.reset(seed=1)
    env.step(np.zeros(1))
    other = copy.deepcopy(env)
    sail(other, 7)
    other.close()
    sail(env, 2)
    env.close()
    metas = [Trajectory.from_rrd(path).meta for path in sorted(tmp_path.glob("*.rrd"))]
    assert [(m["seed"], m["outcome"]) for m in metas] == [(1, "cut short"), (2, "end of time")]


@pytest.mark.parametrize("keep", ["all", lambda t: True], ids=["streamed", "in memory"])
@pytest.mark.parametrize("at", ["add", "finish"])
def test_a_full_disk_is_one_error_and_the_environment_sails_on(tmp_path, monkeypatch, keep, at):
    """Whether the rows or the file find no room; what is there of the episode stays."""
    from ship_gym.recording import recorder

    def full(*given, **options):
        raise OSError(28, "No space left on device")

    record = {"folder": tmp_path, "keep": keep, **FAST}
    env = ShipEnv(overrides={"duration": 30.0}, record=record)
    with monkeypatch.context() as patched:
        if at == "add":
            patched.setattr(recorder.Journal, "append", full)
        else:
            export = SimpleNamespace(write_rrd=full)
            patched.setattr(recorder, "import_rerun_export", lambda: export)
        with pytest.raises(OSError, match="No space"):
            sail(env, 1)
    sail(env, 2)
    env.close()
    left = tmp_path / "episode-000000-seed-1.rrd.partial"
    if at == "finish":
        assert len(Trajectory.from_file(left)) == 31
        left.unlink()
    assert names(tmp_path) == ["episode-000001-seed-2.rrd"]  # nothing of one without any row


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"episodes": 0}, "episodes = 0: allowed is"),
        ({"episodes": "some"}, "episodes = 'some': allowed is"),
        ({"episodes": True}, "episodes = True"),
        ({"keep": "worse"}, "unknown keep 'worse'; did you mean 'worst'"),
        ({"keep": 3}, "keep = 3: allowed is"),
        ({"keep": "worst", "by": "J1"}, "unknown metric of heading_keeping 'J1'"),
        ({"by": "J_1"}, "by = 'J_1': goes with keep = 'worst'"),
        ({"most": 0}, "most = 0: must be"),
        ({"name": "a/b"}, "name = 'a/b': allowed"),
        ({"controller": None}, "controller = None"),
        ({"policy": "nowhere.safetensors"}, "policy = 'nowhere.safetensors': no such file"),
        ({"picture": 1}, "picture = 1"),
        ({"folder": ""}, "folder = ''"),
        ({"episode": 3}, "unknown option of record 'episode'; did you mean 'episodes'"),
    ],
)
def test_bad_options_are_refused_before_anything_is_written(tmp_path, options, said):
    with pytest.raises(ConfigError, match=said):
        ShipEnv(record={"folder": tmp_path / "new", **options})
    assert not (tmp_path / "new").exists()


def test_what_cannot_be_recorded_is_refused(tmp_path):
    with pytest.raises(ConfigError, match="record = 3: must be a folder"):
        ShipEnv(record=3)
    with pytest.raises(ConfigError, match="missing key 'folder'"):
        ShipEnv(record={"episodes": 3})
    with pytest.raises(ConfigError, match="around a CartPoleEnv: must be around a ShipEnv"):
        RecordRerun(gym.make("CartPole-v1"), tmp_path / "new")
    many = gym.vector.SyncVectorEnv([lambda: ShipEnv(overrides=SHORT)])
    with pytest.raises(ConfigError, match="wrap each of its environments with RecordRerun"):
        RecordRerunVector(many, tmp_path / "new")
    file = tmp_path / "file"
    file.write_text("")
    with pytest.raises(ConfigError, match=r"^folder .*file: .* is a file, not a folder$"):
        ShipEnv(record=file)
    if sys.platform == "linux":
        with pytest.raises(ConfigError, match=r"^folder /proc/here: cannot write into /proc"):
            ShipEnv(record="/proc/here")
    assert not (tmp_path / "new").exists()
