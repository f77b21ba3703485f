"""The fuzzer: its cases find nothing, and it would say what it is to find."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from ship_gym.config import ConfigError

SCRIPTS = Path(__file__).parents[2] / "scripts"


@pytest.fixture
def part(monkeypatch):
    """A part of the fuzzer by name, such as ``judge``."""
    monkeypatch.syspath_prepend(str(SCRIPTS))
    return lambda name: pytest.importorskip(f"_fuzz_{name}")


@pytest.mark.slow
def test_two_thousand_cases_find_nothing(tmp_path):
    """In a process of its own: its workers are forked, which what other tests load may not bear."""
    line = [sys.executable, SCRIPTS / "fuzz.py", "--cases", "2000", "--seed", "0", "--jobs", "2"]
    made = subprocess.run(
        [*line, "--out", tmp_path, "--json"], capture_output=True, text=True, check=False
    )
    assert made.returncode in (0, 1), made.stderr
    found = json.loads(made.stdout)
    assert [(each["kind"], each["cases"], each["message"]) for each in found["findings"]] == []
    assert (found["cases"], found["impossible_ships"]) == (2000, 73)
    assert found["largest_memory_MB"] < 1024
    refused = sum(found["outcomes"].get(outcome, 0) for outcome in ("refused", "used"))
    assert refused > 1900  # most are judged; the rest are command lines that began to work
    assert found["outcomes"]["used"] > 200  # and not all are refused


@pytest.mark.slow
def test_good_inputs_are_accepted(tmp_path, part):
    """An input that is refused before anything is changed would find nothing."""
    formats, judge = part("formats"), part("judge")
    for name, each in formats.FORMATS.items():
        if name in ("command", "impossible ship"):
            continue
        for k, one in enumerate(formats.good(name)[:8]):
            case = formats.Case(0, name, one.name, (), one.files, one.options)
            found = judge.judged(case, tmp_path / f"{name}_{k}")
            assert found.outcome == "used", f"{name} {one.name}: {found.message}"
        assert each.weight > 0


QUICK = ("sea", "scenario", "track", "captive csv", "gains")  # formats with small good inputs


@pytest.fixture(autouse=True)
def room(part, monkeypatch):
    """The process of the tests holds what others left in it."""
    monkeypatch.setattr(part("judge"), "MOST_MEMORY", 1 << 40)


def test_a_case_is_always_the_same(part):
    formats = part("formats")
    quick = [k for k in range(80) if formats.kind_of(3, k) in QUICK]
    cases = [formats.case(3, k) for k in quick]
    assert cases == [formats.case(3, k) for k in quick]
    assert len({repr(one.files) for one in cases}) == len(cases)
    several = next(one for one in cases if len(one.edits) > 1)
    kept = formats.case(3, several.number, (several.edits[0][0],))
    assert kept.edits == several.edits[:1] and kept.files != several.files


def test_every_impossible_value_replaces_one_that_is_there(part):
    ships = list(part("impossible").seeds())
    assert len(ships) == len({ship.name for ship in ships}) == 73


def judged(part, monkeypatch, tmp_path, use, **files):
    """What the judge says of a use of one file."""
    formats, judge = part("formats"), part("judge")
    made = formats.Format(1, lambda: iter(()), use, "nobody")
    monkeypatch.setitem(formats.FORMATS, "probe", made)
    case = formats.Case(0, "probe", "good", (), files or {"probe.txt": b"x"}, {})
    return judge.judged(case, tmp_path / "case")


def raises(error):
    def use(path, **_):
        raise error

    return use


def test_errors_in_words_are_no_findings(part, monkeypatch, tmp_path):
    for error in (ConfigError("probe.txt: no"), OSError(2, "gone", "probe.txt"), ImportError("x")):
        found = judged(part, monkeypatch, tmp_path, raises(error))
        assert (found.outcome, found.bad) == ("refused", False)
    found = judged(part, monkeypatch, tmp_path, raises(ConfigError("speed = -1: wrong")))
    assert not found.bad and "no file named" in found.soft[0]
    assert judged(part, monkeypatch, tmp_path, lambda path: path.read_text()).outcome == "used"
    assert not (tmp_path / "case").exists()


def test_what_must_not_be_is_a_finding(part, monkeypatch, tmp_path):
    from ship_gym.config import check_number

    def inside(path, **_):
        check_number(*())  # as a bug in our code would

    found = judged(part, monkeypatch, tmp_path, raises(KeyError("hull")))
    assert (found.outcome, found.where) == ("traceback", "KeyError at outside our code")
    assert judged(part, monkeypatch, tmp_path, raises(SystemExit(1))).outcome == "traceback"
    found = judged(part, monkeypatch, tmp_path, raises(OSError("a" * 301)))
    assert found.outcome == "long message" and found.message.startswith("301")
    nonsense = part("use").Nonsense("a speed of 1e9 m/s")
    assert judged(part, monkeypatch, tmp_path, raises(nonsense)).kind.startswith("nonsense: probe")
    assert judged(part, monkeypatch, tmp_path, inside).outcome == "traceback"
    monkeypatch.setattr(part("judge"), "MOST_MEMORY", 1)
    assert judged(part, monkeypatch, tmp_path, lambda path: None).outcome == "memory"


def test_an_impossible_ship_that_is_accepted_is_a_finding(part, monkeypatch, tmp_path):
    formats, judge = part("formats"), part("judge")
    name = part("impossible").NAME
    made = formats.Format(0, lambda: iter(()), lambda path: None, "nobody")
    monkeypatch.setitem(formats.FORMATS, name, made)
    case = formats.Case(-1, name, "kcs: rho = 1.025", (), {"ship.toml": b""}, {})
    assert judge.judged(case, tmp_path / "c").kind == "accepted: kcs: rho = 1.025"


def _task(task):
    """What workers are given here; named, so that it is found by them."""
    if task == "die":
        os._exit(3)
    if task == "abort":
        os.abort()
    while task == "hang":
        pass
    return task


def test_workers_that_die_or_hang_are_told_and_replaced(part, monkeypatch, tmp_path):
    pool = part("pool")
    monkeypatch.setattr(pool, "SECONDS", 0.3)
    tasks = ["a", "die", "b", "abort", "hang", "c"]
    begun = time.monotonic()
    with pool.Pool(2, _task, tmp_path) as workers:
        found = dict(workers.each(tasks))
    assert time.monotonic() - begun < 30.0
    assert [found[task] for task in "abc"] == ["a", "b", "c"]
    assert [found[task].outcome for task in ("die", "abort", "hang")] == ["death", "death", "hang"]
    assert found["die"].where.startswith("exit code 3")
    assert found["abort"].where.startswith("SIGABRT")


def test_the_smallest_input_is_searched(part, monkeypatch, tmp_path):
    formats, minimise = part("formats"), part("minimise")

    def use(path, **_):
        if b"bad" in path.read_bytes():
            raise KeyError("bad")

    made = formats.Format(1, lambda: iter(()), use, "nobody")
    monkeypatch.setitem(formats.FORMATS, "probe", made)
    lines = [b"line %d" % k for k in range(40)]
    files = {"probe.csv": b"\n".join([*lines[:23], b"bad", *lines[23:]])}
    case = formats.Case(7, "probe", "good", (), files, {})
    monkeypatch.setattr(minimise, "case", lambda *_: case)
    kind = "traceback: KeyError at outside our code"
    found, _ = minimise.smallest(0, 7, kind, tmp_path)
    assert found.files == {"probe.csv": b"bad"}


@pytest.mark.slow
def test_edits_of_every_kind_end_in_bytes(part):
    formats = part("formats")
    rng = np.random.default_rng(0)
    for name in formats.FORMATS:
        if formats.FORMATS[name].weight and name not in ("recording", "command"):
            seed = formats.good(name)[0]
            for file, data in seed.files.items():
                edit = next(e for end, e in formats.EDITS.items() if file.endswith(end))
                changed = [edit(rng, data) for _ in range(20)]
                assert all(isinstance(one, bytes) for one in changed)
                assert any(one != data for one in changed)


def test_a_run_is_gone_on_with_after_a_kill(part, monkeypatch, tmp_path):
    report = part("report")
    monkeypatch.setattr(report, "warm_up", lambda: None)
    monkeypatch.setattr(report, "_work", lambda job: part("judge").Verdict("refused"))
    formats = ["sea"]
    with report.Run(tmp_path, 0, 300, formats, resume=False) as first:
        steps = first.cases(1)
        for _ in range(5):
            next(steps)
        steps.close()
    with (tmp_path / "cases.jsonl").open("a") as log:
        log.write('{"seed": 0, "case": 2')  # cut by the kill
    with report.Run(tmp_path, 0, 300, formats, resume=True) as second:
        assert second.left == first.left - 5
        assert len(list(second.cases(1))) == second.left
        assert second.report()["cases"] == first.left
    with pytest.raises(ConfigError, match="holds a run of seed 0, not 1"):
        report.Run(tmp_path, 1, 300, formats, resume=True)


def test_a_known_kind_is_counted_and_no_finding(part):
    verdict = part("judge").Verdict
    place = "SIGABRT at ship_gym/recording/rerun_export/rrd_file.py258: _chunks"
    assert not verdict("death", place).bad and "forged" in verdict("death", place).known
    assert verdict("hang", place).bad and verdict("death", "SIGSEGV at rrd_file.py").bad
