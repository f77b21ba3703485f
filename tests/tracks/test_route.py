"""Routes laid into their plane: great circles by geographiclib, planned turns by plane geometry."""

import dataclasses
import itertools
import json
import math

import numpy as np
import pytest

from ship_gym.charts import geodesy
from ship_gym.config import ConfigError
from ship_gym.tracks import Leg, Route, Waypoint, load_track
from ship_gym.tracks.route import MOST_LEGS

pytest.importorskip("pyproj", reason="extra 'geo' not installed")
geodesics = pytest.importorskip("geographiclib.geodesic")
WGS84 = geodesics.Geodesic.WGS84

STARTS = {
    "east at 60 N": (60.0, 5.0, 90.0),
    "west over the antimeridian": (52.0, -177.0, 268.0),
    "north": (50.0, 3.0, 0.0),
    "south": (-20.0, 10.0, 180.0),
    "oblique at 60 N": (60.0, -30.0, 50.0),
    "southern hemisphere": (-45.0, 170.0, 110.0),
    "over the equator": (-2.0, -30.0, 20.0),
    "high north": (75.0, 20.0, 70.0),
}


def route(*places, geometry="loxodrome", radii=None, **leg):
    radii = radii or [None] * len(places)
    points = [Waypoint(*place, radius=r) for place, r in zip(places, radii, strict=True)]
    return Route("a", tuple(points), (Leg(geometry, **leg),) * (len(places) - 1))


def off_the_geodesic(latitude, longitude, start):
    """Distance [m] from the geodesic that leaves `start` (lat, lon, azimuth)."""
    way = WGS84.Inverse(start[0], start[1], latitude, longitude)
    if way["s12"] == 0.0:
        return 0.0
    angle = math.radians(way["azi1"] - start[2])
    mask = geodesics.Geodesic.REDUCEDLENGTH
    return WGS84.Inverse(start[0], start[1], latitude, longitude, mask)["m12"] * math.sin(angle)


@pytest.mark.parametrize("start", STARTS.values(), ids=STARTS)
@pytest.mark.parametrize("length", [500e3, 4000e3])
def test_a_great_circle_is_that_of_geographiclib(start, length):
    """Within 1 m of 500 km in length, within 0.5 m aside everywhere."""
    end = WGS84.Direct(*start, length)
    track = route(start[:2], (end["lat2"], end["lon2"]), geometry="orthodrome").track()
    assert track.total_length == pytest.approx(length, abs=1.0 * length / 500e3)
    chart = track.chart
    ends = chart.place(*track.points[[0, -1]].T, [0, len(track.points) - 2])
    for lat, lon, known in zip(*ends, (start[:2], (end["lat2"], end["lon2"])), strict=True):
        assert WGS84.Inverse(float(lat), float(lon), *known)["s12"] < 1e-3
    middles = 0.5 * (track.points[1:] + track.points[:-1])
    lat, lon = chart.place(*middles.T, np.arange(len(middles)))
    off = [off_the_geodesic(a, b, start) for a, b in zip(lat.tolist(), lon.tolist(), strict=True)]
    assert np.abs(off).max() < 0.5
    if len(middles) > 1:  # where the rhumb line is another line, it is cut no finer than needed
        assert np.abs(off).max() > 0.05
    first = math.degrees(track.leg_bearings[0])
    assert math.remainder(first - start[2], 360.0) == pytest.approx(0.0, abs=0.2)


def test_a_due_north_leg_bears_000_wherever_it_lies():
    """414 km from the first way-point it bore 354 deg in the plane about that one."""
    end = WGS84.Direct(60.0, 5.0, 90.0, 414e3)
    track = route((60.0, 5.0), (60.0, end["lon2"]), (61.0, end["lon2"])).track()
    assert np.degrees(track.leg_bearings).tolist() == pytest.approx([90.0, 0.0], abs=1e-9)


def test_250_km_due_east_at_60_deg_stays_on_its_parallel():
    there = geodesy.rhumb_forward(60.0, 5.0, 0.5 * math.pi, 250e3)
    track = route((60.0, 5.0), tuple(map(float, there))).track()
    assert track.to_list() == pytest.approx(np.array([[0.0, 0.0], [0.0, 250e3]]), abs=1e-3)
    lat, _ = track.chart.place(np.zeros(11), np.linspace(0.0, 250e3, 11))
    np.testing.assert_allclose(lat, 60.0, atol=1e-9)


def corner(turn_deg, radius, leg=20e3, at=(54.0, 10.0), **more):
    """Two legs of 20 km that meet at a turn."""
    before = geodesy.rhumb_forward(*at, math.radians(30.0) + math.pi, leg)
    after = geodesy.rhumb_forward(*at, math.radians(30.0 + turn_deg), leg)
    places = [tuple(map(float, place)) for place in (before, at, after)]
    return route(*places, radii=[None, radius, None], **more)


@pytest.mark.parametrize("turn", [-120.0, -40.0, 3.0, 60.0, 90.0, 160.0])
@pytest.mark.parametrize("radius", [300.0, 1111.2])
def test_a_planned_turn_is_an_arc_that_touches_both_legs(turn, radius):
    """Its centre is `radius` from both legs, so that each way-point on it is `radius` from it."""
    made = corner(turn, radius)
    track = made.track()
    room = radius * math.tan(math.radians(0.5 * abs(turn)))
    assert track.leg_lengths[[0, -1]] == pytest.approx([20e3 - room] * 2, abs=0.5)
    side = math.copysign(0.5 * math.pi, turn)
    start, bearing = track.points[1], track.leg_bearings[0]
    centre = start + radius * np.array([math.cos(bearing + side), math.sin(bearing + side)])
    away = np.hypot(*(track.points[1:-1] - centre).T)
    # the Mercator projection, in which it is a circle, has its scale in the middle of the arc
    np.testing.assert_allclose(away, radius, rtol=max(3e-4, 2e-7 * room))
    arc = track.leg_lengths[1:-1]
    assert arc.min() > 5.0 and np.sum(arc) == pytest.approx(
        radius * math.radians(abs(turn)), rel=2e-3
    )
    sagitta = radius - np.sqrt(radius**2 - 0.25 * arc**2)
    assert sagitta.max() < 0.51
    assert np.degrees(track.course_changes).sum() == pytest.approx(turn, abs=1e-6)
    assert (np.sign(track.course_changes) == math.copysign(1.0, turn)).all()


@pytest.mark.parametrize("first", [None, 2000.0])
def test_arcs_may_take_all_of_a_leg(first):
    """2 km of leg between turns of 0.5 and 1 rad: the second arc begins where the first ends."""
    places, bearings = [(54.0, 10.0)], (0.3, 0.8, 1.8)
    for bearing, length in zip(bearings, (9e3, 2e3, 9e3), strict=True):
        there = geodesy.rhumb_forward(*places[-1], bearing, length)
        places.append(tuple(map(float, there)))
    left = 2e3 - (first or 0.0) * math.tan(0.25)
    track = route(*places, radii=[None, first, left / math.tan(0.5), None]).track()
    assert track.leg_lengths.min() > 5.0
    assert track.course_changes.sum() == pytest.approx(1.5, abs=1e-6)
    kinks = track.course_changes[1:] if first is None else track.course_changes
    assert np.degrees(kinks).max() < 5.0
    with pytest.raises(ConfigError, match="way-point 2: a planned turn of 57 deg"):
        route(*places, radii=[None, first, left / math.tan(0.5) + 1.0, None]).track()


def test_an_arc_between_great_circles_at_60_deg():
    """5 NM of radius: both tangent points lie on the geodesics."""
    made = route(
        (60.0, 5.0), (62.0, 20.0), (58.0, 30.0), geometry="orthodrome", radii=[0, 9260.0, 0]
    )
    track = made.track()
    lines = made.lines()
    inner = np.flatnonzero(np.abs(track.course_changes) > math.radians(0.3)) + 1  # not the pieces
    room = 9260.0 * math.tan(0.5 * abs(lines.bearing_there[0] - lines.bearing[1]))
    for i, k, at in ((inner[0], 0, lines.length[0] - room), (inner[-1], 1, room)):
        place = made.waypoints[k]
        known = WGS84.Direct(place.latitude, place.longitude, math.degrees(lines.bearing[k]), at)
        found = track.chart.latitude[i], track.chart.longitude[i]
        assert WGS84.Inverse(*found, known["lat2"], known["lon2"])["s12"] < 1e-3
    assert np.degrees(np.abs(track.course_changes)).max() < 2.0


def test_limits_go_with_the_legs():
    legs = (Leg(port=100.0, starboard=200.0), Leg("orthodrome", port=0.0), Leg())
    points = [Waypoint(54.0, 10.0), Waypoint(54.2, 10.0, radius=500.0), Waypoint(54.2, 12.0)]
    track = Route("a", (*points, Waypoint(55.0, 12.0)), legs).track()
    assert track.limits.shape == (len(track.points) - 1, 2) and len(track.leg_of) > 20
    for k, expected in enumerate(([100.0, 200.0], [math.nan] * 2, [math.nan] * 2)):
        np.testing.assert_array_equal(
            track.limits[track.leg_of == k], [expected] * (track.leg_of == k).sum()
        )
    assert (np.diff(track.leg_of) >= 0).all() and set(track.leg_of) == {0, 1, 2}
    halves = np.sum(track.leg_of == 0), np.sum(track.leg_of[:20] == 1)
    assert halves[0] > 5 and halves[1] > 5  # the arc belongs half to either


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (lambda: route((54.0, 10.0)), "at least 2"),
        (lambda: route((54.0, 10.0), (54.0, 10.0)), "way-point 1: 0 m from the one before.*twice"),
        (lambda: route((54, 10), (55, 10), (54, 10.001)), "way-point 1: the route turns by 180"),
        (lambda: corner(90.0, 25e3), "way-point 1: a planned turn of 90 deg with radius 25000 m "
         "needs 25000 m of the leg from way-point 0 to 1; it has 20000 m"),
        (lambda: corner(178.0, 10.0), "turns by 178.0 deg, allowed is 175"),
        (lambda: route((54, 10), (90, 10)), "latitude = 90: allowed is -89 to 89"),
        (lambda: route((54, 10), (55, 600)), "longitude = 600: allowed"),
        (lambda: route((80, 0), (80, 175), geometry="orthodrome"), "leg from way-point 0 to 1 pas"),
        (lambda: route((54, 10), (55, 10), geometry="great"), "unknown geometry 'great'"),
        (lambda: route((54, 10), (55, 10), port=-1.0), "port = -1.0"),
        (lambda: Waypoint(54.0, 10.0, radius=-1.0), "radius = -1.0"),
        (lambda: Route("a", (Waypoint(1, 2), Waypoint(2, 2)), (Leg(), Leg())), "2 legs for 2"),
    ],
)  # fmt: skip
def test_refused(made, message):
    with pytest.raises(ConfigError, match=message) as error:
        found = made()
        found.track()
    assert len(str(error.value)) <= 300


def test_turns_too_tight_for_the_ship_name_the_waypoint():
    """At 90 deg an arc of 900 m passes 400 m (sqrt(2) - 1) = 166 m inside one of 500 m."""
    for side, turn in (("port", -90.0), ("starboard", 90.0)):
        for limit, refused in ((165.0, True), (167.0, False)):
            made = corner(turn, 500.0, **{side: limit})
            named = dataclasses.replace(made.waypoints[1], name="Pilots", id=43)
            points = made.waypoints[0], named, made.waypoints[2]
            track = Route("a", points, made.legs).track()
            assert track.check_turns(499.0) is track
            if not refused:
                assert track.check_turns(900.0) is track
                continue
            told = r"way-point 1 \(id 43, 'Pilots'\) has a planned radius of 500 m; at .* of 900 m"
            with pytest.raises(ConfigError, match=f"{told} she passes 166 m inside .* 165 m"):
                track.check_turns(900.0)
    other = corner(90.0, 500.0, port=10.0).track()  # the limit of the outer side
    assert other.check_turns(900.0) is other
    told = "leg from way-point 0 to 1 is 20000 m long; turns of 0 and 90"
    for radius in (None, 500.0):
        with pytest.raises(ConfigError, match=told):
            corner(90.0, radius).track().check_turns(25e3)


def test_a_recording_keeps_it():
    made = corner(90.0, 500.0, port=100.0, speed_max=7.5)
    assert Route.from_meta(json.loads(json.dumps(made.to_meta()))) == made
    with pytest.raises(ConfigError, match="route"):
        Route.from_meta({"name": "a", "waypoints": [{"latitude": 1.0}]})


def test_load_track_takes_a_route():
    made = corner(90.0, 500.0)
    assert load_track(made).to_list() == made.track().to_list()


def test_a_route_round_the_world_has_pieces_enough():
    places = [(50.0, -5.0), (-34.5, 18.0), (-45.0, 150.0), (-57.0, -67.0), (50.0, -5.0)]
    track = route(*places, geometry="orthodrome").track()
    lengths = [WGS84.Inverse(*a, *b)["s12"] for a, b in itertools.pairwise(places)]
    assert track.total_length == pytest.approx(sum(lengths), rel=2e-7)
    assert 2_000 < len(track.points) < 20_000 < MOST_LEGS
