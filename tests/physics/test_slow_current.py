"""A current that varies slowly, and one that does not, by hand."""

import math

import numpy as np
import pytest

from ship_gym.physics.dynamics import over_ground, vary_current, water_velocity
from ship_gym.sea.records import SEA_DTYPE


def sea(**values):
    record = np.zeros(1, SEA_DTYPE)
    for name, value in values.items():
        record[name] = value
    return record


@pytest.mark.parametrize(
    ("turns", "factor"), [(0.0, 1.5), (0.25, 1.0), (0.5, 0.5), (0.75, 1.0), (1.0, 1.5)]
)
def test_a_varying_current_is_its_mean_times_1_plus_half_a_cosine(turns, factor):
    """2 m/s to the north and 1 m/s to the west, period 600 s."""
    seas = sea(variation=0.5, variation_omega=2.0 * math.pi / 600.0, mean_north=2.0, mean_east=-1.0)
    vary_current(turns * 600.0, seas[0])
    assert seas["V_north"][0] == pytest.approx(2.0 * factor)
    assert seas["V_east"][0] == pytest.approx(-factor)


def test_its_phase_is_a_share_of_a_turn_at_time_zero():
    seas = sea(variation=0.5, variation_omega=0.01, variation_phase=0.5, mean_north=2.0)
    vary_current(0.0, seas[0])
    assert seas["V_north"][0] == pytest.approx(1.0)


def test_a_steady_current_stays():
    seas = sea(mean_north=2.0, mean_east=-1.0, V_north=0.3, V_east=0.4)
    vary_current(100.0, seas[0])
    assert (seas["V_north"][0], seas["V_east"][0]) == (0.3, 0.4)


@pytest.mark.parametrize(
    ("psi", "along", "starboard"),
    [
        (0.0, 2.0, -1.0),
        (0.5 * math.pi, -1.0, -2.0),
        (math.pi, -2.0, 1.0),
        (-0.5 * math.pi, 1.0, 2.0),
    ],
)
def test_current_in_the_axes_of_the_ship(psi, along, starboard):
    """2 m/s to the north and 1 m/s to the west: heading east, 1 m/s from ahead, 2 m/s to port."""
    seas = sea(V_north=2.0, V_east=-1.0)
    assert water_velocity(psi, seas[0]) == pytest.approx((along, starboard), abs=1e-12)
    states = np.array([[5.0, 0.5, 0.0, 0.0, 0.0, psi, 0.0, 1.0]])
    over_ground(states, seas)
    assert states[0, :2] == pytest.approx([5.0 + along, 0.5 + starboard])
