"""STEP and IGES files as triangles, by OpenCASCADE (cascadio), in a process of their own.

OpenCASCADE ends the process at about one damaged file of six (a hundred random edits of a good one
gave twenty crashes), so that a child reads the bytes: what happens to it is one line here.
"""

from __future__ import annotations

import importlib
import io
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np

from ship_gym.config import ConfigError, cut
from ship_gym.reading import read_bytes

_SECONDS = 300.0  # for one file
_CHORD = 1e-4  # a triangle leaves the surface by so much of the size at most
_ROUGH = 1e4  # [mm]
_ANGLE = 0.2  # [rad] between neighbours on a curved surface
_EXTRAS = {"cascadio": "cad"}  # of the others: bem
# OpenCASCADE talks on stdout: what was stdout is kept for the triangles.
_CHILD = """
import os, sys
out = os.dup(1)
os.dup2(2, 1)
import cascadio
kind, chord, angle = sys.argv[1], float(sys.argv[2]), float(sys.argv[3])
glb = cascadio.load(sys.stdin.buffer.read(), kind, tol_linear=chord, tol_angular=angle)
with os.fdopen(out, "wb") as file:
    file.write(glb)
"""


def library(name: str, path: Path) -> ModuleType:
    """A library that reads hull files, or one line that names the extra with it."""
    try:
        return importlib.import_module(name)
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
    library("cascadio", path)
    data = read_bytes(path)
    # cascadio gives IGES in mm and STEP in m, and takes the chord in mm of both
    unit = 0.001 if kind == "iges" else 1.0
    rough, _ = _triangles(path, data, kind, _ROUGH)  # for the size, which the chord goes by
    size = unit * float(np.ptp(rough, axis=0).max())
    vertices, triangles = _triangles(path, data, kind, 1000.0 * max(_CHORD * size, 1e-6))
    return vertices * unit, triangles


def _triangles(path: Path, data: bytes, kind: str, chord: float) -> tuple[np.ndarray, np.ndarray]:
    """Vertices in cascadio's unit and triangles within a chord [mm] of the surface."""
    trimesh = library("trimesh", path)
    command = [sys.executable, "-P", "-c", _CHILD, kind, repr(chord), repr(_ANGLE)]
    name = kind.upper()
    try:
        done = subprocess.run(command, input=data, capture_output=True, timeout=_SECONDS)
    except subprocess.TimeoutExpired:
        raise ConfigError(
            f"{path}: OpenCASCADE did not read it within {_SECONDS:g} s: damaged, or too fine"
        ) from None
    if done.returncode or not done.stdout:
        lines = [line for line in done.stderr.decode(errors="replace").splitlines() if "rr" in line]
        told = cut(" ".join(lines[0].split()), 120) if lines else "OpenCASCADE ended"
        raise ConfigError(f"{path}: not a {name} file with surfaces, or damaged: {told}")
    solid = trimesh.load_mesh(io.BytesIO(done.stdout), file_type="glb", process=False)
    return np.asarray(solid.vertices, dtype=float), np.asarray(solid.faces)
