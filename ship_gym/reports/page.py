"""A report of sections with text, tables and pictures: as plain text, or as one HTML page.

The page is a single file that loads nothing from outside. A report puts plain text in; everything
is escaped here. Pictures are PNG bytes that whoever draws them hands over, so that this module
needs no drawing library.
"""

from __future__ import annotations

import base64
import dataclasses
import os
from collections.abc import Sequence
from html import escape
from typing import TypeAlias
from urllib.parse import quote

from ship_gym.text import paragraph, table
from ship_gym.writing import atomic_path

GENERATOR = '<meta name="generator" content="Ship Gym">'  # by which a page is known
_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #22303c; max-width: 70em; margin: 2em auto;
  padding: 0 1em; }
h1 { font-size: 1.6em; margin-bottom: 0; }
h2 { font-size: 1.2em; margin-top: 2em; border-bottom: 1px solid #e3e8ec; }
.under { color: #647684; margin-top: 0.2em; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; margin: 0.8em 0; font-size: 0.92em; }
td.left:last-child { min-width: 14em; }
caption { text-align: left; color: #647684; padding-bottom: 0.3em; }
caption span { position: sticky; left: 0; display: inline-block; max-width: calc(100vw - 3em); }
th, td { padding: 0.15em 0.8em 0.15em 0; text-align: right; white-space: nowrap; }
th.left, td.left { text-align: left; white-space: normal; overflow-wrap: break-word; }
thead th { border-bottom: 1px solid #8795a1; }
tbody tr:nth-child(even) { background: #f6f8f9; }
figure { margin: 1em 0; }
figcaption { color: #647684; font-size: 0.92em; }
img { max-width: 100%; height: auto; }
a { color: #1f5a94; }
nav a { margin-right: 1em; }
h3 { font-size: 1.05em; margin: 1.6em 0 0.4em; }
.better { color: #1d6b61; font-weight: 600; }
.worse { color: #b8402f; font-weight: 600; }
.row { display: flex; flex-wrap: wrap; gap: 0 1.5em; align-items: flex-start; }
.row figure { flex: 0 1 auto; max-width: 100%; }
.row figcaption { max-width: 34em; }
details { margin: 0.6em 0; }
summary { cursor: pointer; color: #1f5a94; }
details > div { padding-left: 0.9em; border-left: 2px solid #e3e8ec; }
pre { overflow-x: auto; background: #f6f8f9; padding: 0.5em 0.7em; font-size: 0.88em; }
"""


@dataclasses.dataclass(frozen=True)
class Text:
    """A paragraph of plain text."""

    text: str

    def html(self) -> str:
        """The paragraph as HTML."""
        return f"<p>{escape(self.text)}</p>"

    def plain(self) -> str:
        """The paragraph, wrapped."""
        return paragraph(self.text)


@dataclasses.dataclass(frozen=True)
class Heading:
    """A headline inside a section.

    Attributes
    ----------
    text : str
    anchor : str
        Where a `Cell` of this page can lead; empty: nowhere.
    """

    text: str
    anchor: str = ""

    def html(self) -> str:
        """The headline as HTML."""
        place = f' id="{escape(self.anchor)}"' if self.anchor else ""
        return f"<h3{place}>{escape(self.text)}</h3>"

    def plain(self) -> str:
        """The headline."""
        return self.text


@dataclasses.dataclass(frozen=True)
class Command:
    """Lines to be copied into a shell."""

    text: str

    def html(self) -> str:
        """The lines as HTML."""
        return f"<pre>{escape(self.text)}</pre>"

    def plain(self) -> str:
        """The lines as they are."""
        return self.text


@dataclasses.dataclass(frozen=True)
class Cell:
    """A cell of a table that leads somewhere or is marked.

    Attributes
    ----------
    text : str
    to : str
        Anchor on the same page; empty: none.
    mark : str
        ``"better"``, ``"worse"`` or nothing: a colour, so the text must say it too.
    file : str
        File beside the page that it leads to, a relative path; empty: none.
    """

    text: str
    to: str = ""
    mark: str = ""
    file: str = ""

    def __str__(self) -> str:
        return self.text

    def html(self) -> str:
        """The cell's content as HTML."""
        if self.mark not in ("", "better", "worse"):
            raise ValueError(f"cell {self.text!r}: mark {self.mark!r} is not better or worse")
        text = escape(self.text)
        text = f'<span class="{self.mark}">{text}</span>' if self.mark else text
        if self.file:
            return f'<a href="{escape(quote(self.file))}">{text}</a>'
        return f'<a href="#{escape(self.to)}">{text}</a>' if self.to else text


@dataclasses.dataclass(frozen=True)
class Grid:
    """A table of text.

    Attributes
    ----------
    caption : str
    header : sequence of str
    rows : sequence of sequence of str or Cell
        As many cells each as the header.
    left : int
        Number of columns, from the first, that are aligned left; the others are aligned right.
    """

    caption: str
    header: Sequence[str]
    rows: Sequence[Sequence[str | Cell]]
    left: int = 1

    def html(self) -> str:
        """The table as HTML."""
        if any(len(row) != len(self.header) for row in self.rows):
            raise ValueError(f"table {self.caption!r}: every row needs {len(self.header)} cells")
        body = "".join(f"<tr>{self._cells(row, 'td')}</tr>\n" for row in self.rows)
        return (
            f'<div class="wide"><table><caption><span>{escape(self.caption)}</span></caption>\n'
            f"<thead><tr>{self._cells(self.header, 'th')}</tr></thead>\n"
            f"<tbody>\n{body}</tbody></table></div>"
        )

    def plain(self) -> str:
        """The table as aligned text under its caption."""
        rows = [[str(cell) for cell in row] for row in self.rows]
        return f"{self.caption}\n{table(self.header, rows, self.left)}"

    def _cells(self, row: Sequence[str | Cell], tag: str) -> str:
        style = (' class="left"' if i < self.left else "" for i in range(len(row)))
        texts = (cell.html() if isinstance(cell, Cell) else escape(str(cell)) for cell in row)
        return "".join(f"<{tag}{s}>{text}</{tag}>" for s, text in zip(style, texts, strict=True))


@dataclasses.dataclass(frozen=True)
class Picture:
    """A PNG, kept inside the page.

    Attributes
    ----------
    caption : str
        What it shows; also read out in place of the picture.
    png : bytes
        The whole file.
    name : str
        Of a file, without its suffix, where the picture leaves the page.
    """

    caption: str
    png: bytes
    name: str = ""

    def html(self) -> str:
        """The picture as HTML."""
        if not self.png.startswith(b"\x89PNG"):
            raise ValueError(f"picture {self.caption!r}: no PNG")
        text = escape(self.caption)
        data = base64.b64encode(self.png).decode("ascii")
        return (
            f'<figure><img alt="{text}" src="data:image/png;base64,{data}">'
            f"<figcaption>{text}</figcaption></figure>"
        )

    def plain(self) -> str:
        """Nothing: text has no pictures."""
        return ""


@dataclasses.dataclass(frozen=True)
class Row:
    """Pictures beside each other, as many as the window is wide enough for."""

    pictures: Sequence[Picture]

    def html(self) -> str:
        """The pictures as HTML."""
        return f'<div class="row">{"".join(each.html() for each in self.pictures)}</div>'

    def plain(self) -> str:
        """Nothing: text has no pictures."""
        return ""


@dataclasses.dataclass(frozen=True)
class Folded:
    """Blocks that are shown when their title is clicked."""

    title: str
    blocks: Sequence[Block]

    def html(self) -> str:
        """The folded blocks as HTML."""
        blocks = "\n".join(block.html() for block in self.blocks)
        return f"<details><summary>{escape(self.title)}</summary><div>{blocks}</div></details>"

    def plain(self) -> str:
        """The title, then the blocks: text cannot be folded."""
        texts = (block.plain() for block in self.blocks)
        return "\n\n".join([self.title, *(text for text in texts if text)])


Block: TypeAlias = Text | Heading | Command | Grid | Picture | Row | Folded


@dataclasses.dataclass(frozen=True)
class Section:
    """A headed part of a page.

    Attributes
    ----------
    title : str
    blocks : sequence of Block
    anchor : str
        Where a `Cell` of this page can lead; empty: a number.
    """

    title: str
    blocks: Sequence[Block]
    anchor: str = ""


def plain_text(sections: Sequence[Section]) -> str:
    """Sections as plain text, without their headings and pictures."""
    blocks = [block.plain() for section in sections for block in section.blocks]
    return "\n\n".join(text for text in blocks if text)


def html_page(title: str, under: str, sections: Sequence[Section]) -> str:
    """A whole page as HTML.

    Parameters
    ----------
    title, under : str
        Headline and a fainter line under it, plain text.
    sections : sequence of Section
        Sections without blocks are left out.
    """
    there = [section for section in sections if section.blocks]
    anchors = [escape(section.anchor) or f"s{i}" for i, section in enumerate(there)]
    pairs = list(zip(anchors, there, strict=True))
    links = "".join(f'<a href="#{anchor}">{escape(s.title)}</a>\n' for anchor, s in pairs)
    parts = []
    for anchor, section in pairs:
        blocks = "\n".join(block.html() for block in section.blocks)
        parts.append(f'<section id="{anchor}"><h2>{escape(section.title)}</h2>\n{blocks}</section>')
    body = "\n".join(parts)
    return (
        f'<!doctype html>\n<html lang="en-GB">\n<head><meta charset="utf-8">\n'
        f'<meta name="viewport" content="width=device-width">{GENERATOR}\n'
        f"<title>{escape(title)}</title>\n<style>{_STYLE}</style></head>\n"
        f'<body><h1>{escape(title)}</h1>\n<p class="under">{escape(under)}</p>\n'
        f"<nav>{links}</nav>\n{body}\n</body></html>\n"
    )


def write_page(
    path: str | os.PathLike, title: str, under: str, sections: Sequence[Section]
) -> None:
    """Write `html_page` to a file, whole or not at all."""
    text = html_page(title, under, sections)
    with atomic_path(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
