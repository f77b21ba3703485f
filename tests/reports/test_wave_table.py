"""The report on a wave table: its tables say what the table holds."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.conventions import G
from ship_gym.provenance import sha256
from ship_gym.reports.page import Picture, plain_text
from ship_gym.reports.wave_table import (
    PICTURES,
    chosen,
    largest_froude,
    largest_rms,
    provenance,
    sections,
)
from ship_gym.sea.wave_table import BOUNDS, UNCERTAINTY, WaveTable
from ship_gym.seakeeping.database import Grid
from ship_gym.seakeeping.hull_form import parametric_mesh
from ship_gym.seakeeping.table_checks import compare_with_snnm
from ship_gym.ships.files import DATA
from ship_gym.ships.loader import load_ship
from ship_gym.simulation import self_propulsion

FILE = DATA / "kcs_model" / "waves.npz"
TABLE = WaveTable.load(FILE)
SHIP = load_ship("kcs_model")


@pytest.fixture(scope="module")
def text():
    return plain_text(sections(TABLE, SHIP, parametric_mesh(SHIP), {}))


def row(text, start):
    return next(line.split() for line in text.splitlines() if line.strip().startswith(start))


def test_the_engine_holds_the_largest_speed_and_none_above_it():
    ship = load_ship("kvlcc2_model")
    found = largest_froude(ship)
    speed = math.sqrt(G * ship.hull.L)
    assert self_propulsion(ship, found * speed) <= ship.engine.n_max
    with pytest.raises(ConfigError, match="cannot hold"):
        self_propulsion(ship, (found + 0.001) * speed)


@pytest.mark.parametrize("name, last", [("kvlcc2_model", 0.20), ("dtc_model", 0.26), ("s175", 0.3)])
def test_the_grid_ends_where_the_ship_does(name, last):
    assert Grid().up_to(largest_froude(load_ship(name))).froude[-1] == last


def test_speeds_of_a_grid_end_at_the_first_at_or_above_a_speed():
    grid = Grid((0.0, 0.1, 0.2, 0.3), 7)
    for largest, last in ((0.0, 0.1), (0.05, 0.1), (0.1, 0.1), (0.101, 0.2), (0.3, 0.3)):
        assert grid.up_to(largest).froude[-1] == last
    assert grid.up_to(0.5) == grid
    assert grid.up_to(0.1) == dataclasses.replace(grid, froude=(0.0, 0.1))


def test_nearest_points_come_once_and_in_the_order_wanted():
    assert chosen(np.array([0.0, 90.0, 180.0]), (180.0, 150.0, 90.0, 20.0, 0.0)) == [2, 1, 0]


def test_surge_table_is_the_comparison_with_snnm(text):
    found = compare_with_snnm(TABLE)
    rms = text[text.index("rms difference") : text.index("largest -CX")]
    head = [f"{found['rms'][f'{U:.2f}'][-1]:.2f}" for U in TABLE.froude]
    assert row(rms, "180") == ["180", *head]
    assert len([line for line in rms.splitlines() if line.strip()[:1].isdigit()]) == 7
    peaks = text[text.index("largest -CX") :]
    ours, snnm = found["peak"]["0.26"][-1], found["peak_snnm"]["0.26"][-1]
    assert f"{ours:.2f} ({snnm:.2f})" in peaks


def test_hydrostatics_stand_beside_the_ship_file(text):
    assert f"{SHIP.hull.volume:.5g}" in text
    assert row(text, "KM")[-1] == "%"
    assert "parametric hull of kcs_model: 44 x 8 panels per side" in text


def test_classes_and_their_shares(text):
    for meaning in UNCERTAINTY.values():
        assert meaning in text
    at_rest = next(line for line in text.splitlines() if UNCERTAINTY[0] in line)
    assert at_rest.split()[-2] == f"{100.0 / len(TABLE.froude):.0f}"


def test_classes_stand_beside_what_this_table_reaches(text):
    rms = compare_with_snnm(TABLE)["rms"]
    head = max(max(rms[f"{U:.2f}"][-3:]) for U in TABLE.froude[1:])
    oblique = max(max(rms[f"{U:.2f}"][6:10]) for U in TABLE.froude[1:])
    found = largest_rms(TABLE)
    assert (found[1][0], found[2][0]) == (head, oblique)
    value, U, mu = found[1]
    assert rms[f"{U:.2f}"][round(mu / 15.0)] == value
    assert f"{value:.2f} at Fn {U:g}, {mu:.0f} deg" in text


def test_a_push_ahead_has_no_place_and_no_negative_zero(text):
    peaks = text[text.index("largest -CX") :]
    assert "-0.00" not in peaks
    assert row(peaks[peaks.index("wavelength / L of it") :], "0 ")[1:3] == ["-", "(-)"]


def test_a_cell_out_of_bounds_is_named():
    high = dict(TABLE.card["checks"]["largest"], CY=2.0)
    checks = {**TABLE.card["checks"], "largest": high, "within_bounds": False}
    table = dataclasses.replace(TABLE, card={**TABLE.card, "checks": checks})
    text = plain_text(sections(table, SHIP, None, {}))
    assert f"BEYOND the bound {BOUNDS['CY']:g}" in text
    assert text.count("within the bound") == 2


def test_without_panels_the_page_says_so():
    text = plain_text(sections(TABLE, SHIP, None, {}))
    assert "not at hand" in text and "wetted surface" not in text


def test_a_ship_faster_than_its_table_is_told():
    slow = dataclasses.replace(
        TABLE,
        froude=TABLE.froude[:3],
        **{
            name: getattr(TABLE, name)[:3]
            for name in ("CX_bem", "CX_snnm", "CY", "CN", "motions", "uncertainty")
        },
    )
    assert "beyond the table" in plain_text(sections(slow, SHIP, None, {}))


def test_pictures_stand_in_their_sections():
    pictures = {name: [Picture(name, b"\x89PNG")] for name in PICTURES}
    blocks = [b for s in sections(TABLE, SHIP, None, pictures) for b in s.blocks]
    assert [b.caption for b in blocks if isinstance(b, Picture)] == list(PICTURES)


def test_provenance_names_file_commit_versions_and_constants():
    text = plain_text([provenance(TABLE, FILE)])
    assert sha256(FILE) in text and TABLE.card["git_commit"] in text
    for name in ("capytaine", "numpy", *TABLE.card["calibration"]):
        assert name in text
    assert "no independent check" in text
