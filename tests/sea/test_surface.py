"""The surface from its waves: sizes, shapes, and that its phases are those that the ship feels."""

import math

import numpy as np
import pytest

from ship_gym import ShipEnv, ShipSim
from ship_gym.envs.episode_record import Setting, conditions_of
from ship_gym.physics.waves import WAVE_SWAY, WAVE_SWAY_VELOCITY
from ship_gym.sea import regular_sea
from ship_gym.sea.surface import WAVE_ENTRIES, elevation

ONE = {"amplitude": [2.0], "omega": [0.5], "k": [0.025], "direction_to": [0.0], "phase": [0.0]}


def waves_of(sim, i=0):
    amplitude, omega, k, turns, to = sim.water.waves_of(i)
    return dict(zip(WAVE_ENTRIES, (amplitude, omega, k, to, 2.0 * math.pi * turns), strict=True))


def test_one_wave_is_a_cosine_that_runs_where_it_goes_to():
    """2 m high at the origin at first; a quarter of a period later a quarter of a length north."""
    period, length = 2.0 * math.pi / 0.5, 2.0 * math.pi / 0.025
    assert elevation(ONE, 0.0, 0.0, 0.0) == pytest.approx(2.0)
    assert elevation(ONE, 0.25 * length, 0.0, 0.25 * period) == pytest.approx(2.0)
    assert elevation(ONE, -0.25 * length, 0.0, 0.25 * period) == pytest.approx(-2.0)
    east = ONE | {"direction_to": [0.5 * math.pi]}
    assert elevation(east, 77.0, 0.25 * length, 0.25 * period) == pytest.approx(2.0)
    assert elevation(ONE | {"phase": [math.pi]}, 0.0, 0.0, 0.0) == pytest.approx(-2.0)


def test_shapes_broadcast_and_a_calm_sea_is_flat():
    x, y = np.meshgrid(np.arange(3.0), np.arange(4.0), indexing="ij")
    t = np.arange(5.0)[:, None, None]
    found = elevation(ONE, x, y, t)
    assert found.shape == (5, 3, 4)
    assert found[2, 1, 3] == pytest.approx(float(elevation(ONE, 1.0, 3.0, 2.0)), rel=1e-14)
    none = {name: [] for name in WAVE_ENTRIES}
    assert not elevation(none, x, y, 0.0).any()


def test_the_height_of_a_recorded_sea_is_that_of_its_meta():
    """H_s = 4 sqrt(m_0) of the surface over time, within its own scatter in two hours."""
    env = ShipEnv(overrides={"sea.states": ["ss5"]})
    env.reset(seed=3)
    meta = conditions_of(env.episodes, 0, Setting(env.scenario, env.ship)).meta()
    found = elevation(meta["waves"], 0.0, 0.0, np.arange(0.0, 7200.0, 0.5))
    assert 4.0 * found.std() == pytest.approx(meta["sea"]["wave_height"], rel=0.06)


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("towards", [0.5 * math.pi, -0.5 * math.pi])
def test_a_ship_in_long_waves_moves_as_the_water_under_the_surface(towards, seed):
    """Under a crest water goes where the wave goes; under a trough back.

    In beam waves of eight ship lengths the hull moves sideways nearly as that water does: its
    sway velocity, which the kernel has from its own phases, is in phase with the elevation at the
    ship, and its sway with the slope: zeta = a cos(theta) moves the water by a sin(theta) where the
    wave goes to.
    """
    sea = regular_sea(1.0, wavelength=8 * 230.0, direction_from=towards + math.pi)
    sim = ShipSim("kcs", sea=sea)
    sim.reset(seed=seed)
    rows = []
    for _ in range(300):
        sim.step([[0.0, sim.state[0, 7]]], 1.0)
        velocity, sway = sim.waves[0, [WAVE_SWAY_VELOCITY, WAVE_SWAY]]
        rows.append((sim.time[0], *sim.state[0, 3:5], velocity, sway))
    t, x, y, velocity, sway = np.array(rows).T
    side = math.copysign(1.0, towards)  # to starboard of a ship that heads north
    surface = elevation(waves_of(sim), x, y, t)
    assert np.corrcoef(surface, side * velocity)[0, 1] > 0.99
    slope = elevation(waves_of(sim), x, y + 1.0, t) - elevation(waves_of(sim), x, y - 1.0, t)
    assert np.corrcoef(slope, sway)[0, 1] > 0.99
    assert surface.std() == pytest.approx(1.0 / math.sqrt(2.0), rel=0.1)
