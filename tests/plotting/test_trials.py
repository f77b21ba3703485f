"""Pictures of trials: all differences, and error bars on a circle."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from PIL import Image

from ship_gym.plotting import plot_manoeuvre
from ship_gym.plotting.seaway import plot_turning_in_waves
from ship_gym.plotting.trials import plot_trials
from ship_gym.reports.case import sail_trial
from ship_gym.reports.measures import Row
from ship_gym.reports.trials import Comparison
from ship_gym.ships.loader import load_ship


def changed(first, second) -> int:
    """Pixels of the plan, the left half of the upper part, in which two pictures differ."""
    pair = (np.asarray(Image.open(path).convert("RGB"), int) for path in (first, second))
    one, two = (pixels[100 : len(pixels) * 3 // 5, : pixels.shape[1] // 2] for pixels in pair)
    return int((np.abs(one - two).max(axis=-1) > 8).sum())


def test_all_trials_with_and_without_another_time(tmp_path):
    row = Row("advance", 3.1, 3.0, deviation=0.1)
    far = dataclasses.replace(row, computed=9.0, deviation=None)
    direction = Row("drift_direction", 100.0, 90.0)
    found = [Comparison("ship", name, r) for name in ("a", "b") for r in (row, far, direction)]
    plot_trials(found, tmp_path / "now.png")
    old = [dataclasses.replace(c, before=dataclasses.replace(c.row, computed=2.5)) for c in found]
    plot_trials(old, tmp_path / "then.png")
    pictures = [(tmp_path / name).read_bytes() for name in ("now.png", "then.png")]
    assert all(data[:4] == b"\x89PNG" for data in pictures) and pictures[0] != pictures[1]


@pytest.mark.slow
def test_scatter_is_drawn_on_the_circle(tmp_path):
    ship = load_ship("kcs_model")
    case = sail_trial(ship, ship.trials[2])
    plot_manoeuvre(case, tmp_path / "bars.png")
    plain = dataclasses.replace(case, trial=dataclasses.replace(case.trial, deviation={}))
    plot_manoeuvre(plain, tmp_path / "plain.png")
    assert changed(tmp_path / "bars.png", tmp_path / "plain.png") > 300  # bars and band


@pytest.mark.slow
def test_measured_drift_is_drawn_in_waves(tmp_path):
    ship = load_ship("onrt_model")
    case = sail_trial(ship, ship.trials[0])
    plot_turning_in_waves(case, tmp_path / "drift.png")
    plot_turning_in_waves(dataclasses.replace(case, trial=None), tmp_path / "plain.png")
    assert changed(tmp_path / "drift.png", tmp_path / "plain.png") > 50  # an arrow
