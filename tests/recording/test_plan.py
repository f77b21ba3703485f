"""Numbers of a plan view by hand."""

import numpy as np

from ship_gym.recording.plan import grid_lines, plan_bounds, to_plan


def test_axes_of_the_screen():
    assert to_plan(np.array([[3.0, 5.0], [-1.0, 2.0]])).tolist() == [[5.0, -3.0], [2.0, 1.0]]


def test_bounds_are_a_square_around_the_track():
    low, high = plan_bounds(np.array([[0.0, -100.0], [40.0, 0.0]]), 10.0)
    assert low.tolist() == [-40.0, -110.0] and high.tolist() == [80.0, 10.0]


def test_grid_of_a_square_that_is_not_about_the_origin():
    """600 m wide: a line each 100 m; north is minus the second axis of the screen."""
    lines, places, labels = grid_lines(np.array([950.0, -350.0]), np.array([1550.0, 250.0]))
    assert labels == [
        *(f"E {e} m" for e in (1100, 1200, 1300, 1400, 1500)),
        *(f"N {n} m" for n in (300, 200, 100, 0, -100, -200)),
    ]
    assert lines[0].tolist() == [[1000.0, -350.0], [1000.0, 250.0]]
    assert lines[6].tolist() == [[950.0, -300.0], [1550.0, -300.0]]
    assert places[0].tolist() == [1100.0, 214.0]  # E 1000 would hide what is written at N -200
    assert places[5].tolist() == [986.0, -300.0]
