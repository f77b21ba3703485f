import numpy as np
import pytest

from ship_gym.seakeeping.hull_form import parametric_mesh
from ship_gym.seakeeping.hull_mesh import (
    HullMesh,
    capytaine_axes,
    lid,
    mesh_from_sections,
    welded,
)
from ship_gym.seakeeping.hydrostatics import closure, comparison, comparison_table, hydrostatics
from ship_gym.ships import load_ship


def barge(L=10.0, B=2.0, T=1.0, pieces=6):
    """Box with the corner of the section on a point."""
    y = np.concatenate([np.linspace(0.0, 0.5 * B, pieces), np.full(pieces - 1, 0.5 * B)])
    z = np.concatenate([np.full(pieces, T), np.linspace(T, 0.0, pieces)[1:]])
    x = np.linspace(-0.5 * L, 0.5 * L, 9)
    x, y, z = np.broadcast_arrays(x[:, None], y, z)
    return mesh_from_sections(np.stack([x, y, z], axis=-1))


def wigley(L=1.0, B=0.1, T=0.0625, stations=40, strips=20):
    """y = (B/2) (1 - (2 x/L)^2) (1 - (z/T)^2), the analytic hull of Wigley."""
    x = np.linspace(-0.5 * L, 0.5 * L, stations + 1)[:, None]
    z = np.linspace(T, 0.0, strips + 1)
    y = 0.5 * B * (1.0 - (2.0 * x / L) ** 2) * (1.0 - (z / T) ** 2)
    x, y, z = np.broadcast_arrays(x, y, z)
    return mesh_from_sections(np.stack([x, y, z], axis=-1))


def test_a_box_is_exact():
    found = hydrostatics(barge())
    exact = {"volume": 20.0, "x_B": 0.0, "KB": 0.5, "S": 44.0, "A_wp": 20.0, "x_F": 0.0}
    exact |= {"L_wl": 10.0, "B_wl": 2.0, "draught": 1.0, "BM": 1.0 / 3.0, "BM_L": 100.0 / 12.0}
    for name, value in exact.items():
        assert getattr(found, name) == pytest.approx(value, abs=1e-12), name
    assert found.KM == pytest.approx(0.5 + 1.0 / 3.0)
    assert found.heave == pytest.approx(20.0)
    assert found.roll(KG=0.6) == pytest.approx(20.0 * (0.5 + 1.0 / 3.0 - 0.6))
    assert found.pitch(KG=0.6) == pytest.approx(20.0 * (0.5 + 100.0 / 12.0 - 0.6))


def test_wigley_hull_by_its_integrals():
    # volume 4/9 L B T, waterplane 2/3 L B, KB 5/8 T, BM of y^3 with the integral of (1-u^2)^3 16/35
    found = hydrostatics(wigley())
    assert found.volume == pytest.approx(4.0 / 9.0 * 0.1 * 0.0625, rel=2e-3)
    assert found.A_wp == pytest.approx(2.0 / 3.0 * 0.1, rel=1e-3)
    assert found.KB == pytest.approx(0.625 * 0.0625, rel=2e-3)
    BM = 2.0 / 3.0 * 0.05**3 * 16.0 / 35.0 / (4.0 / 9.0 * 0.1 * 0.0625)
    assert found.BM == pytest.approx(BM, rel=2e-3)
    assert found.x_B == pytest.approx(0.0, abs=1e-12)


def test_half_and_whole_hull_agree():
    half = parametric_mesh(load_ship("kcs_model"))
    whole = half.both_sides()
    assert len(whole.panels) == 2 * len(half.panels) == half.count
    a, b = hydrostatics(half), hydrostatics(whole)
    for name in ("volume", "x_B", "KB", "S", "A_wp", "x_F", "BM", "BM_L"):
        assert getattr(a, name) == pytest.approx(getattr(b, name), rel=1e-12)


def test_moving_the_hull_moves_its_centres():
    mesh = wigley()
    moved = HullMesh(mesh.vertices + np.array([0.1, 0.0, 0.0]), mesh.panels, True)
    a, b = hydrostatics(mesh), hydrostatics(moved)
    assert b.x_B - a.x_B == pytest.approx(0.1) and b.x_F - a.x_F == pytest.approx(0.1)
    assert b.BM_L == pytest.approx(a.BM_L)  # about its own centre


def test_closure_sees_a_missing_panel():
    mesh = barge()
    assert closure(mesh) < 1e-14
    holed = welded(mesh.vertices, mesh.panels[1:], True)
    assert closure(holed) > 1e-3


def test_table_beside_the_ship_file():
    ship = load_ship("kcs")
    mesh = parametric_mesh(ship)
    values = comparison(mesh, ship)
    assert values["x_B"][1] == pytest.approx(-0.0148 * 230.0)
    assert values["KM"][1] == pytest.approx((0.19 + 0.00797) * 230.0 / 3.057)
    text = comparison_table(mesh, ship)
    for word in (f"{mesh.count} panels", "volume", "wetted surface", "roll", "heave", "% L"):
        assert word in text


def test_capytaine_computes_the_same():
    cpt = pytest.importorskip("capytaine")
    ship = load_ship("kcs_model")
    mesh = parametric_mesh(ship, 88, 16)  # the two differ in how they take a twisted panel
    found = hydrostatics(mesh)
    vertices, panels = capytaine_axes(mesh.both_sides())
    body = cpt.FloatingBody(
        mesh=cpt.Mesh(vertices, panels, auto_check=False), center_of_mass=(0.0, 0.0, 0.0)
    )
    assert body.volume == pytest.approx(found.volume, rel=2e-3)
    assert body.waterplane_area == pytest.approx(found.A_wp, rel=1e-3)
    assert body.wet_surface_area == pytest.approx(found.S, rel=2e-3)
    centre = body.center_of_buoyancy
    assert centre[0] == pytest.approx(found.x_B, abs=2e-3 * ship.hull.L)
    assert centre[2] == pytest.approx(found.KB - ship.hull.d, rel=5e-3)
    assert lid(mesh).count > 0


@pytest.mark.parametrize("name", ["kcs", "kvlcc2", "onrt"])
def test_trimesh_computes_the_same(name):
    """Volume, centre and surface, as the mean over both splits of the panels."""
    trimesh = pytest.importorskip("trimesh")
    mesh = parametric_mesh(load_ship(name))
    found, whole = hydrostatics(mesh), mesh.both_sides()
    splits = (((0, 1, 2), (0, 2, 3)), ((0, 1, 3), (1, 2, 3)))
    halves = []
    for split in splits:
        faces = np.concatenate([whole.panels[:, corners] for corners in split])
        solid = trimesh.Trimesh(whole.vertices, faces, process=False)
        # the lid at z = 0, which is missing, adds nothing to the moments about the waterline
        halves.append([solid.volume, *(solid.volume * solid.center_mass[[0, 2]]), solid.area])
    volume, x, z, S = np.mean(halves, axis=0)
    assert volume == pytest.approx(found.volume, rel=1e-12)
    assert x / volume == pytest.approx(found.x_B, abs=1e-12 * mesh.length)
    assert z / volume == pytest.approx(found.draught - found.KB, rel=1e-12)
    assert S == pytest.approx(found.S, rel=1e-12)
