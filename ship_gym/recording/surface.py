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

SHADES = 12  # of the water, from trough to crest
_ALONG, _ACROSS = 30, 8  # points along the main direction and across; long-crested: two across
_MOST_POINTS = 96  # of a short-crested sea
_REACH = 1.5  # half the length of the grid [L], less where the waves are short
_WAVES_SEEN = 2.5  # half the length of the grid at least, in waves
_LEAST_REACH = 0.75  # [L]
_SHORTEST = 3.0  # waves shorter than this many points are left out
_PER_PERIOD = 3.3  # pictures in a mean period, but not more than one in _LEAST_STEP sqrt(L/g)
_LEAST_STEP = 0.6
_STEPS = 9.0  # height steps in a significant height
_EDGE = 1.2  # flat edge of the grid, in halves of what moves
_SPREAD = 0.02  # mean square of the directions' sines from which a sea is short-crested


@dataclass(frozen=True)
class Components:
    """Regular waves of a sea, shapes (N,): zeta = sum a cos(omega t - k (x cos d + y sin d) + eps).

    Amplitude [m], frequency [rad/s], wave number [1/m], direction to which they go, from north
    [rad], phase [rad].
    """

    amplitude: np.ndarray
    omega: np.ndarray
    k: np.ndarray
    direction_to: np.ndarray
    phase: np.ndarray

    def elevation(self, t: float, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Height of the surface [m], upward, at time t [s] and places x north, y east [m]."""
        cosine, sine = np.cos(self.direction_to), np.sin(self.direction_to)
        along = np.multiply.outer(x, cosine) + np.multiply.outer(y, sine)
        return np.cos(self.omega * t + self.phase - self.k * along) @ self.amplitude


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
    components : Components or None
        What moves it; None: flat water.
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
    components: Components | None
    height: float
    step: float

    def picture(self, t: float, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Heights [m] in steps, and shades 0 to SHADES - 1, shapes (P,), about a place (x, y)."""
        heights = np.zeros(len(self.x))
        if self.components is not None:
            x, y = self.x[self.inner] + place[0], self.y[self.inner] + place[1]
            heights[self.inner] = self.components.elevation(t, x, y)
        share = heights / max(self.height, 1e-9)
        shades = np.clip(np.rint((0.5 + 0.8 * share) * (SHADES - 1)), 0, SHADES - 1)
        return np.rint(share * _STEPS) * (self.height / _STEPS), shades.astype(int)


def components_of(meta: Mapping[str, Any]) -> Components | None:
    """Waves of a recording: the entry ``waves`` of its meta; None: there are none, or unknown."""
    waves = meta.get("waves")
    if not isinstance(waves, Mapping) or not waves.get("amplitude"):
        return None
    names = Components.__dataclass_fields__
    if not names.keys() <= waves.keys():
        return None
    return Components(*(np.asarray(waves[name], dtype=float) for name in names))


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
    waves = components_of(meta)
    if waves is None:
        line = np.array([-2.0, -1.0, 1.0, 2.0]) * length
        return _grid(line, line, far, 0.0, None, 0.0, math.inf)
    energy = waves.amplitude**2
    sine, cosine = (energy @ f(waves.direction_to) for f in (np.sin, np.cos))
    main = math.atan2(sine, cosine)
    aside = energy @ np.sin(waves.direction_to - main) ** 2 / energy.sum()
    wave = 2.0 * math.pi * energy.sum() / (energy @ waves.k)
    half = float(np.clip(_WAVES_SEEN * wave, _LEAST_REACH * length, _REACH * length))
    if aside < _SPREAD:
        along, across = _ALONG, 2
    else:
        along, across = _MOST_POINTS // _ACROSS, _ACROSS
    period = 2.0 * math.pi * energy.sum() / (energy @ waves.omega)
    kept = 2.0 * math.pi / waves.k >= _SHORTEST * 2.0 * half / (along - 1)
    waves = Components(*(getattr(waves, name)[kept] for name in Components.__dataclass_fields__))
    step = max(period / _PER_PERIOD, _LEAST_STEP * math.sqrt(length / G))
    height = 4.0 * math.sqrt(0.5 * float(waves.amplitude @ waves.amplitude))
    return _grid(
        _line(half, along),
        _line(half, across),
        far,
        main,
        waves if height > 0.0 else None,
        height,
        step,
    )


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
    edge = np.rint(np.stack(_turned(*rim.T, main), axis=1) / unit) * unit
    flat = np.column_stack([edge, np.zeros(len(edge))])
    return Grid(x, y, inner, _halves(*quads), flat, _halves(*sides), waves, height, step)


def _turned(a: np.ndarray, b: np.ndarray, main: float) -> tuple[np.ndarray, np.ndarray]:
    """North and east of places along and across a direction."""
    return a * math.cos(main) - b * math.sin(main), a * math.sin(main) + b * math.cos(main)


def _halves(aft, ahead, right, left) -> np.ndarray:
    """Two triangles for each quadrangle of corners, shape (T, 3)."""
    aft, ahead, right, left = (part.ravel() for part in (aft, ahead, right, left))
    return np.concatenate([np.stack([aft, right, ahead], 1), np.stack([aft, left, right], 1)])
