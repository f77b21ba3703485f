"""`Chart`: where the simulator's north and east [m] lie on the earth.

A ship's motion knows no place, only north. So the plane is local and goes with the route: each leg
is laid down with its true bearing and length, one behind the other. Along the route headings,
lengths and distances from it are those on the earth; only the last way-point of a route that goes
round in a ring does not come back to the first.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np

from ship_gym.charts import geodesy
from ship_gym.config import ConfigError, check_number, shown

_FIELDS = ("latitude", "longitude", "north", "east")
_ROUNDS = 30  # of the search for a place on a leg; it gains three digits a round near the route
_EXACT = 1e-7  # [m]
_AT_ONCE = 1 << 21  # pairs of a place and a leg


@dataclasses.dataclass(frozen=True, eq=False)
class Chart:
    """Way-points on the earth and in the plane, joined by rhumb lines.

    Attributes
    ----------
    latitude, longitude : numpy.ndarray, shape (W,)
        WGS84 [deg]; with W = 1 the plane about one place, see `about`.
    north, east : numpy.ndarray, shape (W,)
        The same way-points in the plane [m].
    """

    latitude: np.ndarray
    longitude: np.ndarray
    north: np.ndarray
    east: np.ndarray

    def __post_init__(self) -> None:
        for name in _FIELDS:
            array = np.array(getattr(self, name), dtype=np.float64).reshape(-1)
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    @classmethod
    def about(cls, latitude: float, longitude: float) -> Chart:
        """The plane about a place: distance and bearing from there are true.

        Raises
        ------
        ConfigError
            A latitude outside 89 or a longitude outside 180 deg.
        """
        latitude = check_number("latitude", latitude, -geodesy.HIGHEST, geodesy.HIGHEST, "deg")
        longitude = check_number("longitude", longitude, -180.0, 180.0, "deg")
        columns: Any = ([value] for value in (latitude, longitude, 0.0, 0.0))
        return cls(*columns)

    @classmethod
    def laid(cls, latitude: Any, longitude: Any) -> Chart:
        """The plane of a route: rhumb lines between way-points [deg], laid end to start."""
        latitude = np.asarray(latitude, dtype=np.float64)
        longitude = geodesy.wrap_longitude(longitude)
        legs = geodesy.rhumb(latitude[:-1], longitude[:-1], latitude[1:], longitude[1:])
        north = np.concatenate([[0.0], np.cumsum(legs.length * np.cos(legs.bearing))])
        east = np.concatenate([[0.0], np.cumsum(legs.length * np.sin(legs.bearing))])
        return cls(latitude, longitude, north, east)

    def place(self, x: Any, y: Any, leg: Any = None) -> tuple[np.ndarray, np.ndarray]:
        """Places on the earth of places in the plane.

        Along the rhumb line of a leg, then square to it along a geodesic.

        Parameters
        ----------
        x, y : array_like, shape (T,) or one number
            North and east [m].
        leg : array_like of int, shape (T,), optional
            Leg of the plane that is sailed at each instant; without it the nearest one.

        Returns
        -------
        latitude, longitude : numpy.ndarray
            WGS84 [deg], of the shape of `x`; longitudes in [-180, 180).
        """
        x, y = np.broadcast_arrays(np.asarray(x, np.float64), np.asarray(y, np.float64))
        if len(self.north) == 1:
            x, y = x - self.north[0], y - self.east[0]
            bearing = np.arctan2(y, x)
            return geodesy.geodesic_forward(
                self.latitude[0], self.longitude[0], bearing, np.hypot(x, y)
            )
        if leg is None:
            leg = _nearest(x.ravel(), y.ravel(), self.north, self.east).reshape(x.shape)
        leg = np.clip(np.asarray(leg, dtype=np.int64), 0, len(self.north) - 2)
        bearing = self._bearings[leg]
        along, across = _turned(x - self.north[leg], y - self.east[leg], bearing)
        return self._place_on(leg, along, across)

    def plane(self, latitude: Any, longitude: Any) -> tuple[np.ndarray, np.ndarray]:
        """Places in the plane [m], north and east, of places on the earth [deg].

        The inverse of `place` about the nearest leg; exact also far from it with `about`.
        """
        lat, lon = np.broadcast_arrays(
            np.asarray(latitude, np.float64), np.asarray(longitude, np.float64)
        )
        if len(self.north) == 1:
            line = geodesy.geodesic(self.latitude[0], self.longitude[0], lat, lon)
            north, east = line.length * np.cos(line.bearing), line.length * np.sin(line.bearing)
            return self.north[0] + north, self.east[0] + east
        leg, along = self._foot(lat.ravel(), lon.ravel())
        leg, along = leg.reshape(lat.shape), along.reshape(lat.shape)
        bearing, across = self._bearings[leg], np.zeros(lat.shape)
        for _ in range(_ROUNDS):
            found_lat, found_lon = self._place_on(leg, along, across)
            miss = geodesy.geodesic(found_lat, found_lon, lat, lon)
            ahead = miss.length * np.cos(miss.bearing - bearing)
            along, across = along + ahead, across + miss.length * np.sin(miss.bearing - bearing)
            if not (miss.length > _EXACT).any():
                break
        cos, sin = np.cos(bearing), np.sin(bearing)
        return (
            self.north[leg] + along * cos - across * sin,
            self.east[leg] + along * sin + across * cos,
        )

    def to_meta(self) -> dict[str, Any]:
        """The chart as plain lists, for a recording's meta."""
        return {name: getattr(self, name).tolist() for name in _FIELDS}

    @classmethod
    def from_meta(cls, meta: Mapping[str, Any]) -> Chart:
        """The chart of `to_meta`.

        Raises
        ------
        ConfigError
            Something else.
        """
        arrays = []
        for name in _FIELDS:
            try:
                arrays.append(np.asarray(meta[name], dtype=np.float64))
            except (KeyError, TypeError, ValueError):
                raise ConfigError(f"chart: {name!r} must be a list of numbers") from None
            good = arrays[-1].ndim == 1 and len(arrays[-1]) > 0 and np.isfinite(arrays[-1]).all()
            if not good or arrays[-1].shape != arrays[0].shape:
                told = shown(np.asarray(arrays[-1]).tolist())
                raise ConfigError(f"chart.{name} = {told}: must be as many finite numbers")
        return cls(*arrays)

    @property
    def _bearings(self) -> np.ndarray:
        return np.arctan2(np.diff(self.east), np.diff(self.north))

    def _place_on(self, leg: Any, along: Any, across: Any) -> Any:
        """Places at a length along a leg and across it [m], to starboard."""
        bearing = self._bearings[leg]
        lat, lon = geodesy.rhumb_forward(self.latitude[leg], self.longitude[leg], bearing, along)
        return geodesy.geodesic_forward(lat, lon, bearing + 0.5 * np.pi, across)

    def _foot(self, latitude: Any, longitude: Any) -> Any:
        """Nearest leg in the Mercator projection, and how far along it its nearest place is [m]."""
        per_deg = geodesy.A * np.pi / 180.0
        turns = geodesy.short_way(self.longitude[:-1], self.longitude[1:])
        north = geodesy.mercator(self.latitude)
        east = per_deg * (self.longitude[0] + np.concatenate([[0.0], np.cumsum(turns)]))
        y, x = geodesy.mercator(latitude), per_deg * longitude
        round_earth = 360.0 * per_deg
        leg = _nearest(y, x, north, east, round_earth)
        middle = 0.5 * (east[leg] + east[leg + 1])
        x = x - round_earth * np.round((x - middle) / round_earth)
        dn, de = north[leg + 1] - north[leg], east[leg + 1] - east[leg]
        share = ((y - north[leg]) * dn + (x - east[leg]) * de) / (dn * dn + de * de)
        share = np.clip(share, 0.0, 1.0)
        foot = (
            geodesy.from_mercator(north[leg] + share * dn),
            self.longitude[leg] + share * de / per_deg,
        )
        line = geodesy.rhumb(self.latitude[leg], self.longitude[leg], *foot)
        return leg, line.length


def _turned(north: Any, east: Any, bearing: Any) -> Any:
    """Along and across (to starboard) a bearing [m]."""
    cos, sin = np.cos(bearing), np.sin(bearing)
    return north * cos + east * sin, east * cos - north * sin


def _nearest(x: Any, y: Any, north: Any, east: Any, period: Any = None) -> np.ndarray:
    """Number of the nearest leg for each place, shape (T,); `period` [m] goes round the earth."""
    dn, de = np.diff(north), np.diff(east)
    length = np.maximum(dn * dn + de * de, np.finfo(float).tiny)
    found = np.empty(len(x), dtype=np.int64)
    at_once = max(1, _AT_ONCE // len(dn))
    for start in range(0, len(x), at_once):
        part = slice(start, start + at_once)
        n, e = x[part, None] - north[:-1], y[part, None] - east[:-1]
        if period is not None:
            e = e - period * np.round((e - 0.5 * de) / period)
        share = np.clip((n * dn + e * de) / length, 0.0, 1.0)
        found[part] = np.argmin((n - share * dn) ** 2 + (e - share * de) ** 2, axis=1)
    return found
