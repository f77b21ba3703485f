"""The arrays of a batch, taken apart for the card and put together again for one ship.

A kernel of the card gets the arrays as one flat tuple. A thread makes of it what the loops of the
CPU take, a `Fleet` and `Episodes`, but of one ship: rows i to i + 1 of every array that has a row
for each ship. So the loops themselves run on the card, over a batch of one.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

# Tables and lists that all ships share; every other array has a row for each ship.
SCRATCHES = ("scratch", "before")  # of single threads; one of the card has its own of one row
SHARED = frozenset(
    ("open_water", "deflected", "components", "offsets", "turns", "groups", "swell")
    + ("response", "winds", "gusts", "failed", "reached")
)


def leaves(tree: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Name and value of every array and number in named tuples of such, without the scratches."""
    if hasattr(tree, "_fields"):
        for field in tree._fields:
            yield from leaves(getattr(tree, field), field)
    elif tree is not None and name not in SCRATCHES:
        yield name, tree


def of_one_ship(tree: Any) -> tuple[Callable, str]:
    """Function that puts a tree of named tuples together for one ship, and a name for it.

    Parameters
    ----------
    tree : NamedTuple
        Of arrays, numbers and None, which is a type to the compiler, so a constant.

    Returns
    -------
    function : callable
        ``one(values, i, j, scratch, before)``: the tree, with rows i to j = i + 1 of the arrays of
        ships; `values` are those of `leaves`, in their order. Not compiled.
    name : str
        Differs where the functions do.
    """
    scope: dict[str, Any] = {}
    count = iter(range(10**6))

    def text(part: Any, field: str) -> str:
        if field in SCRATCHES:
            return field
        if part is None:
            return "None"
        if hasattr(part, "_fields"):
            kind = type(part).__name__
            scope[kind] = type(part)
            inner = (text(getattr(part, one), one) for one in part._fields)
            return f"{kind}({', '.join(inner)})"
        rows = "[i:j]" if isinstance(part, np.ndarray) and field not in SHARED else ""
        return f"values[{next(count)}]{rows}"

    source = f"def one(values, i, j, scratch, before):\n    return {text(tree, '')}\n"
    exec(source, scope)
    return scope["one"], hashlib.sha256(source.encode()).hexdigest()[:16]
