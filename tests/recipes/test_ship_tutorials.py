"""The tutorials of own ships, docs/tutorials: every block of them, word for word, in order."""

import re
import shlex
from pathlib import Path

import pytest
from ship_gym_agents.cli import load_verb

import ship_gym

PAGES = Path(__file__).resolve().parents[2] / "docs" / "tutorials"
NAMES = ("own_ship", "barge", "tanker_mesh", "ferry")
_BLOCK = re.compile(r"^```(python|bash)\n(.*?)^```$", re.M | re.S)


@pytest.mark.slow
@pytest.mark.parametrize("page", NAMES)
def test_its_blocks_run(page, tmp_path, monkeypatch, capsys):
    for library in ("capytaine", "joblib", "trimesh"):
        pytest.importorskip(library)
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    for kind, block in _BLOCK.findall((PAGES / f"{page}.md").read_text("utf-8")):
        if kind == "python":
            exec(compile(block, f"{page}.md", "exec"), names)
            continue
        for line in block.splitlines():
            program, verb, *words = shlex.split(line)
            assert program == "ship-gym"
            words += ["--jobs", "1"] * (verb == "build-wave-table")
            load_verb(verb).main(words, standalone_mode=False)
    (file,) = tmp_path.glob("*/ship.toml")
    table = ship_gym.load_wave_table(file).table
    assert Path(file.parent / f"waves_{file.parent.name}.npz").is_file()
    assert table.card["checks"]["energy"] < 0.05  # the panels are few, but they hold
    assert names["terminated"] is False


def test_each_has_commands_and_a_sail():
    for page in NAMES:
        kinds = [kind for kind, _ in _BLOCK.findall((PAGES / f"{page}.md").read_text("utf-8"))]
        assert kinds.count("bash") >= 2 and "python" in kinds
