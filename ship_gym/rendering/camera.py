"""Camera: which part of the sea a plan view shows, and where a place lies on it; numpy only."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from ship_gym.rendering.scene import Scene

_STILL_SPAN = 6.0  # what the shorter side of the plan shows without a track [L]
_AHEAD = 3.0  # how far along the track the picture looks [L]
_AROUND = 2.6  # room around what must be seen [L]


@dataclass(frozen=True, eq=False)
class Camera:
    """North-up view of a flat sea.

    Attributes
    ----------
    centre : numpy.ndarray
        Place in the middle of the picture, north, east [m], shape (2,).
    scale : float
        Design units of one metre.
    width, height : float
        Size of the plan [design units].
    """

    centre: np.ndarray
    scale: float
    width: float
    height: float

    def place(self, points) -> np.ndarray:
        """Places north, east [m], shape (..., 2), on the picture, x right and y down."""
        away = (np.asarray(points, dtype=float) - self.centre) * self.scale
        x, y = 0.5 * self.width + away[..., 1], 0.5 * self.height - away[..., 0]
        return np.stack([x, y], axis=-1)

    def runs(self, points) -> list[np.ndarray]:
        """Visible parts of a line through places north, east [m], shape (k, 2), on the picture."""
        if len(points) < 2:
            return []
        places = self.place(points)
        starts, ends, seen = clipped(places[:-1], places[1:], (self.width, self.height))
        found: list[list[np.ndarray]] = []
        for k, (start, end) in enumerate(zip(starts, ends, strict=True)):
            if not seen[k]:
                continue
            if found and (found[-1][-1] == start).all():
                found[-1].append(end)
            else:
                found.append([start, end])
        return [np.array(run) for run in found]


def clipped(starts: np.ndarray, ends: np.ndarray, size: tuple[float, float], margin: float = 20.0):
    """Cut lines to a picture by Liang and Barsky (1984), ACM Trans. Graphics 3(1), 1-22.

    Parameters
    ----------
    starts, ends : numpy.ndarray
        Shapes (k, 2).
    size : tuple of float
        Width and height of the picture; `margin` around it is kept.

    Returns
    -------
    starts, ends, seen : numpy.ndarray
        Shapes (k, 2), (k, 2) and (k,): what is left of each line, and whether anything is.
    """
    away = ends - starts
    enter, leave = np.zeros(len(starts)), np.ones(len(starts))
    outside = np.zeros(len(starts), dtype=bool)
    for axis in (0, 1):
        for sign, edge in ((-1.0, margin), (1.0, size[axis] + margin)):
            speed, room = sign * away[:, axis], edge - sign * starts[:, axis]
            outside |= (speed == 0.0) & (room < 0.0)
            at = np.divide(room, speed, out=np.zeros(len(starts)), where=speed != 0.0)
            leave = np.where(speed > 0.0, np.minimum(leave, at), leave)
            enter = np.where(speed < 0.0, np.maximum(enter, at), enter)
    first = np.where((enter > 0.0)[:, None], starts + enter[:, None] * away, starts)
    last = np.where((leave < 1.0)[:, None], starts + leave[:, None] * away, ends)
    return first, last, ~outside & (enter < leave)


def camera_for(scene: Scene, width: float, height: float) -> Camera:
    """Follow the ship; with a track, show the ship, its foot on the leg and the way ahead."""
    side, L = min(width, height), scene.L
    if scene.track is None:
        return Camera(scene.position, side / (_STILL_SPAN * L), width, height)
    corners = np.stack([scene.position, foot(scene), way_ahead(scene, _AHEAD * L)])
    low, high = corners.min(axis=0), corners.max(axis=0)
    span = (high - low).max() + 2.0 * _AROUND * L
    return Camera(0.5 * (low + high), side / span, width, height)


def foot(scene: Scene) -> np.ndarray:
    """Place on the active leg that is nearest to the ship, north, east [m], shape (2,)."""
    start, end = _way(scene)[scene.active_leg : scene.active_leg + 2]
    return _foot_on(start, end, scene.position)


def nearest_foot(scene: Scene) -> np.ndarray:
    """The same on the previous, the active or the next leg, whichever is nearest, shape (2,)."""
    about = _way(scene)[max(scene.active_leg - 1, 0) : scene.active_leg + 3]
    feet = [_foot_on(a, b, scene.position) for a, b in itertools.pairwise(about)]
    return min(feet, key=lambda place: math.dist(place, scene.position))


def _way(scene: Scene) -> np.ndarray:
    """Way-points of a scene with a track."""
    assert scene.track is not None
    return scene.track


def _foot_on(start: np.ndarray, end: np.ndarray, position: np.ndarray) -> np.ndarray:
    """Place on the line from `start` to `end` that is nearest to a position, shape (2,)."""
    along = end - start
    square = float(along @ along)
    share = float((position - start) @ along) / square if square > 0.0 else 0.0
    return start + min(max(share, 0.0), 1.0) * along


def way_ahead(scene: Scene, distance: float) -> np.ndarray:
    """Place on the track `distance` [m] beyond the foot, or its last way-point."""
    here = foot(scene)
    for point in _way(scene)[scene.active_leg + 1 :]:
        leg = float(np.hypot(*(point - here)))
        if leg >= distance > 0.0:
            return here + distance / leg * (point - here)
        distance -= leg
        here = point
    return here
