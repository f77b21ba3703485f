"""Recordings on the earth: places, files of other programs, the map of the viewer."""

import datetime
import json
import math
import re

import numpy as np
import pytest

from ship_gym.charts import Chart
from ship_gym.config import ConfigError
from ship_gym.recording import Trajectory
from ship_gym.recording.earth import chart_of, parted_at_antimeridian, sailed_places
from ship_gym.recording.earth_files import write_on_earth
from ship_gym.recording.route import Legs, corridor_lines, corridor_of, legs_near

pytest.importorskip("pyproj")
NOON = datetime.datetime(2026, 5, 1, 12, tzinfo=datetime.UTC)


def straight(bearing, length, rows=11, **meta):
    """Recording of a ship on a straight way from north = east = 0."""
    way = np.linspace(0.0, length, rows)
    columns = {"t": np.arange(rows), "x": way * math.cos(bearing), "y": way * math.sin(bearing)}
    return Trajectory(columns | {"psi": np.full(rows, bearing)}, meta)


def test_a_run_without_a_chart_lies_where_its_origin_is_said_to():
    """Distance and bearing from there by Karney's geodesics (geographiclib)."""
    geodesic = pytest.importorskip("geographiclib.geodesic").Geodesic.WGS84
    run = straight(math.radians(70.0), 20e3)
    lat, lon = sailed_places(run, chart_of(run, (54.3, 10.2)))
    for k in (0, 5, 10):
        there = geodesic.Direct(54.3, 10.2, 70.0, 2e3 * k)
        assert (lat[k], lon[k]) == pytest.approx((there["lat2"], there["lon2"]), abs=1e-9)


def test_a_run_on_a_route_lies_on_its_rhumb_lines():
    """250 km due east at 60 N end at 60 N; the plane about the first place was 2.1 km off there."""
    chart = Chart.laid([60.0, 60.0], [5.0, 9.5])
    run = straight(0.5 * math.pi, 250e3, chart=chart.to_meta())
    lat, lon = sailed_places(run, chart_of(run))
    np.testing.assert_allclose(lat, 60.0, atol=1e-9)
    # radius of the parallel: a cos(phi) / sqrt(1 - e^2 sin^2(phi))
    parallel = 6378137.0 * 0.5 / math.sqrt(1.0 - 0.00669437999014 * 0.75)
    assert lon[-1] == pytest.approx(5.0 + math.degrees(250e3 / parallel), abs=1e-8)
    with pytest.raises(ConfigError, match="has a chart"):
        chart_of(run, (60.0, 5.0))


def test_lines_are_cut_at_the_antimeridian():
    lat, lon = np.array([0.0, 1.0, 2.0]), np.array([179.0, -179.5, -179.0])
    one, other = parted_at_antimeridian(lat, lon)
    np.testing.assert_allclose(one, [[0.0, 179.0], [2.0 / 3.0, 180.0]])
    np.testing.assert_allclose(other, [[2.0 / 3.0, -180.0], [1.0, -179.5], [2.0, -179.0]])
    back = parted_at_antimeridian(lat[::-1], lon[::-1])
    np.testing.assert_allclose(np.concatenate(back)[::-1], np.concatenate([one, other]))
    assert len(parted_at_antimeridian(lat, np.array([-3.0, 3.0, 9.0]))) == 1


def test_gpx_is_read_by_others_and_by_us(tmp_path):
    gpxpy = pytest.importorskip("gpxpy")
    from ship_gym.tracks.files import load_route

    run = straight(math.radians(70.0), 20e3)
    path = tmp_path / "run.gpx"
    write_on_earth(run, path, (54.3, 10.2), NOON)
    with open(path) as stream:
        points = gpxpy.parse(stream).tracks[0].segments[0].points
    lat, lon = sailed_places(run, Chart.about(54.3, 10.2))
    np.testing.assert_allclose([p.latitude for p in points], lat, atol=1e-8)
    np.testing.assert_allclose([p.longitude for p in points], lon, atol=1e-8)
    assert points[10].time - points[0].time == datetime.timedelta(seconds=10)
    route = load_route(path)
    assert len(route.waypoints) == 11
    assert route.waypoints[10].latitude == pytest.approx(lat[10], abs=1e-8)


@pytest.mark.parametrize("longitude", [10.2, 179.9])
def test_geojson_and_kml_hold_the_same_places(tmp_path, longitude):
    """From 179.9 E the way east crosses the antimeridian: a line of two parts each."""
    run = straight(0.5 * math.pi, 20e3)
    for suffix in ("geojson", "kml"):
        write_on_earth(run, tmp_path / f"run.{suffix}", (54.3, longitude))
    feature = json.loads((tmp_path / "run.geojson").read_text())
    kind = feature["geometry"]["type"]
    lines = feature["geometry"]["coordinates"]
    lines = [lines] if kind == "LineString" else lines
    assert (kind, len(lines)) == (("LineString", 1) if longitude < 100 else ("MultiLineString", 2))
    assert feature["properties"]["duration"] == 10.0
    assert feature["properties"]["units"] == "deg"  # read as a route near 0 N 0 E, too
    assert "coordTimes" not in feature["properties"]
    text = (tmp_path / "run.kml").read_text()
    drawn = [
        [[float(v) for v in place.split(",")] for place in part.split()]
        for part in re.findall(r"<coordinates>(.*?)</coordinates>", text)
    ]
    np.testing.assert_allclose(np.concatenate(drawn), np.concatenate(lines), atol=1e-8)
    lat, lon = sailed_places(run, Chart.about(54.3, longitude))
    ends = lines[0][0], lines[-1][-1]
    np.testing.assert_allclose(ends, [[lon[0], lat[0]], [lon[-1], lat[-1]]], atol=1e-8)
    if len(lines) == 2:
        assert lines[0][-1][0] == 180.0 and lines[1][0][0] == -180.0


def test_what_cannot_be_written_is_one_line(tmp_path):
    run = straight(0.0, 100.0)
    for args, told in [
        ((tmp_path / "run.gpx",), "no place on the earth"),
        ((tmp_path / "run.shp", (54.0, 10.0)), "format.*gpx"),
        ((tmp_path / "run.gpx", (94.0, 10.0)), "latitude"),
        ((tmp_path / "run.gpx", (54.0, 10.0), datetime.datetime(2026, 1, 1)), "time zone"),
    ]:
        with pytest.raises(ConfigError, match=told):
            write_on_earth(run, *args)
    with pytest.raises(ConfigError, match="without x and y"):
        write_on_earth(Trajectory({"t": [0.0]}), tmp_path / "run.kml", (54.0, 10.0))
    assert list(tmp_path.iterdir()) == []


def test_only_legs_near_the_track_are_drawn():
    waypoints = np.array([[0.0, 0.0], [1e6, 0.0], [1e6, 1e6], [0.0, 1e6]])
    sailed = np.array([[100.0, -50.0], [900.0, 20.0]])
    legs = legs_near(waypoints, sailed, 100.0)
    assert legs.number.tolist() == [0]
    np.testing.assert_allclose(legs.start, [[0.0, 0.0]])
    np.testing.assert_allclose(legs.end, [[900.0 + 5000.0 + 800.0, 0.0]])
    whole = legs_near(waypoints, waypoints, 100.0)
    assert whole.number.tolist() == [0, 1, 2]
    assert not len(legs_near(waypoints, np.array([[5e5, 5e5]]), 100.0).number)


def test_the_corridor_stands_beside_its_legs():
    legs = Legs(np.array([1]), np.array([[0.0, 0.0]]), np.array([[0.0, 500.0]]))  # due east
    meta = {"leg_limits": [[1.0, 2.0], [30.0, 70.0]]}
    (_, port), (_, starboard) = corridor_lines(legs, corridor_of(meta, legs))
    np.testing.assert_allclose(port, [[30.0, 0.0], [30.0, 500.0]], atol=1e-12)
    np.testing.assert_allclose(starboard, [[-70.0, 0.0], [-70.0, 500.0]], atol=1e-12)
    assert corridor_of({"limits": {"corridor": 9.0}}, legs).tolist() == [[9.0, 9.0]]
    assert corridor_of({}, legs) is None


def test_a_recording_with_a_chart_has_a_map(tmp_path):
    """Its lines and points in the file, a view of the kind Map in its blueprint."""
    pytest.importorskip("rerun")
    from ship_gym.recording.rerun_export.rrd_file import read_chunks

    chart = Chart.laid([54.0, 54.0, 54.1], [10.0, 10.05, 10.05])
    points = np.column_stack([chart.north, chart.east]).tolist()
    meta = {"waypoints": points, "chart": chart.to_meta(), "leg_limits": [[50.0, 90.0]] * 2}
    run = straight(0.5 * math.pi, 3000.0, **meta)
    run.to_rrd(tmp_path / "run.rrd")
    chunks = read_chunks(tmp_path / "run.rrd")
    found = {chunk.entity_path for chunk in chunks}
    assert {"/map/route", "/map/corridor", "/map/track", "/map/ship"} <= found
    ship = [chunk.to_record_batch() for chunk in chunks if chunk.entity_path == "/map/ship"]
    moving = next(batch for batch in ship if "GeoPoints:positions" in batch.schema.names)
    places = moving.column("GeoPoints:positions").flatten().to_pylist()
    lat, lon = sailed_places(run, chart)
    np.testing.assert_allclose(places, np.column_stack([lat, lon])[::3], rtol=1e-12)  # slow rows
    assert b"Map" in (tmp_path / "run.rrd").read_bytes()
    assert Trajectory.from_rrd(tmp_path / "run.rrd").meta == run.meta
    straight(0.0, 300.0).to_rrd(tmp_path / "plain.rrd")
    plain = read_chunks(tmp_path / "plain.rrd")
    assert not any(chunk.entity_path.startswith("/map") for chunk in plain)
