import json
import math
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad

from ship_gym.charts import geodesy
from ship_gym.config import ConfigError
from ship_gym.tracks import Track, load_route, load_track, save_track

POINTS = [[0.0, 0.0], [1500.0, 200.0], [2500.0, 2200.125]]
LINE = [[10.0, 54.0], [10.02, 54.01], [10.05, 54.01]]
A, E2 = 6378137.0, 0.0066943799901413165  # WGS84: equatorial radius [m], eccentricity squared


def line(coordinates=LINE, **properties):
    geometry = {"type": "LineString", "coordinates": coordinates}
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def lines(*parts, **properties):
    geometry = {"type": "MultiLineString", "coordinates": list(parts)}
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def collection(*features, **members):
    return {"type": "FeatureCollection", "features": list(features), **members}


def crs(form, name):
    return {**form, "crs": {"type": "name", "properties": {"name": name}}}


def point(longitude, latitude, **properties):
    geometry = {"type": "Point", "coordinates": [longitude, latitude]}
    return {"type": "Feature", "properties": properties, "geometry": geometry}


@pytest.fixture
def charts():
    """For tests of tracks in degrees."""
    pytest.importorskip("pyproj", reason="extra 'geo' not installed")


@pytest.fixture
def written(tmp_path):
    def write(content, name="track.geojson"):
        path = tmp_path / name
        path.write_text(content if isinstance(content, str) else json.dumps(content))
        return path

    return write


def test_lists_arrays_and_tracks():
    track = load_track(POINTS)
    assert track.to_list() == POINTS and track.chart is None and track.route is None
    assert load_track(np.array(POINTS)).to_list() == POINTS
    assert load_track(track) is track


@pytest.mark.parametrize("name", ["a.geojson", "a.JSON", "new/folder/a.json"])
def test_metres_there_and_back_exactly(tmp_path, name):
    save_track(Track(POINTS), tmp_path / name)
    assert load_track(tmp_path / name).to_list() == POINTS
    assert load_track(str(tmp_path / name)).to_list() == POINTS


@pytest.mark.parametrize("origin_deg", [(54.0, 10.0), (-33.9, 179.995), (0.0, -180.0), (78.0, 15)])
@pytest.mark.parametrize("suffix", [".geojson", ".gpx", ".rtz"])
def test_degrees_there_and_back(tmp_path, charts, origin_deg, suffix):
    """Also across the antimeridian, where longitudes jump by 360 deg.

    Distances of 3 km from the origin are true; the rhumb line between two others is not the
    straight line of the plane about it: at 78 deg the meridians turn by 0.13 deg in 3 km.
    """
    path = tmp_path / f"a{suffix}"
    save_track(Track(POINTS), path, origin_deg)
    found = load_track(path)
    np.testing.assert_allclose(found.points, POINTS, atol=4.0 if origin_deg[0] == 78.0 else 1.5)
    assert found.origin_deg[0] == pytest.approx(origin_deg[0])
    again = tmp_path / f"again{suffix}"
    save_track(found, again)
    assert load_track(again).to_list() == found.to_list()


def test_the_place_is_reported(written, charts):
    found = load_track(written(line()))
    assert found.origin_deg == (54.0, 10.0) and found.to_list()[0] == [0.0, 0.0]
    np.testing.assert_allclose(found.chart.place(*found.points.T), np.array(LINE).T[::-1])


def test_a_degree_of_latitude(written, charts):
    """Meridian arc of the ellipsoid: radius of curvature M = a (1 - e2) / (1 - e2 sin^2)^1.5.

    A series in common use, 111132.92 - 559.82 cos 2 lat + 1.175 cos 4 lat - 0.0023 cos 6 lat [m],
    gives 111131.745 m at 45 deg; gis.stackexchange.com/questions/75528 finds it within 0.6 parts
    per million of the radius above.
    """
    found = load_track(written(line([[5.0, 44.5], [5.0, 45.5]], units="deg")))
    arc, _ = quad(
        lambda lat: A * (1.0 - E2) / (1.0 - E2 * math.sin(lat) ** 2) ** 1.5,
        math.radians(44.5),
        math.radians(45.5),
        epsabs=1e-6,
    )
    assert found.points[1, 0] == pytest.approx(arc, abs=1e-3)
    assert found.points[1, 0] == pytest.approx(111131.745, rel=0.6e-6)
    assert found.points[1, 1] == pytest.approx(0.0, abs=1e-6)


def test_a_minute_of_longitude_at_60_deg_is_half_a_minute_of_the_equator(written, charts):
    """Radius of the parallel N cos(lat), N = a / (1 - e2 sin^2)^0.5; due east, to starboard."""
    found = load_track(written(line([[5.0, 60.0], [5.0 + 1.0 / 60.0, 60.0]])))
    parallel = A / math.sqrt(1.0 - 0.75 * E2) * 0.5 * math.radians(1.0 / 60.0)
    assert found.points[1, 1] == pytest.approx(parallel, rel=1e-7)
    assert found.leg_bearings[0] == pytest.approx(math.pi / 2, abs=1e-12)


def test_every_form_of_the_same_line(written, charts):
    expected = load_track(written(line())).to_list()
    high = [[*position, 12.5] for position in LINE]
    same = [
        line()["geometry"],
        collection(line()),
        collection(*(point(*position) for position in LINE)),
        line(high),
        line(units="deg"),
        collection(line(), units="deg"),
        {"type": "Feature", "properties": None, "geometry": line()["geometry"]},
        collection({"type": "Feature", "properties": None, "geometry": None}, line()),
        line([[x + 360.0, y] for x, y in LINE]),
        lines(LINE[:2], LINE[1:]),
    ]
    for form in same:
        np.testing.assert_allclose(load_track(written(form)).points, expected, atol=1e-6)


def test_points_beside_a_line_are_its_marks(written, charts):
    """As map editors export a route: the line and its way-points."""
    plain = load_route(written(line(name="voyage")))
    marked = collection(*(point(*place) for place in LINE), line(name="voyage"))
    assert load_route(written(marked)) == plain


def test_what_says_that_it_is_in_degrees(written, charts):
    """A null of GDAL says nothing; a crs in degrees, or a cut at the antimeridian, says it."""
    far = [[-5.1, 48.3], [-73.9, 40.5]]  # would be refused: it may be in metres
    for name in ("urn:ogc:def:crs:OGC:1.3:CRS84", "EPSG:4326", "urn:ogc:def:crs:EPSG::4258"):
        assert load_route(written(crs(line(far), name))).waypoints[1].longitude == -73.9
    assert load_route(written(line(units=None, name=None, legs=None))).name == ""
    assert load_route(written({**line(), "crs": None})).waypoints[0].longitude == LINE[0][0]
    cut = lines([[170.0, -40.0], [180.0, -41.0]], [[-180.0, -41.0], [-170.0, -42.0]])
    assert len(load_route(written(cut)).waypoints) == 2
    with pytest.raises(ConfigError, match="km long, or it is in metres"):
        load_route(written(line([[170.0, -40.0], [190.0, -42.0]])))
    metres = crs(line([[3e5, 6e6], [3e5, 6.1e6]], units="m"), "EPSG:25832")
    assert load_track(written(metres)).total_length == 1e5


def test_metres_are_east_before_north(written):
    in_metres = [[200.0, 1500.0], [0.0, 0.0]]
    for form in (
        line(in_metres, units="m"),
        {**line(in_metres), "units": "m"},
        collection(line(in_metres), units="m"),
        collection(point(200.0, 1500.0, units="m"), point(0.0, 0.0)),
        {**line(in_metres)["geometry"], "units": "m"},
    ):
        assert load_track(written(form)).to_list() == [[1500.0, 200.0], [0.0, 0.0]]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("{", "not valid JSON"),
        ("[1, 2]", "not GeoJSON"),
        ("[" * 100_000, "not valid JSON"),
        ({"type": "FeatureCollection"}, '"features"'),
        (collection(), "no geometry"),
        (collection(line(), line()), "2 lines; wanted is one"),
        (collection(line(), line(), point(1, 2)), "holds 2 lines; wanted is one"),
        (lines(), '"coordinates"'),
        (lines(LINE, 5), "line 1 of the MultiLineString: must be a list"),
        (lines(LINE, LINE), r"line 1 of the MultiLineString begins at \[10.0, 54.0\], line 0 ends"),
        (lines(LINE[:2], [["x", 54.01], LINE[2]]), "line 1 of the MultiLineString begins"),
        (lines([[0, 0], [180, 9]], [[-180, 9], [-200, 0]], units="m"), "must be the same place"),
        (collection(lines(LINE), line()), "2 lines; wanted is one"),
        ({"type": "Feature", "properties": {}, "geometry": None}, "wanted is one"),
        ({"type": "Feature", "geometry": 5}, '"geometry"'),
        (line([]), '"coordinates"'),
        (line([[1, 2], [3]]), "way-point 1 = .*two numbers"),
        (line([[1, 2], ["3", 4]]), "way-point 1 = .*two numbers"),
        (line([[1, 2], [10**400, 4]]), "way-point 1 = an integer of 1329 bits"),
        (line([[1, 2], [math.nan, 4]]), "NaN is no number of JSON"),
        (line([[1, 2], [math.inf, 4]], units="m"), "Infinity is no number of JSON"),
        (line([[0, 0], [200, 1500]]), 'way-point 1.*add "units": "m".*WGS84'),
        (line([[54.0, 100.0], [54.1, 100.0]]), "way-point 0.*swapped"),
        (line(units="km"), "unknown units 'km'"),
        (collection(line(units="deg"), units="m"), "different units: deg, m"),
        (line([[0.001 * i, 50.0] for i in range(20_001)]), "20001 way-points; at most 20000"),
        (line([[0.5, 0.5], [0.6, 0.5]]), 'within 1 deg of .* or it is in metres.*"units": "m"'),
        (line([[30.0, 12.0], [30.0, 15.0]]), 'would be 332 km long.*"units": "m"'),
        (line([[3.0, 4.0], [0.0, 0.2]]), "way-point 1 .*metres"),
        (line([[5.0 + 0.5 * i, 2.0] for i in range(40)]), "line would be 21.. km long"),
        (crs(line(), "urn:ogc:def:crs:EPSG::25832"), "crs = 'urn:.*25832': must be WGS84"),
        ({**line(), "crs": 5}, "crs = 5: must be WGS84"),
        (line([[541.0, 50.0], [541.0, 50.1]]), "not a longitude within 540"),
        (line(geometry="straight"), "unknown geometry 'straight'"),
        (line(name=5), "name = 5: must be a text"),
        (line(waypoints=[{"name": "a\x00"}, {}, {}]), "without control characters"),
        (line(waypoints=[{"name": "\ud800"}, {}, {}]), "without control characters"),
        (line(legs=[{}]), '"legs" in the properties: 1 of them; must be 2'),
        (line(legs=[{"port": -1.0}, {}]), "port = -1.0: allowed is 0"),
        (line(legs=[{"aside": 1.0}, {}]), "unknown key 'aside'"),
        (line(waypoints=5), '"waypoints" in the properties must be a list'),
        (line([[0.0, 89.5], [1.0, 89.5]]), "way-point 0.*latitude = 89.5: allowed is -89 to 89"),
    ],
)
def test_refused_with_the_name_of_the_file(written, content, message):
    if "km long" in message:
        pytest.importorskip("pyproj", reason="extra 'geo' not installed")
    with pytest.raises(ConfigError, match=f"track.geojson: .*({message})"):
        load_track(written(content))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (line([LINE[0]]), "at least 2"),
        (line([LINE[0], LINE[0], LINE[1]]), "way-point 1.*is it there twice"),
        (line([[0.0, 50.0], [0.0, 50.1], [0.001, 50.0]]), "way-point 1.* turns by 179"),
    ],
)
def test_refused_after_projection(written, charts, content, message):
    with pytest.raises(ConfigError, match=f"track.geojson: .*({message})"):
        load_track(written(content))


def test_lists_have_the_same_limits():
    with pytest.raises(ConfigError, match="20001 way-points"):
        load_track([[10.0 * i, 0.0] for i in range(20_001)])
    assert load_track([[0.0, 0.0], [6e5, 0.0]]).total_length == 6e5
    for bad in ({"a": 1}, None, 5, []):
        with pytest.raises(ConfigError, match="list of way-points"):
            load_track(bad)


def test_bad_paths(tmp_path):
    with pytest.raises(ConfigError, match="no such file"):
        load_track(tmp_path / "missing.geojson")
    with pytest.raises(ConfigError, match=r"ends in \.rtz, \.gpx, \.geojson or \.json"):
        load_track(Path("track.kml"))
    with pytest.raises(ConfigError, match=r"a \.rtzp is a zip archive, unpack the \.rtz"):
        load_track(Path("track.rtzp"))
    with pytest.raises(ConfigError, match=r"ends in \.rtz, \.gpx, \.geojson or \.json"):
        save_track(Track(POINTS), tmp_path / "track.csv")
    for name in ("a.rtz", "a.gpx"):
        with pytest.raises(ConfigError, match="without a place on the earth"):
            save_track(Track(POINTS), tmp_path / name)
    with pytest.raises(ConfigError, match="latitude"):
        save_track(Track(POINTS), tmp_path / "a.json", (100.0, 0.0))
    assert list(tmp_path.iterdir()) == []


def test_without_pyproj_the_extra_is_named(written, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyproj", None)
    geodesy._geod.cache_clear()
    geodesy._mercator.cache_clear()
    with pytest.raises(ImportError, match=r"ship-gym\[geo\]"):
        load_track(written(line()))
    assert load_track(written(line(units="m"))).chart is None


def test_a_line_cut_at_the_antimeridian_is_one_leg(written, charts):
    """RFC 7946, section 3.1.9; where it was cut is no way-point."""
    cut = lines([[177.0, -18.0], [180.0, -18.1]], [[-180.0, -18.1], [-177.0, -18.2]])
    for form in (
        cut,
        line([[177.0, -18.0], [183.0, -18.2]]),
        line([[-183.0, -18.0], [-177, -18.2]]),
    ):
        form["properties"]["units"] = "deg"
        found = load_track(written(form))
        assert found.points.shape == (2, 2)
        assert found.leg_lengths[0] == pytest.approx(6.0 * 105.9e3, rel=1e-3)
    kept = lines([[177.0, -18.0], [180.0, -18.1]], [[180.0, -18.1], [183.0, -18.2]], units="deg")
    assert load_track(written(kept)).points.shape == (3, 2)  # the same place twice: a way-point


def test_longitude_180_05_is_a_longitude(written, charts):
    found = load_route(written(line([[179.95, 50.0], [180.05, 50.0]])))
    assert found.waypoints[1].longitude == pytest.approx(-179.95)
    assert found.track().total_length == pytest.approx(0.1 * 71.7e3, rel=1e-3)


def test_metres_that_could_be_degrees_say_which(written, charts):
    """A towing-tank track was 474 km; a buoy off Ghana is a place."""
    tank = [[0.0, 0.0], [3.0, 0.1], [4.0, 1.0]]
    with pytest.raises(ConfigError, match='"units": "m"'):
        load_track(written(line(tank)))
    assert load_track(written(line(tank, units="m"))).total_length == pytest.approx(4.35, abs=0.01)
    assert load_track(written(line(tank, units="deg"))).total_length == pytest.approx(
        484e3, rel=0.01
    )


def test_geometry_is_said_by_the_file_or_by_the_call(written, charts):
    far = [[-5.0, 48.0], [-50.0, 45.0]]
    rhumb = load_track(written(line(far, units="deg")))
    great = load_track(written(line(far, units="deg")), geometry="orthodrome")
    said = load_track(written(line(far, units="deg", geometry="orthodrome")))
    assert len(rhumb.points) == 2 and great.to_list() == said.to_list()
    assert rhumb.total_length - great.total_length == pytest.approx(55e3, rel=0.2)
    with pytest.raises(ConfigError, match="unknown geometry 'great'"):
        load_track(written(line()), geometry="great")


def test_a_route_is_not_in_metres(written):
    with pytest.raises(ConfigError, match="is in metres"):
        load_route(written(line(units="m")))
