"""The table of all trials: names, values of another time, counts, page."""

from __future__ import annotations

import dataclasses
import math

import pytest

from ship_gym.config import ConfigError
from ship_gym.reports import trials as report
from ship_gym.reports.case import sail_trial
from ship_gym.reports.measures import Row
from ship_gym.ships.files import available_ships
from ship_gym.ships.loader import load_ship


@pytest.fixture(scope="module")
def onrt():
    ship = load_ship("onrt_model")
    return sail_trial(ship, ship.trials[0])


def made(name="advance", computed=3.0, measured=2.0, deviation=None, before=None):
    row = Row(name, computed, measured, deviation=deviation)
    old = None if before is None else dataclasses.replace(row, computed=before)
    return report.Comparison("ship", "trial", row, old)


def test_ships_with_trials_of_their_own():
    found = report.tested_ships()
    assert found == ["kcs_model", "kvlcc2_model", "onrt_model"]
    assert set(found) < set(available_ships())


def test_every_trial_has_another_name():
    for ship in map(load_ship, report.tested_ships()):
        names = [report.trial_name(ship, trial) for trial in ship.trials]
        assert len(set(names)) == len(names)
        assert all("trial:" not in name for name in names)  # each names its facility


def test_name_says_what_was_sailed(onrt):
    name = report.trial_name(onrt.ship, onrt.trial)
    assert name == (
        "SIMMAN 2020: 35 deg to port, Fn 0.200, 9.0 rev/s, waves 0.063 m high, 1 L long, from 0 deg"
    )
    ship = load_ship("kvlcc2_model")
    assert report.trial_name(ship, ship.trials[-1]) == (
        "MARIN: 20/20 zig-zag, port first, Fn 0.142"
    )


def test_values_of_another_time_come_back(onrt, tmp_path):
    now = report.comparisons(onrt)
    assert [c.row.name for c in now] == ["tactical_diameter", "drift_distance", "drift_direction"]
    assert all(c.before is None for c in now)
    report.write_values(now, tmp_path / "v.csv", "an hour ago")
    values, title = report.read_values(tmp_path / "v.csv")
    assert title == "an hour ago"
    again = report.comparisons(onrt, values)
    for each in again:
        assert each.before.computed == pytest.approx(each.row.computed, rel=1e-8)
        assert each.closer is None
    moved = {key: 1.1 * value for key, value in values.items()}
    assert report.comparisons(onrt, moved)[0].before.difference == pytest.approx(
        100.0 * (1.1 * onrt.result.tactical_diameter / 3.00 - 1.0)
    )


def test_file_without_the_columns_is_refused(tmp_path):
    path = tmp_path / "v.csv"
    head = "".join(f"# {k}: x\n" for k in ("title", "source", "obtained", "conventions"))
    path.write_text(head + "ship,trial,measure,value [m]\na,b,c,1\n")
    with pytest.raises(ConfigError, match="computed"):
        report.read_values(path)


@pytest.mark.parametrize(
    ("computed", "before", "closer"),
    [(2.1, 2.2, True), (1.9, 1.8, True), (2.2, 2.1, False), (1.9, 2.1, None), (2.1, None, None)],
)
def test_closer_than_before(computed, before, closer):
    assert made(computed=computed, before=before).closer is closer


def test_direction_is_closer_by_its_angle():
    assert made("drift_direction", 100.0, 93.0, before=-100.0).closer is True


def test_counts():
    found = [
        made(computed=2.2, before=2.4, deviation=0.11),
        made(computed=1.8, before=1.9, deviation=0.3),
        made("drift_direction", 100.0, 90.0),
    ]
    counts = report.summary(found)
    assert counts["values"] == 3
    assert counts["mean_difference_percent"] == pytest.approx(10.0)
    assert counts["mean_before_percent"] == pytest.approx(12.5)
    assert (counts["closer"], counts["further"]) == (1, 1)
    assert (counts["with_deviation"], counts["within_1_deviation"]) == (2, 1)
    assert counts["within_2_deviations"] == 2
    assert "mean_before_percent" not in report.summary([made()])
    assert "2 with scatter" in report.summary_text(found)


def test_page_and_text(onrt):
    values = {c.key: 0.5 * c.row.computed for c in report.comparisons(onrt)}
    found = report.comparisons(onrt, values)
    name = found[0].trial
    page = report.page(found, {name: "a source", "x": "a source"}, "yesterday", "t.png")
    assert "![all trials](t.png)" in page and f"- {name}; x: a source" in page
    assert f"| {name} | tactical diameter | L | 3.00 |" in page
    assert f"{0.5 * onrt.result.tactical_diameter:.2f}" in page and "(yesterday)" in page
    text = report.as_text(report.comparisons(onrt))
    assert "difference before" not in text and "in SD" in text
    data = report.as_dict(found)
    assert [math.isfinite(row["computed"]) for row in data["trials"]] == [True] * 3
    assert data["trials"][2]["difference_deg"] == found[2].row.difference
    assert data["trials"][1]["others"]["CFD, G1/2 SA"] == 0.260
