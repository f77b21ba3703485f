"""Logged tracks become routes: what is left out lies near, the ends stay."""

import numpy as np
import pytest

from ship_gym.charts import Chart
from ship_gym.config import ConfigError
from ship_gym.tracks import Leg, Route, Waypoint, load_route, simplified

pytest.importorskip("pyproj")


def logged(noise, count=400):
    """A place each second along two legs of 10 m/s, with a receiver's noise [m]."""
    north = np.r_[np.arange(count) * 10.0, np.full(count, count * 10.0)]
    east = np.r_[np.zeros(count), np.arange(count) * 10.0]
    aside = np.random.default_rng(1).normal(0.0, noise, (2, 2 * count))
    chart = Chart.about(54.0, 179.99)  # over the antimeridian
    latitude, longitude = chart.place(north + aside[0], east + aside[1])
    return Route("log", tuple(map(Waypoint, latitude.tolist(), longitude.tolist())))


def test_two_legs_of_a_log_are_two_legs():
    route = simplified(logged(2.0), 20.0)
    assert len(route.waypoints) == 3
    assert route.waypoints[0] == logged(2.0).waypoints[0]
    track = route.track()
    assert track.leg_lengths == pytest.approx([4000.0, 4000.0], abs=30.0)
    assert np.degrees(track.course_changes) == pytest.approx([90.0], abs=1.0)


@pytest.mark.parametrize("distance", [2.0, 5.0, 30.0])
def test_what_goes_lies_within_the_distance(distance):
    log = logged(0.5)
    chart = simplified(log, distance).track().chart
    places = [(point.latitude, point.longitude) for point in log.waypoints]
    x, y = chart.plane(*np.array(places).T)
    points = np.stack([chart.north, chart.east], axis=-1)
    a, b = points[:-1, None], points[1:, None]
    here = np.stack([x, y], axis=-1)
    share = np.clip(((here - a) * (b - a)).sum(-1) / ((b - a) ** 2).sum(-1), 0.0, 1.0)
    off = np.linalg.norm(here - (a + share[..., None] * (b - a)), axis=-1).min(axis=0)
    assert off.max() < distance + 0.2


def test_what_would_be_lost_is_refused():
    points = (Waypoint(54.0, 8.0), Waypoint(54.1, 8.0, radius=500.0), Waypoint(54.1, 8.2))
    with pytest.raises(ConfigError, match=r"simplify = 10 m: .*radius.*allowed"):
        simplified(Route("a", points), 10.0)
    plain = tuple(Waypoint(point.latitude, point.longitude) for point in points)
    with pytest.raises(ConfigError, match="limits"):
        simplified(Route("a", plain, (Leg(), Leg(port=100.0))), 10.0)
    with pytest.raises(ConfigError, match="simplify"):
        simplified(Route("a", plain), 0.0)


GPX = """<gpx version="1.1" xmlns="http://www.topografix.com/GPX/1/1">
<rte><name>out</name><rtept lat="54" lon="8"/><rtept lat="54.1" lon="8"/></rte>
<rte><name>home</name><rtept lat="54.1" lon="8"/><rtept lat="54" lon="8.1"/></rte>
<trk><name>sailed</name><trkseg><trkpt lat="54" lon="8"/><trkpt lat="55" lon="8"/></trkseg></trk>
</gpx>"""


def test_one_of_several_routes_is_picked_by_its_name(tmp_path):
    path = tmp_path / "a.gpx"
    path.write_text(GPX)
    assert load_route(path, name="home").waypoints[1].longitude == 8.1
    assert load_route(path, name="sailed").waypoints[1].latitude == 55.0
    with pytest.raises(ConfigError, match=r"holds 2 routes \('out', 'home'\).*--name"):
        load_route(path)
    with pytest.raises(ConfigError, match=r"a.gpx: name = 'back': no route"):
        load_route(path, name="back")
