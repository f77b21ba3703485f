import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ship_gym.config import ConfigError
from ship_gym.tracks import Track, n_draws, random_points

LEGS = 6


def drawn(m, legs=LEGS, seed=0):
    return np.random.default_rng(seed).random((m, n_draws(legs)))


def measured(points):
    """Leg lengths (m, legs) and changes of course (m, legs - 1) of way-points."""
    tracks = [Track(row) for row in points]
    return np.array([t.leg_lengths for t in tracks]), np.array([t.course_changes for t in tracks])


def test_tracks_begin_at_the_origin_to_the_north():
    points = random_points(drawn(50))
    assert points.shape == (50, LEGS + 1, 2)
    assert (points[:, 0] == 0.0).all() and (points[:, 1, 1] == 0.0).all()
    assert ((points[:, 1, 0] >= 3.0) & (points[:, 1, 0] < 15.0)).all()


@settings(max_examples=50)
@given(
    st.floats(0.1, 6.0),
    st.floats(2.0, 8.0),
    st.floats(1.0, 3.0),
    st.just(0.0) | st.floats(1e-30, math.radians(150.0)),
    st.integers(1, 9),
)
def test_every_turn_is_feasible(turn_radius, leg_min, ratio, turn_max, legs):
    leg_max = ratio * leg_min
    points = random_points(drawn(20, legs), turn_radius, leg_min, leg_max, turn_max, margin=1.0)
    lengths, turns = measured(points)
    assert (lengths >= leg_min - 1e-9).all() and (lengths <= leg_max + 1e-9).all()
    assert (np.abs(turns) <= turn_max + 1e-9).all()
    for row in points:
        Track(row).check_turns(turn_radius)
    used = turn_radius * np.tan(0.5 * np.abs(turns))
    none = np.zeros((20, 1))
    both = np.hstack([none, used]) + np.hstack([used, none])
    assert (lengths >= both + 1.0 - 1e-9).all()


def test_the_extreme_draws_use_all_the_room_there_is():
    """Shortest legs, sharpest turns: an inner leg is used up by its two turns."""
    uniform = np.zeros((1, n_draws(4)))
    uniform[:, 1::2] = 1.0 - 2.0**-53
    lengths, turns = measured(random_points(uniform))
    np.testing.assert_allclose(lengths, 3.0)
    np.testing.assert_allclose(turns, 2.0 * math.atan(1.0 / 3.0))  # 36.9 deg, to starboard
    used = 3.0 * np.tan(0.5 * turns[0])
    np.testing.assert_allclose(lengths[0, 1:-1], used[1:] + used[:-1] + 1.0)


def test_the_distribution_is_as_documented():
    points = random_points(drawn(4000))
    lengths, turns = measured(points)
    error = 2.0 / math.sqrt(turns.size)  # four standard errors of a fraction of 1/2
    assert lengths.mean() == pytest.approx(9.0, abs=12.0 * error)
    assert (turns > 0.0).mean() == pytest.approx(0.5, abs=error)
    inner = np.minimum(lengths[:, 1:-2], lengths[:, 2:-1]) >= 7.0
    assert inner.mean() == pytest.approx(4.0 / 9.0, abs=error)
    free = np.abs(turns[:, 1:-1][inner]) / (0.5 * math.pi)  # both legs long: uniform up to 90 deg
    assert np.quantile(free, [0.25, 0.5, 0.75]) == pytest.approx([0.25, 0.5, 0.75], abs=2 * error)
    assert free.max() > 0.99


def test_a_row_is_the_same_bits_in_any_batch():
    uniform = drawn(67)
    whole = random_points(uniform)
    for m in (1, 2, 3, 5, 8, 16, 33, 66):
        assert random_points(uniform[:m]).tobytes() == whole[:m].tobytes()
    for i in range(67):
        assert random_points(uniform[i : i + 1]).tobytes() == whole[i].tobytes()
    other_order = random_points(np.asfortranarray(uniform)[::-1])
    assert other_order[::-1].tobytes() == whole.tobytes()


def test_mirrored_draws_give_the_mirrored_track():
    uniform = drawn(20)
    mirrored = uniform.copy()
    mirrored[:, 1::2] = 1.0 - uniform[:, 1::2]
    expected = random_points(uniform) * [1.0, -1.0]
    np.testing.assert_allclose(random_points(mirrored), expected, atol=1e-12)


def test_no_tracks_and_one_leg():
    assert random_points(np.empty((0, 3))).shape == (0, 3, 2)
    assert random_points(np.array([[0.5]])).tolist() == [[[0.0, 0.0], [9.0, 0.0]]]


def test_number_of_draws():
    assert [n_draws(legs) for legs in (1, 2, 8)] == [1, 3, 15]
    for legs in (0, 1.5, True):
        with pytest.raises(ConfigError, match="legs"):
            n_draws(legs)


@pytest.mark.parametrize(
    ("uniform", "keys", "message"),
    [
        (np.zeros((1, 4)), {}, "odd"),
        (np.zeros(3), {}, "odd"),
        (np.ones((1, 3)), {}, r"\[0, 1\)"),
        (np.full((1, 3), np.nan), {}, r"\[0, 1\)"),
        (np.zeros((1, 3)), {"leg_min": 1.0}, "leg_min = 1.0 L must be above margin"),
        (np.zeros((1, 3)), {"leg_max": 2.0}, "leg_max"),
        (np.zeros((1, 3)), {"turn_max": 90.0}, "degrees"),
        (np.zeros((1, 3)), {"turn_max": -0.5}, "not negative"),
        (np.zeros((1, 3)), {"turn_radius": 0.0}, "turn_radius"),
        (np.zeros((1, 3)), {"margin": -1.0}, "margin"),
    ],
)
def test_refused(uniform, keys, message):
    with pytest.raises(ConfigError, match=message):
        random_points(uniform, **keys)
