"""Rudder forces by formula: what Stern et al. (2021) print, computed again, and how near it is."""

from __future__ import annotations

import json
import math

import pytest

from reproduce import rudder_formulas as report
from ship_gym.manoeuvres import turning_circle
from ship_gym.ships.loader import load_ship
from ship_gym.simulation import self_propulsion

# printed in Stern et al. (2021) Table 1: facility, side, Fn -> measured, Beaufoy, MMG [N]
TABLE_1 = {
    ("HU", "port", 0.157): (2.589, 2.599, 2.6),
    ("HU", "starboard", 0.157): (2.922, 2.599, 2.9),
    ("MARIN", "port", 0.26): (40.0, 55.817, 52.34),
    ("IIHR", "starboard", 0.157): (1.328, 1.799, 1.496),
    ("IIHR", "port", 0.157): (1.502, None, None),
    ("IIHR", "port", 0.26): (4.188, 4.934, 4.507),
}


@pytest.fixture(scope="module")
def data():
    return report.as_dict()


@pytest.fixture(scope="module")
def rows(data):
    return {tuple(r["printed"][k] for k in ("facility", "side", "Fn")): r for r in data["rows"]}


def test_the_file_holds_what_is_printed(rows):
    names = ("F_N measured", "F_N Beaufoy", "F_N MMG")
    assert {k: tuple(r["printed"][n] for n in names) for k, r in rows.items()} == TABLE_1
    ratios = [r["printed"]["U"] / r["printed"]["U0"] for r in rows.values()]  # printed, too
    assert ratios == pytest.approx([0.444, 0.477, 0.394, 0.542, 0.488, 0.492], abs=6e-4)


def test_printed_beaufoy_is_at_the_approach_speed(rows):
    for key, (_, printed, _) in TABLE_1.items():
        found = rows[key]["beaufoy"]
        if printed is None:
            assert found["difference_percent"] is None
            continue
        assert found["computed"] == pytest.approx(printed, rel=0.01), key
        assert found["at_steady_speed"] < 0.3 * printed


def test_printed_mmg_is_met_within_a_tenth_at_constant_revolutions(rows):
    """Drift (but for one turn) and the other rudder coefficients are ours, so a gap is open.

    HU, whose hull set this is, within 3 %; the others 8 to 11 % below, one beyond the tenth.
    """
    gaps = {("IIHR", "starboard", 0.157): -0.111}
    for key, (_, _, printed) in TABLE_1.items():
        if printed is not None:
            off = rows[key]["mmg"]["computed"] / printed - 1.0
            if key in gaps:
                assert off == pytest.approx(gaps[key], abs=0.005), key
            else:
                assert abs(off) < (0.03 if key[0] == "HU" else 0.10), key


def test_formulas_are_near_the_force_of_the_facility_they_were_tuned_to(rows):
    """Text beside Table 1: MMG and HU's data; MARIN's and the CFD's forces are not met so well.

    Theirs: 1 % at HU, 7 to 31 % elsewhere. Ours with their l_R and gamma_R: MARIN is far off, too.
    """
    theirs, ours = {}, {}
    for key, (measured, _, printed) in TABLE_1.items():
        if printed is not None:
            theirs[key] = abs(printed / measured - 1.0)
            ours[key] = abs(rows[key]["mmg"]["computed"] / measured - 1.0)
    at_home = [k for k in theirs if k[0] == "HU"]
    assert max(theirs[k] for k in at_home) < 0.01
    assert min(theirs[k] for k in theirs if k not in at_home) > 0.07
    assert ours["MARIN", "port", 0.26] > max(ours[k] for k in at_home)


def test_printed_J_B_is_of_self_propulsion_at_HU_only(rows):
    for (facility, _, _), row in rows.items():
        if facility == "MARIN":
            assert "n_of_J_B" not in row["inputs"]  # Table 6 has no MARIN
            continue
        ratio = row["inputs"]["n_of_J_B"] / row["inputs"]["n"]
        assert (ratio < 1.03) == (facility == "HU")
        assert (row["mmg"]["at_printed_J_B"] > 1.35 * row["mmg"]["computed"]) == (ratio > 1.1)


def test_propeller_speed_is_that_of_the_printed_approach(rows):
    """J about 0.8 at self-propulsion: our n is the printed one within its digit."""
    for row in rows.values():
        i = row["inputs"]
        assert i["n"] == pytest.approx(i["n_of_J_approach"], rel=0.05)


def test_steady_turn_is_that_of_the_turning_circle():
    ship = load_ship("kcs_model", surrogate="none")
    delta, n = math.radians(35.0), self_propulsion(ship, ship.speed)
    beta, speed = report.steady_turn(ship, delta, ship.speed, n)
    circle = turning_circle(ship, delta)
    assert beta == pytest.approx(circle.steady_drift, rel=1e-3)
    assert speed / ship.speed == pytest.approx(circle.steady_speed_ratio, rel=1e-3)
    # at its own steady speed and yaw rate the force is that of the turn, movable part
    row = {"U": speed, "L": ship.hull.L}
    turn = {"delta": delta, "beta": beta, "yaw_rate": circle.steady_yaw_rate}
    force, J = report.normal_force(ship, row, turn, n)
    assert force == pytest.approx(5.0 / 6.0 * circle.rudder_normal_force, rel=2e-3)
    assert J == pytest.approx(circle.steady_J, rel=1e-3)


def test_report_is_plain_data_and_text(data):
    assert json.loads(json.dumps(data)) == data
    text = report.as_text(data)
    assert "IIHR Fn 0.157 port" in text
    assert "Stern" in text
    assert max(len(line) for line in text.split("\n")) <= 100
