import math

import numpy as np
import pytest
from ship_gym_agents.route_preview import Current, Path, drift_angle

from ship_gym import load_scenario
from ship_gym.tasks.columns import observation_columns

COLUMNS = observation_columns(load_scenario("track_following"))
R = 2.0


def seen(rows=1, **values):
    array = np.zeros((rows, len(COLUMNS)))
    for name, value in values.items():
        array[:, COLUMNS[name]] = value
    return COLUMNS.view(array)


def path(to_go, cross, turn_deg):
    return Path(seen(to_go=to_go, cross_track=cross, next_turn=turn_deg / 180.0), R)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_on_the_leg(side):
    """10 L before a turn of 90 deg the arc begins R before the way-point."""
    here = path(10.0, side * 0.5, side * 90.0)
    assert here.error[0] == side * 0.5
    assert here.way[0] == pytest.approx(R - 10.0)
    ahead = here.bearings(np.array([[0.0, 8.0, 8.0 + R, 20.0]]))[0]
    assert ahead == pytest.approx(side * np.array([0.0, 0.0, 1.0, math.pi / 2]))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_on_the_arc_and_beyond(side):
    """Positions by hand: the centre is at (-R, side R) from the way-point, the next leg beyond."""
    for angle in (0.3, 1.2):
        for error in (-0.4, 0.0, 0.4):  # to starboard of the path
            distance = R - side * error
            x, y = -R + distance * math.sin(angle), R - distance * math.cos(angle)
            here = path(-x, side * y, side * 90.0)
            assert here.error[0] == pytest.approx(error)
            assert here.way[0] == pytest.approx(R * angle)
    beyond = path(-0.3, side * (R + 3.0), side * 90.0)  # 0.3 L outside the next leg
    assert beyond.error[0] == pytest.approx(-side * 0.3)
    assert beyond.way[0] == pytest.approx(R * math.pi / 2 + 3.0)
    assert beyond.bearings(np.array([[0.0]]))[0, 0] == pytest.approx(side * math.pi / 2)


def test_the_last_leg_goes_on():
    here = path(-1.0, 0.7, 0.0)
    assert here.error[0] == pytest.approx(0.7)
    assert here.bearings(np.array([[0.0, 5.0]]))[0] == pytest.approx([0.0, 0.0])


def test_error_and_way_have_no_jump_where_the_arc_begins_and_ends():
    for turn in (20.0, -75.0, 110.0):
        t = R * math.tan(0.5 * math.radians(abs(turn)))
        c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
        for x, y in ((-t, 0.2), (t * c - 0.2 * s, t * s + 0.2 * c)):
            ends = [path(-x + h, y + k, turn) for h in (1e-9, -1e-9) for k in (1e-9, -1e-9)]
            assert np.ptp([end.error[0] for end in ends]) < 1e-7
            assert np.ptp([end.way[0] for end in ends]) < 1e-7


def test_current_is_found_and_turned_with_the_leg():
    """0.15 along, -0.1 across; the next leg is 60 deg to starboard. Headings vary all the time."""
    step, along, across = 1.0 / 30.0, 0.15, -0.1
    found, to_go, turn = Current(1, step, 3.0), 20.0, math.radians(60.0)
    for k in range(600):
        jump = np.zeros(1)
        if k == 300:
            c, s = math.cos(turn), math.sin(turn)
            before = float(found.along[0]), float(found.across[0])
            along, across = c * along + s * across, c * across - s * along
            jump, to_go = np.full(1, -turn), 15.0
        psi, u, v = 0.3 * math.sin(0.02 * k), 0.9, 0.05 * math.cos(0.05 * k)
        over_ground = u * math.cos(psi) - v * math.sin(psi) + along
        rate = u * math.sin(psi) + v * math.cos(psi) + across
        found(seen(surge=u, sway=v, cross_track_rate=rate, to_go=to_go), np.full(1, psi), jump)
        if k == 300:
            assert before == pytest.approx((0.15, -0.1), abs=2e-3)
            assert (found.along[0], found.across[0]) == pytest.approx((along, across), abs=2e-3)
        to_go -= over_ground * step
    assert (found.along[0], found.across[0]) == pytest.approx((along, across), abs=2e-3)


def test_drift_angle_keeps_the_ship_on_the_path():
    """Heading bearing - angle: what she makes across the path is nothing."""
    current = Current(1, 0.03, 3.0)
    current.along, current.across = np.array([0.2]), np.array([-0.15])
    for bearing in (0.0, 1.0, -2.0):
        angle = drift_angle(current, np.array([[bearing]]), np.array([0.9]), np.array([0.0]))[0, 0]
        heading = bearing - angle
        east = 0.9 * math.sin(heading) + current.across[0]
        north = 0.9 * math.cos(heading) + current.along[0]
        assert math.cos(bearing) * east - math.sin(bearing) * north == pytest.approx(0.0, abs=1e-12)
