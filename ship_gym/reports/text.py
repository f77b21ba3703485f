"""Aligned plain text."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

WIDTH = 100  # columns of a wrapped paragraph


def table(header: Sequence[str], rows: Sequence[Sequence[str]], left: int = 1) -> str:
    """Rows of text in aligned columns.

    Parameters
    ----------
    header : sequence of str
    rows : sequence of sequence of str
        As many cells each as the header.
    left : int
        Number of columns, from the first, that are aligned left; the others are aligned right.
    """
    lines = [list(header), *(list(row) for row in rows)]
    widths = [max(len(line[i]) for line in lines) for i in range(len(header))]

    def aligned(line: Sequence[str]) -> str:
        pairs = enumerate(zip(line, widths, strict=True))
        cells = [cell.ljust(w) if i < left else cell.rjust(w) for i, (cell, w) in pairs]
        return "  ".join(cells).rstrip()

    return "\n".join(aligned(line) for line in lines)


def paragraph(text: str, indent: str = "  ") -> str:
    """One paragraph, wrapped; lines after the first are indented."""
    return textwrap.fill(text, WIDTH, subsequent_indent=indent, break_on_hyphens=False)


def percent(value: float | None) -> str:
    """Signed percentage, or nothing."""
    return "" if value is None else f"{value:+.1f} %"
