"""A WAMIT mesh from the field: the tanker of MSS, hanging nodes of 1 cm, sailed in waves.

The file says Lpp 246, B 46, T 10 m; all else of the ship is KVLCC2's by those lengths, for no
particulars of it are at hand. Its volume is that of the file's own panels.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from ship_gym import Sea, ShipSim
from ship_gym.sea.state import RegularWave
from ship_gym.sea.wave_response import wave_table_of
from ship_gym.seakeeping.database import Grid, build, cell, make_problem
from ship_gym.seakeeping.drift import encounter_frequency
from ship_gym.seakeeping.hull_file import read_hull
from ship_gym.seakeeping.hull_gdf import read_gdf
from ship_gym.seakeeping.hull_mesh import boundary_edges
from ship_gym.seakeeping.hydrostatics import closure, hydrostatics
from ship_gym.seakeeping.motions import HEAVE, PITCH, Radiation
from ship_gym.seakeeping.radiation_diffraction import diffraction, radiation
from ship_gym.ships import load_ship
from ship_gym.ships.new_ship import new_ship
from ship_gym.ships.scaling import scaled
from ship_gym.ships.write_ship import ship_text

FILE = Path(__file__).resolve().parents[3] / "shared" / "reference" / "field" / "mss_tanker.gdf"
L, B, T = 246.0, 46.0, 10.0

pytestmark = [
    pytest.mark.skipif(not FILE.is_file(), reason="the MSS tanker is not here"),
    pytest.mark.filterwarnings("ignore:.*is not strict"),
]


def volume_of_file():
    """By z n_z of the file's panels as they are: what is missing between them counts nothing."""
    vertices, panels = read_gdf(FILE)
    a, b, c, d = (vertices[panels[:, i]] for i in range(4))
    halves = [(a, b, c), (a, c, d)]
    return sum(
        float(((p + q + r)[:, 2] / 3.0) @ (0.5 * np.cross(q - p, r - p)[:, 2]))
        for p, q, r in halves
    )


def tanker():
    """KVLCC2's shape of particulars at the file's lengths."""
    like = load_ship("kvlcc2")
    like = scaled(like, L)
    form = dataclasses.replace(
        like.form, x_B=3.93, x_F=-3.12, KG=0.885 * T, GM=22.52 - 0.885 * T, k_xx=0.4 * B
    )
    hull = dataclasses.replace(like.hull, B=B, d=T, volume=volume_of_file(), x_G=3.93, S=14120.0)
    return dataclasses.replace(like, name="mss_tanker", hull=hull, form=form, strict=False)


@pytest.fixture(scope="module")
def ship():
    return tanker()


@pytest.fixture(scope="module")
def own(ship):
    return read_hull(FILE, ship, panels=None)


def test_its_hanging_nodes_are_closed_and_nothing_else_changes(own, ship):
    assert "mss_tanker.gdf: 4750 faces" in own.report[0]
    assert "closed 392 open edges" in own.report[1]
    whole = own.both_sides()
    ends = whole.vertices[boundary_edges(whole)]
    assert np.abs(ends[..., 2]).max() == 0.0  # open at the waterline only
    assert closure(whole) < 1e-9
    assert hydrostatics(own).volume == pytest.approx(ship.hull.volume, rel=5e-6)
    assert hydrostatics(own).draught == 10.0 and hydrostatics(own).B_wl == 46.0
    # no vertex that was not in the file
    there = {tuple(row) for row in np.round(np.abs(read_gdf(FILE)[0]), 4).tolist()}
    assert {tuple(row) for row in np.round(np.abs(own.vertices), 4).tolist()} <= there


def test_coarsened_it_is_the_same_hull(own, ship):
    mesh = read_hull(FILE, ship, panels=704)
    fine, coarse = hydrostatics(own), hydrostatics(mesh)
    assert 690 <= mesh.count <= 750
    assert coarse.volume == pytest.approx(fine.volume, rel=0.005)
    assert coarse.A_wp == pytest.approx(fine.A_wp, rel=0.005)
    assert coarse.x_B == pytest.approx(fine.x_B, abs=0.001 * L)


def test_without_closing_it_is_judged_by_its_volume(ship):
    """What is open is 1 cm wide: with nothing closed the volumes still agree."""
    mesh = read_hull(FILE, ship, panels=None, weld=0.0)
    assert closure(mesh.both_sides()) == pytest.approx(6.3e-5, rel=0.02)


def in_head_seas(ship, mesh, ratio):
    """Closure of the energy, |heave| / A, |pitch| / (k A), surge force by A^2 at rest."""
    problem = make_problem(ship, mesh)
    k0 = 2.0 * np.pi / ratio
    steps = encounter_frequency(k0, np.pi, 0.0) * np.array([0.97, 1.0, 1.03])
    waves = Radiation(steps, np.array([radiation(problem.hull, w**2) for w in steps]))
    (flow,) = diffraction(problem.hull, k0, np.array([np.pi]))
    found = cell(problem, flow, None, waves, k0, np.pi, 0.0)
    return found[4].real, abs(found[5 + HEAVE]), abs(found[5 + PITCH]) / k0, found[0].real


def test_waves_are_solved_with_it(ship):
    """Few panels, long waves: she rides on them, and no energy is lost."""
    pytest.importorskip("capytaine")
    mesh = read_hull(FILE, ship, panels=200)
    assert abs(in_head_seas(ship, mesh, 1.0)[0]) < 0.03  # energy taken from the waves and given
    _, heave, pitch, _ = in_head_seas(ship, mesh, 8.0)
    assert heave == pytest.approx(1.0, abs=0.12) and pitch == pytest.approx(1.0, abs=0.12)


@pytest.mark.slow
def test_its_own_panels_and_the_coarse_ones_agree_in_waves(own, ship):
    pytest.importorskip("capytaine")
    coarse = in_head_seas(ship, read_hull(FILE, ship, panels=704), 1.0)
    fine = in_head_seas(ship, own, 1.0)
    print(coarse, fine)
    assert abs(fine[0]) < 0.02 and abs(coarse[0]) < 0.02
    np.testing.assert_allclose(coarse[1:], fine[1:], rtol=0.05, atol=0.005)


def test_a_new_ship_of_its_particulars_sails_in_waves_without_a_form(tmp_path):
    """As a user would: particulars, the file, a (tiny) table beside the ship file, a sea."""
    pytest.importorskip("capytaine")
    pytest.importorskip("joblib")
    given = {"L": L, "B": B, "d": T, "volume": volume_of_file(), "speed": 7.7, "x_G": 3.93}
    made = dataclasses.replace(new_ship("kvlcc2", "mss", given), form=None)
    file = tmp_path / "mss" / "ship.toml"
    file.parent.mkdir()
    file.write_text(ship_text(made, "given"), "utf-8")
    ship = load_ship(file)
    assert ship.form is None and not ship.wave_table
    mesh = read_hull(FILE, ship, panels=120)
    grid = Grid((0.0, 0.15), 3, 2, longest=2.0, shortest=0.5, encounter=3)
    table = build(ship, mesh, file.with_name("waves_mss.npz"), grid)
    assert table.card["body"]["GM"] * L == pytest.approx(22.52 - T, rel=0.02)  # KM of the file
    assert "no [form]" in table.card["mesh"][-1]
    sailing = load_ship(file)
    assert wave_table_of(sailing).card["made_for"]["volume"] == pytest.approx(ship.hull.volume)
    sim = ShipSim(sailing, n=1, sea=Sea(regular=RegularWave(1.0, 0.7)))
    sim.reset(0, speed=ship.speed)
    sim.step(np.array([[0.0, 1.0]]), 1.0)
    assert np.isfinite(sim.state).all()
