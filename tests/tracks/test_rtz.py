"""RTZ 1.0 to 1.2: the schema of IEC 61174 annex S, its units and what a leg takes from the default.

Radii and cross-track limits are nautical miles (at most 5, below 10), speeds knots; a leg stands at
the way-point that it leads to. The samples are our own.
"""

import itertools
from pathlib import Path

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.conventions import KNOT
from ship_gym.reading import read_xml
from ship_gym.tracks import Leg, Route, Waypoint, load_route, load_track, save_track

pytest.importorskip("pyproj", reason="extra 'geo' not installed")
pytest.importorskip("defusedxml", reason="extra 'geo' not installed")

FIELD = Path(__file__).parents[2] / "../shared/reference/field"
SPACE = "http://www.cirm.org/RTZ/1/2"
KIEL = """<?xml version="1.0" encoding="UTF-8"?>
<route xmlns="http://www.cirm.org/RTZ/1/{minor}" version="1.{minor}">
  <routeInfo routeName="Kiel to Gedser" vesselName="Nobody"/>
  <waypoints>
    <defaultWaypoint radius="0.5">
      <leg starboardXTD="0.2" portsideXTD="0.1" geometryType="Orthodrome" speedMax="12"/>
    </defaultWaypoint>
    <waypoint id="7" revision="0" name="Kiel light &amp; pilots">
      <position lat="54.5" lon="10.28"/>
      <leg starboardXTD="9" geometryType="Loxodrome"/>
    </waypoint>
    <waypoint id="3" revision="2" radius="1.0">
      <position lat="54.6" lon="11.0"/>
      <leg geometryType="Loxodrome" portsideXTD="1.5" speedMin="6"/>
      <extensions><extension manufacturer="A" name="b"><waypoint id="99"/></extension></extensions>
    </waypoint>
    <!-- a comment -->
    <waypoint id="12" revision="0" name="Gedser">
      <position lat="54.4" lon="11.9"/>
    </waypoint>
    <waypoint id="4" revision="0" radius="0">
      <position lat="54.45" lon="12.2"/>
    </waypoint>
    <extensions><extension manufacturer="A" name="c"/></extensions>
  </waypoints>
  <schedules>
    <schedule id="1"><manual><scheduleElement waypointId="7"/></manual></schedule>
  </schedules>
</route>
"""


@pytest.fixture
def written(tmp_path):
    def write(text, name="a.rtz"):
        (tmp_path / name).write_text(text, encoding="utf-8")
        return tmp_path / name

    return write


def kiel(*changes, minor=2):
    text = KIEL.format(minor=minor)
    for old, new in changes:
        assert text.count(old) >= 1, old
        text = text.replace(old, new, 1)
    return text


@pytest.mark.parametrize("minor", [0, 1, 2])
def test_what_a_file_says_and_what_its_default_says(written, minor):
    route = load_route(written(kiel(minor=minor)))
    assert route == Route(
        "Kiel to Gedser",
        (
            Waypoint(54.5, 10.28, "Kiel light & pilots", 0.5 * 1852.0, 7),
            Waypoint(54.6, 11.0, "", 1852.0, 3),
            Waypoint(54.4, 11.9, "Gedser", 0.5 * 1852.0, 12),
            Waypoint(54.45, 12.2, "", 0.0, 4),
        ),
        (
            Leg("loxodrome", 1.5 * 1852.0, 0.2 * 1852.0, 6 * KNOT, 12 * KNOT),
            Leg("orthodrome", 0.1 * 1852.0, 0.2 * 1852.0, None, 12 * KNOT),
            Leg("orthodrome", 0.1 * 1852.0, 0.2 * 1852.0, None, 12 * KNOT),
        ),
    )
    track = load_track(written(kiel(minor=minor)))
    assert track.route == route
    np.testing.assert_allclose(track.limits[0], [2778.0, 370.4])


def test_rhumb_lines_unless_somebody_says_otherwise(written):
    bare = kiel(
        ('<defaultWaypoint radius="0.5">', "<defaultWaypoint>"),
        ('starboardXTD="0.2" portsideXTD="0.1" geometryType="Orthodrome" ', ""),
    )
    path = written(bare)
    assert {leg.geometry for leg in load_route(path).legs} == {"loxodrome"}
    said = [leg.geometry for leg in load_route(path, geometry="orthodrome").legs]
    assert said == ["loxodrome", "orthodrome", "orthodrome"]  # the first one is the file's
    assert load_route(path).waypoints[0].radius is None


@pytest.mark.parametrize("suffix", ["rtz", "gpx", "geojson", "json"])
@pytest.mark.parametrize("minor", [0, 1, 2])
def test_a_route_read_and_exported_is_the_same_route(written, tmp_path, minor, suffix):
    pytest.importorskip("gpxpy", reason="extra 'geo' not installed")
    route = load_route(written(kiel(minor=minor)))
    out = tmp_path / f"out.{suffix}"
    save_track(route, out)
    assert load_route(out) == route
    save_track(load_track(out), out)  # through the plane: as the route that it was made of
    assert load_route(out) == route


@pytest.mark.parametrize("suffix", ["rtz", "gpx", "geojson"])
@pytest.mark.parametrize(
    "name", ["JPNGO_STLAW_BASIC_RTZ", "RTZ1.2AllOptionalElementsAndAttributes"]
)
def test_routes_of_the_field(tmp_path, name, suffix):
    pytest.importorskip("gpxpy", reason="extra 'geo' not installed")
    if not (FIELD / f"{name}.rtz").is_file():
        pytest.skip("no such file here")
    route = load_route(FIELD / f"{name}.rtz")
    assert len(route.waypoints) == 6 and route.name == name
    save_track(route, tmp_path / f"out.{suffix}")
    assert load_route(tmp_path / f"out.{suffix}") == route
    assert route.track().total_length > 8e6


def test_what_is_written_is_as_the_schema_wants_it(written, tmp_path):
    """Order of elements and attributes as in the schema of RTZ 1.2; lengths in short numbers."""
    save_track(load_route(written(kiel(minor=0))), tmp_path / "out.rtz")
    root = read_xml(tmp_path / "out.rtz")
    assert root.tag == f"{{{SPACE}}}route" and root.attrib == {"version": "1.2"}
    assert [e.tag for e in root] == [f"{{{SPACE}}}routeInfo", f"{{{SPACE}}}waypoints"]
    points = list(root[1])
    assert [p.get("id") for p in points] == ["7", "3", "12", "4"]
    assert [p.get("radius") for p in points] == ["0.5", "1", "0.5", "0"]
    for point in points:
        names = [e.tag.partition("}")[2] for e in point]
        assert names == (["position"] if point is points[0] else ["position", "leg"])
    expected = {"portsideXTD": "1.5", "starboardXTD": "0.2", "speedMin": "6", "speedMax": "12"}
    assert points[1][1].attrib == expected | {"geometryType": "Loxodrome"}


def test_ids_are_made_where_there_are_none(tmp_path):
    route = Route("", (Waypoint(54.0, 10.0), Waypoint(55.0, 180.0)))
    save_track(route, tmp_path / "out.rtz")
    found = load_route(tmp_path / "out.rtz")
    assert [p.id for p in found.waypoints] == [1, 2] and found.name == "out"
    assert found.waypoints[1].longitude == -180.0  # the schema allows less than 180


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ([('lat="54.6"', 'lat="154.6"')], "way-point id 3: position: lat = 154.6: allowed is"),
        ([('lat="54.6"', 'lat="54,6"')], "way-point id 3: position: lat = '54,6': must be a"),
        ([('lat="54.6"', 'lat="nan"')], "way-point id 3: position: lat = 'nan': must be a number"),
        ([('lat="54.6"', 'lat="1e999"')], "way-point id 3: position: lat = inf: allowed is"),
        ([('lat="54.6" ', "")], "way-point id 3: position: no lat; must be"),
        ([('lon="11.0"', 'lon="541"')], "way-point id 3: position: lon = 541.0: allowed is"),
        ([('<position lat="54.6" lon="11.0"/>', "")], "way-point id 3: no element position"),
        ([('radius="1.0"', 'radius="5.1"')], "way-point id 3: radius = 5.1: allowed is 0 to 5 .N"),
        ([('portsideXTD="1.5"', 'portsideXTD="-1"')], "id 3: leg: portsideXTD = -1.0: .* 0 to 10"),
        ([('speedMin="6"', 'speedMin="fast"')], "id 3: leg: speedMin = 'fast': .*kn"),
        ([('geometryType="Orthodrome"', 'geometryType="Orthodrom"')],
         "defaultWaypoint: leg: geometryType = 'Orthodrom': allowed is Loxodrome or Orthodrome"),
        ([('<waypoint id="3"', '<waypoint id="7"')], "way-point id 7: the id is there twice"),
        ([('<waypoint id="3"', '<waypoint id="-3"')], r"way-point 1 \(from 0\): id = '-3'; must"),
        ([('id="7" revision', "revision")], r"way-point 0 \(from 0, name 'Kiel .*\): no id; must"),
        ([("<waypoints>", "<points>"), ("</waypoints>", "</points>")], "no element waypoints"),
        ([('version="1.2"', 'version="2.0"')], "route: version = '2.0': allowed is 1.0, 1.1, 1.2"),
        ([("RTZ/1/2", "RTZ/1/3")], "root element .*RTZ/1/3.*: allowed is route of RTZ"),
        ([("<route ", "<voyage "), ("</route>", "</voyage>")], "root element .*voyage"),
        ([("</waypoints>", "")], "not XML, or damaged: mismatched tag"),
        ([("<route ", "<!DOCTYPE route><route ")], "declares a document type"),
    ],
)  # fmt: skip
def test_malformed(written, changes, message):
    with pytest.raises(ConfigError, match=f"a.rtz: .*{message}") as error:
        load_track(written(kiel(*changes)))
    assert len(str(error.value)) <= 300 and "\n" not in str(error.value)


def test_a_turn_that_does_not_fit_names_file_and_waypoint(written):
    text = kiel(
        ('lat="54.6" lon="11.0"', 'lat="54.501" lon="10.29"'), ('radius="1.0"', 'radius="5"')
    )
    with pytest.raises(
        ConfigError, match=r"a.rtz: way-point 1 \(id 3\): a planned turn of .* needs"
    ):
        load_track(written(text))


BOMBS = {
    "billion laughs": '<!DOCTYPE route [<!ENTITY a "lol"><!ENTITY b "&a;&a;&a;">]>{}',
    "external entity": '<!DOCTYPE route [<!ENTITY a SYSTEM "file:///etc/passwd">]>{}',
    "external DTD": '<!DOCTYPE route SYSTEM "http://127.0.0.1:9/a.dtd">{}',
    "parameter entity": '<!DOCTYPE route [<!ENTITY % a SYSTEM "file:///etc/passwd"> %a;]>{}',
    "undeclared entity": "{}",
}


@pytest.mark.parametrize("name", ["a.rtz", "a.gpx"])
@pytest.mark.parametrize("bomb", BOMBS)
def test_entities_are_not_expanded_and_nothing_is_fetched(written, monkeypatch, bomb, name):
    import socket

    monkeypatch.setattr(socket, "socket", None)  # who opens one fails with a trace
    head, body = KIEL.format(minor=2).split("\n", 1)
    text = f"{head}\n{BOMBS[bomb].format(body.replace('Kiel to Gedser', '&a;'))}"
    expected = "not XML, or damaged: undefined entity" if bomb[0] == "u" else "document type or an"
    with pytest.raises(ConfigError, match=expected) as error:
        load_route(written(text, name))
    assert len(str(error.value)) <= 300


@pytest.mark.parametrize("encoding", ["utf-16", "utf-8-sig", "iso-8859-1"])
def test_encodings_that_xml_declares(tmp_path, encoding):
    declared = "UTF-16" if encoding == "utf-16" else encoding.removesuffix("-sig").upper()
    text = kiel(("UTF-8", declared), ("Gedser", "Køge"))
    (tmp_path / "a.rtz").write_bytes(text.encode(encoding))
    assert load_route(tmp_path / "a.rtz").name == "Kiel to Køge"


def test_deep_and_long_files_end_in_a_line(written):
    deep = "<a>" * 50_000 + "</a>" * 50_000
    with pytest.raises(ConfigError, match=r"a.rtz: .*"):
        load_route(written(deep))
    point = '<waypoint id="{0}"><position lat="{1:.6f}" lon="10.0"/></waypoint>'
    points = "".join(point.format(i, 20.0 + 1e-3 * i) for i in range(20_001))
    head, tail = f'<route xmlns="{SPACE}" version="1.2"><waypoints>', "</waypoints></route>"
    with pytest.raises(ConfigError, match="20001 way-points; at most 20000"):
        load_route(written(head + points + tail))


def test_values_that_rtz_does_not_allow_are_not_written(tmp_path):
    points = Waypoint(54.0, 10.0), Waypoint(54.5, 10.0, radius=20e3), Waypoint(54.5, 11.0)
    with pytest.raises(ConfigError, match=r"out.rtz: way-point id 2: radius = 10.799.*0 to 5"):
        save_track(Route("a", points), tmp_path / "out.rtz")
    wide = (Leg(), Leg(port=20e3))
    with pytest.raises(ConfigError, match=r"id 3: leg: portsideXTD = 10.799.*0 to 10"):
        save_track(
            Route("a", (*points[:1], Waypoint(54.5, 10), points[2]), wide), tmp_path / "out.rtz"
        )
    assert list(tmp_path.iterdir()) == []


def test_numbers_come_back_bit_by_bit(tmp_path):
    """Also lengths that are no short number of nautical miles."""
    random = np.random.default_rng(1)
    for radius, port, speed in zip(*random.uniform(1.0, 60.0, (3, 40)), strict=True):
        points = (
            Waypoint(54.0 + port / 97, -radius / 7, "", radius * 31),
            Waypoint(60.0, 11 / speed),
        )
        route = Route("x", points, (Leg("orthodrome", port * 100, 0.1 * 1852.0, speed),))
        save_track(route, tmp_path / "a.rtz")
        found = load_route(tmp_path / "a.rtz")
        assert found.waypoints[0].latitude == points[0].latitude
        assert found.waypoints[0].radius == pytest.approx(points[0].radius, rel=1e-15)
        assert found.legs[0].port == pytest.approx(route.legs[0].port, rel=1e-15)
        assert found.legs[0].starboard == 0.1 * 1852.0
    for known in itertools.chain(np.arange(1, 50) / 10, np.arange(1, 100) / 100):
        route = Route("x", points, (Leg(port=float(known) * 1852.0),))
        save_track(route, tmp_path / "a.rtz")
        assert load_route(tmp_path / "a.rtz").legs == route.legs


def test_the_largest_radius_is_that_of_the_version(tmp_path):
    """Schemas of RTZ: radius below 10 NM in 1.0, at most 5 NM in 1.1 and 1.2; limits below 10."""
    path = tmp_path / "wide.rtz"
    for version, fits in (("1.0", True), ("1.1", False), ("1.2", False)):
        path.write_text(
            f'<route xmlns="http://www.cirm.org/RTZ/{version.replace(".", "/")}" '
            f'version="{version}"><routeInfo routeName="wide"/><waypoints>'
            '<waypoint id="1"><position lat="54" lon="10"/></waypoint>'
            '<waypoint id="2" radius="8"><position lat="54.5" lon="10"/></waypoint>'
            '<waypoint id="3"><position lat="54.5" lon="11"/></waypoint></waypoints></route>'
        )
        if fits:
            assert load_route(path).waypoints[1].radius == 8 * 1852.0
        else:
            with pytest.raises(ConfigError, match=r"id 2: radius = 8\.0: allowed is 0 to 5 .NM"):
                load_route(path)
    points = Waypoint(54.0, 10.0), Waypoint(54.5, 10.0)
    with pytest.raises(ConfigError, match=r"portsideXTD = 10: must be below 10 .NM"):
        save_track(Route("", points, (Leg(port=18520.0),)), tmp_path / "out.rtz")
    assert not (tmp_path / "out.rtz").exists()
