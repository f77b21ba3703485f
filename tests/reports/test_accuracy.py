"""Work-precision report: what is sailed, what counts as error, tables and page."""

from __future__ import annotations

import importlib
import json
import sys
from pathlib import Path

import numpy as np
import pytest

from pages.marks import write_tables
from ship_gym.reports import accuracy
from ship_gym.reports.accuracy import (
    Point,
    conditions,
    default_step,
    jobs,
    measure,
    sail,
)
from ship_gym.ships.files import available_ships
from ship_gym.ships.loader import load_ship
from ship_gym.simulation import ShipSim, longest_step

ROOT = Path(__file__).parents[2]
CONDITIONS = {condition.name: condition for condition in conditions()}


@pytest.fixture
def short(monkeypatch):
    """Runs of two legs of three ships."""
    monkeypatch.setattr(accuracy, "LEGS", 2)
    monkeypatch.setattr(accuracy, "SHIPS", 3)


@pytest.mark.parametrize("name", available_ships())
def test_the_default_step_divides_a_second(name):
    ship = load_ship(name)
    step = default_step(ship)
    assert step <= longest_step(ship) and (1.0 / step) == pytest.approx(round(1.0 / step))


def test_another_longest_step_changes_nothing_else():
    ship = load_ship("onrt_model")
    states = []
    for factor in (1.0, 2.0):
        sim = ShipSim(ship, 1, CONDITIONS["ahead"].sea.scaled(ship.scale))
        sim.longest *= factor
        sim.reset(0, speed=ship.speed)
        for _ in range(8):
            sim.step(np.array([[0.3, sim.state[0, -1]]]), 0.5 * default_step(ship))
        states.append(sim.state)
    np.testing.assert_array_equal(*states)


def test_runs_are_repeatable_and_turn(short):
    ship = load_ship("kcs")
    for condition in CONDITIONS.values():
        psi, seconds = sail(ship, condition, 0.5)
        again, _ = sail(ship, condition, 0.5)
        np.testing.assert_array_equal(psi, again)
        assert psi.shape == (2, 3) and (np.abs(psi) > 0.0).all() and seconds > 0.0


def test_errors_shrink_with_the_step(short):
    coarse, fine = measure(load_ship("kcs"), CONDITIONS["calm"], fractions=[2.0, 0.25])
    assert coarse.step == 8.0 * fine.step == 2.0
    assert 0.0 < fine.largest < 0.2 * coarse.largest
    for point in (coarse, fine):
        assert 0.0 <= point.median <= point.ninety <= point.largest
    assert fine.seconds > 0.0 and coarse.seconds > 0.0


def test_headings_all_round_and_rudders_held():
    ahead, anywhere, calm = (CONDITIONS[k] for k in ("ahead", "anywhere", "calm"))
    assert anywhere.any_heading and not ahead.any_heading
    assert calm.redrawn and not ahead.redrawn
    assert ahead.sea.gusts and len(ahead.sea.components().omega) == 60


def test_every_ship_in_every_condition_she_can_meet():
    found = [(ship.name, condition.name) for ship, condition in jobs()]
    assert len(found) == len(set(found)) == len(available_ships()) * len(CONDITIONS)
    assert {condition.name for _, condition in jobs(["dtc"])} == set(CONDITIONS)


POINTS = [
    Point("kcs", "calm", 2.0, 2.0, 0.0412, 0.0987, 0.2, 0.8e-6),
    Point("kcs", "calm", 1.0, 1.0, 0.0103, 0.0456, 0.1, 1.6e-6),
]


def test_tables():
    text = accuracy.as_text(POINTS)
    assert "0.0103" in text and "0.041 / 0.099 / 0.8" in text and "sea state" not in text
    found = accuracy.tables(POINTS, markdown=True)
    assert set(found) == {"default", "calm"} and "0.0412" not in found["default"]
    assert found["calm"].splitlines()[0] == "| ship | 2 | 1 |"


def test_the_page_has_a_mark_for_every_table(tmp_path):
    page = tmp_path / "accuracy.md"
    page.write_text((ROOT / "docs" / "accuracy.md").read_text("utf-8"), encoding="utf-8")
    names = ("where", "default", *CONDITIONS)
    write_tables(page, {name: f"table {name}" for name in names})
    assert all(f"\n\ntable {name}\n\n" in page.read_text("utf-8") for name in names)
    with pytest.raises(ValueError, match="no marks <!-- other -->"):
        write_tables(page, {"other": ""})


def test_picture(tmp_path):
    pytest.importorskip("matplotlib")
    from ship_gym.plotting.accuracy import plot_accuracy

    plot_accuracy(POINTS, tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes()[:4] == b"\x89PNG"


@pytest.fixture
def script(monkeypatch, capsys):
    """Run measure_accuracy in this process: exit code, stdout, stderr."""
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))

    def call(*args):
        monkeypatch.setattr(sys, "argv", ["measure_accuracy.py", *args])
        code = 0
        try:
            importlib.import_module("_cli").run(importlib.import_module("measure_accuracy").main)
        except SystemExit as stop:
            code = stop.code or 0
        return code, *capsys.readouterr()

    yield call
    for name in ("_cli", "measure_accuracy"):
        sys.modules.pop(name, None)


def test_script(script, short):
    code, out, _ = script("--help")
    assert code == 0 and out.split("examples:")[1].count("python scripts/measure_accuracy.py") == 2
    code, out, _ = script("kvlcc2_model", "--json")
    data = json.loads(out)
    assert code == 0 and data["files"] == [] and len(data["points"]) == 3 * 5
    assert {point["ship"] for point in data["points"]} == {"kvlcc2_model"}


def test_refusals_in_one_line(script):
    code, out, err = script("no_ship")
    assert (code, out) == (2, "") and "no_ship" in err and err.count("\n") == 1
    code, _, err = script("kcs", "--write")
    assert code == 2 and "--write is for all ships" in err
