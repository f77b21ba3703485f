"""Changes of a file's bytes that know its format: trees, tables and lines of text, plain bytes.

An edit takes random numbers and bytes and gives other bytes. What an earlier edit has broken, so
that the format is no longer to be parsed, is changed as plain text.
"""

from __future__ import annotations

import copy
import json
import tomllib
from collections.abc import Callable
from typing import Any

import numpy as np
from _fuzz_values import json_text, odd, scaled, toml

Edit = Callable[[np.random.Generator, bytes], bytes]
_PIECES = (
    b"\x00", b"\xff", b"\xef\xbb\xbf", b"\xff\xfe", b"\n", b"\r", b"\t", b",", b";", b'"', b"=",
    b"[", b"]", b"{", b"}", b"nan", b"1e999", b"-", b"9" * 400, b"[" * 3000, b"#", b"\xc3\xa9",
    b"\n" + b"a." * 20_000 + b"a = 1\n",
)  # fmt: skip


def pick(rng: np.random.Generator, choices):
    """One of a sequence."""
    return choices[int(rng.integers(len(choices)))]


# --- bytes ---------------------------------------------------------------------------------------


def bytes_edit(rng: np.random.Generator, data: bytes) -> bytes:
    """Flip, cut, insert, repeat, move or empty."""
    how = rng.integers(8)
    if not data:
        return pick(rng, _PIECES)
    a, b = sorted(int(k) for k in rng.integers(0, len(data) + 1, 2))
    b = min(b, a + 4096) if how != 1 else b
    if how == 0:
        made = bytearray(data)
        for k in rng.integers(0, len(data), int(rng.integers(1, 9))):
            made[k] ^= 1 << int(rng.integers(8))
        return bytes(made)
    if how == 1:
        return data[:a] if rng.random() < 0.9 else b""
    if how == 2:
        return data[:a] + pick(rng, _PIECES) + data[a:]
    if how == 3:
        return data[:a] + data[b:]
    if how == 4:
        return data[:b] + data[a:b] + data[b:]
    if how == 5:
        return data[:a] + bytes(b - a) + data[b:]
    if how == 6:
        return data[:a] + rng.bytes(min(b - a, 64)) + data[a:]
    return data + data[: int(rng.integers(1, 200))]


# --- text ----------------------------------------------------------------------------------------

_CODES = ("utf-16", "utf-16-le", "utf-32", "cp1252", "latin-1", "cp037")


def changed_or_bytes(rng: np.random.Generator, data: bytes, change: Callable) -> bytes:
    """A file changed by its format; now and then, or where that cannot be, by other bytes."""
    if rng.random() < 0.35:
        return bytes_edit(rng, data)
    try:
        return change(rng, data)
    except Exception:  # broken by an earlier edit, or not to be written
        return bytes_edit(rng, data)


def text_edit(rng: np.random.Generator, data: bytes) -> bytes:
    """Lines left out, repeated, moved; words replaced; another encoding."""
    if rng.random() < 0.25:
        return bytes_edit(rng, data)
    lines = data.split(b"\n")
    k, how = int(rng.integers(len(lines))), rng.integers(7)
    if how == 0:
        return data.decode("utf-8", "replace").encode(pick(rng, _CODES), "replace")
    if how == 1:
        del lines[k]
    elif how == 2:
        lines.insert(k, lines[k])
    elif how == 3:
        lines.insert(k, lines.pop(int(rng.integers(len(lines)))))
    elif how == 4:
        lines = lines[:k]
    elif how == 5:
        lines[k] = b""
    else:
        lines[k] = _word(rng, lines[k])
    return b"\n".join(lines)


def _word(rng: np.random.Generator, line: bytes) -> bytes:
    """A line with one word or number replaced."""
    words = line.split(b" ")
    value = odd(rng)
    text = str(value) if isinstance(value, str | float) else json_text(value)
    words[int(rng.integers(len(words)))] = text.encode("utf-8", "replace")
    return b" ".join(words)


# --- trees of TOML and JSON ----------------------------------------------------------------------


def toml_edit(rng: np.random.Generator, data: bytes) -> bytes:
    """A TOML file with a value, a key or a section of it changed."""
    return _tree_file(rng, data, tomllib.loads, toml)


def json_edit(rng: np.random.Generator, data: bytes) -> bytes:
    """A JSON file with a value or a key of it changed."""
    return _tree_file(rng, data, json.loads, json_text)


def _tree_file(rng, data: bytes, read: Callable, write: Callable) -> bytes:
    if rng.random() < 0.15:
        return text_edit(rng, data)
    try:
        tree = read(data.decode("utf-8"))
        made = write(tree_edit(rng, tree))
    except (ValueError, RecursionError, AttributeError):
        return text_edit(rng, data)
    return made.encode("utf-8", "replace")


def tree_edit(rng: np.random.Generator, tree: Any) -> Any:
    """A copy of a tree with one node replaced, scaled, left out, renamed, moved or added."""
    tree = copy.deepcopy(tree)
    places = list(_places(tree))
    if not places:
        return odd(rng)
    numbers = [(h, k) for h, k in places if _is_number(h[k])]
    if numbers and rng.random() < 0.45:  # most of a tree may be text, which little depends on
        holder, key = pick(rng, numbers)
        holder[key] = scaled(rng, holder[key])
        return tree
    holder, key = _place(rng, places)
    value, how = holder[key], rng.random()
    if how < 0.45 and _is_number(value):
        holder[key] = scaled(rng, value)
    elif how < 0.60:
        holder[key] = odd(rng)
    elif how < 0.72:
        del holder[key]
    elif how < 0.80:
        _rename(rng, holder, key)
    elif how < 0.88:
        other, name = _place(rng, places)
        holder[key] = copy.deepcopy(other[name])
    elif how < 0.94:
        _add(rng, holder, value)
    else:
        holder[key] = pick(rng, ([value], {"value": value}, str(value)[:200], {key: value}))
    return tree


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _places(tree: Any, depth: int = 0):
    """Every mapping or list with each of its keys."""
    keys = tree if isinstance(tree, dict) else range(len(tree)) if isinstance(tree, list) else ()
    for key in list(keys):
        yield tree, key
        if depth < 40:
            yield from _places(tree[key], depth + 1)


def _place(rng: np.random.Generator, places: list) -> tuple[Any, Any]:
    """One of the places; half of them at the top, where whole sections are."""
    if rng.random() < 0.25:
        top = places[0][0]
        places = [place for place in places if place[0] is top]
    return pick(rng, places)


def _rename(rng: np.random.Generator, holder: Any, key: Any) -> None:
    if isinstance(holder, dict):
        name = str(key)
        holder[pick(rng, (name[:-1], name + "_", name.upper(), "", "\u00e9", name * 40))] = (
            holder.pop(key)
        )
    else:
        holder.reverse()


def _add(rng: np.random.Generator, holder: Any, value: Any) -> None:
    if isinstance(holder, dict):
        holder[pick(rng, ("value", "unit", "source", "extra", "base", "x" * 500))] = odd(rng)
    else:
        holder.extend([value] * int(rng.integers(1, 50)))


# --- tables of text ------------------------------------------------------------------------------

_CELLS = (
    "", " ", "nan", "inf", "-inf", "1e400", "1e-400", "-1", "0", "1,5", "1.5.5", "1e6",
    "-1e6", "abc", '"', '"a', "9" * 400, "0x10", "1 000", "true", "None",
    "\u00e9", "\x00", "=1+1", "x" * 2000, "1e300", "5e-324", "\u2212" "1",
)  # fmt: skip


def csv_edit(rng: np.random.Generator, data: bytes) -> bytes:
    """A table with a cell, row, column, heading or remark changed."""
    if rng.random() < 0.2:
        return text_edit(rng, data)
    lines = data.decode("utf-8", "replace").split("\n")
    body = [k for k, line in enumerate(lines) if line and not line.startswith("#")]
    if not body:
        return text_edit(rng, data)
    how, k = rng.random(), pick(rng, body)
    k = body[0] if how > 0.9 else k
    if how < 0.12:  # a remark: key and text
        heads = [j for j, line in enumerate(lines) if line.startswith("#")] or body
        j = pick(rng, heads)
        lines[j] = pick(rng, ("", lines[j] * 3, lines[j].partition(":")[0], "# " + "x" * 500))
    elif how < 0.2:
        lines.insert(k, lines[k])
    elif how < 0.3:
        _column(rng, lines, body)
    else:
        cells = lines[k].split(",")
        j = int(rng.integers(len(cells)))
        cells[j] = _cell(rng, cells[j])
        lines[k] = ",".join(cells)
    return "\n".join(lines).encode("utf-8", "replace")


def _cell(rng: np.random.Generator, cell: str) -> str:
    try:
        number = float(cell)
    except ValueError:
        return pick(rng, (*_CELLS, cell + " [furlong]", cell.partition("[")[0], cell[1:]))
    return str(scaled(rng, number)) if rng.random() < 0.5 else pick(rng, _CELLS)


def _column(rng: np.random.Generator, lines: list[str], body: list[int]) -> None:
    """Leave out or repeat a column, or set all its numbers to one."""
    width = len(lines[body[0]].split(","))
    j, how = int(rng.integers(width)), rng.integers(3)
    value = pick(rng, _CELLS[:12])
    for n, k in enumerate(body):
        cells = lines[k].split(",")
        if j >= len(cells):
            continue
        if how == 0:
            del cells[j]
        elif how == 1:
            cells.append(cells[j])
        elif n:
            cells[j] = value
        lines[k] = ",".join(cells)
