"""The picture of a recorded run has its plots and its marks, whatever the run has."""

from __future__ import annotations

import numpy as np
import pytest

from ship_gym.recording import Trajectory

pytest.importorskip("matplotlib")

from PIL import Image

from ship_gym.plotting.run import plot_run

T = np.arange(0.0, 100.0, 2.0)


def test_every_plot_takes_its_room(tmp_path):
    columns = {"t": T, "psi": 0.01 * T, "delta": np.sin(T), "u": 7.0 + 0.0 * T, "v": 0.0 * T}
    heights = []
    for names in (["t", "psi"], ["t", "psi", "delta"], [*columns]):
        run = Trajectory({name: columns[name] for name in names}, {"outcome": "end of time"})
        plot_run(run, tmp_path / "run.png")
        image = np.asarray(Image.open(tmp_path / "run.png").convert("RGB"))
        assert image.std() > 5.0 and image.shape[1] > 1200
        heights.append(image.shape[0])
    assert heights[0] == heights[1] < heights[2]


def test_a_run_without_plots_is_refused(tmp_path):
    with pytest.raises(ValueError, match="nothing to plot"):
        plot_run(Trajectory({"t": T}), tmp_path / "run.png")
    assert not [*tmp_path.iterdir()]
