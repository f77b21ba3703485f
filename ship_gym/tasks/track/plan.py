"""Plans of a track: way-points, and where the ship starts."""

from __future__ import annotations

import contextlib
import math
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, told_of
from ship_gym.physics.angles import north_east
from ship_gym.tasks.track.kernels import PORT, place_batch
from ship_gym.tracks.files import load_track
from ship_gym.tracks.generator import n_draws, random_points
from ship_gym.tracks.shapes import SHAPES
from ship_gym.tracks.track import Track

NARROWEST = 0.1  # limit of a leg [L], as of the scenario's corridor


class Tracks:
    """Way-points; the ship starts abreast of the first one.

    Random tracks and shapes are in ship lengths and turned to any first bearing; given way-points
    stay where they are. Where legs of these have limits of their own, a plan has two columns more,
    the corridor to port and to starboard of the leg that begins at the way-point.

    Attributes
    ----------
    track : Track or None
        What was given.
    """

    def __init__(self, scenario, ships):
        self._range, self._L = scenario.track, np.array([ship.hull.L for ship in ships])
        self._aside = scenario.start.cross_track
        self.track = _given(self._range)
        self._points = self._fixed_points()
        self._check_turns()
        self._corridor = scenario.limits.corridor * self._L
        with self._named():
            self._limits = _own_limits(self.track, self._L)
        self._n_random = n_draws(self._range.legs) if self._points is None else 0
        rows = self._range.legs + 1 if self._points is None else len(self._points)
        self.shape = (rows, 2 if self._limits is None else 4)
        self.n_draws = 1 + self._n_random

    @property
    def meta(self) -> dict[str, Any]:
        """Chart, route and its legs of a given track, as entries of a recording's meta."""
        track = self.track
        if track is None or track.chart is None:
            return {}
        found: dict[str, Any] = {"chart": track.chart.to_meta()}
        if track.route is not None:
            found["route"] = track.route.to_meta()
        if track.leg_of is not None:
            found["leg_of"] = np.asarray(track.leg_of).tolist()
        return found

    def _named(self) -> contextlib.AbstractContextManager:
        """Puts the file of the track before what is told of it."""
        return told_of(self._range.file) if self._range.file else contextlib.nullcontext()

    def _fixed_points(self) -> np.ndarray | None:
        """Way-points that every episode sails, in metres or ship lengths; None: random ones."""
        if self.track is not None:
            return self.track.points
        return None if self._range.kind == "random" else np.asarray(SHAPES[self._range.kind])

    def _check_turns(self) -> None:
        """Refuse a given track that one of the ships cannot sail."""
        if self._points is None or self._range.any_turns:
            return
        track = self.track or Track(self._points * self._L.max())
        try:
            with self._named():
                track.check_turns(self._range.turn_radius * self._L.max())
        except ConfigError as error:
            raise ConfigError(
                f"{error} (track.turn_radius = {self._range.turn_radius:g} L): lengthen the leg, "
                "turn less or wider, or set track.any_turns"
            ) from None

    def make(self, which, uniform, order, plans, tasks):
        """See ``tasks.base.Plan``."""
        tasks["count"][which] = self.shape[0]
        L, bearing = self._L[which], order
        if self._range.kind == "points":
            plans[which, :, :2] = self._points
            self._write_limits(which, plans)
        else:
            place_batch(which, self._made(uniform[:, 1:]), bearing, L, plans)
        legs = plans[which, 1, :2] - plans[which, 0, :2]
        bearing = np.array([math.atan2(e, n) for n, e in legs.tolist()])
        aside = self._aside * (2.0 * uniform[:, 0] - 1.0) * L
        north, east = np.zeros(len(which)), np.zeros(len(which))
        north_east(aside, bearing + 0.5 * math.pi, north, east)
        return plans[which, 0, 0] + north, plans[which, 0, 1] + east

    def _write_limits(self, which, plans) -> None:
        """Write the limits of the legs; a side without has the corridor of the scenario."""
        if self._limits is not None:
            given = self._limits[None]
            ours = self._corridor[which, None, None]
            plans[which, :-1, PORT:] = np.where(np.isnan(given), ours, given)
            plans[which, -1, PORT:] = plans[which, -2, PORT:]  # no leg begins at the last

    def _made(self, uniform: np.ndarray) -> np.ndarray:
        if self._points is not None:
            return np.broadcast_to(self._points, (len(uniform), *self._points.shape))
        r = self._range
        return random_points(
            uniform,
            turn_radius=r.turn_radius,
            leg_min=r.leg_min,
            leg_max=r.leg_max,
            turn_max=math.radians(r.turn_max_deg),
        )


def _given(section) -> Track | None:
    """The track of a section ``track`` that gives one."""
    if section.kind != "points":
        return None
    if section.geometry:
        return load_track(section.file, geometry=section.geometry)
    return load_track(section.file or list(section.points))


def _own_limits(track: Track | None, L: np.ndarray) -> np.ndarray | None:
    """Limits of the legs (W - 1, 2) [m], nan where there is none; None: no leg has any."""
    if track is None or track.limits is None or np.isnan(track.limits).all():
        return None
    smallest = NARROWEST * float(L.max())
    for leg, side in np.argwhere(track.limits < smallest)[:1]:
        raise ConfigError(
            f"track: {_leg_in_words(track, leg)} allows {track.limits[leg, side]:g} m to "
            f"{('port', 'starboard')[side]}; at least {smallest:.0f} m is needed, {NARROWEST:g} L"
        )
    return track.limits


def _leg_in_words(track: Track, leg: int) -> str:
    """A leg by what its route calls its end; an arc or a geodesic has many legs of the plane."""
    if track.route is None or track.leg_of is None:
        return f"leg {leg + 1}"
    return f"the leg to {track.route.label(int(track.leg_of[leg]) + 1)}"
