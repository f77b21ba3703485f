"""A user's hull file as panels: read, turn, close, cut, check, coarsen.

Every step leaves a line in the mesh's report; what cannot be repaired safely is refused with the
option of ``ship-gym build-wave-table`` that helps. docs/hulls.md lists the formats.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np

from ship_gym.config import ConfigError, check_known, check_number, told_of
from ship_gym.seakeeping.hull_checks import (
    Placed,
    check_mesh,
    check_panels,
    check_place,
    still_open,
)
from ship_gym.seakeeping.hull_formats import CAD, read_faces
from ship_gym.seakeeping.hull_mesh import HullMesh, starboard_half, welded
from ship_gym.seakeeping.hull_repair import GAP, close_gaps, oriented
from ship_gym.seakeeping.hull_sections import coarsened
from ship_gym.seakeeping.hydrostatics import hydrostatics
from ship_gym.ships.files import Named
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Ship

_DIRECTIONS = {"+x": 0, "-x": 0, "+y": 1, "-y": 1, "+z": 2, "-z": 2}


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
    fix_normals: bool = False,
    weld: float | None = None,
    panels: int | None = 704,
) -> HullMesh:
    """Hull mesh of a ship from a user's file.

    Parameters
    ----------
    path : path-like
        Of a format in docs/hulls.md: panels of WAMIT, Nemoh, HydroStar, HAMS, surfaces as STL, OBJ
        and more, meshes of Gmsh, VTK and more, STEP, IGES. The surface may reach above the
        waterline; it is cut there.
    ship : Ship, or its name or file
        The mesh must have its length, draught and volume.
    scale : float
        Metres of this ship per unit of the file: 0.001 for millimetres, 59.407 for a full-scale
        ship from a file of its 1/59.407 model. STEP and IGES name their unit, which is obeyed:
        of them it is metres of this ship per metre.
    forward, up : str
        Axis of the file that points to the bow, and upwards: "+x", "-x", ... "-z".
    midship, waterline : float
        Forward coordinate of midship and height of the waterline in the file's axes, in metres
        after `scale`. The middle between the perpendiculars, not of the overall length.
    flip_normals : bool
        True if the file's normals point into the hull.
    fix_normals : bool
        Turn faces until neighbours agree and normals point out of the hull. Done without asking to
        STEP and IGES, whose surfaces have no side.
    weld : float, optional
        Gaps between faces up to this are closed [m]; default: 1e-4 of the length.
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
    if weld is not None:
        check_number("weld", weld, 0.0, 0.01 * ship.hull.L, "m")
    if panels is not None:
        panels = int(check_number("panels", panels, 40, 20000))
    placed = Placed(scale, forward, up, midship, waterline)
    vertices, faces, note = read_faces(path)
    points = _turned(vertices * scale, forward, up, midship, waterline)
    faces = faces[:, ::-1] if flip_normals else faces
    fix_normals = fix_normals or path.suffix.lower() in CAD
    with told_of(path):
        check_place(points, ship, str(path), placed)
        points, faces, closed = _closed(points, faces, weld)
        mesh = _under_water(points, faces, fix_normals, (note, *closed))
        check_mesh(mesh, ship, str(path), placed)
        mesh = mesh.with_report(*still_open(mesh))
        if panels is None:
            check_panels(mesh, str(path))
            return starboard_half(mesh)
        coarse = coarsened(mesh, panels)
        check_mesh(coarse, ship, f"{path} with {coarse.count} panels", placed)
        return coarse


def _closed(
    points: np.ndarray, faces: np.ndarray, weld: float | None
) -> tuple[np.ndarray, np.ndarray, tuple[str, ...]]:
    """The surface with its gaps closed, as it came where there are none, and what was done."""
    whole = welded(points, faces, symmetric=False)
    gap = GAP * whole.length if weld is None else weld
    vertices, panels, count = close_gaps(whole.vertices, whole.panels, gap)
    if not count:
        return points, faces, ()
    return vertices, panels, (f"closed {count} open edges with gaps of at most {gap:.3g} m",)


def _under_water(
    points: np.ndarray, faces: np.ndarray, fix_normals: bool, report: tuple[str, ...]
) -> HullMesh:
    """Both sides of the hull below its waterline, with what was done in its report."""
    if one_side := _one_side(points):
        report = (report[0] + ", one side, mirrored", *report[1:])
    half = welded(*cut(points, faces), symmetric=one_side)
    if fix_normals:
        panels, turned = oriented(half.vertices, half.panels)
        half = dataclasses.replace(half, panels=panels)
        report = (*report, f"turned {turned} of {len(panels)} panels outward")
    mesh = half.both_sides()
    found = hydrostatics(mesh)
    return mesh.with_report(
        *report,
        f"cut at the waterline: {mesh.count} panels below, volume {found.volume:.6g} m3, "
        f"wetted surface {found.S:.6g} m2",
    )


def _one_side(points: np.ndarray) -> bool:
    """True if the file holds one half of the hull only."""
    tolerance = 1e-4 * np.ptp(points[:, 0])
    return bool(points[:, 1].min() > -tolerance or points[:, 1].max() < tolerance)


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
