"""Picture of ships in waves from several directions, and the angle that it shows."""

import numpy as np
import pytest

from reproduce.headings import HeadingRun, bow_to_waves, plot_headings
from ship_gym.recording import Trajectory
from ship_gym.reports.case import sail
from ship_gym.ships.loader import load_ship


def test_angle_between_bow_and_waves():
    found = bow_to_waves(np.radians([0.0, 20.0, -70.0, 200.0, 380.0]), 20.0)
    assert found == pytest.approx([20.0, 0.0, 90.0, 180.0, 0.0], abs=1e-9)


@pytest.mark.slow
def test_headings(tmp_path):
    case = sail(load_ship("dtc_model"), delta_deg=-35.0, wave_height=0.05, wavelength=1.0)
    t = case.result.trajectory
    t = Trajectory({name: values[::20] for name, values in t.columns.items()}, {})
    runs = [HeadingRun(angle, t, t, t) for angle in (20.0, 120.0)]
    plot_headings(runs, tmp_path / "heading.png", "title", "details")
    data = (tmp_path / "heading.png").read_bytes()
    assert data[:4] == b"\x89PNG" and 15_000 < len(data) < 300_000
