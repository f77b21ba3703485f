"""Where napoleon and autodoc read our docstrings otherwise than they are meant.

Numpydoc allows ``x, y : float`` for what shares a line: napoleon divides parameters written so,
but takes the first names of attributes for a type. What stands before a colon in the line of a
property it takes for a type, too. A field of a named tuple is in the signature already.
"""

from __future__ import annotations

import re
from typing import Any

from sphinx.application import Sphinx

TOGETHER = re.compile(r"(\w+(?:, \w+)+)( :.*)?")
COLON = "\ue000"  # stands for a colon while napoleon reads; for private use in Unicode
BEFORE, AFTER = 400, 600  # napoleon has the usual 500
FIELD = "Alias for field number"  # the docstring that Python gives it


def divided(lines: list[str]) -> list[str]:
    """The lines of a docstring with each attribute by itself."""
    made: list[str] = []
    inside, at = False, 0
    while at < len(lines):
        if lines[at + 1 : at + 2] and re.fullmatch("-{3,}", lines[at + 1]):
            inside = lines[at] == "Attributes"
        end = at + 1
        if inside and (several := TOGETHER.fullmatch(lines[at])):
            while end < len(lines) and (not lines[end] or lines[end].startswith(" ")):
                end += 1
            for name in several[1].split(", "):
                made += [name + (several[2] or ""), *lines[at + 1 : end]]
        else:
            made.append(lines[at])
        at = end
    return made


def before(app: Sphinx, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Write a docstring so that napoleon reads it as it is meant, in place."""
    lines[:] = divided(lines)
    if what == "property" and lines:
        lines[0] = lines[0].replace(":", COLON)


def after(app: Sphinx, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Put the colons back, in place."""
    lines[:] = [line.replace(COLON, ":") for line in lines]


def skip(app: Sphinx, what: str, name: str, thing: Any, skipped: bool, options: Any) -> bool | None:
    """Leave out fields of named tuples about which nothing is said."""
    return True if (getattr(thing, "__doc__", None) or "").startswith(FIELD) else None


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the steps."""
    app.connect("autodoc-process-docstring", before, priority=BEFORE)
    app.connect("autodoc-process-docstring", after, priority=AFTER)
    app.connect("autodoc-skip-member", skip)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
