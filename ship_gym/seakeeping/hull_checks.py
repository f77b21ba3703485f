"""Checks of a hull mesh, each with a hint how to repair what it refuses.

A hint names the option of ``ship-gym build-wave-table``; the argument of `read_hull` is called the
same, with underscores.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.seakeeping.hull_mesh import HullMesh, boundary_edges, panel_edges
from ship_gym.seakeeping.hydrostatics import closure, comparison, hydrostatics
from ship_gym.ships.particulars import Ship

_VOLUME = 0.05  # largest difference from the ship file
_LENGTH, _MIDDLE, _DRAUGHT = 0.15, 0.08, 0.15  # by L, by L, by d: wrong units, origin, waterline
_BOTH, _ASIDE = 0.75, 0.05  # by B: wide enough for both sides, and not centred
_CENTRE = 0.01  # by L: centre of buoyancy of a hull that may lie the wrong way round
_TOLERANCE = 1e-5  # by L: of what lies in the waterline or the centre plane
_CLOSED = 1e-3  # of the volume along x, y and z, and of the area seen along x and y
_UNITS = {"mm": 0.001, "cm": 0.01, "inch": 0.0254, "ft": 0.3048, "km": 1000.0}


@dataclasses.dataclass(frozen=True)
class Placed:
    """How a file was placed, as in `read_hull`: a hint says by what to replace it."""

    scale: float = 1.0
    forward: str = "+x"
    up: str = "+z"
    midship: float = 0.0
    waterline: float = 0.0


def check_place(points: np.ndarray, ship: Ship, name: str, placed: Placed) -> None:
    """Refuse a mesh that is not the ship's size or not where the ship is, and guess why."""
    L, d = ship.hull.L, ship.hull.d
    wet = points[points[:, 2] > 1e-6 * L]
    deepest = float(points[:, 2].max())
    height = placed.waterline + d - deepest  # of the waterline, at the ship's draught
    size = np.ptp(points, axis=0)
    if abs(size[0] / L - 1.0) > _LENGTH:
        raise ConfigError(
            f"{name}: {size[0]:.4g} m long, but {ship.name} has L = {L:.4g} m; "
            f"{_guess(size, L, placed)}"
        )
    if len(wet) == 0:
        raise ConfigError(
            f"{name}: nothing below the waterline; z reaches from {-deepest:.4g} to "
            f"{-points[:, 2].min():.4g} m above it: give --waterline {height:.6g} for the ship's "
            "draught, or another --up"
        )
    if abs(deepest / d - 1.0) > _DRAUGHT:
        raise ConfigError(
            f"{name}: draught {deepest:.4g} m, but {ship.name} has d = {d:.4g} m; give "
            f"--waterline, its height above the file's zero: {height:.6g} for this draught"
        )
    middle = float(0.5 * (wet[:, 0].max() + wet[:, 0].min()))
    if abs(middle) > _MIDDLE * L:
        raise ConfigError(
            f"{name}: the hull's middle lies {middle:.4g} m forward of midship; give "
            "--midship, the middle between the perpendiculars in the file, about "
            f"{placed.midship + middle:.6g}"
        )
    low, high = wet[:, 1].min(), wet[:, 1].max()
    aside, B = float(0.5 * (low + high)), ship.hull.B
    if high - low > _BOTH * B and abs(aside) > _ASIDE * B:
        raise ConfigError(
            f"{name}: its centre plane lies {abs(aside):.4g} m to "
            f"{'starboard' if aside > 0.0 else 'port'} of zero: move it there in a mesh editor"
        )


def _guess(size: np.ndarray, L: float, placed: Placed) -> str:
    """What may be wrong with a mesh of this size (3,) [m]."""
    longest = int(np.argmax(size))
    if longest != 0:
        axis = "starboard" if longest == 1 else "vertical"
        letter = (
            placed.up[1] if longest == 2 else ({*"xyz"} - {placed.up[1], placed.forward[1]}).pop()
        )
        return (
            f"it is longest along the {axis} axis: give --forward +{letter} or -{letter} and, if "
            "need be, --up"
        )
    for unit, metres in _UNITS.items():
        if abs(size[0] * metres / L - 1.0) < _LENGTH:
            return f"it looks like {unit}: give --scale {placed.scale * metres:g}"
    return (
        "if it is the same ship at another size give --scale "
        f"{placed.scale * L / size[0]:.4g} or so"
    )


def check_mesh(
    mesh: HullMesh, ship: Ship, name: str = "hull mesh", placed: Placed | None = None
) -> None:
    """Refuse a mesh that a boundary element method cannot use, and say how to repair it.

    Raises
    ------
    ConfigError
        Normals that disagree or point inward, holes below the waterline that count, a volume that
        differs from the ship file's by more than 5 %, a bow where the stern should be.
    """
    _check_winding(mesh, name)
    _check_closed(mesh, name)
    found = hydrostatics(mesh)
    if found.volume < 0.0:
        raise ConfigError(f"{name}: the normals point into the hull; give --flip-normals")
    if abs(found.volume / ship.hull.volume - 1.0) > _VOLUME:
        raise ConfigError(
            f"{name}: volume {found.volume:.5g} m3, but {ship.name} has {ship.hull.volume:.5g}: "
            f"allowed is a difference of {100 * _VOLUME:g} %; check --scale and --waterline, and "
            "that there are no inner walls, tanks or double surfaces"
        )
    x_B, given = comparison(mesh, ship)["x_B"]
    if abs(x_B - given) > max(_CENTRE * ship.hull.L, 2.0 * abs(x_B + given)):
        forward = (placed or Placed()).forward
        other = ("-" if forward[0] == "+" else "+") + forward[1]
        raise ConfigError(
            f"{name}: centre of buoyancy {x_B:.4g} m forward of midship, but {ship.name} has "
            f"{given:.4g} m: the bow seems to be at the stern; give --forward {other}"
        )


def _check_winding(mesh: HullMesh, name: str) -> None:
    """Neighbours must run along their common edge in opposite directions."""
    edges = panel_edges(mesh)
    keys = edges[:, 0] * len(mesh.vertices) + edges[:, 1]
    _, index, count = np.unique(keys, return_index=True, return_counts=True)
    if (count > 1).any():
        x, y, z = mesh.vertices[edges[index[count > 1][0], 0]]
        raise ConfigError(
            f"{name}: {int((count > 1).sum())} pairs of panels have normals on opposite sides or "
            f"lie on each other, one at x {x:.4g}, y {y:.4g}, z {z:.4g} m: give --fix-normals; if "
            "that does not help remove doubled faces in a mesh editor"
        )


def _check_closed(mesh: HullMesh, name: str) -> None:
    """What is open must not count: area vectors that add up, one volume along x, y and z.

    A lid at the waterline, which is not there, adds nothing to the volumes and nothing to the area
    seen along x and y.
    """
    apart, lost = closure(mesh), _lost(mesh)
    if apart <= _CLOSED and lost <= _CLOSED:
        return
    told = (
        f"{name}: not watertight: its volume differs by {100.0 * apart:.2g} % along x, y and z, "
        f"{100.0 * lost:.2g} % of its area is missing (allowed 0.1)"
    )
    ends = _open_below(mesh)
    if len(ends) == 0:
        raise ConfigError(f"{told}, though no edge is open: look for faces that cross each other")
    if (np.abs(ends[..., 1]) < _TOLERANCE * mesh.length).all():
        raise ConfigError(f"{told}; only one side is in the file: mirror it in y = 0")
    raise ConfigError(
        f"{told}: {_told_open(ends)}: close gaps with --weld [m], fill holes in a mesh editor"
    )


def still_open(mesh: HullMesh) -> tuple[str, ...]:
    """Line of a report on edges that are open below the waterline; none where none is."""
    ends = _open_below(mesh)
    return (f"still open, too little to count: {_told_open(ends)}",) if len(ends) else ()


def _open_below(mesh: HullMesh) -> np.ndarray:
    """Ends of open edges that do not lie in the waterline, shape (E, 2, 3)."""
    ends = mesh.vertices[boundary_edges(mesh)]
    return ends[~(np.abs(ends[..., 2]) < _TOLERANCE * mesh.length).all(axis=1)]


def _told_open(ends: np.ndarray) -> str:
    x, y, z = ends.mean(axis=1)[-1]
    return f"{len(ends)} open edges, one at x {x:.4g}, y {y:.4g}, z {z:.4g} m"


def _lost(mesh: HullMesh) -> float:
    """What does not cancel of the area seen along x and y, by that area; 0 of a closed hull."""
    sides = mesh.both_sides().area_vectors[:, :2]
    return float((np.abs(sides.sum(axis=0)) / np.abs(sides).sum(axis=0)).max())


def check_panels(mesh: HullMesh, name: str) -> None:
    """A panel without area has no normal."""
    flat = mesh.areas < 1e-9 * mesh.areas.sum()
    if flat.any():
        x, y, z = mesh.vertices[mesh.panels[flat][0, 0]]
        raise ConfigError(
            f"{name}: {int(flat.sum())} degenerate panels without area, one at x {x:.4g}, "
            f"y {y:.4g}, z {z:.4g} m: let it be coarsened (--panels 704) or remove slivers"
        )
