"""Headroom of a cell, and the file of the reference values."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from ship_gym_agents import make_controller

from ship_gym.config import ConfigError
from ship_gym.evaluation import headroom
from ship_gym.evaluation.headroom import Cell, measure_cell, relative, separates
from ship_gym.evaluation.score import read_references
from ship_gym.evaluation.statistics import Estimate, Paired
from ship_gym.scenarios.scenario import load_scenario

SHORT = {"base": "heading_ss5_beam", "duration": 180.0}
CELL = Cell(
    measure="J_steady",
    nothing=10.0,
    reference=2.0,
    reference_controller="pid",
    second=2.5,
    second_controller="lqg",
    difference=Paired(0.5, 0.2, 0.8, 0.01),
    optimum=1.0,
    optimum_kind="gauss-newton plan",
    optimum_seeds=32,
    headroom=Estimate(50.0, 40.0, 60.0),
    separates=True,
    inputs="abc",
)


def test_relative_by_hand():
    reference = np.array([1.0, 2.0, 4.0, 100.0])  # middles of four: without lowest and highest
    values = np.array([0.5, 1.0, 2.0, 0.0])  # 0.75 against 3
    assert relative(values, reference).value == pytest.approx(75.0)
    half = relative(0.5 * reference, reference)
    assert (half.value, half.low, half.high) == pytest.approx((50.0, 50.0, 50.0))
    assert relative(values[:1], reference[:1]) == Estimate(50.0, None, None)


def test_interval_of_the_headroom_is_paired():
    rng = np.random.default_rng(1)
    reference = np.exp(rng.standard_normal(64))
    values = reference * (0.7 + 0.02 * rng.standard_normal(64))
    found = relative(values, reference)
    assert found.low < 30.0 < found.high and found.high - found.low < 3.0


@pytest.mark.parametrize(
    ("difference", "room", "expected"),
    [
        (Paired(0.5, 0.2, 0.8, 0.01), None, True),
        (Paired(0.5, -0.2, 0.8, 0.4), None, False),
        (None, Estimate(20.0, 6.0, 30.0), True),
        (None, Estimate(20.0, 4.0, 30.0), False),  # the search starts at the reference
        (Paired(-0.5, -0.8, -0.2, 0.01), Estimate(1.0, 0.5, 2.0), True),
    ],
)
def test_what_separates(difference, room, expected):
    assert separates(difference, room) == expected


def test_file_is_read_as_it_was_written(tmp_path):
    path = tmp_path / "cells.json"
    headroom.write({"heading_keeping/kcs": dataclasses.asdict(CELL)}, path)
    found = read_references(path).of("heading_keeping", "kcs")
    assert (found.reference, found.optimum, found.headroom) == (2.0, 1.0, CELL.headroom)
    assert headroom.read(path) == {"heading_keeping/kcs": dataclasses.asdict(CELL)}
    assert headroom.read(tmp_path / "none.json") == {}


def test_inputs_change_with_what_a_cell_depends_on(tmp_path):
    gains = tmp_path / "pid_kcs.toml"
    gains.write_text("K_p = 1")
    scenario = load_scenario("heading_keeping")
    first = headroom.inputs_of(scenario, "J_steady", ["pid", "lqg"], [gains])
    assert first == headroom.inputs_of(scenario, "J_steady", ["lqg", "pid"], [gains])
    other = load_scenario("heading_keeping", {"ship": "onrt"})
    changed = {
        headroom.inputs_of(other, "J_steady", ["pid", "lqg"], [gains]),
        headroom.inputs_of(scenario, "J_0.1", ["pid", "lqg"], [gains]),
        headroom.inputs_of(scenario, "J_steady", ["pid"], [gains]),
    }
    gains.write_text("K_p = 2")
    changed.add(headroom.inputs_of(scenario, "J_steady", ["pid", "lqg"], [gains]))
    assert first not in changed and len(changed) == 4


def test_a_cell():
    made = {name: (lambda name=name: make_controller(name)) for name in ("pid", "lqg", "ilos")}
    cell = measure_cell(made, SHORT, "kcs", judged=4, optimised=2, iterations=1)
    assert cell.measure == "J_steady" and cell.optimum_kind == "gauss-newton plan"
    assert {cell.reference_controller, cell.second_controller} == {"pid", "lqg"}, (
        "ilos needs a track"
    )
    assert cell.optimum_seeds == 2 and 0.0 <= cell.headroom.value < 100.0
    assert cell.optimum == pytest.approx(cell.reference * (1.0 - cell.headroom.value / 100.0))
    assert cell.nothing > cell.reference


def test_a_measure_without_an_optimum():
    made = {"pid": lambda: make_controller("pid")}
    cell = measure_cell(made, SHORT, "kcs", "energy", judged=2)
    assert (cell.optimum, cell.optimum_kind, cell.headroom, cell.second) == (None,) * 4
    assert not cell.separates and math.isfinite(cell.nothing)


def test_refusals():
    with pytest.raises(ConfigError, match=r"no classical controller sails .*: .*cross_track"):
        measure_cell({"ilos": lambda: make_controller("ilos")}, SHORT, "kcs", judged=2)
    with pytest.raises(ConfigError, match="measure 'success': more of it is better"):
        measure_cell({"pid": lambda: make_controller("pid")}, SHORT, "kcs", "success", judged=2)
