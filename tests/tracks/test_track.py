import math
import pickle

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.tracks import SHAPES, Track, shape_track

# 3-4-5 triangles: north-east, then a right angle to starboard, then one to port.
POINTS = [[0, 0], [300, 400], [-100, 700], [200, 1100]]


def test_lengths_bearings_and_changes_of_course():
    track = Track(POINTS)
    first = math.atan2(4.0, 3.0)
    np.testing.assert_allclose(track.leg_lengths, 500.0)
    np.testing.assert_allclose(track.leg_bearings, [first, first + math.pi / 2, first])
    np.testing.assert_allclose(track.course_changes, [math.pi / 2, -math.pi / 2])
    np.testing.assert_allclose(track.distances, [0.0, 500.0, 1000.0, 1500.0])
    assert track.total_length == 1500.0
    assert track.points.dtype == np.float64 and track.to_list() == POINTS


def test_turns_are_checked_by_what_they_need_of_both_legs():
    """Right angles at both ends of 500 m: a radius of 250 m each is all there is."""
    track = Track(POINTS)
    assert track.check_turns(250.0) is track
    told = r"leg from way-point 1 to 2 is 500 m long; turns of 90 and 90 deg .* need 502 m at"
    with pytest.raises(ConfigError, match=told):
        track.check_turns(251.0)
    with pytest.raises(ConfigError, match=r"from way-point 0 to 1 is 500 m .* 0 and 90 deg"):
        track.check_turns(501.0)
    assert Track([[0, 0], [1, 0], [2, 0]]).check_turns(1e6).total_length == 2.0  # straight on
    for name in SHAPES:
        shape_track(name).check_turns(3.0)


def test_a_turn_through_south_is_the_short_way_round():
    changes = Track([[0, 0], [-1, 0.1], [-2, 0.0], [-3, 0.1]]).course_changes
    expected = 2.0 * math.atan(0.1)
    np.testing.assert_allclose(changes, [expected, -expected])  # 174 to 186 deg: to starboard


def test_a_track_keeps_its_own_read_only_points():
    mine = np.array(POINTS, dtype=float)
    track = Track(mine)
    mine[0] = 1e6
    assert track.points[0, 0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        track.points[0, 0] = 1.0
    assert pickle.loads(pickle.dumps(track)).to_list() == POINTS


def test_scaled_and_moved():
    track = Track(POINTS)
    np.testing.assert_allclose(track.scaled(0.01).leg_lengths, 5.0)
    moved = track.moved(10.0, -20.0, math.pi / 2)
    np.testing.assert_allclose(moved.points[0], [10.0, -20.0])
    np.testing.assert_allclose(moved.points[1], [-390.0, 280.0])  # (300, 400) clockwise by 90 deg
    np.testing.assert_allclose(moved.course_changes, track.course_changes)
    np.testing.assert_allclose(moved.leg_bearings[0], track.leg_bearings[0] + math.pi / 2)


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([[0, 0]], "1 way-point; a track needs at least 2"),
        ([], "list of way-points"),
        ([[0, 0, 0], [1, 1, 1]], "list of way-points"),
        ([[0, 0], [1]], "list of way-points"),
        ([["0", "0"], ["1", "1"]], "list of way-points"),
        ("abc", "list of way-points"),
        (None, "list of way-points"),
        ([[0, 0], [1, 0], [math.nan, 0]], r"way-point 2 = \[nan, 0.0\]"),
        ([[0, 0], [math.inf, 0]], "way-point 1"),
        ([[0, 0], [0, 1e10]], "way-point 1"),
        ([[0, 0], [5, 0], [5, 0.9e-3], [9, 9]], "way-point 2.*is it there twice"),
        ([[0, 0], [10, 0], [0, 1]], "way-point 1.*turns by 174.3 deg.*150"),
        ([[0, 0], [10, 0], [0, -1]], "way-point 1.*turns by -174.3 deg.*150"),
    ],
)
def test_refused(points, message):
    with pytest.raises(ConfigError, match=message):
        Track(points)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_turns_up_to_150_deg_are_allowed(side):
    def turned(deg):
        a = side * math.radians(deg)
        return Track([[0, 0], [1, 0], [1 + math.cos(a), math.sin(a)]])

    assert turned(150.0).course_changes[0] == pytest.approx(side * math.radians(150.0))
    with pytest.raises(ConfigError, match="150"):
        turned(150.001)


@pytest.mark.parametrize("factor", [0.0, -1.0, math.nan, "2"])
def test_a_factor_must_be_positive(factor):
    with pytest.raises(ConfigError, match="factor"):
        Track(POINTS).scaled(factor)


def test_one_pair_of_limits_for_each_leg():
    track = Track(POINTS, limits=[[100.0, 200.0]] * (len(POINTS) - 1))
    assert track.limits.tolist() == [[100.0, 200.0]] * (len(POINTS) - 1)
    assert not track.limits.flags.writeable and track.origin_deg is None
    assert track.moved(1.0, 2.0).limits.tolist() == track.limits.tolist()
    assert track.scaled(0.5).limits.tolist() == [[50.0, 100.0]] * (len(POINTS) - 1)
    with pytest.raises(ConfigError, match=r"track.limits: shape \(1, 2\)"):
        Track(POINTS, limits=[[100.0, 200.0]])
    with pytest.raises(ConfigError, match=r"track\.leg_of"):
        Track(POINTS, leg_of=[0] * len(POINTS))


def test_bad_turn():
    with pytest.raises(ConfigError, match="degrees"):
        Track(POINTS).moved(0.0, 0.0, 90.0)


@pytest.mark.parametrize("name", SHAPES)
def test_shapes_begin_north_and_leave_room_for_the_turns(name):
    track = shape_track(name)
    assert track.to_list()[0] == [0.0, 0.0] and track.leg_bearings[0] == 0.0
    used = 3.0 * np.tan(0.5 * np.abs(track.course_changes))
    both = np.concatenate([[0.0], used]) + np.concatenate([used, [0.0]])
    assert (track.leg_lengths > both + 1.0).all()
    np.testing.assert_allclose(shape_track(name, 230.0).leg_lengths, 230.0 * track.leg_lengths)


def test_shapes_are_what_their_names_say():
    circle = shape_track("circle")
    np.testing.assert_allclose(circle.course_changes, math.radians(15.0))
    centre = circle.points[:-1].mean(axis=0)
    np.testing.assert_allclose(np.hypot(*(circle.points - centre).T), 8.0)
    np.testing.assert_allclose(circle.points[-1], 0.0, atol=1e-12)
    zigzag = np.degrees(shape_track("zigzag").leg_bearings)
    np.testing.assert_allclose(zigzag, [0.0, 30.0, -30.0, 30.0, -30.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(shape_track("square").course_changes, math.pi / 2)
    np.testing.assert_allclose(shape_track("l_turn").course_changes, [math.pi / 2])
    assert len(shape_track("straight").points) == 2


def test_unknown_shape_names_the_nearest():
    with pytest.raises(ConfigError, match="did you mean 'zigzag'"):
        shape_track("zig-zag")
