"""Picture of a hull mesh: body plan, the panels from below, from the side and from the bow."""

from __future__ import annotations

import os

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb

from ship_gym.plotting.figure import BLUE, FAINT, INK, RED, headline, picture
from ship_gym.seakeeping.hull_mesh import HullMesh, lid
from ship_gym.seakeeping.hull_sections import section
from ship_gym.seakeeping.hydrostatics import comparison
from ship_gym.ships.particulars import Ship

_STATIONS = 20  # of the body plan
_LIGHT = np.array([0.45, 0.55, -0.70])  # from ahead, starboard and above


def hull_picture(path: str | os.PathLike, mesh: HullMesh, ship: Ship) -> None:
    """Draw a mesh and its hydrostatics beside the ship file's values as a PNG.

    Parameters
    ----------
    path : path-like
        PNG file.
    mesh : HullMesh
        Of the size of `ship`.
    ship : Ship
        For the title and the numbers compared with.
    """
    with picture(path, 11.0, 7.4) as figure:
        headline(figure, f"{ship.name}: hull below the waterline", _numbers(mesh, ship))
        grid = figure.add_gridspec(3, 2, width_ratios=(1.0, 2.1), height_ratios=(1.3, 0.55, 0.75))
        _body_plan(figure.add_subplot(grid[0, 0]), mesh)
        _oblique(figure.add_subplot(grid[0, 1]), mesh)
        _profile(figure.add_subplot(grid[1, :]), mesh)
        _plan(figure.add_subplot(grid[2, :]), mesh)


def _numbers(mesh: HullMesh, ship: Ship) -> str:
    parts = [f"{mesh.count} panels"]
    for name, (found, given) in comparison(mesh, ship).items():
        if name in ("x_B", "x_F"):
            parts.append(f"{name} {100.0 * (found - given) / ship.hull.L:+.2f} % L")
        elif name not in ("draught", "B_wl"):
            parts.append(f"{name} {100.0 * (found / given - 1.0):+.1f} %")
    return ", ".join(parts) + " beside the ship file"


def _body_plan(axes: Axes, mesh: HullMesh) -> None:
    """Sections, aft ones to the left, forward ones to the right."""
    low, high = mesh.vertices[:, 0].min(), mesh.vertices[:, 0].max()
    for share in (np.arange(_STATIONS) + 0.5) / _STATIONS:
        y, z = section(mesh, low + share * (high - low)).T
        side, colour = (-1.0, RED) if share < 0.5 else (1.0, BLUE)
        axes.plot(side * y, z, color=colour, linewidth=1.0)
    axes.axhline(0.0, color=FAINT, linewidth=0.8)
    axes.set(title="Body plan: aft left, fore right", xlabel="y [m]", ylabel="z [m]")
    _equal(axes, down=True)


def _oblique(axes: Axes, mesh: HullMesh) -> None:
    """All panels and the lid, from the starboard bow below the water."""
    turn, tilt = np.radians(38.0), np.radians(24.0)
    right = np.array([np.sin(turn), np.cos(turn), 0.0]) * np.array([1.0, -1.0, 1.0])
    towards = np.array([np.cos(turn), np.sin(turn), 0.0])
    view = np.cos(tilt) * towards + np.sin(tilt) * np.array([0.0, 0.0, 1.0])
    _panels(axes, mesh.both_sides(), right, np.cross(view, right), view)
    axes.set(title="Panels from the starboard bow, below the water")
    axes.set_axis_off()
    _equal(axes)


def _profile(axes: Axes, mesh: HullMesh) -> None:
    _panels(axes, mesh, np.eye(3)[0], np.eye(3)[2], np.eye(3)[1])
    axes.set(title="Starboard side", ylabel="z [m]")
    _equal(axes, down=True)


def _plan(axes: Axes, mesh: HullMesh) -> None:
    """Starboard half from below, port half of the plan the lid."""
    half = mesh.vertices[mesh.panels].mean(axis=1)[:, 1] >= 0.0
    starboard = HullMesh(mesh.vertices, mesh.panels[half], True)
    _panels(axes, starboard, np.eye(3)[0], np.eye(3)[1], np.eye(3)[2])
    cover = lid(starboard)
    port = cover.vertices[:, :2] * np.array([1.0, -1.0])
    axes.add_collection(
        PolyCollection(port[cover.panels], facecolors="none", edgecolors=FAINT, linewidths=0.5)
    )
    axes.set(title="From below: hull panels (starboard) and lid at z = 0 (port)", xlabel="x [m]")
    axes.set(ylabel="y [m]")
    _equal(axes)


def _panels(axes: Axes, mesh: HullMesh, right, up, view) -> None:
    """Panels that face the viewer, shaded, far ones first."""
    normals = mesh.area_vectors / np.maximum(mesh.areas, 1e-30)[:, None]
    seen = normals @ view > 1e-9
    corners, normals = mesh.vertices[mesh.panels[seen]], normals[seen]
    order = np.argsort(corners.mean(axis=1) @ view)
    light = 0.62 + 0.30 * (normals @ (_LIGHT * np.array([1.0, 1.0, -1.0])))
    colours = np.clip(1.0 - (1.0 - np.array(to_rgb(BLUE))) * (1.25 - light)[:, None], 0.0, 1.0)
    flat = np.stack([corners @ right, corners @ up], axis=-1)
    axes.add_collection(
        PolyCollection(flat[order], facecolors=colours[order], edgecolors=INK, linewidths=0.25)
    )


def _equal(axes: Axes, down: bool = False) -> None:
    """One scale on both axes; z grows downwards."""
    axes.autoscale_view()
    axes.set_aspect("equal", adjustable="datalim" if not axes.axison else "box")
    axes.margins(0.03)
    if down:
        axes.invert_yaxis()
