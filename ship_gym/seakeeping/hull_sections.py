"""A fine hull surface as few panels: cut into sections, each divided anew.

The result has the same layout as the parametric hull, stations along and strips around. It follows
a bulb ahead of the waterline and the counter behind the keel, as long as each section is one curve
from the centreline to the waterline or back to the centreline.
"""

from __future__ import annotations

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.seakeeping.hull_mesh import HullMesh, divided, mesh_from_sections
from ship_gym.seakeeping.hydrostatics import hydrostatics

_ASPECT = 5.5  # stations per strip: 44 x 8 in a half of 704
_LOPSIDED = 0.01  # centre of buoyancy off the centre plane, by the beam
_CORNER, _REACH = np.radians(55.0), 0.02  # turn of a corner within this share of the girth each way
_END = 1e-3  # of the length: first and last section lie this far inside, where they have a shape


def coarsened(mesh: HullMesh, panels: int) -> HullMesh:
    """Starboard half of a hull with about `panels` panels on both sides.

    Parameters
    ----------
    mesh : HullMesh
        Both sides, cut at the waterline, watertight.
    panels : int
        Number wanted for both sides.

    Raises
    ------
    ConfigError
        No section from the centreline (catamaran), or the two sides differ.
    """
    _check_sides(mesh)
    girth = max(4, round((0.5 * panels / _ASPECT) ** 0.5))
    stations = max(8, round(0.5 * panels / girth))
    low, high = mesh.vertices[:, 0].min(), mesh.vertices[:, 0].max()
    share = np.linspace(0.0, 1.0, stations + 1)
    share = 0.5 * share + 0.5 * (0.5 - 0.5 * np.cos(np.pi * share))  # closer at both ends
    sections = np.zeros((stations + 1, girth + 1, 3))
    for i, at in enumerate(low + (high - low) * (_END + (1.0 - 2.0 * _END) * share)):
        sections[i, :, 0] = at
        sections[i, :, 1:] = _divided(section(mesh, at), girth)
    _close_stem(sections, 1e-4 * (high - low))
    for end, x in ((0, low), (-1, high)):
        if _is_flat(mesh, sections[end], x):
            sections[end, :, 0] = x
    coarse = mesh_from_sections(sections, mesh.report)
    old, new = hydrostatics(mesh), hydrostatics(coarse)
    return coarse.with_report(
        f"coarsened to {coarse.count} panels, {stations} x {girth} per side: volume "
        f"{100.0 * (new.volume / old.volume - 1.0):+.2f} %, wetted surface "
        f"{100.0 * (new.S / old.S - 1.0):+.2f} %"
    )


def _divided(points: np.ndarray, count: int) -> np.ndarray:
    """A section (N, 2) as `count` pieces, with a point at each sharp corner.

    Pieces that cut off the square bilge of a barge cost it 1 % of its volume at 200 panels.
    """
    girth = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1)))
    corners = _corners(points, girth, count - 1)
    if not corners:
        return divided(points, count)
    parts = np.split(np.arange(len(points)), corners)
    parts = [np.append(part, part[-1] + 1) for part in parts[:-1]] + parts[-1:]
    length = np.array([girth[part[-1]] - girth[part[0]] for part in parts])
    shares = np.ones(len(parts), dtype=int)
    for _ in range(count - len(parts)):  # one more for the part whose pieces are longest
        shares[np.argmax(length / shares)] += 1
    made = [divided(points[part], n) for part, n in zip(parts, shares.tolist(), strict=True)]
    return np.concatenate([made[0], *(part[1:] for part in made[1:])])


def _corners(points: np.ndarray, girth: np.ndarray, most: int) -> list[int]:
    """Points at which a section (N, 2) turns by a corner's angle within a short way, in order."""
    reach = _REACH * girth[-1]
    inner = np.nonzero((girth > reach) & (girth < girth[-1] - reach))[0]
    if len(inner) == 0 or reach == 0.0:
        return []
    before, after = (
        np.stack([np.interp(girth[inner] + way, girth, column) for column in points.T], axis=-1)
        for way in (-reach, reach)
    )
    a, b = points[inner] - before, after - points[inner]
    turn = np.abs(np.arctan2(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], (a * b).sum(axis=1)))
    found: list[int] = []
    for i in np.argsort(-turn, kind="stable"):
        at = int(inner[i])
        if turn[i] < _CORNER or len(found) == most:
            break
        if all(abs(girth[at] - girth[other]) > 2.0 * reach for other in found):
            found.append(at)
    return sorted(found)


def _is_flat(mesh: HullMesh, points: np.ndarray, x: float) -> bool:
    """True if the hull ends at x in a transverse plane as large as its section (G, 3) there."""
    area = 0.5 * abs(np.sum(points[:-1, 1] * points[1:, 2] - points[1:, 1] * points[:-1, 2]))
    near = np.abs(mesh.vertices[mesh.panels][..., 0] - x).max(axis=1) < 2.0 * _END * mesh.length
    across = np.abs(mesh.area_vectors[near, 0])
    plane = across > 0.99 * mesh.areas[near]
    return bool(0.5 * across[plane].sum() > 0.9 * area > 0.0)


def _close_stem(sections: np.ndarray, tolerance: float) -> None:
    """Bring the waterline to the centreline where the next section no longer reaches it."""
    dry = sections[:, -1, 2] > tolerance  # ends on top of a bulb
    neighbour = np.zeros_like(dry)
    neighbour[1:] |= dry[:-1]
    neighbour[:-1] |= dry[1:]
    sections[neighbour & ~dry, -1, 1] = 0.0


def _check_sides(mesh: HullMesh) -> None:
    a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
    n_z = 0.5 * np.cross(b - a, c - a)[:, 2]
    y, z = ((a + b + c) / 3.0)[:, 1:].T
    off, beam = float((y * z) @ n_z / (z @ n_z)), float(np.ptp(mesh.vertices[:, 1]))
    if abs(off) > _LOPSIDED * beam:
        raise ConfigError(
            f"hull mesh: the centre of buoyancy lies {off:.4g} m to starboard: put the centre "
            "plane at y = 0, or keep the panels as they are with --panels own"
        )


def section(mesh: HullMesh, x: float) -> np.ndarray:
    """Starboard section at x [m]: points (N, 2) of y, z from the centreline up.

    It ends at the waterline or, through a bulb, at the centreline again. Where there are more
    curves (a skeg below the counter) the longest one that starts at the centreline counts.

    Raises
    ------
    ConfigError
        No curve starts at the centreline.
    """
    tolerance = 1e-3 * float(mesh.vertices[:, 2].max())
    found = []
    for curve in _curves(mesh, x):
        half = _starboard(curve)
        if len(half) > 1 and half[0, 0] <= tolerance:
            found.append(half)
    if not found:
        raise ConfigError(
            f"hull mesh: the section at x = {x:.4g} m does not reach the centre plane (several "
            "hulls?): keep the panels as they are with --panels own"
        )
    return max(found, key=lambda half: np.linalg.norm(np.diff(half, axis=0), axis=1).sum())


def _starboard(curve: np.ndarray) -> np.ndarray:
    """The part y >= 0 of a curve (N, 2) from its lowest crossing of the centreline upwards."""
    if (curve[0] == curve[-1]).all():  # a loop, to be opened on the port side
        curve = np.roll(curve[:-1], -int(np.argmin(curve[:-1, 0])), axis=0)
        curve = np.concatenate([curve, curve[:1]])
    y = curve[:, 0]
    starboard = y >= 0.0
    crossing = np.nonzero(starboard[:-1] != starboard[1:])[0]
    if len(crossing) == 0:
        ordered = curve if curve[0, 1] > curve[-1, 1] else curve[::-1]
        return ordered if y.mean() >= 0.0 else np.empty((0, 2))
    share = y[crossing] / (y[crossing] - y[crossing + 1])
    z = curve[crossing, 1] + share * (curve[crossing + 1, 1] - curve[crossing, 1])
    keel = crossing[np.argmax(z)]
    part = curve[keel + 1 :] if starboard[keel + 1] else curve[keel::-1]
    back = np.nonzero(part[:, 0] < 0.0)[0]
    if len(back):  # through the top of a bulb
        i = back[0]
        top = part[i - 1] + (part[i] - part[i - 1]) * part[i - 1, 0] / (part[i - 1, 0] - part[i, 0])
        part = np.concatenate([part[:i], top[None] * np.array([0.0, 1.0])])
    return np.concatenate([[[0.0, z.max()]], part])


def _curves(mesh: HullMesh, x: float) -> list[np.ndarray]:
    """Curves (N, 2) of y, z in which the plane cuts the panels; a closed one ends as it began."""
    side = mesh.vertices[:, 0] > x
    triangles = mesh.triangles
    triangles = triangles[side[triangles].any(axis=1) & ~side[triangles].all(axis=1)]
    links: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for triangle in triangles.tolist():
        pairs = zip(triangle, triangle[1:] + triangle[:1], strict=True)
        ends = {(min(i, j), max(i, j)) for i, j in pairs if side[i] != side[j]}
        if len(ends) == 2:
            a, b = ends
            links.setdefault(a, []).append(b)
            links.setdefault(b, []).append(a)
    curves = []
    while links:
        start = next(
            (edge for edge, others in links.items() if len(others) == 1), next(iter(links))
        )
        curves.append(_edge_points(mesh.vertices, _walk(links, start), x))
    return curves


def _walk(links: dict, start: tuple[int, int]) -> list[tuple[int, int]]:
    """Follow the links from one end (or around a loop) and take them out."""
    path, at = [start], start
    while links.get(at):
        following = links[at].pop()
        links[following].remove(at)
        path.append(following)
        at = following
    for edge in path:
        if not links.get(edge):
            links.pop(edge, None)
    return path


def _edge_points(vertices: np.ndarray, path: list[tuple[int, int]], x: float) -> np.ndarray:
    a, b = (vertices[[edge[i] for edge in path]] for i in (0, 1))
    share = (x - a[:, 0]) / (b[:, 0] - a[:, 0])
    return (a + share[:, None] * (b - a))[:, 1:]
