"""Pictures: written whole or not at all, without touching the user's matplotlib."""

from __future__ import annotations

import subprocess
import sys

import matplotlib
import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.plotting import figure, plot_manoeuvre, plot_surrogate
from ship_gym.plotting.surrogate import response, side_force
from ship_gym.reports.case import sail
from ship_gym.ships.loader import load_ship
from ship_gym.surrogates.fit import KCS_SAMPLES, TRAINING, VALIDATION, read_csv, sample_set


def rows(points):
    return sample_set(read_csv(KCS_SAMPLES), "G2", "SA", points)


@pytest.fixture(scope="module")
def zigzag():
    return sail(load_ship("kcs_model"), "zigzag")


def is_picture(path) -> bool:
    data = path.read_bytes()
    return data[:4] == b"\x89PNG" and 15_000 < len(data) < 250_000


@pytest.mark.parametrize("delta_deg", [-35.0, 20.0])  # with a trial, and without
def test_turning_circle(tmp_path, delta_deg):
    path = tmp_path / "new" / "circle.png"
    plot_manoeuvre(sail(load_ship("kcs_model"), delta_deg=delta_deg), path)
    assert is_picture(path)


def test_zigzag_in_a_sea(tmp_path):
    case = sail(load_ship("kcs_model"), "zigzag", sea="current")
    plot_manoeuvre(case, tmp_path / "zigzag.png")
    assert is_picture(tmp_path / "zigzag.png")


def test_surrogate(tmp_path):
    plot_surrogate(load_ship("kcs_model"), tmp_path / "s.png", rows(TRAINING), rows(VALIDATION))
    assert is_picture(tmp_path / "s.png")
    with pytest.raises(ConfigError, match="no surrogate"):
        plot_surrogate(load_ship("kvlcc2_model"), tmp_path / "none.png")
    assert not (tmp_path / "none.png").exists()


def test_surfaces_are_those_of_the_samples():
    """The kernels give the printed CFD values back within the error that the thesis prints."""
    samples, ship = rows(VALIDATION), load_ship("kcs_model")
    for i in range(4):
        found = response(ship, samples.columns["J"][i], np.radians(samples.columns["beta"][i]))
        for name, value in zip(("K_T", "10K_Q", "C_Fx", "C_Fy"), found, strict=True):
            assert value == pytest.approx(samples.columns[name][i], rel=0.07), name


def test_side_force_is_mirrored_by_the_rudder():
    force = side_force(load_ship("kcs_model"), np.radians([-20.0, 0.0, 20.0]), 0.0)
    assert force[1] == pytest.approx(0.0, abs=1e-12)
    assert force[0] == pytest.approx(-force[2])
    assert force[2] < 0.0  # starboard rudder pushes the stern to port


def test_an_interrupted_write_leaves_the_old_picture(tmp_path, zigzag, monkeypatch):
    path = tmp_path / "zigzag.png"
    plot_manoeuvre(zigzag, path)
    before = path.read_bytes()

    def breaks(made, temporary):
        temporary.write_bytes(b"half")
        raise KeyboardInterrupt

    monkeypatch.setattr(figure, "_write", breaks)
    with pytest.raises(KeyboardInterrupt):
        plot_manoeuvre(zigzag, path)
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_users_matplotlib_is_left_alone(tmp_path, zigzag):
    with matplotlib.rc_context({"font.size": 33.0, "axes.grid": False}):
        before = dict(matplotlib.rcParams)
        plot_manoeuvre(zigzag, tmp_path / "a.png")
        assert dict(matplotlib.rcParams) == before
    plot_manoeuvre(zigzag, tmp_path / "b.png")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_pyplot_is_never_imported():
    code = "import sys, ship_gym.plotting; sys.exit('matplotlib.pyplot' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
