"""Hull files of other programs: each format of the table in docs/hulls.md."""

from __future__ import annotations

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.seakeeping.hull_file import read_hull
from ship_gym.seakeeping.hull_form import parametric_mesh
from ship_gym.seakeeping.hull_gdf import read_gdf
from ship_gym.seakeeping.hull_mesh import capytaine_axes
from ship_gym.seakeeping.hydrostatics import hydrostatics
from ship_gym.ships import load_ship

SHIP = load_ship("kcs")
HALF = parametric_mesh(SHIP)
WHOLE = HALF.both_sides()
VOLUME = hydrostatics(HALF).volume


def rows(*arrays):
    """Lines of numbers, those of each array behind those of the one before."""
    joined = np.concatenate([np.reshape(a, (len(a), -1)) for a in arrays], axis=1)
    return [" ".join(f"{value:.9g}" for value in row) for row in joined]


def mar(vertices, panels, symmetric):
    count = np.arange(len(vertices)) + 1
    return [f"2 {symmetric}", *rows(count, vertices), "0 0. 0. 0.", *rows(panels + 1), "0 0 0 0"]


def hst(vertices, panels, symmetric, numbered=True):
    first = [np.arange(len(panels)) + 1] if numbered else []
    return [
        "PROJECT: a hull", "", f"SYMMETRY {symmetric}", "COORDINATES",
        *rows(np.arange(len(vertices)) + 1, vertices), "ENDCOORDINATES",
        f"PANEL TYPE {int(numbered)}", *rows(*first, panels + 1), "ENDPANEL", "ENDFILE",
    ]  # fmt: skip


def pnl(vertices, panels, symmetric):
    faces = [
        f"{i} {len(set(row))} " + " ".join(str(j + 1) for j in dict.fromkeys(row))
        for i, row in enumerate(panels.tolist(), 1)
    ]
    return [
        "    --------------Hull Mesh File---------------", "", "    # Number of Panels, Nodes",
        f"{len(panels)} {len(vertices)} 0 {symmetric}", "", "    # Start Definition of Node",
        *rows(np.arange(len(vertices)) + 1, vertices), "   end", "", "    # Start of Connectivity",
        *faces, "   end",
    ]  # fmt: skip


def gdf(vertices, panels, symmetric, third="NPAN"):
    corners = rows(vertices[panels].reshape(-1, 3))
    return ["hull", "1. 9.80665 ULEN GRAV", f"0 {symmetric} ISX ISY", f"{len(panels)} {third}",
            *corners]  # fmt: skip


PANELS = {"mar": mar, "nemoh": mar, "dat": mar, "hst": hst, "pnl": pnl, "gdf": gdf}


def written(path, lines):
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize("ending", PANELS)
@pytest.mark.parametrize("symmetric", [0, 1])
def test_panels_of_the_wave_programs_are_read(tmp_path, ending, symmetric):
    if ending != "gdf":
        pytest.importorskip("capytaine")
    mesh = HALF if symmetric else WHOLE
    path = written(tmp_path / f"hull.{ending}", PANELS[ending](*capytaine_axes(mesh), symmetric))
    found = read_hull(path, SHIP, panels=None)
    assert found.symmetric and found.count == HALF.count
    assert hydrostatics(found).volume == pytest.approx(VOLUME, rel=1e-7)


def test_hydrostar_without_numbers_of_panels(tmp_path):
    pytest.importorskip("capytaine")
    path = written(tmp_path / "hull.hst", hst(*capytaine_axes(HALF), 1, numbered=False))
    assert hydrostatics(read_hull(path, SHIP, panels=None)).volume == pytest.approx(VOLUME)


def quarter():
    """A quarter of a box, 40 x 10 x 4: corners (3, 4, 3), x forward, y to port, z up."""
    side = [[0, 5, 0], [0, 5, -4], [20, 5, -4], [20, 5, 0]]
    bottom = [[0, 0, -4], [20, 0, -4], [20, 5, -4], [0, 5, -4]]
    end = [[20, 0, 0], [20, 5, 0], [20, 5, -4], [20, 0, -4]]
    return np.array([side[::-1], bottom[::-1], end[::-1]], dtype=float)


@pytest.mark.parametrize("symmetries, share", [("1 1", 4), ("1 0", 2), ("0 1", 2), ("0 0", 1)])
def test_symmetries_of_a_gdf_file_are_unfolded(tmp_path, symmetries, share):
    corners = quarter()
    lines = ["box", "1 9.81", symmetries, "3", *rows(corners.reshape(-1, 3))]
    vertices, panels = read_gdf(written(tmp_path / "box.gdf", lines))
    assert len(panels) == 3 * share
    a, b, c, d = (vertices[panels[:, i]] for i in range(4))
    n = 0.5 * np.cross(c - a, d - b)
    # volume by z n_z: every quarter adds its own, whichever way it was mirrored
    assert ((a + b + c + d)[:, 2] / 4 @ n[:, 2]) == pytest.approx(share * 20 * 5 * 4)


def test_a_nemoh_file_whose_first_list_has_no_end_names_its_last_line(tmp_path):
    lines = ["2 0", "1 0 0 0", "2 1 0 0", "3 1 1 0", "1 2 3 3", "0 0 0 0"]  # no 0 behind vertices
    with pytest.raises(ConfigError, match=r"hull.mar:6: the file ends: needed are four corners"):
        read_hull(written(tmp_path / "hull.mar", lines), SHIP)


def test_a_gdf_file_of_fortran_in_double_precision(tmp_path):
    lines = ["box", "1 9.81", "1 1", "3", *rows(quarter().reshape(-1, 3))]
    double = [*lines[:4], *(" ".join(f"{float(w):.3E}".replace("E", "D") for w in line.split())
                            for line in lines[4:])]  # fmt: skip
    plain, other = (read_gdf(written(tmp_path / "box.gdf", some)) for some in (lines, double))
    np.testing.assert_array_equal(plain[0], other[0])


@pytest.mark.parametrize(
    ("number", "line", "words"),
    [
        (1, "metres", "hull.gdf:2: 'metres': not a GDF file: needed are two numbers, ULEN"),
        (2, "0 2", "hull.gdf:3: '0 2': not a GDF file: needed are two numbers 0 or 1, ISX"),
        (3, "many", "hull.gdf:4: 'many': not a GDF file: needed are the number of panels"),
        (3, "14 1", "hull.gdf:4: a higher-order GDF file (14 patches, IGDEF = 1): allowed"),
        (3, "-5", "hull.gdf:4: '-5'"),
        (9, "1.0 x 2.0", "hull.gdf: panel 2, corner 2: 'x': needed is a number"),
        (-1, "", "hull.gdf: ends in panel 356 of 356"),
    ],
)
def test_a_damaged_gdf_file_is_one_line(tmp_path, number, line, words):
    lines = gdf(*capytaine_axes(HALF), 1)
    lines[number] = line
    with pytest.raises(ConfigError) as error:
        read_hull(written(tmp_path / "hull.gdf", lines), SHIP)
    assert words in str(error.value) and len(str(error.value)) < 300 + len(str(tmp_path))


V = len(HALF.vertices)


@pytest.mark.parametrize(
    ("ending", "number", "line", "words"),
    [
        ("mar", 0, "hull", "hull.mar:1: 'hull': needed are 2 and 0, or 2 and 1"),
        ("mar", 5, "5 1.0 2.0", "hull.mar:6: '5 1.0 2.0': needed are a number and x, y, z"),
        ("mar", 5, "5 1.0 2.0 nan", "hull.mar:6: "),
        ("mar", V + 4, "1 2 3", f"hull.mar:{V + 5}: '1 2 3': needed are four corners"),
        ("mar", V + 4, f"1 2 3 {V + 1}", f"hull.mar:{V + 5}: '1 2 3 {V + 1}': needed are corners"),
        ("mar", -1, "", "the file ends: needed are four corners of a panel, or 0 0 0 0"),
        ("hst", 2, "SYMMETRY 3", "hull.hst:3: 'SYMMETRY 3': needed is SYMMETRY 0, 1 or 2"),
        ("hst", 6, "3 1.0", "hull.hst:7: '3 1.0': needed are x, y, z"),
        ("hst", V + 6, "1 2 x 4 5", f"hull.hst:{V + 7}: '1 2 x 4 5': needed are three or four"),
        ("hst", V + 6, "1 0 2 4 5", f"hull.hst:{V + 7}: '1 0 2 4 5': needed are corners of 1 to"),
        ("hst", 3, "", "not a HydroStar file: no section COORDINATES"),
        ("pnl", 3, "10 10 0", "hull.pnl:4: '10 10 0': needed are numbers of panels"),
        ("pnl", 3, "356 90000 0 1", "the file ends: needed are 90000 vertices"),
        ("pnl", 8, "3 1 2", "hull.pnl:9: '3 1 2': needed are a number and x, y, z"),
        ("pnl", V + 9, "1 5 1 2 3 4", f"hull.pnl:{V + 10}: '1 5 1 2 3 4': needed are 1, 3 or 4"),
    ],
)
def test_a_damaged_file_of_panels_names_its_line(tmp_path, ending, number, line, words):
    pytest.importorskip("capytaine")
    lines = PANELS[ending](*capytaine_axes(HALF), 1)
    lines[number] = line
    with pytest.raises(ConfigError) as error:
        read_hull(written(tmp_path / f"hull.{ending}", lines), SHIP)
    assert words in str(error.value) and "\n" not in str(error.value)


MESHIO = (".msh", ".vtk", ".vtu", ".inp", ".mesh", ".avs", ".ply", ".dat", ".vol", ".mdpa")


@pytest.mark.parametrize("ending", MESHIO)
def test_meshes_of_meshio_are_read(tmp_path, ending):
    meshio = pytest.importorskip("meshio")
    vertices, panels = capytaine_axes(WHOLE)
    three = panels[:, 2] == panels[:, 3]
    path = tmp_path / f"hull{ending}"
    kinds = {".msh": "gmsh22", ".vol": "netgen"}.get(ending)
    cells = [("triangle", panels[three][:, :3]), ("quad", panels[~three])]
    meshio.write(path, meshio.Mesh(vertices, cells), file_format=kinds)
    found = read_hull(path, SHIP, panels=None)
    assert found.count == HALF.count
    assert hydrostatics(found).volume == pytest.approx(VOLUME, rel=1e-6)


@pytest.mark.parametrize("ending", ["stl", "obj", "ply", "off", "glb"])
def test_surfaces_of_trimesh_are_read(tmp_path, ending):
    trimesh = pytest.importorskip("trimesh")
    vertices, panels = capytaine_axes(WHOLE)
    faces = np.concatenate([panels[:, :3], panels[panels[:, 2] != panels[:, 3]][:, [0, 2, 3]]])
    path = tmp_path / f"hull.{ending}"
    trimesh.Trimesh(vertices, faces, process=False).export(path)
    found = read_hull(path, SHIP, panels=None)
    assert hydrostatics(found).volume == pytest.approx(VOLUME, rel=1e-3)  # split one way


def corners_of(panels):
    """Lists of three or four numbers of vertices from 0."""
    return [list(dict.fromkeys(row)) for row in panels.tolist()]


def nastran(vertices, panels):
    lines = [f"GRID,{i},,{x:.6f},{y:.6f},{z:.6f}" for i, (x, y, z) in enumerate(vertices, 1)]
    for i, row in enumerate(corners_of(panels + 1), 1):
        kind = "CQUAD4" if len(row) == 4 else "CTRIA3"
        lines.append(f"{kind},{i},1," + ",".join(str(j) for j in row))
    return ["CEND", "BEGIN BULK", *lines, "ENDDATA"]


def su2(vertices, panels):
    faces = [
        f"{9 if len(row) == 4 else 5} " + " ".join(str(j) for j in row) + f" {i}"
        for i, row in enumerate(corners_of(panels))
    ]
    points = rows(vertices, np.arange(len(vertices)))
    return ["NDIME= 3", f"NELEM= {len(faces)}", *faces, f"NPOIN= {len(points)}", *points]


def ugrid(vertices, panels):
    found = corners_of(panels + 1)
    faces = [" ".join(str(j) for j in row) for n in (3, 4) for row in found if len(row) == n]
    three = sum(len(row) == 3 for row in found)
    head = f"{len(vertices)} {three} {len(found) - three} 0 0 0 0"
    return [head, *rows(vertices), *faces, *["1"] * len(found)]


@pytest.mark.parametrize("ending, lines", [("nas", nastran), ("su2", su2), ("ugrid", ugrid)])
def test_meshes_of_flow_and_structure_programs_are_read(tmp_path, ending, lines):
    pytest.importorskip("meshio")
    path = written(tmp_path / f"hull.{ending}", lines(*capytaine_axes(WHOLE)))
    found = read_hull(path, SHIP, panels=None)
    assert hydrostatics(found).volume == pytest.approx(VOLUME, rel=1e-6)


def test_faces_of_second_order_count_by_their_corners(tmp_path):
    meshio = pytest.importorskip("meshio")
    vertices, panels = capytaine_axes(WHOLE)
    four = panels[panels[:, 2] != panels[:, 3]]
    three = panels[panels[:, 2] == panels[:, 3]][:, :3]
    middle = np.concatenate(
        [0.5 * (vertices[four[:, i]] + vertices[four[:, i - 3]]) for i in range(4)]
    )
    index = len(vertices) + np.arange(4 * len(four)).reshape(4, -1).T
    cells = [("quad8", np.concatenate([four, index], axis=1)), ("triangle", three)]
    meshio.write(tmp_path / "hull.vtu", meshio.Mesh(np.concatenate([vertices, middle]), cells))
    found = read_hull(tmp_path / "hull.vtu", SHIP, panels=None)
    assert hydrostatics(found).volume == pytest.approx(VOLUME, rel=1e-6)


def test_what_is_no_surface_is_refused(tmp_path):
    meshio = pytest.importorskip("meshio")
    path = tmp_path / "hull.vtk"
    meshio.write(path, meshio.Mesh(np.eye(4, 3), [("tetra", [[0, 1, 2, 3]])]))
    with pytest.raises(ConfigError, match=r"hull.vtk: holds tetra: allowed are triangles and quad"):
        read_hull(path, SHIP)
    with pytest.raises(ConfigError, match=r"hull.3ds: suffix '.3ds': allowed are .gdf, .mar"):
        read_hull(written(tmp_path / "hull.3ds", ["1 2 3"]), SHIP)
    with pytest.raises(ConfigError, match=r"hull.ele: .ele holds no surface"):
        read_hull(written(tmp_path / "hull.ele", ["1 2 3"]), SHIP)


BOMB = """<?xml version="1.0"?>
<!DOCTYPE VTKFile [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>
<VTKFile>&b;</VTKFile>"""
OUTSIDE = """<?xml version="1.0"?>
<!DOCTYPE Xdmf SYSTEM "http://127.0.0.1:9/x.dtd"><Xdmf Version="3.0"></Xdmf>"""
ELSEWHERE = """<?xml version="1.0"?>
<Xdmf Version="3.0"><DataItem Format="Binary" Dimensions="3">/etc/hostname</DataItem></Xdmf>"""


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("a.vtu", BOMB, "a.vtu:2: holds a DOCTYPE: allowed is XML without document type"),
        ("a.xdmf", OUTSIDE, "a.xdmf:2: holds a DOCTYPE"),
        ("b.xdmf", ELSEWHERE, "its numbers lie in another file"),
        ("c.vtu", "<VTKFile>", "not XML, or damaged"),
    ],
)
def test_xml_has_no_entities_and_opens_no_other_file(tmp_path, name, text, words):
    pytest.importorskip("meshio")
    (tmp_path / name).write_text(text)
    with pytest.raises(ConfigError) as error:
        read_hull(tmp_path / name, SHIP)
    assert words in str(error.value) and "\n" not in str(error.value)
