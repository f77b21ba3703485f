"""A current that varies slowly, and one that does not, by hand."""

import dataclasses
import math

import numpy as np
import pytest

from ship_gym import Sea, ShipSim
from ship_gym.physics.dynamics import over_ground, vary_current, water_velocity
from ship_gym.sea.records import SEA_DTYPE
from ship_gym.sea.state import irregular_sea


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
    # cosines are right to 1e-12 (physics.angles), of 2 m/s
    assert water_velocity(psi, seas[0]) == pytest.approx((along, starboard), abs=2e-12)
    states = np.array([[5.0, 0.5, 0.0, 0.0, 0.0, psi, 0.0, 1.0]])
    over_ground(states, seas)
    assert states[0, :2] == pytest.approx([5.0 + along, 0.5 + starboard])


VARYING = Sea(
    current_speed=1.0, current_direction_to=1.1, current_variation=0.5, current_period=100.0
)
COMMAND = np.array([[0.2, 1.7]])


def test_a_ship_whose_steps_are_done_keeps_its_current():
    """Its neighbour sails five steps in the same interval."""
    intervals = np.array([1.0, 5.0])
    both = ShipSim("kcs", 2, VARYING)
    both.reset(seed=1)
    single = [ShipSim("kcs", 1, VARYING) for _ in intervals]
    for i, sim in enumerate(single):
        sim.reset(seed=1 + i)
    for _ in range(3):
        both.step(np.repeat(COMMAND, 2, axis=0), intervals)
        for sim, interval in zip(single, intervals, strict=True):
            sim.step(COMMAND, interval)
    for i, sim in enumerate(single):
        assert both.seas[i] == sim.seas[0]
        assert np.array_equal(both.state[i], sim.state[0])


def test_a_reset_forgets_the_current_of_the_last_run():
    sim = ShipSim("kcs", 1, VARYING)
    first = sim.reset(seed=1).copy()
    sim.step(COMMAND, 30.0)
    assert np.array_equal(sim.reset(seed=1), first)


def test_waves_in_it_are_the_same_whatever_interval_was_set_before_a_reset():
    waves = irregular_sea(4.0, 10.0, direction_from=2.2)
    sea = dataclasses.replace(
        waves, current_speed=1.0, current_variation=0.5, current_period=100.0, wave_count=8
    )
    sim = ShipSim("kcs", 1, sea)
    runs = []
    for _ in range(2):  # the first time none is set
        sim.reset(seed=1)
        runs.append(sim.step(COMMAND, 1.0).copy())
    sim.set_interval(0.3)
    sim.reset(seed=1)
    runs.append(sim.step(COMMAND, 1.0).copy())
    assert np.array_equal(runs[0], runs[1]) and np.array_equal(runs[0], runs[2])


def test_halving_the_step_in_it_quarters_the_error():
    """The current of a step is that of its middle: of first order it would be halved."""
    places = []
    for step in (4.0, 2.0, 0.125):
        sim = ShipSim("kcs", 1, VARYING)
        sim.longest[:] = step
        sim.reset(seed=1)
        for _ in range(20):
            sim.step([[0.0, 1.7]], 4.0)
        places.append(sim.state[0, :6].copy())
    coarse, fine = (np.abs(place - places[2])[[0, 3, 4]] for place in places[:2])
    assert (fine < 0.35 * coarse).all(), (coarse, fine)
