"""Hull files to vertices and faces: which reader a file name asks for, and what holds of all.

Own reader: WAMIT (`hull_gdf`). By Capytaine: Nemoh, HydroStar, HAMS (`hull_panels`). By trimesh,
from the bytes alone: STL, OBJ, PLY, OFF, GLB. By meshio: the rest. By OpenCASCADE: STEP and IGES
(`hull_cad`). Libraries are imported when a file asks for them.
"""

from __future__ import annotations

import io
import re
import xml.parsers.expat
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ship_gym.config import ConfigError, shown
from ship_gym.reading import check_array, read_as, read_bytes, read_text
from ship_gym.seakeeping.hull_cad import library, read_cad
from ship_gym.seakeeping.hull_gdf import FAR, MOST_FACES, read_gdf
from ship_gym.seakeeping.hull_panels import read_panels

_TRIMESH = (".stl", ".obj", ".ply", ".off", ".glb")
CAD = (".step", ".stp", ".iges", ".igs")
_CAPYTAINE = {
    ".mar": "mar", ".nemoh": "mar", ".hst": "hst", ".hydrostar": "hst", ".pnl": "pnl",
    ".hams": "pnl",
}  # fmt: skip
_XML = (".vtu", ".xdmf", ".xmf", ".xml", ".svg")
_VOLUMES = (".ele", ".node", ".svg")  # tetrahedra (over which meshio may never end), a drawing
_ELSEWHERE = re.compile(rb"Format\s*=\s*[\"'](HDF|Binary)[\"']")  # numbers in a file beside it
# Cells of meshio that are faces, with their corners; nodes between the corners are left out.
_FACES = {"triangle": 3, "triangle6": 3, "triangle7": 3, "quad": 4, "quad8": 4, "quad9": 4}
_CORNER = re.compile(
    r"-?[1-9][0-9]*(/-?[0-9]*)?(/-?[0-9]*)?"
)  # of an OBJ face: vertex/texture/normal
_NEMOH = re.compile(r"\s*[0-9]+\s+[01]\s*(\n|$)")  # first line: 2, and 1 if mirrored in y = 0

Mesh = tuple[np.ndarray, np.ndarray]


def read_faces(path: Path) -> tuple[np.ndarray, np.ndarray, str]:
    """Vertices (V, 3) in the file's axes and unit, faces (P, 3 or 4), a line for the report.

    Raises
    ------
    ConfigError
        No such file, a format that is not read, a damaged file, a missing library.
    """
    try:
        with read_as(path, "a mesh"):
            vertices, faces = _reader(path)(path)
    except SystemExit as error:  # meshio's word for a file that it does not know
        raise ConfigError(f"{path}: not a mesh, or damaged: {error}") from None
    vertices, faces = _checked(path, vertices, faces)
    return vertices, faces, f"{path.name}: {len(faces)} faces"


def _reader(path: Path) -> Callable[[Path], Mesh]:
    """Who reads a file of this name."""
    kind = path.suffix.lower()
    if kind == ".gdf":
        return read_gdf
    if kind in _CAPYTAINE or (kind == ".dat" and _of_nemoh(path)):
        return lambda file: read_panels(file, _CAPYTAINE.get(kind, "mar"))
    if kind in CAD:
        return read_cad
    return _read_trimesh if kind in _TRIMESH else _read_meshio


def _of_nemoh(path: Path) -> bool:
    """Nemoh's meshes and Tecplot's tables are both called .dat."""
    return _NEMOH.match(read_text(path, fallback="latin-1")) is not None


def _checked(path: Path, vertices: object, faces: object) -> Mesh:
    """Vertices that are finite and faces between them, whatever a library has made of a file."""
    vertices, faces = np.asarray(vertices), np.asarray(faces)
    if len(faces) == 0:
        raise ConfigError(f"{path}: holds no faces")
    if len(faces) > MOST_FACES:
        raise ConfigError(f"{path}: {len(faces)} faces: allowed are at most {MOST_FACES}")
    check_array(f"{path}: vertices", vertices, (None, 3), -FAR, FAR)
    if faces.ndim != 2 or faces.shape[1] not in (3, 4):
        raise ConfigError(f"{path}: faces of shape {faces.shape}: allowed are 3 or 4 corners")
    last = len(vertices) - 1
    check_array(f"{path}: corners of faces", faces, faces.shape, 0, last, "number of a vertex")
    return vertices.astype(float), faces.astype(np.int64)


def _read_trimesh(path: Path) -> Mesh:
    """From the bytes alone: materials and pictures that a file names are not looked for."""
    trimesh = library("trimesh", path)
    data, kind = read_bytes(path), path.suffix.lower()
    if kind == ".obj":
        _check_obj(path)
    if kind == ".ply" and b"\nformat binary" in data[:200]:
        return _read_meshio(path)  # trimesh refuses triangles beside quadrilaterals in it
    # without its processing, which leaves out vertices that are not finite
    solid = trimesh.load_mesh(io.BytesIO(data), file_type=kind[1:], process=False)
    vertices, faces = _checked(path, solid.vertices, solid.faces)
    solid = trimesh.Trimesh(vertices, faces, process=True)
    return solid.vertices, solid.faces


def _check_obj(path: Path) -> None:
    """Refuse a line of a vertex or a face that is damaged; the library passes over some."""
    for number, line in enumerate(read_text(path, fallback="latin-1").splitlines(), 1):
        word, *values = line.partition("#")[0].split() or [""]
        if word == "v":
            try:
                whole = len([float(value) for value in values]) >= 3
            except ValueError:
                whole = False
        elif word == "f":
            whole = len(values) >= 3 and all(_CORNER.fullmatch(value) for value in values)
        else:
            continue
        if not whole:
            raise ConfigError(
                f"{path}:{number}: {shown(line)}: needed are three numbers of a vertex (v), or "
                "three or more corners of a face (f)"
            )


def _read_meshio(path: Path) -> Mesh:
    kind = path.suffix.lower()
    if kind in _VOLUMES:
        raise ConfigError(f"{path}: {kind} holds no surface in space: allowed are .msh, .vtk, .stl")
    meshio = library("meshio", path)
    if kind not in meshio.extension_to_filetypes:
        known = ", ".join((".gdf", *_CAPYTAINE, *_TRIMESH, *CAD))
        raise ConfigError(
            f"{path}: suffix {shown(kind)}: allowed are {known}, .msh, .vtk, .vtu, .inp, .dat and "
            "what else docs/hulls.md lists"
        )
    data = read_bytes(path)  # a regular file of a size that can be read
    if kind in _XML:
        _check_xml(path, data)
    mesh = meshio.read(path)
    found = [(mesh.cells_dict[kind], n) for kind, n in _FACES.items() if kind in mesh.cells_dict]
    if not found:
        there = ", ".join(mesh.cells_dict) or "no cells"
        raise ConfigError(f"{path}: holds {there}: allowed are triangles and quadrilaterals")
    four = [faces[:, [0, 1, 2, 3] if n == 4 else [0, 1, 2, 2]] for faces, n in found]
    points = np.asarray(mesh.points)
    if points.ndim == 2 and points.shape[1] == 2:
        raise ConfigError(f"{path}: a plane drawing: needed are three coordinates of a vertex")
    return points, np.concatenate(four)


def _check_xml(path: Path, data: bytes) -> None:
    """Refuse a document type, the only place of entities, and numbers that lie elsewhere."""
    parser = xml.parsers.expat.ParserCreate()

    def refused(*_: object) -> None:
        raise ConfigError(
            f"{path}:{parser.CurrentLineNumber}: holds a DOCTYPE: allowed is XML without document "
            "type and entities"
        )

    parser.StartDoctypeDeclHandler = refused
    head = data.partition(b"<AppendedData")[0]  # behind it a VTU file may hold raw bytes
    try:
        parser.Parse(head, True)
    except xml.parsers.expat.ExpatError as error:
        if len(head) == len(data):
            raise ConfigError(f"{path}: not XML, or damaged: {error}") from None
    if (elsewhere := _ELSEWHERE.search(data)) and path.suffix.lower() in (".xdmf", ".xmf"):
        raise ConfigError(
            f"{path}: its numbers lie in another file ({elsewhere[0].decode()}): allowed is "
            'Format="XML"; or write it as .vtk or .vtu'
        )
