"""What all verbs of ship-gym share: help, JSON, one-line refusals, own files, completion."""

from __future__ import annotations

import json
import re
import runpy
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from ship_gym_agents.cli import VERBS, load_verb, main
from ship_gym_agents.cli.names import NAMES

from ship_gym.ships.files import DATA

ROOT = Path(__file__).parents[2]
SCRIPTS = {verb: verb.replace("-", "_") for verb in VERBS if verb not in ("list", "completion")}
SCRIPTS["speed"] = "benchmark_speed"
OWN = '''
import numpy as np


class Steady:
    """Rudder held at a tenth of its range."""

    name = "steady"

    def reset(self, count, ship, scenario):
        self.count = count

    def act(self, observations):
        return np.full((self.count, 1), 0.1)


class Tuned(Steady):
    def __init__(self, gain):
        self.gain = gain


class Halves:
    def act(self, observations): ...


def made():
    controller = Steady()
    controller.name = "made"
    return controller


kept = Steady()
kept.name = "kept"
number = 3
'''


@pytest.fixture
def own(tmp_path):
    (tmp_path / "mine.py").write_text(OWN)
    return "mine.py"


@pytest.mark.parametrize("verb", VERBS)
def test_help_has_examples_and_the_line_of_the_overview(cli, verb):
    code, out, _ = cli(verb, "--help")
    examples = out.split("examples:")[1]
    assert code == 0 and examples.count(f"ship-gym {verb}") >= 2 and "--json" in out
    assert load_verb(verb).help.partition("\n")[0] == VERBS[verb]


def test_overview_names_every_verb_and_imports_nothing_heavy(cli):
    code, out, _ = cli("--help")
    assert code == 0 and all(verb in out for verb in VERBS)
    assert cli()[1] == out
    heavy = "{'numpy', 'gymnasium', 'ship_gym', 'torch', 'tqdm'} & set(sys.modules)"
    for arguments in ([], *([verb] for verb in VERBS)):
        code = f"""
import sys
from ship_gym_agents.cli import main
main({[*arguments, "--help"]})
sys.exit(", ".join({heavy}) or 0)"""
        subprocess.run([sys.executable, "-c", code], check=True, stdout=subprocess.DEVNULL)


@pytest.mark.parametrize(("verb", "script"), SCRIPTS.items())
def test_scripts_are_the_verbs(monkeypatch, capsys, verb, script):
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    monkeypatch.setattr(sys, "argv", [f"scripts/{script}.py", "--help"])
    runpy.run_path(str(ROOT / "scripts" / f"{script}.py"), run_name="__main__")
    out = capsys.readouterr().out
    assert out.split("examples:")[1].count(f"python scripts/{script}.py") >= 2
    assert VERBS[verb] in " ".join(out.split())


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["trian"], ["unknown verb 'trian'", "did you mean 'train'"]),
        (["train", "--minuets", "1"], ["--minuets", "--minutes"]),
        (["train", "--minutes", "0"], ["--minutes = 0: allowed is 0.001 to 1000000 [min]"]),
        (["train", "--minutes", "nan"], ["--minutes = nan: allowed is"]),
        (["train", "--envs", "0"], ["--envs = 0: allowed is 1 to 100000"]),
        (["train", "--steps", "many"], ["--steps = many: must be a whole number"]),
        (["train", "--seed", "-1"], ["--seed = -1: allowed is 0 to 4294967295"]),
        (["train", "--algo", "a2c"], ["algorithm 'a2c'", "Known: dqn, gauss_newton, ppo"]),
        (["train", "--ship", "kcz"], ["did you mean 'kcs'"]),
        (["train", "--set", "duration"], ["--set duration: must be KEY=VALUE"]),
        (["train", "--set", "sea.wnd=1"], ["unknown key 'wnd'"]),
        (["train", "--set", "a=1", "a=2"], ["a is given twice"]),
        (["train", "--out", "file"], ["file is a file, not a folder"]),
        (["train", "--resume"], ["no run to resume"]),
        (["train", "--recipe", "none"], ["unknown recipe 'none'"]),
        (["train", "--set", "training.gama=1"], ["unknown key 'gama'; did you mean 'gamma'"]),
        (["tune", "--generations", "0"], ["--generations = 0: allowed is 1 to 10000"]),
        (["tune", "--out", "g.toml"], ["name one controller and one ship"]),
        (["tune", "--ship", "kcs", "--out", "g.json"], ["--out g.json: allowed is a .toml file"]),
        (["tune", "--ship", "none.toml"], ["none.toml: no such file"]),
        (["evaluate", "--episodes", "1.5"], ["--episodes = 1.5: must be a whole number"]),
        (["evaluate", "--out", "e.csv"], ["--out e.csv: allowed is a .json file"]),
        (["evaluate", "--controllers", "pid", "pid"], ["two controllers are named 'pid'"]),
        (["evaluate", "--controllers"], ["nothing to sail"]),
        (["evaluate", "--scenario", "none.toml"], ["none.toml: no such file"]),
        (["record", "--out", "x.mp4"], ["--out x.mp4: allowed is a .rrd or .csv file"]),
        (["record", "--policy", "pid", "--controller", "pid"], ["two controllers are named 'pid'"]),
        (["record", "--out", "file/x.rrd"], ["file is a file, not a folder"]),
        (["review"], ["FILE"]),
        (["simulate", "zigzag", "--delta", "10", "--psi", "-10"], ["10 deg", "-10 deg"]),
        (["simulate", "zigzag", "--delta", "0"], ["delta = 0 deg"]),
        (["simulate", "--delta", "0"], ["delta = 0 deg"]),
        (["simulate", "--delta", "ten"], ["--delta = ten: must be a number [deg]"]),
        (["simulate", "--sea", "ss5", "--wave-from", "1e9"], ["wave_from", "deg"]),
        (["simulate", "--csv", "a.txt"], ["--csv a.txt: allowed is a .csv file"]),
        (["simulate", "--rrd", "a.csv"], ["--rrd a.csv: allowed is a .rrd file"]),
        (["simulate", "--out", "a.pdf"], ["--out a.pdf: allowed is a .png file"]),
        (["simulate", "--loading", "a"], ["--loading a: allowed is a .png file"]),
        (["simulate", "--out", "a.png", "--loading", "a.png"], ["--out writes that file"]),
        (["fit-surrogate", "--plot", "a.jpg"], ["--plot a.jpg: allowed is a .png file"]),
        (["fit-surrogate", "--report", "a.txt"], ["--report a.txt: allowed is a .html file"]),
        (["fit-surrogate", "--out", "a.csv"], ["--out a.csv: allowed is a .npz file"]),
        (["fit-surrogate", "--validation", "x"], ["--validation = x: must be a whole number"]),
        (["build-wave-table", "--jobs", "0"], ["--jobs = 0: allowed is 1 to 1024"]),
        (["build-wave-table", "--ship", "none.toml"], ["none.toml: no such file"]),
        (["build-wave-table", "--out", "w.csv"], ["--out w.csv: allowed is a .npz file"]),
        (["speed", "--quik"], ["--quick"]),
        (["list", "ship"], ["did you mean 'ships'"]),
        (["list", "none.py"], ["none.py: no such file"]),
        (["completion", "tcsh"], ["bash", "fish"]),
    ],
)
def test_what_cannot_be_used_is_one_line_before_any_work(cli, tmp_path, arguments, words):
    (tmp_path / "file").write_text("")
    code, out, err = cli(*arguments)
    assert (code, out, err.count("\n")) == (2, "", 1), err
    assert err.startswith("error: ") and all(word in err for word in words), err
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_an_own_controller_is_evaluated_with_others(cli, own):
    arguments = ["--controller", f"{own}:Steady", "mine.py:made", "--controllers", "mine.py:kept"]
    code, out, err = cli("evaluate", *arguments, "--episodes", 1, "--set", "duration=20", "--json")
    assert code == 0, err
    found = json.loads(out)
    assert list(found["controllers"]) == ["steady", "made", "kept"]
    assert found["scenario"]["duration"] == 20.0
    assert (
        found["next"]
        == "ship-gym record --controller mine.py:Steady --set duration=20 --seed 2000000"
    )


def test_an_own_controller_is_recorded_and_reviewed(cli, own):
    pytest.importorskip("rerun")
    short = ["--set", "duration=20", "sensors.noise=false"]
    code, out, err = cli("record", "--controller", f"{own}:Steady", *short, "--json")
    assert code == 0, err
    assert json.loads(out)["next"] == "ship-gym review show runs/rollout.rrd"
    code, out, _ = cli("review", "runs/rollout.rrd", "--json")
    assert json.loads(out)["runs/rollout.rrd"]["controller"] == "steady"


def test_own_controllers_are_listed(cli, own):
    code, out, _ = cli("list", own, "--json")
    assert code == 0
    assert json.loads(out) == {
        "mine.py": {
            "mine.py:Steady": "Rudder held at a tenth of its range.",
            "mine.py:Tuned": "",
            "mine.py:kept": "Rudder held at a tenth of its range.",
        }
    }


@pytest.mark.parametrize(
    ("named", "words"),
    [
        ("none.py:LQR", ["none.py: no such file"]),
        ("mine.py", ["which object of the file? Name it, like mine.py:Steady, mine.py:Tuned"]),
        ("mine.py:Stedy", ["name in mine.py 'Stedy'", "did you mean 'Steady'"]),
        ("mine.py:number", ["is no controller: it has no name and no reset and no act"]),
        ("mine.py:Halves", ["is no controller: it has no name and no reset"]),
        ("mine.py:Tuned", ["cannot be made: TypeError", "'gain'"]),
        ("bad.py:LQR", ["bad.py:3: ZeroDivisionError: division by zero"]),
        ("torn.py:LQR", ["torn.py:1: SyntaxError: invalid syntax"]),
        ("lost.py:LQR", ["lost.py:1: ModuleNotFoundError: No module named 'nowhere'"]),
        ("stop.py:LQR", ["stop.py:2: SystemExit: 3"]),
    ],
)
@pytest.mark.parametrize("verb", ["evaluate", "record"])
def test_own_files_that_cannot_be_used_are_one_line(cli, own, tmp_path, verb, named, words):
    (tmp_path / "bad.py").write_text("\ndef broken():\n    return 1 / 0\n\nbroken()\n")
    (tmp_path / "torn.py").write_text("class = 3\n")
    (tmp_path / "lost.py").write_text("import nowhere\n")
    (tmp_path / "stop.py").write_text("import sys\nsys.exit(3)\n")
    code, out, err = cli(verb, "--controller", named)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert all(word in err for word in words), err
    assert not (tmp_path / "runs").exists()


def test_an_own_file_is_run_again_only_when_it_changes(cli, tmp_path):
    from ship_gym_agents.plugins import load_object

    (tmp_path / "beside.py").write_text("gain = 2.0\n")
    file = tmp_path / "gains.py"
    file.write_text("import beside\nfound = [beside.gain]\n")
    first = load_object(f"{file}:found")
    assert first == [2.0] and load_object(f"{file}:found") is first
    file.write_text("import beside\nfound = [beside.gain + 1.0]\n")
    assert load_object(f"{file}:found") == [3.0]


OWN_TASK = ROOT / "tests" / "recipes" / "hold_yaw_rate.py"


def test_a_task_brings_its_scenario(cli):
    arguments = ["--task", OWN_TASK, "--episodes", 1, "--set", "duration=20", "--json"]
    code, out, err = cli("evaluate", *arguments)
    assert code == 0, err
    found = json.loads(out)
    assert found["scenario"]["task"] == "hold_yaw_rate" and list(found["controllers"]) == [
        "constant"
    ]
    assert next(iter(found["metrics"])) == "rms_rate_error" and "J_0.1" not in found["metrics"]
    assert f"--task {OWN_TASK}" in found["next"]


def test_an_episode_of_an_own_task_is_recorded_and_reviewed(cli):
    pytest.importorskip("rerun")
    own = ["--task", OWN_TASK]
    arguments = [*own, "--controller", "constant", "--set", "duration=20", "--out", "own.rrd"]
    code, out, err = cli("record", *arguments)
    assert code == 0 and "rms_rate_error" in out, err
    code, out, err = cli("review", *own, "own.rrd")
    assert code == 0 and "rms_rate_error" in out and "hold_yaw_rate" in out, err


@pytest.mark.parametrize("verb", ["evaluate", "record", "train", "tune"])
def test_a_scenario_of_another_task_is_refused(cli, tmp_path, verb):
    code, out, err = cli(verb, "--task", "course_changing", "--scenario", "track_zigzag")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert "--task course_changing: scenario track_zigzag is of task 'track_following'" in err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("verb", ["evaluate", "record", "train", "tune"])
def test_unknown_tasks_are_refused(cli, tmp_path, verb):
    code, out, err = cli(verb, "--task", "course_changin")
    assert (code, out, err.count("\n")) == (2, "", 1) and "did you mean 'course_changing'" in err
    code, out, err = cli(verb, "--task", "nothing.py")
    assert (code, out) == (2, "") and "nothing.py: no such file" in err
    assert not list(tmp_path.iterdir())


def test_list_tells_what_can_be_named(cli):
    code, out, _ = cli("list", "--json")
    found = json.loads(out)
    assert code == 0 and set(found) == {
        *("ships", "scenarios", "tasks", "controllers", "recipes", "surrogates", "seas")
    }
    assert found["scenarios"]["track_zigzag"] == "track_following"
    assert (
        "ppo for kcs in heading_keeping" in found["controllers"]["ppo_kcs"]
        and found["controllers"]["pid"]
    )
    assert found["recipes"]["heading_gauss_newton"].startswith("Heading: ")
    assert found["surrogates"]["G2_SA"] == "default"
    assert all(found["ships"].values()) and "heading_keeping" in found["tasks"]
    code, out, _ = cli("list", "surrogates", "--ship", "onrt", "seas")
    assert code == 0 and out.startswith("surrogates:\n  none\n") and "ss5" in out


@pytest.fixture
def ship_file(tmp_path):
    """A ship file of one's own, away from the package."""
    text = (DATA / "kvlcc2_model" / "ship.toml").read_text()
    (tmp_path / "my ship.toml").write_text(text)
    return "my ship.toml"


def test_a_ship_file_stays_a_file_in_what_comes_next(cli, ship_file):
    code, out, err = cli("simulate", "--ship", ship_file)
    assert code == 0, err
    following = [line for line in out.splitlines() if "ship-gym simulate" in line]
    assert len(following) == 2 and all("--ship 'my ship.toml'" in line for line in following)


def test_gains_of_an_own_ship_are_found_by_its_name(cli, ship_file, monkeypatch, tmp_path):
    """As in an installed package, which tune does not write into."""
    from ship_gym_agents import gains_files

    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.setattr(gains_files, "GAINS", tmp_path / "a" / "b" / "c" / "gains")
    small = ["--scenario", "heading_calm", "--episodes", 2, "--generations", 1]
    small += ["--set", "duration=20", "sensors.noise=false"]
    code, out, err = cli("tune", "--ship", ship_file, *small)
    assert code == 0, err
    file = tmp_path / "data" / "ship_gym" / "gains" / "pid_my ship.toml"
    assert f"wrote {file}" in out and f"--controller '{file}' --controller pid" in out
    kept = tomllib.loads(file.read_text())["tuning"]["overrides"]
    assert kept == {"duration": 20, "sensors.noise": False}
    assert "tuned already" in cli("tune", "--ship", ship_file, *small, "--resume")[1]
    short = ["--scenario", "heading_calm", "--episodes", 1, "--set", "duration=20"]
    code, _, err = cli("evaluate", "--ship", ship_file, "--controller", "pid", *short)
    assert code == 0, err


def test_an_installed_package_keeps_its_gains(cli, monkeypatch, tmp_path):
    from ship_gym_agents import gains_files

    gains = tmp_path / "a" / "b" / "gains"
    gains.mkdir(parents=True)
    (gains / "pid_kcs.toml").write_text("")
    monkeypatch.setattr(gains_files, "GAINS", gains)
    code, _, err = cli("tune", "--ship", "kcs")
    assert code == 2 and "--out runs/pid_kcs.toml" in err and err.count("\n") == 1


def test_train_then_what_it_says_comes_next(cli):
    pytest.importorskip("stable_baselines3")
    small = ["--steps", 64, "--envs", 2, "--set", "duration=20"]
    Path("h.toml").write_text(
        (ROOT / "agents/ship_gym_agents/sb3/hyperparameters/ppo.toml")
        .read_text()
        .replace("validations = 12", "validations = 1")
    )
    code, out, err = cli("train", *small, "--hyperparameters", "h.toml", "--out", "run")
    assert code == 0, err
    following = re.search(r"next: ship-gym (.*)", out)[1].split()
    assert following == ["evaluate", "--policy", "run"]
    code, out, err = cli(*following, "--episodes", 1, "--json")
    assert code == 0, err
    assert json.loads(out)["file"] == "run/evaluation.json"
    code, _, err = cli("train", *small, "--out", "run")
    assert code == 2 and "run holds a run; resume it" in err
    code, _, err = cli("train", "--resume", "--out", "run", "--ship", "kcs")
    assert code == 2 and "leave out: --ship" in err


def test_speed_of_an_own_ship_in_an_own_task(cli, ship_file):
    own = ["--ship", ship_file, "--task", OWN_TASK, "--set", "sea.states=[]", "sea.gusts=false"]
    code, out, err = cli("speed", "--quick", "--json", *own)
    assert code == 0, err
    found = json.loads(out)
    names = {row["name"] for row in found["steps"]}
    assert {"environment step", "environment, one core"} <= names
    assert [row["scenario"] for row in found["overhead"]] == ["hold_yaw_rate"]
    assert cli("speed", "--quick", "--ship", "nothing.toml")[0] == 2


def test_every_kind_of_name_has_some():
    assert all(names() for names in NAMES.values())


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_prints_a_script(cli, shell):
    code, out, _ = cli("completion", shell)
    assert code == 0 and "_SHIP_GYM_COMPLETE" in out and "ship-gym" in out
    assert json.loads(cli("completion", shell, "--json")[1])["script"].strip() == out.strip()


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("ship-gym tra", ["plain,train"]),
        ("ship-gym train --scen", ["plain,--scenario"]),
        ("ship-gym simulate --ship kvl", ["plain,kvlcc2", "plain,kvlcc2_model"]),
        ("ship-gym evaluate --controllers il", ["plain,ilos"]),
        ("ship-gym record --controller my", ["file,my"]),
        ("ship-gym simulate --csv r", ["file,r"]),
        ("ship-gym train --control rudder+", ["plain,rudder+rpm"]),
        ("ship-gym train --task cou", ["plain,course_changing"]),
        ("ship-gym train --algorithm sa", ["plain,sac"]),
    ],
)
def test_completion_completes(monkeypatch, capsys, words, expected):
    monkeypatch.setenv("_SHIP_GYM_COMPLETE", "bash_complete")
    monkeypatch.setenv("COMP_WORDS", words)
    monkeypatch.setenv("COMP_CWORD", str(len(words.split()) - 1))
    with pytest.raises(SystemExit) as stop:
        main([])
    assert stop.value.code == 0 and capsys.readouterr().out.split() == expected
