"""ship-gym record of several episodes: seeds, the worst of many, files and formats."""

import json
import shlex
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from ship_gym_agents.controllers import make_controller

from ship_gym.evaluation import evaluation_seeds, metrics, rollout
from ship_gym.recording import Trajectory
from ship_gym.scenarios import load_scenario

from .conftest import SCRIPTS

SHORT = ("--set", "duration=20")


@pytest.fixture
def recorded(cli):
    """Record short episodes; gives what --json says of each."""
    pytest.importorskip("rerun")

    def call(*arguments):
        code, out, err = cli("record", *arguments, *SHORT, "--json")
        assert code == 0, err
        found = json.loads(out)
        return found.get("recordings", [found])

    return call


def test_several_controllers_and_seeds_into_a_folder(recorded, policy):
    given = ("--policy", "run", "run/seed_1", "--controller", "pid")
    found = recorded(*given, "--seeds", "2000003..2000004", "7", "--out", "there")
    names = [name for who in ("run", "run-seed_1", "pid") for name in _names(who)]
    assert [one["file"] for one in found] == [f"there/{name}" for name in names]
    for one in found:
        kept = Trajectory.from_rrd(one["file"])
        assert metrics(kept) == one["metrics"] and kept.meta["seed"] == one["seed"]
        assert kept.meta["controller"] == one["controller"]


def _names(who):
    return [f"{who}-{seed}.rrd" for seed in (2000003, 2000004, 7)]


def test_the_stem_of_a_file_and_the_default_folder(recorded):
    found = recorded("--controller", "pid", "constant", "--seed", 5, "--out", "a.rrd")
    assert [one["file"] for one in found] == ["a-pid-5.rrd", "a-constant-5.rrd"]
    assert [one["file"] for one in recorded("--seeds", 2)] == [
        f"runs/recordings/pid-{seed}.rrd" for seed in evaluation_seeds(2)
    ]


def test_the_extension_decides_the_format(recorded, tmp_path):
    (one,) = recorded("--seed", 5, "--out", "a.csv")
    text = (tmp_path / "a.csv").read_text()
    assert text.startswith("# Ship Gym trajectory") and one["file"] == "a.csv"
    assert {one.suffix for one in tmp_path.rglob("a*")} == {".csv"}
    assert [one["file"] for one in recorded("--seeds", 2, "--out", "b.csv")] == [
        f"b-pid-{seed}.csv" for seed in evaluation_seeds(2)
    ]


def test_the_worst_of_many_are_those_of_the_batch(recorded):
    seeds = evaluation_seeds(6)
    found = recorded("--worst", 2, "--best", 1, "--median", "--by", "J_1", "--of", 6, "--out", "w")
    scenario = load_scenario("heading_keeping", {"duration": 20.0})
    sailed = rollout(make_controller("pid"), scenario, seeds=seeds)
    every = {seed: metrics(sailed.trajectory(i)) for i, seed in enumerate(seeds)}
    order = sorted(seeds, key=lambda seed: every[seed]["J_1"])
    assert [one["seed"] for one in found] == [order[-1], order[-2], order[0], order[2]]
    assert [one["which"] for one in found] == ["worst", "worst", "best", "median"]
    for one in found:
        assert one["metrics"] == every[one["seed"]] and one["by"] == "J_1"
        assert Path(one["file"]) == Path("w") / f"pid-{one['seed']}.rrd"


def test_too_short_episodes_are_chosen_by_the_return(recorded, cli):
    (one,) = recorded("--worst", 1, "--seeds", 3, "--out", "w.rrd")
    every = recorded("--seeds", 3, "--out", "all")
    assert one["metrics"]["J_steady"] is None and one["by"] == "return"
    assert one["seed"] == min(every, key=lambda each: each["metrics"]["return"])["seed"]
    code, out, err = cli("record", "--worst", 1, "--seeds", 3, "--out", "w.rrd", *SHORT)
    assert code == 0 and "by return" in out and "worst" in out, err


def test_failed_ones_are_the_worst(cli):
    pytest.importorskip("rerun")
    given = ("--controller", "constant", "--worst", 1, "--by", "rudder_travel", "--seeds", 6)
    code, out, _ = cli("record", *given, "--json", "--set", "duration=200")
    found = json.loads(out)  # the rudder never moves: all are equal in what they are judged by
    assert code == 0 and found["failed"] and found["which"] == "worst"


def test_few_stand_side_by_side_and_many_have_a_row_each(cli):
    pytest.importorskip("rerun")
    code, out, _ = cli("record", "--controller", "pid", "constant", "--seeds", 1, *SHORT)
    assert code == 0 and out.splitlines()[0].split() == ["metric", "unit", "pid", "constant"]
    assert "wrote 2 files in runs/recordings\nnext: ship-gym review list runs/recordings" in out
    code, out, _ = cli("record", "--seeds", 5, *SHORT)
    assert code == 0 and out.splitlines()[0].split()[:3] == ["controller", "seed", "outcome"]
    assert out.splitlines()[5].split()[:2] == ["pid", str(evaluation_seeds(5)[-1])]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--seeds", "2000000"], ["1 to 1000", "--seed"]),
        (["--seeds", "0"], ["--seeds = 0", "1 to 1000"]),
        (["--seeds", "7..3"], ["--seeds = 7..3", "FIRST <= LAST"]),
        (["--seeds", "3", "-1"], ["-1"]),
        (["--seeds", "1..x"], ["--seeds = 1..x", "FIRST..LAST"]),
        (["--seeds", "1..5000"], ["5000 seeds", "1000 at most"]),
        (["--seeds", "1..3", "2"], ["seed 2 is there twice"]),
        (["--seeds", "1..3", "--seed", "2"], ["--seed and --seeds"]),
        (["--worst", "2", "--of", "8", "--seeds", "9"], ["--seeds and --of"]),
        (["--worst", "0"], ["--worst = 0: allowed is 1"]),
        (["--by", "J_1"], ["--by J_1: needs --worst"]),
        (["--of", "8"], ["--of 8: needs --worst"]),
        (["--worst", "2", "--by", "J_2"], ["unknown metric 'J_2'", "did you mean"]),
        (["--out", "x.mp4"], ["--out x.mp4: allowed is a .rrd or .csv file, or a folder"]),
        (["--out", "file"], ["--out file: file is a file, not a folder"]),
        (["--controller", "pid", "pit", "--seeds", "3"], ["did you mean 'pid'"]),
        (["--controller", "own.py:A", "own.py:B"], ["'my law' and 'my-law'", "one file"]),
    ],
)
def test_what_cannot_be_used_is_one_line_before_any_work(cli, tmp_path, arguments, words):
    pytest.importorskip("rerun")
    (tmp_path / "file").write_text("")
    (tmp_path / "own.py").write_text(_OWN)
    code, out, err = cli("record", *arguments)
    assert (code, out, err.count("\n")) == (2, "", 1), err
    assert all(word in err for word in words), err
    assert {path.name for path in tmp_path.iterdir()} <= {"file", "own.py", "__pycache__"}


_OWN = """
from ship_gym.evaluation.controller import ConstantController


def A():
    made = ConstantController()
    made.name = "my law"
    return made


def B():
    made = ConstantController()
    made.name = "my-law"
    return made
"""


_ENDS = """
import os
import signal

from ship_gym.evaluation.controller import ConstantController


class Ends(ConstantController):
    k = 0

    def act(self, observations):
        self.k += 1
        if self.k == 91:
            os.kill(os.getpid(), signal.{})
        return super().act(observations)
"""


@pytest.mark.parametrize("by", ["SIGKILL", "SIGINT"])
def test_what_was_sailed_before_it_was_killed_can_be_read(tmp_path, by):
    pytest.importorskip("rerun")
    (tmp_path / "own.py").write_text(_ENDS.format(by))
    call = [sys.executable, str(SCRIPTS / "record.py"), "--controller", "own.py:Ends"]
    call += ["--seeds", "7..8", "--out", "rec"]
    ended = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True)
    files = sorted((tmp_path / "rec").iterdir())
    assert [file.name for file in files] == [f"constant-{k}.rrd.partial" for k in (7, 8)]
    for file in files:
        kept = Trajectory.from_file(file)
        assert not kept.complete and kept.meta["seed"] in (7, 8)
        # 90 intervals of 1 s sailed: all rows, or all but those of the last chunk of 16
        assert len(kept) >= (90 if by == "SIGINT" else 90 - 16)
    if by == "SIGINT":
        assert ended.returncode == 2 and ended.stderr.strip().count("\n") == 0
        assert "rec/constant-7.rrd.partial, rec/constant-8.rrd.partial" in ended.stderr
    else:
        assert ended.returncode == -signal.SIGKILL


def run_next(cli, command):
    """What the command of a ``next:`` line says in JSON."""
    words = shlex.split(command)
    assert words[0] == "ship-gym"
    code, out, err = cli(*words[1:], "--json")
    assert code == 0, err
    return json.loads(out)


@pytest.mark.parametrize(
    ("arguments", "who"),
    [
        (["--controller", "pid", "constant"], "pid"),
        (["--policy", "heading_kcs"], "heading_kcs"),  # what it was trained for is sailed
        (["--controller", "pid", "generalist"], "generalist"),
        (["--policy", "ppo_kcs", "--ship", "kvlcc2", "--scenario", "heading_ss5_beam"], "ppo_kcs"),
        (["--task", "course_changing", "--controller", "adaptive"], "adaptive"),
    ],
)
def test_the_next_line_of_evaluate_records_exactly_its_worst_episode(cli, arguments, who):
    pytest.importorskip("rerun")
    short = ["--set", "duration=40", "sea.current_speed=1.5", 'sea.states=["ss4", "ss5"]']
    code, out, err = cli("evaluate", *arguments, "--episodes", 5, *short, "--json")
    assert code == 0, err
    found = json.loads(out)
    worst = found["extremes"]["of"][who]["worst"]
    again = run_next(cli, found["next"])
    assert (again["controller"], again["seed"]) == (who, worst["seed"])
    i = found["seeds"].index(worst["seed"])
    assert again["metrics"] == {name: row[i] for name, row in found["episodes"][who].items()}
    assert again["metrics"][found["extremes"]["by"]] == worst["value"]
    assert Trajectory.from_rrd(again["file"]).meta["config"] == found["scenario"]


def test_evaluate_records_what_it_sailed(cli, tmp_path):
    pytest.importorskip("rerun")
    given = ("--controllers", "pid", "constant", "--episodes", 4, "--set", "duration=200")
    record = ("--record", "rec", "--which", "worst", "median", "failed")
    code, out, err = cli("evaluate", *given, *record, "--json")
    assert code == 0, err
    found = json.loads(out)
    assert found["next"] == "ship-gym review list rec"
    shown = found["extremes"]["of"].items()
    wanted = {f"rec/{who}-{e[w]['seed']}.rrd" for who, e in shown for w in ("worst", "median")}
    success = dict(zip(found["seeds"], found["episodes"]["constant"]["success"], strict=True))
    lost = {f"rec/constant-{seed}.rrd" for seed, kept in success.items() if not kept}
    assert lost and set(found["recordings"]) == wanted | lost
    for file in found["recordings"]:
        kept = Trajectory.from_rrd(tmp_path / file)
        i = found["seeds"].index(kept.meta["seed"])
        every = found["episodes"][kept.meta["controller"]]
        assert metrics(kept) == {name: row[i] for name, row in every.items()}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--which", "all"], ["--which: needs --record"]),
        (["--record", "r", "--which", "wrst"], ["did you mean 'worst'"]),
        (["--record", "file"], ["file is a file"]),
        (["--record", "r", "--controller", "own.py:A", "own.py:B"], ["one file"]),
    ],
)
def test_evaluate_refuses_before_any_work(cli, tmp_path, arguments, words):
    (tmp_path / "file").write_text("")
    (tmp_path / "own.py").write_text(_OWN)
    code, out, err = cli("evaluate", *arguments)
    assert (code, out, err.count("\n")) == (2, "", 1), err
    assert all(word in err for word in words)
    assert {path.name for path in tmp_path.iterdir()} <= {"file", "own.py", "__pycache__"}


def test_no_episode_failed(cli, tmp_path):
    pytest.importorskip("rerun")
    given = ("--controllers", "pid", "--episodes", 1, *SHORT, "--record", "r", "--which", "failed")
    code, out, _ = cli("evaluate", *given)
    assert code == 0 and "0 recordings in r\nnext: ship-gym record --controller pid" in out
