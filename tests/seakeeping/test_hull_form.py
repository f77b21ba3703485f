import dataclasses
import itertools
import math

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.seakeeping.bulb import Bulb, ship_bulb
from ship_gym.seakeeping.hull_checks import check_mesh
from ship_gym.seakeeping.hull_form import (
    area_curve,
    breadth_curve,
    hull_lines,
    parametric_mesh,
    section_coefficient,
    section_exponent,
    section_outline,
    transom_draught,
)
from ship_gym.seakeeping.hydrostatics import closure, hydrostatics
from ship_gym.ships import available_ships, load_ship

WITH_FORM = [name for name in available_ships() if load_ship(name).form is not None]


def changed(ship, **changes):
    return dataclasses.replace(ship, form=dataclasses.replace(ship.form, **changes))


def test_section_coefficient_of_known_shapes():
    # ellipse, triangle; n = 1/2: Gamma(3)^2 / Gamma(5) = 4 / 24
    np.testing.assert_allclose(
        section_coefficient([2.0, 1.0, 0.5]), [math.pi / 4, 0.5, 1.0 / 6.0], rtol=1e-12
    )


def test_section_exponent_is_the_inverse():
    c = np.linspace(0.02, 0.999, 50)
    np.testing.assert_allclose(section_coefficient(section_exponent(c)), c, atol=1e-5)


@pytest.mark.parametrize("n", [0.5, 1.0, 2.0, 9.0])
def test_section_outline_lies_on_the_section_and_holds_its_area(n):
    points = section_outline(3.0, 2.0, n)
    assert points[0].tolist() == [0.0, 2.0] and points[-1].tolist() == [3.0, 0.0]
    np.testing.assert_allclose(
        (points[:, 0] / 3.0) ** n + (points[:, 1] / 2.0) ** n, 1.0, atol=1e-9
    )
    y, z = points.T
    area = -np.sum(0.5 * (y[1:] + y[:-1]) * np.diff(z))
    assert area == pytest.approx(6.0 * section_coefficient(n), rel=1e-3)


@pytest.mark.parametrize("name", WITH_FORM)
def test_the_drawn_hull_of_every_ship(name):
    """Waves.md: volume -0.3 to -0.6 %, centre of buoyancy within 0.1 % L. ONRT has -0.68 %."""
    ship = load_ship(name)
    mesh = parametric_mesh(ship)
    found = hydrostatics(mesh)
    assert mesh.symmetric and 656 <= mesh.count <= 1220
    assert -0.007 < found.volume / ship.hull.volume - 1.0 < -0.002  # chords lie inside the hull
    assert abs(found.x_B - ship.form.x_B) < 0.001 * ship.hull.L
    assert abs(found.x_F - ship.form.x_F) < 0.001 * ship.hull.L
    assert found.A_wp == pytest.approx(ship.form.C_wp * ship.hull.L * ship.hull.B, rel=0.002)
    assert found.draught == pytest.approx(ship.hull.d)
    assert found.L_wl == pytest.approx(ship.hull.L + ship.form.l_bulb)
    assert closure(mesh) < 1e-12
    assert mesh.areas.min() > 1e-5 * mesh.areas.mean()
    check_mesh(mesh, ship, name)


def test_published_numbers_of_kcs():
    """9,424 m2 and 0.6 m + 14.3 m are published (SIMMAN 2020, Knight 2021)."""
    found = hydrostatics(parametric_mesh(load_ship("kcs")))
    assert found.S == pytest.approx(9424.0, rel=0.01)  # 9,353
    assert found.KM == pytest.approx(14.9, rel=0.01)


def test_finer_panels_converge_to_the_volume():
    ship = load_ship("kcs_model")
    errors = [
        1.0 - hydrostatics(parametric_mesh(ship, s, g)).volume / ship.hull.volume
        for s, g in ((22, 4), (44, 8), (88, 16), (176, 32))
    ]
    assert errors[3] < 0.0006
    assert all(b < 0.45 * a for a, b in itertools.pairwise(errors))


def test_the_curves_of_dtc_are_those_measured_on_its_published_geometry():
    """Breadth of the waterline and sectional area by B and B d; the [form] was fitted to them."""
    ship = load_ship("dtc")
    bulb = ship_bulb(ship)
    x = np.array([-0.484, -0.442, -0.40, -0.30, -0.18, 0.0, 0.14, 0.22, 0.30, 0.38, 0.4411, 0.4821])
    breadth = [0.526, 0.844, 0.944, 1.0, 1.0, 1.0, 1.0, 0.969, 0.802, 0.507, 0.235, 0.064]
    area = [0.017, 0.159, 0.341, 0.699, 0.935, 0.987, 0.935, 0.794, 0.558, 0.303, 0.158, 0.103]
    np.testing.assert_allclose(breadth_curve(ship)(x), breadth, atol=0.04)
    np.testing.assert_allclose(ship.form.C_m * area_curve(ship, bulb)(x), area, atol=0.025)
    ahead = np.array([0.5095, 0.5163, 0.5232])
    drawn = bulb.area * bulb.size(ahead * ship.hull.L) / (ship.hull.B * ship.hull.d)
    np.testing.assert_allclose(drawn, [0.0796, 0.0664, 0.0433], atol=0.004)


@pytest.mark.parametrize("name", ["dtc", "kvlcc2"])
def test_the_bulb_is_part_of_the_volume_and_closed(name):
    ship = load_ship(name)
    bulb, mesh = ship_bulb(ship), parametric_mesh(ship, 180, 40)
    ahead = mesh.vertices[:, 0] > bulb.x
    assert mesh.vertices[ahead, 0].max() == pytest.approx(bulb.x + bulb.length)
    assert mesh.vertices[ahead, 1].max() <= bulb.half_breadth
    found = hydrostatics(mesh)
    assert found.volume == pytest.approx(ship.hull.volume, rel=1.5e-3)
    assert found.x_B == pytest.approx(ship.form.x_B, abs=4e-4 * ship.hull.L)
    assert closure(mesh) < 1e-12


def test_volume_and_centre_of_half_an_ellipsoid():
    bulb = Bulb(x=10.0, length=2.0, half_breadth=0.5, half_height=0.8, z=3.0, z_nose=2.0)
    x = 10.0 + 2.0 * (np.arange(20000) + 0.5) / 20000
    area = bulb.area * bulb.size(x)
    assert bulb.volume == pytest.approx(2.0 * area.mean(), rel=1e-6)
    assert bulb.centre == pytest.approx((area @ x) / area.sum(), rel=1e-6)
    assert bulb.size(10.0 - 3.0 * 2.0) == 0.0
    z = np.linspace(0.0, 5.0, 20001)
    assert 2.0 * 5.0 * bulb.half_breadths(10.0, z).mean() == pytest.approx(bulb.area, rel=1e-3)
    assert bulb.outline(11.0)[[0, -1], 0].tolist() == [0.0, 0.0]
    assert bulb.outline(12.0)[:, 1] == pytest.approx(2.0)


def test_a_ship_without_bulb_ends_at_the_perpendicular():
    ship = changed(load_ship("dtc"), l_bulb=0.0, a_bulb=0.0, b_bulb=0.0)
    assert ship_bulb(ship) is None
    mesh = parametric_mesh(ship)
    assert mesh.vertices[:, 0].max() == pytest.approx(0.5 * ship.hull.L)
    check_mesh(mesh, ship)


def test_the_transom_has_its_area():
    ship = load_ship("onrt_model")
    lines = hull_lines(ship)
    f = ship.form
    end = transom_draught(f.a_transom, f.b_transom, f.C_m)
    assert lines.draught[0] == pytest.approx(end * ship.hull.d)
    assert lines.half_breadth[0] == pytest.approx(0.5 * f.b_transom * ship.hull.B)
    assert section_coefficient(lines.exponent[0]) == pytest.approx(2.0 / 3.0, abs=1e-4)


def test_a_pointed_stern_needs_no_transom():
    ship = changed(load_ship("kcs"), b_transom=0.0, a_transom=0.0, x_F=-6.0)
    check_mesh(parametric_mesh(ship), ship)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"C_wp": 0.40}, r"C_wp = 0\.4000: allowed is 0\.\d+ to 0\.9"),
        ({"C_wp": 0.99}, r"C_wp = 0\.9900: allowed is"),
        ({"x_F": 20.0}, r"x_F / L = 0\.0870: allowed is -0\.\d+ to 0\.0"),
        ({"C_m": 0.5}, r"C_b / C_m = 1\.\d+: allowed is"),
        ({"C_m": 0.70}, r"sectional area is \d\.\d+ of breadth times draught.*raise C_wp"),
        ({"z_bulb": 0.2}, r"z_bulb = 0\.2: the bulb is 0\.\d+ d high.*allowed is 0\.\d+ to 0\.\d+"),
    ],
)
def test_a_form_that_does_not_exist_says_which_number(changes, message):
    with pytest.raises(ConfigError, match=message):
        parametric_mesh(changed(load_ship("kcs"), **changes))


def test_a_ship_without_form_is_refused():
    with pytest.raises(ConfigError, match=r"kcs: no section \[form\]"):
        hull_lines(dataclasses.replace(load_ship("kcs"), form=None))
