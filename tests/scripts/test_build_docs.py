import functools
import importlib
import json
import sys
from pathlib import Path

import pytest

from pages import environment_pages
from pages.environment_pages import env_ids, name_of

SCRIPTS = Path(__file__).parents[2] / "scripts"
PICTURES = [f"{name_of(env_id)}.png" for env_id in env_ids()]

pages = functools.lru_cache(environment_pages.pages)  # half a second each time


@pytest.fixture
def script(monkeypatch, tmp_path, capsys):
    """Run build_docs in this process, in an empty folder: exit code, stdout, stderr."""
    monkeypatch.syspath_prepend(str(SCRIPTS))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(environment_pages, "pages", pages)

    def call(*args):
        monkeypatch.setattr(sys, "argv", ["build_docs.py", *map(str, args)])
        code = 0
        try:
            importlib.import_module("_cli").run(importlib.import_module("build_docs").main)
        except SystemExit as stop:
            code = stop.code
        return code, *capsys.readouterr()

    yield call
    for name in ("_cli", "build_docs"):
        sys.modules.pop(name, None)


def test_help_has_two_examples(script):
    code, out, _ = script("--help")
    assert code == 0 and out.split("examples:")[1].count("python scripts/build_docs.py") == 2
    assert "--json" in out and "--check" in out


def test_texts_then_check(script, tmp_path):
    code, out, _ = script("--out", "d", "--no-pictures")
    assert code == 0 and out.count("wrote d") == len(pages())
    assert {path.name for path in Path("d").iterdir()} == set(pages())
    code, out, _ = script("--out", "d", "--check", "--json")
    assert code == 1 and json.loads(out) == {"folder": "d", "outdated": sorted(PICTURES)}
    for name in PICTURES:
        (tmp_path / "d" / name).write_bytes(b"any")
    code, out, _ = script("--out", "d", "--check")
    assert (code, out) == (0, "up to date\n")
    (tmp_path / "d" / "README.md").write_text("edited")
    code, out, _ = script("--out", "d", "--check")
    assert code == 1 and "README.md; run python scripts/build_docs.py" in out
    assert (tmp_path / "d" / "README.md").read_text() == "edited"


def test_the_default_folder_is_that_of_the_checkout(script):
    code, out, _ = script("--check", "--json")
    assert code == 0 and Path(json.loads(out)["folder"]) == SCRIPTS.parent / "docs/environments"


def test_a_file_in_place_of_the_folder_is_one_line(script, tmp_path):
    (tmp_path / "d").write_text("a file")
    code, out, err = script("--out", "d", "--no-pictures")
    assert (code, out) == (2, "") and err.startswith("error: ") and err.count("\n") == 1


def test_missing_pillow_is_one_line_before_any_work(script, monkeypatch, tmp_path):
    for name in ("png", "canvas"):
        monkeypatch.delitem(sys.modules, f"ship_gym.rendering.{name}", raising=False)
    monkeypatch.setitem(sys.modules, "PIL", None)
    code, _, err = script("--out", "d")
    assert code == 2 and 'pip install "ship-gym[render]"' in err and err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_pictures(script, tmp_path):
    image = pytest.importorskip("PIL.Image")
    code, out, _ = script("--out", "d", "--json")
    assert code == 0
    written = [Path(file).name for file in json.loads(out)["files"]]
    assert sorted(written) == sorted([*pages(), *PICTURES])
    for name in PICTURES:
        with image.open(tmp_path / "d" / name) as picture:
            assert picture.size == (960, 540)
        assert (tmp_path / "d" / name).stat().st_size < 100_000
    assert script("--out", "d", "--check")[0] == 0
