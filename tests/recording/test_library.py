"""The runs of a folder: found, and read whole or with their error."""

from __future__ import annotations

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.recording import Trajectory
from ship_gym.recording.library import metric_names, read, recordings
from ship_gym.recording.recorder import Recorder

T = np.arange(5.0)


def meta(**more):
    return {"kind": "episode", "task": "heading_keeping", "ship": {"name": "kcs"}, **more}


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
    (folder / "turn.rrd").rename(folder / "TURN.RRD")
    names = [path.name for path in recordings([folder, folder / "more" / "a.rrd"])]
    assert sorted(names) == ["TURN.RRD", "a.rrd", "b.rrd", "bad.rrd", "killed.rrd.partial"]
    assert len(Trajectory.from_file(folder / "TURN.RRD")) == len(T)
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
