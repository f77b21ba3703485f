"""The suite of manoeuvres: definitions, what is sailed, rows of the table, its file."""

import dataclasses
import math

import pytest

from ship_gym.config import ConfigError
from ship_gym.evaluation.manoeuvres.definition import Manoeuvre
from ship_gym.evaluation.manoeuvres.sailing import NO_WAVES, sail_manoeuvres
from ship_gym.evaluation.manoeuvres.table import (
    COLUMNS,
    read_manoeuvres,
    rows_of,
    write_manoeuvres,
)
from ship_gym.evaluation.suite import load_suite
from ship_gym.manoeuvres import imo_limits, turning_circle, zigzag
from ship_gym.ships import load_ship
from ship_gym.stopping import stopping

pytest.importorskip("pyarrow")


@pytest.fixture(scope="module")
def rows(sailed):
    return rows_of(sailed)


def one(rows, **asked):
    found = [row for row in rows if all(row[key] == value for key, value in asked.items())]
    assert len(found) == 1, (asked, len(found))
    return found[0]


def test_the_standard_suite_has_the_manoeuvres_of_the_issue():
    found = load_suite("manoeuvres")
    names = [each.name for each in found.manoeuvre]
    assert names == [
        "turning circle 35 deg", "zig-zag 10/10", "zig-zag 20/20", "zig-zag 10/5", "zig-zag 20/5",
        "zig-zag 20/10", "pull-out", "direct spiral", "crash stop",
    ]  # fmt: skip
    assert {each.name for each in found.manoeuvre if each.seas == ("calm", "ss5")} == {
        *names[:6], "crash stop"
    }  # fmt: skip
    assert found.kind == "manoeuvres" and not found.controllers and not found.scenario


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"kind": "turing"}, "did you mean 'turning'"),
        ({"kind": "turning", "heading_deg": 10.0}, "allowed for a zigzag only"),
        ({"kind": "zigzag", "rudder_deg": 0.0}, "manoeuvre zigzag.rudder_deg = 0.0"),
        ({"kind": "zigzag", "heading_deg": 91.0}, "manoeuvre zigzag.heading_deg = 91.0"),
        ({"kind": "spiral", "seas": ()}, "seas: at least one"),
    ],
)
def test_a_wrong_manoeuvre_is_refused(given, words):
    with pytest.raises(ConfigError, match=words):
        Manoeuvre(**given)


def test_unknown_seas_and_ships_are_refused_before_the_work():
    with pytest.raises(ConfigError, match="ss55"):
        sail_manoeuvres([Manoeuvre("spiral", seas=("ss55",))], ["kcs"])
    with pytest.raises(ConfigError, match="did you mean 'kcs'"):
        sail_manoeuvres([Manoeuvre("spiral")], ["kcz"])


def test_rows_are_what_the_manoeuvres_give(rows):
    """The same numbers as by the functions of the package, in units of display."""
    circle = turning_circle("kvlcc2", -math.radians(35.0))
    there = {"ship": "kvlcc2", "manoeuvre": "turning circle 35 deg", "side": "port"}
    found = one(rows, **there, measure="advance")
    assert found["value"] == circle.advance and found["unit"] == "L" and found["sea"] == "calm"
    drift = one(rows, **there, measure="steady_drift")
    assert drift["value"] == pytest.approx(math.degrees(circle.steady_drift), rel=1e-12)
    zig = zigzag("kcs", math.radians(20.0), math.radians(5.0))
    there = {"ship": "kcs", "manoeuvre": "zig-zag 20/5", "side": "starboard"}
    first = one(rows, **there, measure="overshoot_1")
    assert first["value"] == pytest.approx(math.degrees(zig.overshoots[0]), rel=1e-12)
    assert first["limit"] is None and first["passes"] is None  # IMO has none for 20/5
    stop = one(rows, ship="kcs", manoeuvre="crash stop", sea="calm", measure="track_reach")
    assert stop["value"] == stopping("kcs").track_reach and stop["side"] == ""


@pytest.mark.parametrize("ship", ["kvlcc2", "kcs"])
def test_limits_of_imo_are_those_of_the_ship_and_of_calm_water_only(rows, ship):
    limits = imo_limits(ship, load_ship(ship).speed)
    expected = {
        ("turning circle 35 deg", "advance"): 4.5,
        ("turning circle 35 deg", "tactical_diameter"): 5.0,
        ("zig-zag 10/10", "initial_turning"): 2.5,
        ("zig-zag 10/10", "overshoot_1"): math.degrees(limits["overshoot_10_10_first"]),
        ("zig-zag 10/10", "overshoot_2"): math.degrees(limits["overshoot_10_10_second"]),
        ("crash stop", "track_reach"): 15.0,
    }
    judged = [row for row in rows if row["ship"] == ship and row["limit"] is not None]
    assert {(row["manoeuvre"], row["measure"]) for row in judged} == set(expected)
    for row in judged:
        limit = expected[row["manoeuvre"], row["measure"]]
        assert row["limit"] == pytest.approx(limit) and row["sea"] == "calm"
        assert row["passes"] == (row["value"] <= limit)
    assert len(judged) == 2 * 5 + 1


def test_in_waves_the_calm_value_stands_beside(rows):
    there = {"ship": "kcs", "manoeuvre": "zig-zag 10/10", "side": "port", "measure": "overshoot_1"}
    calm, rough = (one(rows, **there, sea=sea) for sea in ("calm", "ss5"))
    assert rough["calm"] == calm["value"] != rough["value"] and calm["calm"] is None


def test_every_trial_of_a_ship_stands_once_beside_what_was_computed(rows):
    """With its mean, its scatter and where it is printed."""
    for name in ("kvlcc2", "kcs"):
        ship = load_ship(name)
        # a model's trial in waves keeps no force at full scale, and this one had nothing else
        sources = {f"{trial.facility}: {trial.source}" for trial in ship.trials if trial.measures}
        ours = [row for row in rows if row["ship"] == name and row["trial"] is not None]
        assert {row["source"] for row in ours} == sources
    trial = one(rows, ship="kvlcc2", manoeuvre="zig-zag 10/10", side="port", sea="calm",
                measure="overshoot_2")  # fmt: skip
    assert trial["trial"] == 14.9 and trial["trial_scatter"] is None
    name = "mean of 3 facilities: 35 deg to port, Fn 0.157"
    scattered = one(rows, ship="kcs", manoeuvre=name, measure="tactical_diameter")
    deviation = next(
        t.deviation["tactical_diameter"] * t.measures["tactical_diameter"]
        for t in load_ship("kcs").trials
        if t.facility == "mean of 3 facilities" and t.delta_deg < 0.0 and "Fn 0.157" in name
    )
    assert scattered["trial_scatter"] == pytest.approx(deviation) and scattered["side"] == ""
    assert scattered["limit"] is None


def test_what_a_ship_cannot_do_is_told_and_ends_nothing():
    ship = load_ship("kcs")
    engine = dataclasses.replace(ship.engine, n_astern=0.0)
    lame = dataclasses.replace(ship, name="lame", engine=engine, wave_table="", trials=())
    asked = [Manoeuvre("stopping", seas=("calm", "ss5")), Manoeuvre("zigzag", 10.0, 10.0)]
    found = rows_of(sail_manoeuvres(asked, [lame]))
    lost = [row for row in found if row["error"]]
    assert [row["sea"] for row in lost] == ["calm", "ss5"]
    assert "cannot reverse" in lost[0]["error"] and lost[1]["error"] == NO_WAVES
    assert all(row["measure"] == "" and row["value"] is None for row in lost)
    assert len([row for row in found if row["measure"] == "overshoot_1"]) == 2


def test_the_file_gives_the_rows_back(rows, tmp_path):
    path = tmp_path / "manoeuvres.parquet"
    write_manoeuvres(path, rows, {"version": "ShipBench-1"})
    found, about = read_manoeuvres(path)
    assert found == rows and about == {"version": "ShipBench-1"}
    assert all(list(row) == list(COLUMNS) for row in found)
    write_manoeuvres(tmp_path / "again.parquet", rows, {"version": "ShipBench-1"})
    assert (tmp_path / "again.parquet").read_bytes() == path.read_bytes()


def test_other_files_are_refused(tmp_path):
    with pytest.raises(ConfigError, match="no such file; it is made by"):
        read_manoeuvres(tmp_path / "none.parquet")
    (tmp_path / "text.parquet").write_text("no")
    with pytest.raises(ConfigError, match="not a parquet file"):
        read_manoeuvres(tmp_path / "text.parquet")
