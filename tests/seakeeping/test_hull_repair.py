"""Hanging nodes, gaps, normals that differ, square corners: what is repaired and what is not."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.seakeeping.hull_checks import check_mesh
from ship_gym.seakeeping.hull_file import read_hull
from ship_gym.seakeeping.hull_mesh import welded
from ship_gym.seakeeping.hull_repair import close_gaps, open_edges, oriented
from ship_gym.seakeeping.hull_sections import coarsened
from ship_gym.seakeeping.hydrostatics import closure, hydrostatics
from ship_gym.ships import load_ship

# what is not the hull is still that of KCS
pytestmark = pytest.mark.filterwarnings("ignore:.*is not strict")

L, B, D = 100.0, 20.0, 5.0


@pytest.fixture(scope="module")
def barge():
    """A ship file for a box: L B d is its volume."""
    like = load_ship("kcs")
    hull = dataclasses.replace(
        like.hull, L=L, B=B, d=D, volume=L * B * D, x_G=0.0, S=L * B + 2 * (L + B) * D, k_zz=25.0
    )
    return dataclasses.replace(like, name="barge", hull=hull, form=None, wind=None, strict=False)


def sheet(u, v, corner, along, up):
    """Quadrilaterals of a flat patch between lines at u and v (0 to 1): corners (n, 4, 3)."""
    at = np.asarray(corner) + np.multiply.outer(u, along)[:, None] + np.multiply.outer(v, up)[None]
    return np.stack([at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]], axis=2).reshape(-1, 4, 3)


def box(off=0.0, sides=5, bottom=8):
    """A box open on top, ship axes, normals out; its patches divided differently along x.

    The nodes of the sides' lower edges that are not the bottom's lie `off` beside it [m].
    """
    u, n = np.linspace(0.0, 1.0, sides + 1), np.linspace(0.0, 1.0, bottom + 1)
    v = np.array([0.0, 0.5, 1.0])
    x0, y0 = -L / 2, -B / 2
    starboard = sheet(u, v, (x0, -y0, 0), (L, 0, 0), (0, 0, D))[:, ::-1]
    low = (starboard[..., 2] == D) & (np.abs(starboard[..., 0]) < L / 2)
    starboard[low, 2] -= off
    starboard[low, 1] -= off
    port = (starboard * [1, -1, 1])[:, ::-1]
    floor = sheet(n, np.linspace(0, 1, 5), (x0, y0, D), (L, 0, 0), (0, B, 0))
    stern = sheet(np.linspace(0, 1, 5), v, (x0, y0, 0), (0, B, 0), (0, 0, D))
    bow = (stern * [-1, 1, 1])[:, ::-1]
    corners = np.concatenate([starboard, port, floor, stern[:, ::-1], bow[:, ::-1]])
    mesh = welded(corners.reshape(-1, 3), np.arange(4 * len(corners)).reshape(-1, 4), False)
    return mesh if hydrostatics(mesh).volume > 0 else dataclasses.replace(mesh)


def gdf(path, mesh):
    corners = (mesh.vertices * [1, -1, -1])[mesh.panels].reshape(-1, 3)
    lines = [" ".join(f"{x:.9g}" for x in corner) for corner in corners]
    path.write_text("\n".join(["box", "1 9.81", "0 0", str(len(mesh.panels)), *lines]) + "\n")
    return path


def open_below(mesh):
    edges, _ = open_edges(mesh.panels)
    return int((np.abs(mesh.vertices[edges][..., 2]) > 1e-6).any(axis=1).sum())


@pytest.mark.parametrize("off", [0.0, 0.005])
def test_hanging_nodes_become_corners(off):
    """Sides of 5 panels on a bottom of 8 share no edge but at the ends."""
    mesh = box(off)
    assert open_below(mesh) == 2 * (5 + 8)
    points, panels, closed = close_gaps(mesh.vertices, mesh.panels, 0.01)
    fixed = welded(points, panels, False)
    assert closed == 26 and open_below(fixed) == 0
    assert len(fixed.vertices) == len(mesh.vertices)
    assert closure(fixed) < 1e-13
    assert hydrostatics(fixed).volume == pytest.approx(L * B * D, rel=1e-3 if off else 1e-13)
    assert fixed.areas.min() > 1e-5 * fixed.areas.max()  # no slivers


def test_what_lies_farther_apart_stays_open():
    mesh = box(0.05)
    _, _, closed = close_gaps(mesh.vertices, mesh.panels, 0.01)
    assert closed == 0


def test_a_wide_gap_is_refused_and_weld_closes_it(tmp_path, barge):
    path = gdf(tmp_path / "box.gdf", box(0.2))
    with pytest.raises(ConfigError, match=r"not watertight.*26 open edges.*--weld") as error:
        read_hull(path, barge)
    assert len(str(error.value)) < 300 + len(str(tmp_path))
    mesh = read_hull(path, barge, weld=0.4)
    assert "closed 26 open edges with gaps of at most 0.4 m" in mesh.report[1]


def test_equal_nodes_with_rounded_numbers_are_one(tmp_path, barge):
    mesh = box(sides=8)
    corners = mesh.vertices[mesh.panels] + np.random.default_rng(1).uniform(
        -0.002, 0.002, (len(mesh.panels), 4, 3)
    )
    corners[mesh.vertices[mesh.panels][..., 2] == 0.0, 2] = 0.0
    apart = welded(corners.reshape(-1, 3), np.arange(4 * len(corners)).reshape(-1, 4), False)
    assert open_below(apart) > 100
    found = read_hull(gdf(tmp_path / "box.gdf", apart), barge, panels=704)
    assert hydrostatics(found).volume == pytest.approx(L * B * D, rel=1e-3)


def test_open_edges_that_count_nothing_are_no_hole(barge):
    """Flat patches side by side: no volume is lost, whatever the edges say."""
    mesh = box(0.0)
    assert open_below(mesh) == 26
    check_mesh(mesh, barge)


def test_one_panel_of_thousands_is_told_in_the_report(tmp_path, barge):
    """Too small to count, but whoever reads the card must know."""
    mesh = box(sides=40, bottom=400)
    holed = dataclasses.replace(mesh, panels=np.delete(mesh.panels, 500, axis=0))
    assert not any("still open" in line for line in read_hull(
        gdf(tmp_path / "whole.gdf", mesh), barge).report)  # fmt: skip
    found = read_hull(gdf(tmp_path / "holed.gdf", holed), barge)
    assert any(line.startswith("still open, too little to count: 4 open") for line in found.report)


@pytest.mark.parametrize(
    ("aside", "words"), [(12.0, "12 m to starboard"), (-6e6, "6e\\+06 m to port")]
)
def test_both_sides_beside_the_centre_plane_are_no_half(tmp_path, barge, aside, words):
    """Mirrored they would be two hulls; coordinates of a map are far from zero."""
    mesh = box(0.0)
    moved = dataclasses.replace(mesh, vertices=mesh.vertices + [0.0, aside, 0.0])
    with pytest.raises(ConfigError, match=f"its centre plane lies {words} of zero"):
        read_hull(gdf(tmp_path / "aside.gdf", moved), barge)


def test_a_missing_face_is_a_hole(barge):
    mesh = box(0.0)
    for face in (0, 25, len(mesh.panels) - 1):  # of a side, of the bottom, of the bow
        holed = dataclasses.replace(mesh, panels=np.delete(mesh.panels, face, axis=0))
        with pytest.raises(ConfigError, match="not watertight: its volume differs by"):
            check_mesh(holed, barge)


def test_normals_are_turned_outward(tmp_path, barge):
    mesh = box(sides=8)
    wrong = mesh.panels.copy()
    some = np.random.default_rng(2).random(len(wrong)) < 0.4
    wrong[some] = wrong[some][:, ::-1]
    found, turned = oriented(mesh.vertices, wrong)
    assert turned == some.sum()
    assert hydrostatics(dataclasses.replace(mesh, panels=found)).volume == pytest.approx(L * B * D)
    path = gdf(tmp_path / "box.gdf", dataclasses.replace(mesh, panels=wrong))
    with pytest.raises(ConfigError, match=r"normals on opposite sides.*--fix-normals"):
        read_hull(path, barge)
    mended = read_hull(path, barge, fix_normals=True)
    assert hydrostatics(mended).volume == pytest.approx(L * B * D)


@pytest.mark.parametrize("panels", [80, 200, 704])
@pytest.mark.parametrize(("beam", "draught"), [(20.0, 5.0), (60.0, 2.0), (10.0, 20.0)])
def test_a_box_keeps_its_volume_when_coarsened(panels, beam, draught):
    mesh = box(sides=8)
    mesh = dataclasses.replace(mesh, vertices=mesh.vertices * [1, beam / B, draught / D])
    coarse = hydrostatics(coarsened(mesh, panels))
    fine = hydrostatics(mesh)
    for name in ("volume", "S", "A_wp", "KB", "BM", "L_wl"):
        assert getattr(coarse, name) == pytest.approx(getattr(fine, name), rel=1e-9), name


def test_a_box_of_twelve_triangles_is_enough(tmp_path, barge):
    """As a CAD program writes it, from keel to deck."""
    pytest.importorskip("trimesh")
    corners = [(x, y, z) for x in (0, L) for y in (-B / 2, B / 2) for z in (0, 2 * D)]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [f for a, b, c, d in quads for f in ((a, b, c), (a, c, d))]
    lines = [f"v {x} {y} {z}" for x, y, z in corners]
    lines += ["f " + " ".join(str(i + 1) for i in face) for face in faces]
    (tmp_path / "box.obj").write_text("\n".join(lines))
    mesh = read_hull(tmp_path / "box.obj", barge, midship=L / 2, waterline=D, panels=300)
    assert hydrostatics(mesh).volume == pytest.approx(L * B * D, rel=1e-9)
