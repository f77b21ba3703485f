"""A comparison is one sealed rerun file without a record of its own."""

from __future__ import annotations

import errno
import os

import pytest

from tests.recording.runs import run

pytest.importorskip("rerun")

from ship_gym.recording import Trajectory
from ship_gym.recording.comparison_card import content_hash
from ship_gym.recording.rerun_export.compare import read_comparison, write_comparison
from ship_gym.recording.rerun_export.rrd_file import read_chunks
from ship_gym.recording.sealed import DamagedRecording


def test_ships_tracks_lines_card_and_marks_of_all_are_there(tmp_path):
    path = tmp_path / "both.rrd"
    write_comparison([run(), run("lqg", step=0.5)], path)
    shown = {chunk.entity_path for chunk in read_chunks(path)}
    for k in (0, 1):
        assert {f"/world/runs/{k}/hull", f"/world/tracks/{k}", f"/plan/ships/{k}"} <= shown
        assert {f"/compare/error/{k}", f"/compare/rudder/{k}", f"/compare/speed/{k}"} <= shown
    assert {"/compare/distance/0", "/compare/error_less/0", "/about", "/marks"} <= shown
    assert "/record" not in shown


def test_head_lists_the_sources(tmp_path):
    path = tmp_path / "both.rrd"
    write_comparison([run(), run("lqg")], path, ["old", "new"])
    head = read_comparison(path)
    assert head["kind"] == "comparison"
    assert [source["name"] for source in head["sources"]] == ["old", "new"]
    assert head["sources"][1]["content"] == content_hash(run("lqg"))


def test_it_is_no_recording_and_a_recording_is_no_comparison(tmp_path):
    write_comparison([run(), run("lqg")], tmp_path / "both.rrd")
    with pytest.raises(DamagedRecording, match="comparison of runs, which has no record"):
        Trajectory.from_rrd(tmp_path / "both.rrd")
    run().to_rrd(tmp_path / "one.rrd")
    with pytest.raises(DamagedRecording, match="no comparison"):
        read_comparison(tmp_path / "one.rrd")


def test_it_is_sealed(tmp_path):
    path = tmp_path / "both.rrd"
    write_comparison([run(), run("lqg")], path)
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)
    with pytest.raises(DamagedRecording):
        read_comparison(path)


def test_full_disk_is_one_line_that_names_the_file(tmp_path, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("pathlib.Path.write_bytes", full)
    with pytest.raises(OSError, match=r"both\.rrd: no space left"):
        write_comparison([run(), run("lqg")], tmp_path / "both.rrd")
    assert os.listdir(tmp_path) == []
