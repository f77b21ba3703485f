"""Metrics of a track and of course changes, by hand and from rollouts."""

import math

import numpy as np
import pytest
from ship_gym_agents.los import ILOS, LOSPID
from ship_gym_agents.pid import PID, Gains
from ship_gym_agents.reference import Guidance

from ship_gym.evaluation import metrics, rollout
from ship_gym.evaluation.metrics import all_metrics, metrics_of
from ship_gym.recording import Trajectory
from ship_gym.tasks.track.metrics import measure
from ship_gym.tracks.guidance import on_route, passed

L = 100.0
CORNER = [[0.0, 0.0], [1000.0, 0.0], [1000.0, 1000.0]]


def voyage(places, points=CORNER, outcome="arrived", failed=False, duration=None):
    """Recording of a ship of 100 m that is at these places (north, east) [m], a second apart."""
    x, y = np.array(places, dtype=float).T
    legs, first = [0], on_route(x[0], y[0], *points[0], *points[0], *points[1], *points[-1])
    for place in places[1:]:
        k = legs[-1]
        about = [points[min(max(k + j, 0), len(points) - 1)] for j in (-1, 0, 1, 2)]
        at = on_route(*place, *(number for point in about for number in point))
        over = passed(at.to_go, at.along_next, at.cross, 0.0) == 1
        legs.append(min(k + over, len(points) - 2))
    limits = {"cross_track": 5.0, "corridor": 0.5}
    meta = {
        "ship": {"L": L, "scale": 1.0, "m_u": 1e6, "efficiency": 0.7, "power_max": 1e6},
        "config": {
            "limits": limits,
            "duration": float(duration or len(places) - 1),
            "control_interval": 1.0,
        },
        "waypoints": points,
        "outcome": outcome,
        "failed": failed,
    }
    columns = {"t": np.arange(len(places)), "x": x, "y": y, "leg": np.array(legs)}
    still = ("u", "v", "psi", "n", "torque", "current_speed", "current_direction_to")
    columns |= dict.fromkeys(still, np.zeros(len(places)))
    return Trajectory(columns | {"cross_track_error": np.full(len(places), first.cross)}, meta)


def path(*corners, step=10.0):
    """Places `step` [m] apart along straight lines between these."""
    places = [np.array(corners[0], dtype=float)]
    for a, b in zip(np.array(corners[:-1], float), np.array(corners[1:], float), strict=True):
        n = round(np.hypot(*(b - a)) / step)
        places += [a + (b - a) * k / n for k in range(1, n + 1)]
    return [place.tolist() for place in places]


def test_metrics_of_a_voyage_by_hand():
    """Six intervals: 30 m to starboard, 40 m to port, the corner cut and swung round, on track."""
    places = [(0, 20), (300, 30), (600, -40), (980, 60), (1000, 400), (1080, 700), (1000, 1001)]
    found = measure(voyage(places, duration=100.0))
    off = np.array([0.3, -0.4, 0.2, 0.0, -0.8, 0.0])  # of (980, 60): 20 m south of the next leg
    assert found["rms_route"] == pytest.approx(math.sqrt(np.mean(off**2)))
    assert found["max_route"] == pytest.approx(0.8)
    assert found["corridor"] == pytest.approx(5.0 / 6.0)
    # from the active leg (980, 60) is 60 m off: the leg of the interval that ends there
    cross = np.array([0.3, -0.4, 0.6, 0.0, -0.8, 0.0])
    assert found["rms_cross_track"] == pytest.approx(math.sqrt(np.mean(cross**2)))
    assert found["max_cross_track"] == pytest.approx(0.8)
    assert found["voyage_time"] == 6.0


def test_a_failure_is_judged_to_the_planned_end():
    lost = voyage([(0, 0), (10, 0), (20, 30)], outcome="missed the end", failed=True, duration=5.0)
    found = measure(lost)
    assert found["rms_route"] == pytest.approx(math.sqrt((0.0 + 0.09 + 3 * 25.0) / 5.0))
    assert found["corridor"] == pytest.approx(2.0 / 5.0)
    assert found["max_route"] == pytest.approx(0.3) and found["voyage_time"] == 5.0


def test_the_corridor_counts_from_the_first_interval_within_it():
    outside = [(0, 90), (10, 80), (20, 60), (30, 50), (40, 20), (50, 60), (60, 0)]
    assert measure(voyage(outside))["corridor"] == pytest.approx(3.0 / 4.0)
    assert measure(voyage([(0, 90), (10, 80), (20, 70)]))["corridor"] == 0.0
    strayed = voyage(outside, outcome="arrived, corridor left", duration=100.0)
    assert measure(strayed)["voyage_time"] == 6.0


def test_cutting_a_corner_by_a_length_is_worse_than_following_the_route():
    """A straight line from 2 L before to 2 L behind the way-point passes 1 L inside of it.

    By hand: over the 28 intervals on the diagonal e / L runs from 0 to 1 and back.
    """
    exact = measure(voyage(path(*CORNER)))
    cut = measure(voyage(path([0, 0], [800, 0], [1000, 200], [1000, 1000])))
    swung = measure(voyage(path([0, 0], [1050, 0], [1050, 100], [1000, 150], [1000, 1000])))
    assert exact["rms_route"] == pytest.approx(0.0, abs=1e-12)
    rows = 80 + 28 + 80
    assert cut["rms_route"] == pytest.approx(math.sqrt(28.0 / 3.0 / rows), rel=0.01)
    assert cut["max_route"] == pytest.approx(1.0, abs=0.04)
    assert cut["rms_route"] > swung["rms_route"] > 0.0 and cut["corridor"] < 1.0


def test_a_controller_that_cuts_corners_does_not_gain():
    """Rudder over for a circle of 6 L radius instead of what the ship needs."""
    found = {}
    for radius in (3.0, 6.0):
        los = LOSPID(Gains(K_p=2.0, K_d=2.0, guidance=Guidance(turn_radius=radius)))
        sailed = rollout(los, "track_sharp", seeds=range(8))
        found[radius] = [metrics(sailed.trajectory(i))["rms_route"] for i in range(8)]
    assert np.mean(found[6.0]) > 1.5 * np.mean(found[3.0])


@pytest.fixture(scope="module")
def sailed():
    return rollout(ILOS(), "track_following", seeds=[1, 2])


def test_metrics_of_a_track(sailed):
    L = sailed.ship.hull.L
    for i in range(2):
        t = sailed.trajectory(i)
        found = metrics(t)
        assert list(found) == list(metrics_of("track_following")) and set(found) <= set(
            all_metrics()
        )
        # the reward term is (e / L)^2 of the same intervals
        paid = -t["reward_cross_track"][:-1]
        assert found["rms_route"] == pytest.approx(math.sqrt(paid.mean()), rel=1e-9)
        judged = max(math.sqrt(paid.max()), abs(t["cross_track_error"][0]) / L)
        assert found["max_route"] == pytest.approx(judged, rel=1e-9)
        assert found["corridor"] == 1.0 and found["max_route"] <= 1.5
        assert found["rms_cross_track"] == pytest.approx(found["rms_route"], rel=0.01)
        # the columns are of the leg that holds after the interval
        off, cross = t["off_route"], t["cross_track_error"]
        assert (off[:60] == cross[:60]).all()
        assert found["voyage_time"] == sailed.lengths[i] < 3600
        assert found["success"] == 1.0 and t.meta["outcome"] == "arrived"
        assert len(t.meta["waypoints"]) == 6 and t["leg"][-1] == 4


def test_loitering_on_the_route_does_not_pay():
    """Time up at 500 m of 2000 m, always 30 m off: a quarter at 0.3 L, three at the limit, 5 L."""
    places = path((0, 30), (500, 30))
    found = measure(voyage(places, outcome="end of time"))
    assert found["rms_route"] == pytest.approx(math.sqrt(0.25 * 0.09 + 0.75 * 25.0))
    there_and_back = path((0, 0), (500, 0), (100, 0))  # 1900 m are left
    found = measure(voyage(there_and_back, outcome="end of time"))
    assert found["rms_route"] == pytest.approx(5.0 * math.sqrt(0.95))


def test_metric_and_kernel_agree_on_the_corridor():
    """In the narrow one some of these voyages leave it, some do not."""
    sailed = rollout(ILOS(), "track_corridor", seeds=range(12))
    kept = set()
    for i in range(12):
        t = sailed.trajectory(i)
        found, outcome = metrics(t), t.meta["outcome"]
        assert outcome in ("arrived", "arrived, corridor left", "missed the end")
        assert found["success"] == (outcome == "arrived")
        if outcome != "missed the end":
            assert (found["corridor"] == 1.0) == (found["max_route"] <= 0.5) == found["success"]
            kept.add(found["success"])
    assert kept == {0.0, 1.0}


def test_a_voyage_that_failed_is_judged_to_the_end(sailed):
    t = sailed.trajectory(0)
    lost = Trajectory(t.columns, t.meta | {"failed": True, "outcome": "cross-track limit"})
    found, rows = metrics(lost), len(t) - 1
    squares = metrics(t)["rms_route"] ** 2 * rows + 25.0 * (3600 - rows)
    assert found["rms_route"] == pytest.approx(math.sqrt(squares / 3600))
    assert found["voyage_time"] == 3600.0 and found["success"] == 0.0


def test_the_file_of_a_track_gives_the_same_metrics(sailed, tmp_path):
    pytest.importorskip("rerun")
    sailed.trajectory(1).to_rrd(tmp_path / "t.rrd")
    assert metrics(Trajectory.from_rrd(tmp_path / "t.rrd")) == metrics(sailed.trajectory(1))


def test_steps_of_the_course_are_averaged():
    t = rollout(PID(), "course_calm", seeds=[3]).trajectory(0)
    begins = np.flatnonzero(np.diff(t["psi_ordered"])) + 1
    assert len(begins) == 4 and begins[0] == 30
    error = np.degrees(t["psi_error"])
    over = [
        max(0.0, (-math.copysign(1.0, error[a]) * error[a:b]).max())
        for a, b in zip(begins, [*begins[1:], len(t)], strict=True)
    ]
    found = metrics(t)
    assert found["overshoot"] == pytest.approx(np.mean(over), abs=0.2)  # later swings are small
    assert 20.0 < found["settling_time"] < 150.0


def test_an_interval_is_judged_by_the_order_that_held():
    t = rollout(PID(), "course_changing", seeds=[5]).trajectory(0)
    paid = -(t["reward_heading"] + t["reward_rudder"]).sum() / 900.0
    assert metrics(t)["J_0.1"] == pytest.approx(np.degrees(np.degrees(paid)), rel=1e-9)
