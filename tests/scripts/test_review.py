"""ship-gym review: from a folder of runs to the worst one, its picture, its numbers, its table."""

from __future__ import annotations

import csv
import json
import re
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from ship_gym_agents.cli.review import VERBS, load_verb
from ship_gym_agents.controllers import CONTROLLERS

from ship_gym.evaluation import metrics, rollout
from ship_gym.provenance import sha256
from ship_gym.recording import Trajectory
from ship_gym.recording.recorder import Recorder
from ship_gym.recording.sealed import verify

pytest.importorskip("rerun")

from ship_gym.recording.rerun_export import program, viewer


def with_meta(run, **more):
    return Trajectory(run.columns, run.meta | more)


@pytest.fixture(scope="module")
def sailed():
    """Three short episodes of heading keeping by two controllers, with what a writer adds."""
    found = []
    for name, seeds in (("pid", [1000001, 1000002]), ("constant", [1000001])):
        made = rollout(CONTROLLERS[name](), seeds=seeds, overrides={"duration": 200.0})
        for run in made.episodes:
            more = {"kind": "episode", "scenario": "heading_keeping", "metrics": metrics(run)}
            found.append(with_meta(run, **more))
    return found


@pytest.fixture
def folder(sailed, cli, tmp_path):
    """A folder with those episodes, a manoeuvre, a journal and a damaged file."""
    runs = tmp_path / "runs"
    for run in sailed:
        run.to_rrd(runs / f"{run.meta['controller']}_{run.meta['seed']}.rrd", picture=False)
    columns = {name: sailed[0][name] for name in ("t", "x", "y", "psi", "u", "v", "r")}
    turn = {"kind": "manoeuvre", "task": "turning_circle", "ship": sailed[0].meta["ship"]}
    turn |= {"metrics": {"advance": 3.125}}
    Trajectory(columns, turn).to_rrd(runs / "turn.rrd", picture=False)
    recorder = Recorder(runs / "killed.rrd", {"kind": "episode", "seed": 5}, ["t", "u"])
    recorder.add(np.column_stack([sailed[0]["t"], sailed[0]["u"]]))
    recorder.keep()
    whole = bytearray((runs / "turn.rrd").read_bytes())
    whole[1000] ^= 16
    (runs / "bad.rrd").write_bytes(whole)
    return runs


def worst(sailed):
    return max(sailed, key=lambda run: run.meta["metrics"]["J_steady"]).meta


@pytest.mark.parametrize("verb", VERBS)
def test_help_has_examples_and_imports_nothing_heavy(cli, verb):
    code, out, _ = cli("review", verb, "--help")
    examples = out.split("examples:")[1]
    assert code == 0 and examples.count(f"ship-gym review {verb}") >= 2 and "--json" in out
    assert load_verb(verb).help.partition("\n")[0] == VERBS[verb]
    code = f"""
import sys
from ship_gym_agents.cli import main
main(["review", {verb!r}, "--help"])
sys.exit(", ".join({{'numpy', 'gymnasium', 'ship_gym', 'rerun'}} & set(sys.modules)) or 0)"""
    subprocess.run([sys.executable, "-c", code], check=True, stdout=subprocess.DEVNULL)


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("ship-gym review pic", ["plain,picture"]),
        ("ship-gym review list --wor", ["plain,--worst"]),
        ("ship-gym review picture a.rrd --at s", ["plain,strip"]),
        ("ship-gym review show ru", ["file,ru"]),
    ],
)
def test_completion_knows_the_verbs(monkeypatch, capsys, words, expected):
    from ship_gym_agents.cli import main

    monkeypatch.setenv("_SHIP_GYM_COMPLETE", "bash_complete")
    monkeypatch.setenv("COMP_WORDS", words)
    monkeypatch.setenv("COMP_CWORD", str(len(words.split()) - 1))
    with pytest.raises(SystemExit):
        main([])
    assert capsys.readouterr().out.split() == expected


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["lst"], ["unknown verb 'lst'", "did you mean 'list'"]),
        ([], ["review what?", "review list FOLDER", "review metrics FILE"]),
        (["list"], ["FOLDER"]),
        (["list", "nowhere"], ["nowhere: no such file or folder"]),
        (["list", "runs", "--where", "J_1"], ["must be FIELD OPERATOR VALUE"]),
        (["list", "runs", "--by", "J_1"], ["--by J_1: belongs to --worst"]),
        (["list", "runs", "--worst", "1", "--sort", "J_1"], ["--sort: --worst sorts by itself"]),
        (["list", "runs", "--worst", "0"], ["--worst = 0: allowed is 1 to"]),
        (["show", "nowhere.rrd", "--web"], ["nowhere.rrd"]),
        (["show", "a.rrd", "b.rrd", "--at", "5"], ["--at 5: is of one FILE; there are 2"]),
        (["picture", "a.rrd", "--at", "best"], ["--at best: allowed are worst, strip, or a time"]),
        (["picture", "a.rrd", "--size", "big"], ["--size big: must be WIDTHxHEIGHT"]),
        (["picture", "a.rrd", "--size", "10x10"], ["each 320 to 7680"]),
        (["picture", "a.rrd", "--out", "a.jpg"], ["--out a.jpg: allowed is a .png file"]),
        (["picture", "a.rrd", "--light", "--painter"], ["--light: is of rerun's viewer"]),
        (["compare", "a.rrd"], ["needs two recordings or more"]),
        (["compare", "a.rrd", "b.rrd", "--out", "c.csv"], ["--out c.csv: allowed is a .rrd file"]),
        (
            ["export", "a.rrd"],
            ["--format: which? Allowed are csv, parquet, png, mp4, gpx, geojson, kml"],
        ),
        (["export", "a.rrd", "--format", "xls"], ["unknown format 'xls'"]),
        (["export", "a.rrd", "--out", "a.xls"], ["--out a.xls: allowed is a file .csv, .parquet"]),
        (["export", "a.rrd", "--format", "csv", "--out", "a.png"], ["--format says csv"]),
        (["export", "a/x.rrd", "b/x.rrd", "--format", "csv", "--out", "all"], ["two of the"]),
        (["metrics"], ["FILE"]),
    ],
)
def test_refusals_are_one_line_and_leave_nothing(cli, tmp_path, arguments, words):
    code, out, err = cli("review", *arguments)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert all(word in err for word in words), err
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="needs /proc of Linux")
@pytest.mark.parametrize(
    "arguments",
    [
        ["picture", "a.rrd", "--out", "/proc/a.png"],
        ["compare", "a.rrd", "b.rrd", "--out", "/proc/c.rrd"],
        ["compare", "a.rrd", "b.rrd", "--picture", "/proc/c.png"],
        ["export", "a.rrd", "--out", "/proc/a.csv"],
        ["export", "a.rrd", "b.rrd", "--format", "png", "--out", "/proc"],
        ["export", "/proc/a.rrd", "--format", "csv"],
        ["picture", "/proc/a.rrd"],
    ],
)
def test_places_that_cannot_be_written_are_refused_before_a_file_is_read(cli, arguments):
    code, out, err = cli("review", *arguments)
    assert (code, out, err.count("\n")) == (2, "", 1) and "cannot write into /proc: " in err


def test_list_has_a_row_for_every_file(cli, folder):
    code, out, err = cli("review", "list", "runs", "--json")
    assert code == 0, err
    rows = {row["file"]: row for row in json.loads(out)["runs"]}
    assert {name: row["state"] for name, row in rows.items()} == {
        "runs/bad.rrd": "unreadable",
        "runs/constant_1000001.rrd": "complete",
        "runs/killed.rrd.partial": "incomplete",
        "runs/pid_1000001.rrd": "complete",
        "runs/pid_1000002.rrd": "complete",
        "runs/turn.rrd": "complete",
    }
    assert rows["runs/bad.rrd"]["error"] and rows["runs/turn.rrd"]["metrics"] == {"advance": 3.125}
    assert rows["runs/pid_1000001.rrd"]["seed"] == 1000001
    text = cli("review", "list", "runs")[1]
    assert text.startswith("6 runs, 1 unreadable\n") and "J_steady [deg2]" in text
    assert rows["runs/bad.rrd"]["error"] in text


def test_list_and_show_are_enough_for_the_worst(cli, folder, sailed):
    code, out, err = cli("review", "list", "runs", "--worst", "1")
    meta = worst(sailed)
    name = f"runs/{meta['controller']}_{meta['seed']}.rrd"
    assert code == 0 and f"next: ship-gym review show {name}" in out, err
    assert out.startswith("1 of 6 runs, 1 unreadable; left out, for they have no J_steady: 3\n")


def test_failed_runs_are_worse_than_others(cli, sailed, tmp_path):
    """As for ship-gym record --worst, whatever their metric is."""
    meta = worst(sailed)
    good = next(run for run in sailed if run.meta["seed"] != meta["seed"])
    for name, run, failed in (("good", good, True), ("bad", sailed[2], False)):
        with_meta(run, failed=failed).to_rrd(tmp_path / f"{name}.rrd", picture=False)
    rows = json.loads(cli("review", "list", ".", "--worst", "2", "--json")[1])["runs"]
    assert [row["file"] for row in rows] == ["good.rrd", "bad.rrd"]


def test_list_filters_and_sorts(cli, folder):
    arguments = ["--where", "controller==pid", "seed>0", "--sort", "seed", "--reverse", "--json"]
    rows = json.loads(cli("review", "list", "runs", *arguments)[1])["runs"]
    assert [row["seed"] for row in rows] == [1000002, 1000001]
    out = cli("review", "list", "runs", "--where", "ship==kvlcc2")[1]
    assert out == "0 of 6 runs, 1 unreadable: none meets the conditions\n"
    code, _, err = cli("review", "list", "runs", "--where", "J1>3")
    assert code == 2 and "unknown field 'J1'; did you mean 'J_1'" in err
    code, _, err = cli("review", "list", "runs", "--worst", "1", "--by", "advance")
    assert code == 2 and "use --sort advance" in err
    code, _, err = cli("review", "list", "runs", "--metrics", "J1")
    assert code == 2 and "did you mean 'J_1'" in err


def test_list_prints_csv_with_all_digits(cli, folder, sailed):
    lines = cli("review", "list", "runs", "--csv")[1].splitlines()
    header, rows = lines[0].split(","), [line.split(",") for line in lines[1:]]
    found = next(row for row in rows if row[0] == "runs/pid_1000001.rrd")
    assert float(found[header.index("J_1")]) == sailed[0].meta["metrics"]["J_1"]


def test_an_empty_folder_says_what_makes_recordings(cli, tmp_path):
    (tmp_path / "empty").mkdir()
    code, _, err = cli("review", "list", "empty")
    assert code == 2 and "no recordings (.rrd, .rrd.partial); made by: ship-gym record" in err


def test_metrics_are_computed_from_the_columns(cli, folder, sailed):
    for old in ([], ["metrics"]):  # without the verb as in older versions
        code, out, err = cli("review", *old, "runs/pid_1000001.rrd", "runs/turn.rrd", "--json")
        assert code == 0, err
        found = json.loads(out)
        assert found["runs/pid_1000001.rrd"]["metrics"] == sailed[0].meta["metrics"]
        assert found["runs/pid_1000001.rrd"]["source"] == "computed"
        assert found["runs/turn.rrd"]["metrics"] == {"advance": 3.125}
        assert found["runs/turn.rrd"]["source"] == "stored"
    assert "incomplete: none" in cli("review", "metrics", "runs/killed.rrd.partial")[1]


def test_a_stored_metric_that_the_columns_do_not_give_is_an_error(cli, sailed, tmp_path):
    stored = sailed[0].meta["metrics"]
    changed = stored | {"J_1": float(np.nextafter(stored["J_1"], 0.0))}
    with_meta(sailed[0], metrics=changed).to_rrd(tmp_path / "a.rrd", picture=False)
    code, out, err = cli("review", "metrics", "a.rrd")
    assert code == 2 and "J_1" in out and err.count("\n") == 1
    assert f"such as J_1: stored {changed['J_1']!r}, computed {stored['J_1']!r}" in err


@pytest.mark.parametrize("arguments", [["metrics"], ["show", "--web"], ["picture"], ["export"]])
def test_damaged_files_are_refused(cli, folder, arguments, monkeypatch):
    monkeypatch.setattr(viewer, "Program", None)  # no viewer sees it
    more = ["--format", "csv"] if arguments == ["export"] else []
    before = sorted(path.name for path in folder.iterdir())
    code, out, err = cli("review", *arguments, "runs/bad.rrd", *more)
    assert (code, out, err.count("\n")) == (2, "", 1) and "bad.rrd" in err
    assert sorted(path.name for path in folder.iterdir()) == before


def test_without_a_screen_show_says_what_else_there_is(cli, folder, monkeypatch):
    monkeypatch.setattr(viewer, "has_screen", lambda: False)
    code, out, err = cli("review", "show", "runs/pid_1000001.rrd")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert "ship-gym review show --web runs/pid_1000001.rrd" in err
    assert "ship-gym review picture runs/pid_1000001.rrd" in err


def test_show_opens_at_the_worst_moment_and_draws_what_has_no_picture(
    cli, folder, sailed, monkeypatch
):
    from ship_gym.recording.marks import worst_moment

    seen = []

    def opened(*paths, moment=None):
        assert all(verify(path).has_picture for path in paths)
        seen.append((moment, [Trajectory.from_rrd(path).meta["seed"] for path in paths]))

    monkeypatch.setattr(viewer, "has_screen", lambda: True)
    monkeypatch.setattr(viewer, "show", opened)
    code, out, err = cli("review", "show", "runs/pid_1000001.rrd")
    assert code == 0 and "next: close its window" in out, err
    assert cli("review", "show", "runs/pid_1000001.rrd", "--at", "7.5")[0] == 0
    assert cli("review", "show", "runs/killed.rrd.partial", "runs/pid_1000002.rrd")[0] == 0
    moment = worst_moment(sailed[0])
    assert seen == [(moment, [1000001]), (7.5, [1000001]), (None, [5, 1000002])]
    code, _, err = cli("review", "show", "runs/pid_1000001.rrd", "--at", "700")
    assert code == 2 and "--at = 700.0: allowed is 0 to 200 [s]" in err


def test_show_web_prints_an_address_of_this_machine(cli, folder, monkeypatch):
    class Served:
        address = "http://127.0.0.1:1/?url=x"
        ended = False

        def wait(self):
            raise KeyboardInterrupt

        def stop(self):
            Served.ended = True

    monkeypatch.setattr(viewer, "has_screen", lambda: False)
    monkeypatch.setattr(viewer, "serve_web", lambda *paths: Served())
    code, out, err = cli("review", "show", "--web", "runs/pid_1000001.rrd", "--json")
    assert (code, err) == (0, "") and Served.ended
    assert json.loads(out)["address"] == Served.address
    code, out, err = cli("review", "show", "--web", "runs/pid_1000001.rrd", "--at", "7.5")
    assert "next: open the address in a browser; move its time to 7.5 s\n" in out


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_server_ends_with_the_verb(folder, number):
    words = ["review", "show", "--web", "runs/pid_1000001.rrd", "--json"]
    code = f"from ship_gym_agents.cli import main; main({words})"
    verb = subprocess.Popen(
        [sys.executable, "-c", code], cwd=folder.parent, stdout=subprocess.PIPE, text=True
    )
    text = "".join(iter(verb.stdout.readline, "}\n")) + "}"
    port = int(re.search(r":(\d+)/", json.loads(text)["address"])[1])
    assert program.listens(port)
    verb.send_signal(number)
    assert verb.wait(30) == 0 and not program.listens(port)
    verb.stdout.close()


def test_export_writes_tables_and_plots(cli, folder, sailed, tmp_path):
    code, out, err = cli("review", "export", "runs/pid_1000001.rrd", "--out", "a.csv")
    assert code == 0 and out == "wrote a.csv\n", err
    sailed[0].to_csv("b.csv")
    assert sha256("a.csv") == sha256("b.csv")
    parquet = pytest.importorskip("pyarrow.parquet")
    files = ["runs/pid_1000001.rrd", "runs/killed.rrd.partial"]
    code, out, err = cli("review", "export", *files, "--format", "parquet", "--out", "t", "--json")
    assert code == 0, err
    assert json.loads(out)["files"] == ["t/pid_1000001.parquet", "t/killed.parquet"]
    table = parquet.read_table("t/pid_1000001.parquet")
    assert table.column_names == sailed[0].names
    for name in sailed[0].names:
        assert table[name].to_numpy().tobytes() == sailed[0][name].tobytes()
    assert json.loads(table.schema.metadata[b"ship_gym"]) == sailed[0].meta
    for suffix in ("csv", "parquet"):  # again, then of another run, then over a user's own file
        beside = folder / f"pid_1000001.{suffix}"
        export = ("review", "export", "runs/pid_1000001.rrd", "--format", suffix)
        assert [cli(*export)[0] for _ in range(2)] == [0, 0]
        code, _, err = cli("review", "export", "runs/pid_1000002.rrd", "--out", beside)
        assert code == 2 and "holds a recording of pid, kcs, seed 1000001" in err, err
        beside.write_text("my,notes\n")
        assert cli(*export)[0] == 2 and beside.read_text() == "my,notes\n"
        assert cli(*export, "--force")[0] == 0 and beside.read_bytes()[:2] in (b"# ", b"PA")
    pytest.importorskip("matplotlib")
    code, _, err = cli("review", "export", "runs/pid_1000001.rrd", "--format", "png")
    assert code == 0 and (folder / "pid_1000001.png").stat().st_size > 20_000, err


def test_pictures_are_painted_where_the_viewer_cannot_run(cli, folder, sailed, monkeypatch):
    Image = pytest.importorskip("PIL.Image")

    def refused(*_):
        raise viewer.NoViewer("no graphics driver")

    monkeypatch.setattr(viewer, "screenshot", refused)
    file = "runs/pid_1000001.rrd"
    code, out, err = cli("review", "picture", file, "--at", "12.5")
    assert code == 0 and f"{file} at 12.5 s\n" in out, err
    assert "wrote runs/pid_1000001.png, drawn by the painter of env.render: no graphics" in out
    at_a_time = Image.open(folder / "pid_1000001.png").convert("RGB").tobytes()
    found = json.loads(cli("review", "picture", file, "--json", "--painter")[1])
    assert (found["by"], found["reason"], found["file"]) == (
        "painter",
        "",
        f"{folder.name}/pid_1000001.png",
    )
    assert Image.open(folder / "pid_1000001.png").convert("RGB").tobytes() != at_a_time
    code, out, err = cli("review", "picture", file, "--at", "strip", "--out", "strip.png")
    assert code == 0 and "moments\nwrote strip.png, drawn by the painter" in out, err
    code, out, err = cli("review", "picture", file, "--light", "--out", "light.png")
    assert (code, out, err) == (2, "", "error: no graphics driver\n")
    code, out, err = cli("review", "picture", file, "--at", "700")
    assert code == 2 and "--at = 700.0: allowed is 0 to 200 [s]" in err


def test_pictures_are_of_the_viewer_where_it_can_run(cli, folder, sailed, monkeypatch):
    seen = []
    monkeypatch.setattr(viewer, "screenshot", lambda *given: seen.append(given))
    arguments = ["--out", "a.png", "--size", "800x600", "--light"]
    code, out, err = cli("review", "picture", "runs/killed.rrd.partial", *arguments)
    assert code == 0 and "wrote a.png, drawn by rerun's viewer\n" in out, err
    path, out, time, size, light = seen[0]
    assert path.name == "0-killed.rrd" and (str(out), size, light) == ("a.png", (800, 600), True)
    assert time == sailed[0]["t"][-1]  # its two columns tell of no worse moment


def test_videos_are_of_the_painter(cli, folder, monkeypatch):
    pytest.importorskip("av")
    from ship_gym.rendering import replay

    seen = []
    monkeypatch.setattr(replay, "write_video", lambda run, path, progress: seen.append(str(path)))
    code, out, err = cli("review", "export", "runs/pid_1000001.rrd", "--format", "mp4")
    assert code == 0 and seen == ["runs/pid_1000001.mp4"] and seen[0] in out, err


def test_compare_puts_runs_side_by_side(cli, folder, sailed, monkeypatch):
    names = ["runs/pid_1000001.rrd", "runs/constant_1000001.rrd"]
    shots = []
    monkeypatch.setattr(viewer, "screenshot", lambda *given: shots.append(given))
    arguments = ["--out", "runs/both.rrd", "--picture", "both.png"]
    code, out, err = cli("review", "compare", *names, *arguments, "--json")
    assert code == 0, err
    found = json.loads(out)
    assert found["files"] == ["runs/both.rrd", "both.png"] and len(shots) == 1
    pid, constant = (one.meta["metrics"] for one in (sailed[0], sailed[2]))
    first, second = found["recordings"]
    assert (first["name"], second["name"]) == ("pid", "constant")
    assert second["metrics"] == constant
    assert second["differences"]["J_1"] == constant["J_1"] - pid["J_1"]
    assert first["content"] != second["content"]
    assert "less pid" in cli("review", "compare", *names, "--out", "runs/both.rrd")[1]
    others = ("review", "compare", names[0], names[0], "--out", "runs/both.rrd")
    code, out, err = cli(*others)
    assert (code, out) == (2, "") and "holds a comparison of pid, constant, not" in err, err
    same = cli(*others, "--force")[1]
    assert same.startswith("the content of all is the same, bit for bit\n")
    assert cli("review", "compare", *names, "--out", "runs/both.rrd", "--force")[0] == 0
    code, out, err = cli("review", "compare", *names, "--out", "runs/turn.rrd")
    assert (code, out) == (2, "") and "--force" in err, err
    rows = json.loads(cli("review", "list", "runs", "--where", "kind==comparison", "--json")[1])
    assert [row["file"] for row in rows["runs"]] == ["runs/both.rrd"]
    seen = []
    monkeypatch.setattr(viewer, "has_screen", lambda: True)
    monkeypatch.setattr(viewer, "show", lambda *paths, moment=None: seen.append((paths, moment)))
    assert cli("review", "show", "runs/both.rrd")[0] == 0
    assert [(str(path), moment) for (path,), moment in seen] == [("runs/both.rrd", None)]
    assert cli("review", "show", "runs/both.rrd", "--at", "30")[0] == 0 and seen.pop()[1] == 30.0
    assert cli("review", "picture", "runs/both.rrd", "--at", "30")[0] == 0
    assert (shots[-1][1].name, shots[-1][2]) == ("both.png", 30.0)
    assert "is a comparison" in cli("review", "picture", "runs/both.rrd", "--painter")[2]
    whole = bytearray((folder / "both.rrd").read_bytes())
    whole[5000] ^= 1
    (folder / "both.rrd").write_bytes(whole)
    code, out, err = cli("review", "show", "runs/both.rrd")
    assert (code, out, len(seen)) == (2, "", 1) and "runs/both.rrd" in err


def test_runs_of_different_tasks_are_not_compared(cli, folder):
    code, out, err = cli("review", "compare", "runs/pid_1000001.rrd", "runs/turn.rrd")
    assert (code, out, err.count("\n")) == (2, "", 1) and "different task" in err
    assert not (folder / "compare.rrd").exists()


def test_compare_never_writes_over_one_of_its_recordings(cli, folder):
    names = ["runs/pid_1000001.rrd", "runs/constant_1000001.rrd"]
    before = (folder / "constant_1000001.rrd").read_bytes()
    code, out, err = cli(
        "review", "compare", *names, "--out", f"../{folder.parent.name}/{names[1]}"
    )
    assert (code, out) == (2, "") and "is one of the recordings to compare" in err
    assert (folder / "constant_1000001.rrd").read_bytes() == before


def test_compare_says_how_runs_differ(cli, folder):
    names = ["runs/pid_1000001.rrd", "runs/pid_1000002.rrd"]
    code, out, err = cli("review", "compare", *names, "--out", "both.rrd")
    assert code == 0 and out.startswith("The seeds differ, and with them sea"), err
    found = json.loads(cli("review", "compare", *names, "--out", "both.rrd", "--json")[1])
    assert found["notes"][0].startswith("The seeds differ")


@pytest.mark.parametrize("arguments", [["--painter"], ["--at", "strip"]])
def test_the_painter_needs_pillow(cli, folder, monkeypatch, arguments):
    monkeypatch.setitem(sys.modules, "PIL", None)
    code, out, err = cli("review", "picture", "runs/pid_1000001.rrd", *arguments)
    assert (code, out) == (2, "") and 'need PIL: pip install "ship-gym[render]"' in err


def test_what_all_have_in_common_is_rounded(cli, sailed, tmp_path):
    for name in ("a", "b"):
        t = sailed[0]["t"] / 3.0
        Trajectory({"t": t, "u": t}, {"kind": "episode"}).to_rrd(f"runs/{name}.rrd", picture=False)
    assert "\nall: kind episode, duration 66.667 s\n" in cli("review", "list", "runs")[1]


def test_metrics_as_csv_are_quoted_and_have_the_units_of_the_file(cli, sailed, tmp_path):
    turn = Trajectory({"t": sailed[0]["t"]}, {
        "kind": "manoeuvre", "config": {"manoeuvre": "turn"}, "task": "turn",
        "metrics": {"steady_drift": 0.25}, "units": {"steady_drift": "rad"},
    })  # fmt: skip
    turn.to_rrd("a, b.rrd", picture=False)
    code, out, err = cli("review", "metrics", "a, b.rrd", "--csv")
    assert code == 0, err
    rows = list(csv.reader(out.splitlines()))
    assert rows[0] == ["metric", "unit", "a, b.rrd"] and rows[-1] == ["steady_drift", "rad", "0.25"]


def test_simulate_says_how_its_recording_is_seen(cli, tmp_path):
    given = ("coasting", "--ship", "kcs_model", "--out", "a.png", "--rrd", "a b.rrd")
    code, out, err = cli("simulate", *given)
    assert code == 0 and out.endswith("\n      ship-gym review show 'a b.rrd'\n"), err
    meta = Trajectory.from_rrd("a b.rrd").meta
    assert meta["units"].keys() == meta["metrics"].keys()


@pytest.mark.parametrize("suffix", ["gpx", "geojson", "kml"])
def test_export_puts_a_track_on_the_earth(cli, folder, suffix):
    for library in ("pyproj", "gpxpy"):
        pytest.importorskip(library)
    run, out = "runs/pid_1000001.rrd", f"a.{suffix}"
    code, _, err = cli("review", "export", run, "--out", out)
    assert code == 2 and err.count("\n") == 1
    assert f"{run}: its" in err and "--origin LAT LON" in err and not Path(out).exists()
    on_earth = ("--origin", "-33.9", "-71.6")
    again = ("review", "export", run, "--out", out, *on_earth)
    assert [cli(*again)[0] for _ in range(2)] == [0, 0]
    assert "33.9" in Path(out).read_text()
    code, _, err = cli("review", "export", "runs/pid_1000002.rrd", "--out", out, *on_earth)
    assert code == 2 and "holds the track of another recording" in err
    Path(out).write_text("my route")
    assert "holds no such result" in cli(*again)[2] and cli(*again, "--force")[0] == 0
    before = Path(out).read_bytes()
    assert cli(*again, "--start", "2026-05-01T12:00:00Z")[0] == 0
    assert b"2026-05-01T12:00:00" in Path(out).read_bytes() and before != Path(out).read_bytes()


@pytest.mark.parametrize(
    ("more", "told"),
    [
        (["--out", "a.gpx", "--origin", "95", "0"], "latitude = 95"),
        (["--out", "a.gpx", "--origin", "54", "10", "--start", "noon"], "--start 'noon'"),
        (["--out", "a.gpx", "--origin", "54", "10", "--start", "2026-05-01T12:00"], "its zone"),
        (["--out", "a.csv", "--origin", "54", "10"], "--origin: of gpx, geojson, kml"),
        (["--out", "a.png", "--start", "2026-05-01T12:00Z"], "--start: of gpx"),
    ],
)
def test_places_and_times_that_are_none_are_one_line(cli, folder, more, told):
    pytest.importorskip("pyproj")
    code, _, err = cli("review", "export", "runs/pid_1000001.rrd", *more)
    assert code == 2 and told in err and err.count("\n") == 1, err
    assert not list(folder.parent.glob("a.*"))
