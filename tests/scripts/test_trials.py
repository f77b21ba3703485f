"""ship-gym trials: the table, its files, what it refuses."""

from __future__ import annotations

import json
from pathlib import Path

import pytest


@pytest.mark.slow
def test_files_and_another_time(cli):
    ship = ("trials", "--ship", "onrt_model")
    code, out, _ = cli(*ship, "--csv", "before.csv")
    assert code == 0 and "tactical diameter" in out and "wrote before.csv" in out
    files = ("--out", "docs/trials.md", "--plot", "docs/t.png")
    code, out, _ = cli(*ship, "--before", "before.csv", *files, "--json")
    data = json.loads(out)
    assert code == 0 and data["files"] == ["docs/trials.md", "docs/t.png"]
    assert data["before"].startswith("trials computed at commit")
    assert data["summary"]["closer"] == data["summary"]["further"] == 0
    assert all(row["before"] is not None for row in data["trials"])
    page = Path("docs/trials.md").read_text("utf-8")
    assert "](t.png)" in page and "Knight (2021) Table 6.2" in page
    assert Path("docs/t.png").read_bytes()[:4] == b"\x89PNG"


def test_refusals_in_one_line(cli):
    for arguments, words in (
        (("--ship", "dtc_model"), "no trial"),
        (("--before", "none.csv"), "none.csv"),
        (("--out", "page.txt"), "allowed is a .md file"),
    ):
        code, out, err = cli("trials", *arguments)
        assert (code, out) == (2, "") and words in err and len(err.strip().splitlines()) == 1
