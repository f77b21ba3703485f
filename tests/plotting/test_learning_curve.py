"""Learning curves: one run, several seeds, and validations without a value."""

import numpy as np
import pytest
from PIL import Image

from ship_gym.plotting.learning_curve import plot_learning_curves

SAMPLES = [0.0, 100.0, 200.0]
ONE = {"samples": SAMPLES, "J": [30.0, 25.0, 22.0], "rudder_travel": [900.0, 950.0, 800.0]}
OTHER = {"samples": [0.0, 90.0], "J": [31.0, None], "rudder_travel": [900.0, 1000.0]}
NONE = {"samples": SAMPLES, "J": [None, None, None], "rudder_travel": [1.0, 1.0, 1.0]}


@pytest.mark.parametrize("curves", [[ONE], [ONE, OTHER, ONE], [NONE], [NONE, NONE]])
def test_curves_are_drawn(tmp_path, curves):
    path = tmp_path / "curve.png"
    references = {"pid": {"J": 23.0, "rudder_travel": 1000.0}, "lqg": {"J": None}}
    plot_learning_curves(curves, "J", "deg2", path, "title", "details", references)
    with Image.open(path) as image:
        assert image.size == (946, 440)
        drawn = np.asarray(image.convert("RGB")).reshape(-1, 3)
    assert len(np.unique(drawn, axis=0)) > 10
