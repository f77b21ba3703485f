"""The legs of a route that a picture can show, and the lines of its corridor; numpy only."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from ship_gym.recording.surroundings import section

_FARTHEST = 50.0  # [L] from the track that was sailed; beyond it an ocean route is not drawn


class Legs(NamedTuple):
    """Legs, or what of them is near.

    Attributes
    ----------
    number : numpy.ndarray
        Of each in the route, from 0, shape (K,).
    start, end : numpy.ndarray
        North and east [m], shapes (K, 2).
    """

    number: np.ndarray
    start: np.ndarray
    end: np.ndarray


def legs_near(waypoints: np.ndarray, sailed: np.ndarray, length: float) -> Legs:
    """What of the legs between way-points lies about the positions that were sailed.

    Parameters
    ----------
    waypoints, sailed : numpy.ndarray
        North and east [m], shapes (W, 2) and (T, 2).
    length : float
        Of the ship [m].
    """
    low, high = sailed.min(axis=0), sailed.max(axis=0)
    room = _FARTHEST * length + float((high - low).max())
    start, along = waypoints[:-1], np.diff(waypoints, axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        bounds = np.stack([low - room - start, high + room - start]) / along
    still = along == 0.0  # along an axis: in the box for all of the leg, or for none of it
    within = (start >= low - room) & (start <= high + room)
    enter = np.where(still, np.where(within, 0.0, np.inf), bounds.min(axis=0)).max(axis=1)
    leave = np.where(still, np.where(within, 1.0, -np.inf), bounds.max(axis=0)).min(axis=1)
    enter, leave = np.maximum(enter, 0.0), np.minimum(leave, 1.0)
    seen = np.flatnonzero(enter < leave)
    cut = along[seen]
    return Legs(seen, start[seen] + enter[seen, None] * cut, start[seen] + leave[seen, None] * cut)


def corridor_of(meta: Mapping[str, Any], legs: Legs) -> np.ndarray | None:
    """Corridor of some legs to port and to starboard [m], shape (K, 2); None: there is none."""
    if meta.get("leg_limits"):
        return np.array(meta["leg_limits"], dtype=np.float64)[legs.number]
    corridor = section(meta, "limits").get("corridor")
    return None if corridor is None else np.full((len(legs.number), 2), float(corridor))


def corridor_lines(legs: Legs, corridor: np.ndarray) -> list[tuple[int, np.ndarray]]:
    """Lines beside legs: number of the leg, and both ends north and east [m], shape (2, 2)."""
    along = legs.end - legs.start
    starboard = np.stack([-along[:, 1], along[:, 0]], axis=1)
    starboard /= np.hypot(*along.T)[:, None]
    found = []
    for side, aside in ((-1.0, corridor[:, 0]), (1.0, corridor[:, 1])):
        shift = side * aside[:, None] * starboard
        ends = np.stack([legs.start + shift, legs.end + shift], axis=1)
        found += list(zip(legs.number.tolist(), ends, strict=True))
    return found
