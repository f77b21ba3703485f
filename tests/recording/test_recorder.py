"""A recorder loses at most one chunk of a run, and leaves one file of one that is over."""

from __future__ import annotations

import mmap
import os
import signal
import struct
import time

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.recording import Recorder, Trajectory

pytest.importorskip("rerun")

NAMES = ["x", "t", "psi"]


def rows(count: int, step: float = 1.0) -> np.ndarray:
    k = np.arange(count)
    return np.stack([7.0 * k, step * k, 0.01 * k], axis=1)


def run_of(table: np.ndarray, **meta) -> Trajectory:
    return Trajectory(dict(zip(NAMES, table.T, strict=True)), {"task": "heading", **meta})


def test_a_run_that_is_over_is_one_file(tmp_path):
    recorder = Recorder(tmp_path / "new" / "run.rrd", {"task": "heading"}, NAMES)
    assert recorder.journal.is_file()
    recorder.add(rows(1)[0])
    recorder.add(rows(30)[1:])
    run = run_of(rows(30), metrics={"J": 1.5})
    recorder.finish(run)
    assert os.listdir(tmp_path / "new") == ["run.rrd"]
    read = Trajectory.from_file(tmp_path / "new" / "run.rrd")
    assert read.complete
    assert read.meta == run.meta
    assert all(read[name].tobytes() == run[name].tobytes() for name in run.names)
    with pytest.raises(ConfigError, match="over"):
        recorder.add(rows(31)[30:])
    with pytest.raises(ConfigError, match="over"):
        recorder.finish(run)


@pytest.mark.parametrize(
    ("step", "chunk", "on_disk"),
    [(1.0, None, 16), (0.1, None, 100), (1.0, 5, 20), (20.0, None, 16)],
)
def test_a_chunk_is_ten_seconds_or_sixteen_rows(tmp_path, step, chunk, on_disk):
    recorder = Recorder(tmp_path / "run.rrd", {}, NAMES, chunk=chunk)
    table = rows(on_disk + 3, step)
    for row in table:
        recorder.add(row)
    assert len(Trajectory.from_file(recorder.journal)) == on_disk
    recorder.keep()
    kept = Trajectory.from_file(recorder.journal)
    assert len(kept) == on_disk + 3
    assert not kept.complete
    assert kept.names == ["t", "x", "psi"]
    assert kept["psi"].tobytes() == np.ascontiguousarray(table[:, 2]).tobytes()
    with pytest.raises(FileNotFoundError, match=r"broken off left .*run\.rrd\.partial"):
        Trajectory.from_file(tmp_path / "run.rrd")


def test_a_run_that_breaks_off_keeps_its_rows(tmp_path):
    with (
        pytest.raises(KeyboardInterrupt),
        Recorder(tmp_path / "run.rrd", {"seed": 1}, NAMES) as recorder,
    ):
        recorder.add(rows(3))
        raise KeyboardInterrupt
    kept = Trajectory.from_file(tmp_path / "run.rrd.partial")
    assert len(kept) == 3
    assert kept.meta == {"seed": 1, "complete": False}
    Recorder(tmp_path / "run.rrd", {}, NAMES).discard()  # of a new run of that name
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("limit", [8000, 12000])  # bytes: the last chunk fits, or does not
def test_a_full_disk_is_one_error_and_leaves_the_rows(tmp_path, limited, limit):
    recorder = Recorder(tmp_path / "run.rrd", {}, NAMES)
    with limited(limit):
        with pytest.raises(OSError, match=r"run\.rrd") as error:
            recorder.add(rows(400))
            recorder.finish(run_of(rows(400)))
        recorder.keep()
    assert "\n" not in str(error.value)
    if limit == 12000:  # the rows had room, the file has not
        assert str(error.value).endswith(f"; its rows are in {recorder.journal}")
    assert os.listdir(tmp_path) == ["run.rrd.partial"]
    kept = len(Trajectory.from_file(recorder.journal))
    assert kept % 16 == 0
    assert kept == 400 if limit == 12000 else limit - 3 * 16 * 24 < 24 * kept < limit


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (np.zeros((2, 2)), r"shape \(2, 2\), not \(k, 3\)"),
        (np.array([[0.0, 1.0, np.nan]]), "psi = nan"),
        (rows(2)[::-1], "'t' does not increase: 1.0 then 0.0"),
    ],
)
def test_rows_that_no_trajectory_takes_are_refused(tmp_path, table, message):
    with (
        Recorder(tmp_path / "run.rrd", {}, NAMES) as recorder,
        pytest.raises(ConfigError, match=message),
    ):
        recorder.add(table)


def test_what_cannot_be_recorded_is_refused_before_the_run(tmp_path):
    for path, message in ((tmp_path / "run.csv", r"\*\.rrd"), (tmp_path, r"\*\.rrd")):
        with pytest.raises(ConfigError, match=message):
            Recorder(path, {}, NAMES)
    (tmp_path / "folder.rrd").mkdir()
    with pytest.raises(ConfigError, match="is a folder"):
        Recorder(tmp_path / "folder.rrd", {}, NAMES)
    for names in (["x"], ["t", "t"]):
        with pytest.raises(ConfigError, match="'t' must be among them"):
            Recorder(tmp_path / "run.rrd", {}, names)
    with pytest.raises(ValueError, match=r"meta\['far'\] is inf"):
        Recorder(tmp_path / "run.rrd", {"far": np.inf}, NAMES)
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="file"):
        Recorder(tmp_path / "file" / "run.rrd", {}, NAMES)
    recorder = Recorder(tmp_path / "run.rrd", {}, NAMES)
    with pytest.raises(ConfigError, match="another run"):
        Recorder(tmp_path / "run.rrd", {}, NAMES)
    recorder.discard()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the killed process is a fork of this one")
@pytest.mark.parametrize("moment", [0.0005, 0.002, 0.005, 0.012, 0.02])
def test_a_kill_costs_at_most_one_chunk(tmp_path, moment):
    told = mmap.mmap(-1, 8)
    path = tmp_path / "run.rrd"
    table = rows(100_000)
    child = os.fork()
    if child == 0:  # pragma: no cover (is killed)
        recorder = Recorder(path, {}, NAMES, chunk=7)
        for k, row in enumerate(table, start=1):
            recorder.add(row)
            told[:] = struct.pack("<q", k)
        os._exit(0)
    while struct.unpack("<q", told)[0] < 8:
        time.sleep(1e-4)
    time.sleep(moment)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    added = struct.unpack("<q", told)[0]
    kept = Trajectory.from_file(recorder_journal := path.with_name("run.rrd.partial"))
    assert added - 7 < len(kept) <= added + 1  # one more may be on disk that was not told
    assert kept["x"].tolist() == table[: len(kept), 0].tolist()
    Recorder(path, {}, NAMES).discard()  # nobody holds it any more
    assert not recorder_journal.exists()
