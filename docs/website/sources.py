"""Source files as pages of the site.

A link of a page to a file of the repository leads to the file, as on GitHub, where Sphinx would
offer it as a download. Each entry of the reference leads to the line where it is defined.
"""

from __future__ import annotations

import inspect
import posixpath
import sys
from collections.abc import Iterator
from functools import reduce
from pathlib import Path
from typing import Any

from docutils import nodes
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import TextLexer, get_lexer_for_filename
from pygments.util import ClassNotFound
from sphinx import addnodes
from sphinx.application import Sphinx

ROOT = Path(__file__).resolve().parents[2]
SHOWN = {".py", ".toml", ".csv", ".json", ".rtz", ".sh", ".cff", ".xml", ".yml", ".txt"}
FROM_REFERENCE = "../.."  # its pages lie in docs/api
LINKED: set[str] = set()  # files that some page leads to, from the root of the repository


def page_of(file: str) -> str:
    """Place of a file's page in the site; the page will be written."""
    LINKED.add(file)
    return f"source/{file}.html"


def point_to_pages(app: Sphinx, doctree: nodes.document, docname: str) -> None:
    """Replace downloads of text files by links to their pages."""
    for node in list(doctree.findall(addnodes.download_reference)):
        file = app.env.relfn2path(node["reftarget"], docname)[0]
        if posixpath.splitext(file)[1] in SHOWN:
            place = posixpath.relpath(page_of(file), posixpath.dirname(docname) or ".")
            link = nodes.reference("", "", internal=True, refuri=place)
            link += node.children
            node.replace_self(link)


def linkcode_resolve(domain: str, info: dict[str, str]) -> str | None:
    """Where a name of the reference is defined; None of what has no place, such as a number."""
    try:
        named = reduce(getattr, info["fullname"].split("."), sys.modules[info["module"]])
        named = inspect.unwrap(named.fget if isinstance(named, property) else named)
        file = Path(inspect.getsourcefile(named)).relative_to(ROOT).as_posix()
        line = inspect.getsourcelines(named)[1]
    except (AttributeError, KeyError, TypeError, ValueError, OSError):
        return None
    return f"{FROM_REFERENCE}/{page_of(file)}#line-{line}"


def source_pages(app: Sphinx) -> Iterator[tuple[str, dict[str, Any], str]]:
    """A page for each file that was linked."""
    for file in sorted(LINKED):
        try:
            lexer = get_lexer_for_filename(file)
        except ClassNotFound:
            lexer = TextLexer()
        text = (ROOT / file).read_text("utf-8")
        code = highlight(text, lexer, HtmlFormatter(linespans="line"))
        body = f"<h1>{file}</h1>\n{code}"
        yield f"source/{file}", {"title": file, "body": body}, "page.html"


def setup(app: Sphinx) -> dict[str, bool]:
    """Register both steps."""
    app.connect("doctree-resolved", point_to_pages)
    app.connect("html-collect-pages", source_pages)
    return {"parallel_read_safe": False, "parallel_write_safe": False}
