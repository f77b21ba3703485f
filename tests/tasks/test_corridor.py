"""Corridors of single legs and sides: in the kernels, in the metrics and in what is seen."""

import math

import numpy as np
import pytest
from ship_gym_agents.los import ILOS

from ship_gym.config import ConfigError
from ship_gym.conventions import PSI, X, Y
from ship_gym.envs.env import ShipEnv
from ship_gym.evaluation.rollout import rollout
from ship_gym.recording import Trajectory
from ship_gym.tasks.base import RUNNING
from ship_gym.tasks.track import plan as plans
from ship_gym.tasks.track.kernels import ARRIVED, KEPT, LEFT, MISSED, STRAYED, TRACK_LIMIT
from ship_gym.tasks.track.metrics import measure
from ship_gym.tracks import Track
from ship_gym.tracks.guidance import nearest_leg

STILL = {
    "sea.states": [],
    "sea.gusts": False,
    "sea.current_speed": 0.0,
    "sensors.noise": False,
    "start.heading_error_deg": 0.0,
    "start.cross_track": 0.0,
}
L = 230.0
POINTS = [[0.0, 0.0], [2000.0, 0.0], [2000.0, 2000.0]]
NAN = math.nan
# the first leg has room to starboard and little to port, the second only a limit to port
LIMITS = [[60.0, 600.0], [100.0, NAN]]


@pytest.fixture
def sea_room(monkeypatch):
    """An environment whose way-points have these limits, whatever the file says."""

    def make(limits=LIMITS, points=POINTS, **changes):
        given = {"track.kind": "points", "track.points": points}
        with monkeypatch.context() as patch:
            patch.setattr(plans, "load_track", lambda *_: Track(points, limits=limits))
            env = ShipEnv(scenario="track_following", overrides=STILL | given | changes)
        env.reset(seed=0)
        return env

    return make


def place(env, north, east, psi=0.0):
    """Put the ship somewhere and sail one interval, of 7 m."""
    env.episodes.sim.state[0, [X, Y, PSI]] = north, east, psi
    *_, info = env.step(np.zeros(1))
    return info["outcome"], int(env.episodes.tasks["kept"][0])


def test_each_side_of_each_leg_has_its_own_corridor(sea_room):
    inside = {(500.0, 599.0): KEPT, (500.0, -59.0): KEPT}
    outside = {(500.0, 601.0): LEFT, (500.0, -61.0): LEFT}
    for (north, east), kept in (inside | outside).items():
        env = sea_room()
        place(env, 300.0, 0.0)
        assert place(env, north, east) == (RUNNING, kept)
    # the second leg leads east: port is north; starboard has the scenario's 1.5 L = 345 m
    for north, kept in ((2099.0, KEPT), (2101.0, LEFT), (1656.0, KEPT), (1654.0, LEFT)):
        env = sea_room()
        place(env, 300.0, 0.0)
        place(env, 2000.0, 100.0)
        assert place(env, north, 1000.0, 0.5 * math.pi) == (RUNNING, kept)


def test_the_episode_ends_at_as_many_corridors_aside_as_in_the_scenario(sea_room):
    """5 L by 1.5 L: 200 m to port of the first leg, 2000 m to starboard."""
    far = 5.0 / 1.5
    assert place(sea_room(), 500.0, -60.0 * far + 1.0)[0] == RUNNING
    assert place(sea_room(), 500.0, -60.0 * far - 1.0)[0] == TRACK_LIMIT
    assert place(sea_room(points=[[0.0, 0.0], [9000.0, 0.0]], limits=[[60.0, 600.0]]), 500.0,
                 600.0 * far - 1.0)[0] == RUNNING  # fmt: skip
    assert place(sea_room(points=[[0.0, 0.0], [9000.0, 0.0]], limits=[[60.0, 600.0]]), 500.0,
                 600.0 * far + 1.0)[0] == TRACK_LIMIT  # fmt: skip


def test_the_end_is_missed_by_the_limit_of_its_side(sea_room):
    for north, outcome in (
        (2099.0, ARRIVED),
        (2101.0, MISSED),
        (1656.0, ARRIVED),
        (1654.0, MISSED),
    ):
        env = sea_room()
        place(env, 300.0, 0.0)
        place(env, 2000.0, 100.0)
        assert place(env, north, 1996.0, 0.5 * math.pi)[0] == outcome
    env = sea_room()
    place(env, 300.0, 0.0)
    place(env, 500.0, -61.0)
    place(env, 2000.0, 100.0)
    assert place(env, 2000.0, 1996.0, 0.5 * math.pi)[0] == STRAYED


def test_the_limit_is_that_of_the_nearest_leg_and_outside_of_a_turn_of_the_active_one(sea_room):
    # 80 m short of the corner and 150 m to starboard: the second leg is nearer, 80 m away
    env = sea_room(limits=[[60.0, 100.0], [60.0, 90.0]])
    place(env, 300.0, 0.0)
    assert place(env, 1912.0, 150.0, 0.5 * math.pi)[1] == KEPT
    # beyond the corner the way-point is the nearest place of both legs
    voyage = (
        np.array(POINTS),
        np.array([0, 1]),
        np.array([2030.0, 2030.0]),
        np.array([-40.0, -40.0]),
    )
    assert nearest_leg(*voyage).tolist() == [0, 1]


def test_tracks_without_limits_are_as_they_were(sea_room):
    """The same bits with the scenario's corridor written as limits of all legs."""
    plain, given = sea_room(limits=None), sea_room(limits=[[1.5 * L] * 2] * 2)
    assert plain.episodes.plans.shape[2] == 2 and given.episodes.plans.shape[2] == 4
    assert sea_room(limits=[[NAN, NAN]] * 2).episodes.plans.shape[2] == 2
    for _ in range(50):
        one, other = (env.step(np.array([0.1])) for env in (plain, given))
        assert one[0].tobytes() == other[0].tobytes() and one[1] == other[1]


def test_a_limit_narrower_than_a_tenth_of_the_ship_is_refused(sea_room):
    told = r"leg 2 allows 10 m to port; at least 23 m is needed"
    with pytest.raises(ConfigError, match=told):
        sea_room(limits=[[NAN, NAN], [10.0, NAN]])


def test_a_limit_of_a_file_is_told_with_the_file_and_the_way_point(tmp_path):
    pytest.importorskip("pyproj", reason="extra 'geo' not installed")
    from ship_gym.envs.env import ShipEnv
    from ship_gym.tracks import Leg, Route, Waypoint, save_track

    path = tmp_path / "route.geojson"
    places = [Waypoint(54.0, 8.0), Waypoint(54.1, 8.0), Waypoint(54.2, 8.0, name="Buoy")]
    save_track(Route("r", tuple(places), (Leg(), Leg(port=10.0))), path)
    told = r"route.geojson: track: the leg to way-point 2 \('Buoy'\) allows 10 m to port; at least"
    with pytest.raises(ConfigError, match=told):
        ShipEnv(scenario="track_calm", overrides={"track.kind": "points", "track.file": str(path)})


def test_pieces_of_a_turn_that_are_shorter_than_an_interval_are_all_passed(sea_room):
    """A quarter of a circle of 1000 m in pieces of 3 m, of which she passes two in a second."""
    angle = np.linspace(0.0, 0.5 * math.pi, 520)
    arc = np.stack([1000.0 * np.sin(angle), 1000.0 * (1.0 - np.cos(angle))], axis=1)
    points = [[-800.0, 0.0], *arc.tolist(), [1000.0, 1900.0]]
    env = sea_room(points=points, limits=None)
    env.episodes.sim.state[0, [X, Y]] = 0.0, 0.0
    for t in range(160):
        way = min(t * 7.0 / 1000.0, 0.5 * math.pi)
        past = max(t * 7.0 - 500.0 * math.pi, 0.0)
        north, east = 1000.0 * math.sin(way), 1000.0 * (1.0 - math.cos(way)) + past
        env.episodes.sim.state[0, [X, Y, PSI]] = north, east, way
        *_, info = env.step(np.zeros(1))
        assert abs(info["cross_track"]) < 1.0
        behind = np.degrees(abs(env.episodes.sim.state[0, PSI] - info["psi_ordered"]))
        assert behind < 1.5  # the active leg is the one she is on


def voyage(places, limits=LIMITS, leg=None, **meta):
    """Recording of a ship that is at these places (north, east) [m], a second apart."""
    x, y = np.array(places, dtype=float).T
    count = len(places)
    meta = {
        "ship": {"L": 100.0, "scale": 1.0, "m_u": 1e6, "efficiency": 0.7, "power_max": 1e6},
        "config": {
            "limits": {"cross_track": 5.0, "corridor": 0.5},
            "duration": float(count - 1),
            "control_interval": 1.0,
        },
        "waypoints": POINTS,
        "leg_limits": limits,
        "outcome": "arrived",
        "failed": False,
    } | meta
    columns = {"t": np.arange(count), "x": x, "y": y, "leg": np.array(leg or [0] * count)}
    still = ("u", "v", "psi", "n", "torque", "current_speed", "current_direction_to")
    columns |= dict.fromkeys(still, np.zeros(count))
    return Trajectory(columns | {"cross_track_error": np.zeros(count)}, meta)


def test_the_metric_judges_each_side_of_each_leg():
    """Of nine intervals three are outside: by the scenario's corridor of 50 m it were six."""
    limits = [[60.0, 600.0], [100.0, 50.0]]
    first = [(100.0, 0.0), (200.0, 40.0), (300.0, 599.0), (500.0, 601.0), (700.0, -59.0)]
    first += [(900.0, -61.0)]
    second = [(2099.0, 500.0), (2101.0, 900.0), (1951.0, 1400.0), (2000.0, 2000.0)]
    legs = [0] * 5 + [1] * 5  # that of an interval is the leg at its start
    found = measure(voyage(first + second, limits, legs))
    assert found["corridor"] == pytest.approx(6.0 / 9.0)
    same = measure(voyage(first + second, [[50.0, 50.0]] * 2, legs))
    plain = voyage(first + second, limits, legs)
    del plain.meta["leg_limits"]
    assert measure(plain)["corridor"] == same["corridor"] == pytest.approx(3.0 / 9.0)


def test_a_failure_counts_with_the_widest_limit_of_the_legs():
    """Failing early never pays: what is not sailed counts as 600 m by 0.5 L times 5 L."""
    limits = {"cross_track": 5.0, "corridor": 0.5}
    config = {"limits": limits, "duration": 4.0, "control_interval": 1.0}
    meta = {"failed": True, "outcome": "missed the end", "config": config}
    lost = voyage([(0, 0), (10, 0), (20, 0)], [[60.0, 600.0]] * 2, **meta)
    assert measure(lost)["rms_route"] == pytest.approx(math.sqrt(2 * 60.0**2 / 4.0))


def test_what_is_seen_and_recorded_of_a_corridor(sea_room, monkeypatch, tmp_path):
    env = sea_room()
    place(env, 500.0, -30.0)
    scene = env.episodes.task.scene(env.episodes, 0)
    assert scene["corridor"] == 60.0 and scene["cross_track_limit"] == pytest.approx(200.0)
    assert scene["leg_limits"].tolist() == [[60.0, 600.0], [100.0, 1.5 * L]]
    given = {"track.kind": "points", "track.points": POINTS}
    monkeypatch.setattr(plans, "load_track", lambda *_: Track(POINTS, limits=LIMITS))
    sailed = rollout(ILOS(), "track_following", seeds=[1], overrides=STILL | given)
    t = sailed.trajectory(0)
    assert t.meta["leg_limits"] == [[60.0, 600.0], [100.0, 1.5 * L]]
    assert np.shape(t.meta["waypoints"]) == (3, 2)
    assert t["corridor_port"][0] == 60.0 and t["corridor_starboard"][0] == 600.0
    assert t.meta["frame"].startswith("x north, y east [m] in a plane without a place")
    assert 0.0 < t.meta["metrics"]["corridor"] <= 1.0
