"""``ship-gym route``: what it prints, writes and refuses."""

import json

import numpy as np
import pytest

from ship_gym.tracks import Leg, Route, Track, Waypoint, load_route, save_track

pytest.importorskip("pyproj", reason="extra 'geo' not installed")
pytest.importorskip("gpxpy", reason="extra 'geo' not installed")
pytest.importorskip("defusedxml", reason="extra 'geo' not installed")


@pytest.fixture
def voyage(tmp_path):
    """60 nautical miles due north, then a turn of 1 nautical mile due east."""
    points = Waypoint(54.0, 10.0, "Start"), Waypoint(55.0, 10.0, "Turn", 1852.0), Waypoint(55.0, 11)
    legs = Leg(port=185.2, starboard=370.4, speed_max=7.2022), Leg("orthodrome")
    route = Route("voyage", points, legs)
    save_track(route, tmp_path / "voyage.rtz")
    return tmp_path / "voyage.rtz"


def test_a_table_of_the_legs(cli, voyage):
    code, out, _ = cli("route", voyage)
    assert code == 0 and out.startswith("route voyage: 3 way-points, ")
    first, second = (line.split() for line in out.splitlines() if "drome" in line)
    assert first[1:] == ["Turn", *"55.000000 10.000000 loxodrome 000.0 60.10 185 370".split(), "to",
                         "14", "1852"]  # fmt: skip
    assert second[1:5] == ["55.000000", "11.000000", "orthodrome", "089.6-090.4"]
    assert "straight pieces" in out and f"track.file={voyage}" in out


def test_json_has_bearings_and_lengths(cli, voyage):
    code, out, _ = cli("route", voyage, "--json")
    found = json.loads(out)
    assert code == 0 and found["name"] == "voyage" and found["written"] == []
    assert found["legs"][0]["bearing_deg"] == 0.0
    assert found["legs"][0]["length"] == pytest.approx(111_315.0, abs=20.0)
    assert found["legs"][0]["port"] == pytest.approx(185.2)
    assert found["plane"]["legs"] > 20
    cut = (2.0 - 0.5 * np.pi) * 1852.0  # of a turn of 90 deg
    assert found["length"] - found["plane"]["length"] == pytest.approx(cut, abs=15.0)


@pytest.mark.parametrize("suffix", ["gpx", "geojson", "rtz"])
def test_written_in_another_format_it_is_the_same_route(cli, voyage, tmp_path, suffix):
    out = tmp_path / f"other.{suffix}"
    code, told, _ = cli("route", voyage, "--out", out)
    assert code == 0 and f"wrote {out}" in told
    assert load_route(out) == load_route(voyage)
    assert cli("route", voyage, "--out", out)[0] == 0  # the same route may be replaced
    save_track(Route("mine", load_route(voyage).waypoints), out)
    code, _, err = cli("route", voyage, "--out", out)
    assert code == 2 and "holds the route 'mine', not the route 'voyage'; see --force" in err
    assert cli("route", voyage, "--out", out, "--force")[0] == 0
    assert load_route(out) == load_route(voyage)


@pytest.mark.parametrize("suffix", ["gpx", "geojson", "rtz"])
def test_the_same_command_twice(cli, tmp_path, suffix):
    """A plotter's route has no numbers and maybe no name; RTZ gives it both, in other units."""
    points = Waypoint(54.0, 10.0), Waypoint(54.1, 10.0, radius=123.456789), Waypoint(54.1, 10.2)
    save_track(Route("", points, (Leg(port=77.7), Leg(speed_max=6.1))), tmp_path / "a.gpx")
    command = ("route", tmp_path / "a.gpx", "--out", tmp_path / f"b.{suffix}")
    assert [cli(*command)[0] for _ in range(2)] == [0, 0]
    save_track(Route("", points, (Leg(port=77.8), Leg(speed_max=6.1))), tmp_path / "a.gpx")
    code, _, err = cli(*command)
    assert code == 2 and "with other settings" in err


def test_metres_from_a_place(cli, tmp_path):
    save_track(Track([[0.0, 0.0], [3000.0, 0.0]]), tmp_path / "tank.geojson")
    code, _, err = cli("route", tmp_path / "tank.geojson")
    assert code == 2 and "is in metres" in err and "--origin" in err
    code, _, _ = cli(
        "route", tmp_path / "tank.geojson", "--origin", -33.0, -4.5, "--out", tmp_path / "tank.rtz"
    )
    found = load_route(tmp_path / "tank.rtz").waypoints
    assert code == 0 and (found[0].latitude, found[0].longitude) == (-33.0, -4.5)
    code, _, err = cli("route", tmp_path / "tank.rtz", "--origin", -33.0, -4.5)
    assert code == 2 and "has places on the earth" in err


def test_a_picture(cli, voyage, tmp_path):
    pytest.importorskip("matplotlib")
    code, told, _ = cli("route", voyage, "--picture", tmp_path / "a.png")
    assert code == 0 and "a.png" in told and (tmp_path / "a.png").read_bytes()[1:4] == b"PNG"


def test_a_turn_that_does_not_fit_names_the_file(cli, voyage):
    points = *load_route(voyage).waypoints[:2], Waypoint(55.0, 10.02, "Near")
    save_track(Route("voyage", points), voyage)
    code, _, err = cli("route", voyage)
    told = f"error: {voyage}: way-point 1 (id 2, 'Turn'): a planned turn of 90 deg with radius 18"
    assert code == 2 and err.count("\n") == 1 and err.startswith(told[:100])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["none.rtz"], "error: none.rtz: no such file"),
        (["a.kml"], "error: a.kml: a track file ends in .rtz, .gpx, .geojson or .json"),
        (["none.rtz", "--geometry", "straight"], "unknown geometry 'straight'"),
        (["none.rtz", "--out", "a.kml"], "--out a.kml: allowed is a .rtz or .gpx or .geojson file"),
        (
            ["a.json", "--origin", "1", "2", "--geometry", "orthodrome"],
            "--origin is for a track in",
        ),
        (["none.rtz", "--origin", "91", "0"], "latitude = 91.0: allowed is -89 to 89"),
    ],
)
def test_refused_in_one_line(cli, tmp_path, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    code, out, err = cli("route", *arguments)
    assert (code, out, err.count("\n")) == (2, "", 1) and message in err
