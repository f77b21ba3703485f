"""Episodes as files: sailed into them in parts, named, and read back."""

import dataclasses

import pytest

from ship_gym.config import ConfigError
from ship_gym.evaluation import metrics, recordings, rollout
from ship_gym.evaluation.controller import ConstantController
from ship_gym.evaluation.recordings import check_told_apart, checked, file_name, keep, safe, sail
from ship_gym.recording import Trajectory

SEEDS = [5, 6, 7, 8, 9]
SHORT = {"overrides": {"duration": 20.0}, "parallel": False}


@pytest.fixture(scope="module")
def sailed():
    return rollout(ConstantController(), seeds=SEEDS, **SHORT)


def test_parts_give_what_the_whole_batch_does(tmp_path, monkeypatch, sailed):
    pytest.importorskip("rerun")
    monkeypatch.setattr(recordings, "TOGETHER", 2)
    files = [tmp_path / file_name("constant", seed) for seed in SEEDS]
    found = sail(ConstantController(), SEEDS, files, **SHORT)
    assert [one.file for one in found] == files and [one.seed for one in found] == SEEDS
    assert sorted(tmp_path.iterdir()) == sorted(files)  # no journal is left
    for i, one in enumerate(found):
        live = sailed.trajectory(i)
        assert one.metrics == metrics(live) == metrics(Trajectory.from_rrd(one.file))
        kept = Trajectory.from_rrd(one.file)
        assert all((kept[name] == live[name]).all() for name in live.names)
        assert one.plain()["file"] == str(files[i]) and one.outcome == "end of time"


def test_a_file_of_another_episode_is_noticed(tmp_path, sailed):
    pytest.importorskip("rerun")
    file = tmp_path / "a.rrd"
    assert keep(sailed.trajectory(0), file).metrics == metrics(sailed.trajectory(0))
    with pytest.raises(OSError, match=r"a\.rrd: the metrics of the file are not those"):
        checked(sailed.trajectory(1), file)


def test_a_csv_has_the_metrics_of_the_episode(tmp_path, sailed):
    one = keep(sailed.trajectory(0), tmp_path / "a.csv")
    assert one.metrics == metrics(sailed.trajectory(0)) and one.file.stat().st_size > 1000


def test_a_task_without_metrics_is_recorded_all_the_same(tmp_path, sailed, monkeypatch):
    none = dataclasses.replace(sailed.task, metrics={}, measure=None)
    monkeypatch.setattr(recordings, "TASKS", {sailed.task.name: none})
    assert keep(sailed.trajectory(0), tmp_path / "a.csv").metrics == {}


def test_names_say_who_sailed_which_episode():
    assert file_name("pid", 7) == "pid-7.rrd" and file_name("pid", 7, ".csv") == "pid-7.csv"
    assert safe("runs/a b@kcs+model") == "runs-a-b-kcs-model" and safe("//") == "unnamed"
    check_told_apart(["pid", "lqg", "pid"])
    with pytest.raises(ConfigError, match=r"'a/b' and 'a-b': .* one file, a-b-SEED"):
        check_told_apart(["a/b", "a-b"])
