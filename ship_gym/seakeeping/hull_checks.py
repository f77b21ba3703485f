"""Checks of a hull mesh, each with a hint how to repair what it refuses."""

from __future__ import annotations

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.seakeeping.hull_mesh import HullMesh, boundary_edges, panel_edges
from ship_gym.seakeeping.hydrostatics import closure, comparison, hydrostatics
from ship_gym.ships.particulars import Ship

_VOLUME = 0.05  # largest difference from the ship file
_LENGTH, _MIDDLE, _DRAUGHT = 0.15, 0.08, 0.15  # by L, by L, by d: wrong units, origin, waterline
_CENTRE = 0.01  # by L: centre of buoyancy of a hull that may lie the wrong way round
_UNITS = {"mm": 0.001, "cm": 0.01, "inch": 0.0254, "ft": 0.3048, "km": 1000.0}


def check_place(points: np.ndarray, ship: Ship, name: str) -> None:
    """Refuse a mesh that is not the ship's size or not where the ship is, and guess why."""
    L, d = ship.hull.L, ship.hull.d
    wet = points[points[:, 2] > 0.0]
    if len(wet) == 0:
        raise ConfigError(
            f"{name}: nothing below the waterline; z reaches from {-points[:, 2].max():.4g} to "
            f"{-points[:, 2].min():.4g} m above it: give waterline = its height, or another up"
        )
    size = np.ptp(points, axis=0)
    if abs(size[0] / L - 1.0) > _LENGTH:
        raise ConfigError(
            f"{name}: {size[0]:.4g} m long, but {ship.name} has L = {L:.4g} m; {_guess(size, L)}"
        )
    middle = 0.5 * (wet[:, 0].max() + wet[:, 0].min())
    if abs(middle) > _MIDDLE * L:
        raise ConfigError(
            f"{name}: the hull's middle lies {middle:.4g} m forward of midship; give midship = "
            "coordinate of the middle between the perpendiculars (half of L if x = 0 is the stern)"
        )
    if abs(wet[:, 2].max() / d - 1.0) > _DRAUGHT:
        raise ConfigError(
            f"{name}: draught {wet[:, 2].max():.4g} m, but {ship.name} has d = {d:.4g} m; give "
            "waterline = its height above the file's zero (d if z = 0 is the keel)"
        )


def _guess(size: np.ndarray, L: float) -> str:
    """What may be wrong with a mesh of this size (3,) [m]."""
    if np.argmax(size) != 0:
        axis = "starboard" if np.argmax(size) == 1 else "vertical"
        return f"it is longest along the {axis} axis: give forward and up"
    for unit, metres in _UNITS.items():
        if abs(size[0] * metres / L - 1.0) < _LENGTH:
            return f"it looks like {unit}: multiply scale by {metres:g}"
    return f"if it is the same ship at another size multiply scale by about {L / size[0]:.4g}"


def check_mesh(mesh: HullMesh, ship: Ship, name: str = "hull mesh") -> None:
    """Refuse a mesh that a boundary element method cannot use, and say how to repair it.

    Raises
    ------
    ConfigError
        Normals that disagree or point inward, holes below the waterline, a volume that differs
        from the ship file's by more than 5 %, a bow where the stern should be.
    """
    _check_winding(mesh, name)
    _check_holes(mesh, name)
    found = hydrostatics(mesh)
    if found.volume < 0.0:
        raise ConfigError(f"{name}: the normals point into the hull; give flip_normals = True")
    if closure(mesh) > 1e-3:
        raise ConfigError(
            f"{name}: not watertight: its volume differs by {100 * closure(mesh):.2g} % along "
            "x, y and z: fill holes in a mesh editor"
        )
    if abs(found.volume / ship.hull.volume - 1.0) > _VOLUME:
        raise ConfigError(
            f"{name}: volume {found.volume:.5g} m3, but {ship.name} has {ship.hull.volume:.5g}: "
            f"allowed is a difference of {100 * _VOLUME:g} %; check scale and waterline, and that "
            "there are no inner walls, tanks or double surfaces"
        )
    x_B, given = comparison(mesh, ship)["x_B"]
    if abs(x_B - given) > max(_CENTRE * ship.hull.L, 2.0 * abs(x_B + given)):
        raise ConfigError(
            f"{name}: centre of buoyancy {x_B:.4g} m forward of midship, but {ship.name} has "
            f"{given:.4g} m: the bow seems to be at the stern; give forward with the other sign"
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
            f"lie on each other, one at x {x:.4g}, y {y:.4g}, z {z:.4g} m: make the normals "
            "consistent in a mesh editor (recalculate outside) and remove doubled faces"
        )


def _check_holes(mesh: HullMesh, name: str) -> None:
    """Open edges may lie at the waterline and, of a half, in the centre plane."""
    tolerance = 1e-5 * mesh.length
    ends = mesh.vertices[boundary_edges(mesh)]
    allowed = (np.abs(ends[..., 2]) < tolerance).all(axis=1)
    centre = (np.abs(ends[..., 1]) < tolerance).all(axis=1)
    if mesh.symmetric:
        allowed |= centre
    if allowed.all():
        return
    x, y, z = ends[~allowed].mean(axis=1)[-1]
    half = (
        "; only one side is in the file: mirror it in y = 0"
        if centre[~allowed].all()
        else ": merge vertices, fill holes or stitch the patches in a mesh editor"
    )
    raise ConfigError(
        f"{name}: not watertight below the waterline: {int((~allowed).sum())} open edges, one at "
        f"x {x:.4g}, y {y:.4g}, z {z:.4g} m{half}"
    )


def check_panels(mesh: HullMesh, name: str) -> None:
    """A panel without area has no normal."""
    flat = mesh.areas < 1e-9 * mesh.areas.sum()
    if flat.any():
        x, y, z = mesh.vertices[mesh.panels[flat][0, 0]]
        raise ConfigError(
            f"{name}: {int(flat.sum())} degenerate panels without area, one at x {x:.4g}, "
            f"y {y:.4g}, z {z:.4g} m: let it be coarsened (panels = 704) or remove slivers"
        )
