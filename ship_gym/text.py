"""Text for people: tables, plain or in Markdown, wrapped paragraphs, percentages."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

WIDTH = 100  # columns of a wrapped paragraph


def table(
    header: Sequence[str],
    rows: Sequence[Sequence[str]],
    left: int | None = 1,
    *,
    markdown: bool = False,
) -> str:
    """Rows of text as a table: aligned columns, or Markdown.

    Parameters
    ----------
    header : sequence of str
    rows : sequence of sequence of str
        As many cells each as the header.
    left : int or None
        Number of columns, from the first, that are aligned left; the others are aligned right.
        None: all are left. Markdown has them all left.
    markdown : bool
        With bars, which are escaped in cells; there an empty table is an error.
    """
    if any(len(row) != len(header) for row in rows) or (markdown and not rows):
        raise ValueError(f"table {list(header)}: needs rows of {len(header)} cells")
    lines = [header, *rows]
    if markdown:
        cells = [[cell.replace("|", "\\|") for cell in line] for line in lines]
        cells.insert(1, ["---"] * len(header))
        return "\n".join(f"| {' | '.join(line)} |" for line in cells)
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]

    def padded(line: Sequence[str]) -> str:
        pairs = enumerate(zip(line, widths, strict=True))
        cells = [c.ljust(w) if left is None or i < left else c.rjust(w) for i, (c, w) in pairs]
        return "  ".join(cells).rstrip()

    return "\n".join(map(padded, lines))


def paragraph(text: str, indent: str = "  ") -> str:
    """One paragraph, wrapped; lines after the first are indented."""
    return textwrap.fill(text, WIDTH, subsequent_indent=indent, break_on_hyphens=False)


def signed_interval(value: float, low: float, high: float) -> str:
    """A difference with its interval."""
    return f"{value:+.3g} [{low:+.3g}, {high:+.3g}]"


def percent(value: float | None) -> str:
    """Signed percentage, or nothing."""
    return "" if value is None else f"{value:+.1f} %"
