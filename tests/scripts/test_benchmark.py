import json
import shlex
from pathlib import Path

import pytest
from ship_gym_agents.sail_again import sail_again

from ship_gym.evaluation import metrics, read_results
from ship_gym.evaluation.report import judge
from ship_gym.evaluation.report.episodes import episode
from ship_gym.evaluation.run_folder import RunFolder
from ship_gym.recording import Trajectory
from tests.evaluation.benchmarking import write_suite

pytest.importorskip("pyarrow")
pytest.importorskip("matplotlib")


@pytest.fixture
def small(cli, tmp_path):
    """Run the small suite in this process."""
    write_suite(tmp_path)
    return lambda *more: cli("benchmark", "--suite", "small.toml", "--jobs", 1, *more)


def test_benchmark_prints_scores_and_what_comes_next(small, tmp_path):
    names = ["--controllers", "pid", "own.py:Good", "own.py:Raises"]
    code, out, err = small("--seeds", 3, *names, "--json")
    assert code == 0, err
    found = json.loads(out)
    assert found["files"] == ["runs/benchmark/episodes.parquet", "runs/benchmark/report.html"]
    assert all((tmp_path / file).is_file() for file in found["files"])
    rows = {row["controller"]: row for row in found["scores"]}
    assert set(rows) == {"constant", "pid", "good", "raises"}
    assert rows["raises"]["errors"] > 0 and rows["good"]["errors"] == 0
    assert rows["good"]["kind"] == "own" and rows["pid"]["episodes"] == 6
    assert found["next"].startswith("ship-gym record --controller ")
    code, out, err = small("--seeds", 3, *names, "--no-report")
    assert code == 0 and "16 of" not in out
    assert "8 units, 8 of them kept from before" in out
    assert "raises: " in out and "interval 17: ValueError: to starboard" in out
    assert "wrote runs/benchmark/episodes.parquet" in out and "next: ship-gym record" in out


def test_the_next_line_records_exactly_the_worst_episode(small, cli):
    pytest.importorskip("rerun")
    code, out, err = small(
        "--seeds", 3, "--controllers", "pid", "heading_kcs", "--no-report", "--json"
    )
    assert code == 0, err
    following = shlex.split(json.loads(out)["next"])
    code, out, err = cli(*following[1:], "--json")
    assert code == 0, err
    again = json.loads(out)
    found = read_results("runs/benchmark").rows()
    cell = {(row["scenario"], row["ship"]): row for row in found}
    first = [r for r in found if (r["scenario"], r["ship"]) == next(iter(cell))]
    worst = max((r for r in first if r["controller"] != "constant"), key=lambda r: r["value"])
    assert (again["controller"], again["seed"]) == (worst["controller"], worst["seed"])
    assert again["metrics"] == {name: worst[name] for name in again["metrics"]}


def test_the_next_line_brings_the_task_of_ones_own(cli, tmp_path):
    pytest.importorskip("rerun")
    (tmp_path / "mine.toml").write_text(_OWN_TASK.format(HOLD_YAW_RATE))
    (tmp_path / "short.toml").write_text('base = "hold_yaw_rate"\nduration = 20.0\n')
    given = ("--suite", "mine.toml", "--seeds", 2, "--jobs", 1, "--controllers", "constant")
    code, out, err = cli("benchmark", *given, "--record", "--no-report", "--json")
    assert code == 0, err
    (file,) = (tmp_path / "runs/benchmark/episodes").iterdir()
    recorded = Trajectory.from_rrd(file)
    judged = judge(read_results("runs/benchmark"))
    again = episode(judged, judged.events[0], "constant", recorded.meta["seed"])
    assert again.task == str(HOLD_YAW_RATE)
    code, out, err = cli(*shlex.split(again.command)[1:], "--json")
    assert code == 0, err
    assert json.loads(out)["metrics"] == metrics(recorded)
    assert metrics(sail_again(again)) == metrics(recorded)


HOLD_YAW_RATE = Path(__file__).parents[1] / "recipes" / "hold_yaw_rate.py"
_OWN_TASK = """
name = "mine"
version = "1"
title = "Mine"
ships = ["kcs"]
controllers = ["constant"]
tasks = ["{}"]

[[scenario]]
name = "short.toml"
"""


def test_the_worst_episode_of_each_controller_is_recorded_and_linked(small, tmp_path):
    pytest.importorskip("rerun")
    names = ("--controllers", "pid", "own.py:Good", "own.py:Raises", "own.py:Reset")
    code, out, err = small("--seeds", 3, *names, "--record", "--json")
    assert code == 0, err
    found = json.loads(out)
    assert found["next"] == "ship-gym review list runs/benchmark/episodes"
    told, rows = found["about"]["recordings"], read_results("runs/benchmark").rows()
    assert told["errors"] == told["differing"] == []
    page = (tmp_path / "runs/benchmark/report.html").read_text()
    sailed = set()
    for scenario, ships in told["files"]["small"].items():
        for controller, file in ships["kcs"].items():
            kept = Trajectory.from_rrd(tmp_path / "runs/benchmark" / file)
            of = [r for r in rows if (r["scenario"], r["controller"]) == (scenario, controller)]
            of = [row for row in of if not row["error"]]
            by = "value" if scenario == "heading_calm" else "return"  # 60 s are all turn
            sign = 1.0 if by == "value" else -1.0
            worst = max(of, key=lambda row: (row["failed"], sign * row[by], row["seed"]))
            assert (kept.meta["seed"], kept.meta["controller"]) == (worst["seed"], controller)
            assert metrics(kept) == {name: worst[name] for name in metrics(kept)}
            assert (f'<a href="{file}">{worst["seed"]}: ' in page) == (by == "value")
            sailed.add((scenario, controller))
    steer = {(r["scenario"], r["controller"]) for r in rows if not r["error"]}
    assert sailed == {pair for pair in steer if pair[1] != "constant"} and len(sailed) >= 5


def test_recordings_that_are_there_are_kept_and_fresh_removes_them(small, tmp_path):
    pytest.importorskip("rerun")
    given = ("--seeds", 2, "--controllers", "pid", "--no-report")
    assert small(*given)[0] == 0
    code, out, _ = small(*given, "--record")
    files = sorted((tmp_path / "runs/benchmark/episodes").iterdir())
    assert code == 0 and "wrote 2 recordings of worst episodes in runs/benchmark/episodes" in out
    assert [file.name for file in files] == [file.name for file in files if "-pid-2" in file.name]
    made = [file.stat().st_mtime_ns for file in files]
    files[0].unlink()
    assert small(*given, "--record")[0] == 0
    assert files[0].is_file() and files[1].stat().st_mtime_ns == made[1]
    assert small(*given, "--fresh")[0] == 0
    assert not any(file.exists() for file in files)


def test_other_settings_in_the_folder_are_one_line(small):
    assert small("--seeds", 1, "--no-report")[0] == 0
    code, out, err = small("--seeds", 2, "--no-report")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert err.startswith("error: runs/benchmark holds a run with other seeds: ")
    assert small("--seeds", 2, "--no-report", "--fresh")[0] == 0


def test_an_interruption_says_what_is_kept_and_how_to_go_on(small, monkeypatch):
    keep = RunFolder.keep

    def interrupted(self, number, sailed):
        if number == 2:
            raise KeyboardInterrupt
        keep(self, number, sailed)

    monkeypatch.setattr(RunFolder, "keep", interrupted)
    code, out, err = small("--seeds", 2)
    assert (code, out) == (2, "")
    assert "interrupted: 2 of 4 units are kept in runs/benchmark" in err
    command = "ship-gym benchmark --suite small.toml --seeds 2 --jobs 1 --out runs/benchmark"
    assert command in " ".join(err.split())


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--suite", "hedaing"], "did you mean 'heading'"),
        (["--suite", "none.toml"], "none.toml: no such file"),
        (["--seeds", "0"], "--seeds = 0: allowed is"),
        (["--engine", "rya"], "did you mean 'ray'"),
        (["--patience", "-1"], "--patience = -1: allowed is"),
        (["--controllers", "pit"], "did you mean 'pid'"),
        (["--ships", "kcz"], "did you mean 'kcs'"),
        (["--address", "auto"], "only the engine 'ray' has one"),
        (["--suite", "manoeuvres", "--record"], "--record: of episodes"),
    ],
)
def test_errors_are_one_line_and_leave_nothing(cli, tmp_path, arguments, words):
    code, out, err = cli("benchmark", *arguments)
    assert (code, out, err.count("\n")) == (2, "", 1) and words in err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("Raises", "interval 17: ValueError: to starboard (own.py:"),
        ("Shape", "episode 2000000, interval 0: actions have shape (3,)"),
        ("Reset", "episode 2000000, reset: RuntimeError: not today (own.py:"),
    ],
)
def test_evaluate_says_where_a_controller_failed(cli, tmp_path, name, words):
    write_suite(tmp_path)
    arguments = ["--controller", f"own.py:{name}", "--scenario", "short.toml"]
    code, out, err = cli("evaluate", *arguments, "--episodes", 6)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert err.startswith(f"error: controller {name.lower()}, episode 20000") and words in err


HULLS = """\
name = "hulls"
version = "mine"
title = "Hulls"
kind = "manoeuvres"
ships = ["kvlcc2"]

[[manoeuvre]]
kind = "zigzag"
rudder_deg = 10.0
"""


def test_manoeuvres_have_a_table_and_a_page_of_their_own(cli, tmp_path):
    (tmp_path / "hulls.toml").write_text(HULLS)
    code, out, err = cli("benchmark", "--suite", "hulls.toml", "--json")
    assert code == 0, err
    found = json.loads(out)
    files = ["runs/benchmark/manoeuvres.parquet", "runs/benchmark/manoeuvres.html"]
    assert found["files"] == files and all((tmp_path / file).is_file() for file in files)
    assert {row["manoeuvre"] for row in found["rows"] if row["side"]} == {"zig-zag 10/10"}
    assert not (tmp_path / "runs/benchmark/episodes.parquet").exists()
    code, out, err = cli("benchmark", "--suite", "hulls.toml", "--ships", "onrt", "--no-report")
    assert code == 0 and "onrt  zig-zag 10/10 starboard  first overshoot" in out and "pass" in out


def test_manoeuvres_beside_episodes(small, tmp_path):
    (tmp_path / "hulls.toml").write_text(HULLS)
    code, out, err = small(
        "--suite", "hulls.toml", "--ships", "kcs", "--seeds", 1, "--controllers", "pid",
        "--no-report", "--json",
    )  # fmt: skip
    assert code == 0, err
    found = json.loads(out)
    assert found["manoeuvres"]["files"] == ["runs/benchmark/manoeuvres.parquet"]
    assert {row["ship"] for row in found["manoeuvres"]["rows"]} == {"kcs"} and found["scores"]


def test_a_folder_without_histories_is_one_line(cli, tmp_path):
    code, out, err = cli("benchmark", "--suite", "manoeuvres", "--trials", "none")
    assert (code, out, err.count("\n")) == (2, "", 1) and "no files marin_free_*.csv" in err
    assert not list(tmp_path.iterdir())
