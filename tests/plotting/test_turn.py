"""Path of a manoeuvre over the samples, and shares of the forces over a turn."""

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.plotting.turn import force_shares, path_share, plot_path, plot_shares
from ship_gym.recording.trajectory import Trajectory
from ship_gym.reports.case import sail
from ship_gym.reports.manoeuvre import title
from ship_gym.ships.loader import load_ship


@pytest.fixture(scope="module")
def circle():
    return sail(load_ship("kcs_model"), delta_deg=-35.0)


def made(**columns):
    """A trajectory of four samples; forces that are not given are zero."""
    whole = {f"{a}_{k}": np.zeros(4) for a in "XYN" for k in ("hull", "rudder", "wave")}
    basis = {"t": np.arange(4.0), "psi": np.zeros(4), "delta": np.full(4, -0.6)}
    return Trajectory(basis | whole | {k: np.asarray(v, float) for k, v in columns.items()})


def test_share_of_the_path_counts_samples_in_the_box_mirrored_to_starboard():
    """Rudder to port, drift to port: as a turn to starboard. Box: J 0.2 to 0.9, 0 to 45 deg."""
    t = made(J=[0.1, 0.5, 0.5, 0.5], beta_P=[-0.3, -0.3, 0.3, -0.3], beta_R=[-0.3, -0.3, -0.3, -1])
    assert path_share(t, load_ship("kcs_model")) == {"propeller": 0.5, "rudder": 0.5}


def test_path_picture(tmp_path, circle):
    shares = plot_path(circle.result.trajectory, circle.ship, tmp_path / "p.png", title(circle))
    assert (tmp_path / "p.png").read_bytes()[:4] == b"\x89PNG"
    assert set(shares) == {"propeller", "rudder"}


def test_a_ship_without_surrogate_has_no_samples_to_cross(tmp_path, circle):
    with pytest.raises(ConfigError, match="no surrogate"):
        plot_path(circle.result.trajectory, load_ship("kvlcc2_model"), tmp_path / "p.png", "x")


def test_shares_of_the_resistance_sum_to_one_and_sway_is_over_the_hull():
    t = made(
        X_hull=[-1, -1, -2, 0], X_rudder=[-1, -3, -2, 0], X_wave=[0, 0, -4, 0],
        Y_hull=[0, 2, 4, 4], Y_rudder=[1, -1, -1, -1], N_hull=[-1, -2, 0, 1], N_rudder=[2, 2, 2, 2],
    )  # fmt: skip
    found = force_shares(t)
    np.testing.assert_allclose(found["X"]["hull"], [0.5, 0.25, 0.25, np.nan])
    np.testing.assert_allclose(found["X"]["wave"], [0.0, 0.0, 0.5, np.nan])
    np.testing.assert_allclose(found["Y"]["rudder"], [np.nan, -0.5, -0.25, -0.25])
    np.testing.assert_allclose(found["N"]["hull"], [-0.5, -1.0, 0.0, 0.5])
    assert "wave" not in found["Y"] and "wave" not in found["N"]


def test_shares_picture(tmp_path, circle):
    """In the steady turn hull and rudder balance in yaw but for a few percent."""
    last = plot_shares(circle.result.trajectory, tmp_path / "s.png", title(circle))
    assert (tmp_path / "s.png").read_bytes()[:4] == b"\x89PNG"
    assert sum(last["X"].values()) == pytest.approx(1.0)
    assert last["N"]["hull"] == pytest.approx(-1.0, abs=0.1)
