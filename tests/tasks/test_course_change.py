"""Course change from leg to leg, across +-180 deg too, as a track's observation and info say it."""

import math

import gymnasium as gym
import numpy as np
import pytest

from ship_gym.conventions import PSI, X, Y
from ship_gym.tasks import observations_of

STILL = {
    "sea.states": [],
    "sea.gusts": False,
    "sea.current_speed": 0.0,
    "sensors.noise": False,
    "start.heading_error_deg": 0.0,
    "start.cross_track": 0.0,
}
LEG = 3000.0
SYMBOLS = [row.symbol for row in observations_of("track_following")]
NEXT_TURN = SYMBOLS.index("d_chi / pi")


def track(*bearings_deg):
    """Environment on a track of legs of 3 km on these bearings."""
    points = [[0.0, 0.0]]
    for bearing in np.radians(bearings_deg):
        north, east = points[-1]
        points.append([north + LEG * math.cos(bearing), east + LEG * math.sin(bearing)])
    overrides = STILL | {"track.kind": "points", "track.points": points}
    env = gym.make("ShipGym/TrackFollowing-v0", overrides=overrides)
    return env, points


def degrees_between(a, b):
    return math.degrees((a - b + math.pi) % (2.0 * math.pi) - math.pi)


@pytest.mark.parametrize(
    ("first", "second", "turn"),
    [
        (170.0, -170.0, 20.0),
        (-170.0, 170.0, -20.0),
        (135.0, -135.0, 90.0),
        (-135.0, 135.0, -90.0),
        (179.0, -90.0, 91.0),
        (-110.0, 110.0, -140.0),
        (100.0, -111.0, 149.0),
        (10.0, 50.0, 40.0),
        (50.0, 10.0, -40.0),
        (-10.0, 20.0, 30.0),
        (30.0, 30.0, 0.0),
    ],
)
def test_the_next_turn_is_the_shorter_one_with_its_sign(first, second, turn):
    """Positive to starboard; 170 to -170 deg is 20 deg to starboard, not 340 deg to port."""
    env, _ = track(first, second)
    obs, info = env.reset(seed=0)
    assert 180.0 * obs[NEXT_TURN] == pytest.approx(turn, abs=1e-4)
    assert degrees_between(info["psi_ordered"], math.radians(first)) == pytest.approx(0, abs=1e-9)


def test_every_leg_names_the_turn_at_its_own_end_and_the_last_one_none():
    """Legs on 170, -170, 120 and 120 deg: turns of +20, -70 and 0; after the last way-point 0."""
    bearings, turns = (170.0, -170.0, 120.0, 120.0), (20.0, -70.0, 0.0, 0.0)
    env, points = track(*bearings)
    obs, info = env.reset(seed=0)
    state = env.unwrapped.episodes.sim.state
    for leg, (bearing, turn) in enumerate(zip(bearings, turns, strict=True)):
        assert info["leg"] == leg
        assert 180.0 * obs[NEXT_TURN] == pytest.approx(turn, abs=1e-4)
        off = degrees_between(info["psi_ordered"], math.radians(bearing))
        assert off == pytest.approx(0.0, abs=1e-9)
        # put the ship on the end of the leg, so that the next begins
        state[0, [X, Y, PSI]] = *points[leg + 1], math.radians(bearing)
        obs, _, terminated, _, info = env.step(np.zeros(1))
        assert terminated == (leg == 3)


@pytest.mark.parametrize("bearing", [180.0, 179.0, -179.0, 90.0])
@pytest.mark.parametrize("aside", [300.0, -300.0])
def test_cross_track_error_is_positive_to_starboard_on_any_bearing(bearing, aside):
    """300 m to starboard of a leg is +300 / 230 lengths, going south as going east."""
    env, _ = track(bearing, bearing)
    env.reset(seed=0)
    b = math.radians(bearing)
    c, s = math.cos(b), math.sin(b)
    state = env.unwrapped.episodes.sim.state
    state[0, [X, Y, PSI]] = 1000.0 * c - aside * s, 1000.0 * s + aside * c, b
    obs, *_, info = env.step(np.zeros(1))
    assert obs[SYMBOLS.index("e / L")] == pytest.approx(aside / 230.0, abs=1e-3)
    assert info["cross_track"] == pytest.approx(aside, abs=0.2)
    # the line of sight lies across the leg, on the other side
    sight = math.atan2(aside, 3.0 * 230.0)
    assert obs[SYMBOLS.index("sin(psi_l)")] == pytest.approx(math.sin(sight), abs=2e-3)
    # 7.46 m in the second just sailed
    assert obs[SYMBOLS.index("s / L")] == pytest.approx((LEG - 1007.46) / 230.0, abs=2e-3)
