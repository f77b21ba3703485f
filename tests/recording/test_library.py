"""The runs of a folder: found, read whole or with their error, chosen and ordered."""

from __future__ import annotations

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.recording import Trajectory
from ship_gym.recording.library import Run, metric_names, read, recordings
from ship_gym.recording.recorder import Recorder
from ship_gym.recording.selection import chosen, condition, ordered

T = np.arange(5.0)


def meta(**more):
    return {"kind": "episode", "task": "heading_keeping", "ship": {"name": "kcs"}, **more}


def run(name, **values):
    """A run of which only columns and metrics matter."""
    own = {key: values.pop(key) for key in ("controller", "seed", "outcome") if key in values}
    return Run(name, meta(metrics=values, **own), 4.0, True)


@pytest.fixture
def folder(tmp_path):
    """Two episodes, one manoeuvre, a journal, a damaged file and others that are none."""
    pytest.importorskip("rerun")
    sub = tmp_path / "runs" / "more"
    sub.mkdir(parents=True)
    for name, seed in (("b", 2), ("a", 1)):
        found = meta(seed=seed, controller="pid", outcome="end of time", metrics={"J_1": 2.0})
        Trajectory({"t": T, "u": T}, found).to_rrd(sub / f"{name}.rrd", picture=False)
    turn = {"kind": "manoeuvre", "task": "turning_circle", "metrics": {"advance": 3.0}}
    Trajectory({"t": T}, turn).to_rrd(tmp_path / "runs" / "turn.rrd", picture=False)
    recorder = Recorder(sub / "killed.rrd", meta(seed=3), ["t", "u"])
    recorder.add(np.column_stack([T, T]))
    recorder.keep()
    whole = (sub / "a.rrd").read_bytes()
    (sub / "bad.rrd").write_bytes(whole[:900] + bytes([whole[900] ^ 1]) + whole[901:])
    (sub / "text.txt").write_text("no recording")
    (sub / ".half.rrd").write_text("is being written")
    return tmp_path / "runs"


def test_recordings_and_journals_are_found_in_subfolders_once(folder):
    names = [path.name for path in recordings([folder, folder / "more" / "a.rrd"])]
    assert sorted(names) == ["a.rrd", "b.rrd", "bad.rrd", "killed.rrd.partial", "turn.rrd"]
    with pytest.raises(ConfigError, match="nowhere: no such file or folder"):
        recordings([folder / "nowhere"])


def test_every_file_is_a_run_bad_ones_with_their_error(folder):
    runs = {one.path.name: one for one in map(read, recordings([folder]))}
    states = {name: one.value("state") for name, one in runs.items()}
    assert states == {
        "a.rrd": "complete",
        "b.rrd": "complete",
        "turn.rrd": "complete",
        "killed.rrd.partial": "incomplete",
        "bad.rrd": "unreadable",
    }
    assert runs["bad.rrd"].error and runs["bad.rrd"].meta == {}
    assert runs["a.rrd"].columns() == {
        "file": str(folder / "more" / "a.rrd"),
        "kind": "episode",
        "scenario": "heading_keeping",
        "task": "heading_keeping",
        "ship": "kcs",
        "controller": "pid",
        "seed": 1,
        "outcome": "end of time",
        "failed": None,
        "duration": 4.0,
        "state": "complete",
    }
    assert runs["turn.rrd"].metrics == {"advance": 3.0}
    assert runs["killed.rrd.partial"].duration == 4.0
    assert metric_names([*runs.values()]) == ["J_1", "advance"]


def test_a_file_of_another_kind_is_a_run_with_its_error(tmp_path):
    (tmp_path / "a.csv").write_text("t\n1\n")
    assert "*.rrd" in read(tmp_path / "a.csv").error


RUNS = [
    run("a", J_1=5.0, controller="pid", seed=3, outcome="end of time"),
    run("b", J_1=150.0, controller="lqg", seed=1, outcome="heading limit"),
    run("c", J_1=None, controller="pid", seed=2, outcome="heading limit"),
    run("d", J_1=100.0, controller="mpc", seed=4, outcome="end of time"),
    Run("e", error="damaged"),
]


@pytest.mark.parametrize(
    ("conditions", "expected"),
    [
        ([], "abcde"),
        (["J_1>100"], "b"),
        (["J_1 >= 1e2"], "bd"),
        (["J_1<100"], "a"),
        (["J_1<=100"], "ad"),
        (["J_1==5"], "a"),
        (["J_1!=5"], "bd"),
        (["controller==pid"], "ac"),
        (["outcome!=end of time"], "bc"),
        (['outcome=="heading limit"', "seed<2"], "b"),
        (["state==unreadable"], "e"),
        (["duration>10"], ""),
    ],
)
def test_conditions_choose(conditions, expected):
    assert "".join(one.path for one in chosen(RUNS, conditions)) == expected


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("J_1", "condition 'J_1': must be FIELD OPERATOR VALUE"),
        ("J_1=3", "operators: <= >= == != < >"),
        ("J_1>>3", "'>3' is not a number"),
        ("J_1>high", "'high' is not a number"),
        ("J1>3", "unknown field 'J1'; did you mean 'J_1'"),
        ("controler==pid", "did you mean 'controller'"),
        ("ship>kcs", "ship is text: allowed are == and !="),
        ("__import__('os')>1", "unknown field"),
    ],
)
def test_conditions_that_are_none_say_what_is_allowed(text, words):
    with pytest.raises(ConfigError) as refused:
        condition(text, ["J_1"])
    assert words in str(refused.value)


def test_order_puts_what_lacks_a_value_last():
    names = ["".join(one.path for one in ordered(RUNS, "J_1", back)) for back in (False, True)]
    assert names == ["adbce", "bdace"]
    assert next(one.path for one in ordered(RUNS, "seed")) == "b"
    with pytest.raises(ConfigError, match="unknown field to sort by 'J_2'"):
        ordered(RUNS, "J_2")
