"""A place that cannot be written is refused before any work; a full disk is one line."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
from pathlib import Path

import click
import pytest
from ship_gym_agents.cli import VERBS, load_verb
from ship_gym_agents.cli.record_out import OutRecordings
from ship_gym_agents.cli.values import OutFile, OutFolder

pytestmark = pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="needs /proc of Linux")

DOCS = Path(__file__).parents[2] / "docs"
LONG = 1_000_000
# verbs that write something where no option says so, each with arguments that would take long
USUAL = {
    "evaluate": ["--episodes", LONG],
    "bound": ["--seeds", 10_000],
    "record": ["--set", "duration=1e6"],
    "dataset": ["--episodes", 100_000],
    "train": ["--minutes", LONG],
    "tune-agent": ["--minutes", LONG],
    "benchmark": ["--seeds", LONG],
    "simulate": ["trials", "--ship", "kvlcc2_model"],
    "draw": ["errors"],
    "fit-surrogate": ["--family", "gp"],
    "fit-hull": ["--captive", "none.csv"],
    "build-wave-table": ["--ship", "kcs_model"],
    "fmu": [],
}
# verbs that print only, or write only where they are told to, or beside what they read
OTHERS = {
    *("report", "review", "export", "trials", "linearise", "tune", "speed", "warm-up", "list"),
    *("serve", "completion", "route"),
}
# what must stand before --out for it to be looked at, and extensions that depend on it
BEFORE = {"export": ["ppo_kcs"], "review export": ["none.rrd"], "route": ["none.rtz"]}
SUFFIX = {"export": ".onnx", "review export": ".csv", "record": ".rrd"}
OUT = OutFile | OutFolder | OutRecordings


def places():
    """Verb, option and extension of everything that a verb can be told to write."""
    commands = [(verb, load_verb(verb)) for verb in VERBS]
    for verb, command in commands:  # grows by the verbs of groups
        inner = command.list_commands(None) if isinstance(command, click.Group) else []
        commands += [(f"{verb} {name}", command.get_command(None, name)) for name in inner]
        for param in command.params:
            if param.name == "out" or isinstance(param.type, OUT):
                yield verb, param.opts[0], getattr(param.type, "suffix", SUFFIX.get(verb, ""))


@pytest.fixture
def at_once():
    """A test that begins to sail is broken off."""

    def late(number, frame):
        raise TimeoutError("the work began")

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(60)  # imports may take their time on a busy machine
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize(("verb", "option", "suffix"), [*places()])
def test_a_place_that_cannot_be_written_is_refused(cli, tmp_path, at_once, verb, option, suffix):
    (tmp_path / "file").write_text("kept")
    for place, reason in (
        (f"file/x{suffix}", "file is a file, not a folder"),
        (f"/proc/x{suffix}" if suffix else "/proc/x/y", "cannot write into /proc: "),
    ):
        code, out, err = cli(*verb.split(), *BEFORE.get(verb, []), option, place)
        assert (code, out, err.count("\n")) == (2, "", 1), err
        assert err.startswith(f"error: {option} {place}: ") and reason in err
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("file", "kept")]


def test_every_verb_is_known_here():
    assert {*USUAL, *OTHERS} == {*VERBS}


@pytest.mark.parametrize("verb", USUAL)
def test_a_usual_place_that_cannot_be_written_is_refused(cli, monkeypatch, at_once, verb):
    needs = {"build-wave-table": "capytaine", "dataset": "minari"}
    pytest.importorskip(needs.get(verb, "numpy"))
    monkeypatch.chdir("/proc")
    code, out, err = cli(verb, *USUAL[verb])
    assert (code, out, err.count("\n")) == (2, "", 1), err
    assert err.startswith("error: --out runs") and "cannot write into /proc: " in err


@pytest.mark.parametrize(
    ("kind", "out"), [("stopping", []), ("captive", []), ("turning", ["--csv", "/proc/x.csv"])]
)
def test_every_kind_of_manoeuvre_is_refused_before_it_is_sailed(
    cli, monkeypatch, at_once, kind, out
):
    monkeypatch.chdir("/proc")
    code, _, err = cli("simulate", kind, *out)
    assert (code, err.count("\n")) == (2, 1) and "cannot write into /proc: " in err


def test_gains_beside_the_package_are_refused_before_the_search(cli, monkeypatch, at_once):
    pytest.importorskip("optuna")
    from ship_gym_agents import gains_files

    monkeypatch.setattr(gains_files, "place_for_gains", lambda *_: Path("/proc/pid_kcs.toml"))
    code, out, err = cli("tune", "--ship", "kcs", "--episodes", 10_000)
    assert (code, out, err.count("\n")) == (2, "", 1) and "cannot write into /proc: " in err


@pytest.mark.parametrize(
    ("script", "arguments"),
    [
        ("build_docs.py", ["--out", "/proc/docs"]),
        ("build_results.py", ["--run", "/proc/run", "--out", "results.md"]),
        ("build_results.py", ["--run", "run", "--out", "/proc/results.md"]),
        ("judge_policies.py", ["--run", "/proc/run", "--seeds", str(LONG)]),
        ("reproduce.py", ["stern", "--plot", "/proc/stern.png"]),
        ("mutate.py", ["--out", "/proc/mutation.jsonl"]),
        ("mutate.py", ["--report", "/proc/mutation.md"]),
        ("check_speed.py", ["--write", "--baseline", "/proc/speed.json"]),
    ],
)
def test_scripts_refuse_before_any_work(call, tmp_path, monkeypatch, at_once, script, arguments):
    monkeypatch.syspath_prepend(str(DOCS))  # its package reproduce, before the script of that name
    code, out, err = call(script, *arguments)
    assert (code, out, err.count("\n")) == (2, "", 1), err
    assert "cannot write into /proc: " in err and not list(tmp_path.iterdir())


@pytest.fixture
def small_files():
    """No file of this process may grow beyond 500 bytes, as on a full disk."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    yield lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (500, before[1]))
    resource.setrlimit(resource.RLIMIT_FSIZE, before)
    signal.signal(signal.SIGXFSZ, ignored)


SHORT = ["--set", "duration=20"]
WRITING = {
    "record": ["--controller", "pid", *SHORT, "--out", "new/r.rrd"],
    "evaluate": ["--controller", "pid", "--episodes", 1, *SHORT, "--out", "new/e.json"],
    "simulate": ["--ship", "kcs_model", "--out", "new/s.png"],
    "draw": ["errors", "--out", "new/d.png"],
    "fit-surrogate": ["--out", "new/f.npz"],
    "export": ["ppo_kcs", "--to", "safetensors", "--out", "new/p.safetensors"],
}


@pytest.mark.filterwarnings("ignore:compiled code cannot be kept")
@pytest.mark.parametrize("verb", WRITING)
def test_a_full_disk_is_one_line_and_leaves_nothing(cli, tmp_path, monkeypatch, small_files, verb):
    from ship_gym import writing

    # the try before the work writes more than 500 bytes, and the disk is to fill after it
    monkeypatch.setattr(writing, "check_place", lambda path, *_, **__: Path(path))
    old = tmp_path / "new" / "old.txt"
    old.parent.mkdir()
    old.write_text("kept")
    cli(verb, "--help")
    small_files()
    code, out, err = cli(verb, *WRITING[verb])
    file = WRITING[verb][-1]
    assert (code, out) == (2, ""), err
    # before it may stand warnings of code that was compiled and could not be kept either
    said = f"{file}: file too large; nothing was written to it"
    if verb == "record":  # its rows go to disk on the way
        said = f"{file}.partial: file too large"
    assert err.splitlines()[-1] == f"error: {said}"
    assert "Traceback" not in err
    assert [p for p in tmp_path.rglob("*") if p.is_file()] == [old] and old.read_text() == "kept"


def test_a_disk_that_is_full_already_is_refused(cli, tmp_path, at_once, small_files):
    small_files()
    code, out, err = cli("evaluate", "--episodes", LONG, "--out", "e.json")
    assert (code, out, err.count("\n")) == (2, "", 1) and not list(tmp_path.iterdir())
    assert err == "error: --out e.json: cannot write into .: file too large\n"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_a_full_stdout_is_one_line():
    code = "from ship_gym_agents.cli import main; main(['list', 'seas', '--json'])"
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [sys.executable, "-c", code], stdout=full, stderr=subprocess.PIPE, text=True
        )
    assert done.returncode == 2 and done.stderr == "error: stdout: no space left on device\n"


@pytest.fixture
def small_disk(tmp_path):
    """A disk of 200 kB of which 100 are taken; only root may mount one."""
    place = tmp_path / "disk"
    place.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", "size=200k", "tmpfs", str(place)]
    try:
        subprocess.run(command, check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("no right to mount a small disk")
    (place / "taken").write_bytes(os.urandom(100_000))
    yield place
    subprocess.run(["umount", "--lazy", str(place)], check=True)


@pytest.mark.parametrize("option", ["--out", "--csv", "--rrd"])
def test_a_disk_that_fills_up_is_one_line(cli, small_disk, option):
    pytest.importorskip("rerun" if option == "--rrd" else "matplotlib")
    file = small_disk / {"--out": "s.png", "--csv": "s.csv", "--rrd": "s.rrd"}[option]
    (small_disk / "more").write_bytes(bytes(70_000))
    code, out, err = cli("simulate", "--ship", "kcs_model", option, file)
    assert (code, out) == (2, "")
    assert err == f"error: {file}: no space left on device; nothing was written to it\n"
    assert sorted(p.name for p in small_disk.iterdir()) == ["more", "taken"]


def test_a_disk_mounted_read_only_is_refused(cli, small_disk, at_once):
    subprocess.run(["mount", "-o", "remount,ro", str(small_disk)], check=True)
    code, out, err = cli("train", "--minutes", LONG, "--out", small_disk / "run")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert f"cannot write into {small_disk}: read-only file system" in err
