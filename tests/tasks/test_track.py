"""Sailing a track: legs, arrival, limits, and what is seen of them."""

import math

import numpy as np
import pytest

from ship_gym.conventions import PSI, X, Y
from ship_gym.envs.env import ShipEnv
from ship_gym.tasks.base import RUNNING
from ship_gym.tasks.track.kernels import ARRIVED, TRACK_LIMIT

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


def test_the_next_leg_begins_in_the_circle_and_the_interval_is_judged_by_the_old_one():
    env = corner()
    _, _, _, _, info = place(env, 2000.0 - 2.2 * L, 30.0)
    assert info["leg"] == 0
    obs, _, _, _, info = place(env, 2000.0 - 1.95 * L, 30.0)
    assert info["leg"] == 1 and info["psi_ordered"] == pytest.approx(0.5 * math.pi)
    # the reward is that of the old leg, all else that of the new one
    assert info["reward_terms"]["cross_track"] == pytest.approx(-((30.0 / L) ** 2), rel=0.01)
    assert info["cross_track"] == pytest.approx(obs[9] * L, rel=1e-6)
    # the ship is south of the eastward leg: to starboard of it
    assert obs[9] == pytest.approx(1.95 - 7.4 / L, abs=0.02)
    assert obs[0] == pytest.approx(-1.0, abs=1e-3)
    assert obs[12] == 0.0


def test_a_reset_tells_how_far_off_the_first_leg_the_ship_is():
    env = ShipEnv(scenario="track_following", overrides=CALM | {"start.cross_track": 2.0})
    for seed in range(5):
        obs, info = env.reset(seed=seed)
        assert abs(obs[9]) > 0.01 and info["cross_track"] == pytest.approx(obs[9] * L, rel=1e-6)


def test_a_missed_circle_is_passed_abeam():
    env = corner()
    _, _, terminated, _, info = place(env, 1990.0, 2.5 * L)
    assert not terminated and info["leg"] == 0
    _, _, terminated, _, info = place(env, 2001.0, 2.5 * L)
    assert not terminated and info["leg"] == 1


def test_given_way_points_stay_where_they_are_and_the_ship_starts_at_the_first():
    points = [[300.0, -700.0], [2000.0, -700.0]]
    env = ShipEnv(
        scenario="track_following",
        overrides=STILL | {"track.kind": "points", "track.points": points},
    )
    env.reset(seed=0)
    assert env.episodes.sim.state[0, [X, Y]].tolist() == [300.0, -700.0]
    assert env.episodes.plans[0].tolist() == points


def test_arrival_ends_the_episode_as_a_success():
    env = corner()
    place(env, 2000.0, 100.0)
    _, reward, terminated, truncated, info = place(env, 2000.0, 2000.0 - 1.9 * L, 0.5 * math.pi)
    assert terminated and not truncated
    assert info["outcome"] == ARRIVED and info["is_success"] and info["cost"] == 0.0
    assert info["reward_terms"]["termination"] == 0.0 and reward > -1.0


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
