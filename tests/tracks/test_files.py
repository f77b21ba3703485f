import json
import math
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad

from ship_gym.config import ConfigError
from ship_gym.tracks import Track, load_track, save_track

POINTS = [[0.0, 0.0], [1500.0, 200.0], [2500.0, 2200.125]]
LINE = [[10.0, 54.0], [10.02, 54.01], [10.05, 54.01]]
A, E2 = 6378137.0, 0.0066943799901413165  # WGS84: equatorial radius [m], eccentricity squared


def line(coordinates=LINE, **properties):
    geometry = {"type": "LineString", "coordinates": coordinates}
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def collection(*features, **members):
    return {"type": "FeatureCollection", "features": list(features), **members}


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
    assert track.to_list() == POINTS and track.projection == "none, metres"
    assert load_track(np.array(POINTS)).to_list() == POINTS
    assert load_track(track) is track


@pytest.mark.parametrize("name", ["a.geojson", "a.JSON", "new/folder/a.json"])
def test_metres_there_and_back_exactly(tmp_path, name):
    save_track(Track(POINTS), tmp_path / name)
    assert load_track(tmp_path / name).to_list() == POINTS
    assert load_track(str(tmp_path / name)).to_list() == POINTS


@pytest.mark.parametrize("origin_deg", [(54.0, 10.0), (-33.9, 179.995), (0.0, -180.0), (78.0, 15)])
def test_degrees_there_and_back(tmp_path, charts, origin_deg):
    """Also across the antimeridian, where longitudes jump by 360 deg."""
    path = tmp_path / "a.geojson"
    save_track(Track(POINTS), path, origin_deg)
    found = load_track(path)
    np.testing.assert_allclose(found.points, POINTS, atol=1e-6)
    assert found.origin_deg[0] == pytest.approx(origin_deg[0])
    again = tmp_path / "again.geojson"
    save_track(found, again, found.origin_deg)
    np.testing.assert_allclose(load_track(again).points, POINTS, atol=1e-6)


def test_the_projection_is_reported(written, charts):
    found = load_track(written(line()))
    assert found.origin_deg == (54.0, 10.0) and found.to_list()[0] == [0.0, 0.0]
    assert found.projection == "+proj=aeqd +lat_0=54.0 +lon_0=10.0 +datum=WGS84 +units=m"


def test_a_degree_of_latitude(written, charts):
    """Meridian arc of the ellipsoid: radius of curvature M = a (1 - e2) / (1 - e2 sin^2)^1.5.

    A series in common use, 111132.92 - 559.82 cos 2 lat + 1.175 cos 4 lat - 0.0023 cos 6 lat [m],
    gives 111131.745 m at 45 deg; gis.stackexchange.com/questions/75528 finds it within 0.6 parts
    per million of the radius above.
    """
    found = load_track(written(line([[5.0, 44.5], [5.0, 45.5]])))
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
    assert found.leg_bearings[0] == pytest.approx(math.pi / 2, abs=2e-4)  # parallels are curved


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
    ]
    for form in same:
        assert load_track(written(form)).to_list() == expected


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
        (collection(line(), point(1, 2)), "LineString, Point; wanted is one"),
        ({"type": "MultiLineString", "coordinates": [LINE]}, "MultiLineString; wanted is one"),
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
        (line([[0.001 * i, 50.0] for i in range(501)]), "501 way-points; at most 500"),
        (line([[0.0, 0.0], [0.0, 5.1e5]], units="m"), "way-points 0 and 1 are 510 km apart"),
    ],
)
def test_refused_with_the_name_of_the_file(written, content, message):
    with pytest.raises(ConfigError, match=f"track.geojson: .*({message})"):
        load_track(written(content))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (line([LINE[0]]), "at least 2"),
        (line([LINE[0], LINE[0], LINE[1]]), "way-point 1.*is it there twice"),
        (line([[0.0, 50.0], [0.0, 54.6]]), "way-points 0 and 1 are 512 km apart"),
    ],
)
def test_refused_after_projection(written, charts, content, message):
    with pytest.raises(ConfigError, match=f"track.geojson: .*({message})"):
        load_track(written(content))


def test_lists_have_the_same_limits():
    with pytest.raises(ConfigError, match="501 way-points"):
        load_track([[10.0 * i, 0.0] for i in range(501)])
    with pytest.raises(ConfigError, match="600 km apart"):
        load_track([[0.0, 0.0], [6e5, 0.0]])
    for bad in ({"a": 1}, None, 5, []):
        with pytest.raises(ConfigError, match="list of way-points"):
            load_track(bad)


def test_bad_paths(tmp_path):
    with pytest.raises(ConfigError, match="no such file"):
        load_track(tmp_path / "missing.geojson")
    with pytest.raises(ConfigError, match=r"ends in \.geojson or \.json"):
        load_track(Path("track.gpx"))
    with pytest.raises(ConfigError, match=r"ends in \.geojson or \.json"):
        save_track(Track(POINTS), tmp_path / "track.csv")
    with pytest.raises(ConfigError, match="latitude"):
        save_track(Track(POINTS), tmp_path / "a.json", (100.0, 0.0))
    assert list(tmp_path.iterdir()) == []


def test_without_pyproj_the_extra_is_named(written, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyproj", None)
    with pytest.raises(ImportError, match=r"ship-gym\[geo\]"):
        load_track(written(line()))
    assert load_track(written(line(units="m"))).projection == "none, metres"
