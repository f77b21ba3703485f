"""A Trajectory says clearly what is wrong with its data, and keeps what is right exactly."""

from __future__ import annotations

import csv
import json
import pickle
import subprocess
import sys

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.recording import Trajectory

T = np.array([0.0, 0.1, 0.3])


def test_access_order_and_conversion():
    run = Trajectory({"psi": [1, 2, 3], "t": T, "alarm": [True, False, True]}, {"seed": 4})
    assert run.names == ["t", "psi", "alarm"]
    assert len(run) == 3
    assert "psi" in run
    assert "u" not in run
    assert all(run[name].dtype == np.float64 for name in run.names)
    assert run["alarm"].tolist() == [1.0, 0.0, 1.0]
    with pytest.raises(KeyError, match="no column 'u'"):
        run["u"]


def test_columns_are_read_only_copies():
    psi = np.zeros(3)
    run = Trajectory({"t": T, "psi": psi})
    psi[0] = 1.0
    assert run["psi"][0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        run["psi"][0] = 1.0


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"psi": T}, "needs a column 't'"),
        ({}, "needs a column 't'"),
        ({"t": T, "psi": [0.0, 1.0]}, "'psi' has 2 rows, but 't' has 3"),
        ({"t": T, "name": ["a", "b", "c"]}, "'name' is not numeric"),
        ({"t": T, "u": [1.0, None, 2.0]}, "'u' is not numeric"),
        ({"t": T, "u": [1j, 2j, 3j]}, "'u' is not numeric"),
        ({"t": T, "u": [1.0, np.nan, np.inf]}, "'u' is nan in row 1"),
        ({"t": T, "u": [1.0, 2.0, -np.inf]}, "'u' is -inf in row 2"),
        ({"t": T, "u": np.zeros((3, 2))}, r"'u' has shape \(3, 2\)"),
        ({"t": [0.0, 1.0, 1.0]}, "'t' does not increase at row 2"),
        ({"t": []}, "at least one row"),
        ({"t": T, "": T}, "non-empty"),
        ({"t": T, "a\nb": T}, "printable"),
        ({"t": T, 3: T}, "strings"),
    ],
)
def test_bad_columns_are_named(columns, message):
    with pytest.raises(ValueError, match=message):
        Trajectory(columns)


@pytest.mark.parametrize(
    ("meta", "message"),
    [
        ({"a": {"b": [1.0, float("nan")]}}, r"meta\['a'\]\['b'\]\[1\] is nan"),
        ({"a": {1: 2}}, r"meta\['a'\] has a key that is not a string: 1"),
        ({"a": object()}, r"meta\['a'\] is a object"),
    ],
)
def test_bad_meta_is_named(meta, message):
    with pytest.raises(ValueError, match=message):
        Trajectory({"t": T}, meta)


def test_meta_becomes_plain():
    meta = {"x": np.float64(0.1), "n": np.int32(3), "v": np.arange(2), "t": (1, None), "b": True}
    run = Trajectory({"t": T}, meta)
    assert run.meta == {"x": 0.1, "n": 3, "v": [0, 1], "t": [1, None], "b": True}
    assert json.loads(json.dumps(run.meta)) == run.meta


def test_pickle_round_trip():
    run = Trajectory({"t": T, "psi": T**2}, {"seed": 1})
    again = pickle.loads(pickle.dumps(run))
    assert again.meta == run.meta
    assert again["psi"].tobytes() == run["psi"].tobytes()


def test_csv_holds_meta_and_exact_numbers(tmp_path):
    values = [0.1 + 0.2, -5e-324, 1.7976931348623157e308]
    run = Trajectory({"t": T, 'odd, "name"': values}, {"ship": {"name": "kcs"}, "seed": 3})
    run.to_csv(tmp_path / "new folder" / "run.csv")
    lines = (tmp_path / "new folder" / "run.csv").read_text().splitlines()
    head = [line[2:] for line in lines if line.startswith("# ")]
    assert json.loads("\n".join(head[1:])) == run.meta
    rows = list(csv.reader(lines[len(head) :]))
    assert rows[0] == run.names
    assert np.array(rows[1:], dtype=float)[:, 1].tolist() == values


def test_missing_rerun_says_what_to_install(tmp_path, monkeypatch):
    import ship_gym.recording as recording

    monkeypatch.delattr(recording, "rerun_export", raising=False)
    for name in [k for k in sys.modules if k.startswith("ship_gym.recording.rerun_export")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(ImportError, match=r'pip install "ship-gym\[rerun\]"'):
        Trajectory({"t": T}).to_rrd(tmp_path / "run.rrd")
    with pytest.raises(ImportError, match=r'pip install "ship-gym\[rerun\]"'):
        Trajectory.from_rrd(tmp_path / "run.rrd")


def test_import_leaves_rerun_alone():
    code = "import sys, ship_gym.recording; sys.exit('rerun' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize("name", ["run.csv", "run.txt", "run", "run.rrd.partial"])
def test_the_extension_says_the_format(tmp_path, name):
    run = Trajectory({"t": T})
    with pytest.raises(ConfigError, match=r"allowed is a \.rrd file"):
        run.to_rrd(tmp_path / name)
    if name != "run.csv":
        with pytest.raises(ConfigError, match=r"allowed is a \.csv file"):
            run.to_csv(tmp_path / name)
    assert not list(tmp_path.iterdir())
