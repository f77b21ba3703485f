"""The example of docs/cosimulation.md sails as the page says."""

import json
import math
import runpy
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("fmpy")
pytest.importorskip("pythonfmu")

from ship_gym.manoeuvres import zigzag
from ship_gym.ships.loader import load_ship
from ship_gym.simulation import self_propulsion

DOCS = Path(__file__).parents[2] / "docs"


def example(monkeypatch, capsys, *arguments):
    monkeypatch.setattr(sys, "argv", ["fmu_zigzag.py", *arguments])
    runpy.run_path(str(DOCS / "examples" / "fmu_zigzag.py"), run_name="__main__")
    return capsys.readouterr().out


def test_it_says_what_the_page_shows(monkeypatch, tmp_path, capsys):
    monkeypatch.chdir(tmp_path)
    out = example(monkeypatch, capsys)
    assert out in (DOCS / "cosimulation.md").read_text(encoding="utf-8")


def test_its_overshoots_are_those_of_the_manoeuvre(monkeypatch, tmp_path, capsys):
    monkeypatch.chdir(tmp_path)
    found = json.loads(example(monkeypatch, capsys, "--sea", "calm", "--json"))
    assert found["same_bits"] and found["steps"] == 1200
    ship, angle = load_ship("kcs"), math.radians(20.0)
    result = zigzag(ship, angle, angle, ship.speed, self_propulsion(ship, ship.speed))
    expected = np.degrees(result.overshoots[: len(found["overshoots_deg"])])
    assert len(expected) >= 2
    # the example looks every 0.5 s and turns up to 0.5 s later: at 0.7 deg/s some 0.4 deg
    assert found["overshoots_deg"] == pytest.approx(expected.tolist(), abs=0.5)
