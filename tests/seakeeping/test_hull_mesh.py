import dataclasses
import gzip
from pathlib import Path

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.plotting.hull import hull_picture
from ship_gym.seakeeping.hull_file import cut, read_hull
from ship_gym.seakeeping.hull_form import parametric_mesh
from ship_gym.seakeeping.hull_gdf import read_gdf
from ship_gym.seakeeping.hull_mesh import (
    HullMesh,
    capytaine_axes,
    divided,
    lid,
    starboard_half,
    waterline,
    welded,
)
from ship_gym.seakeeping.hydrostatics import closure, hydrostatics
from ship_gym.ships import load_ship

DTC = Path(__file__).resolve().parents[3] / "shared" / "reference" / "dtc_hull.stl.gz"
SHIP = load_ship("kcs")
HALF = parametric_mesh(SHIP)
WHOLE = HALF.both_sides()


def write_stl(path, vertices, panels):
    """ASCII STL of triangles and quadrilaterals."""
    triangles = np.concatenate([panels[:, :3], panels[:, [0, 2, 3]]])
    triangles = triangles[triangles[:, 1] != triangles[:, 2]]
    lines = ["solid hull"]
    for corners in vertices[triangles]:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += [f"vertex {x:.9g} {y:.9g} {z:.9g}" for x, y, z in corners]
        lines += ["endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid"]) + "\n")
    return path


def write_obj(path, vertices, panels):
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in vertices]
    lines += ["f " + " ".join(str(i + 1) for i in dict.fromkeys(row)) for row in panels.tolist()]
    path.write_text("\n".join(lines) + "\n")
    return path


def write_gdf(path, vertices, panels, ISY=0):
    lines = ["hull", "1.0 9.80665", f"0 {ISY}", str(len(panels))]
    lines += [" ".join(f"{x:.9g}" for x in corner) for corner in vertices[panels].reshape(-1, 3)]
    path.write_text("\n".join(lines) + "\n")
    return path


def same_hull(mesh, rel=1e-6):
    a, b = hydrostatics(mesh), hydrostatics(HALF)
    for name in ("volume", "KB", "S", "A_wp", "BM"):
        assert getattr(a, name) == pytest.approx(getattr(b, name), rel=rel), name
    for name in ("x_B", "x_F"):
        assert getattr(a, name) == pytest.approx(getattr(b, name), abs=0.2 * rel * SHIP.hull.L)


# --- the container ----------------------------------------------------------------------------


def test_normals_point_into_the_water():
    centres = HALF.vertices[HALF.panels].mean(axis=1)
    inside = np.stack([centres[:, 0] * 0.97, np.zeros(len(centres)), 0.45 * centres[:, 2]], axis=1)
    outward = np.einsum("ij,ij->i", HALF.area_vectors, centres - inside)
    assert (outward > 0.0).mean() > 0.99
    assert HALF.areas.min() > 1e-7 * HALF.areas.sum()
    assert (HALF.vertices[:, 1] >= 0.0).all() and (HALF.vertices[:, 2] >= 0.0).all()


def test_capytaine_axes_are_half_a_turn_about_x():
    vertices, panels = capytaine_axes(HALF)
    assert (vertices[:, 2] <= 0.0).all() and (vertices[:, 1] <= 0.0).all()
    np.testing.assert_array_equal(vertices[:, 0], HALF.vertices[:, 0])
    again = HullMesh(vertices, panels, True)  # a turn keeps the windings: volume stays positive
    n_z = again.area_vectors[:, 2]
    assert (again.vertices[panels].mean(axis=1)[:, 2] @ n_z) > 0.0
    assert not np.signbit(vertices[vertices == 0.0]).any()


def test_the_port_half_is_the_mirror_image():
    mirrored = np.sort(WHOLE.vertices * np.array([1.0, -1.0, 1.0]), axis=0)
    np.testing.assert_allclose(mirrored, np.sort(WHOLE.vertices, axis=0), atol=1e-9)
    assert WHOLE.area_vectors[:, 1].sum() == pytest.approx(0.0, abs=1e-9 * HALF.areas.sum())
    again = starboard_half(WHOLE)
    assert again.symmetric and len(again.panels) == len(HALF.panels)
    same_hull(again, rel=1e-12)


def test_welding_merges_points_and_drops_collapsed_panels():
    points = np.array([[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1], [1 + 1e-9, 1, 1]], dtype=float)
    mesh = welded(points, np.array([[0, 1, 2, 3], [0, 1, 2, 4], [0, 2, 4, 3], [2, 4, 2, 4]]), True)
    assert len(mesh.vertices) == 4
    corners = [sorted(set(row)) for row in mesh.panels.tolist()]
    assert [len(c) for c in corners] == [4, 3, 3]
    assert (mesh.panels[1:, 2] == mesh.panels[1:, 3]).all()  # a triangle repeats its last vertex
    np.testing.assert_allclose(mesh.areas, [1.0, 0.5, 0.5])


def test_lid_lies_at_zero_fills_the_waterplane_and_looks_down():
    cover = lid(HALF)
    assert (cover.vertices[:, 2] == 0.0).all() and cover.symmetric
    assert (cover.area_vectors[:, 2] > 0.0).all()  # z down: into the hull
    assert 2.0 * cover.areas.sum() == pytest.approx(hydrostatics(HALF).A_wp, rel=1e-9)
    assert lid(WHOLE).areas.sum() == pytest.approx(2.0 * cover.areas.sum(), rel=1e-9)
    line = waterline(HALF)
    assert line[0, 1] == pytest.approx(0.5 * SHIP.form.b_transom * SHIP.hull.B, rel=1e-6)
    assert line[-1].tolist() == pytest.approx([0.5 * SHIP.hull.L, 0.0], abs=1e-3)


def test_divided_keeps_ends_and_gives_a_tight_corner_points():
    corner = np.array([[0.0, 1.0], [2.0, 1.0], [2.0, 0.0]])
    points = divided(np.repeat(corner, 1, axis=0), 8)
    assert points[0].tolist() == [0.0, 1.0] and points[-1].tolist() == [2.0, 0.0]
    assert len(points) == 9


def test_a_mesh_without_panels_or_with_nan_is_refused():
    with pytest.raises(ConfigError, match="no panel below the waterline"):
        HullMesh(np.zeros((0, 3)), np.zeros((0, 4), dtype=int), True)
    with pytest.raises(ConfigError, match="not finite"):
        HullMesh(np.full((3, 3), np.nan), np.array([[0, 1, 2, 2]]), True)


# --- a user's file ----------------------------------------------------------------------------


def test_cut_at_the_waterline_is_exact():
    """A box from z = -1 to 1 loses its upper half."""
    corners = np.array([[x, y, z] for x in (-5, 5) for y in (-1, 1) for z in (-1, 1)], dtype=float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh = welded(*cut(corners, np.array(quads)), symmetric=False)
    found = hydrostatics(mesh)
    assert found.volume == pytest.approx(20.0) and found.S == pytest.approx(44.0)
    assert closure(mesh) < 1e-14


def test_stl_in_millimetres(tmp_path):
    pytest.importorskip("trimesh")
    vertices, panels = capytaine_axes(WHOLE)
    path = write_stl(tmp_path / "hull.stl", 1000.0 * vertices, panels)
    mesh = read_hull(path, SHIP, scale=0.001, panels=None)
    assert mesh.symmetric
    same_hull(mesh, rel=1e-3)  # an STL splits the panels into triangles one way
    assert "hull.stl" in mesh.report[0] and "cut at the waterline" in mesh.report[1]
    with pytest.raises(
        ConfigError, match=r"but kcs has L = 230 m; it looks like mm: give --scale 0.001"
    ):
        read_hull(path, SHIP)


def test_obj_with_other_axes_origin_and_one_side(tmp_path):
    """X to starboard, y up, bow towards -z; x = 0 at the stern, keel at zero; starboard only."""
    pytest.importorskip("trimesh")
    points = HALF.vertices + np.array([0.5 * SHIP.hull.L, 0.0, -SHIP.hull.d])
    turned = np.stack([points[:, 1], -points[:, 2], -points[:, 0]], axis=1)
    path = write_obj(tmp_path / "hull.obj", turned, HALF.panels)
    place = {"midship": 0.5 * SHIP.hull.L, "waterline": SHIP.hull.d}
    mesh = read_hull(path, SHIP, forward="-z", up="+y", panels=None, **place)
    same_hull(mesh, rel=1e-3)
    assert "one side, mirrored" in mesh.report[0]
    with pytest.raises(
        ConfigError, match="longest along the vertical axis: give --forward \\+z or -z"
    ):
        read_hull(path, SHIP, **place)
    with pytest.raises(ConfigError, match=r"give --midship, the middle .* about 118.588"):
        read_hull(path, SHIP, forward="-z", up="+y", waterline=SHIP.hull.d)
    with pytest.raises(ConfigError, match=r"nothing below the waterline.*give --waterline 10.8"):
        read_hull(path, SHIP, forward="-z", up="+y", midship=0.5 * SHIP.hull.L)
    with pytest.raises(ConfigError, match="must be two different axes"):
        read_hull(path, SHIP, forward="-z", up="+z")
    with pytest.raises(ConfigError, match="unknown direction up 'up'"):
        read_hull(path, SHIP, up="up")


def test_gdf_with_symmetry(tmp_path):
    vertices, panels = capytaine_axes(HALF)
    path = write_gdf(tmp_path / "hull.gdf", vertices, panels, ISY=1)
    points, faces = read_gdf(path)
    assert len(faces) == HALF.count and points[:, 1].max() > 0.0 > points[:, 1].min()
    same_hull(read_hull(path, SHIP, panels=None))
    path.write_text("\n".join(path.read_text().splitlines()[:50]))
    with pytest.raises(ConfigError, match=r"hull\.gdf: ends in panel"):
        read_hull(path, SHIP)


def test_coarsening_keeps_the_hull(tmp_path):
    fine = parametric_mesh(SHIP, 160, 30)
    path = write_gdf(tmp_path / "fine.gdf", *capytaine_axes(fine), ISY=1)
    mesh = read_hull(path, SHIP, panels=704)
    assert mesh.symmetric and 690 <= mesh.count <= 740
    assert "coarsened" in mesh.report[-1]
    same_hull(mesh, rel=0.01)
    assert closure(mesh) < 1e-9


@pytest.fixture
def gdf(tmp_path):
    vertices, panels = capytaine_axes(WHOLE)
    return lambda v=vertices, p=panels: write_gdf(tmp_path / "bad.gdf", v, p)


def test_inverted_normals_are_refused_and_can_be_flipped(gdf):
    path = gdf(p=WHOLE.panels[:, ::-1])
    with pytest.raises(ConfigError, match="normals point into the hull; give --flip-normals"):
        read_hull(path, SHIP)
    same_hull(read_hull(path, SHIP, flip_normals=True, panels=None))


def test_a_hull_that_lies_the_wrong_way_round_is_refused(gdf):
    with pytest.raises(ConfigError, match="the bow seems to be at the stern"):
        read_hull(gdf(), SHIP, forward="-x")


def test_one_inverted_panel_is_refused(gdf):
    panels = WHOLE.panels.copy()
    panels[200] = panels[200, ::-1]
    with pytest.raises(ConfigError, match=r"normals on opposite sides.*give --fix-normals"):
        read_hull(gdf(p=panels), SHIP)


def test_a_hole_is_refused_and_named(gdf):
    gone = np.abs(WHOLE.vertices[WHOLE.panels].mean(axis=1) - [0.0, 8.0, SHIP.hull.d]).sum(axis=1)
    panels = np.delete(WHOLE.panels, np.argmin(gone), axis=0)
    with pytest.raises(ConfigError, match=r"not watertight.*4 open edges, one at x .*fill holes"):
        read_hull(gdf(p=panels), SHIP)


def test_a_volume_that_is_not_the_ship_s_is_refused(gdf):
    path = gdf(v=capytaine_axes(WHOLE)[0] * np.array([1.0, 1.07, 1.0]))
    with pytest.raises(ConfigError, match=r"volume .* but kcs has .* allowed is a difference of 5"):
        read_hull(path, SHIP)


def test_another_draught_is_refused(gdf):
    path = gdf(v=capytaine_axes(WHOLE)[0] * np.array([1.0, 1.0, 1.3]))
    with pytest.raises(ConfigError, match=r"draught 14.* but kcs has d = .* give --waterline"):
        read_hull(path, SHIP)


def test_degenerate_panels_are_refused_as_they_are(gdf):
    """A corner of one panel on the straight line between its neighbours: no area, no normal."""
    vertices, panels = capytaine_axes(WHOLE)
    vertices = vertices.copy()
    row = panels[np.argmax(WHOLE.areas)]
    middle = 0.5 * (vertices[row[0]] + vertices[row[2]])
    sliver = np.array([[row[0], len(vertices), row[2], row[2]]])
    panels = np.concatenate(
        [
            panels[(panels != row).any(axis=1)],
            [[row[0], row[1], row[2], len(vertices)], [row[0], row[2], row[3], row[3]]],
            sliver,
        ]
    )
    path = gdf(v=np.concatenate([vertices, middle[None]]), p=panels)
    with pytest.raises(ConfigError, match=r"degenerate panels without area.*coarsened"):
        read_hull(path, SHIP, panels=None)
    assert read_hull(path, SHIP).count > 690


def test_two_hulls_cannot_be_coarsened(gdf):
    """A catamaran of the ship's volume: no section reaches the centre plane."""
    apart = np.concatenate([WHOLE.vertices * [1, 0.5, 1] + [0, 20 * s, 0] for s in (1.0, -1.0)])
    panels = np.concatenate([WHOLE.panels, WHOLE.panels + len(WHOLE.vertices)])
    path = gdf(v=apart * [1, -1, -1], p=panels)
    with pytest.raises(ConfigError, match=r"does not reach the centre plane.*--panels own"):
        read_hull(path, SHIP)
    assert read_hull(path, SHIP, panels=None).count == 2 * WHOLE.count


def test_missing_and_damaged_files(tmp_path):
    with pytest.raises(ConfigError, match="no such file"):
        read_hull(tmp_path / "none.stl", SHIP)
    (tmp_path / "hull.vtk").write_text("nonsense")
    pytest.importorskip("meshio")
    with pytest.raises(ConfigError, match="not a mesh, or damaged"):
        read_hull(tmp_path / "hull.vtk", SHIP)


def obj(vertices, faces):
    """Lines of an OBJ file in Capytaine's axes, triangles."""
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in vertices]
    corners = np.concatenate([faces[:, :3], faces[:, [0, 2, 3]]]) + 1
    return lines + [f"f {a} {b} {c}" for a, b, c in corners if len({a, b, c}) == 3]


def test_an_obj_file_is_read(tmp_path):
    pytest.importorskip("trimesh")
    (tmp_path / "hull.obj").write_text(
        "\n".join(["mtllib ../../x.mtl", *obj(*capytaine_axes(WHOLE))])
    )
    assert read_hull(tmp_path / "hull.obj", SHIP).count > 690


@pytest.mark.parametrize(
    ("number", "line", "words"),
    [
        (0, "v 1.0 2.0", "hull.obj:1: 'v 1.0 2.0': needed are three numbers"),
        (0, "v 1.0 2.0 x", "hull.obj:1: 'v 1.0 2.0 x': needed"),
        (0, "v nan 2.0 3.0", "vertices[0, 0] = nan: allowed is -1e+09 to 1e+09"),
        (0, "v 1 2 1e300", "vertices[0, 2] = 1e+300: allowed"),
        (-1, "f 1 2", "'f 1 2': needed"),
        (-1, "f 1 2 3x", "'f 1 2 3x': needed"),
        (-1, "f 1 2 1000000000000", "hull.obj: "),
        (-1, "f 1 2 99999", "hull.obj: "),
        (-1, "f 0 1 2", "'f 0 1 2': needed"),
    ],
)
def test_a_damaged_line_of_a_mesh_is_told(tmp_path, number, line, words):
    pytest.importorskip("trimesh")
    lines = obj(*capytaine_axes(WHOLE))
    lines[number] = line
    (tmp_path / "hull.obj").write_text("\n".join(lines))
    with pytest.raises(ConfigError) as error:
        read_hull(tmp_path / "hull.obj", SHIP)
    assert words in str(error.value) and "\n" not in str(error.value)


VTK = "# vtk DataFile Version 2.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 1000000000000 float"


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.gdf", "t\n1 9.8\n0 0\n1000000000000\n1 2 3"),
        ("b.gdf", "t\n1 9.8\n0 0\n1e400\n1 2 3"),
        ("c.gdf", "t\n1 9.8\nnan 0\n1\n1 2 3"),
        ("d.gdf", "t\n1 9.8\n0 0\n1\n" + "nan " * 12),
        ("e.gdf", ""),
        ("a.off", "OFF\n3 1000000000000 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2"),
        ("a.ply", "ply\nformat ascii 1.0\nelement vertex 1000000000000\nend_header\n1"),
        ("a.stl", "solid\nfacet"),
        ("b.stl", ""),
        ("a.obj", ""),
        ("b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0"),
        ("a.vtk", VTK),
        ("a.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 1000000000000 1 2"),
        ("a.vtu", "<VTKFile>"),
    ],
)  # fmt: skip
def test_a_mesh_that_is_none_is_one_line(tmp_path, name, text):
    pytest.importorskip("trimesh")
    pytest.importorskip("meshio")
    (tmp_path / name).write_text(text)
    with pytest.raises(ConfigError) as error:
        read_hull(tmp_path / name, SHIP)
    assert str(tmp_path / name) in str(error.value) and "\n" not in str(error.value)


# --- the real hull of DTC, which is not in the package -----------------------------------------


@pytest.mark.skipif(not DTC.is_file(), reason="the published DTC geometry is not here")
def test_the_published_hull_of_dtc(tmp_path):
    """173,326 m3, 22,039 m2 and 174.06 m forward of AP were measured by others in this file."""
    pytest.importorskip("trimesh")
    path = tmp_path / "dtc.stl"
    path.write_bytes(gzip.decompress(DTC.read_bytes()))
    hull = dataclasses.replace(SHIP.hull, L=355.0, B=51.0, d=14.5, volume=173468.0, S=22032.0)
    ship = dataclasses.replace(SHIP, name="dtc", hull=hull, form=None, wind=None)
    where = {"scale": 59.407, "midship": 177.5, "waterline": 0.2440 * 59.407}
    mesh = read_hull(path, ship, panels=704, **where)
    # all 81,000 panels of the file below the waterline
    volume, S = (
        float(text.split()[1 + i]) for i, text in enumerate(mesh.report[1].split(", ")[1:])
    )
    assert volume == pytest.approx(173326.0, rel=1e-4)
    assert S == pytest.approx(22039.0, rel=1e-4)
    # the 736 panels that are left of them
    found = hydrostatics(mesh)
    assert found.volume == pytest.approx(173326.0, rel=0.006)
    assert found.S == pytest.approx(22039.0, rel=0.01)
    assert found.x_B == pytest.approx(174.06 - 177.5, abs=0.0001 * 355.0)
    assert found.A_wp == pytest.approx(15310.0, rel=0.002)
    assert closure(mesh) < 1e-9


def test_picture(tmp_path):
    hull_picture(tmp_path / "kcs.png", HALF, SHIP)
    assert (tmp_path / "kcs.png").stat().st_size > 20_000
