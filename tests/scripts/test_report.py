"""ship-gym report: the page, the Markdown page, what it refuses."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from ship_gym.evaluation.episodes_table import Results, table_of, write_results


@pytest.fixture
def run(tmp_path):
    """Folder of a run with two made-up episodes of each of two controllers."""
    shared = {
        "suite": "heading", "version": "ShipBench-1", "scenario": "heading_keeping",
        "tier": "basic", "task": "heading_keeping", "ship": "kcs", "kind": "classical",
        "measure": "J_0.1", "outcome": "end of time", "failed": False, "length": 600, "error": "",
        "success": 1.0, "rudder_travel": 100.0, "rudder_reversals": 50.0,
    }  # fmt: skip
    rows = [
        shared | {"controller": name, "seed": 2_000_000 + k, "value": value + k, "J_0.1": value + k}
        for name, value in (("constant", 900.0), ("pid", 20.0))
        for k in range(2)
    ]
    folder = tmp_path / "run"
    write_results(folder / "episodes.parquet", Results(table_of(rows), {"seeds": [2_000_000]}))
    return folder


def test_the_page_stands_beside_the_results(cli, run):
    code, out, _ = cli("report", run, "--episodes", "0")
    assert code == 0 and f"wrote {run / 'report.html'}" in out
    text = (run / "report.html").read_text("utf-8")
    assert "heading_keeping, kcs (basic)" in text and "The worst episode" not in text


def test_markdown_and_json(cli, run):
    code, out, _ = cli("report", run / "episodes.parquet", "--markdown", "docs/r.md", "--json")
    data = json.loads(out)
    assert code == 0 and data["episodes"] == 4 and data["files"][0] == "docs/r.md"
    assert all(Path(file).exists() for file in data["files"])


@pytest.mark.compiled
def test_an_episode_is_sailed_again(cli, run):
    code, _, _ = cli("report", run, "--episodes", "1", "--out", "page.html")
    text = Path("page.html").read_text("utf-8")
    assert code == 0 and "The best episode of pid, heading_keeping/kcs, seed 2000000" in text


def test_refusals_in_one_line(cli, run):
    for arguments, words in (
        (("none",), "none: no such file"),
        ((run, "--out", "a.html", "--markdown", "b.md"), "allowed is one of them"),
        ((run, "--out", "page.md"), "allowed is a .html file"),
        ((run, "--episodes", "-1"), "--episodes = -1: allowed is 0 to 10000"),
    ):
        code, out, err = cli("report", *arguments)
        assert (code, out) == (2, "") and words in err and len(err.strip().splitlines()) == 1


def test_pages_and_pictures_of_a_user_are_kept(cli, run):
    for option, file, mine in (
        ("--out", "page.html", "<!doctype html>\n<title>mine</title>"),
        ("--markdown", "docs/r.md", "<!-- mine -->"),
        ("--markdown", "docs/s.md", None),
    ):
        words, path = ("report", run, "--episodes", "0", option, file), Path(file)
        path.parent.mkdir(exist_ok=True)
        kept = path if mine else path.with_suffix("") / "photo.png"
        kept.parent.mkdir(exist_ok=True)
        kept.write_text(mine or "mine")
        code, out, err = cli(*words)
        assert (code, out, err.count("\n")) == (2, "", 1) and "--force" in err, err
        assert kept.read_text() == (mine or "mine")
        assert cli(*words, "--force")[0] == 0
        assert cli(*words)[0] == 0, "a page of the verb"
