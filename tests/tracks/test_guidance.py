import math
import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ship_gym.physics.angles import wrapped
from ship_gym.tracks import Track
from ship_gym.tracks.guidance import (
    OnRoute,
    cross_track,
    leg_position,
    look_ahead_bearing,
    off_route,
    on_route,
    passed,
    share_left,
)

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


@given(METRES, METRES, METRES, METRES, METRES, METRES)
def test_mirrored(x, y, x_a, y_a, x_b, y_b):
    """East and west exchanged: cross-track error and bearings change sign, the rest stays."""
    along, cross, bearing, length = leg_position(x, y, x_a, y_a, x_b, y_b)
    mirrored = leg_position(x, -y, x_a, -y_a, x_b, -y_b)
    assert (mirrored[0], mirrored[1], mirrored[3]) == (along, -cross, length)
    assert abs(wrapped(mirrored[2] + bearing)) < 1e-15
    assert look_ahead_bearing(-bearing, -cross, 500.0) == -look_ahead_bearing(bearing, cross, 500.0)
    route = (x, y, -700.0, 400.0, x_a, y_a, x_b, y_b, x_b + 300.0, y_b + 50.0)
    sides = [1.0 if k % 2 == 0 else -1.0 for k in range(10)]
    here = on_route(*route)
    other = on_route(*(v * side for v, side in zip(route, sides, strict=True)))
    assert other.cross == -here.cross and abs(other.off) == abs(here.off)
    assert (other.to_go, other.along_next) == (here.to_go, here.along_next)


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


# North for 1000 m, then east for 1000 m, then north again.
CORNERS = np.array([[0.0, 0.0], [1000.0, 0.0], [1000.0, 1000.0], [2000.0, 1000.0]])


def here(leg, north, east, points=CORNERS):
    """Position on the route with this leg active."""
    ends = [points[min(max(leg + k, 0), len(points) - 1)].tolist() for k in (-1, 0, 1, 2)]
    return on_route(north, east, *ends[0], *ends[1], *ends[2], *ends[3])


@pytest.mark.parametrize(
    ("leg", "north", "east", "off"),
    [
        (0, 500.0, 30.0, 30.0),  # abreast of the active leg
        (0, 500.0, -30.0, -30.0),
        (0, -40.0, 30.0, 30.0),  # behind the start: the first leg goes on
        (0, 980.0, 100.0, 20.0),  # nearer to the next leg, south and so to starboard of it
        (0, 1010.0, 100.0, -10.0),  # north of it
        (0, 1030.0, -40.0, -50.0),  # outside the corner: distance to the way-point
        (1, 1030.0, -40.0, -50.0),  # the same with the next leg active: nothing jumps
        (1, 960.0, 5.0, 5.0),  # nearer to the previous leg
        (1, 1040.0, 1030.0, 30.0),  # beyond the active leg, abreast of the next one
        (2, 1500.0, 970.0, -30.0),
        (2, 2040.0, 970.0, -30.0),  # beyond the end: the last leg goes on
        (2, 960.0, 1030.0, 50.0),  # before the last leg, which is no first one
    ],
)
def test_the_distance_to_the_route_is_that_to_the_nearest_leg(leg, north, east, off):
    assert here(leg, north, east).off == pytest.approx(off, abs=1e-9)
    voyage = np.array([leg]), np.array([north]), np.array([east])
    assert off_route(CORNERS, *voyage)[0] == pytest.approx(off, abs=1e-9)
    mirrored = here(leg, north, -east, CORNERS * [1.0, -1.0])
    assert mirrored.off == pytest.approx(-off, abs=1e-9)


@pytest.mark.parametrize(
    ("leg", "north", "east", "share"),
    [(0, 0.0, 50.0, 1.0), (0, 400.0, 0.0, 2600 / 3000), (1, 1000.0, 250.0, 1750 / 3000),
     (2, 2500.0, 1000.0, 0.0), (0, -300.0, 0.0, 1.0)],
)  # fmt: skip
def test_share_of_the_route_that_is_left(leg, north, east, share):
    assert share_left(CORNERS, leg, north, east) == pytest.approx(share)


def test_only_three_legs_are_looked_at():
    """On a route back to its start the first leg is no way to save the last."""
    square = 1000.0 * np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])
    assert here(3, 300.0, 500.0, square).off == pytest.approx(300.0)  # north of the leg west
    assert here(3, 300.0, 10.0, square).off == pytest.approx(300.0)  # though 10 m off leg 0


METRE = st.floats(-3000.0, 3000.0)


@given(METRE, METRE, st.integers(0, 2))
def test_the_distance_is_the_least_to_any_point_of_the_legs(north, east, leg):
    """Of 2001 points on each of the three legs, prolonged at both ends of the route."""
    points = CORNERS.copy()
    if leg == 0:
        points[0] = [-1e4, 0.0]
    if leg == 2:
        points[-1] = [1e4, 1000.0]
    share = np.linspace(0.0, 1.0, 2001)[:, None]
    legs = [k for k in (leg - 1, leg, leg + 1) if 0 <= k <= 2]
    on = np.concatenate([points[k] + share * (points[k + 1] - points[k]) for k in legs])
    nearest = np.hypot(on[:, 0] - north, on[:, 1] - east).min()
    found = abs(here(leg, north, east).off)
    assert found <= nearest + 1e-9 and found == pytest.approx(nearest, abs=6.0)


def test_on_the_bisector_nothing_jumps_when_the_leg_changes():
    """At 45 deg through the corner, inside and outside, from both legs."""
    for aside in (-300.0, -20.0, 20.0, 300.0):
        before, after = here(0, 1000.0 - aside, aside), here(1, 1000.0 - aside, aside)
        assert before.off == pytest.approx(after.off, abs=1e-9)
        assert before.to_go == pytest.approx(before.along_next)


@pytest.mark.parametrize(
    ("north", "east", "expected"),
    [
        (999.0, 0.0, 0),
        (1000.0, 0.0, 1),  # on the way-point
        (701.0, 300.0, 1),  # inside the turn: beyond the line at 45 deg
        (699.0, 300.0, 0),
        (1299.0, -300.0, 0),  # outside
        (1301.0, -300.0, 1),
        (0.0, 0.0, 0),
    ],
)
def test_a_way_point_is_passed_at_the_bisector(north, east, expected):
    at = here(0, north, east)
    assert passed(at.to_go, at.along_next, at.cross, 0.0) == expected


@pytest.mark.parametrize("turn_deg", [-150.0, -60.0, -10.0, 0.0, 10.0, 90.0, 150.0])
def test_the_bisector_halves_any_angle(turn_deg):
    """The line lies at 90 deg plus half the turn off the leg, through the way-point."""
    turn = math.radians(turn_deg)
    points = np.array([[-1e4, 0.0], [0.0, 0.0], [1e4 * math.cos(turn), 1e4 * math.sin(turn)]])
    across = 0.5 * turn + 0.5 * math.pi
    for out in (-500.0, 0.0, 500.0):
        for ahead in (-1.0, 1.0):
            north = out * math.cos(across) + ahead * math.cos(0.5 * turn)
            east = out * math.sin(across) + ahead * math.sin(0.5 * turn)
            at = here(0, north, east, points)
            assert passed(at.to_go, at.along_next, at.cross, 0.0) == (ahead > 0.0)


@pytest.mark.parametrize(
    ("to_go", "cross", "expected"),
    [
        (50.0, 0.0, 1),  # on the rim of the circle of 50 m
        (40.0, 30.0, 1),  # rim: 40, 30, 50
        (40.0, -30.1, 0),
        (51.0, 0.0, 0),
        (0.1, 200.0, 0),  # abeam soon, far outside the circle
        (0.0, 200.0, 1),  # the last way-point, abeam
        (-500.0, -3000.0, 1),
    ],
)
def test_the_last_way_point_is_passed_abeam_and_any_in_a_circle(to_go, cross, expected):
    assert passed(to_go, 0.0, cross, 50.0) == expected


def test_the_last_leg_has_no_next():
    assert here(2, 1900.0, 1000.0) == OnRoute(0.0, 0.0, 100.0, 0.0, 0)


COMPILED = """
import numpy as np
from ship_gym.tracks.guidance import leg_position, look_ahead_bearing, on_route, passed
for row in np.random.default_rng(1).normal(0.0, 1e3, (500, 10)).tolist():
    along, cross, bearing, length = leg_position(*row[:6])
    sight = look_ahead_bearing(bearing, cross, 800.0)
    route = on_route(*row)
    print(*(float(v).hex() for v in (along, cross, bearing, length, sight, *route)),
          passed(route.to_go, route.along_next, route.cross, 300.0))
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
