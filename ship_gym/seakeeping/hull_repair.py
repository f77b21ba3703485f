"""Gaps between the faces of a hull file closed, and its normals made to agree.

A hanging node is a corner of one face that lies on the edge of another, or a little beside it, so
that the two do not share their edge: what a mesh written patch by patch, with rounded numbers or
from CAD surfaces has. The edge takes the node in and its face is divided anew. No vertex is made;
only vertices at open edges move, by a gap at most.
"""

from __future__ import annotations

from collections import deque
from functools import cache

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

GAP = 1e-4  # of the length: what is closed without being asked for, 2.5 cm of a tanker
_ROUNDS = 4
_TURNED = [1, 0, 3, 2]  # of a triangle, too, which repeats its last corner


def close_gaps(
    points: np.ndarray, faces: np.ndarray, gap: float
) -> tuple[np.ndarray, np.ndarray, int]:
    """Faces that share their edges where they meet within a gap.

    Parameters
    ----------
    points : numpy.ndarray, shape (V, 3)
        [m], equal ones merged.
    faces : numpy.ndarray, shape (P, 4)
        Vertex indices; a triangle repeats its last one.
    gap : float
        Largest distance of what is joined [m].

    Returns
    -------
    points, faces : numpy.ndarray
        As they came in if no edge is open or nothing lies near enough.
    closed : int
        Number of open edges that are no longer.
    """
    before = len(open_edges(faces)[0])
    for _ in range(_ROUNDS if before else 0):
        moved = faces
        for _ in range(_ROUNDS):  # of four that meet, two and two
            moved, once = _merged(points, moved, gap), moved
            if moved is once:
                break
        made = _with_nodes(points, moved, gap)
        if made is faces or len(open_edges(made)[0]) >= len(open_edges(faces)[0]):
            break
        faces = made
    return points, faces, before - len(open_edges(faces)[0])


def open_edges(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Edges of one face only, shape (E, 2) in its direction, and their face, shape (E,)."""
    edges, owner, keys = _edges(faces)
    _, index, count = np.unique(keys, return_inverse=True, return_counts=True)
    single = count[index] == 1
    return edges[single], owner[single]


def _edges(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """All edges (E, 2) of all faces, their face and a number for their two ends."""
    edges = np.concatenate([faces[:, [i, (i + 1) % 4]] for i in range(4)])
    owner = np.tile(np.arange(len(faces)), 4)
    real = edges[:, 0] != edges[:, 1]
    edges, owner = edges[real], owner[real]
    most = int(faces.max(initial=0)) + 1
    return edges, owner, edges.min(axis=1) * most + edges.max(axis=1)


def _merged(points: np.ndarray, faces: np.ndarray, gap: float) -> np.ndarray:
    """Two vertices of open edges become one where each is the other's nearest.

    Ends of one edge are not merged: a fine edge of the deck would fold up.
    """
    edges, _ = open_edges(faces)
    nodes = np.unique(edges)
    if len(nodes) < 2:
        return faces
    distance, near = cKDTree(points[nodes]).query(points[nodes], k=2, distance_upper_bound=gap)
    other = np.where(near[:, 0] == np.arange(len(nodes)), near[:, 1], near[:, 0])
    found = np.isfinite(distance[:, 1])
    first = np.nonzero(found)[0]
    first = first[(other[other[first]] == first) & (first < other[first])]
    linked = {(min(a, b), max(a, b)) for a, b in edges.tolist()}
    new = np.arange(len(points))
    for i in first:
        a, b = int(nodes[i]), int(nodes[other[i]])
        if (min(a, b), max(a, b)) not in linked:
            new[max(a, b)] = min(a, b)
    return _whole(new[faces]) if (new != np.arange(len(points))).any() else faces


def _whole(faces: np.ndarray) -> np.ndarray:
    """Faces of three corners or more, after corners have become one."""
    rows = [list(dict.fromkeys(row)) for row in faces.tolist()]
    return np.array([[*row, row[-1]][:4] for row in rows if len(row) > 2], dtype=np.int64)


def _with_nodes(points: np.ndarray, faces: np.ndarray, gap: float) -> np.ndarray:
    """Faces with the hanging nodes of their open edges as corners."""
    edges, owner = open_edges(faces)
    nodes = np.unique(edges)
    if len(nodes) == 0:
        return faces
    tree = cKDTree(points[nodes])
    middle, half = points[edges].mean(axis=1), points[edges[:, 1]] - points[edges[:, 0]]
    length = np.linalg.norm(half, axis=1)
    near = tree.query_ball_point(middle, 0.5 * length + gap)
    wanted: dict[int, dict[tuple[int, int], list[int]]] = {}
    for (a, b), face, found, along, size in zip(
        edges.tolist(), owner.tolist(), near, half, length, strict=True
    ):
        others = np.setdiff1d(nodes[found], faces[face])
        if len(others) == 0:
            continue
        away = points[others] - points[a]
        share = away @ along / size**2
        off = np.linalg.norm(away - share[:, None] * along, axis=1)
        hangs = (off <= gap) & (share > 0.0) & (share < 1.0)
        if hangs.any():
            order = others[hangs][np.argsort(share[hangs])]
            wanted.setdefault(face, {})[a, b] = order.tolist()
    if not wanted:
        return faces
    new = [_divided(points, faces[face], edge) for face, edge in wanted.items()]
    kept = np.delete(faces, list(wanted), axis=0)
    return np.concatenate([kept, *new])


def _divided(
    points: np.ndarray, face: np.ndarray, nodes: dict[tuple[int, int], list[int]]
) -> np.ndarray:
    """A face with more corners as triangles (n, 4), whose flattest is as good as can be."""
    corners = list(dict.fromkeys(face.tolist()))
    ring = []
    for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
        ring += [a, *nodes.get((a, b), [])]
    ring = list(dict.fromkeys(ring))
    at = points[ring]

    def quality(i: int, j: int, k: int) -> float:
        a, b, c = at[i], at[j], at[k]
        sides = ((b - a) ** 2).sum() + ((c - b) ** 2).sum() + ((a - c) ** 2).sum()
        return float(np.linalg.norm(np.cross(b - a, c - a)) / sides)

    @cache
    def best(i: int, j: int) -> tuple[float, int]:
        """Worst triangle of the best division of the corners i to j, and its third corner."""
        if j - i < 2:
            return 1.0, -1
        return max(
            (min(quality(i, k, j), best(i, k)[0], best(k, j)[0]), k) for k in range(i + 1, j)
        )

    made, waiting = [], [(0, len(ring) - 1)]
    while waiting:
        i, j = waiting.pop()
        if j - i > 1:
            k = best(i, j)[1]
            made.append([ring[i], ring[k], ring[j], ring[j]])
            waiting += [(i, k), (k, j)]
    return np.array(made, dtype=np.int64)


def oriented(points: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, int]:
    """Faces whose normals agree with their neighbours' and point out of the hull.

    Parameters
    ----------
    points : numpy.ndarray, shape (V, 3)
        Ship axes [m], below the waterline.
    faces : numpy.ndarray, shape (P, 4)

    Returns
    -------
    faces : numpy.ndarray
        The same, some of them turned over.
    turned : int
        How many. Each piece of the surface is turned as a whole, so that seen from the middle of
        the waterplane it faces outward.
    """
    turn, piece = _agreeing(faces)
    agreed = np.where(turn[:, None], faces[:, _TURNED], faces)
    a, b, c, d = (points[agreed[:, i]] for i in range(4))
    middle = np.array([0.5 * (points[:, 0].max() + points[:, 0].min()), 0.0, 0.0])
    outward = np.einsum("ij,ij->i", np.cross(c - a, d - b), 0.25 * (a + b + c + d) - middle)
    back = (np.bincount(piece, outward) < 0.0)[piece]
    return np.where(back[:, None], agreed[:, _TURNED], agreed), int((turn != back).sum())


def _agreeing(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which faces to turn so that neighbours agree, and the number of the piece of each."""
    edges, owner, keys = _edges(faces)
    order = np.argsort(keys, kind="stable")
    _, start, count = np.unique(keys[order], return_index=True, return_counts=True)
    pair = start[count == 2]
    i, j = order[pair], order[pair + 1]
    against = edges[i, 0] == edges[j, 0]  # both run the same way: their normals disagree
    n = len(faces)
    links: list[list[tuple[int, bool]]] = [[] for _ in range(n)]
    for a, b, odd in zip(owner[i].tolist(), owner[j].tolist(), against.tolist(), strict=True):
        links[a].append((b, odd))
        links[b].append((a, odd))
    graph = coo_array((np.ones(len(i)), (owner[i], owner[j])), shape=(n, n))
    _, piece = connected_components(graph, directed=False)
    turn, seen = np.zeros(n, dtype=bool), np.zeros(n, dtype=bool)
    for first in np.unique(piece, return_index=True)[1].tolist():
        waiting, seen[first] = deque([first]), True
        while waiting:
            face = waiting.popleft()
            for other, odd in links[face]:
                if not seen[other]:
                    seen[other], turn[other] = True, turn[face] != odd
                    waiting.append(other)
    return turn, piece
