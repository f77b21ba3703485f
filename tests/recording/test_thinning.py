"""A thinned run keeps its first and last rows, its pace, and the moment of each order."""

from __future__ import annotations

import numpy as np
import pytest

from ship_gym.recording import Trajectory
from ship_gym.recording.thinning import thinned

ROWS = 1003


def full() -> Trajectory:
    t = 0.1 * np.arange(ROWS)
    order = np.where(t < 33.33, 0.0, 0.5)
    columns = {"t": t, "x": np.sin(t), "delta_command": order, "n_command": 0.0 * t + 1.4}
    return Trajectory(columns, {"seed": 1})


def test_rows_are_kept_at_the_interval_and_round_orders():
    run, kept = full(), thinned(full(), 1.0)
    assert kept.meta == {"seed": 1, "interval": pytest.approx(1.0)}
    rows = np.searchsorted(run["t"], kept["t"])
    assert set(rows) == {*range(0, ROWS, 10), ROWS - 1, 333, 334}
    assert kept["x"].tobytes() == run["x"][rows].tobytes()
    assert kept["delta_command"][list(rows).index(333)] == 0.0
    assert kept["delta_command"][list(rows).index(334)] == 0.5


def test_a_long_run_gets_fewer_rows_and_a_coarse_one_keeps_its_own():
    assert len(thinned(full(), 1.0, most=21)) == pytest.approx(21, abs=3)
    coarse = thinned(full(), 1.0, most=21)
    assert coarse.meta["interval"] > 1.0
    assert thinned(full(), 0.19)["t"].tolist() == full()["t"].tolist()  # never coarser than asked
    assert len(thinned(Trajectory({"t": [0.0]}), 1.0)) == 1
