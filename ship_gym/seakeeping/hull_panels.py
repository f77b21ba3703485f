"""Panels of Nemoh (.mar, .dat), HydroStar (.hst) and HAMS (.pnl) by Capytaine's readers.

Capytaine says little about a damaged line, so that each line is looked at first and the odd one is
named. The text is handed over, not the file.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ship_gym.config import ConfigError, cut, shown
from ship_gym.reading import read_text
from ship_gym.seakeeping.hull_cad import library

_NAMES = {"mar": "Nemoh", "hst": "HydroStar", "pnl": "HAMS"}
Lines = list[tuple[int, list[str]]]  # number and words of each line


def read_panels(path: Path, kind: str) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (V, 3) and panels (P, 4), symmetries unfolded.

    Parameters
    ----------
    path : path-like
    kind : str
        "mar", "hst" or "pnl".

    Raises
    ------
    ConfigError
        A line that is not what it should be, with its number and what is allowed.
    """
    capytaine = library("capytaine", path)
    text = read_text(path, fallback="latin-1")
    lines = [(i, line.split()) for i, line in enumerate(text.splitlines(), 1)]
    {"mar": _check_mar, "hst": _check_hst, "pnl": _check_pnl}[kind](path, lines)
    mesh = capytaine.load_mesh(io.StringIO(_tidy(text, kind)), kind)
    mesh = mesh.merged() if hasattr(mesh, "merged") else mesh
    return np.asarray(mesh.vertices), np.asarray(mesh.faces)


def _tidy(text: str, kind: str) -> str:
    """Without empty lines, at which the reader of .mar ends with an error."""
    if kind != "mar":
        return text
    return "".join(f"{line}\n" for line in text.splitlines() if line.strip())


def _numbers(words: list[str], counts: tuple[int, ...], kind: type) -> bool:
    """True if these are numbers, as many as allowed."""
    try:
        return len(words) in counts and all(np.isfinite(kind(word)) for word in words)
    except (ValueError, OverflowError):
        return False


def _refused(path: Path, number: int, words: list[str], needed: str) -> ConfigError:
    line = shown(cut(" ".join(words), 60)) if words else "the file ends"
    return ConfigError(f"{path}:{number}: {line}: needed {needed}")


def _check_faces(path: Path, faces: Lines, first: int, count: int) -> None:
    """Corners, behind `first` other numbers, are numbers of vertices, from 1."""
    for number, words in faces:
        if not all(1 <= int(word) <= count for word in words[first:]):
            raise _refused(path, number, words, f"are corners of 1 to {count}, the vertices")


def _check_mar(path: Path, lines: Lines) -> None:
    rows = iter([line for line in lines if line[1]])
    number, words = next(rows, (1, []))
    if not _numbers(words[:2], (2,), int) or words[1] not in ("0", "1"):
        raise _refused(path, number, words, "are 2 and 0, or 2 and 1 of a hull mirrored in y = 0")
    last = lines[-1][0]
    needed = "a number and x, y, z of a vertex, or 0 0 0 0"
    vertices = _until_zero(path, rows, 4, float, needed, last)
    needed = "four corners of a panel, or 0 0 0 0 at the end"
    faces = _until_zero(path, rows, 4, int, needed, last)
    _check_faces(path, faces, 0, len(vertices))


def _until_zero(
    path: Path, rows: Iterator, count: int, kind: type, needed: str, last: int
) -> Lines:
    """Lines up to the one that starts with 0."""
    found: Lines = []
    for number, words in rows:
        if words[0] == "0":
            return found
        if not _numbers(words, (count,), kind):
            raise _refused(path, number, words, f"are {needed}")
        found.append((number, words))
    raise _refused(path, last, [], f"are {needed}")


def _check_hst(path: Path, lines: Lines) -> None:
    vertices, faces, where, first = [], [], "", 0
    for number, words in lines:
        word = words[0] if words else ""
        if word == "ENDFILE":
            break
        if word.startswith(("COORDINATES", "PANEL")):
            where = "vertex" if word.startswith("C") else "panel"
            first = 1 if where == "panel" and words[-1] == "1" else 0
            if where == "panel" and words[-1] not in ("0", "1"):
                raise _refused(path, number, words, "is PANEL TYPE 0 or PANEL TYPE 1")
        elif word.startswith(("ENDCOORDINATES", "ENDPANEL")):
            where = ""
        elif where == "vertex" and words:
            if not _numbers(words, (3, 4), float):
                raise _refused(path, number, words, "are x, y, z of a vertex, behind its number")
            vertices.append((number, words))
        elif where == "panel" and words:
            if not _numbers(words, (3 + first, 4 + first), int):
                raise _refused(path, number, words, "are three or four corners of a panel")
            faces.append((number, words))
        elif word == "SYMMETRY" and words[-1] not in ("0", "1", "2"):
            raise _refused(path, number, words, "is SYMMETRY 0, 1 or 2")
    if not vertices or not faces:
        missing = "PANEL TYPE" if vertices else "COORDINATES"
        raise ConfigError(f"{path}: not a HydroStar file: no section {missing} with lines in it")
    _check_faces(path, faces, first, len(vertices))


def _check_pnl(path: Path, lines: Lines) -> None:
    """Three lines of head, numbers, two lines, vertices, three lines, panels."""
    number, words = lines[3] if len(lines) > 3 else (4, [])
    if not _numbers(words, (4,), int) or min(int(word) for word in words) < 0:
        raise _refused(path, number, words, "are numbers of panels, vertices, x and y symmetry")
    panels, count = (int(word) for word in words[:2])
    if 6 + count + 3 + panels > len(lines):
        raise _refused(path, len(lines), [], f"are {count} vertices and {panels} panels")
    for number, words in lines[6 : 6 + count]:
        if not _numbers(words, (4,), float):
            raise _refused(path, number, words, "are a number and x, y, z of a vertex")
    faces = lines[9 + count : 9 + count + panels]
    for i, (number, words) in enumerate(faces, 1):
        if (
            not _numbers(words, (5, 6), int)
            or int(words[1]) != len(words) - 2
            or int(words[0]) != i
        ):
            raise _refused(path, number, words, f"are {i}, 3 or 4, and as many corners of a panel")
    _check_faces(path, faces, 2, count)
