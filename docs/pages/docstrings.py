"""What docstrings say, for pages in Markdown."""

from __future__ import annotations

import functools
import inspect
import re
from collections.abc import Callable
from typing import NamedTuple

from ship_gym.text import table as text_table

table = functools.partial(text_table, markdown=True)

_FIELDS = re.compile(r"^(?:Attributes|Parameters)\n-+\n(.*?)(?=^\w+\n-+$|\Z)", re.M | re.S)
_RETURNS = re.compile(r"^Returns\n-+\n(.*?)(?=^\w+\n-+$|\Z)", re.M | re.S)


def intro(thing: type | Callable) -> str:
    """Text of a numpydoc docstring before its first section, a line for each paragraph."""
    before = re.split(r"^\w+\n-+$", inspect.getdoc(thing), maxsplit=1, flags=re.M)[0]
    return "\n\n".join(_flowing(text) for text in before.strip().split("\n\n"))


class Field(NamedTuple):
    """Names of a docstring that share one text, e.g. two bounds; the text is often empty."""

    names: tuple[str, ...]
    text: str


def fields(thing: type | Callable) -> dict[str, Field]:
    """Attributes or parameters of a numpydoc docstring by name; without such a section, none."""
    found: dict[str, Field] = {}
    section = _FIELDS.search(inspect.getdoc(thing))
    for entry in re.split(r"\n(?=\S)", section[1].strip()) if section else ():
        head, _, text = entry.partition("\n")
        names = tuple(name.strip() for name in head.partition(" : ")[0].split(","))
        found |= dict.fromkeys(names, Field(names, _flowing(text)))
    return found


def returned(thing: Callable) -> list[str]:
    """Clauses of the Returns section of a numpydoc docstring, without the line of its type."""
    _, _, text = _RETURNS.search(inspect.getdoc(thing))[1].partition("\n")
    return re.split(r"[;.] ", _flowing(text).removesuffix("."))


def _flowing(text: str) -> str:
    """One line, code in single backticks as Markdown has it."""
    return " ".join(text.split()).replace("``", "`")
