"""STEP and IGES files as triangles, by OpenCASCADE (cascadio), in a process of their own.

OpenCASCADE ends the process at about one damaged file of six (a hundred random edits of a good one
gave twenty crashes), so that a child reads the bytes: what happens to it is one line here.
"""

from __future__ import annotations

import importlib
import io
import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

import numpy as np

from ship_gym.config import ConfigError, cut
from ship_gym.reading import read_bytes
from ship_gym.seakeeping._capytaine import capytaine

_SECONDS = 300.0  # for one file
_MEMORY = 8 << 30  # [bytes] of the child
_CHORD = 1e-4  # a triangle leaves the surface by so much of the size at most
_ROUGH = 1e4  # [mm]
_ANGLE = 0.2  # [rad] between neighbours on a curved surface
_COLOUR = re.compile("\x1b\\[[0-9;]*m")
_EXTRAS = {"cascadio": "cad"}  # of the others: bem
# OpenCASCADE talks on stdout: what was stdout is kept for the triangles. First roughly, for the
# size, which the chord goes by. It takes chords in mm; a GLB file says how far its points reach.
_CHILD = """
import json, os, sys
most = int(sys.argv.pop())
try:
    import resource
    resource.setrlimit(resource.RLIMIT_AS, (most, most))
except (ImportError, ValueError, OSError):  # not on this system
    pass
out = os.dup(1)
os.dup2(2, 1)
sys.modules["trimesh"] = None  # is not needed here and takes long
import cascadio
kind, unit, chord, rough, angle = sys.argv[1], *map(float, sys.argv[2:])
data = sys.stdin.buffer.read()
glb = cascadio.load(data, kind, tol_linear=rough, tol_angular=angle)
reach = ()
if glb:
    head = json.loads(glb[20 : 20 + int.from_bytes(glb[12:16], "little")])
    reach = [(a["min"], a["max"]) for a in head["accessors"] if len(a.get("min", ())) == 3]
if reach:
    size = max(max(r[1][i] for r in reach) - min(r[0][i] for r in reach) for i in range(3))
    tolerance = max(chord * size * unit, 1e-3)
    glb = cascadio.load(data, kind, tol_linear=tolerance, tol_angular=angle)
with os.fdopen(out, "wb") as file:
    file.write(glb if reach else b"")
"""


def library(name: str, path: Path) -> ModuleType:
    """A library that reads hull files, or one line that names the extra with it."""
    try:
        return capytaine() if name == "capytaine" else importlib.import_module(name)
    except ImportError as error:
        extra = _EXTRAS.get(name, "bem")
        raise ConfigError(
            f'{path}: {error}; install the extra: pip install "ship-gym[{extra}]"'
        ) from None


def read_cad(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Triangles of all faces of a STEP or IGES file.

    Returns
    -------
    vertices : numpy.ndarray, shape (V, 3)
        In metres, whatever unit the file is in, and in the file's axes.
    triangles : numpy.ndarray, shape (P, 3)
        Each face by itself: along their edges faces share points, but not vertices.

    Raises
    ------
    ConfigError
        No surface in it, damaged, or a missing library.
    """
    kind = "iges" if path.suffix.lower() in (".igs", ".iges") else "step"
    trimesh = library("trimesh", path)
    if find_spec("cascadio") is None:
        library("cascadio", path)
    unit = 1.0 if kind == "iges" else 1000.0  # [mm]: cascadio gives IGES in mm, STEP in m
    numbers = (unit, _CHORD, _ROUGH, _ANGLE)
    command = [sys.executable, "-P", "-c", _CHILD, kind, *map(repr, numbers), str(_MEMORY)]
    try:
        done = subprocess.run(
            command, input=read_bytes(path), capture_output=True, timeout=_SECONDS
        )
    except subprocess.TimeoutExpired:
        raise ConfigError(
            f"{path}: OpenCASCADE did not read it within {_SECONDS:g} s: damaged, or too fine"
        ) from None
    if done.returncode or not done.stdout:
        lines = _COLOUR.sub("", done.stderr.decode(errors="replace")).splitlines()
        errors = [" ".join(line.split()).strip("* ") for line in lines if "Err" in line.title()]
        told = cut(errors[0], 120) if errors else "OpenCASCADE ended"
        raise ConfigError(f"{path}: no {kind.upper()} file with surfaces, or damaged: {told}")
    solid = trimesh.load_mesh(io.BytesIO(done.stdout), file_type="glb", process=False)
    return np.asarray(solid.vertices, dtype=float) * (1e-3 * unit), np.asarray(solid.faces)
