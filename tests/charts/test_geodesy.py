"""Rhumb lines against the closed formula by quadrature, geodesics against geographiclib."""

import math
import sys

import numpy as np
import pytest
from scipy.integrate import quad

from ship_gym.charts import geodesy

pytest.importorskip("pyproj", reason="extra 'geo' not installed")

A, E2 = 6378137.0, 0.0066943799901413165  # WGS84: equatorial radius [m], eccentricity squared
PLACES = [(0.0, 0.0), (54.0, 10.0), (60.0, 5.0), (60.0, 178.0), (-33.9, -179.0), (78.0, 15.0)]
BEARINGS = [0.0, 37.0, 90.0, 90.001, 135.0, 180.0, 233.0, 270.0, 315.0]


def meridian_arc(latitude, latitude_to):
    """Integral of the radius of curvature M = a (1 - e2) / (1 - e2 sin^2)^1.5 [m]."""
    return quad(
        lambda phi: A * (1.0 - E2) / (1.0 - E2 * math.sin(phi) ** 2) ** 1.5,
        math.radians(latitude),
        math.radians(latitude_to),
        epsabs=1e-7,
    )[0]


def isometric(latitude):
    sine, e = math.sin(math.radians(latitude)), math.sqrt(E2)
    return math.atanh(sine) - e * math.atanh(e * sine)


def closed_rhumb(latitude, longitude, latitude_to, longitude_to):
    """Bearing [rad] and length [m]: arc of the meridian / cos, along a parallel N cos(lat) dlon."""
    east = math.radians((longitude_to - longitude + 180.0) % 360.0 - 180.0)
    if latitude == latitude_to:
        phi = math.radians(latitude)
        across = A / math.sqrt(1.0 - E2 * math.sin(phi) ** 2) * math.cos(phi)
        return math.copysign(0.5 * math.pi, east), abs(east) * across
    bearing = math.atan2(east, isometric(latitude_to) - isometric(latitude))
    return bearing, meridian_arc(latitude, latitude_to) / math.cos(bearing)


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("bearing", BEARINGS)
def test_a_rhumb_line_of_500_km_is_the_closed_formula(place, bearing):
    bearing = math.radians(bearing)
    there = geodesy.rhumb_forward(*place, bearing, 500e3)
    line = geodesy.rhumb(*place, *there)
    assert line.length == pytest.approx(500e3, abs=1e-3)
    assert math.remainder(line.bearing - bearing, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-9)
    expected, length = closed_rhumb(*place, *map(float, there))
    if abs(math.cos(bearing)) > 1e-3:  # near due east the formula itself loses its digits
        assert length == pytest.approx(500e3, abs=1e-2)
        assert math.remainder(expected - bearing, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-8)


def test_250_km_due_east_at_60_deg():
    """Along the parallel, not 2.1 km off it as a projection about the start would have it."""
    phi = math.radians(60.0)
    radius = A / math.sqrt(1.0 - E2 * math.sin(phi) ** 2) * math.cos(phi)
    longitude = 5.0 + math.degrees(250e3 / radius)
    line = geodesy.rhumb(60.0, 5.0, 60.0, longitude)
    assert line.bearing == pytest.approx(0.5 * math.pi, abs=1e-12)
    assert line.length == pytest.approx(250e3, abs=1e-3)
    assert geodesy.rhumb_forward(60.0, 5.0, 0.5 * math.pi, 250e3)[0] == pytest.approx(60.0)


def test_from_level_to_oblique_there_is_no_jump():
    """The two formulas meet where one gives way to the other."""
    steps = np.array([0.9e-4, 0.99e-4, 1.01e-4, 1.1e-4])
    line = geodesy.rhumb(60.0, 5.0, 60.0 + steps, 14.0)
    exact = [closed_rhumb(60.0, 5.0, 60.0, 14.0)[1]] * 4
    np.testing.assert_allclose(line.length, exact, atol=10.0)  # a parallel of 11 m farther north
    assert np.ptp(line.length - np.interp(steps, steps[[0, 3]], line.length[[0, 3]])) < 1e-3


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("bearing", BEARINGS)
def test_geodesics_are_those_of_geographiclib(place, bearing):
    wgs84 = pytest.importorskip("geographiclib.geodesic").Geodesic.WGS84
    lat, lon = geodesy.geodesic_forward(*place, math.radians(bearing), 500e3)
    known = wgs84.Direct(*place, bearing, 500e3)
    apart = wgs84.Inverse(float(lat), float(lon), known["lat2"], known["lon2"])["s12"]
    assert apart < 1e-6
    line = geodesy.geodesic(*place, lat, lon)
    assert line.length == pytest.approx(500e3, abs=1e-6)
    there = math.radians(known["azi2"])
    assert math.remainder(line.bearing_there - there, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-9)


def test_longitudes_keep_their_bits():
    given = [-180.0, -158.686186, 0.1, 179.999, 180.0, 180.05, 540.0, -190.0]
    expected = [-180.0, -158.686186, 0.1, 179.999, -180.0, -179.95, -180.0, 170.0]
    np.testing.assert_allclose(geodesy.wrap_longitude(given), expected, atol=1e-12)
    assert geodesy.wrap_longitude(given)[:4].tolist() == given[:4]


def test_cuts_are_closer_where_the_latitude_is_high():
    cuts = geodesy.geodesic_cuts(0.0, 0.0, math.radians(40.0), 5e6)
    pieces = np.diff(cuts)
    assert cuts[0] == 0.0 and cuts[-1] == 5e6 and pieces.min() > 1e3
    assert pieces[0] > 2.0 * pieces[-1]
    assert geodesy.geodesic_cuts(50.0, 0.0, 0.0, 3e6).tolist() == [0.0, 3e6]  # a meridian is both


def test_without_pyproj_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "pyproj", None)
    geodesy._geod.cache_clear()
    geodesy._mercator.cache_clear()
    with pytest.raises(ImportError, match=r"ship-gym\[geo\]"):
        geodesy.rhumb(0.0, 0.0, 1.0, 1.0)
