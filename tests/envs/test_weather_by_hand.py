"""Where waves, wind and current go in an episode, and when an order changes, by hand."""

import math

import gymnasium as gym
import numpy as np
import pytest

from ship_gym import load_ship

HEADING, COURSE = "ShipGym/HeadingKeeping-v0", "ShipGym/CourseChanging-v0"
CALM = {"sea.states": [], "sea.gusts": False, "sea.current_speed": 0.0, "sensors.noise": False}


def direction(north, east):
    return math.atan2(east, north)


def angle(a, b):
    """Difference of two directions [deg], in [-180, 180)."""
    return math.degrees((a - b + math.pi) % (2.0 * math.pi) - math.pi)


@pytest.mark.parametrize("ship", ["kcs", "kcs_model"])
@pytest.mark.parametrize(
    ("waves", "wind", "current"), [(90.0, 90.0, 180.0), (180.0, -45.0, 30.0), (-120.0, 0.0, -90.0)]
)
def test_encounter_angles_count_from_the_ordered_heading(ship, waves, wind, current):
    """psi - direction_to = the angle asked for: 90 deg comes from starboard, 180 from ahead.

    12 m/s of wind and 0.5 m/s of current at full scale, slower by the root of the scale.
    """
    sea = {
        "sea.wave_height": 3.0,
        "sea.wave_height_min": 3.0,
        "sea.wave_encounter_deg": waves,
        "sea.wind_speed": 12.0,
        "sea.wind_speed_min": 12.0,
        "sea.wind_encounter_deg": wind,
        "sea.current_speed": 0.5,
        "sea.current_speed_min": 0.5,
        "sea.current_encounter_deg": current,
    }
    env = gym.make(HEADING, ship=ship, overrides=CALM | sea)
    root = math.sqrt(load_ship(ship).scale)
    for seed in range(3):
        _, info = env.reset(seed=seed)
        episodes, order = env.unwrapped.episodes, info["psi_ordered"]
        seas = episodes.sim.seas[0]
        assert angle(order, episodes.tasks["wave_to"][0]) == pytest.approx(
            angle(math.radians(waves), 0.0), abs=1e-9
        )
        wind_to = direction(seas["wind_north"], seas["wind_east"])
        current_to = direction(seas["V_north"], seas["V_east"])
        for towards, wanted in ((wind_to, wind), (current_to, current)):
            off = angle(order - towards, math.radians(wanted))
            assert off == pytest.approx(0.0, abs=1e-9)
        assert math.hypot(seas["wind_north"], seas["wind_east"]) == pytest.approx(12.0 / root)
        assert math.hypot(seas["V_north"], seas["V_east"]) == pytest.approx(0.5 / root)


def test_wind_and_current_lie_between_their_two_limits_and_reach_near_both():
    sea = {"sea.wind_speed": 14.0, "sea.wind_speed_min": 6.0}
    sea |= {"sea.current_speed": 1.0, "sea.current_speed_min": 0.4}
    env = gym.make(HEADING, overrides=CALM | sea)
    found = []
    for seed in range(60):
        env.reset(seed=seed)
        seas = env.unwrapped.episodes.sim.seas[0]
        found.append(
            [
                math.hypot(seas["wind_north"], seas["wind_east"]),
                math.hypot(seas["V_north"], seas["V_east"]),
            ]
        )
    low, high = np.min(found, axis=0), np.max(found, axis=0)
    assert 6.0 <= low[0] < 6.5 and 13.5 < high[0] <= 14.0
    assert 0.4 <= low[1] < 0.45 and 0.95 < high[1] <= 1.0


@pytest.mark.parametrize(
    ("first", "dt", "interval"),
    [(3.0, 1.0, 3), (2.4, 1.0, 2), (2.6, 1.0, 3), (6.0, 2.0, 3), (0.0, 1.0, 1)],
)
def test_an_order_comes_at_the_interval_nearest_to_its_time(first, dt, interval):
    """At 0 s it comes after the first interval: an episode begins with another order."""
    changes = {"course.first": first, "control_interval": dt, "duration": 10.0 * dt}
    env = gym.make(COURSE, overrides=CALM | changes)
    _, info = env.reset(seed=1)
    before = info["psi_ordered"]
    changed = []
    for k in range(1, 8):
        *_, info = env.step(np.zeros(1))
        if info["psi_ordered"] != before:
            changed.append(k)
            before = info["psi_ordered"]
    assert changed == [interval]


@pytest.mark.parametrize(("smallest", "largest"), [(20.0, 20.0), (5.0, 60.0)])
def test_steps_of_the_order_go_to_either_side_within_their_sizes(smallest, largest):
    changes = {"course.step_min_deg": smallest, "course.step_max_deg": largest}
    env = gym.make(COURSE, overrides=CALM | changes | {"course.first": 1.0})
    steps = []
    for seed in range(40):
        _, info = env.reset(seed=seed)
        before = info["psi_ordered"]
        *_, info = env.step(np.zeros(1))
        steps.append(angle(info["psi_ordered"], before))
    assert min(steps) < 0.0 < max(steps)
    sizes = np.abs(steps)
    assert smallest - 1e-9 <= sizes.min() and sizes.max() <= largest + 1e-9
    if smallest < largest:
        assert sizes.min() < 12.0 and sizes.max() > 50.0
