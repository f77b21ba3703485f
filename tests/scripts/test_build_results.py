"""scripts/build_results.py: the page from whatever the benchmark gives."""

import json
from pathlib import Path

import ship_gym.evaluation as module
from ship_gym.evaluation.episodes_table import Results, table_of


def test_the_page_is_written_with_its_command(call, monkeypatch):
    asked = {}

    def made_up(suite, entrant, **options):
        asked.update(options, suite=suite)
        row = {
            "suite": "heading", "version": "ShipBench-1", "scenario": "heading_keeping",
            "tier": "basic", "task": "heading_keeping", "ship": "kcs", "kind": "classical",
            "measure": "J_steady", "failed": False, "error": "", "outcome": "end of time",
            "length": 600, "success": 1.0,
        }  # fmt: skip
        rows = [
            row | {"controller": name, "seed": seed, "value": value + seed}
            for name, value in (("constant", 90.0), ("pid", 10.0))
            for seed in range(4)
        ]
        return Results(table_of(rows), {"command": options["command"]})

    monkeypatch.setattr(module, "benchmark", made_up)
    arguments = ("--suite", "heading", "--seeds", "4", "--out", "r.md", "--json")
    code, out, _ = call("build_results.py", *arguments)
    data = json.loads(out)
    assert code == 0 and data["episodes"] == 8 and data["files"][0] == "r.md"
    assert (asked["suite"], asked["seeds"]) == (["heading"], 4)
    text = Path("r.md").read_text("utf-8")
    assert text.count("python scripts/build_results.py --suite heading --seeds 4") >= 3
    assert "| 1 | pid | classical | " in text
