"""Axes show several ticks of whole powers of ten, and legends stand where the lines are not."""

from __future__ import annotations

import numpy as np
import pytest

from ship_gym.recording.axes import CORNERS, free_corner, is_shown, y_range


def ticks(low: float, high: float) -> int:
    """Ticks of the finest power of ten that the viewer writes on a quarter of a screen."""
    step = 10.0 ** np.ceil(np.log10((high - low) / 8.8))
    return int(np.floor(high / step) - np.ceil(low / step)) + 1


@pytest.mark.parametrize(
    ("low", "high", "least"),
    [
        (-90.0, -78.0, 3), (-0.3, 35.0, 4), (59.9, 60.1, 3), (0.0, 11.0, 3), (4.2, 7.9, 4),
        (-1e6, 2e6, 3), (0.0, 900.0, 2), (-0.0098, 0.0, 2), (-9.0, 9.0, 3), (330.0, 352.0, 3),
    ],
)  # fmt: skip
def test_several_ticks(low, high, least):
    found = y_range([np.linspace(low, high, 50)])
    assert found[0] <= low
    assert found[1] >= high
    assert ticks(*found) >= least
    assert high - low > 0.45 * (found[1] - found[0])


def test_fewer_plots_have_room_for_more_ticks():
    low, high = y_range([np.linspace(0.0, 900.0, 50)], plots=3)
    assert -100.0 < low and high < 1000.0  # ten ticks, a hundred apart


def test_a_constant_line_has_room_on_both_sides():
    for value in (0.0, 5.0, -2e-3):
        low, high = y_range([np.full(9, value)])
        assert low < value < high


def test_a_limit_is_on_the_axis_only_where_a_line_comes_near():
    line, limits = np.linspace(-8.0, 20.0, 9), [np.full(9, 35.0), np.full(9, -35.0)]
    assert max(y_range([line], limits)) < 35.0
    assert [is_shown(limit, [line]) for limit in limits] == [False, False]
    assert [is_shown(limit, [1.5 * line]) for limit in limits] == [True, False]
    low, high = y_range([1.5 * line], limits)
    assert high > 35.0
    assert low > -35.0


def test_the_rare_peak_is_left_out_where_asked():
    line = np.where(np.arange(100) < 8, -50.0, -1.0) + 0.5 * np.sin(np.arange(100.0))
    assert y_range([line])[0] < -50.0
    assert -3.0 < y_range([line], robust=True)[0] < -1.4


@pytest.mark.parametrize("corner", CORNERS)
def test_the_legend_takes_the_corner_that_is_free(corner):
    t = np.linspace(0.0, 10.0, 101)
    early, high = t < 5.0, corner.endswith("Top")
    here = early if corner.startswith("Left") else ~early
    line = np.where(here, 1.0 if not high else -1.0, -1.0 if not high else 1.0)
    busy = np.concatenate([line, np.full(101, 0.0)])
    lines = [busy[:101]]
    # away from the corner the line runs along both edges
    lines.append(np.where(here, lines[0], -lines[0]))
    assert free_corner(t, lines, (-1.2, 1.2), 3) == corner
