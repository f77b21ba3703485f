"""The picture of a search for hyperparameters."""

import pytest

pytest.importorskip("matplotlib")

from matplotlib.axes import Axes

from ship_gym.plotting.trials_of_search import plot_search


@pytest.fixture
def drawn(monkeypatch):
    """Points that are scattered: one list for each call."""
    calls = []
    scatter = Axes.scatter

    def kept(self, x, y, **options):
        calls.append((list(x), list(y), options["facecolors"]))
        return scatter(self, x, y, **options)

    monkeypatch.setattr(Axes, "scatter", kept)
    return calls


def test_every_trial_with_a_score_is_shown(drawn, tmp_path):
    rows = [
        (0, 2.0, True, {"rate": 1e-4, "hidden": [64, 64]}),
        (1, 3.0, False, {"rate": 2e-3, "hidden": [8]}),
        (2, None, False, {"rate": 1e-3, "hidden": [8]}),
        (3, 1.5, True, {"rate": 1e-3, "hidden": [8]}),
    ]
    path = tmp_path / "trials.png"
    plot_search(rows, "J [deg2]", True, path, "a search")
    assert path.stat().st_size > 2000
    history, hollow, rates, _, hidden, _ = drawn
    assert history[:2] == ([0, 3], [2.0, 1.5]) and rates[0] == [1e-4, 1e-3]
    assert hollow == ([1], [3.0], "none")
    assert hidden[0] == [1, 0]  # [8] stands before [64, 64]
