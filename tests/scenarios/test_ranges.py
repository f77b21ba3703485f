"""The ends of the allowed ranges: an end is taken, what lies beyond is not."""

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.envs.start_options import start_options
from ship_gym.scenarios.scenario import load_scenario
from ship_gym.sea.components import omega_of_length

RANGES = [
    ("heading_keeping", "sensors.heading_deg", 0.0, 45.0),
    ("heading_keeping", "sensors.yaw_rate_deg_s", 0.0, 10.0),
    ("heading_keeping", "sensors.speed", 0.0, 10.0),
    ("heading_keeping", "sensors.position", 0.0, 1000.0),
    ("heading_keeping", "randomisation.surrogate_std", 0.0, 3.0),
    ("heading_keeping", "randomisation.hull_std", 0.0, 0.2),
    ("heading_keeping", "randomisation.interaction_std", 0.0, 0.3),
    ("heading_keeping", "randomisation.loading", 0.0, 0.4),
    ("heading_keeping", "randomisation.gear", 0.0, 0.9),
    ("heading_keeping", "randomisation.sensors", 0.0, 1.0),
    ("heading_keeping", "failure.heading_bias_deg", -180.0, 180.0),
    ("heading_keeping", "failure.rudder_rate", 0.0, 1.0),
    ("heading_keeping", "failure.propeller_speed", 0.0, 1.0),
    ("heading_keeping", "failure.dropout", 0.0, 1e6),
    ("heading_keeping", "sensors.dropout_rate", 0.0, 3600.0),
    ("heading_keeping", "limits.heading_error_deg", 1.0, 180.0),
    ("course_changing", "limits.overshoot_deg", 0.1, 180.0),
    ("heading_keeping", "start.heading_error_deg", 0.0, 180.0),
    ("heading_keeping", "sea.current_speed", 0.0, 10.0),
    ("heading_keeping", "sea.sway_disturbance", 0.0, 0.1),
    ("heading_keeping", "sea.yaw_disturbance", 0.0, 0.02),
    ("heading_keeping", "reward.heading", 0.0, 1e9),
    ("course_changing", "course.changes", 1, 50),
    ("course_changing", "course.step_max_deg", 0.0, 180.0),
    ("track_following", "track.legs", 1, 100),
    ("track_following", "track.turn_max_deg", 0.0, 150.0),
    ("track_following", "track.leg_max", 0.1, 1000.0),
    ("track_following", "track.turn_radius", 1e-3, 100.0),
    ("track_following", "track.acceptance", 0.0, 20.0),
    ("track_following", "track.look_ahead", 0.1, 100.0),
    ("track_following", "start.cross_track", 0.0, 100.0),
    ("track_following", "limits.cross_track", 0.1, 100.0),
    ("track_following", "limits.corridor", 0.1, 100.0),
]
# what must fit a value at its end
BESIDE = {
    "course.step_max_deg": {"course.step_min_deg": 0.0},
    "failure.rudder_rate": {"failure.time": 60.0},
    "failure.propeller_speed": {"failure.time": 60.0},
    "failure.heading_bias_deg": {"failure.time": 60.0},
    "failure.dropout": {"failure.time": 60.0},
    "sensors.dropout_rate": {"sensors.dropout_time": 60.0},
    "limits.cross_track": {"start.cross_track": 0.0},
}
# ends that another rule refuses: of the other field, or a failure that is none
CROSSED = {
    ("failure.rudder_rate", 1.0),
    ("failure.dropout", 0.0),
    ("sensors.dropout_rate", 0.0),
    ("limits.heading_error_deg", 1.0),
    ("start.cross_track", 100.0),
    ("start.heading_error_deg", 180.0),
    ("track.leg_max", 0.1),
}


@pytest.mark.parametrize(("scenario", "key", "low", "high"), RANGES, ids=str)
def test_an_end_is_taken_and_nothing_beyond(scenario, key, low, high):
    whole, beside = isinstance(low, int), BESIDE.get(key, {})
    for end, beyond in ((low, -np.inf), (high, np.inf)):
        if (key, end) not in CROSSED:
            load_scenario(scenario, beside | {key: end})
        outside = end + (1 if beyond > 0 else -1) if whole else float(np.nextafter(end, beyond))
        with pytest.raises(ConfigError, match=f"{key.split('.')[1]} = "):
            load_scenario(scenario, beside | {key: outside})


def test_seeds_of_a_sea_are_whole_numbers_of_63_bits():
    start_options({"sea_seed": 2**63 - 1}, 1)
    with pytest.raises(ConfigError, match="sea_seed"):
        start_options({"sea_seed": 2**63}, 1)


def test_lengths_of_waves():
    for end, beyond in ((1e-2, 0.0), (1e4, np.inf)):
        assert omega_of_length(end) > 0.0
        with pytest.raises(ConfigError, match="wavelength = "):
            omega_of_length(float(np.nextafter(end, beyond)))
