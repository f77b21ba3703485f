"""A recording as parquet keeps every bit and its meta."""

from __future__ import annotations

import json

import numpy as np
import pytest

from ship_gym.evaluation.trajectory_table import META, write_parquet
from ship_gym.recording import Trajectory

parquet = pytest.importorskip("pyarrow.parquet")


def test_bits_and_meta_come_back(tmp_path):
    values = np.random.default_rng(1).normal(size=9)
    run = Trajectory({"t": np.arange(9.0), "r'": values}, {"seed": 2**60, "ship": {"name": "kcs"}})
    write_parquet(run, tmp_path / "new" / "run.parquet")
    table = parquet.read_table(tmp_path / "new" / "run.parquet")
    assert table.column_names == ["t", "r'"]
    assert table["r'"].to_numpy().tobytes() == values.tobytes()
    assert json.loads(table.schema.metadata[META]) == run.meta
