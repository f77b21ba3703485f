"""Panels of a hull under water, in ship axes: the container, its geometry, its lid.

Ship axes as in ``ship_gym.conventions``: x forward, y to starboard, z down, origin midship at the
waterline [m]. Normals point out of the hull into the water. `capytaine_axes` is the flip to z up.
"""

from __future__ import annotations

import dataclasses
from functools import cached_property

import numpy as np

from ship_gym.config import ConfigError

_TURNING = 0.25  # weight of the turning beside the girth, see `divided`
WELD = 1e-6  # points closer than this share of the length are one vertex
_FLIP = np.array([1.0, -1.0, -1.0])  # half a turn about x, so windings stay as they are


@dataclasses.dataclass(frozen=True)
class HullMesh:
    """Panels of a hull below the waterline z = 0.

    Attributes
    ----------
    vertices : numpy.ndarray, float64, shape (V, 3)
        Points in ship axes [m].
    panels : numpy.ndarray, int64, shape (P, 4)
        Vertex indices; a triangle repeats its last one. Right-handed about the outward normal.
    symmetric : bool
        True: the panels are the starboard half (y >= 0) and y = 0 is a mirror.
    report : tuple of str
        How the mesh was made.
    """

    vertices: np.ndarray
    panels: np.ndarray
    symmetric: bool
    report: tuple[str, ...] = ()

    def __post_init__(self):
        if len(self.panels) == 0:
            raise ConfigError("hull mesh: no panel below the waterline")
        if not np.isfinite(self.vertices).all():
            raise ConfigError("hull mesh: a vertex is not finite")

    @property
    def count(self) -> int:
        """Number of panels of both sides together."""
        return len(self.panels) * (2 if self.symmetric else 1)

    @property
    def length(self) -> float:
        """Length of the part under water [m]."""
        return float(np.ptp(self.vertices[:, 0]))

    @property
    def triangles(self) -> np.ndarray:
        """Panels as triangles, int64, shape (2 P, 3); of a triangle the second one has no area."""
        return np.concatenate([self.panels[:, :3], self.panels[:, [0, 2, 3]]])

    @cached_property
    def area_vectors(self) -> np.ndarray:
        """Outward normal times area of every panel [m2], shape (P, 3)."""
        a, b, c, d = (self.vertices[self.panels[:, i]] for i in range(4))
        return 0.5 * np.cross(c - a, d - b)

    @property
    def areas(self) -> np.ndarray:
        """Area of every panel [m2], shape (P,)."""
        return np.linalg.norm(self.area_vectors, axis=1)

    def both_sides(self) -> HullMesh:
        """The same hull with the port half added, without symmetry."""
        if not self.symmetric:
            return self
        mirrored = self.vertices * np.array([1.0, -1.0, 1.0])
        port = self.panels[:, ::-1] + len(self.vertices)
        return welded(
            np.concatenate([self.vertices, mirrored]),
            np.concatenate([self.panels, port]),
            symmetric=False,
            report=self.report,
        )

    def with_report(self, *lines: str) -> HullMesh:
        """The same mesh with more lines in its report."""
        return dataclasses.replace(self, report=(*self.report, *lines))


def welded(
    vertices: np.ndarray, panels: np.ndarray, symmetric: bool, report: tuple[str, ...] = ()
) -> HullMesh:
    """Mesh with equal points merged and collapsed panels dropped.

    Parameters
    ----------
    vertices : numpy.ndarray, shape (V, 3)
        Points in ship axes [m]; those nearer than 1e-6 of the length become one.
    panels : numpy.ndarray, shape (P, 3) or (P, 4)
        Vertex indices.
    symmetric, report
        As in `HullMesh`; of a symmetric one panels in the centre plane are dropped too.
    """
    length = max(float(np.ptp(vertices, axis=0).max()), 1e-9) if len(vertices) else 1.0
    keys = np.round(vertices / (WELD * length)).astype(np.int64)
    _, first, index = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    corners = index.reshape(-1)[panels]
    if corners.shape[1] == 3:
        corners = corners[:, [0, 1, 2, 2]]
    corners = _compressed(corners)
    points = vertices[first] + 0.0
    points[np.abs(points[:, 2]) < WELD * length, 2] = 0.0
    if symmetric:  # what folds into the centre plane is no surface
        points[np.abs(points[:, 1]) < WELD * length, 1] = 0.0
        corners = corners[(points[corners, 1] != 0.0).any(axis=1)]
    used, panels = np.unique(corners, return_inverse=True)
    return HullMesh(points[used], panels.reshape(-1, 4), symmetric, report)


def _compressed(corners: np.ndarray) -> np.ndarray:
    """Quadrilaterals with one side collapsed become triangles; lines and folds vanish."""
    repeated = corners == np.roll(corners, -1, axis=1)  # corner i equals the next one
    start = np.where(repeated.any(axis=1), np.argmax(repeated, axis=1) + 2, 0)
    order = (start[:, None] + np.arange(4)) % 4  # the equal pair comes last
    a, b, c, d = np.take_along_axis(corners, order, axis=1).T
    keep = (a != b) & (b != c) & (a != c) & (a != d) & (b != d)
    return np.stack([a, b, c, d], axis=1)[keep]


def starboard_half(mesh: HullMesh) -> HullMesh:
    """The panels y >= 0 of a mesh of both sides, as the half of a symmetric one.

    Raises
    ------
    ConfigError
        A panel crosses the centre plane, or the two sides differ.
    """
    if mesh.symmetric:
        return mesh
    tolerance = 10.0 * WELD * mesh.length
    y = mesh.vertices[mesh.panels][..., 1]
    starboard, port = (y >= -tolerance).all(axis=1), (y <= tolerance).all(axis=1)
    sums = [mesh.area_vectors[side].sum(axis=0) for side in (starboard, port)]
    uneven = np.abs(sums[0] * np.array([1.0, -1.0, 1.0]) - sums[1]).max()
    if not (starboard | port).all() or uneven > 1e-3 * mesh.areas.sum():
        raise ConfigError(
            "hull mesh: the panels are not alike on both sides or cross the centre plane: mirror "
            "one half, or let the mesh be coarsened"
        )
    return welded(mesh.vertices, mesh.panels[starboard & ~port], True, mesh.report)


def mesh_from_sections(
    sections: np.ndarray, report: tuple[str, ...] = (), closed: bool = True
) -> HullMesh:
    """Starboard half from the points of its sections.

    Parameters
    ----------
    sections : numpy.ndarray, shape (S, G, 3)
        Points [m] of each section from the keel round to the waterline, y >= 0, sections from aft
        forward.
    report : tuple of str
        As in `HullMesh`.
    closed : bool
        Close a first or last section that has area (a transom) by panels.
    """
    s, g = sections.shape[:2]
    index = np.arange(s * g).reshape(s, g)
    skin = [index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]]
    points, panels = [sections.reshape(-1, 3)], [np.stack(skin, axis=-1).reshape(-1, 4)]
    for row in (index[0], index[-1]) if closed else ():
        centre = sections.reshape(-1, 3)[row] * np.array([1.0, 0.0, 1.0])
        middle = np.arange(g) + sum(len(p) for p in points)
        cap = np.stack([row[:-1], row[1:], middle[1:], middle[:-1]], axis=-1)
        points.append(centre)
        panels.append(cap if row[0] == 0 else cap[:, ::-1])
    return welded(np.concatenate(points), np.concatenate(panels), True, report)


def divided(points: np.ndarray, count: int) -> np.ndarray:
    """A section (N, 2) as `count` pieces, shape (count + 1, 2), its ends kept.

    The pieces have equal shares of girth plus a quarter of the turning, so that a bilge of small
    radius keeps its area: without it the volume of a container ship comes out 0.2 % smaller. The
    turning is that of four steps per piece, so that no sharp corner draws all pieces to itself.
    """
    girth = _shares(np.linalg.norm(np.diff(points, axis=0), axis=1))
    even = np.linspace(0.0, 1.0, 4 * count + 1)
    steps = np.diff(_at(points, girth, even), axis=0)
    bend = np.abs(np.diff(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))))
    turning = _shares(0.5 * (np.append(bend, 0.0) + np.append(0.0, bend)))
    measure = even + _TURNING * turning
    new = _at(points, girth, np.interp(np.linspace(0.0, measure[-1], count + 1), measure, even))
    new[0], new[-1] = points[0], points[-1]  # to the last digit
    return new


def _at(points: np.ndarray, girth: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Points of a polyline at shares of its girth."""
    return np.stack([np.interp(share, girth, column) for column in points.T], axis=-1)


def _shares(parts: np.ndarray) -> np.ndarray:
    """Running sum from 0 to 1; all zero if the parts are."""
    total = np.concatenate([[0.0], np.cumsum(parts)])
    return total / total[-1] if total[-1] > 0.0 else total


def boundary_edges(mesh: HullMesh) -> np.ndarray:
    """Edges that belong to one panel only, shape (E, 2), in the direction of that panel."""
    edges = panel_edges(mesh)
    keys = edges.min(axis=1) * len(mesh.vertices) + edges.max(axis=1)
    _, index, count = np.unique(keys, return_inverse=True, return_counts=True)
    return edges[count[index] == 1]


def panel_edges(mesh: HullMesh) -> np.ndarray:
    """All edges of all panels, shape (E, 2), in the direction of their panel."""
    edges = np.concatenate([mesh.panels[:, [i, (i + 1) % 4]] for i in range(4)])
    return edges[edges[:, 0] != edges[:, 1]]


def waterline(mesh: HullMesh) -> np.ndarray:
    """Points of the starboard waterline from aft forward, shape (W, 2): x, y >= 0 [m].

    Raises
    ------
    ConfigError
        The mesh has no edges at the waterline.
    """
    tolerance = 10.0 * WELD * mesh.length
    ends = mesh.vertices[np.unique(boundary_edges(mesh))]
    ends = ends[(np.abs(ends[:, 2]) < tolerance) & (ends[:, 1] > -tolerance)]
    if len(ends) < 3:
        raise ConfigError("hull mesh: no edges at the waterline z = 0; is it cut there?")
    ends = ends[np.argsort(ends[:, 0])]
    groups = np.split(ends[:, :2], np.nonzero(np.diff(ends[:, 0]) > tolerance)[0] + 1)
    # of a transom only the outer corner counts
    return np.array([group[np.argmax(group[:, 1])] for group in groups])


def lid(mesh: HullMesh, strips: int = 2) -> HullMesh:
    """Panels at exactly z = 0 inside the waterline, which remove the irregular frequencies.

    Parameters
    ----------
    mesh : HullMesh
        Hull whose waterline is one curve on each side.
    strips : int
        Rows of panels on each side of the centreline.

    Returns
    -------
    HullMesh
        Of the same symmetry; normals point down, into the hull, as Capytaine wants them.
    """
    x, y = waterline(mesh).T
    share = np.linspace(0.0, 1.0, strips + 1)
    rows = np.stack(np.broadcast_arrays(x[:, None], y[:, None] * share, 0.0), axis=-1)
    text = f"lid of {strips} strips per side at z = 0"
    half = mesh_from_sections(rows, (text,), closed=False)
    return half if mesh.symmetric else half.both_sides()


def capytaine_axes(mesh: HullMesh) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (V, 3) [m] with y to port and z up, and panels (P, 4), normals into the water.

    A triangle repeats its last vertex, as in Capytaine. The starboard half lies at y <= 0.
    """
    return mesh.vertices * _FLIP + 0.0, mesh.panels
