"""A ship file without a form: entrance, metacentre and centres are those of the mesh."""

import dataclasses

import numpy as np
import pytest

from ship_gym.seakeeping.database import QUICK, make_problem
from ship_gym.seakeeping.hull_form import parametric_mesh
from ship_gym.seakeeping.hull_mesh import mesh_from_sections
from ship_gym.seakeeping.mesh_form import ASSUMED, form_of_mesh, with_form
from ship_gym.seakeeping.snnm import added_resistance, snnm_hull
from ship_gym.ships.loader import load_ship
from ship_gym.ships.new_ship import new_ship
from ship_gym.ships.plausible import checked


def test_a_box():
    """KM of a box is d / 2 + B^2 / (12 d)."""
    barge = new_ship("kvlcc2", "barge", {"L": 80, "B": 16, "d": 3, "C_b": 1, "speed": 4, "x_G": 0})
    barge = dataclasses.replace(barge, form=None)
    x = np.linspace(-40.0, 40.0, 9)
    section = [[0.0, 3.0], [4.0, 3.0], [8.0, 3.0], [8.0, 1.5], [8.0, 0.0]]
    sections = np.zeros((9, 5, 3))
    sections[..., 0], sections[..., 1:] = x[:, None], np.array(section)
    ship, mesh = with_form(barge, mesh_from_sections(sections))
    assert mesh.report[-1] == ASSUMED and ship.form == form_of_mesh(mesh, barge)
    assert ship.form.KG == 3.0 and ship.form.L_E == ship.form.L_R == 0.05 * 80.0
    assert ship.form.GM == pytest.approx(1.5 + 16.0**2 / 36.0 - 3.0)
    assert ship.form.x_B == pytest.approx(0.0, abs=1e-9) and ship.form.C_wp == pytest.approx(1.0)
    assert checked(ship).form is ship.form


def test_a_ship_beside_her_own_form():
    kvlcc2 = load_ship("kvlcc2_model")
    mesh = parametric_mesh(kvlcc2)
    found = form_of_mesh(mesh, kvlcc2)
    assert with_form(kvlcc2, mesh) == (kvlcc2, mesh)
    bare = dataclasses.replace(kvlcc2, form=None)
    ship, mesh = with_form(bare, mesh)
    assert make_problem(ship, mesh, QUICK).body.GM == pytest.approx(found.GM / 7.0)
    assert found.x_B == pytest.approx(kvlcc2.form.x_B, abs=0.01 * 7.0)
    assert found.C_wp == pytest.approx(kvlcc2.form.C_wp, rel=0.02)
    assert found.KG + found.GM == pytest.approx(kvlcc2.form.KG + kvlcc2.form.GM, rel=0.02)
    assert found.KG == kvlcc2.hull.d  # where the metacentre lets it
    there, here = (added_resistance(snnm_hull(s), 0.14, 7.0, np.pi) for s in (kvlcc2, ship))
    assert here == pytest.approx(there, rel=0.3)
