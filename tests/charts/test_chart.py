"""The plane of a route and the earth: there and back, along legs and beside them."""

import json
import math

import numpy as np
import pytest

from ship_gym.charts import Chart, geodesy
from ship_gym.config import ConfigError

pytest.importorskip("pyproj", reason="extra 'geo' not installed")

LATITUDE = [60.0, 60.5, 60.5, 59.0, -5.0, -40.0]
LONGITUDE = [170.0, 175.0, -178.0, -170.0, -165.0, 178.0]


def between(a, b):
    """Distance [m] by geographiclib."""
    wgs84 = pytest.importorskip("geographiclib.geodesic").Geodesic.WGS84
    return wgs84.Inverse(float(a[0]), float(a[1]), float(b[0]), float(b[1]))["s12"]


def test_legs_have_their_true_bearing_and_length():
    chart = Chart.laid(LATITUDE, LONGITUDE)
    assert (chart.north[0], chart.east[0]) == (0.0, 0.0)
    line = geodesy.rhumb(LATITUDE[:-1], LONGITUDE[:-1], LATITUDE[1:], LONGITUDE[1:])
    np.testing.assert_allclose(np.hypot(np.diff(chart.north), np.diff(chart.east)), line.length)
    assert line.length[1] < 400e3  # the short way over the antimeridian


def test_waypoints_lie_where_they_are():
    chart = Chart.laid(LATITUDE, LONGITUDE)
    lat, lon = chart.place(chart.north, chart.east)
    np.testing.assert_allclose(lat, LATITUDE, atol=1e-9)
    np.testing.assert_allclose(lon, LONGITUDE, atol=1e-9)


@pytest.mark.parametrize("aside", [-2000.0, 0.0, 50.0, 5000.0])
def test_there_and_back_beside_the_route(aside):
    chart = Chart.laid(LATITUDE, LONGITUDE)
    legs = np.repeat(np.arange(5), 7)
    share = np.tile(np.linspace(0.1, 0.9, 7), 5)
    dn, de = np.diff(chart.north)[legs], np.diff(chart.east)[legs]
    length = np.hypot(dn, de)
    x = chart.north[legs] + share * dn - aside * de / length
    y = chart.east[legs] + share * de + aside * dn / length
    lat, lon = chart.place(x, y, legs)
    np.testing.assert_allclose(chart.place(x, y), (lat, lon), atol=1e-12)
    assert (lon >= -180.0).all() and (lon < 180.0).all()
    back = chart.plane(lat, lon)
    np.testing.assert_allclose(back, (x, y), atol=1e-5)


def test_square_to_the_leg_the_distance_is_true():
    chart = Chart.laid(LATITUDE, LONGITUDE)
    on = chart.place(0.4 * chart.north[1], 0.4 * chart.east[1], 0)
    bearing = math.atan2(chart.east[1], chart.north[1])
    x = 0.4 * chart.north[1] - 800.0 * math.sin(bearing)
    y = 0.4 * chart.east[1] + 800.0 * math.cos(bearing)
    assert between(on, chart.place(x, y, 0)) == pytest.approx(800.0, abs=1e-5)


def test_the_leg_that_is_sailed_is_used_where_two_cross():
    """Round a square of 100 km the plane does not close: the last leg ends beside the first."""
    chart = Chart.laid([60.0, 61.0, 61.0, 60.0, 60.0], [5.0, 5.0, 7.0, 7.0, 5.0])
    gap = math.hypot(chart.north[-1], chart.east[-1])
    south, north = (geodesy.rhumb(lat, 5.0, lat, 7.0).length for lat in (60.0, 61.0))
    assert gap == pytest.approx(south - north, abs=1e-3)  # 3.4 km
    for leg, expected in ((0, chart.place(0.0, 0.0, 0)), (3, (60.0, 5.0))):
        end = 0 if leg == 0 else -1
        place = chart.place(chart.north[end], chart.east[end], leg)
        assert between(place, expected) < 1e-3


def test_about_a_place_distance_and_bearing_are_true():
    chart = Chart.about(-33.9, 179.9)
    x, y = np.array([0.0, 3e4, -2e5]), np.array([1e3, 4e4, 1e5])
    lat, lon = chart.place(x, y)
    for i in range(3):
        assert between((-33.9, 179.9), (lat[i], lon[i])) == pytest.approx(math.hypot(x[i], y[i]))
    np.testing.assert_allclose(chart.plane(lat, lon), (x, y), atol=1e-6)
    assert [float(v) for v in chart.plane(-33.9, 179.9)] == [0.0, 0.0]


def test_single_numbers():
    chart = Chart.laid(LATITUDE, LONGITUDE)
    lat, lon = chart.place(1000.0, 2000.0)
    assert lat.shape == lon.shape == ()
    np.testing.assert_allclose(chart.plane(lat, lon), (1000.0, 2000.0), atol=1e-5)


@pytest.mark.parametrize("chart", [Chart.laid(LATITUDE, LONGITUDE), Chart.about(54.0, 10.0)])
def test_a_recording_keeps_it(chart):
    again = Chart.from_meta(json.loads(json.dumps(chart.to_meta())))
    for name in ("latitude", "longitude", "north", "east"):
        assert getattr(again, name).tolist() == getattr(chart, name).tolist()


@pytest.mark.parametrize(
    "meta",
    [
        {},
        {"latitude": [1.0], "longitude": [2.0], "north": [0.0]},
        {"latitude": [1.0], "longitude": [2.0], "north": [0.0], "east": [0.0, 1.0]},
        {"latitude": ["x"], "longitude": [2.0], "north": [0.0], "east": [0.0]},
        {"latitude": [math.nan], "longitude": [2.0], "north": [0.0], "east": [0.0]},
        {"latitude": [], "longitude": [], "north": [], "east": []},
    ],
)
def test_a_damaged_one_is_refused(meta):
    with pytest.raises(ConfigError, match="chart"):
        Chart.from_meta(meta)


@pytest.mark.parametrize("place", [(91.0, 0.0), (89.5, 0.0), (0.0, 181.0), (math.nan, 0.0)])
def test_a_place_off_the_chart_is_refused(place):
    with pytest.raises(ConfigError, match="itude"):
        Chart.about(*place)


def test_a_ring_does_not_close_in_the_plane():
    """100 km north, east, south at 60 N and back: meridians meet."""
    latitude, longitude = [60.0], [10.0]
    for bearing in (0.0, 0.5 * np.pi, np.pi):
        place = geodesy.rhumb_forward(latitude[-1], longitude[-1], bearing, 100e3)
        latitude.append(float(place[0]))
        longitude.append(float(place[1]))
    chart = Chart.laid([*latitude, 60.0], [*longitude, 10.0])
    left = np.hypot(chart.north[-1], chart.east[-1])
    assert left == pytest.approx(2.8e3, abs=50.0)  # docs/routes.md
    assert left == pytest.approx(100e3**2 * np.tan(np.radians(60.45)) / 6.39e6, rel=0.02)
