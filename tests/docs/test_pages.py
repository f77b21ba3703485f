"""Every page with blocks runs from top to bottom in an empty folder: here, or where `RUN` says.

What a page takes for granted (a file of the reader's, a trained policy), and where a test sails
less than the page says, stands in `READERS`.
"""

import pytest

from tests.docs.blocks import PAGES, ROOT, SHELL, blocks_of
from tests.docs.readers import READERS
from tests.docs.running import ELSEWHERE, Reader, call, needs, run_page
from tests.docs.test_tutorials import SHIPS, TUTORIALS

RUN = {  # pages whose blocks other tests run
    **dict.fromkeys(TUTORIALS, "tests/docs/test_tutorials.py"),
    **{f"docs/tutorials/{name}.md": "tests/recipes/test_ship_tutorials.py" for name in SHIPS},
    "docs/extending.md": "tests/recipes/test_extending.py",
}
BLOCKS = {
    name: blocks
    for page in PAGES
    if (name := page.relative_to(ROOT).as_posix()) not in RUN
    and (blocks := [b for b in blocks_of(page) if b.language in ("python", *SHELL)])
}
CLIENTS = sorted({(page, x) for page, blocks in BLOCKS.items() for b in blocks if (x := needs(b))})


def sail(page, folder, monkeypatch, client=None):
    """A page in its folder, if its libraries are there."""
    reader = READERS.get(page, Reader())
    for library in reader.libraries:
        pytest.importorskip(library)
    monkeypatch.chdir(folder)
    run_page(page, reader, client)


@pytest.mark.slow
@pytest.mark.parametrize("page", BLOCKS)
def test_a_page_runs(page, tmp_path, monkeypatch):
    sail(page, tmp_path, monkeypatch)


@pytest.mark.parametrize(("page", "library"), CLIENTS)
def test_the_blocks_of_another_library_run(page, library, tmp_path, monkeypatch):
    """In scripts/test_clients.sh, which brings the libraries."""
    pytest.importorskip(library)
    sail(page, tmp_path, monkeypatch, library)


def test_pages_that_others_run_are_there():
    for page, test in RUN.items():
        assert (ROOT / page).exists() and (ROOT / test).exists(), page


@pytest.mark.parametrize("page", READERS)
def test_what_is_shorter_stands_in_the_page(page):
    text = "\n".join(block.code for block in blocks_of(ROOT / page))
    for long, short in READERS[page].shorter.items():
        assert long in text and long != short
        text = text.replace(long, short)


def test_lines_of_other_programs_stand_in_a_page():
    text = [line for page in PAGES for block in blocks_of(page) for line in block.code.splitlines()]
    for start in ELSEWHERE:
        assert any(line.startswith(start) for line in text), start


def test_a_line_that_nobody_runs_is_noticed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for line in ("rm -rf runs", "python scripts/gone.py", "make all"):
        with pytest.raises(AssertionError):
            call(line)


def test_a_page_that_fails_is_noticed(tmp_path, monkeypatch):
    """Names, files and commands that are missing, each by its line."""
    monkeypatch.chdir(tmp_path)
    page = "docs/routes.md"  # without the reader's file
    with pytest.raises(Exception, match=r"kiel_gedser.rtz: no such file"):
        run_page(page, Reader())
