"""The script that kills: nothing bad comes of it, and it would say so."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from ship_gym.writing import atomic_path, check_place

SCRIPTS = Path(__file__).parents[2] / "scripts"
pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="forks")


@pytest.fixture
def kills(monkeypatch):
    monkeypatch.syspath_prepend(str(SCRIPTS))
    return pytest.importorskip("check_kills")


@pytest.mark.slow
@pytest.mark.compiled
def test_killed_runs_go_on_and_equal_others(tmp_path):
    for library in ("optuna", "rerun", "pyarrow", "capytaine"):
        pytest.importorskip(library)
    command = [sys.executable, SCRIPTS / "check_kills.py", "--log", "kills.jsonl", "--json"]
    # apart from this process, which tests may have used rerun in: it must not be forked then
    done = subprocess.run([*command, "--kills", "2"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr + done.stdout
    data = json.loads(done.stdout)
    assert data["bad"] == 0
    assert {"train", "tune", "benchmark", "record", "table"} <= set(data["kills"])
    assert all(sum(data[name].values()) == 2 for name in data["kills"])


def whole():
    """A work that writes two files as it should."""
    for name in ("a.json", "b.json"):
        with atomic_path(check_place(name, "--out")) as temporary:
            temporary.write_text("[1]")


def half():
    """One that writes over the file itself, in steps, and takes a half one for done."""
    if not os.path.exists("a.json"):
        with open("a.json", "w") as file:
            file.write("[1")
            file.flush()
            Path("b.json").write_text("[1]")
            file.write("]")
    Path("b.json").write_text("[1]")


def read(folder):
    return [json.loads((folder / name).read_text()) for name in ("a.json", "b.json")]


def broken(folder, _):
    for file in folder.glob("[!.]*.json"):
        json.loads(file.read_text())
    return ""


@pytest.mark.parametrize(("run", "good"), [(whole, True), (half, False)])
def test_a_work_is_judged_by_what_its_kills_leave(tmp_path, kills, run, good):
    from _kill_works import Work

    work = Work(run, broken, read)
    known = kills._known(work, tmp_path)
    assert known.names == ["a.json", "b.json"] and known.changes >= 2
    outcomes = set()
    for change in range(1, known.changes + 1):
        case = tmp_path / str(change) / "case"
        case.mkdir(parents=True)
        moments = Moments(change)
        outcome, told = kills._case(work, known, case, moments)
        assert told == [f"killed {{'change': {change}}}"], "killed there, and once"
        outcomes.add(outcome)
    if good:
        assert outcomes == {kills.GOOD}
    else:
        assert any(outcome.startswith("inconsistent: JSONDecodeError") for outcome in outcomes)


class Moments:
    """In place of chance: one change of a file, and no second kill."""

    def __init__(self, change):
        self.change = change

    def random(self):
        return 0.5

    def integers(self, *_):
        return self.change


def test_the_log_is_gone_on_with_and_half_a_line_is_none(tmp_path, kills):
    args = type("Args", (), {"log": tmp_path / "x.jsonl", "seed": 0, "fresh": False, "kills": 5})
    kills._begin(args)
    row = {"work": "tune", "number": 1, "outcome": kills.GOOD, "kills": 1}
    with args.log.open("a") as log:
        log.write(json.dumps(row) + "\n" + '{"work": "tu')
    kills._begin(args)
    assert kills._logged(args) == [row]
    args.seed = 1
    kills._begin(args)
    assert kills._logged(args) == []


def test_differences_are_told(kills):
    assert kills._differing({"a": np.float64(1.0)}, {"a": 1.0}) == ""
    assert "1.5" in kills._differing({"a": 1.5}, {"a": 1.0})
