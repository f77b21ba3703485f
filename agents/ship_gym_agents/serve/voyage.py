"""Where a ship is on her route: what XTE and APB say of it."""

from __future__ import annotations

import math
import re
import unicodedata
from typing import NamedTuple

import numpy as np

from ship_gym.charts.geodesy import rhumb
from ship_gym.tracks.guidance import leg_axes, look_ahead_bearing, passed
from ship_gym.tracks.track import Track
from ship_gym_agents.serve.instruments import Seen

LOOK_AHEAD = 3.0  # ship lengths, of the heading to steer
CIRCLE = 2.0  # ship lengths, of arrival
_TURN = 2.0 * math.pi
_LONGEST = 10  # letters of a name


class OnLeg(NamedTuple):
    """A ship on the active leg.

    Attributes
    ----------
    cross : float
        Off the leg [m], positive to starboard of it.
    bearing : float
        Of the leg [rad].
    name : str
        Of the way-point that it leads to.
    bearing_there : float
        From the ship to that way-point, along a rhumb line [rad].
    to_steer : float
        Towards the point of the leg `LOOK_AHEAD` ahead of the ship [rad].
    arrived, passed : bool
        Within `CIRCLE` of the way-point; abeam of it or beyond.
    """

    cross: float
    bearing: float
    name: str
    bearing_there: float
    to_steer: float
    arrived: bool
    passed: bool


class Voyage:
    """Follows a ship along a track; a leg is over at the bisector of the angle at its end.

    Parameters
    ----------
    track : Track
        With a chart.
    length : float
        Of the ship [m].
    """

    def __init__(self, track: Track, length: float):
        assert track.chart is not None
        self._points, self._chart, self._length = track.points.tolist(), track.chart, length
        self._ends = ends_of(track)
        self.leg = 0  # of the plane

    def follow(self, now: Seen) -> None:
        """Take the next leg where the active one is over; call it at every instant."""
        while self.leg < len(self._points) - 2 and self._is_over(now):
            self.leg += 1

    def at(self, now: Seen) -> OnLeg:
        """Where she is on the active leg."""
        (x_a, y_a), (x_b, y_b) = self._points[self.leg : self.leg + 2]
        bearing, cross = math.atan2(y_b - y_a, x_b - x_a), self._axes(now, self.leg)[1]
        name, latitude, longitude = self._ends[self.leg]
        lat, lon = self._chart.place(now.north, now.east, self.leg)
        there = rhumb(lat, lon, latitude, longitude)
        return OnLeg(
            cross=cross,
            bearing=bearing % _TURN,
            name=name,
            bearing_there=float(there.bearing) % _TURN,
            to_steer=look_ahead_bearing(bearing, cross, LOOK_AHEAD * self._length) % _TURN,
            arrived=float(there.length) <= CIRCLE * self._length,
            passed=math.cos(float(there.bearing) - bearing) <= 0.0,
        )

    def _axes(self, now: Seen, leg: int) -> tuple[float, float, float]:
        return leg_axes(now.north, now.east, *self._points[leg], *self._points[leg + 1])

    def _is_over(self, now: Seen) -> bool:
        along, cross, length = self._axes(now, self.leg)
        return bool(passed(length - along, self._axes(now, self.leg + 1)[0], cross, 0.0))


def ends_of(track: Track) -> list[tuple[str, float, float]]:
    """Of each leg of the plane the way-point it leads to: name, latitude, longitude [deg].

    Of a route those are its own; an arc or a piece of a great circle leads to the next of them.
    """
    if track.route is None:
        assert track.chart is not None
        places = np.transpose(track.chart.place(*track.points.T)).tolist()
        return [(_named("", k), *places[k]) for k in range(1, len(places))]
    points = track.route.waypoints
    return [
        (_named(points[k].name, k), points[k].latitude, points[k].longitude)
        for k in (np.asarray(track.leg_of) + 1).tolist()
    ]


def _named(name: str, number: int) -> str:
    """A name in letters that a sentence may hold, W and the number of the way-point without one."""
    plain = unicodedata.normalize("NFKD", name)  # letters without their accents
    text = re.sub(r"[^A-Za-z0-9_. -]+", "", plain).strip()[:_LONGEST]
    return text or f"W{number:03d}"
