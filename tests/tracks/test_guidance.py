import math
import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ship_gym.physics.angles import wrapped
from ship_gym.tracks import Track
from ship_gym.tracks.guidance import cross_track, leg_position, look_ahead_bearing, passed

METRES = st.floats(-1e4, 1e4)


def test_known_position_on_a_leg_to_the_north_east():
    along, cross, bearing, length = leg_position(100.0, 0.0, 0.0, 0.0, 300.0, 300.0)
    assert along == pytest.approx(100.0 / math.sqrt(2.0))
    assert cross == pytest.approx(-100.0 / math.sqrt(2.0))  # north of the leg: to port of it
    assert bearing == pytest.approx(math.pi / 4)
    assert length == pytest.approx(300.0 * math.sqrt(2.0))


def test_starboard_of_a_leg_to_the_south_is_west():
    south = leg_position(-30.0, -7.0, 0.0, 0.0, -100.0, 0.0)
    assert south == (30.0, 7.0, math.pi, 100.0)  # exactly


def test_before_beyond_and_a_leg_of_one_point():
    assert leg_position(-5.0, 0.0, 0.0, 0.0, 10.0, 0.0)[0] == -5.0
    assert leg_position(15.0, 0.0, 0.0, 0.0, 10.0, 0.0)[0] == 15.0
    assert leg_position(5.0, 3.0, 1.0, 1.0, 1.0, 1.0) == (4.0, 2.0, 0.0, 0.0)


def test_a_leg_has_the_bearing_and_length_of_its_track():
    track = Track([[0.0, 0.0], [300.0, -400.0]])
    _, _, bearing, length = leg_position(1.0, 2.0, *track.points[0], *track.points[1])
    assert bearing == track.leg_bearings[0] and length == track.leg_lengths[0]


@settings(deadline=None)
@given(METRES, METRES, METRES, METRES, METRES, METRES)
def test_mirrored(x, y, x_a, y_a, x_b, y_b):
    """East and west exchanged: cross-track error and bearings change sign, the rest stays."""
    along, cross, bearing, length = leg_position(x, y, x_a, y_a, x_b, y_b)
    mirrored = leg_position(x, -y, x_a, -y_a, x_b, -y_b)
    assert (mirrored[0], mirrored[1], mirrored[3]) == (along, -cross, length)
    assert abs(wrapped(mirrored[2] + bearing)) < 1e-15
    assert look_ahead_bearing(-bearing, -cross, 500.0) == -look_ahead_bearing(bearing, cross, 500.0)
    assert passed(along, -cross, length, 50.0) == passed(along, cross, length, 50.0)


@settings(deadline=None)
@given(METRES, METRES, METRES, METRES, METRES, METRES, st.floats(-math.pi, math.pi))
def test_turned_and_moved(x, y, x_b, y_b, north, east, turn):
    """Turning and moving ship and leg together turns the bearing and changes nothing else."""

    def placed(x, y):
        cos, sin = math.cos(turn), math.sin(turn)
        return cos * x - sin * y + north, sin * x + cos * y + east

    if math.hypot(x_b, y_b) < 1.0:
        return
    along, cross, bearing, length = leg_position(x, y, 0.0, 0.0, x_b, y_b)
    other = leg_position(*placed(x, y), *placed(0.0, 0.0), *placed(x_b, y_b))
    # 1e-11 m of rounding in the way-points turns a leg of 1 m by 1e-11 rad: 1e-7 m at 1e4 m
    assert other[0] == pytest.approx(along, abs=1e-6)
    assert other[1] == pytest.approx(cross, abs=1e-6)
    assert other[3] == pytest.approx(length, abs=1e-9)
    assert abs(wrapped(other[2] - bearing - turn)) < 1e-10


@settings(deadline=None)
@given(METRES, METRES, METRES, METRES, st.floats(1.0, 2000.0))
def test_look_ahead_points_at_the_point_ahead_on_the_leg(x, y, x_b, y_b, distance):
    if math.hypot(x_b, y_b) < 1.0:
        return
    along, cross, bearing, length = leg_position(x, y, 0.0, 0.0, x_b, y_b)
    ahead = (along + distance) / length
    sight = math.atan2(ahead * y_b - y, ahead * x_b - x)
    assert abs(wrapped(look_ahead_bearing(bearing, cross, distance) - sight)) < 1e-9


def test_look_ahead_steers_back_to_the_leg():
    assert look_ahead_bearing(0.3, 0.0, 400.0) == 0.3
    assert look_ahead_bearing(0.3, 400.0, 400.0) == pytest.approx(0.3 - math.pi / 4)
    assert look_ahead_bearing(0.3, -400.0, 400.0) == pytest.approx(0.3 + math.pi / 4)
    assert look_ahead_bearing(0.0, 1e12, 1.0) == pytest.approx(-math.pi / 2)


@pytest.mark.parametrize(
    ("along", "cross", "expected"),
    [
        (0.0, 0.0, 0),
        (949.0, 0.0, 0),
        (950.0, 0.0, 1),  # on the rim of the circle of 50 m
        (960.0, 30.0, 1),  # rim: 40, 30, 50
        (960.0, -30.1, 0),
        (999.9, 200.0, 0),  # abeam soon, far outside the circle
        (1000.0, 200.0, 1),  # passed, having missed the circle
        (1500.0, -3000.0, 1),
    ],
)
def test_a_way_point_is_reached_or_passed(along, cross, expected):
    assert passed(along, cross, 1000.0, 50.0) == expected


COMPILED = """
import numpy as np
from ship_gym.tracks.guidance import leg_position, look_ahead_bearing, passed
for row in np.random.default_rng(1).normal(0.0, 1e3, (500, 6)).tolist():
    along, cross, bearing, length = leg_position(*row)
    sight = look_ahead_bearing(bearing, cross, 800.0)
    print(*(float(v).hex() for v in (along, cross, bearing, length, sight)),
          passed(along, cross, length, 300.0))
"""


@pytest.mark.compiled
def test_compiled_is_the_same_bits_as_python():
    def run(**extra):
        env = {**os.environ, **extra}
        command = [sys.executable, "-c", COMPILED]
        return subprocess.run(command, env=env, capture_output=True, text=True, check=True).stdout

    compiled = run()
    assert compiled.count("\n") == 500
    assert {line[-1] for line in compiled.splitlines()} == {"0", "1"}
    assert compiled == run(NUMBA_DISABLE_JIT="1")


def test_cross_track_of_a_voyage_takes_the_leg_of_each_row():
    """East for 1000 m, then south: 30 m south of the first leg, 40 m west of the second.

    Both lie to starboard.
    """
    points = np.array([[0.0, 0.0], [0.0, 1000.0], [-1000.0, 1000.0]])
    x, y = np.array([-30.0, -500.0, 20.0]), np.array([400.0, 960.0, 400.0])
    found = cross_track(points, np.array([0, 1, 0]), x, y)
    np.testing.assert_allclose(found, [30.0, 40.0, -20.0], atol=1e-9)
