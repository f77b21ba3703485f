"""The tutorials of own ships, docs/tutorials: every block of them, word for word, in order."""

from pathlib import Path

import pytest

import ship_gym
from tests.docs.blocks import ROOT, blocks_of
from tests.docs.running import Reader, run_page

NAMES = ("own_ship", "barge", "tanker_mesh", "ferry")
ONE = Reader(shorter={"ship-gym build-wave-table": "ship-gym build-wave-table --jobs 1"})


@pytest.mark.slow
@pytest.mark.parametrize("page", NAMES)
def test_its_blocks_run(page, tmp_path, monkeypatch, capsys):
    for library in ("capytaine", "joblib", "trimesh"):
        pytest.importorskip(library)
    monkeypatch.chdir(tmp_path)
    names = run_page(f"docs/tutorials/{page}.md", ONE)
    (file,) = tmp_path.glob("*/ship.toml")
    table = ship_gym.load_wave_table(file).table
    assert Path(file.parent / f"waves_{file.parent.name}.npz").is_file()
    assert table.card["checks"]["energy"] < 0.05  # the panels are few, but they hold
    assert names["terminated"] is False


def test_each_has_commands_and_a_sail():
    for page in NAMES:
        kinds = [block.language for block in blocks_of(ROOT / f"docs/tutorials/{page}.md")]
        assert kinds.count("bash") >= 2 and "python" in kinds
