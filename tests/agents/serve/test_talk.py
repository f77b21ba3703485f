"""Sentences of the instruments, read back by pynmea2; examples of the wind are the standard's."""

import datetime
import math

import pytest

pynmea2 = pytest.importorskip("pynmea2")

from ship_gym_agents.serve.instruments import Seen, relative  # noqa: E402
from ship_gym_agents.serve.nmea import LONGEST, made  # noqa: E402
from ship_gym_agents.serve.server import periods  # noqa: E402
from ship_gym_agents.serve.talk import RATES, TALKERS, Fix, sentences_of  # noqa: E402
from ship_gym_agents.serve.voyage import OnLeg, ends_of  # noqa: E402

from ship_gym.conventions import KNOT  # noqa: E402
from ship_gym.tracks import Route, Waypoint  # noqa: E402

UTC = datetime.datetime(2026, 7, 9, 4, 5, 6, 789012, tzinfo=datetime.UTC)
SEEN = Seen(
    time=0.0,
    heading=math.radians(15.5),
    rate=math.radians(-1.0),
    surge=10.0 * KNOT,
    sway=-0.5 * KNOT,
    ground_surge=11.0 * KNOT,
    ground_sway=0.25 * KNOT,
    north=0.0,
    east=0.0,
    course=math.radians(17.0),
    speed=11.003 * KNOT,
    rudder=math.radians(-3.25),
    rudders=1,
    wind=(0.0, -10.0),
)
LEG = OnLeg(185.2, math.radians(90.0), "W001", math.radians(89.0), math.radians(80.0), False, True)


def fix(seen=SEEN, latitude=54.5, longitude=-8.25, leg=LEG, simulated=False):
    return Fix(seen, latitude, longitude, UTC, leg, simulated)


def said(kind, **changes):
    """The sentences of a kind, through the wire."""
    lines = [made(TALKERS[kind], kind, fields) for fields in sentences_of(kind, fix(**changes))]
    assert all(line.endswith("\r\n") and len(line) <= LONGEST for line in lines)
    return [pynmea2.parse(line, check=True) for line in lines]


def test_heading_and_turn():
    (heading,), (turn,) = said("HDT"), said("ROT")
    assert (heading.talker, float(heading.heading), heading.hdg_true) == ("HE", 15.5, "T")
    assert (float(turn.rate_of_turn), turn.status) == (-60.0, "A")  # to port, deg/min


@pytest.mark.parametrize(
    ("degrees", "text"), [(359.999, "000.00"), (359.99, "359.99"), (0.0, "000.00")]
)
def test_bearings_go_round(degrees, text):
    (heading,) = said("HDT", seen=SEEN._replace(heading=math.radians(degrees)))
    assert heading.data[0] == text


def test_rudder():
    (one,), (two,) = said("RSA"), said("RSA", seen=SEEN._replace(rudders=2))
    assert one.data == ["-3.25", "A", "", "V"]  # - turns to port
    assert two.data == ["-3.25", "A", "-3.25", "A"]
    assert said("RSA", seen=SEEN._replace(rudder=-1e-9))[0].data[0] == "0.00"


def test_log():
    (log,) = said("VBW")
    assert [float(v) for v in (log.lon_water_spd, log.trans_water_spd)] == [10.0, -0.5]
    assert [float(v) for v in (log.lon_grnd_spd, log.trans_grnd_spd)] == [11.0, 0.25]
    assert log.is_valid


@pytest.mark.parametrize(
    ("latitude", "longitude"), [(54.5, -8.25), (-0.001, 179.999999), (-33.9999999, 0.0), (0.0, 9.0)]
)
def test_position(latitude, longitude):
    for kind in ("RMC", "GGA"):
        (place,) = said(kind, latitude=latitude, longitude=longitude)
        assert place.latitude == pytest.approx(latitude, abs=1e-7)
        assert place.longitude == pytest.approx(longitude, abs=1e-7)
        assert place.timestamp.isoformat() == "04:05:06.780000+00:00"
        assert place.is_valid


def test_motion_and_date():
    (fix_,) = said("RMC")
    assert fix_.spd_over_grnd == pytest.approx(11.003) and fix_.true_course == 17.0
    assert fix_.datestamp == datetime.date(2026, 7, 9)


def test_a_simulated_position_says_so():
    (place,), (quality,) = said("RMC", simulated=True), said("GGA", simulated=True)
    assert (place.mode_indicator, place.status, quality.gps_qual) == ("S", "V", 8)


def under_way(knots, wind_from, wind_knots):
    """Heading west; the wind from a direction [deg]."""
    angle = math.radians(wind_from) + math.pi
    wind = tuple(wind_knots * KNOT * part for part in (math.cos(angle), math.sin(angle)))
    heading = math.radians(270.0)
    return SEEN._replace(heading=heading, ground_surge=knots * KNOT, ground_sway=0.0, wind=wind)


@pytest.mark.parametrize(
    ("ship", "relative_wind", "theoretical"),
    [
        # the two examples of the definition of MWV in NMEA 0183
        (under_way(7.0, 90.0, 10.0), (180.0, 3.0), (180.0, 10.0)),
        (under_way(5.0, 135.0, 5.0 * math.sqrt(2.0)), (270.0, 5.0), (225.0, 7.07)),
    ],
)
def test_wind_of_the_standard(ship, relative_wind, theoretical):
    felt, true = said("MWV", seen=ship)
    assert (felt.reference, true.reference) == ("R", "T")
    for sentence, wanted in ((felt, relative_wind), (true, theoretical)):
        shown = float(sentence.wind_angle), float(sentence.wind_speed)
        assert shown == pytest.approx(wanted, abs=0.051)
        assert (sentence.wind_speed_units, sentence.status) == ("N", "A")
    assert relative(ship, moving=True)[1] == pytest.approx(relative_wind[1] * KNOT, rel=1e-6)


def test_no_wind_no_route_nothing_said():
    assert said("MWV", seen=SEEN._replace(wind=None)) == []
    assert said("XTE", leg=None) == said("APB", leg=None) == []


@pytest.mark.parametrize(("cross", "side"), [(185.2, "L"), (-185.2, "R")])
def test_off_track_steers_back(cross, side):
    """A ship to starboard of the leg is told to steer to port."""
    (off,) = said("XTE", leg=LEG._replace(cross=cross))
    assert off.data == ["A", "A", "0.1000", side, "N"]
    (pilot,) = said("APB", leg=LEG._replace(cross=cross))
    assert (pilot.cross_track_err_mag, pilot.dir_steer) == ("0.1000", side)
    assert (pilot.arr_circle_entered, pilot.perp_passed) == ("V", "A")
    assert (pilot.bearing_to_dest, pilot.bearing_type, pilot.dest_waypoint_id) == (
        "090.00",
        "T",
        "W001",
    )
    assert (pilot.bearing_pres_dest, pilot.heading_to_dest) == ("089.00", "080.00")


def test_rates_are_whole_intervals():
    every = periods(RATES, 0.1)
    assert every == {"HDT": 1, "ROT": 1, "RSA": 2, **dict.fromkeys(list(TALKERS)[3:], 10)}
    assert set(periods(RATES, 1.0).values()) == {1}
    assert periods(RATES | {"GGA": 0.0, "HDT": 0.2}, 1.0)["HDT"] == 5
    assert "GGA" not in periods(RATES | {"GGA": 0.0}, 1.0)


@pytest.mark.parametrize(
    ("name", "told"),
    [("Sjællands Øst", "Sjllands st"), ("Kühlung*,$", "Kuhlung"), ("東京", "W003"), ("", "W003")],
)
def test_names_of_waypoints_in_letters_of_a_sentence(name, told):
    """Accents go, other letters too; a name of which nothing is left is its number."""
    pytest.importorskip("pyproj", reason="extra 'geo' not installed")
    points = [Waypoint(54.0 + 0.1 * k, 10.0, name) for k in range(4)]
    track = Route("", tuple(points)).track()
    assert ends_of(track)[-1][0] == told[:10]
