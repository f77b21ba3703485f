"""Sailing a track: legs, arrival, limits, and what is seen of them."""

import math

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.conventions import PSI, X, Y
from ship_gym.envs.env import ShipEnv
from ship_gym.envs.vector_env import ShipVectorEnv
from ship_gym.tasks.base import RUNNING
from ship_gym.tasks.track.kernels import ARRIVED, MISSED, STRAYED, TRACK_LIMIT
from ship_gym.tracks import SHAPES, Track, save_track

CALM = {"sea.states": [], "sea.gusts": False, "sea.current_speed": 0.0, "sensors.noise": False}
STILL = CALM | {"start.heading_error_deg": 0.0, "start.cross_track": 0.0}
L = 230.0


def corner(**changes):
    """North for 2000 m, then east for 2000 m."""
    points = [[0.0, 0.0], [2000.0, 0.0], [2000.0, 2000.0]]
    track = {"track.kind": "points", "track.points": points}
    env = ShipEnv(scenario="track_following", overrides=STILL | track | changes)
    env.reset(seed=0)
    return env


def place(env, north, east, psi=0.0):
    """Put the ship somewhere and sail one interval."""
    state = env.episodes.sim.state
    state[0, [X, Y, PSI]] = north, east, psi
    return env.step(np.zeros(1))


def test_what_is_seen_of_a_leg():
    env = corner()
    obs, _, terminated, _, info = place(env, 500.0, 100.0, 0.1)
    x, y = env.episodes.sim.state[0, [X, Y]]
    assert not terminated and info["leg"] == 0
    assert obs[9] == pytest.approx(y / L, rel=1e-6)
    assert obs[10] == pytest.approx(math.sin(0.1), abs=2e-3)  # U = U0 along the heading
    assert obs[11] == pytest.approx((2000.0 - x) / L, rel=1e-6)
    assert obs[12] == pytest.approx(0.5)  # 90 deg to starboard
    psi = env.episodes.sim.state[0, PSI]
    sight = psi + math.atan(y / (3.0 * L))
    assert (obs[13], obs[14]) == pytest.approx((math.sin(sight), math.cos(sight)), abs=1e-6)
    assert info["cross_track"] == pytest.approx(y)
    assert info["reward_terms"]["cross_track"] == pytest.approx(-((y / L) ** 2), rel=1e-9)


def test_the_next_leg_begins_at_the_bisector():
    env = corner()
    # inside of the turn, before and beyond the line at 45 deg through the way-point
    _, _, _, _, info = place(env, 2000.0 - 120.0, 100.0)
    assert info["leg"] == 0
    obs, _, _, _, info = place(env, 2000.0 - 95.0, 100.0)
    assert info["leg"] == 1 and info["psi_ordered"] == pytest.approx(0.5 * math.pi)
    # the ship is south of the eastward leg: to starboard of it
    assert obs[9] == pytest.approx((95.0 - 7.4) / L, abs=0.005)
    assert obs[0] == pytest.approx(-1.0, abs=1e-3)
    assert obs[12] == 0.0


def test_turning_early_or_late_the_error_does_not_jump():
    """200 m before the corner, 80 m inside: the next leg is 200 m off, the active one 80 m."""
    env = corner()
    *_, info = place(env, 1800.0, 80.0, 0.25 * math.pi)
    assert info["leg"] == 0 and info["cross_track"] == pytest.approx(80.0, abs=6.0)
    # nearer to the next leg already, though the active one is 140 m away
    obs, *_, info = place(env, 1900.0, 140.0, 0.5 * math.pi)
    assert info["leg"] == 1 and info["cross_track"] == pytest.approx(100.0, abs=0.5)
    assert info["reward_terms"]["cross_track"] == pytest.approx(-((100.0 / L) ** 2), rel=0.01)
    assert obs[9] == pytest.approx(100.0 / L, abs=0.002)
    # outside of the turn the way-point itself is the nearest
    env = corner()
    *_, info = place(env, 2030.0, -40.0)
    assert info["leg"] == 0 and info["cross_track"] == pytest.approx(-math.hypot(37.5, 40), abs=0.2)


def test_a_circle_counts_to_a_quarter_of_the_shorter_leg_and_never_at_the_end():
    env = corner(**{"track.acceptance": 2.0})
    *_, info = place(env, 2000.0 - 2.2 * L, 30.0)
    assert info["leg"] == 0
    *_, info = place(env, 2000.0 - 1.95 * L, 30.0)  # 449 m, within 460 m and 500 m
    assert info["leg"] == 1
    _, _, terminated, *_ = place(env, 2000.0, 2000.0 - 1.0 * L, 0.5 * math.pi)
    assert not terminated
    points = [[0.0, 0.0], [2000.0, 0.0], [2000.0, 800.0]]
    env = corner(**{"track.acceptance": 2.0, "track.points": points})
    *_, info = place(env, 2000.0 - 210.0, 0.0)  # a quarter of 800 m is 200 m
    assert info["leg"] == 0
    *_, info = place(env, 2000.0 - 205.0, 0.0)
    assert info["leg"] == 1


def test_a_reset_tells_how_far_off_the_first_leg_the_ship_is():
    env = ShipEnv(scenario="track_following", overrides=CALM | {"start.cross_track": 2.0})
    for seed in range(5):
        obs, info = env.reset(seed=seed)
        assert abs(obs[9]) > 0.01 and info["cross_track"] == pytest.approx(obs[9] * L, rel=1e-6)


def test_given_way_points_stay_where_they_are_and_the_ship_starts_at_the_first():
    points = [[300.0, -700.0], [2000.0, -700.0]]
    env = ShipEnv(
        scenario="track_following",
        overrides=STILL | {"track.kind": "points", "track.points": points},
    )
    env.reset(seed=0)
    assert env.episodes.sim.state[0, [X, Y]].tolist() == [300.0, -700.0]
    assert env.episodes.plans[0].tolist() == points


def test_arrival_abeam_of_the_end_is_a_success():
    env = corner()
    place(env, 2000.0, 100.0)
    _, _, terminated, _, info = place(env, 2000.0, 1990.0, 0.5 * math.pi)
    assert not terminated and info["leg"] == 1
    _, reward, terminated, truncated, info = place(env, 2000.0, 1996.0, 0.5 * math.pi)
    assert terminated and not truncated
    assert info["outcome"] == ARRIVED and info["is_success"] and info["cost"] == 0.0
    assert info["reward_terms"]["termination"] == 0.0 and reward > -1.0


def test_the_end_passed_outside_the_corridor_is_missed():
    env = corner()
    place(env, 2000.0, 100.0)
    _, _, terminated, _, info = place(env, 2000.0 - 1.51 * L, 1996.0, 0.5 * math.pi)
    assert terminated and info["outcome"] == MISSED and not info["is_success"]
    assert info["reward_terms"]["termination"] == -200.0 and info["cost"] == 1.0


def test_a_corridor_left_on_the_way_costs_the_success_alone():
    env = corner()
    place(env, 500.0, 1.49 * L)
    place(env, 1000.0, 0.0)
    place(env, 2000.0, 100.0)
    *_, info = place(env, 2000.0, 1996.0, 0.5 * math.pi)
    assert info["outcome"] == ARRIVED
    env = corner()
    place(env, 500.0, 0.0)
    place(env, 500.0, 1.51 * L)
    place(env, 2000.0, 100.0)
    _, _, terminated, _, info = place(env, 2000.0, 1996.0, 0.5 * math.pi)
    assert terminated and info["outcome"] == STRAYED and not info["is_success"]
    assert info["reward_terms"]["termination"] == 0.0 and info["cost"] == 0.0


def test_a_start_outside_the_corridor_is_no_leaving_of_it():
    env = corner(**{"limits.corridor": 0.2})
    place(env, 100.0, 0.4 * L)
    place(env, 1000.0, 0.0)
    place(env, 2000.0, 100.0)
    *_, info = place(env, 2000.0, 1996.0, 0.5 * math.pi)
    assert info["outcome"] == ARRIVED
    env.reset(seed=1)  # forgets the last voyage
    place(env, 100.0, 0.1 * L)
    place(env, 100.0, 0.4 * L)
    place(env, 2000.0, 100.0)
    *_, info = place(env, 2000.0, 1996.0, 0.5 * math.pi)
    assert info["outcome"] == STRAYED


def test_one_leg_of_300_m_is_sailed_to_its_end():
    env = corner(**{"track.points": [[0.0, 0.0], [300.0, 0.0]]})
    terminated, steps = False, 0
    while not terminated and steps < 60:
        _, _, terminated, _, info = env.step(np.zeros(1))
        steps += 1
    assert info["outcome"] == ARRIVED
    assert steps == pytest.approx(300.0 / env.ship.speed, abs=2.0)  # 40 s, not one


STAIRS = [[0.0, 0.0], [250.0, 0.0], [250.0, 250.0], [500.0, 250.0], [500.0, 500.0], [750.0, 500.0]]


def test_a_track_that_the_ship_cannot_sail_is_refused_before_it_starts(tmp_path):
    told = r"leg from way-point 0 to 1 is 250 m.* 0 and 90 deg .*690 m.*track.turn_radius = 3 L"
    with pytest.raises(ConfigError, match=told):
        corner(**{"track.points": STAIRS})
    file = tmp_path / "stairs.geojson"
    save_track(Track(STAIRS), file)
    with pytest.raises(ConfigError, match=told):
        corner(**{"track.points": (), "track.file": str(file)})
    with pytest.raises(ConfigError, match=r"from way-point 1 to 2 is 2760 m long.* 3680 m"):
        ShipEnv(scenario="track_square", overrides={"track.turn_radius": 8.0})
    for shape in SHAPES:
        ShipEnv(scenario="track_following", overrides={"track.kind": shape})  # by the default
    # a model of it can: 250 m are 34 lengths
    track = {"track.kind": "points", "track.points": STAIRS}
    ShipEnv(ship="kcs_model", scenario="track_following", overrides=track)


def test_stairs_of_250_m_are_not_climbed_with_the_rudder_amidships():
    """With a circle of 2 L every way-point was "reached" so, and the voyage a success."""
    circle = {"track.points": STAIRS, "track.any_turns": True, "track.acceptance": 2.0}
    env = corner(**circle)
    for _ in range(200):
        _, _, terminated, _, info = env.step(np.zeros(1))
        if terminated:
            break
    assert terminated and not info["is_success"]
    assert info["outcome"] in (MISSED, TRACK_LIMIT)


def test_a_ship_of_a_fleet_that_cannot_sail_it_counts():
    points = [[0.0, 0.0], [800.0, 0.0], [800.0, 800.0]]
    track = {"track.kind": "points", "track.points": points}
    ShipEnv(ship="kcs", scenario="track_following", overrides=track)
    for ships in ("kvlcc2", ["kcs", "kvlcc2"]):
        with pytest.raises(ConfigError, match=r"800 m long.* 960 m"):
            ShipVectorEnv(2, ship=ships, scenario="track_following", overrides=track)


def test_five_lengths_off_the_track_end_it_as_failed():
    env = corner()
    *_, info = place(env, 500.0, -4.99 * L)
    assert info["outcome"] == RUNNING
    _, _, terminated, _, info = place(env, 500.0, -5.01 * L)
    assert terminated and info["outcome"] == TRACK_LIMIT and not info["is_success"]
    assert info["reward_terms"]["termination"] == -200.0 and info["cost"] == 1.0


def test_time_runs_out_without_success():
    env = corner(duration=3.0)
    for _ in range(3):
        _, _, terminated, truncated, info = env.step(np.zeros(1))
    assert truncated and not terminated and not info["is_success"]


def test_random_tracks_start_abeam_of_their_first_point_and_are_turned_any_way():
    env = ShipEnv(scenario="track_following")
    bearings = []
    for seed in range(60):
        env.reset(seed=seed)
        e = env.episodes
        leg = e.plans[0, 1] - e.plans[0, 0]
        bearing = math.atan2(leg[1], leg[0])
        bearings.append(bearing)
        assert e.tasks["psi_ordered"][0] == pytest.approx(bearing)
        offset = e.sim.state[0, [X, Y]] - e.plans[0, 0]
        assert abs(offset @ leg) < 1e-6 * np.hypot(*leg) * L
        assert np.hypot(*offset) <= 0.5 * L + 1e-9
        lengths = np.hypot(*np.diff(e.plans[0], axis=0).T) / L
        assert lengths.min() >= 3.0 - 1e-9 and lengths.max() <= 15.0 + 1e-9
        error = e.sim.state[0, PSI] - bearing
        assert abs((error + math.pi) % (2.0 * math.pi) - math.pi) <= math.radians(10.0) + 1e-9
    assert np.ptp(bearings) > 5.0


def test_a_model_sails_the_same_track_to_scale_but_given_points_stay():
    full, model = (ShipEnv(ship=s, scenario="track_following") for s in ("kcs", "kcs_model"))
    for env in (full, model):
        env.reset(seed=4)
    scale = full.ship.hull.L / model.ship.hull.L
    np.testing.assert_allclose(full.episodes.plans, model.episodes.plans * scale, rtol=1e-12)
    assert corner().episodes.plans[0, 2].tolist() == [2000.0, 2000.0]


def test_a_track_from_a_file(tmp_path):
    file = tmp_path / "track.geojson"
    file.write_text(
        '{"type": "Feature", "properties": {"units": "m"}, "geometry": '
        '{"type": "LineString", "coordinates": [[0, 0], [0, 3000], [900, 5000]]}}'
    )
    env = ShipEnv(
        scenario="track_following", overrides={"track.kind": "points", "track.file": str(file)}
    )
    env.reset(seed=0)
    assert env.episodes.plans[0].tolist() == [[0.0, 0.0], [3000.0, 0.0], [5000.0, 900.0]]
