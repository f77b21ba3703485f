"""The wave surface round a ship as a coarse moving grid, from the components of a recording.

It is made for the eye and for a small file: few points, one picture in some seconds, heights and
shades in steps. Waves shorter than the grid can carry are left out.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ship_gym.conventions import G
from ship_gym.sea.surface import WAVE_ENTRIES, elevation

SHADES = 12  # of the water, from trough to crest
_ALONG, _ACROSS = 30, 7  # points along the main direction and across; long-crested: two across
_MOST_POINTS = 91  # of a short-crested sea
_REACH = 1.5  # half the length of the grid [L], less where the waves are short
_WAVES_SEEN = 2.5  # half the length of the grid at least, in waves
_LEAST_REACH, _NARROW = 0.75, 0.85  # [L]; the latter of a short-crested sea, at most
_SHORTEST = 3.0  # waves shorter than this many points are left out
_PER_PERIOD = 3.3  # pictures in a mean period, but not more than one in _LEAST_STEP sqrt(L/g)
_LEAST_STEP = 0.6
_SHADE = 0.8  # share of all shades for a significant height up, and down
_STEPS = 9.0  # height steps in a significant height
_EDGE = 1.2  # flat edge of the grid, in halves of what moves
_SPREAD = 0.02  # mean square of the directions' sines from which a sea is short-crested


@dataclass(frozen=True)
class Grid:
    """A grid that is carried along with a ship and does not turn.

    Attributes
    ----------
    x, y : numpy.ndarray
        Places north and east of its centre [m], rounded, shape (P,).
    inner : numpy.ndarray of bool
        Those that move, all but the edge, shape (P,).
    triangles : numpy.ndarray
        Indices, shape (T, 3), upper side up.
    rim, rim_triangles : numpy.ndarray
        Flat water from the edge on, shapes (8, 3) [m] and (8, 3).
    waves : mapping or None
        What moves it, as ``sea.surface.elevation`` takes it; None: flat water.
    height : float
        Significant height of what it shows [m].
    step : float
        Time between two pictures [s].
    """

    x: np.ndarray
    y: np.ndarray
    inner: np.ndarray
    triangles: np.ndarray
    rim: np.ndarray
    rim_triangles: np.ndarray
    waves: Mapping[str, np.ndarray] | None
    height: float
    step: float

    def pictures(self, t: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Heights [m] in steps, and shades 0 to SHADES - 1, at some times about some places.

        Parameters
        ----------
        t : numpy.ndarray
            [s], shape (F,).
        places : numpy.ndarray
            North and east of the centre [m], shape (F, 2).

        Returns
        -------
        heights, shades : numpy.ndarray
            Shapes (F, P).
        """
        share = np.zeros((len(t), len(self.x)))
        if self.waves is not None:
            x, y = (line[self.inner] + place[:, None] for line, place in zip(
                (self.x, self.y), places.T, strict=True))  # fmt: skip
            share[:, self.inner] = elevation(self.waves, x, y, t[:, None]) / self.height
        shades = np.clip(np.rint((0.5 + _SHADE * share) * (SHADES - 1)), 0, SHADES - 1)
        return np.rint(share * _STEPS) * (self.height / _STEPS), shades.astype(int)


def _waves(meta: Mapping[str, Any]) -> dict[str, np.ndarray] | None:
    """Waves of a recording; None: there are none, or unknown."""
    waves = meta.get("waves")
    if not isinstance(waves, Mapping) or not set(WAVE_ENTRIES) <= waves.keys():
        return None
    found = {name: np.asarray(waves[name], dtype=float) for name in WAVE_ENTRIES}
    return found if found["amplitude"].any() else None


def wave_grid(meta: Mapping[str, Any], length: float, far: float) -> Grid:
    """Grid that fits a ship and the waves of her recording.

    Parameters
    ----------
    meta : mapping
        Of a trajectory.
    length : float
        Of the ship [m].
    far : float
        Distance to which the water goes on, flat [m].
    """
    waves = _waves(meta)
    if waves is None:
        line = np.array([-2.0, -1.0, 1.0, 2.0]) * length
        return _grid(line, line, far, 0.0, None, 0.0, math.inf)
    energy = waves["amplitude"] ** 2
    sine, cosine = (energy @ f(waves["direction_to"]) for f in (np.sin, np.cos))
    main = math.atan2(sine, cosine)
    aside = energy @ np.sin(waves["direction_to"] - main) ** 2 / energy.sum()
    wave = 2.0 * math.pi * energy.sum() / (energy @ waves["k"])
    half = float(np.clip(_WAVES_SEEN * wave, _LEAST_REACH * length, _REACH * length))
    along, across = _ALONG, 2
    if aside >= _SPREAD:
        along, across, half = _MOST_POINTS // _ACROSS, _ACROSS, min(half, _NARROW * length)
    period = 2.0 * math.pi * energy.sum() / (energy @ waves["omega"])
    kept = 2.0 * math.pi / waves["k"] >= _SHORTEST * 2.0 * half / (along - 1)
    waves = {name: values[kept] for name, values in waves.items()}
    step = max(period / _PER_PERIOD, _LEAST_STEP * math.sqrt(length / G))
    height = 4.0 * math.sqrt(0.5 * float(waves["amplitude"] @ waves["amplitude"]))
    lines = _line(half, along), _line(half, across)
    return _grid(*lines, far, main, waves if height > 0.0 else None, height, step)


def _line(half: float, count: int) -> np.ndarray:
    """Places along one axis: from -half to half, then the edge on both sides."""
    return np.concatenate([[-_EDGE * half], np.linspace(-half, half, count), [_EDGE * half]])


def _grid(along, across, far: float, main: float, waves, height: float, step: float) -> Grid:
    a, b = (part.ravel() for part in np.meshgrid(along, across, indexing="ij"))
    number = np.arange(len(a)).reshape(len(along), len(across))
    quads = (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
    inner = (np.abs(a) < along[-1]) & (np.abs(b) < across[-1])
    ends = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    rim = np.concatenate([ends * [along[-1], across[-1]], ends * far])
    ring = np.arange(4)
    sides = (ring + 4, (ring + 1) % 4 + 4, (ring + 1) % 4, ring)
    unit = 10.0 ** math.floor(math.log10(along[-1] / 500.0))  # round places pack better
    x, y = (np.rint(part / unit) * unit for part in _turned(a, b, main))
    edge = np.rint(np.stack(_turned(rim[:, 0], rim[:, 1], main), axis=1) / unit) * unit
    flat = np.column_stack([edge, np.zeros(len(edge))])
    return Grid(x, y, inner, _halves(*quads), flat, _halves(*sides), waves, height, step)


def _turned(a: np.ndarray, b: np.ndarray, main: float) -> tuple[np.ndarray, np.ndarray]:
    """North and east of places along and across a direction."""
    return a * math.cos(main) - b * math.sin(main), a * math.sin(main) + b * math.cos(main)


def _halves(aft, ahead, right, left) -> np.ndarray:
    """Two triangles for each quadrangle of corners, shape (T, 3)."""
    aft, ahead, right, left = (part.ravel() for part in (aft, ahead, right, left))
    return np.concatenate([np.stack([aft, right, ahead], 1), np.stack([aft, left, right], 1)])
