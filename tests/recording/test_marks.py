"""Marks: what a reader looks for is found at its time, and nothing else is made up."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ship_gym.recording import Trajectory
from ship_gym.recording.marks import AT_LIMIT, KINDS, marks, spells, worst_moment
from ship_gym.recording.task_error import task_error
from ship_gym.tasks.bridge import SATURATED

SHIP = {"name": "kcs", "L": 230.0, "scale": 1.0, "speed": 7.0, "delta_max": 0.6, "n_max": 2.0}
CONFIG = {"control_interval": 1.0}


def run(columns=None, rows: int = 200, **meta) -> Trajectory:
    t = np.arange(rows) * 1.0
    base = {"t": t, "psi": 0.0 * t, "psi_ordered": 0.0 * t, "delta": 0.0 * t, "n": 1.0 + 0.0 * t}
    base |= {"u": 7.0 + 0.0 * t, "v": 0.0 * t}
    meta = {"ship": SHIP, "config": CONFIG, "outcome": "end of time", "failed": False} | meta
    return Trajectory(base | (columns or {}), meta)


def of(kind: str, trajectory: Trajectory) -> list[tuple[float, str]]:
    assert kind in KINDS
    return [(mark.time, mark.text) for mark in marks(trajectory) if mark.kind == kind]


def test_share_of_a_limit_is_that_of_the_metric():
    assert AT_LIMIT == SATURATED


def test_largest_error_is_the_one_made_and_not_the_one_given_at_the_start():
    t = np.arange(200.0)
    psi = np.radians(20.0) * np.exp(-t / 10.0) * np.cos(t / 12.0)
    psi[150] = -math.radians(3.0)
    overshoot = int(np.argmin(psi[:100]))
    found = of("error", run({"psi": psi}))
    assert found[0] == (0.0, "heading error at the start +20.0\N{DEGREE SIGN}")
    assert found[1][0] == 150.0
    assert "-3.0\N{DEGREE SIGN}, that of the start aside" in found[1][1]
    psi[150] = 0.0
    assert worst_moment(run({"psi": psi})) == overshoot


def test_error_that_grows_beyond_that_of_the_start_counts():
    psi = np.radians(np.linspace(5.0, 60.0, 200))
    assert of("error", run({"psi": psi})) == [(199.0, "largest heading error +60.0\N{DEGREE SIGN}")]


def test_what_is_left_of_a_given_error_is_not_made():
    psi = np.radians(20.0) * np.exp(-np.arange(200.0) / 10.0)
    psi[180:] = math.radians(0.1)
    assert worst_moment(run({"psi": psi})) == 180.0


def test_error_that_never_comes_down_is_that_of_the_start():
    psi = np.radians(np.linspace(20.0, 10.0, 200))
    assert worst_moment(run({"psi": psi})) == 0.0


def test_new_order_gives_an_error_that_is_not_made():
    ordered = np.where(np.arange(200) < 50, 0.0, 0.5)
    psi = np.where(np.arange(200) < 120, 0.0, 0.48)
    psi[150:] = 0.53
    found = run({"psi": psi, "psi_ordered": ordered})
    assert worst_moment(found) == 150.0
    assert of("leg", found) == [
        (50.0, "ordered heading 029\N{DEGREE SIGN}, 28.6\N{DEGREE SIGN} to starboard")
    ]


def test_error_of_the_meta_comes_first():
    column = np.zeros(200)
    column[70] = -2.0
    named = {"column": "too_fast", "label": "speed above the order", "unit": "m/s"}
    trajectory = run({"too_fast": column}, error=named)
    assert task_error(trajectory).unit == "m/s"
    assert of("error", trajectory) == [(70.0, "largest speed above the order -2 m/s")]
    assert worst_moment(trajectory) == 70.0


def test_angles_of_the_meta_are_shown_in_degrees():
    named = {"column": "psi", "label": "heading error", "unit": "rad"}
    found = task_error(run({"psi": np.full(200, 0.5 * math.pi)}, error=named))
    assert (found.unit, found.values[0], found.stepped) == ("deg", 90.0, True)


def test_failed_run_is_worst_at_its_end():
    trajectory = run({"psi": np.full(200, 0.1)}, failed=True, outcome="heading limit")
    assert worst_moment(trajectory) == 199.0
    assert of("end", trajectory) == [(199.0, "heading limit: the episode has failed")]


def test_recording_that_breaks_off_says_so():
    assert of("end", run(complete=False, outcome=None)) == [
        (199.0, "the recording breaks off here")
    ]


def test_rudder_at_its_limit_is_marked_once_for_each_spell():
    delta = np.zeros(200)
    delta[10:20], delta[25:30] = 0.6, -0.6  # closer than 30 s: one
    delta[100:110] = -0.6
    assert of("saturation", run({"delta": delta})) == [
        (10.0, "rudder at its limit both ways, 15 s of 20 s"),
        (100.0, "rudder at its limit to port, 10 s"),
    ]


def test_only_the_longest_spells_are_marked_and_counted():
    delta = np.zeros(400)
    for k, begin in enumerate(range(10, 400, 70)):
        delta[begin : begin + 3 + k] = 0.6
    found = of("saturation", run({"delta": delta}, rows=400))
    assert [time for time, _ in found] == [220.0, 290.0, 360.0]
    assert found[-1][1].endswith("8.0 s, the longest of 6 times")


def test_spells_of_a_model_are_apart_in_her_own_time():
    mask = np.zeros(60, dtype=bool)
    mask[[10, 20]] = True
    t = np.arange(60.0)
    assert spells(mask, t, 30.0) == [(10, 20)]
    assert spells(mask, t, 30.0 / 10.0) == [(10, 10), (20, 20)]
    delta = 0.6 * mask
    assert len(of("saturation", run({"delta": delta}, rows=60, ship=SHIP | {"scale": 100.0}))) == 2


def test_limits_of_corridor_speed_engine_and_tables():
    t = np.arange(200.0)
    columns = {
        "off_route": np.where((t >= 20) & (t < 60), 250.0, 0.0),
        "u": np.where((t >= 30) & (t < 40), 3.0, 7.0),
        "n": np.where(t >= 190, 2.0, 1.0),
        "torque": np.where(t >= 195, 1e6, 0.0),
        "extrapolation": np.where(t == 100, 0.25, 0.0),
    }
    ship = SHIP | {"power_max": 2.0 * math.pi * 2.0 * 1e6}
    assert of("limit", run(columns, ship=ship, limits={"corridor": 230.0})) == [
        (20.0, "outside the corridor of 230 m, 40 s"),
        (30.0, "slower through the water than half the nominal speed, 10 s"),
        (100.0, "propeller or rudder outside their trained box, 1.0 s, by up to 25 % of its size"),
        (190.0, "propeller at its largest speed, 9.0 s"),
        (195.0, "engine at its largest power, 4.0 s"),
    ]


def test_current_does_not_make_a_ship_slow():
    current = {"current_speed": np.full(200, 4.0), "current_direction_to": np.full(200, math.pi)}
    assert of("limit", run({"u": np.full(200, 3.0), **current})) == []
    assert len(of("limit", run({"u": np.full(200, 3.0)}))) == 1


@pytest.mark.parametrize(("scale", "time"), [(1.0, 100.0), (4.0, 50.0)])
def test_failure_begins_in_the_ship_s_own_time(scale, time):
    config = CONFIG | {"failure": {"time": 99.5, "rudder_rate": 0.1}}
    trajectory = run(config=config, ship=SHIP | {"scale": scale})
    assert of("failure", trajectory) == [(time, "the rudder moves at 10 % of its rate")]


def test_lost_gyro_comes_back_in_the_ship_s_own_time():
    config = CONFIG | {"failure": {"time": 20.0, "dropout": 60.0, "heading_bias_deg": -5.0}}
    trajectory = run(config=config, ship=SHIP | {"scale": 4.0})
    text = "the gyro is wrong by -5\N{DEGREE SIGN}; the gyro is lost for 30 s"
    assert of("failure", trajectory) == [(10.0, text)]


def test_failure_that_is_none_or_comes_after_the_end_is_not_marked():
    nothing = {"time": 0.0, "rudder_rate": 1.0, "propeller_speed": None, "heading_bias_deg": 0.0}
    assert of("failure", run(config=CONFIG | {"failure": nothing})) == []
    late = nothing | {"time": 500.0, "propeller_speed": 0.5}
    assert of("failure", run(config=CONFIG | {"failure": late})) == []


def test_legs_of_a_track():
    leg = np.where(np.arange(200) < 80, 0.0, 1.0)
    trajectory = run({"leg": leg, "psi_ordered": 0.5 * math.pi * leg}, waypoints=[[0, 0]] * 3)
    begins = "leg 2 of 2 begins, course 090\N{DEGREE SIGN}, 90\N{DEGREE SIGN} to starboard"
    assert of("leg", trajectory) == [(80.0, begins)]


def test_order_that_moves_all_the_time_has_no_steps():
    assert of("leg", run({"psi_ordered": 0.001 * np.arange(200.0)})) == []


def manoeuvre(columns, **config) -> Trajectory:
    return Trajectory(columns, {"ship": SHIP, "config": config, "task": config["manoeuvre"]})


def test_turning_circle_has_its_quarters():
    t = np.arange(1001.0)
    columns = {"t": t, "psi": -0.01 * t, "r": -0.01 + 0.0 * t, "delta_command": -0.6 + 0.0 * t}
    trajectory = manoeuvre(columns, manoeuvre="turning_circle")
    fastest, *found = of("leg", trajectory)
    assert fastest == (0.0, "fastest turn, 0.57\N{DEGREE SIGN}/s to port")
    assert worst_moment(trajectory) == 0.0
    assert [text.split("\N{DEGREE SIGN}")[0] for _, text in found] == "90 180 270 360 540".split()
    assert found[0][0] == math.ceil(50.0 * math.pi)
    assert of("end", trajectory) == [(1000.0, "end of the manoeuvre")]


def test_zigzag_has_its_orders_and_where_the_heading_turns_back():
    t = np.arange(0.0, 120.0)
    psi = np.radians(15.0) * np.sin(2.0 * math.pi * t / 80.0)
    command = np.radians(np.where((t < 12) | (t >= 50), 10.0, -10.0))
    columns = {"t": t, "psi": psi, "delta_command": command}
    found = of("leg", manoeuvre(columns, manoeuvre="zigzag"))
    assert found == [
        (12.0, "rudder ordered 10\N{DEGREE SIGN} to port"),
        (20.0, "heading turns back 15\N{DEGREE SIGN} to starboard"),
        (50.0, "rudder ordered 10\N{DEGREE SIGN} to starboard"),
        (60.0, "heading turns back 15\N{DEGREE SIGN} to port"),
    ]


def test_bare_recording_has_an_end_alone():
    trajectory = Trajectory({"t": [0.0, 1.0]}, {"ship": "kcs", "config": None})
    assert [mark.kind for mark in marks(trajectory)] == ["end"]
    assert worst_moment(trajectory) == 1.0


def test_a_distance_to_a_route_has_a_side():
    t = np.arange(10.0)
    columns = {"t": t, "off_route": np.where(t == 4.0, -170.4, 12.25)}
    error = task_error(Trajectory(columns, {}))
    assert (error.text(4), error.text(0)) == ("170 m to port", "12.2 m to starboard")
    assert "largest distance to the route 170 m to port" in [
        mark.text for mark in marks(Trajectory(columns, {}))
    ]
