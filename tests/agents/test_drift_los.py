"""The estimated drift by hand; how the ship sails with it: ``test_los``."""

import math

import numpy as np
import pytest
from ship_gym_agents.drift_los import DriftLOS
from ship_gym_agents.pid import Gains
from ship_gym_agents.reference import Guidance

from ship_gym import load_scenario, load_ship
from ship_gym.config import ConfigError
from ship_gym.evaluation.comparison import per_episode
from ship_gym.evaluation.rollout import rollout, tuning_seeds
from ship_gym.tasks.columns import observation_columns

SCENARIO, KCS = load_scenario("track_following"), load_ship("kcs")
STEP = KCS.speed / KCS.hull.L  # control interval of 1 s over L / U0
COLUMNS = observation_columns(SCENARIO)


def started(drift_time=1e3, count=1):
    law = DriftLOS(Gains(1.0, 1.0, guidance=Guidance(look_ahead=2.0, drift_time=drift_time)))
    law.reset(count, KCS, SCENARIO)
    return law


def seen(error=0.0, surge=1.0, cross_track=0.0, rate=0.0, to_go=20.0, turn=0.0):
    """Observation of one ship, off the bearing of the leg by `error` [rad]."""
    row = np.zeros((1, len(COLUMNS)))
    values = {"sin_error": math.sin(error), "cos_error": math.cos(error), "surge": surge}
    values |= {"cross_track": cross_track, "cross_track_rate": rate, "to_go": to_go}
    values |= {"next_turn": turn / math.pi}
    for name, value in values.items():
        row[0, COLUMNS[name]] = value
    return COLUMNS.view(row)


def wanted(law, view, jump=0.0):
    return law._wanted(view, np.array([jump]))[0]


def sail(law, intervals=3, error=0.3, drift=(0.1, -0.2), to_go=20.0):
    """Straight on off the leg in a drift along and across it; the last wanted heading."""
    for k in range(intervals):
        made = math.cos(error) + drift[0]
        view = seen(error, rate=math.sin(error) + drift[1], to_go=to_go - k * STEP * made)
        last = wanted(law, view)
    return last


def test_the_drift_by_hand():
    """What the ship makes good less her way through the water, and the crab angle against it."""
    law = started()
    last = sail(law)
    assert law._drift[:, 0] == pytest.approx([0.1, -0.2])
    assert last == pytest.approx(math.asin(0.2))  # set to port: steer to starboard


def test_the_course_over_ground_is_that_of_the_line_of_sight():
    """Way through the water and drift together go to the point ahead on the leg."""
    law, drift = started(), (0.15, -0.25)
    sail(law, drift=drift)
    heading = wanted(law, seen(0.3, rate=math.sin(0.3) - 0.25, cross_track=1.0, to_go=-9.0))
    north, east = math.cos(heading) + drift[0], math.sin(heading) + drift[1]
    assert math.atan2(east, north) == pytest.approx(-math.atan(1.0 / 2.0))


def test_a_new_leg_turns_the_axes_and_not_the_drift():
    law = started()
    sail(law, drift=(0.1, -0.2))
    turn = math.radians(90.0)
    wanted(law, seen(rate=-0.1, to_go=15.0), jump=-turn)
    # to the north is now to port across the leg, to the west backwards along it
    assert law._drift[:, 0] == pytest.approx([-0.2, -0.1])


def test_the_drift_is_smoothed_over_its_time():
    law = started(drift_time=5.0)
    for _ in range(400):
        wanted(law, seen())
    wanted(law, seen(rate=0.5))
    assert law._drift[1, 0] == pytest.approx(0.5 * STEP / 5.0)


def test_distances_that_the_observation_cuts_off_say_nothing():
    law = started()
    for _ in range(5):
        wanted(law, seen(to_go=50.0))
    assert law._drift[0, 0] == 0.0


def test_a_drift_faster_than_the_ship_is_limited():
    assert abs(sail(started(), drift=(0.0, 3.0))) < math.pi / 4


def test_rows_do_not_know_each_other():
    """Episodes of different seeds, together and alone; each with its own gains in a batch."""
    seeds = tuning_seeds(2)
    env = {"scenario": "track_following", "overrides": {"duration": 300.0}}
    rows = np.array([2.0, 4.0])
    gains = Gains(2.0, 2.0, guidance=Guidance(look_ahead=rows, drift_time=rows))
    both = per_episode(rollout(DriftLOS(gains), seeds=seeds, **env))["rms_cross_track"]
    for k in range(2):
        own = Gains(2.0, 2.0, guidance=Guidance(look_ahead=rows[k], drift_time=rows[k]))
        alone = per_episode(rollout(DriftLOS(own), seeds=[seeds[k]], **env))
        assert alone["rms_cross_track"] == [both[k]]


def test_an_observation_without_positions_is_refused():
    with pytest.raises(ConfigError, match=r"drift_los needs cross_track, .*cross_track_rate"):
        DriftLOS(Gains(1.0, 1.0)).reset(1, KCS, load_scenario("heading_keeping"))
