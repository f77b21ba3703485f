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

from ship_gym.provenance import atomic_path
from ship_gym.text import paragraph, table

_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #22303c; max-width: 70em; margin: 2em auto;
  padding: 0 1em; }
h1 { font-size: 1.6em; margin-bottom: 0; }
h2 { font-size: 1.2em; margin-top: 2em; border-bottom: 1px solid #e3e8ec; }
.under { color: #647684; margin-top: 0.2em; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; margin: 0.8em 0; font-size: 0.92em; }
caption { text-align: left; color: #647684; padding-bottom: 0.3em; }
th, td { padding: 0.15em 0.8em 0.15em 0; text-align: right; white-space: nowrap; }
th.left, td.left { text-align: left; white-space: normal; overflow-wrap: anywhere; }
thead th { border-bottom: 1px solid #8795a1; }
tbody tr:nth-child(even) { background: #f6f8f9; }
figure { margin: 1em 0; }
figcaption { color: #647684; font-size: 0.92em; }
img { max-width: 100%; height: auto; }
nav a { margin-right: 1em; }
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
class Grid:
    """A table of text.

    Attributes
    ----------
    caption : str
    header : sequence of str
    rows : sequence of sequence of str
        As many cells each as the header.
    left : int
        Number of columns, from the first, that are aligned left; the others are aligned right.
    """

    caption: str
    header: Sequence[str]
    rows: Sequence[Sequence[str]]
    left: int = 1

    def html(self) -> str:
        """The table as HTML."""
        if any(len(row) != len(self.header) for row in self.rows):
            raise ValueError(f"table {self.caption!r}: every row needs {len(self.header)} cells")
        body = "".join(f"<tr>{self._cells(row, 'td')}</tr>\n" for row in self.rows)
        return (
            f'<div class="wide"><table><caption>{escape(self.caption)}</caption>\n'
            f"<thead><tr>{self._cells(self.header, 'th')}</tr></thead>\n"
            f"<tbody>\n{body}</tbody></table></div>"
        )

    def plain(self) -> str:
        """The table as aligned text under its caption."""
        return f"{self.caption}\n{table(self.header, self.rows, self.left)}"

    def _cells(self, row: Sequence[str], tag: str) -> str:
        style = (' class="left"' if i < self.left else "" for i in range(len(row)))
        return "".join(
            f"<{tag}{s}>{escape(str(cell))}</{tag}>" for s, cell in zip(style, row, strict=True)
        )


@dataclasses.dataclass(frozen=True)
class Picture:
    """A PNG, kept inside the page.

    Attributes
    ----------
    caption : str
        What it shows; also read out in place of the picture.
    png : bytes
        The whole file.
    """

    caption: str
    png: bytes

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
class Section:
    """A headed part of a page."""

    title: str
    blocks: Sequence[Text | Grid | Picture]


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
    links = "".join(f'<a href="#s{i}">{escape(s.title)}</a>\n' for i, s in enumerate(there))
    parts = []
    for i, section in enumerate(there):
        blocks = "\n".join(block.html() for block in section.blocks)
        parts.append(f'<section id="s{i}"><h2>{escape(section.title)}</h2>\n{blocks}</section>')
    body = "\n".join(parts)
    return (
        f'<!doctype html>\n<html lang="en-GB">\n<head><meta charset="utf-8">\n'
        f'<meta name="viewport" content="width=device-width">\n'
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
