"""The script that harms recordings: nothing bad comes of it, and it would say so."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from ship_gym.recording import Recorder, Trajectory

pytest.importorskip("rerun")

T = np.arange(40.0)
RUN = Trajectory({"t": T, "x": 1.5 * T}, {"seed": 1})


@pytest.fixture
def checks(monkeypatch):
    monkeypatch.syspath_prepend(str(Path(__file__).parents[2] / "scripts"))
    return pytest.importorskip("_recording_checks")


@pytest.mark.slow
def test_no_harm_gives_changed_numbers(call):
    code, out, _ = call(
        "check_recordings.py", "--flips", "60", "--cuts", "20", "--kills", "4", "--json"
    )
    data = json.loads(out)
    assert code == 0
    assert data["flips"] == {"one clear error": 60}
    assert sum(data["cuts"].values()) == 20 and data["cuts"]["first rows, marked incomplete"] > 10
    assert sum(data["kills"].values()) == 4
    assert sum(data["full disk"].values()) == 2
    assert data["bad"] == 0


def test_what_was_read_is_judged(tmp_path, checks, monkeypatch):
    path = tmp_path / "run.rrd"
    RUN.to_rrd(path, picture=False)
    assert checks.flipped(str(path), 8000, RUN) == "one clear error"
    assert checks.cut(str(path), 20, RUN) == "one clear error"
    assert checks.cut(str(path), 10**6, RUN) == "reads as before"
    other = Trajectory(RUN.columns | {"x": np.where(T > 30.0, 0.0, 1.5 * T)}, RUN.meta)
    assert checks.cut(str(path), 10**6, other) == "changed numbers pass"
    monkeypatch.setattr(Trajectory, "from_file", lambda path: 1 / 0)
    assert checks.cut(str(path), 10**6, RUN) == "other error: ZeroDivisionError"


def test_what_a_kill_left_is_judged(tmp_path, checks):
    path = tmp_path / "run.rrd"
    assert checks._left(path, RUN, 16) == "journal, at most one chunk lost"
    assert checks._left(path, RUN, 17) == "17 rows lost"
    recorder = Recorder(path, RUN.meta, RUN.names)
    recorder.add(np.stack([RUN["t"], RUN["x"]], axis=1))
    assert checks._left(path, RUN, 40) == "journal, at most one chunk lost"
    assert checks._left(path, RUN, 49) == "17 rows lost"
    other = Trajectory(RUN.columns | {"x": T}, RUN.meta)
    assert checks._left(path, other, 40) == "wrong rows"
    recorder.finish(RUN)
    assert checks._left(path, RUN, 40) == "whole file"
    assert checks._left(path, other, 40) == "wrong file"


def test_places_are_judged(tmp_path, checks, monkeypatch):
    assert checks.refused(str(tmp_path), RUN) == "taken"
    (tmp_path / "file").write_text("")
    assert checks.refused(str(tmp_path / "file"), RUN) != "taken"
    assert checks.full(str(tmp_path / "new"), RUN, "to_rrd", None) == "no error"

    def fail(*_, **__):
        raise OSError("no\nspace")

    monkeypatch.setattr(Trajectory, "to_rrd", fail)
    assert checks.full(str(tmp_path), RUN, "to_rrd", None).startswith("unclear error")
