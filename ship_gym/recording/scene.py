"""Numbers behind the 3D view of a run: poses, wake, arrows, rudder and propeller; numpy only.

Axes are the project's own, x north, y east, z down (``ship_gym.conventions``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ship_gym.conventions import FORCES, G
from ship_gym.recording.hull_shape import box_mesh, merge
from ship_gym.recording.marks import bearing
from ship_gym.recording.surroundings import waves_of

Columns = Mapping[str, np.ndarray]
MOST_WAKE_POINTS = 400  # more would fill the file and show nothing new
RING = 0.8  # radius of the compass ring [L]
_OUTSIDE = tuple(force for force in FORCES if force.outside)
_WIND, _WAVES, _CURRENT = (0.0, 0.3), (0.12, 0.1), (0.0, 0.0)  # see _incoming
_STRONG_WIND, _STRONG_CURRENT = 0.42, 0.032  # [sqrt(g L)], of a ship of 230 m 20 and 1.5 m/s
_LOWEST, _APART = 0.12, 0.08  # height of their arrows above the water, and between them [L]
# Of what has a label: its text has that colour, on a ground that the viewer makes dark or light.
# White stands out best on the worse of both, so these are white or nearly so.
ORDERED, COMPASS = (222, 104, 0), (255, 255, 255)
_VIOLET, _PINK, _GREEN = (224, 218, 255), (255, 224, 240), (196, 255, 214)
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
    """An arrow that moves with the ship.

    Origins and vectors (T, 3) [m] in earth axes; what is written at it, shape (T,), "" for nothing.
    """

    name: str
    labels: np.ndarray
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


def wake(points: np.ndarray, seldom: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Cut a track into pieces that appear one after the other.

    Parameters
    ----------
    points : numpy.ndarray, shape (T, k)
        Track [m].
    seldom : numpy.ndarray of bool, optional
        Rows from which to choose, shape (T,), the first among them; all if omitted.

    Returns
    -------
    rows : numpy.ndarray of int, shape (P,)
        Row at which each piece ends, P <= MOST_WAKE_POINTS.
    pieces : numpy.ndarray, shape (P, 2, k)
        Start and end of each piece [m]; the first piece is a point.
    """
    among = np.arange(len(points)) if seldom is None else np.flatnonzero(seldom)
    rows = among[np.unique(np.linspace(0, len(among) - 1, MOST_WAKE_POINTS).astype(int))]
    before = np.concatenate([rows[:1], rows[:-1]])
    return rows, np.stack([points[before], points[rows]], axis=1)


def propeller_angle(columns: Columns) -> np.ndarray:
    """Angle of the propeller [rad], shape (T,), from its speed ``n`` [rev/s]."""
    t, n = columns["t"], columns["n"]
    turns = np.concatenate([[0.0], np.cumsum(0.5 * (n[1:] + n[:-1]) * np.diff(t))])
    return 2.0 * np.pi * (turns % 1.0)


def arrows(columns: Columns, length: float, meta: Mapping | None = None) -> list[Arrow]:
    """Arrows for the ordered heading, waves, wind, current and the forces from outside.

    Parameters
    ----------
    columns : mapping of str to numpy.ndarray
        Columns of a trajectory; an arrow whose columns are missing is left out.
    length : float
        Ship length [m]. The ordered heading is a mark on the compass ring; wind and current have
        the length of their speed up to a strong one, the forces all have one scale.
    meta : mapping, optional
        Of the trajectory: its ``sea`` says height, period and direction of the waves.

    Returns
    -------
    list of Arrow
        Arrows relative to the ship's position.
    """
    found = flow_arrows(columns, length, meta)
    if "psi_ordered" in columns:
        order = columns["psi_ordered"]
        vectors = _toward(order, 0.3 * length)  # outward from the ring
        labels = np.array([f"ordered {bearing(angle)}" for angle in order])
        arrow = Arrow("ordered_heading", labels, RING / 0.3 * vectors, vectors, ORDERED)
        found = [arrow, *found]
    return found + _force_arrows(columns, length)


def flow_arrows(columns: Columns, length: float, meta: Mapping | None = None) -> list[Arrow]:
    """Arrows for waves, wind and current, with their numbers; see `arrows`."""
    found = []
    rows = len(next(iter(columns.values())))
    height, period, to, _ = waves_of(meta or {})
    if height and period:
        text = f"waves H {height:.1f} m, T {period:.1f} s from {bearing(to + np.pi)}"
        flow = np.full(rows, to), np.ones(rows)
        found.append(_incoming("waves", text, *flow, length, _WAVES, _VIOLET))
    scale = np.sqrt(G * length)
    if {"wind_speed", "wind_direction_from"} <= columns.keys():
        speed, origin = columns["wind_speed"], columns["wind_direction_from"]
        share = _share(speed, _STRONG_WIND * scale)
        if share.any():
            text = f"wind {speed.mean():.1f} m/s from {bearing(origin[0])}"
            flow = origin + np.pi, share
            found.append(_incoming("wind", text, *flow, length, _WIND, _PINK))
    if {"current_speed", "current_direction_to"} <= columns.keys():
        speed, way = columns["current_speed"], columns["current_direction_to"]
        share = _share(speed, _STRONG_CURRENT * scale)
        if share.any():
            text = f"current {speed.mean():.2f} m/s to {bearing(way[0])}"
            found.append(_incoming("current", text, way, share, length, _CURRENT, _GREEN))
    return found


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
        none = np.full(len(vectors), "")  # their names would hide each other, and the ship
        found.append(Arrow(f"{force.name}_force", none, start, shown, force.on_dark))
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
    return lines, _toward(np.radians([0.0, 90.0, 180.0, 270.0]), (RING - 0.17) * length)


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


def _incoming(name, text, direction, size, length: float, place: tuple, color) -> Arrow:
    """Arrow of a flow outside the compass ring, on the side the flow comes from.

    `place` is the gap to the ring and the height above the water [L], apart for each flow, so that
    their labels do not hide each other where they come from one side.
    """
    gap, height = place
    vectors = _toward(direction, 0.4 * length * size)
    origins = _toward(direction, -(RING + gap) * length) - vectors
    labels = np.full(len(direction), text)
    return Arrow(name, labels, origins + np.array([0.0, 0.0, -height * length]), vectors, color)


def _share(speed: np.ndarray, strong: float) -> np.ndarray:
    """Length of an arrow as a share of its longest: not too short to see, 0 for next to nothing."""
    share = speed / strong
    return np.where(share < 0.02, 0.0, np.clip(share, 0.25, 1.0))


def _is_size(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and value > 0.0
