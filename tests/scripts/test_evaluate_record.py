import json
from pathlib import Path

import pytest
from ship_gym_agents.cli import output

from ship_gym.config import ConfigError


def test_evaluate_writes_what_it_prints(cli, tmp_path):
    code, out, _ = cli("evaluate", "--episodes", 3, "--out", "e/found.json")
    assert code == 0
    assert "constant - pid" in out and "seeds 2000000 to 2000002" in out
    assert "wrote e/found.json" in out and "next: ship-gym record --controller pid" in out
    found = json.loads((tmp_path / "e" / "found.json").read_text())
    assert found["reference"] == "pid" and len(found["episodes"]["pid"]["J_0.1"]) == 3
    assert found["versions"] and found["scenario"]["ship"] == "kcs"


def test_evaluate_json(cli):
    code, out, _ = cli("evaluate", "--controllers", "constant", "--episodes", 1, "--json")
    found = json.loads(out)
    assert code == 0 and found["file"] == "runs/evaluation.json"
    assert list(found["controllers"]) == ["constant"] and found["differences"] == {}


def test_evaluate_a_policy(cli, policy, tmp_path):
    code, out, _ = cli("evaluate", "--policy", policy, "--episodes", 2)
    assert code == 0
    assert "tiny - pid" in out and "next: ship-gym record --policy run" in out
    found = json.loads((tmp_path / "run" / "evaluation.json").read_text())
    assert list(found["controllers"]) == ["tiny", "pid", "constant"]
    assert found["controllers"]["tiny"]["success"]["value"] == 1.0


def test_policy_for_another_control_is_refused_before_work(cli, policy):
    code, out, err = cli("evaluate", "--policy", policy, "--control", "rudder+rpm")
    assert (code, out) == (2, "") and "decisions" in err and "rpm new" in err


def test_several_policies_are_told_apart_by_their_paths(cli, policy, tmp_path):
    given = ("run/seed_0", "run/seed_1", "run")
    code, out, _ = cli("evaluate", "--policy", *given, "--controller", "pid", "--episodes", 1)
    assert code == 0 and "wrote runs/evaluation.json" in out
    found = json.loads((tmp_path / "runs" / "evaluation.json").read_text())
    assert list(found["controllers"]) == [*given, "pid"]
    assert found["episodes"]["run/seed_0"] == found["episodes"]["run"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["evaluate", "--controllers", "pit"], "did you mean 'pid'"),
        (["evaluate", "--ship", "kcz"], "did you mean 'kcs'"),
        (["evaluate", "--control", "ruder"], "did you mean 'rudder'"),
        (["evaluate", "--episodes", "0"], "episodes = 0"),
        (["evaluate", "--policy", "runs/nowhere"], "ship-gym train"),
        (["record", "--controller", "pit"], "did you mean 'pid'"),
        (["record", "--seed", "-1"], "--seed = -1: allowed is 0 to"),
        (["review", "nowhere.rrd"], "nowhere.rrd"),
        (["tune", "--ship", "kcz"], "did you mean 'kcs'"),
        (["tune", "--episodes", "0"], "episodes = 0"),
    ],
)
def test_errors_are_one_line_and_leave_nothing(cli, tmp_path, arguments, message):
    if arguments[0] in ("record", "review"):
        pytest.importorskip("rerun")
    code, out, err = cli(*arguments)
    assert (code, out) == (2, "")
    assert message in err and err.count("\n") == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["evaluate", "record", "review", "tune"])
def test_help_has_two_examples_at_least(cli, name):
    code, out, _ = cli(name, "--help")
    assert code == 0
    assert out.split("examples:")[1].count(f"ship-gym {name}") >= 2
    assert "--json" in out


def test_record_and_review(cli, tmp_path):
    pytest.importorskip("rerun")
    code, out, _ = cli("record", "--controller", "constant", "--seed", 1000001, "--json")
    recorded = json.loads(out)
    assert code == 0 and Path(recorded["file"]) == Path("runs/rollout.rrd")
    code, out, _ = cli("review", recorded["file"], "--json")
    reviewed = json.loads(out)[recorded["file"]]
    assert reviewed["metrics"] == recorded["metrics"]
    assert (reviewed["controller"], reviewed["seed"]) == ("constant", 1000001)
    code, out, _ = cli("review", recorded["file"], "--csv")
    rows = dict(line.split(",", 1) for line in out.splitlines())
    assert float(rows["J_1"].split(",")[1]) == recorded["metrics"]["J_1"]


def test_review_refuses_other_files(cli, tmp_path):
    pytest.importorskip("rerun")
    (tmp_path / "text.rrd").write_text("no recording")
    code, _, err = cli("review", "text.rrd")
    assert code == 2 and "text.rrd" in err and err.count("\n") == 1


@pytest.mark.parametrize(
    ("name", "arguments", "library", "extra"),
    [
        ("record", (), "rerun", "rerun"),
        ("simulate", (), "matplotlib", "plot"),
        ("simulate", ("--rrd", "a.rrd"), "rerun", "rerun"),
        ("fit-surrogate", ("--plot", "a.png"), "matplotlib", "plot"),
        ("fit-surrogate", ("--report",), "matplotlib", "plot"),
    ],
)
def test_missing_extra_is_one_line_before_any_work(
    cli, monkeypatch, tmp_path, name, arguments, library, extra
):
    there = output.find_spec
    monkeypatch.setattr(output, "find_spec", lambda n: None if n == library else there(n))
    code, _, err = cli(name, *arguments)
    assert code == 2 and f'pip install "ship-gym[{extra}]"' in err and err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_run_lets_real_bugs_through():
    with pytest.raises(ZeroDivisionError):
        output.run(lambda: 1 / 0)
    for error in (ConfigError("a\nb"), ImportError("c"), KeyboardInterrupt(), OSError("d")):

        def fail(error=error):
            raise error

        with pytest.raises(SystemExit) as stop:
            output.run(fail)
        assert stop.value.code == 2
