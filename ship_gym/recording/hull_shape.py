"""A simple ship-like shape from L, B and d, for pictures only; no physics uses it.

Body axes as in ``ship_gym.conventions``: x forward, y to starboard, z down, origin midship at the
waterline. Triangles wind so that ``cross(v1 - v0, v2 - v0)`` points out of the solid.
"""

from __future__ import annotations

import numpy as np

from ship_gym.tables import smoothstep

FREEBOARD = 0.65  # height of the deck above the waterline, amidships [d]
BOW_SHEER = 0.35  # extra height of the deck at the bow [freeboard]
_RAKE = 0.06  # how far the keel stays behind the deck at the stem [L]
_COUNTER = 0.12  # depth of the bottom over rudder and propeller [d]
_STATIONS = 48  # of the outline
_MESH_STATIONS = 18  # of the solid, which every recording holds
_BILGE_POINTS = 6  # from the keel to the waterline
_SIDE_POINTS = 2  # from the waterline to the deck edge
_SHARP = -0.7  # part of a normal that faces aft on a transom, up on a deck
_ASIDE = 0.3  # part of a normal to the side: both sides meet at the stem in an edge


def hull_mesh(L: float, B: float, d: float) -> tuple[np.ndarray, np.ndarray]:
    """Closed hull: pointed raked bow, parallel middle body, tapered stern with a transom.

    Parameters
    ----------
    L, B, d : float
        Length, breadth and draught [m].

    Returns
    -------
    vertices : numpy.ndarray, float64, shape (V, 3)
        Points in body axes [m]: x from -L/2 to L/2, y from -B/2 to B/2, z from above the deck
        (negative) to the keel at d.
    triangles : numpy.ndarray, int64, shape (T, 3)
        Vertex indices; each edge belongs to two triangles, and the surface mirrors in y = 0.
    """
    _check_size(L=L, B=B, d=d)
    sections = _starboard_sections(L, B, d, _MESH_STATIONS)
    half = np.concatenate([_skin(sections), _transom(sections[0])])
    port = half[:, ::-1] * np.array([1.0, -1.0, 1.0])  # reversed winding keeps normals outward
    return _weld(np.concatenate([half, port]))


def superstructure_mesh(L: float, B: float, d: float) -> tuple[np.ndarray, np.ndarray]:
    """Deckhouse aft, a bridge across its top and a funnel: three closed boxes on the deck.

    Parameters
    ----------
    L, B, d : float
        Length, breadth and draught [m].

    Returns
    -------
    vertices : numpy.ndarray, float64, shape (24, 3)
        Points in body axes [m].
    triangles : numpy.ndarray, int64, shape (36, 3)
        Vertex indices, each box closed.
    """
    _check_size(L=L, B=B, d=d)
    deck, top = -FREEBOARD * d, -FREEBOARD * d - 0.10 * L
    return merge(
        box_mesh((-0.36 * L, -0.36 * B, top), (-0.27 * L, 0.36 * B, deck)),
        box_mesh((-0.32 * L, -0.48 * B, top - 0.02 * L), (-0.265 * L, 0.48 * B, top)),
        box_mesh((-0.42 * L, -0.12 * B, top + 0.01 * L), (-0.37 * L, 0.12 * B, deck)),
    )


def deck_outline(L: float, B: float, d: float) -> np.ndarray:
    """Edge of the deck seen from above, closed, shape (P, 2): x and y in body axes [m]."""
    _check_size(L=L, B=B, d=d)
    starboard = _starboard_sections(L, B, d, _STATIONS)[:, -2, :2]
    port = starboard[::-1] * np.array([1.0, -1.0])
    return np.concatenate([starboard, port, starboard[:1]])


def box_mesh(low: tuple, high: tuple) -> tuple[np.ndarray, np.ndarray]:
    """Closed box between two corners [m]; vertices (8, 3) and triangles (12, 3)."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    start = np.asarray(low, dtype=float)
    return start + corners * (np.asarray(high, dtype=float) - start), np.array(triangles)


def merge(*meshes: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Put meshes of (vertices [m], triangles) side by side into one."""
    starts = np.cumsum([0] + [len(vertices) for vertices, _ in meshes])
    triangles = [mesh[1] + start for mesh, start in zip(meshes, starts, strict=False)]
    return np.concatenate([vertices for vertices, _ in meshes]), np.concatenate(triangles)


def flat_shaded(
    vertices: np.ndarray, triangles: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Give every triangle its own corners, so that edges look sharp in a renderer.

    Parameters
    ----------
    vertices : numpy.ndarray, shape (V, 3)
        Points [m].
    triangles : numpy.ndarray, shape (T, 3)
        Vertex indices.

    Returns
    -------
    vertices, triangles, normals : numpy.ndarray
        Shapes (3 T, 3) [m], (T, 3) and (3 T, 3) [-] of unit length, pointing outward.
    """
    corners = vertices[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    order = np.arange(3 * len(triangles)).reshape(-1, 3)
    return corners.reshape(-1, 3), order, np.repeat(normals, 3, axis=0)


def smooth_shaded(
    corners: np.ndarray, normals: np.ndarray, paint: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Share corners between triangles of one paint that make one surface, to look round.

    Parameters
    ----------
    corners, normals : numpy.ndarray, shape (N, 3)
        Of `flat_shaded`.
    paint : numpy.ndarray of uint8, shape (N, 3)
        Colour of each corner.

    Returns
    -------
    vertices : numpy.ndarray, shape (V, 3)
        Points [m], V < N.
    triangles : numpy.ndarray, shape (N / 3, 3)
        Vertex indices.
    normals, paint : numpy.ndarray, shape (V, 3)
        Unit normals, means of the triangles that meet, and colours.
    """
    surface = 2.0 * (normals[:, :1] < _SHARP) + (normals[:, 2:] < _SHARP)
    surface += np.sign(normals[:, 1:2]) * (np.abs(normals[:, 1:2]) > _ASIDE) * 4.0
    key = np.round(np.concatenate([corners, paint, surface], axis=1), 9)
    _, first, index = np.unique(key, axis=0, return_index=True, return_inverse=True)
    index = index.reshape(-1)
    sums = [np.bincount(index, normals[:, k]) for k in range(3)]
    mean = np.stack(sums, axis=1, dtype=np.float64)
    mean /= np.linalg.norm(mean, axis=1, keepdims=True)
    return corners[first], index.reshape(-1, 3), mean, paint[first]


def _starboard_sections(L: float, B: float, d: float, count: int) -> np.ndarray:
    """Points of the starboard half, shape (stations, points, 3): keel, bilge, side, deck centre."""
    s = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, count))  # denser at the ends; 0 is the stern
    keel = d * (1.0 - (1.0 - _COUNTER) * smoothstep((0.15 - s) / 0.10))
    deck = -FREEBOARD * d * (1.0 + BOW_SHEER * smoothstep((s - 0.75) / 0.25))
    ahead = np.clip((s - 0.68) / (1.0 - 0.68), 0.0, 1.0)  # exactly 1 at the stem: a sharp edge
    waterline = 0.5 * B * (1.0 - ahead**2.0) * (0.62 + 0.38 * smoothstep(s / 0.22))
    deck_edge = 0.5 * B * (1.0 - ahead**3.5) * (0.82 + 0.18 * smoothstep(s / 0.15))
    middle = smoothstep(s / 0.35) * smoothstep((1.0 - s) / 0.45)
    exponent = (2.0 / (1.6 + 4.4 * middle))[:, None]  # V-shaped at the ends, boxy amidships
    angle = np.linspace(0.0, 0.5 * np.pi, _BILGE_POINTS)
    bilge_y = waterline[:, None] * np.sin(angle) ** exponent
    bilge_z = keel[:, None] * np.cos(angle) ** exponent
    bilge_z[:, -1] = 0.0  # cos(pi/2) is not quite zero
    up = np.linspace(0.0, 1.0, _SIDE_POINTS + 1)[1:]
    side_y = waterline[:, None] + (deck_edge - waterline)[:, None] * up
    side_z = deck[:, None] * up
    y = np.concatenate([bilge_y, side_y, np.zeros((count, 1))], axis=1)
    z = np.concatenate([bilge_z, side_z, deck[:, None]], axis=1)
    rake = _RAKE * L * smoothstep((s - 0.75) / 0.25)[:, None] * (z - deck[-1]) / (d - deck[-1])
    return np.stack([np.broadcast_to((s[:, None] - 0.5) * L, z.shape) - rake, y, z], axis=-1)


def _skin(sections: np.ndarray) -> np.ndarray:
    """Triangles, shape (n, 3, 3), between stations, from the keel round to the deck."""
    a, b = sections[:-1, :-1], sections[1:, :-1]  # lower edge: aft, ahead
    c, e = sections[1:, 1:], sections[:-1, 1:]  # upper edge: ahead, aft
    # This diagonal leaves no triangle in the centre plane at the stem, where b and c have y = 0.
    pairs = np.stack([a, b, e], axis=-2), np.stack([b, c, e], axis=-2)
    return np.concatenate(pairs).reshape(-1, 3, 3)


def _transom(section: np.ndarray) -> np.ndarray:
    """Triangles, shape (n, 3, 3), that close the aftmost section: a fan from its deck centre."""
    fan = np.broadcast_to(section[-1], section[1:-1].shape)
    return np.stack([fan, section[:-2], section[1:-1]], axis=1)


def _weld(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Merge equal corners and drop the triangles that this collapses (stem, centre plane)."""
    points = corners.reshape(-1, 3) + 0.0  # turns -0.0 into 0.0
    vertices, index = np.unique(points, axis=0, return_inverse=True)
    triangles = index.reshape(-1, 3)
    first, second, third = triangles.T
    return vertices, triangles[(first != second) & (second != third) & (third != first)]


def _check_size(**sizes: float) -> None:
    for name, value in sizes.items():
        if not (np.isfinite(value) and value > 0.0):
            raise ValueError(f"{name} = {value} m; it must be positive")
