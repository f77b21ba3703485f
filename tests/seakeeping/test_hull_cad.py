"""STEP and IGES: Wigley's hull as one Bezier surface a side, whose volume is 4/9 L B d."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.seakeeping import hull_cad
from ship_gym.seakeeping.hull_file import read_hull
from ship_gym.seakeeping.hull_mesh import boundary_edges
from ship_gym.seakeeping.hydrostatics import hydrostatics
from ship_gym.ships import load_ship

# what is not the hull is still that of KCS
pytestmark = pytest.mark.filterwarnings("ignore:.*is not strict")

L, B, D = 100.0, 20.0, 8.0
VOLUME = 4.0 / 9.0 * L * B * D


@pytest.fixture(scope="module")
def ship():
    like = load_ship("kcs")
    hull = dataclasses.replace(
        like.hull, L=L, B=B, d=D, volume=VOLUME, x_G=0.0, S=2244.0, k_zz=0.25 * L
    )
    return dataclasses.replace(like, name="wigley", hull=hull, form=None, wind=None, strict=False)


def patch(side, along=(-1.0, 1.0), down=(0.0, 1.0)):
    """Control points (9 of x, y, z) of y = B/2 (1 - xi^2) (1 - zeta^2) over a part, z up.

    Of a part from a to b they are the polar forms at (a, a), (a, b), (b, b).
    """
    (a, b), (c, d) = along, down
    ahead = [(0.5 * (p + q), 1.0 - p * q) for p, q in ((a, a), (a, b), (b, b))]
    deep = [(0.5 * (p + q), 1.0 - p * q) for p, q in ((c, c), (c, d), (d, d))]
    return [(0.5 * L * x, side * 0.5 * B * f * g, -D * z) for z, g in deep for x, f in ahead]


def iges(patches, flag, unit, by):
    """Entity 128 (rational B-spline surface) for each patch; `by` units to the metre."""

    def section(text, letter):
        lines = [text[i : i + 72] for i in range(0, len(text), 72)]
        return [f"{line:<72}{letter}{i:>7}" for i, line in enumerate(lines, 1)]

    start = [f"{'wigley':<72}S{1:>7}"]
    day = "15H20260101.000000"
    head = section(
        f"1H,,1H;,6Hwigley,8Hhull.igs,4Htest,4Htest,32,38,6,308,15,6Hwigley,1.,{flag},"
        f"{len(unit)}H{unit},1,0.01,{day},1E-06,{200 * by:g},4Htest,4Htest,11,0,{day};",
        "G",
    )
    entries, data = [], []
    for points in patches:
        knots, flat = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0], [c * by for point in points for c in point]
        values = [128, 2, 2, 2, 2, 0, 0, 1, 0, 0, *knots, *knots, *[1.0] * 9, *flat,
                  0.0, 1.0, 0.0, 1.0]  # fmt: skip
        lines, first, number = [""], len(data) + 1, len(entries) + 1
        for word in [*(f"{value!r}," for value in values[:-1]), f"{values[-1]!r};"]:
            if len(lines[-1]) + len(word) > 64:
                lines.append("")
            lines[-1] += word
        data += [f"{x:<64}{number:>8}P{first + i:>7}" for i, x in enumerate(lines)]
        zero = f"{0:>8}"
        entries.append(f"{128:>8}{first:>8}{zero * 6}{'00000000':>8}D{number:>7}")
        entries.append(f"{128:>8}{zero * 2}{len(lines):>8}{zero}{'':>24}{zero}D{number + 1:>7}")
    counts = f"S{1:>7}G{len(head):>7}D{len(entries):>7}P{len(data):>7}"
    return "\n".join([*start, *head, *entries, *data, f"{counts:<72}T{1:>7}"]) + "\n"


def step(patches, unit, by):
    """B-spline surfaces as a geometric set of AP214; `unit` is SI's prefix of the metre."""
    lines = []

    def add(text):
        lines.append(f"#{len(lines) + 1} = {text};")
        return f"#{len(lines)}"

    surfaces = []
    for points in patches:
        c = [add(f"CARTESIAN_POINT('',({x * by!r},{y * by!r},{z * by!r}))") for x, y, z in points]
        rows = ",".join(f"({c[i]},{c[3 + i]},{c[6 + i]})" for i in range(3))
        surfaces.append(
            add(
                f"B_SPLINE_SURFACE_WITH_KNOTS('',2,2,({rows}),.UNSPECIFIED.,.F.,.F.,.F.,(3,3),"
                "(3,3),(0.,1.),(0.,1.),.UNSPECIFIED.)"
            )
        )
    made = add(f"GEOMETRIC_SET('',({','.join(surfaces)}))")
    metre = add(f"( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT({unit},.METRE.) )")
    angle = add("( NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.) )")
    solid = add("( NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT() )")
    context = add(
        "( GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNIT_ASSIGNED_CONTEXT("
        f"({metre},{angle},{solid})) REPRESENTATION_CONTEXT('','') )"
    )
    shape = add(f"GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION('',({made}),{context})")
    use = add("APPLICATION_CONTEXT('automotive design')")
    kind = add(f"PRODUCT_CONTEXT('',{use},'mechanical')")
    product = add(f"PRODUCT('hull','hull','',({kind}))")
    formed = add(f"PRODUCT_DEFINITION_FORMATION('','',{product})")
    stage = add(f"PRODUCT_DEFINITION_CONTEXT('part definition',{use},'design')")
    whole = add(f"PRODUCT_DEFINITION('design','',{formed},{stage})")
    defined = add(f"PRODUCT_DEFINITION_SHAPE('','',{whole})")
    add(f"SHAPE_DEFINITION_REPRESENTATION({defined},{shape})")
    return "\n".join(
        [
            "ISO-10303-21;", "HEADER;", "FILE_DESCRIPTION((''),'2;1');",
            "FILE_NAME('','2026-01-01T00:00:00',(''),(''),'','','');",
            "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));", "ENDSEC;", "DATA;",
            *lines, "ENDSEC;", "END-ISO-10303-21;",
        ]
    )  # fmt: skip


ONE, BOTH = [patch(1.0)], [patch(1.0), patch(-1.0)]
FILES = {
    "metres.igs": iges(BOTH, 6, "M", 1.0),
    "millimetres.iges": iges(ONE, 2, "MM", 1000.0),
    "metres.stp": step(ONE, "$", 1.0),
    "millimetres.step": step(BOTH, ".MILLI.", 1000.0),
}


@pytest.mark.parametrize("name", FILES)
def test_wigleys_hull_is_read_in_its_own_unit(tmp_path, ship, name):
    pytest.importorskip("cascadio")
    path = tmp_path / name
    path.write_text(FILES[name])
    found = read_hull(path, ship, panels=None)
    values = hydrostatics(found)
    assert values.volume == pytest.approx(VOLUME, rel=2e-3)  # chords cut off a little
    assert values.L_wl == pytest.approx(L, rel=1e-4)
    assert values.B_wl == pytest.approx(B, rel=1e-3) and values.draught == pytest.approx(D)
    assert values.A_wp == pytest.approx(2.0 / 3.0 * L * B, rel=2e-3)
    assert values.KB == pytest.approx(5.0 / 8.0 * D, rel=2e-3)


def test_a_coarse_hull_of_it(tmp_path, ship):
    pytest.importorskip("cascadio")
    (tmp_path / "hull.igs").write_text(FILES["metres.igs"])
    found = read_hull(tmp_path / "hull.igs", ship, panels=704)
    assert 690 < found.count < 750
    assert hydrostatics(found).volume == pytest.approx(VOLUME, rel=0.008)


def test_surfaces_that_meet_in_a_t_are_joined(tmp_path, ship):
    """One surface aft, two above each other forward."""
    pytest.importorskip("cascadio")
    aft = patch(1.0, (-1.0, 0.1))
    fore = [patch(1.0, (0.1, 1.0), part) for part in ((0.0, 0.37), (0.37, 1.0))]
    (tmp_path / "hull.igs").write_text(iges([aft, *fore], 6, "M", 1.0))
    found = read_hull(tmp_path / "hull.igs", ship, panels=None)
    ends = found.vertices[boundary_edges(found)]
    assert (np.abs(ends[..., 1:]).min(axis=2).max()) < 1e-3  # keel, stems and waterline only
    assert hydrostatics(found).volume == pytest.approx(VOLUME, rel=2e-3)


@pytest.mark.parametrize("name", ["hull.step", "hull.igs"])
@pytest.mark.parametrize("text", ["", "nonsense", "ISO-10303-21;\nHEADER;"])
def test_what_is_no_cad_file_is_one_line(tmp_path, ship, name, text):
    pytest.importorskip("cascadio")
    (tmp_path / name).write_text(text)
    kind = "IGES" if name.endswith("igs") else "STEP"
    with pytest.raises(ConfigError, match=f"{name}: no {kind} file with surfaces") as error:
        read_hull(tmp_path / name, ship)
    assert "\n" not in str(error.value)


def test_a_reader_that_dies_is_one_line(tmp_path, ship, monkeypatch):
    """OpenCASCADE ends its process at some damaged files."""
    pytest.importorskip("cascadio")
    monkeypatch.setattr(hull_cad, "_CHILD", "import os; os.abort()")
    (tmp_path / "hull.stp").write_text(FILES["metres.stp"])
    with pytest.raises(ConfigError, match=r"hull.stp: no STEP file with surfaces, or damaged"):
        read_hull(tmp_path / "hull.stp", ship)
    monkeypatch.setattr(hull_cad, "_CHILD", "import time; time.sleep(30)")
    monkeypatch.setattr(hull_cad, "_SECONDS", 0.5)
    with pytest.raises(ConfigError, match=r"hull.stp: OpenCASCADE did not read it within 0.5 s"):
        read_hull(tmp_path / "hull.stp", ship)


def test_without_the_library_the_extra_is_named(tmp_path, ship, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "cascadio", None)
    (tmp_path / "hull.stp").write_text(FILES["metres.stp"])
    with pytest.raises(ConfigError, match=r'pip install "ship-gym\[cad\]"'):
        read_hull(tmp_path / "hull.stp", ship)
