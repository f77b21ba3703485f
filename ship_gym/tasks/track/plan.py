"""Plans of a track: way-points, and where the ship starts."""

from __future__ import annotations

import math

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.physics.angles import north_east
from ship_gym.tasks.track.kernels import place_batch
from ship_gym.tracks.files import load_track
from ship_gym.tracks.generator import n_draws, random_points
from ship_gym.tracks.shapes import SHAPES
from ship_gym.tracks.track import Track


class Tracks:
    """Way-points; the ship starts abreast of the first one.

    Random tracks and shapes are in ship lengths and turned to any first bearing; given way-points
    stay where they are.
    """

    def __init__(self, scenario, ships):
        self._range, self._L = scenario.track, np.array([ship.hull.L for ship in ships])
        self._aside = scenario.start.cross_track
        self._points = self._fixed_points()
        self._check_turns()
        random = self._range.kind == "random"
        self._n_random = n_draws(self._range.legs) if random else 0
        rows = self._range.legs + 1 if random else len(self._points)
        self.shape = (rows, 2)
        self.n_draws = 1 + self._n_random

    def _fixed_points(self) -> np.ndarray | None:
        """Way-points that every episode sails, in metres or ship lengths; None: random ones."""
        kind = self._range.kind
        if kind == "random":
            return None
        if kind == "points":
            return load_track(self._range.file or list(self._range.points)).points
        return np.asarray(SHAPES[kind])

    def _check_turns(self) -> None:
        """Refuse a given track that one of the ships cannot sail."""
        if self._points is None or self._range.any_turns:
            return
        unit = 1.0 if self._range.kind == "points" else self._L.max()
        try:
            Track(self._points * unit).check_turns(self._range.turn_radius * self._L.max())
        except ConfigError as error:
            raise ConfigError(
                f"{error} (track.turn_radius = {self._range.turn_radius:g} L): lengthen the leg, "
                "turn less, or set track.any_turns"
            ) from None

    def make(self, which, uniform, order, plans, tasks):
        """See ``tasks.base.Plan``."""
        tasks["count"][which] = self.shape[0]
        L, bearing = self._L[which], order
        if self._range.kind == "points":
            plans[which] = self._points
        else:
            place_batch(which, self._made(uniform[:, 1:]), bearing, L, plans)
        legs = plans[which, 1] - plans[which, 0]
        bearing = np.array([math.atan2(e, n) for n, e in legs.tolist()])
        aside = self._aside * (2.0 * uniform[:, 0] - 1.0) * L
        north, east = np.zeros(len(which)), np.zeros(len(which))
        north_east(aside, bearing + 0.5 * math.pi, north, east)
        return plans[which, 0, 0] + north, plans[which, 0, 1] + east

    def _made(self, uniform: np.ndarray) -> np.ndarray:
        if self._range.kind != "random":
            return np.broadcast_to(self._points, (len(uniform), *self._points.shape))
        r = self._range
        return random_points(
            uniform,
            turn_radius=r.turn_radius,
            leg_min=r.leg_min,
            leg_max=r.leg_max,
            turn_max=math.radians(r.turn_max_deg),
        )
