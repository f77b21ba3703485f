"""A user's hull file (STL, OBJ, GDF and more) as panels: read, turn, cut, check, coarsen.

Every step leaves a line in the mesh's report; what cannot be repaired safely is refused with a
hint.
"""

from __future__ import annotations

import importlib
import io
import re
from pathlib import Path
from types import ModuleType

import numpy as np

from ship_gym.config import ConfigError, check_known, check_number, shown, told_of
from ship_gym.reading import check_array, read_as, read_bytes, read_text
from ship_gym.seakeeping.hull_checks import check_mesh, check_panels, check_place
from ship_gym.seakeeping.hull_mesh import HullMesh, starboard_half, welded
from ship_gym.seakeeping.hull_sections import coarsened
from ship_gym.seakeeping.hydrostatics import hydrostatics
from ship_gym.ships.files import Named
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Ship

_DIRECTIONS = {"+x": 0, "-x": 0, "+y": 1, "-y": 1, "+z": 2, "-z": 2}
_TRIMESH = (".stl", ".obj", ".ply", ".off")
_MOST_FACES = 2_000_000
_FAR = 1e9  # of a vertex from the origin, in the unit of the file
_CORNER = re.compile(r"-?[0-9]+(/-?[0-9]*)?(/-?[0-9]*)?")  # of an OBJ face: vertex/texture/normal
_GDF = (
    "a low-order GDF file (a title, ULEN GRAV, ISX ISY, the number of panels and four corners of "
    "three numbers for each)"
)


def read_hull(
    path: str | Path,
    ship: Named | Ship,
    *,
    scale: float = 1.0,
    forward: str = "+x",
    up: str = "+z",
    midship: float = 0.0,
    waterline: float = 0.0,
    flip_normals: bool = False,
    panels: int | None = 704,
) -> HullMesh:
    """Hull mesh of a ship from a user's file.

    Parameters
    ----------
    path : path-like
        ``.stl``, ``.obj``, ``.ply``, ``.off`` (trimesh), ``.gdf`` (WAMIT), or what meshio reads.
        The surface may reach above the waterline; it is cut there.
    ship : Ship, or its name or file
        The mesh must have its length, draught and volume.
    scale : float
        Metres of this ship per unit of the file: 0.001 for millimetres, 59.407 for a full-scale
        ship from a file of its 1/59.407 model.
    forward, up : str
        Axis of the file that points to the bow, and upwards: "+x", "-x", ... "-z".
    midship, waterline : float
        Forward coordinate of midship and height of the waterline in the file's axes, in metres
        after `scale`. The middle between the perpendiculars, not of the overall length.
    flip_normals : bool
        True if the file's normals point into the hull.
    panels : int or None
        Number of panels wanted for both sides; None keeps the file's own, which then must be alike
        on both sides and not cross the centre plane.

    Returns
    -------
    HullMesh
        Starboard half, watertight below z = 0, normals outward. `report` says what was done. A
        file that holds one side only is mirrored.

    Raises
    ------
    ConfigError
        Missing or unreadable file; not watertight; inverted normals; degenerate panels; length,
        draught or volume that are not the ship's, with what to change.
    """
    path, ship = Path(path), load_ship(ship)
    check_number("scale", scale, 1e-9, 1e9)
    if panels is not None:
        panels = int(check_number("panels", panels, 40, 20000))
    vertices, faces, note = _read(path)
    points = _turned(vertices * scale, forward, up, midship, waterline)
    faces = faces[:, ::-1] if flip_normals else faces
    with told_of(path):
        mesh = _under_water(points, faces, ship, note, path)
        if panels is None:
            check_panels(mesh, str(path))
            return starboard_half(mesh)
        coarse = coarsened(mesh, panels)
        check_mesh(coarse, ship, f"{path} with {coarse.count} panels")
        return coarse


def _under_water(
    points: np.ndarray, faces: np.ndarray, ship: Ship, note: str, path: Path
) -> HullMesh:
    """Both sides of the hull below its waterline, checked, with what was done in its report."""
    check_place(points, ship, str(path))
    if one_side := _one_side(points):
        note += ", one side, mirrored"
    mesh = welded(*cut(points, faces), symmetric=one_side).both_sides()
    check_mesh(mesh, ship, str(path))
    found = hydrostatics(mesh)
    return mesh.with_report(
        note,
        f"cut at the waterline: {mesh.count} panels below, volume {found.volume:.6g} m3, "
        f"wetted surface {found.S:.6g} m2",
    )


def _one_side(points: np.ndarray) -> bool:
    """True if the file holds one half of the hull only."""
    tolerance = 1e-4 * np.ptp(points[:, 0])
    return bool(points[:, 1].min() > -tolerance or points[:, 1].max() < tolerance)


def _read(path: Path) -> tuple[np.ndarray, np.ndarray, str]:
    """Vertices (V, 3), triangles or quadrilaterals (P, 3 or 4), and a line for the report."""
    kind = path.suffix.lower()
    try:
        with read_as(path, "a mesh"):
            if kind == ".gdf":
                vertices, faces = read_gdf(path)
            else:
                vertices, faces = (_read_trimesh if kind in _TRIMESH else _read_meshio)(path)
    except SystemExit as error:  # meshio's word for a file that it does not know
        raise ConfigError(f"{path}: not a mesh, or damaged: {error}") from None
    vertices, faces = _checked(path, vertices, faces)
    return vertices, faces, f"{path.name}: {len(faces)} faces"


def _checked(path: Path, vertices: object, faces: object) -> tuple[np.ndarray, np.ndarray]:
    """Vertices that are finite and faces between them, whatever a library has made of a file."""
    vertices, faces = np.asarray(vertices), np.asarray(faces)
    if len(faces) == 0:
        raise ConfigError(f"{path}: holds no faces")
    if len(faces) > _MOST_FACES:
        raise ConfigError(f"{path}: {len(faces)} faces: allowed are at most {_MOST_FACES}")
    check_array(f"{path}: vertices", vertices, (None, 3), -_FAR, _FAR)
    if faces.ndim != 2 or faces.shape[1] not in (3, 4):
        raise ConfigError(f"{path}: faces of shape {faces.shape}: allowed are 3 or 4 corners")
    last = len(vertices) - 1
    check_array(f"{path}: corners of faces", faces, faces.shape, 0, last, "number of a vertex")
    return vertices.astype(float), faces.astype(np.int64)


def _read_trimesh(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """From the bytes alone: materials and pictures that a file names are not looked for."""
    trimesh = _library("trimesh", path)
    data, kind = read_bytes(path), path.suffix.lower()
    if kind == ".obj":
        _check_obj(path)
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


def _library(name: str, path: Path) -> ModuleType:
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ConfigError(
            f"{path}: {error}; install the extra: pip install ship-gym[bem]"
        ) from None


def _read_meshio(path: Path) -> tuple[np.ndarray, np.ndarray]:
    meshio = _library("meshio", path)
    read_bytes(path)  # a regular file of a size that can be read
    mesh = meshio.read(path)
    found = [mesh.cells_dict[kind] for kind in ("triangle", "quad") if kind in mesh.cells_dict]
    if not found:
        raise ConfigError(f"{path}: holds no triangles or quadrilaterals")
    four = [faces if faces.shape[1] == 4 else faces[:, [0, 1, 2, 2]] for faces in found]
    return mesh.points, np.concatenate(four)


def read_gdf(path: str | Path) -> tuple[np.ndarray, np.ndarray]:
    """Panels of a WAMIT low-order GDF file, its symmetries unfolded.

    Returns
    -------
    vertices : numpy.ndarray, shape (4 P, 3)
        In the file's axes and units (x forward, y to port, z up; ULEN is not applied).
    panels : numpy.ndarray, shape (P, 4)
        Anticlockwise seen from the water, so normals point out of the hull.

    Raises
    ------
    ConfigError
        Too few numbers, or a higher-order file.
    """
    lines = read_text(path, fallback="latin-1").splitlines()
    with read_as(path, _GDF):
        ISX, ISY = (int(float(word)) for word in lines[2].split()[:2])
        count = int(float(lines[3].split()[0]))
        if not 0 < count <= _MOST_FACES:
            raise ValueError(f"{count} panels: allowed are 1 to {_MOST_FACES}")
        numbers = np.array(" ".join(lines[4:]).replace(",", " ").split()[: 12 * count], dtype=float)
        corners = numbers.reshape(count, 4, 3)
    check_array(f"{path}: corners", corners, corners.shape, -_FAR, _FAR)
    for axis, wanted in enumerate((ISX, ISY)):
        if wanted:
            mirrored = corners[:, ::-1] * np.where(np.arange(3) == axis, -1.0, 1.0)
            corners = np.concatenate([corners, mirrored])
    return corners.reshape(-1, 3), np.arange(4 * len(corners)).reshape(-1, 4)


def _turned(
    points: np.ndarray, forward: str, up: str, midship: float, waterline: float
) -> np.ndarray:
    """Points in ship axes, z down, from the file's axes."""
    for name, value in (("forward", forward), ("up", up)):
        check_known(f"direction {name}", value, _DIRECTIONS)
    if _DIRECTIONS[forward] == _DIRECTIONS[up]:
        raise ConfigError(f"forward = {forward!r}, up = {up!r}: must be two different axes")
    f, u = (np.zeros(3), np.zeros(3))
    f[_DIRECTIONS[forward]] = 1.0 if forward[0] == "+" else -1.0
    u[_DIRECTIONS[up]] = 1.0 if up[0] == "+" else -1.0
    turned = points @ np.stack([f, np.cross(f, u), -u], axis=1)
    return turned + np.array([-midship, 0.0, waterline])


def cut(points: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Part of a surface below z = 0 (z down).

    Parameters
    ----------
    points : numpy.ndarray, shape (V, 3)
        Ship axes [m].
    faces : numpy.ndarray, shape (P, 3) or (P, 4)
        Vertex indices; those wholly under water are kept as they are.

    Returns
    -------
    points, faces : numpy.ndarray
        Shapes (W, 3) and (Q, 4), a triangle repeating its last vertex. Faces in the plane z = 0
        itself (a lid) are dropped.
    """
    faces = faces[:, [0, 1, 2, 2]] if faces.shape[1] == 3 else faces
    z = np.where(np.abs(points[:, 2]) < 1e-9 * np.ptp(points), 0.0, points[:, 2])
    points = np.stack([points[:, 0], points[:, 1], z], axis=-1)
    below = (z[faces] >= 0.0).all(axis=1) & (z[faces] > 0.0).any(axis=1)
    crossing = (z[faces] < 0.0).any(axis=1) & (z[faces] > 0.0).any(axis=1)
    split = faces[crossing]
    triangles = np.concatenate([split[:, :3], split[:, [0, 2, 3]]])
    triangles = triangles[triangles[:, 1] != triangles[:, 2]]
    parts = [part for corners in points[triangles] if len(part := _clipped(corners)) == 4]
    new = np.array(parts).reshape(-1, 3)
    index = len(points) + np.arange(len(new)).reshape(-1, 4)
    return np.concatenate([points, new]), np.concatenate([faces[below], index])


def _clipped(corners: np.ndarray) -> np.ndarray:
    """Part of one triangle (3, 3) below z = 0 as four corners; empty if there is none."""
    kept = []
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if a[2] >= 0.0:
            kept.append(a)
        if a[2] * b[2] < 0.0:
            low, high = (a, b) if a[2] < b[2] else (b, a)  # one order: neighbours agree exactly
            point = low + (high - low) * (low[2] / (low[2] - high[2]))
            kept.append(np.array([point[0], point[1], 0.0]))
    if len(kept) < 3 or max(p[2] for p in kept) == 0.0:
        return np.empty((0, 3))
    return np.array([*kept, kept[-1]] if len(kept) == 3 else kept)
