"""The smallest case of a kind of finding, and how it differs from a good input."""

from __future__ import annotations

import dataclasses
import difflib
import io
import json
import time
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from _fuzz_binary import members_of
from _fuzz_formats import Case, case, good
from _fuzz_judge import judged

_SECONDS = 6.0  # for the search of one smallest case
_LINES = (".toml", ".csv", ".json", ".geojson", ".obj", ".gdf", ".off", ".ply", ".stl", ".words")
_SHOWN = 6  # differences


def smallest(seed: int, number: int, kind: str, folder: Path) -> tuple[Case, list[str]]:
    """The smallest input of the same kind of finding that a few seconds find.

    First as few edits as possible, then as few lines.

    Returns
    -------
    case : Case
    differences : list of str
        From the good input it was made of.
    """
    end, count = time.monotonic() + _SECONDS, 0

    def same(one: Case) -> bool:
        nonlocal count
        count += 1
        return judged(one, folder / f"m{number}_{count}").kind == kind

    found = case(seed, number)
    found = _fewer_edits(seed, found, same)
    told = differences(found)
    for name in found.files:
        if name.endswith(_LINES) and b"\0" not in found.files[name]:
            found = _fewer_lines(found, name, same, end)
    return found, told


def _fewer_edits(seed: int, found: Case, same: Callable[[Case], bool]) -> Case:
    edits = [j for j, _ in found.edits]
    tries = [(j,) for j in edits] + [tuple(k for k in edits if k != j) for j in edits]
    for kept in tries if len(edits) > 1 else []:
        made = case(seed, found.number, kept)
        if same(made):
            return _fewer_edits(seed, made, same) if len(kept) > 1 else made
    return found


def _fewer_lines(found: Case, name: str, same: Callable[[Case], bool], end: float) -> Case:
    """Leave out blocks of lines, smaller and smaller ones, while the kind stays."""
    lines = found.files[name].split(b"\n")
    size = len(lines) // 2
    while size and time.monotonic() < end:
        at = 0
        while at < len(lines) and time.monotonic() < end:
            fewer = lines[:at] + lines[at + size :]
            made = dataclasses.replace(found, files={**found.files, name: b"\n".join(fewer)})
            if fewer and same(made):
                lines, found = fewer, made
            else:
                at += size
        size //= 2
    return found


def differences(found: Case) -> list[str]:
    """How a case differs from the good input, a few lines."""
    before = next((s.files for s in good(found.kind) if s.name == found.seed), {})
    told = []
    for name, data in found.files.items():
        old = before.get(name, b"")
        if data != old:
            told += [f"{name}: {line}"[:300] for line in _differing(name, old, data)][:_SHOWN]
    return told


def _differing(name: str, old: bytes, new: bytes) -> Iterator[str]:
    try:
        trees = [_tree(name, data) for data in (old, new)]
    except (ValueError, RecursionError):
        trees = []
    if trees:
        a, b = (dict(_flat(tree)) for tree in trees)
        for key in {**a, **b}:
            if repr(a.get(key, _NONE)) != repr(b.get(key, _NONE)):
                yield f"{key}: {_text(a.get(key, _NONE))} -> {_text(b.get(key, _NONE))}"
    elif name.endswith(_LINES) and b"\0" not in new:
        pair = [data.decode("utf-8", "replace").splitlines() for data in (old, new)]
        for line in difflib.unified_diff(*pair, lineterm="", n=0):
            if not line.startswith(("---", "+++", "@@")):
                yield line[:160]
    else:
        same = next((i for i, (x, y) in enumerate(zip(old, new, strict=False)) if x != y), 0)
        yield f"{len(old)} -> {len(new)} bytes, first other byte {same}"
        yield from _members(name, old, new)


_NONE = object()


def _text(value: Any) -> str:
    from ship_gym.config import shown

    return "(none)" if value is _NONE else shown(value)


def _tree(name: str, data: bytes) -> Any:
    if name.endswith(".toml"):
        return tomllib.loads(data.decode())
    if name.endswith((".json", ".geojson")):
        return json.loads(data)
    raise ValueError


def _flat(tree: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    inner = (
        tree.items()
        if isinstance(tree, dict)
        else enumerate(tree)
        if isinstance(tree, list)
        else ()
    )
    if not isinstance(tree, dict | list) or not tree or path.count(".") > 30:
        yield path, tree
    else:
        for key, value in inner:
            yield from _flat(value, f"{path}.{key}" if path else str(key))


def _members(name: str, old: bytes, new: bytes) -> Iterator[str]:
    """Arrays of an npz file that differ."""
    if name.endswith((".npz", ".zip")):
        a, b = members_of(old), members_of(new)
        for key in {**a, **b}:
            if a.get(key) != b.get(key):
                yield f"{key}: {_array(a.get(key))} -> {_array(b.get(key))}"


def _array(data: bytes | None) -> str:
    if data is None:
        return "(none)"
    try:
        array = np.load(io.BytesIO(data), allow_pickle=False)
    except Exception:
        return f"{data[:80]!r}"
    if not isinstance(array, np.ndarray):
        return "another npz file"
    if array.dtype == np.uint8:
        return repr(array.tobytes()[:120])
    return f"{array.dtype} {array.shape} {array.ravel()[:3]}"
