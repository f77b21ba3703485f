"""Pictures: written whole or not at all, without touching the user's matplotlib."""

from __future__ import annotations

import subprocess
import sys

import matplotlib
import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.plotting import figure, plot_manoeuvre, plot_surrogate
from ship_gym.plotting.surrogate_maps import response, side_force
from ship_gym.plotting.surrogate_report import write_surrogate_report
from ship_gym.reports import surrogate as surrogate_report
from ship_gym.reports.case import sail
from ship_gym.ships.loader import attach_surrogate, load_ship
from ship_gym.surrogates.fit import fit
from ship_gym.surrogates.force_table import table_of
from ship_gym.surrogates.samples import KCS, ONRT


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


def attached(data, grid=None, turbulence=""):
    """Fit of a regression, and its ship with the table attached."""
    found = fit(data, None, grid, turbulence)
    ship = load_ship(data.ship, surrogate="none")
    return found, attach_surrogate(ship, table_of(found, ship), found.name)


@pytest.fixture(scope="module", params=[KCS, ONRT], ids=lambda data: data.name)
def surrogate(request):
    return attached(request.param)


SLOW_ONRT = pytest.param(ONRT, marks=pytest.mark.slow)


@pytest.mark.parametrize("data", [KCS, SLOW_ONRT], ids=["kcs", "onrt"])
def test_surrogate(tmp_path, data):
    found, ship = attached(data)
    plot_surrogate(ship, tmp_path / "s.png", found)
    assert is_picture(tmp_path / "s.png")


def test_a_ship_without_surrogate_is_refused(tmp_path):
    with pytest.raises(ConfigError, match="no surrogate"):
        plot_surrogate(load_ship("kvlcc2_model"), tmp_path / "none.png")
    assert not (tmp_path / "none.png").exists()


@pytest.mark.slow
@pytest.mark.parametrize("data", [KCS, ONRT], ids=lambda data: data.name)
def test_surrogate_page(tmp_path, data):
    found, ship = attached(data)
    facts = surrogate_report.as_dict(found, ship.surrogate)
    write_surrogate_report(tmp_path / "s.html", found, ship, facts)
    text = (tmp_path / "s.html").read_text()
    assert text.count("<img") == 3 * len(found.models) + 2
    assert "://" not in text.replace(facts["source"], "")
    assert all(title in text for title in ("Response surfaces", "Where to sample", "Provenance"))
    assert [path.name for path in tmp_path.iterdir()] == ["s.html"]


@pytest.mark.slow
def test_surrogate_page_without_held_out_points_and_with_printed_coefficients(tmp_path):
    """SST: no forces at the training points of KCS, no standard deviation."""
    found, ship = attached(KCS, "G2", "SST")
    facts = surrogate_report.as_dict(found, ship.surrogate)
    write_surrogate_report(tmp_path / "s.html", found, ship, facts)
    assert (tmp_path / "s.html").read_text().count("<img") == 4
    found, ship = attached(ONRT, "G2", "SST")
    plot_surrogate(ship, tmp_path / "s.png", found)
    assert is_picture(tmp_path / "s.png")


def test_surfaces_are_those_of_the_samples(surrogate):
    """The kernels give the fitted models back at the held-out samples, on both sides of a ship."""
    found, ship = surrogate
    for side, models in found.models.items():
        for J, beta in found.validation[side].X:
            values = response(ship, J, beta, side)
            for name in set(models) - {"C_Mz"}:
                expected = models[name].predict(np.array([[J, beta]]))[0][0]
                expected *= found.data.sign if name in ("K_S", "C_Fy") else 1.0
                value = values["K_T" if name == "K_X" else name]
                assert value == pytest.approx(expected, abs=1e-3), (side, name)


def test_surfaces_of_kcs_are_near_cfd():
    """Within 7 % of the printed values, as far as the thesis prints its regression to be."""
    samples, ship = fit(KCS).validation["single"], load_ship("kcs_model")
    for i, (J, beta) in enumerate(samples.X):
        found = response(ship, J, beta)
        for name, values in samples.values.items():
            assert found[name] == pytest.approx(values[i], rel=0.07), name


@pytest.mark.parametrize("beta_deg", [-30.0, 0.0, 20.0, 40.0])
def test_side_force_has_no_kink_over_the_rudder_angle(surrogate, beta_deg):
    """Half the step quarters the second difference of a smooth curve, of a kink it halves it."""
    _, ship = surrogate
    bends = []
    for count in (281, 561):
        delta = np.linspace(-ship.gear.delta_max, ship.gear.delta_max, count)
        force = side_force(ship, delta, np.radians(beta_deg))
        bends.append(np.abs(np.diff(force, 2)).max())
    assert bends[0] / bends[1] == pytest.approx(4.0, abs=0.2)


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
