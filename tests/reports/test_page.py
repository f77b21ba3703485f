"""One HTML page: everything escaped, nothing loaded from outside, written whole or not at all."""

import base64
from html.parser import HTMLParser

import pytest

from ship_gym.reports import page
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
    html_page,
    plain_text,
    write_page,
)

PNG = b"\x89PNG" + b"data"
NASTY = "<script>&\"'"


@pytest.fixture
def sections():
    return [
        Section("One " + NASTY, [Text(NASTY), Grid(NASTY, ["", NASTY], [["a", NASTY]])]),
        Section("empty", []),
        Section("Pictures", [Picture(NASTY, PNG), Row([Picture(NASTY, PNG), Picture("b", PNG)])]),
        Section("More", [Folded(NASTY, [Heading(NASTY, "here"), Command(NASTY)])], "more"),
    ]


def test_everything_is_escaped(sections):
    text = html_page(NASTY, NASTY, sections)
    assert "<script" not in text and "&lt;script&gt;&amp;&quot;&#x27;" in text
    assert text.count("<section") == 3 and "empty" not in text  # without blocks left out


def test_the_page_is_self_contained(sections):
    text = html_page("t", "u", sections)
    assert f"data:image/png;base64,{base64.b64encode(PNG).decode()}" in text
    for outside in ("http:", "https:", "<link", "<script", "@import", "url("):
        assert outside not in text
    assert text.startswith("<!doctype html>") and text.endswith("</html>\n")


class Tags(HTMLParser):
    """Open tags; every end tag must close the last of them."""

    def __init__(self):
        super().__init__()
        self.open = []

    def handle_starttag(self, tag, attrs):
        if tag not in ("meta", "img"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def test_tags_are_closed(sections):
    tags = Tags()
    tags.feed(html_page("t", "u", sections))
    assert tags.open == []


def test_plain_text_has_no_pictures(sections):
    text = plain_text([Section("s", [Grid("caption", ["", "x"], [["a", "10"], ["b", "9"]])])])
    assert text == "caption\n    x\na  10\nb   9"
    assert "PNG" not in plain_text(sections)


def test_cells_lead_and_are_marked():
    grid = Grid("c", ["a", "b"], [[Cell(NASTY, "here"), Cell("x", mark="worse")], ["1", "2"]])
    text = html_page("t", "u", [Section("s", [grid, Heading("h", "here")], "place")])
    assert '<a href="#here">&lt;script' in text and '<h3 id="here">h</h3>' in text
    assert '<span class="worse">x</span>' in text
    assert '<section id="place">' in text and '<a href="#place">s</a>' in text
    assert grid.plain().splitlines()[2].split() == [NASTY, "x"]


def test_folded_blocks_and_commands_are_there_as_text():
    folded = Folded("more", [Command("ls -l"), Row([Picture("p", PNG)]), Text("end")])
    assert folded.plain() == "more\n\nls -l\n\nend"
    assert folded.html().startswith("<details><summary>more</summary>")


def test_wrong_blocks_are_refused():
    with pytest.raises(ValueError, match="every row needs 2 cells"):
        Grid("c", ["a", "b"], [["1"]]).html()
    with pytest.raises(ValueError, match="no PNG"):
        Picture("c", b"GIF89a").html()
    with pytest.raises(ValueError, match="'good' is not better or worse"):
        Cell("c", mark="good").html()


def test_an_interrupted_write_leaves_the_old_page(sections, tmp_path, monkeypatch):
    path = tmp_path / "new" / "page.html"
    write_page(path, "t", "u", sections)
    before = path.read_bytes()
    monkeypatch.setattr(page, "html_page", lambda *a: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        write_page(path, "t", "u", sections)
    assert path.read_bytes() == before and list(path.parent.iterdir()) == [path]
