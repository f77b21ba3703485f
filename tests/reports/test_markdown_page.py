"""Sections as Markdown: the page, its pictures beside it, what is refused."""

import pytest

from ship_gym.reports.markdown_page import write_markdown_page
from ship_gym.reports.page import (
    Cell,
    Command,
    Folded,
    Grid,
    Heading,
    Picture,
    Row,
    Section,
    Text,
)

PNG = b"\x89PNG" + b"data"


def sections():
    return [
        Section("", [Text("begins")]),
        Section("Left out", []),
        Section(
            "First",
            [
                Grid("numbers", ["a", "b"], [[Cell("x", "there"), "1|2"]]),
                Grid("empty", ["a"], []),
                Row([Picture("one", PNG, "p1"), Picture("two", PNG, "p2")]),
                Folded("more", [Heading("h"), Command("ls")]),
            ],
        ),
    ]


def test_the_page_and_its_pictures(tmp_path):
    path = tmp_path / "docs" / "results.md"
    old = tmp_path / "docs" / "results" / "old.png"
    old.parent.mkdir(parents=True)
    old.write_bytes(PNG)
    files = write_markdown_page(path, "Title", "made by a test", sections())
    assert [file.name for file in files] == ["results.md", "p1.png", "p2.png"]
    assert all(file.exists() for file in files) and not old.exists()
    text = path.read_text("utf-8")
    assert text.startswith("<!-- made by a test -->\n\n# Title\n\nbegins\n\n## First\n")
    assert "numbers:\n\n| a | b |\n| --- | --- |\n| x | 1\\|2 |" in text
    assert "![one](results/p1.png)" in text and "Left out" not in text and "empty" not in text
    assert "<details><summary>more</summary>\n\n### h\n\n```text\nls\n```\n\n</details>" in text


def test_pictures_need_names_of_their_own(tmp_path):
    for names in (("", "b"), ("a", "a")):
        twice = [Section("s", [Picture("c", PNG, name) for name in names])]
        with pytest.raises(ValueError, match="each needs a name of its own"):
            write_markdown_page(tmp_path / "p.md", "t", "m", twice)
    assert list(tmp_path.iterdir()) == []
