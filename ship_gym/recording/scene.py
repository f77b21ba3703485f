"""Numbers behind the 3D view of a run: poses, wake, arrows, rudder and propeller; numpy only.

Axes are the project's own, x north, y east, z down (``ship_gym.conventions``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ship_gym.conventions import FORCES
from ship_gym.recording.hull_shape import box_mesh, merge

Columns = Mapping[str, np.ndarray]
MOST_WAKE_POINTS = 2000  # more would slow the viewer down and show nothing new
RING = 0.8  # radius of the compass ring [L]
_OUTSIDE = tuple(force for force in FORCES if force.outside)
_LOWEST, _APART = 0.12, 0.08  # height of their arrows above the water, and between them [L]
_HULL_RED, _HULL_BLUE, _DECK = (165, 62, 52), (70, 98, 145), (165, 135, 105)


@dataclass(frozen=True)
class ShipShape:
    """Sizes of the pictured ship: L, B, d [m], rudder area [m2], propeller diameter [m]."""

    L: float
    B: float
    d: float
    A_R: float
    D_P: float


@dataclass(frozen=True)
class Arrow:
    """An arrow that moves with the ship: origins and vectors (T, 3) [m] in earth axes."""

    name: str
    label: str
    origins: np.ndarray
    vectors: np.ndarray
    color: tuple[int, int, int]


def ship_shape(meta: Mapping) -> ShipShape | None:
    """Read the ship's sizes from ``meta["ship"]``; None if L, B or d are not there.

    A missing rudder area or propeller diameter gets a usual size, as it only fills the picture.
    """
    ship = meta.get("ship")
    if not isinstance(ship, Mapping) or not all(_is_size(ship.get(k)) for k in ("L", "B", "d")):
        return None
    L, B, d = (float(ship[k]) for k in ("L", "B", "d"))
    area = float(ship["A_R"]) if _is_size(ship.get("A_R")) else L * d / 50.0
    diameter = float(ship["D_P"]) if _is_size(ship.get("D_P")) else 0.7 * d
    return ShipShape(L, B, d, area, min(diameter, 0.85 * d))


def positions(columns: Columns) -> np.ndarray:
    """Position of the ship's origin [m], shape (T, 3), earth axes."""
    return np.stack([columns["x"], columns["y"], np.zeros(len(columns["x"]))], axis=1)


def pose(columns: Columns) -> tuple[np.ndarray, np.ndarray]:
    """Place and turn of the hull as it is seen, with wave-frequency motion where it is recorded.

    Returns
    -------
    places : numpy.ndarray, shape (T, 3)
        [m], earth axes: the ship's origin, moved to starboard by ``wave_sway``.
    turns : numpy.ndarray, shape (T, 4)
        Unit quaternions (x, y, z, w): heading with ``wave_yaw``, then ``wave_roll`` to starboard.
    """
    still = np.zeros(len(columns["psi"]))
    sway, roll, yaw = (columns.get(f"wave_{name}", still) for name in ("sway", "roll", "yaw"))
    places = positions(columns) + _to_earth(still, sway, columns["psi"])
    z, w = turned(columns["psi"] + yaw, axis=2).T[2:]
    x, w_roll = turned(roll, axis=0).T[[0, 3]]
    return places, np.stack([w * x, z * x, z * w_roll, w * w_roll], axis=1)


def turned(angle: np.ndarray, axis: int) -> np.ndarray:
    """Unit quaternions (x, y, z, w), shape (T, 4), of turns by `angle` [rad] about one axis."""
    quaternions = np.zeros((len(angle), 4))
    quaternions[:, axis] = np.sin(0.5 * angle)
    quaternions[:, 3] = np.cos(0.5 * angle)
    return quaternions


def wake(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cut a track into pieces that appear one after the other.

    Parameters
    ----------
    points : numpy.ndarray, shape (T, k)
        Track [m].

    Returns
    -------
    rows : numpy.ndarray of int, shape (P,)
        Row at which each piece ends, P <= MOST_WAKE_POINTS.
    pieces : numpy.ndarray, shape (P, 2, k)
        Start and end of each piece [m]; the first piece is a point.
    """
    rows = np.unique(np.linspace(0, len(points) - 1, MOST_WAKE_POINTS).astype(int))
    before = np.concatenate([rows[:1], rows[:-1]])
    return rows, np.stack([points[before], points[rows]], axis=1)


def propeller_angle(columns: Columns) -> np.ndarray:
    """Angle of the propeller [rad], shape (T,), from its speed ``n`` [rev/s]."""
    t, n = columns["t"], columns["n"]
    turns = np.concatenate([[0.0], np.cumsum(0.5 * (n[1:] + n[:-1]) * np.diff(t))])
    return 2.0 * np.pi * (turns % 1.0)


def arrows(columns: Columns, length: float) -> list[Arrow]:
    """Arrows for the ordered heading, the current, the wind and the forces of waves and wind.

    Parameters
    ----------
    columns : mapping of str to numpy.ndarray
        Columns of a trajectory; an arrow whose columns are missing is left out.
    length : float
        Ship length [m]. The ordered heading is a mark on the compass ring; the others are scaled
        so that their largest value shows well, the forces all by one scale.

    Returns
    -------
    list of Arrow
        Arrows relative to the ship's position.
    """
    found = []
    if "psi_ordered" in columns:
        order = _toward(columns["psi_ordered"], 0.3 * length)  # outward from the ring
        start = RING / 0.3 * order
        found.append(Arrow("ordered_heading", "ordered heading", start, order, (250, 170, 60)))
    if {"current_speed", "current_direction_to"} <= columns.keys():
        flow = (columns["current_direction_to"], columns["current_speed"])
        found.append(_incoming("current", *flow, length, 0.0, (80, 225, 240)))
    if {"wind_speed", "wind_direction_from"} <= columns.keys():
        wind = (columns["wind_direction_from"] + np.pi, columns["wind_speed"])
        found.append(_incoming("wind", *wind, length, -0.2 * length, (235, 235, 250)))
    return found + _force_arrows(columns, length)


def _force_arrows(columns: Columns, length: float) -> list[Arrow]:
    """Arrows of the forces from outside that act, all by one scale."""
    forces = {}
    for force in _OUTSIDE:
        names = f"X_{force.name}", f"Y_{force.name}", "psi"
        if columns.keys() >= set(names):
            vectors = _to_earth(*(columns[name] for name in names))
            if vectors.any():
                forces[force] = vectors
    largest = max((np.linalg.norm(v, axis=1).max() for v in forces.values()), default=1.0)
    found = []
    for force, vectors in forces.items():
        height = _LOWEST + _APART * _OUTSIDE.index(force)
        start = np.broadcast_to([0.0, 0.0, -height * length], vectors.shape)
        shown = vectors * (0.5 * length / largest)
        name, label = f"{force.name}_force", f"{force.label} force"
        found.append(Arrow(name, label, start, shown, force.on_dark))
    return found


def compass_ring(length: float) -> tuple[list[np.ndarray], np.ndarray]:
    """Circle with a tick every 10 deg round the ship, to read headings and to frame the view.

    Parameters
    ----------
    length : float
        Ship length [m].

    Returns
    -------
    lines : list of numpy.ndarray, shape (P, 3)
        Circle and ticks [m], earth axes, relative to the ship.
    names : numpy.ndarray, shape (4, 3)
        Where N, E, S and W are written [m].
    """
    angles = np.radians(np.arange(0.0, 361.0, 5.0))
    lines = [_toward(angles, RING * length)]
    for degrees in range(0, 360, 10):
        inner = RING - (0.08 if degrees % 90 == 0 else 0.03)
        lines.append(_toward(np.radians([degrees] * 2), np.array([inner, RING]) * length))
    return lines, _toward(np.radians([0.0, 90.0, 180.0, 270.0]), (RING + 0.08) * length)


def hull_colors(corners: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Paint triangles by height and slope: bottom red, sides blue, deck brown; (N, 3) uint8.

    Parameters
    ----------
    corners, normals : numpy.ndarray, shape (N, 3)
        Corners of the triangles [m], three rows for each, and the normal at each corner [-].
    """
    height = corners.reshape(-1, 3, 3)[:, :, 2].mean(axis=1).repeat(3)
    above = np.where(normals[:, 2:] < -0.7, _DECK, _HULL_BLUE)
    return np.where(height[:, None] > 0.0, _HULL_RED, above).astype(np.uint8)


def rudder_plate(ship: ShipShape) -> tuple[np.ndarray, tuple, tuple]:
    """Place the rudder: stock (3,) in body axes, and two corners of its plate from there [m]."""
    span = min(np.sqrt(1.6 * ship.A_R), 0.75 * ship.d)
    chord = ship.A_R / span
    stock = np.array([-0.485 * ship.L, 0.0, 0.95 * ship.d - 0.5 * span])
    low = (-0.7 * chord, -0.06 * chord, -0.5 * span)
    return stock, low, (0.3 * chord, 0.06 * chord, 0.5 * span)


def propeller_mesh(ship: ShipShape) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Propeller of four plain blades: centre (3,) [m], vertices (V, 3) [m], triangles (T, 3)."""
    radius = 0.5 * ship.D_P
    blade, faces = box_mesh((-0.03, -0.24, 0.15), (0.03, 0.24, 1.0))
    blade = blade * radius
    blade[:, 0] += 0.6 * blade[:, 1]  # pitch: the blades look twisted from the side
    hub = box_mesh(
        (-0.25 * radius,) + (-0.16 * radius,) * 2, (0.25 * radius,) + (0.16 * radius,) * 2
    )
    blades = []
    for cosine, sine in ((1, 0), (0, 1), (-1, 0), (0, -1)):
        turn = np.array([[1, 0, 0], [0, cosine, -sine], [0, sine, cosine]], dtype=float)
        blades.append((blade @ turn.T, faces))
    centre = np.array([-0.455 * ship.L, 0.0, 0.97 * ship.d - radius])
    return centre, *merge(*blades, hub)


def _toward(direction: np.ndarray, length: np.ndarray | float) -> np.ndarray:
    zeros = np.zeros(len(direction))
    return np.stack([length * np.cos(direction), length * np.sin(direction), zeros], axis=1)


def _to_earth(surge: np.ndarray, sway: np.ndarray, psi: np.ndarray) -> np.ndarray:
    north = surge * np.cos(psi) - sway * np.sin(psi)
    east = surge * np.sin(psi) + sway * np.cos(psi)
    return np.stack([north, east, np.zeros(len(psi))], axis=1)


def _incoming(name, direction, speed, length: float, height: float, color) -> Arrow:
    """Arrow of a flow that ends on the compass ring, on the side the flow comes from."""
    vectors = _scaled(_toward(direction, speed), 0.4 * length)
    origins = _toward(direction, -RING * length) - vectors + np.array([0.0, 0.0, height])
    return Arrow(name, name, origins, vectors, color)


def _scaled(vectors: np.ndarray, length: float) -> np.ndarray:
    """Scale vectors so that the longest one is `length` [m] long."""
    longest = float(np.linalg.norm(vectors, axis=1).max())
    return vectors * (length / longest) if longest > 0.0 else vectors


def _is_size(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and value > 0.0
