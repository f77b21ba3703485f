"""Lines on the WGS84 ellipsoid: rhumb lines (loxodromes) and geodesics (orthodromes).

A rhumb line keeps its bearing and is a straight line of the Mercator projection; its length is
the arc of the meridian divided by the cosine of the bearing, along a parallel the radius of the
parallel times the difference of longitude. Geodesics are pyproj's. Latitudes and longitudes in
deg, lengths in m, bearings in rad from north, clockwise; arrays of one shape, or numbers.
"""

from __future__ import annotations

import functools
from typing import Any, NamedTuple

import numpy as np

A = 6378137.0  # [m] equatorial radius of WGS84
FLATTENING = 1.0 / 298.257223563
E2 = FLATTENING * (2.0 - FLATTENING)  # eccentricity squared
HIGHEST = 89.0  # [deg] of latitude; a rhumb line winds round a pole without end
CLOSE = 0.4  # [m] between a geodesic and the pieces of rhumb line that stand for it
_LEVEL = 1e-4  # [deg]; between nearer latitudes the radius of the parallel is that of the middle
_SAMPLES = 10e3  # [m] between places where the curvature of a geodesic is looked at
_NO_PYPROJ = 'places on the earth need pyproj: pip install "ship-gym[geo]"'


class Line(NamedTuple):
    """Bearing at both ends [rad] and length [m] of a line from one place to another."""

    bearing: Any
    bearing_there: Any
    length: Any


def wrap_longitude(longitude: Any) -> Any:
    """The same longitude [deg] in [-180, 180); a number within them keeps its bits."""
    longitude = np.asarray(longitude, dtype=np.float64)
    within = (longitude >= -180.0) & (longitude < 180.0)
    return np.where(within, longitude, np.mod(longitude + 180.0, 360.0) - 180.0)


def short_way(longitude: Any, longitude_to: Any) -> Any:
    """Difference of longitude [deg] in [-180, 180)."""
    return wrap_longitude(np.subtract(longitude_to, longitude, dtype=np.float64))


def rhumb(latitude: Any, longitude: Any, latitude_to: Any, longitude_to: Any) -> Line:
    """Rhumb line to another place, the short way round the earth."""
    east = np.radians(short_way(longitude, longitude_to))
    north = _meridian_arc(latitude, latitude_to)
    east = east * _parallel(latitude, latitude_to, north)
    bearing = np.arctan2(east, north)
    return Line(bearing, bearing, np.hypot(north, east))


def rhumb_forward(latitude: Any, longitude: Any, bearing: Any, length: Any) -> tuple[Any, Any]:
    """Place at a length along a rhumb line: latitude, longitude in [-180, 180) [deg].

    Beyond a latitude of 89 deg it stays there.
    """
    north, east = length * np.cos(bearing), length * np.sin(bearing)
    latitude, longitude, north, east = np.broadcast_arrays(latitude, longitude, north, east)
    zero = np.zeros_like(north, dtype=np.float64)
    _, there, _ = _geod().fwd(zero, latitude.astype(np.float64), zero, north)
    there = np.clip(np.asarray(there), -HIGHEST, HIGHEST)
    return there, wrap_longitude(
        longitude + np.degrees(east / _parallel(latitude, there, _meridian_arc(latitude, there)))
    )


def geodesic(latitude: Any, longitude: Any, latitude_to: Any, longitude_to: Any) -> Line:
    """Shortest line to another place."""
    lines = np.broadcast_arrays(longitude, latitude, longitude_to, latitude_to)
    there, back, length = _geod().inv(*(np.array(v, dtype=np.float64) for v in lines))
    return Line(
        np.radians(np.asarray(there)),
        np.radians(wrap_longitude(np.asarray(back) + 180.0)),
        np.asarray(length),
    )


def geodesic_forward(latitude: Any, longitude: Any, bearing: Any, length: Any) -> tuple[Any, Any]:
    """Place at a length along a geodesic: latitude, longitude in [-180, 180) [deg]."""
    lines = np.broadcast_arrays(longitude, latitude, np.degrees(bearing), length)
    east, north, _ = _geod().fwd(*(np.array(v, dtype=np.float64) for v in lines))
    return np.asarray(north), wrap_longitude(east)


def geodesic_cuts(latitude: float, longitude: float, bearing: float, length: float) -> np.ndarray:
    """Where to cut a geodesic, so that rhumb lines from cut to cut stay within `CLOSE` of it.

    A rhumb line bends from a geodesic by tan(latitude) sin(bearing) / N (N: radius of curvature
    across the meridian), so a piece of length l by l^2 / 8 of that in its middle.

    Returns
    -------
    numpy.ndarray, shape (P + 1,)
        Lengths [m] from 0 to `length`, closer where latitudes are high.
    """
    at = np.linspace(0.0, length, max(9, int(length / _SAMPLES) + 1))
    lat, lon = geodesic_forward(latitude, longitude, bearing, at)
    course = geodesic(lat[:-1], lon[:-1], lat[1:], lon[1:]).bearing
    phi = np.radians(0.5 * (lat[:-1] + lat[1:]))
    bend = np.abs(np.tan(phi) * np.sin(course)) / _across(phi)
    pieces = np.concatenate([[0.0], np.cumsum(np.diff(at) * np.sqrt(bend / (8.0 * CLOSE)))])
    count = max(1, int(np.ceil(pieces[-1])))
    if count == 1:
        return np.array([0.0, length])
    cuts = np.interp(np.linspace(0.0, pieces[-1], count + 1), pieces, at)
    cuts[-1] = length
    return cuts


def mercator(latitude: Any) -> Any:
    """North [m] in the Mercator projection that is true to scale at the equator.

    East is `A` times the longitude [rad], with no jump where a line crosses the antimeridian.
    """
    latitude = np.array(latitude, dtype=np.float64)
    return _mercator()(np.zeros_like(latitude), latitude)[1]


def from_mercator(north: Any) -> Any:
    """Latitude [deg] of a place of the Mercator projection."""
    north = np.array(north, dtype=np.float64)
    return _mercator()(np.zeros_like(north), north, inverse=True)[1]


def scale(latitude: Any) -> Any:
    """Metres of the Mercator projection for one metre on the earth."""
    phi = np.radians(latitude)
    return A / (_across(phi) * np.cos(phi))


def _across(phi: Any) -> Any:
    """Radius of curvature [m] across the meridian at a latitude [rad]."""
    return A / np.sqrt(1.0 - E2 * np.sin(phi) ** 2)


def _meridian_arc(latitude: Any, latitude_to: Any) -> Any:
    """Length [m] of the meridian from one latitude to the other, positive to the north."""
    latitude, latitude_to = np.broadcast_arrays(latitude, latitude_to)
    zero = np.zeros(latitude.shape)
    *_, length = _geod().inv(
        zero, latitude.astype(np.float64), zero.copy(), latitude_to.astype(np.float64)
    )
    return np.where(latitude_to < latitude, -1.0, 1.0) * length


def _parallel(latitude: Any, latitude_to: Any, arc: Any) -> Any:
    """Radius [m] of the parallel: arc of the meridian by difference of isometric latitude.

    Between latitudes that are nearly one it is N cos(latitude).
    """
    latitude, latitude_to = np.asarray(latitude, np.float64), np.asarray(latitude_to, np.float64)
    phi = np.radians(0.5 * (latitude + latitude_to))
    level = np.abs(latitude_to - latitude) < _LEVEL
    apart = (mercator(latitude_to) - mercator(latitude)) / A
    return np.where(level, _across(phi) * np.cos(phi), arc / np.where(level, 1.0, apart))


@functools.cache
def _geod() -> Any:
    return _pyproj().Geod(a=A, f=FLATTENING)


@functools.cache
def _mercator() -> Any:
    return _pyproj().Proj("+proj=merc +ellps=WGS84 +units=m")


def _pyproj() -> Any:
    try:
        import pyproj
    except ImportError:
        raise ImportError(_NO_PYPROJ) from None
    return pyproj
