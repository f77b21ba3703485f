"""Scenes: directions and signs, what a recording gets of them, and what they refuse."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.conventions import PSI, STATE_NAMES, polar
from ship_gym.rendering.camera import camera_for, clipped, foot, nearest_foot, way_ahead
from ship_gym.rendering.scene import Scene


def scene(**changes) -> Scene:
    base = {"task": "Track following", "ship": "KCS", "L": 200.0, "B": 32.0, "U0": 7.0}
    base |= {"delta_max": 0.6, "n_max": 2.0, "state": np.zeros(8), "command": np.zeros(2)}
    return Scene(**(base | changes))


TRACK = np.array([[0.0, 0.0], [1000.0, 0.0], [1000.0, 2000.0]])


def at(north: float, east: float) -> np.ndarray:
    return np.array([7.0, 0.0, 0.0, north, east, 0.0, 0.0, 1.0])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"L": 0.0}, "L = 0.0: must be above 0"),
        ({"U0": -1.0}, "U0 = -1.0: allowed"),
        ({"n_max": math.inf}, "n_max = inf"),
        ({"state": np.zeros(7)}, r"state has shape \(7,\), allowed is \(8,\)"),
        ({"state": np.full(8, np.nan)}, "state = .*must be finite"),
        ({"command": np.zeros(3)}, "command has shape"),
        ({"wake": np.zeros((5, 3))}, "wake has shape"),
        ({"track": np.zeros((3, 3))}, "track has shape"),
        ({"track": TRACK, "active_leg": 2}, "active_leg = 2: allowed is 0 to 1"),
        ({"track": np.zeros((1, 2))}, "a track needs at least 2 way-points, it has 1"),
    ],
)
def test_scenes_that_cannot_be_drawn_are_refused(changes, message):
    with pytest.raises(ConfigError, match=message):
        scene(**changes)


def test_directions():
    assert polar(0.0, 2.0) == pytest.approx((2.0, 0.5 * math.pi))  # to the east
    assert polar(-3.0, 0.0) == pytest.approx((3.0, math.pi))
    east = at(0.0, 0.0)
    east[PSI] = 0.5 * math.pi
    # A ship that heads east in a current to the east makes less way through the water; a part of
    # the current to the north, its port side, moves it through the water to starboard.
    found = scene(state=east, current=(0.5, 2.0)).water_velocity
    assert found == pytest.approx((5.0, 0.5))
    turned = at(0.0, 0.0)
    turned[PSI] = 0.1
    assert scene(state=turned, psi_ordered=0.3).heading_error == pytest.approx(-0.2)
    assert scene().heading_error is None


def test_row_has_the_columns_of_a_recording():
    row = scene(
        state=at(5.0, 6.0), time=9.0, psi_ordered=6.2, track=TRACK, cross_track=6.0,
        current=(0.0, 0.5), wind=(-8.0, 0.0), reward=-1.0, reward_terms={"heading": -1.0},
    ).row()  # fmt: skip
    assert row["t"] == 9.0
    assert [row[name] for name in STATE_NAMES] == at(5.0, 6.0).tolist()
    assert row["psi_error"] == pytest.approx(2.0 * math.pi - 6.2)
    assert row["off_route"] == 6.0
    assert (row["current_speed"], row["current_direction_to"]) == (0.5, 0.5 * math.pi)
    assert (row["wind_speed"], row["wind_direction_from"]) == (8.0, 0.0)  # blows to the south
    assert row["reward_heading"] == -1.0
    assert all(isinstance(value, float) for value in row.values())
    assert "psi_error" not in scene().row()


def test_foot_and_way_ahead():
    beside = scene(state=at(400.0, 150.0), track=TRACK)
    assert foot(beside).tolist() == [400.0, 0.0]
    assert way_ahead(beside, 100.0).tolist() == [500.0, 0.0]
    assert way_ahead(beside, 700.0).tolist() == [1000.0, 100.0]  # round the corner
    assert way_ahead(beside, 1e6).tolist() == [1000.0, 2000.0]
    assert foot(scene(state=at(-50.0, 20.0), track=TRACK)).tolist() == [0.0, 0.0]


def test_the_nearest_foot_may_be_on_the_leg_before_or_after():
    near_next = scene(state=at(900.0, 400.0), track=TRACK)
    assert foot(near_next).tolist() == [900.0, 0.0]
    assert nearest_foot(near_next).tolist() == [1000.0, 400.0]
    outside = scene(state=at(1040.0, -30.0), track=TRACK)
    assert nearest_foot(outside).tolist() == foot(outside).tolist() == [1000.0, 0.0]


def test_camera_has_north_up_and_shows_ship_and_leg():
    still = camera_for(scene(state=at(50.0, 80.0)), 640.0, 540.0)
    assert still.place([50.0, 80.0]).tolist() == [320.0, 270.0]
    north, east = still.place([[60.0, 80.0], [50.0, 90.0]])
    assert north[1] < 270.0
    assert east[0] > 320.0
    off = scene(state=at(400.0, 1000.0), track=TRACK)
    camera = camera_for(off, 640.0, 540.0)
    places = camera.place([off.position, foot(off), way_ahead(off, 600.0)])
    assert (places > 60.0).all()
    assert (places < (580.0, 480.0)).all()


def test_lines_are_cut_at_the_edge_of_the_picture():
    starts = np.array([[-1e9, 50.0], [10.0, 10.0], [-50.0, -50.0], [50.0, -1e9], [-30.0, 20.0]])
    ends = np.array([[1e9, 50.0], [20.0, 20.0], [-40.0, 90.0], [50.0, 1e9], [60.0, -25.0]])
    first, last, seen = clipped(starts, ends, (100.0, 100.0), margin=0.0)
    assert seen.tolist() == [True, True, False, True, True]
    assert first[[0, 3]] == pytest.approx(np.array([[0.0, 50.0], [50.0, 0.0]]), abs=1e-6)
    assert last[[0, 3]] == pytest.approx(np.array([[100.0, 50.0], [50.0, 100.0]]), abs=1e-6)
    assert (first[1] == starts[1]).all()
    assert (last[1] == ends[1]).all()
    assert first[4] == pytest.approx([0.0, 5.0])
    assert last[4] == pytest.approx([10.0, 0.0])


def test_a_line_that_leaves_the_picture_comes_back_as_two():
    camera = camera_for(scene(), 640.0, 540.0)
    far = 1e6
    loop = np.array([[0.0, 0.0], [100.0, 0.0], [far, 0.0], [far, far], [0.0, 300.0], [0.0, 0.0]])
    runs = camera.runs(loop)
    assert len(runs) == 2
    assert len(runs[0]) == 3
    assert camera.runs(loop[:1]) == []
