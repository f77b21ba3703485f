"""GPX 1.0 and 1.1, by gpxpy and by hand."""

import pytest

from ship_gym.config import ConfigError
from ship_gym.tracks import Leg, Route, Waypoint, load_route, load_track, save_track

pytest.importorskip("pyproj", reason="extra 'geo' not installed")
gpxpy = pytest.importorskip("gpxpy", reason="extra 'geo' not installed")

PLACES = [(54.5, 10.28), (54.6, 11.0), (54.4, 179.9), (54.4, -179.9)]
HEAD = '<gpx version="1.1" creator="me" xmlns="http://www.topografix.com/GPX/1/1">'


def points(kind, places=PLACES):
    return "".join(f'<{kind}pt lat="{a}" lon="{b}"/>' for a, b in places)


def rte(places=PLACES, name=""):
    return f"<rte><name>{name}</name>{points('rte', places)}</rte>"


def trk(*segments, name=""):
    inner = "".join(f"<trkseg>{points('trk', segment)}</trkseg>" for segment in segments)
    return f"<trk><name>{name}</name>{inner}</trk>"


@pytest.fixture
def written(tmp_path):
    def write(*parts, head=HEAD):
        (tmp_path / "a.gpx").write_text(f"{head}{''.join(parts)}</gpx>")
        return tmp_path / "a.gpx"

    return write


def places(route):
    return [(point.latitude, point.longitude) for point in route.waypoints]


def test_routes_and_tracks(written):
    assert places(load_route(written(rte(name="out")))) == PLACES
    assert load_route(written(rte(name="out"))).name == "out"
    assert {leg.geometry for leg in load_route(written(rte())).legs} == {"loxodrome"}
    great = load_route(written(rte()), geometry="orthodrome")
    assert {leg.geometry for leg in great.legs} == {"orthodrome"}
    assert places(load_route(written(trk(PLACES)))) == PLACES
    assert places(load_route(written(trk(PLACES[:2], PLACES[2:])))) == PLACES
    both = '<wpt lat="1" lon="2"/>', trk(PLACES[:2]), rte()
    assert places(load_route(written(*both))) == PLACES  # a plan goes before a log
    empty = rte([], "nothing yet"), trk(PLACES), trk([])
    assert places(load_route(written(*empty))) == PLACES  # plotters write lines without places
    old = '<gpx version="1.0" creator="me" xmlns="http://www.topografix.com/GPX/1/0">'
    assert places(load_route(written(rte(), head=old))) == PLACES
    assert places(load_route(written(rte(), head='<gpx version="1.1">'))) == PLACES


def test_a_track_that_logs_a_place_twice(written):
    log = [PLACES[0], PLACES[0], *PLACES[1:], PLACES[-1]]
    assert places(load_route(written(trk(log)))) == PLACES
    with pytest.raises(ConfigError, match=r"a.gpx: way-point 1: 0 m from the one before"):
        load_track(written(rte(log)))


def test_what_gpxpy_writes_is_read(tmp_path):
    file = gpxpy.gpx.GPX()
    file.routes.append(gpxpy.gpx.GPXRoute("Kiel & <Gedser>"))
    for i, place in enumerate(PLACES):
        file.routes[0].points.append(gpxpy.gpx.GPXRoutePoint(*place, name=f"no. {i}", elevation=3))
    (tmp_path / "a.gpx").write_text(file.to_xml("1.1"))
    route = load_route(tmp_path / "a.gpx")
    assert route.name == "Kiel & <Gedser>" and places(route) == PLACES
    assert [point.name for point in route.waypoints] == [f"no. {i}" for i in range(4)]


def test_what_is_written_gpxpy_reads(tmp_path):
    names = Waypoint(54.5, 10.28, "a & <b>", 926.0, 3), Waypoint(54.6, 11.0, "ø", 1e-5)
    route = Route("Kiel & <Gedser>", names, (Leg("orthodrome", 185.2, None, 3.1, 7.0),))
    save_track(route, tmp_path / "a.gpx")
    found = gpxpy.parse((tmp_path / "a.gpx").read_text(encoding="utf-8"))
    assert found.routes[0].name == route.name
    assert [p.name for p in found.routes[0].points] == ["a & <b>", "ø"]
    assert [p.latitude for p in found.routes[0].points] == [54.5, 54.6]
    assert load_route(tmp_path / "a.gpx") == route


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ([rte(name="a"), rte(name="b")], r"holds 2 routes \('a', 'b'\); wanted is one"),
        ([trk(PLACES), trk(PLACES)], "holds 2 tracks"),
        (['<wpt lat="1" lon="2"/>'], r"holds 1 single way-points \(wpt\); wanted is one route"),
        ([], "holds no places"),
        (["<rte/>"], "holds no places"),
        ([rte([(54.0, 10.0), (95.0, 10.0)])], r"rtept 1 \(from 0\): lat = 95.0: allowed is -89"),
        ([rte([(54.0, 10.0), ("", 10.0)])], r"rtept 1 \(from 0\): lat = '': must be a number"),
        ([trk([(54.0, "x")])], r"trkpt 0 \(from 0\): lon = 'x': must be a number"),
        (['<rte><rtept lon="1"><name>Buoy</name></rtept></rte>'], "0 .from 0., 'Buoy': no lat"),
        (["<rte>"], "not XML"),
    ],
)
def test_malformed(written, parts, message):
    with pytest.raises(ConfigError, match=f"a.gpx: .*{message}") as error:
        load_track(written(*parts))
    assert len(str(error.value)) <= 300 and "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("extension", "message"),
    [
        ('<s:waypoint radius="-1"/>', r"rtept 0 \(from 0\): radius = -1.0: allowed is 0"),
        ('<s:leg geometry="straight"/>', r"rtept 0 \(from 0\): unknown geometry 'straight'"),
        ('<s:leg port="wide"/>', r"rtept 0 \(from 0\): leg: port = 'wide': must be a number"),
    ],
)
def test_malformed_extensions(written, extension, message):
    head = HEAD.replace("xmlns=", 'xmlns:s="urn:ship-gym:route:1" xmlns=')
    point = f'<rtept lat="1" lon="2"><extensions>{extension}</extensions></rtept>'
    with pytest.raises(ConfigError, match=message):
        load_route(written(f"<rte>{point}{points('rte')}</rte>", head=head))


def test_another_root(tmp_path):
    (tmp_path / "a.gpx").write_text("<kml/>")
    with pytest.raises(ConfigError, match=r"root element 'kml': allowed is gpx of GPX 1.0 or 1.1"):
        load_route(tmp_path / "a.gpx")
