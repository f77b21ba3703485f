"""Cells of tables that hold sentences, marked so that a narrow page does not squeeze them.

A table that is wider than the page scrolls; a browser then makes every column as narrow as its
longest word, and a sentence a column of words. The style sheet gives marked cells a least width.
"""

from __future__ import annotations

from docutils import nodes
from sphinx.application import Sphinx

LONG = 60  # characters


def mark(app: Sphinx, doctree: nodes.document) -> None:
    """Give cells with long texts the class ``sentence``."""
    for cell in doctree.findall(nodes.entry):
        if len(cell.astext()) > LONG:
            cell["classes"].append("sentence")


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the step."""
    app.connect("doctree-read", mark)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
