"""A kinematic Nomoto ship on a track of straight legs; lengths in L, times in L / U0."""

import math

import numpy as np
import pytest
from ship_gym_agents.drift_los import DriftLOS
from ship_gym_agents.los import ILOS, LOSPID
from ship_gym_agents.pid import Gains
from ship_gym_agents.reference import Guidance

from ship_gym import load_scenario, load_ship
from ship_gym.config import ConfigError
from ship_gym.tasks.columns import observation_columns

GAINS = Gains(K_p=2.0, K_d=2.0, guidance=Guidance(look_ahead=2.5, integral=0.3))
K, T_NOMOTO = 1.7, 2.3


def on_leg(error_deg=0.0, cross=0.0, to_go=20.0, next_turn_deg=0.0):
    """Observation of a ship that sails straight, off the leg and its bearing by so much."""
    e = math.radians(error_deg)
    seen = np.zeros((1, 15))
    seen[0, :4] = math.sin(e), math.cos(e), 0.0, 1.0
    seen[0, 9], seen[0, 11], seen[0, 12] = cross, to_go, next_turn_deg / 180.0
    return seen


def started(controller):
    controller.reset(1, load_ship("kcs"), load_scenario("track_following"))
    return controller


def wanted_deg(controller, seen, jump=0.0):
    seen = observation_columns(load_scenario("track_following")).view(seen)
    return math.degrees(controller._wanted(seen, np.array([jump]))[0])


def sail(controller, points, current=(0.0, 0.0), T=1500, start=(0.0, 0.0)):
    """Rows of x, y, psi, cross-track error and number of the leg; x north, y east.

    A leg ends at the bisector of the way-point's angle.
    """
    controller, ship = started(controller), load_ship("kcs")
    points, limit = np.asarray(points, dtype=float), ship.gear.delta_max
    step, rate = ship.speed / ship.hull.L, ship.gear.rate
    (x, y), leg, r, delta, rows = start, 0, 0.0, 0.0, []
    legs = np.diff(points, axis=0)
    bearing = np.arctan2(legs[:, 1], legs[:, 0])
    ahead = np.stack([np.cos(bearing), np.sin(bearing)], axis=1)
    psi = bearing[0]
    for _ in range(T):
        while (
            leg < len(legs) - 1
            and np.dot((x, y) - points[leg + 1], ahead[leg : leg + 2].sum(0)) > 0
        ):
            leg += 1
        c, s = math.cos(bearing[leg]), math.sin(bearing[leg])
        north, east = points[leg + 1] - (x, y)
        cross = c * (y - points[leg, 1]) - s * (x - points[leg, 0])
        seen = np.zeros((1, 15))
        e = psi - bearing[leg]
        seen[0, :6] = math.sin(e), math.cos(e), r, 1.0, 0.0, delta / limit
        turn = bearing[leg + 1] - bearing[leg] if leg < len(legs) - 1 else 0.0
        turn = (turn + math.pi) % (2.0 * math.pi) - math.pi
        to_go = np.clip(c * north + s * east, -5.0, 50.0)
        seen[0, 9], seen[0, 11], seen[0, 12] = np.clip(cross, -10.0, 10.0), to_go, turn / math.pi
        seen[0, 10] = math.sin(e) - s * current[0] + c * current[1]
        wanted = limit * float(controller.act(seen)[0, 0])
        delta += np.clip(wanted - delta, -rate, rate)
        r += step * (K * delta - r) / T_NOMOTO
        psi += step * r
        x += step * (math.cos(psi) + current[0])
        y += step * (math.sin(psi) + current[1])
        rows.append((x, y, psi, cross, leg))
    return np.array(rows)


def test_line_of_sight():
    """One look-ahead off the leg: 45 deg towards it; on it: along it."""
    los = started(LOSPID(Gains(1.0, 1.0, guidance=Guidance(look_ahead=2.5))))
    assert wanted_deg(los, on_leg()) == 0.0
    assert wanted_deg(los, on_leg(cross=2.5)) == pytest.approx(-45.0)
    assert wanted_deg(los, on_leg(cross=-2.5)) == pytest.approx(45.0)


def test_wheel_over_is_where_the_circle_leaves_the_leg():
    los = started(LOSPID(Gains(1.0, 1.0, guidance=Guidance(turn_radius=2.0))))
    reach = 2.0 * math.tan(math.radians(30.0))
    assert wanted_deg(los, on_leg(to_go=reach + 0.01, next_turn_deg=60.0)) == 0.0
    # at the way-point the line of sight is along the next leg, before it still towards it
    assert wanted_deg(los, on_leg(to_go=0.0, next_turn_deg=60.0)) == pytest.approx(60.0)
    early = wanted_deg(los, on_leg(to_go=reach - 0.01, next_turn_deg=60.0))
    assert 30.0 < early < 60.0
    assert wanted_deg(los, on_leg(to_go=reach - 0.01, next_turn_deg=-60.0)) == -early
    assert wanted_deg(los, on_leg(to_go=0.0)) == 0.0  # no way-point behind the last leg


def test_reach_orders_the_turn_earlier():
    guidance = Guidance(turn_radius=2.0, reach=0.5)
    los = started(LOSPID(Gains(1.0, 1.0, guidance=guidance)))
    reach = 2.0 * math.tan(math.radians(30.0)) + 0.5
    assert wanted_deg(los, on_leg(to_go=reach + 0.01, next_turn_deg=60.0)) == 0.0
    assert wanted_deg(los, on_leg(to_go=reach - 0.01, next_turn_deg=60.0)) > 20.0


def test_a_leg_switch_changes_nothing_by_itself():
    """Wanted heading in earth axes, just before and after the environment names the next leg."""
    los = started(LOSPID(Gains(1.0, 1.0, guidance=Guidance(turn_radius=3.0))))
    d, turn = 1.0, math.radians(40.0)
    before = wanted_deg(los, on_leg(cross=0.3, to_go=d, next_turn_deg=40.0))
    cross = d * math.sin(turn) + 0.3 * math.cos(turn)
    assert wanted_deg(los, on_leg(cross=cross)) + 40.0 == pytest.approx(before)


@pytest.mark.parametrize(("law", "past"), [(LOSPID, 0.25), (ILOS, 0.75), (DriftLOS, 0.25)])
def test_converges_to_a_leg_from_aside(law, past):
    """From 3 L aside; the integral costs some overshoot."""
    cross = sail(law(GAINS), [(0, 0), (60, 0)], start=(0.0, 3.0))[:, 3]
    assert abs(cross[-1]) < 0.02
    assert cross.min() > -past


@pytest.mark.parametrize("turn_deg", [-90.0, 30.0, 60.0, 120.0])
@pytest.mark.parametrize("radius", [0.0, 4.0])
def test_turns_at_a_way_point(turn_deg, radius):
    """Passes the bisector however early the turn begins and settles on the next leg."""
    a = math.radians(turn_deg)
    points = [(0, 0), (15, 0), (15 + 25 * math.cos(a), 25 * math.sin(a))]
    gains = Gains(2.0, 2.0, guidance=Guidance(look_ahead=2.5, turn_radius=radius))
    rows = sail(LOSPID(gains), points, T=1100)
    assert rows[-1, 4] == 1 and abs(rows[-1, 3]) < 0.05


def test_wheel_over_keeps_the_ship_nearer_to_the_track():
    """A turn of 60 deg begun early runs less far past the next leg."""
    points = [(0, 0), (15, 0), (27.5, 25 * math.sin(math.radians(60.0)))]
    past = []
    for radius in (0.0, 4.0):
        gains = Gains(2.0, 2.0, guidance=Guidance(turn_radius=radius))
        rows = sail(LOSPID(gains), points, T=1100)
        past.append(-rows[rows[:, 4] == 1, 3].min())
    assert past[1] < 0.5 * past[0]


def test_ilos_removes_the_offset_of_a_current():
    points, current = [(0, 0), (80, 0)], (0.0, 0.15)
    laws = LOSPID, ILOS, DriftLOS
    los, ilos, drift_los = (sail(c(GAINS), points, current, T=2000)[:, 3] for c in laws)
    # LOS alone: the offset at which the crab angle is atan(e / look_ahead)
    expected = 2.5 * math.tan(math.asin(0.15))
    assert los[-1] == pytest.approx(expected, rel=0.02)
    assert abs(ilos[-1]) < 0.02
    # the drift is known before the ship is set aside
    assert abs(drift_los[-1]) < 0.02 and np.std(drift_los) < 0.5 * np.std(ilos)


def test_ilos_integral_by_hand_and_at_a_new_leg():
    p = Guidance(look_ahead=2.0, integral=0.5)
    ilos = started(ILOS(Gains(1.0, 1.0, guidance=p)))
    step = load_ship("kcs").speed / load_ship("kcs").hull.L
    assert wanted_deg(ilos, on_leg(cross=1.0)) == pytest.approx(-math.degrees(math.atan(0.5)))
    z = step * 2.0 / (2.0**2 + 1.0**2)
    assert ilos._drift[0] == pytest.approx(z)
    wanted_deg(ilos, on_leg(cross=0.0), jump=-math.pi / 2)
    assert abs(ilos._drift[0]) < 1e-12  # a current across the old leg is along the new one


@pytest.mark.parametrize("law", [ILOS, DriftLOS])
def test_mirrored_tracks_give_mirrored_ways(law):
    points = np.array([(0, 0), (12, 0), (20, 8), (40, 8)])
    port, starboard = (sail(law(GAINS), points * (1, s), (0.02, 0.05 * s), T=900) for s in (-1, 1))
    assert port[:, 1] == pytest.approx(-starboard[:, 1], abs=1e-6)


def test_an_observation_without_a_track_is_refused():
    with pytest.raises(ConfigError, match=r"15 columns, an array of shape \(1, 9\) was given"):
        started(ILOS(GAINS)).act(on_leg()[:, :9])
    with pytest.raises(ConfigError, match="controller ilos needs cross_track, to_go, next_turn"):
        ILOS(GAINS).reset(1, load_ship("kcs"), load_scenario("heading_keeping"))
