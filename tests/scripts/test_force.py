"""Results of other runs are kept unless --force is given; two at once are not let in."""

import json
import os
import shutil
from pathlib import Path

import numpy as np
import pytest
from ship_gym_agents.cli import replace
from ship_gym_agents.cli.replace import check_replaced
from ship_gym_agents.cli.replace_read import result_in
from ship_gym_agents.controllers import shipped_file
from ship_gym_agents.gains_files import gains_path

from ship_gym.config import ConfigError
from ship_gym.evaluation.run_folder import RunFolder
from ship_gym.locks import held, locked
from ship_gym.recording import Trajectory
from ship_gym.ships.files import DATA

EPISODE = {"controller": "pid", "seed": 3, "config": {"ship": "kcs", "duration": 60.0}}

EVALUATED = {"scenario": {"duration": 60.0}, "ship": "kcs", "seeds": [1, 2], "controllers": ["pid"]}


def history(path):
    run = Trajectory({"t": np.arange(3.0), "x": np.zeros(3)}, EPISODE)
    run.to_csv(path) if path.suffix == ".csv" else run.to_rrd(path, picture=False)


def made(name, tmp_path):
    """A result of Ship Gym in a file of this name, and what it is."""
    path = tmp_path / name
    if path.suffix == ".toml":
        shutil.copyfile(gains_path("kcs"), path)
        return path, replace.gains("pid", "kcs", None)
    if path.suffix == ".safetensors":
        shutil.copyfile(shipped_file("ppo_kcs"), path)
        return path, result_in(Path(shipped_file("ppo_kcs")))
    if path.suffix == ".npz":
        shutil.copyfile(next((DATA / "kcs_model").glob("surrogate_*.npz")), path)
        return path, replace.surrogate("kcs", "kcs_model")
    if path.suffix == ".json":
        path.write_text(json.dumps({**EVALUATED, "differences": {}, "episodes": {}}))
        return path, replace.evaluation(**EVALUATED)
    if path.suffix == ".rrd":
        pytest.importorskip("rerun")
    history(path)
    return path, replace.recording("pid", 3, EPISODE["config"])


OTHERS = {
    ".toml": replace.gains("pid", "kvlcc2", None),
    ".safetensors": replace.policy({"name": "another"}),
    ".npz": replace.wave_table("kcs_model", {}),
    ".json": replace.bound(EVALUATED),
    ".rrd": replace.recording("pid", 4, EPISODE["config"]),
    ".csv": replace.recording("pid", 3, EPISODE["config"] | {"duration": 90.0}),
}


GAUSS_NEWTON = "--algo gauss_newton --set form.base=pid"


def slowly(*values):
    """Parameters of a test that loads much."""
    return pytest.param(*values, marks=pytest.mark.slow)


@pytest.mark.parametrize("suffix", OTHERS)
def test_the_same_is_replaced_and_anything_else_is_kept(tmp_path, suffix):
    path, same = made(f"x{suffix}", tmp_path)
    check_replaced(path, same, force=False)
    with pytest.raises(ConfigError, match=rf"^--to {path}: holds {same.words}.*, not .*--force$"):
        check_replaced(path, OTHERS[suffix], False, "--to")
    check_replaced(path, OTHERS[suffix], force=True)
    for mine in (b"a user's own", b"\x00\x01", b"t,x\n0,1\n", b"[1]", b'name = "ship"\n'):
        path.write_bytes(mine)
        with pytest.raises(ConfigError, match=r"holds no such result"):
            check_replaced(path, same, force=False)
    path.write_bytes(b"")
    check_replaced(path, same, force=False)
    check_replaced(tmp_path / f"new{suffix}", same, force=False)
    check_replaced(None, same, force=False)


def test_a_coarse_table_does_not_replace_a_fine_one(tmp_path):
    path = tmp_path / "waves.npz"
    shutil.copyfile(DATA / "kcs_model" / "waves.npz", path)
    there = result_in(path)
    check_replaced(path, there, force=False)
    coarse = replace.wave_table("kcs_model", there.facts[2] | {"headings": 7})
    with pytest.raises(ConfigError, match=r"holds a wave table of kcs_model with other settings"):
        check_replaced(path, coarse, force=False)


def test_a_policy_of_another_run_is_kept(cli, tmp_path):
    export = ("--to", "safetensors", "--out", "mine.safetensors")
    for again in range(2):
        assert cli("export", "ppo_kcs", *export)[0] == 0, f"time {again}"
    before = (tmp_path / "mine.safetensors").read_bytes()
    code, out, err = cli("export", "heading_kcs", *export)
    assert (code, out, err.count("\n")) == (2, "", 1) and "--force" in err
    assert (tmp_path / "mine.safetensors").read_bytes() == before
    assert cli("export", "heading_kcs", *export, "--force")[0] == 0
    assert (tmp_path / "mine.safetensors").read_bytes() != before


def test_an_exported_model_is_known_by_its_policy(cli, tmp_path):
    pytest.importorskip("onnx")
    assert cli("export", "ppo_kcs", "--out", "x.onnx")[0] == 0
    assert cli("export", "ppo_kcs", "--out", "x.onnx")[0] == 0, "the same again"
    assert "--force" in cli("export", "heading_kcs", "--out", "x.onnx")[2]
    (tmp_path / "x.onnx").write_bytes(b"\xff\x01")
    assert "holds no such result" in cli("export", "ppo_kcs", "--out", "x.onnx")[2]


@pytest.mark.parametrize(
    ("words", "file", "of_another"),
    [
        ("tune --ship kcs --out mine.toml", "mine.toml", b'title = "my ship"\n'),
        ("bound --out mine.json", "mine.json", b'{"front": 1, "bound": 2}'),
        ("evaluate --out mine.json", "mine.json", b'{"controllers": {}, "differences": {}}'),
        ("evaluate --controller pid --record .", "pid-2000031.rrd", b"mine"),
        ("record --out mine.csv", "mine.csv", b"t,heading\n"),
        ("record --worst 1 --of 2 --out mine.csv", "mine.csv", b"t,heading\n"),
        ("record --seeds 7 --out .", "pid-2000006.rrd", b"mine"),
        ("simulate turning --csv mine.csv", "mine.csv", b"t,heading\n"),
        ("simulate trials --csv mine.csv", "mine_2.csv", b"t,heading\n"),
        ("trials --csv mine.csv", "mine.csv", b"ship;trial\n"),
        ("trials --out mine.md", "mine.md", b"# My notes\n"),
        ("fit-surrogate --out mine.npz", "mine.npz", b"PK"),
        ("build-wave-table --out mine.npz", "mine.npz", b"PK"),
    ],
)
def test_a_file_of_the_user_is_kept_before_any_work(cli, tmp_path, words, file, of_another):
    needed = {"tune": "optuna", "build-wave-table": "capytaine"}
    pytest.importorskip(needed.get(words.split()[0], "numpy"))
    (tmp_path / file).write_bytes(of_another)
    code, out, err = cli(*words.split())
    assert (code, out, err.count("\n")) == (2, "", 1) and "--force" in err, err
    assert (tmp_path / file).read_bytes() == of_another and os.listdir(tmp_path) == [file]


@pytest.mark.parametrize(
    ("words", "library", "lock"),
    [
        ("tune --ship kcs --out x.toml", "optuna", lambda: held("x.toml", "works")),
        ("bound --out x.json", "numpy", lambda: held("x.json", "works")),
        ("fit-surrogate --out x.npz", "numpy", lambda: held("x.npz", "works")),
        ("build-wave-table --quick --out x.npz", "capytaine", lambda: held("x.npz", "works")),
        ("benchmark --suite manoeuvres --out x", "pyarrow", lambda: RunFolder("x").locked()),
        slowly("benchmark --suite heading --out x", "pyarrow", lambda: RunFolder("x").locked()),
        (f"train {GAUSS_NEWTON} --out x", "numpy", lambda: locked("x/lock", "trains")),
        slowly("tune-agent --out x", "optuna", lambda: locked("x/lock", "searches")),
    ],
)
def test_a_second_process_is_refused_at_once(cli, words, library, lock):
    pytest.importorskip(library)
    if "tune-agent" in words:
        pytest.importorskip("stable_baselines3")
    with lock():
        code, out, err = cli(*words.split())
    last = err.strip().splitlines()[-1]
    assert (code, out) == (2, "") and f"another process (pid {os.getpid()})" in last, err


SHORT = "--set duration=60 sensors.noise=false"
LONGER = SHORT.replace("60", "400")
_LONG = ("bound", "simul", "trial")  # two seconds and more
AGAIN = {  # a command, and others that would write another result to the same place
    f"evaluate --controller pid --episodes 2 {SHORT} --record x --out x.json": (
        "--ship kvlcc2",
        "--episodes 3",
        "--controller constant",
        "--set privileged=true",
    ),
    f"bound --controller pid --seeds 1 --iterations 1 {LONGER} --out x.json": (
        "--iterations 2",
        "--ship kvlcc2",
        "--lambdas 1",
    ),
    f"record --seeds 2 {SHORT} --out x": ("--ship kvlcc2", "--set privileged=true"),
    f"record --worst 1 --of 2 {SHORT} --out x.csv": ("--ship kvlcc2", "--controller constant"),
    "simulate coasting --ship kcs_model --csv x.csv --rrd x.rrd": ("--speed 0.7", "--ship kcs"),
    "trials --ship onrt_model --csv x.csv --out x.md": ("--ship kcs_model --out y.md",),
}


@pytest.mark.parametrize(
    "words", [slowly(words) if words[:5] in _LONG else words for words in AGAIN]
)
def test_the_same_command_needs_no_force_and_another_one_does(cli, tmp_path, words):
    if "rrd" in words or "--out x" in words:
        pytest.importorskip("rerun")
    for again in range(2):
        code, _, err = cli(*words.split())
        assert code == 0, (again, err)
    before = {path: path.read_bytes() for path in tmp_path.rglob("*.*")}
    for other in AGAIN[words]:
        code, out, err = cli(*words.split(), *other.split())
        assert (code, out, err.count("\n")) == (2, "", 1) and "--force" in err, (other, err)
    assert {path: path.read_bytes() for path in tmp_path.rglob("*.*")} == before
    assert cli(*words.split(), *AGAIN[words][0].split(), "--force")[0] == 0
