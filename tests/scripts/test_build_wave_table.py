"""The script build_wave_table: what it computes, writes, prints and refuses."""

from __future__ import annotations

import functools
import importlib
import json
import re
from pathlib import Path

import numpy as np
import pytest

from ship_gym.reports.page import Picture
from ship_gym.sea.wave_table import WaveTable
from ship_gym.seakeeping import database, hull_form
from ship_gym.seakeeping.database import Grid
from ship_gym.seakeeping.hull_form import parametric_mesh
from ship_gym.seakeeping.hull_mesh import capytaine_axes
from ship_gym.ships import load_ship
from ship_gym.ships.files import DATA

NAME = "build_wave_table.py"
SHIPPED = DATA / "kcs_model" / "waves.npz"
TINY = Grid((0.0, 0.15, 0.26, 0.30), 3, 2, longest=2.0, shortest=0.5, encounter=3)


@pytest.fixture
def call(call, monkeypatch):
    """Run the script on a tiny grid; gives exit code, stdout and stderr."""
    monkeypatch.setattr(database, "QUICK", TINY)
    return functools.partial(call, NAME)


@pytest.fixture
def grids(monkeypatch):
    """Grids asked for; nothing is computed, the shipped table of KCS comes back."""
    seen = []

    def build(ship, mesh, path, grid, jobs, progress):
        seen.append(grid)
        table = WaveTable.load(SHIPPED)
        table.save(path)
        return table

    monkeypatch.setattr(database, "build", build)
    for library in ("capytaine", "joblib"):
        pytest.importorskip(library)
    return seen


@pytest.fixture
def no_drawing(monkeypatch):
    """Pictures are drawn in tests/plotting/test_waves.py."""
    waves = importlib.import_module("ship_gym.plotting.waves")
    monkeypatch.setattr(waves, "for_page", lambda caption, draw: Picture(caption, b"\x89PNG"))


def test_help_shows_examples(call):
    code, out, _ = call("--help")
    assert code == 0 and f"python scripts/{NAME} --ship kcs_model --report" in out


def test_quick_computes_a_table_and_its_page(call, no_drawing, monkeypatch):
    monkeypatch.setattr(
        hull_form, "parametric_mesh", lambda ship, *size: parametric_mesh(ship, 16, 4)
    )
    for library in ("capytaine", "joblib"):
        pytest.importorskip(library)
    code, out, err = call("--ship", "kvlcc2_model", "--quick", "--jobs", "1", "--report")
    assert (code, err) == (0, "")
    table = WaveTable.load("runs/waves_kvlcc2_model.npz")
    np.testing.assert_array_equal(table.froude, [0.0, 0.15, 0.26])  # its engine holds 0.17
    assert "128 panels" in out and "wrote runs/waves_kvlcc2_model.html" in out
    page = Path("runs/waves_kvlcc2_model.html").read_text()
    assert "KVLCC2" in page and page.count("data:image/png") == 5
    assert sorted(p.name for p in Path("runs").iterdir()) == [
        "waves_kvlcc2_model.html",
        "waves_kvlcc2_model.npz",
    ]


@pytest.mark.parametrize(
    "arguments, last",
    [
        (["--ship", "kvlcc2_model"], 0.20),
        (["--ship", "kcs_model"], 0.30),
        (["--ship", "kcs_model", "--froude", "0.12"], 0.15),
    ],
)
def test_speeds_end_where_the_engine_does_or_at_a_given_speed(call, grids, arguments, last):
    assert call(*arguments)[0] == 0
    assert [grid.froude[-1] for grid in grids] == [last]


HULL = parametric_mesh(load_ship("kcs"))


def write_gdf(path, inward=False):
    """KCS at full scale, its normals outward or inward."""
    vertices, panels = capytaine_axes(HULL.both_sides())
    corners = vertices[panels[:, ::-1] if inward else panels].reshape(-1, 3)
    lines = [" ".join(f"{x:.9g}" for x in corner) for corner in corners]
    Path(path).write_text("\n".join(["KCS", "1 9.81", "0 0", str(len(panels)), *lines]) + "\n")


def test_the_repair_that_a_message_names_is_an_option(call, grids, monkeypatch):
    """Each message is followed to the next until the hull is taken."""
    seen = []
    build = database.build
    monkeypatch.setattr(
        database, "build", lambda s, mesh, *a: (seen.append(mesh), build(s, mesh, *a))[1]
    )
    write_gdf("hull.gdf", inward=True)
    text = Path("hull.gdf").read_text().splitlines()
    points = [[1000.0 * float(x) for x in line.split()] for line in text[4:]]
    moved = [f"{x + 1e5} {y} {z + 11000}" for x, y, z in points]
    Path("hull.gdf").write_text("\n".join([*text[:4], *moved]) + "\n")
    given = ["--ship", "kcs", "--mesh", "hull.gdf", "--panels", "own"]
    for option in ("--scale", "--waterline", "--midship", "--flip-normals"):
        code, _, err = call(*given)
        assert code == 2 and err.count("\n") == 1 and not seen
        name, value = re.search(rf"({option})(?: (-?[0-9.]+))?", err).groups()
        if option == "--midship":  # of the perpendiculars: the message says about
            assert float(re.search(r"about ([0-9.]+)", err)[1]) == pytest.approx(100.0, abs=4.0)
            value = "100"
        given += [name, value] if value else [name]
    code, _, err = call(*given)
    assert (code, err) == (0, "") and seen[0].count == HULL.count
    assert given[6:8] == ["--scale", "0.001"] and given[10:] == [
        "--midship",
        "100",
        "--flip-normals",
    ]
    assert float(given[9]) == pytest.approx(11.0, abs=1e-4)


def test_json_has_the_card_and_the_comparison(call, grids):
    code, out, _ = call("--json", "--out", "there.npz")
    facts = json.loads(out)
    assert code == 0 and facts["file"] == "there.npz" and facts["files"] == ["there.npz"]
    assert facts["panels"] == 712 and len(facts["snnm"]["rms"]["0.26"]) == 13


def test_from_reports_on_a_table_without_computing(call, grids, no_drawing, monkeypatch):
    cli = importlib.import_module("ship_gym_agents.cli.output")
    there = cli.find_spec
    monkeypatch.setattr(cli, "find_spec", lambda n: None if n == "capytaine" else there(n))
    code, out, _ = call("--from", str(SHIPPED), "--report", "page.html")
    assert code == 0 and not grids
    assert "kcs_model: 712 panels" in out and "wrote page.html" in out
    assert [p.name for p in Path().iterdir()] == ["page.html"]


def test_from_a_users_hull_goes_without_its_panels(call, no_drawing):
    table = WaveTable.load(SHIPPED)
    table.card["mesh"] = ["my.stl: 10000 faces"]
    table.save("mine.npz")
    code, _, err = call("--from", "mine.npz", "--report")
    assert (code, err) == (0, "")
    page = Path("mine.html").read_text()
    assert "not at hand" in page and page.count("data:image/png") == 4


@pytest.mark.parametrize("library, extra", [("capytaine", "bem"), ("joblib", "bem")])
def test_a_missing_library_is_one_line_before_any_work(call, monkeypatch, library, extra):
    cli = importlib.import_module("ship_gym_agents.cli.output")
    there = cli.find_spec
    monkeypatch.setattr(cli, "find_spec", lambda n: None if n == library else there(n))
    code, _, err = call()
    assert code == 2 and f'pip install "ship-gym[{extra}]"' in err and err.count("\n") == 1
    assert not list(Path().iterdir())


def test_a_page_without_matplotlib_is_refused_before_any_work(call, grids, monkeypatch):
    cli = importlib.import_module("ship_gym_agents.cli.output")
    there = cli.find_spec
    monkeypatch.setattr(cli, "find_spec", lambda n: None if n == "matplotlib" else there(n))
    code, _, err = call("--report")
    assert code == 2 and 'pip install "ship-gym[plot]"' in err and not grids


@pytest.mark.parametrize(
    "arguments, message",
    [
        (["--ship", "kcs_modell"], "kcs_model"),
        (["--mesh", "none.stl"], "none.stl: no such file"),
        (["--mesh", "bad.stl"], "bad.stl"),
        (["--mesh", "bad.stl", "--panels", "some"], "--panels = some: must be a whole number, or"),
        (["--mesh", "bad.stl", "--panels", "3"], "--panels = 3: allowed is 40 to 20000"),
        (["--mesh", "bad.stl", "--weld", "-1"], "--weld = -1: allowed is 0 to"),
        (["--flip-normals"], "--flip-normals: belongs to a hull file: name it with --mesh"),
        (["--scale", "2"], "--scale: belongs to a hull file"),
        (["--froude", "-0.1"], "froude = -0.1"),
        (["--froude", "nan"], "froude = nan"),
        (["--from", "none.npz"], "none.npz: no such wave table"),
        (["--from", "bad.stl"], "not a wave table"),
        (["--from", str(SHIPPED), "--quick"], "--quick and --froude belong to computing"),
        (["--from", str(SHIPPED), "--ship", "s175"], "made for kcs_model, not for s175"),
    ],
)
def test_bad_input_is_one_line_before_any_work(call, grids, arguments, message):
    if "--mesh" in arguments:
        pytest.importorskip("trimesh")
    Path("bad.stl").write_text("solid nothing\nendsolid nothing\n")
    code, _, err = call(*arguments)
    assert code == 2 and message in err and err.count("\n") == 1
    assert not grids and [p.name for p in Path().iterdir()] == ["bad.stl"]


def test_from_with_another_mesh_is_refused(call):
    table = WaveTable.load(SHIPPED)
    table.card["mesh"] = ["parametric hull of kcs_model: 60 x 10 panels per side"]
    table.save("fine.npz")
    code, _, err = call("--from", "fine.npz", "--report")
    assert code == 2 and "made with another mesh: parametric hull of kcs_model: 60 x 10" in err
