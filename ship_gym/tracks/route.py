"""`Route`: way-points on the earth, how the legs between them run, and the plane to sail it in.

A planned radius makes a turn an arc that touches both legs; great circles and arcs become short
rhumb lines, since every leg of the plane is one.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ship_gym.charts import Chart, geodesy
from ship_gym.config import ConfigError, build, shown
from ship_gym.conventions import wrap_angle
from ship_gym.tracks.arcs import SHORTEST_ARC, arc_places
from ship_gym.tracks.track import SHARPEST_TURN, SHORTEST_LEG, Track
from ship_gym.tracks.waypoint import Leg, Waypoint, check_count, checked_name

MOST_LEGS = 100_000  # of the plane
SHARPEST = math.radians(175.0)  # a planned turn; beyond it the leg is sailed back
_NO_LEG = 0.1  # [m]; between two arcs no straight piece is shorter


@dataclasses.dataclass(frozen=True)
class Route:
    """Way-points and the legs between them.

    Attributes
    ----------
    name : str
    waypoints : tuple of Waypoint
        At least two.
    legs : tuple of Leg
        Leg k leads from way-point k to k + 1; empty: rhumb lines without limits.

    Raises
    ------
    ConfigError
        Too few or too many way-points, not one leg fewer than those.
    """

    name: str
    waypoints: tuple[Waypoint, ...]
    legs: tuple[Leg, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", checked_name(self.name))
        waypoints, legs = tuple(self.waypoints), tuple(self.legs)
        check_count(len(waypoints))
        if len(waypoints) < 2:
            raise ConfigError(f"route: {len(waypoints)} way-point; a route needs at least 2")
        legs = legs or (Leg(),) * (len(waypoints) - 1)
        if len(legs) != len(waypoints) - 1:
            raise ConfigError(
                f"route: {len(legs)} legs for {len(waypoints)} way-points; must be one fewer"
            )
        object.__setattr__(self, "waypoints", waypoints)
        object.__setattr__(self, "legs", legs)

    def label(self, i: int) -> str:
        """Way-point `i` for people: ``way-point 3 (id 43, 'WP 3')``, counted from 0."""
        point = self.waypoints[i]
        told = [f"id {point.id}"] if point.id is not None else []
        told += [shown(point.name, 40)] if point.name else []
        return f"way-point {i} ({', '.join(told)})" if told else f"way-point {i}"

    def lines(self) -> geodesy.Line:
        """Bearings at both ends [rad] and lengths [m] of the legs, arrays of shape (W - 1,)."""
        lat, lon = self._places().T
        ends = lat[:-1], lon[:-1], lat[1:], lon[1:]
        rhumbs, geodesics = geodesy.rhumb(*ends), geodesy.geodesic(*ends)
        great = np.array([leg.geometry == "orthodrome" for leg in self.legs])
        return geodesy.Line(
            *(np.where(great, g, r) for g, r in zip(geodesics, rhumbs, strict=True))
        )

    def track(self) -> Track:
        """The route in its plane.

        Raises
        ------
        ConfigError
            A way-point that is there twice, a turn too sharp, a planned turn that does not fit its
            legs, a great circle across a pole; names the way-point.
        """
        lines = self.lines()
        for i in np.flatnonzero(~(lines.length >= SHORTEST_LEG))[:1]:
            raise ConfigError(
                f"{self.label(i + 1)}: {lines.length[i]:.3g} m from the one before, at least "
                f"{SHORTEST_LEG:g} m is needed; is it there twice?"
            )
        rooms, turns = self._rooms(lines)
        given, places = self._places(), []
        owners: list[int] = []
        for k in range(len(self.legs)):
            leg = self._cut(k, lines, rooms[k], lines.length[k] - rooms[k + 1])
            leg[[0, -1]] = np.where(  # an end that no arc cuts off is the way-point, bit by bit
                [[rooms[k] == 0.0], [rooms[k + 1] == 0.0]], given[k : k + 2], leg[[0, -1]]
            )
            places += list(leg[1:] if k > 0 and rooms[k] == 0.0 else leg)
            owners += [k] * (len(places) - len(owners))
            if rooms[k + 1] > 0.0:
                after = self._at(k + 1, lines, np.array([rooms[k + 1]]))[0]
                arc = arc_places(places[-1], after, turns[k + 1])
                places += list(arc)
                owners += [k + (2 * j >= len(arc)) for j in range(len(arc))]
        return self._laid(np.array(places), np.array(owners[1:]))

    def _laid(self, places: np.ndarray, owners: np.ndarray) -> Track:
        """Track of places (P, 2) and of the route's leg of each of the P - 1 between them."""
        if len(owners) > MOST_LEGS:
            raise ConfigError(
                f"route: {len(owners)} straight pieces stand for its great circles and turns; "
                f"at most {MOST_LEGS} are allowed"
            )
        if np.abs(places[:, 0]).max() > geodesy.HIGHEST:
            i = owners[max(0, int(np.argmax(np.abs(places[:, 0]))) - 1)]
            raise ConfigError(
                f"route: the leg from {self.label(i)} to {i + 1} passes a pole nearer than "
                f"latitude {geodesy.HIGHEST:g} deg; let it pass elsewhere"
            )
        chart = Chart.laid(places[:, 0], places[:, 1])
        limits = [[leg.port or math.nan, leg.starboard or math.nan] for leg in self.legs]
        return Track(
            np.stack([chart.north, chart.east], axis=-1),
            chart=chart,
            route=self,
            limits=np.array(limits, dtype=np.float64)[owners],
            leg_of=owners,
        )

    def check_turns(self, radius: float) -> None:
        """Refuse a route that a ship with a turning radius [m] cannot sail.

        Where a planned radius R is smaller, her own arc of radius r must fit the legs, too, and
        keep within the limits of both: at a turn D it passes (r - R) (1 / cos(D / 2) - 1) inside
        the planned one.
        """
        lines = self.lines()
        turns = _turns(lines)
        sizes = np.minimum(np.abs(turns), SHARPEST)
        planned = np.array([point.radius or np.inf for point in self.waypoints])
        inside = np.maximum(radius - planned, 0.0) * (1.0 / np.cos(0.5 * sizes) - 1.0)
        limits = self._limits_inside(turns)
        for i in np.flatnonzero(inside > limits)[:1]:
            raise ConfigError(
                f"route: {self.label(i)} has a planned radius of {planned[i]:.0f} m; at the ship's "
                f"turning radius of {radius:.0f} m she passes {inside[i]:.0f} m inside it, the "
                f"limits of its legs are {limits[i]:.0f} m"
            )
        own = np.maximum(np.where(np.isfinite(planned), planned, 0.0), radius)
        need = own * np.tan(0.5 * sizes)
        for i in np.flatnonzero(lines.length < (need[:-1] + need[1:]) * (1.0 - 1e-9))[:1]:
            before, after = np.degrees(sizes[i : i + 2])
            raise ConfigError(
                f"route: the leg from {self.label(i)} to {i + 1} is {lines.length[i]:.0f} m long; "
                f"turns of {before:.0f} and {after:.0f} deg at its ends need "
                f"{need[i] + need[i + 1]:.0f} m at a turning radius of {radius:.0f} m"
            )

    def _limits_inside(self, turns: np.ndarray) -> np.ndarray:
        """Smaller limit of the two legs on the inner side of each turn [m], shape (W,)."""
        sides = [[leg.port or np.inf, leg.starboard or np.inf] for leg in self.legs]
        none = [np.inf, np.inf]
        both = np.minimum([none, *sides], [*sides, none])
        return np.where(turns < 0.0, both[:, 0], both[:, 1])

    def to_meta(self) -> dict[str, Any]:
        """The route as plain values, for a recording's meta."""
        return dataclasses.asdict(self)

    @classmethod
    def from_meta(cls, meta: Mapping[str, Any]) -> Route:
        """The route of `to_meta`.

        Raises
        ------
        ConfigError
            Something else.
        """
        return build(cls, meta, "route")

    def _places(self) -> np.ndarray:
        """Latitude and longitude [deg] of the way-points, shape (W, 2)."""
        return np.array([[point.latitude, point.longitude] for point in self.waypoints])

    def _rooms(self, lines: geodesy.Line) -> tuple[np.ndarray, np.ndarray]:
        """What the planned turns take of both legs [m], and the changes of course; shape (W,)."""
        turns = _turns(lines)
        radii = np.array([point.radius or 0.0 for point in self.waypoints])
        sharpest = np.where(radii > 0.0, SHARPEST, SHARPEST_TURN)
        for i in np.flatnonzero(np.abs(turns) > sharpest * (1.0 + 1e-12))[:1]:
            raise ConfigError(
                f"{self.label(i)}: the route turns by {math.degrees(turns[i]):.1f} deg, allowed "
                f"is {math.degrees(sharpest[i]):.0f} deg to either side"
            )
        rooms = radii * np.tan(0.5 * np.abs(turns))
        rooms[rooms < SHORTEST_ARC] = 0.0
        over = rooms[:-1] + rooms[1:] > lines.length * (1.0 + 1e-9)
        for k in np.flatnonzero(over)[:1]:
            i = k + int(rooms[k + 1] >= rooms[k])  # the turn that takes more
            raise ConfigError(
                f"{self.label(i)}: a planned turn of {abs(math.degrees(turns[i])):.0f} deg with "
                f"radius {radii[i]:.0f} m needs {rooms[i]:.0f} m of the leg from way-point {k} to "
                f"{k + 1}; it has {max(0.0, lines.length[k] - rooms[2 * k + 1 - i]):.0f} m"
            )
        return rooms, turns

    def _cut(self, k: int, lines: geodesy.Line, start: float, end: float) -> np.ndarray:
        """Places (P, 2) that stand for leg `k` from one length along it to another [m]."""
        length = lines.length[k]
        if start == 0.0 and end == length and self.legs[k].geometry == "loxodrome":
            return self._ends(k)
        at = np.array([start, end] if end - start > _NO_LEG or end == length else [start])
        if self.legs[k].geometry == "orthodrome":
            place = self.waypoints[k]
            cuts = geodesy.geodesic_cuts(place.latitude, place.longitude, lines.bearing[k], length)
            between = (cuts > start + SHORTEST_ARC) & (cuts < end - SHORTEST_ARC)
            at = np.concatenate([at[:1], cuts[between], at[1:]])
        return self._at(k, lines, at)

    def _ends(self, k: int) -> np.ndarray:
        """Places (2, 2) of the way-points of leg `k`."""
        ends = self.waypoints[k : k + 2]
        return np.array([[point.latitude, point.longitude] for point in ends])

    def _at(self, k: int, lines: geodesy.Line, at: np.ndarray) -> np.ndarray:
        """Places (P, 2) at lengths along leg `k` [m]."""
        great = self.legs[k].geometry == "orthodrome"
        forward = geodesy.geodesic_forward if great else geodesy.rhumb_forward
        place = self.waypoints[k]
        return np.stack(forward(place.latitude, place.longitude, lines.bearing[k], at), axis=-1)


def _turns(lines: geodesy.Line) -> np.ndarray:
    """Changes of course at the way-points [rad], positive to starboard; 0 at both ends."""
    turns = -wrap_angle(lines.bearing_there[:-1] - lines.bearing[1:])
    return np.concatenate([[0.0], turns, [0.0]])
