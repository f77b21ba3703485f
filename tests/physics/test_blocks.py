"""A batch in blocks of 64: every ship has the bits that she has alone, whoever is beside her."""

import functools
import os
import subprocess
import sys

import numpy as np
import pytest

from ship_gym.physics._threads import BLOCK
from ship_gym.physics.parameters import Traits
from ship_gym.sea.spectra import WaveSystem
from ship_gym.sea.state import Sea
from ship_gym.ships import load_ship
from ship_gym.simulation import ShipSim, longest_step

WAVES = (WaveSystem("jonswap", 3.0, 9.0, spreading=1.0),)
ROUGH = Sea(
    current_speed=0.5, current_direction_to=1.0, current_variation=0.3, sway_disturbance=0.01,
    yaw_disturbance=0.001, waves=WAVES, wave_count=20, wind_speed=12.0, gusts=True,
)  # fmt: skip
SEAS = {"calm": Sea(), "rough": ROUGH}
SIZES = (1, 2, 7, 63, 64, 65, 200)
SEEN = ("state", "time", "forces", "flow", "waves")


def orders(ships, steps):
    """Commands of each ship, shape (steps, n, 2), and her interval [s], shape (n,), by her row.

    Intervals of one to three integration steps.
    """
    n = len(ships)
    row, k = np.arange(n), np.arange(steps)[:, None]
    rudder = [s.gear.delta_max for s in ships] * np.sin(0.4 * k + row)
    speed = [0.6 * s.engine.n_max for s in ships] * (1.0 + 0.4 * np.cos(0.3 * k + row))
    longest = np.array([longest_step(s) for s in ships])
    return np.stack([rudder, speed], axis=-1), longest * (0.8 + row % 3)


def sailed(ships, sea, rows=None, steps=6, change=None, traits=(), parallel=False):
    """A simulation of the given rows of some ships, each with her own orders and phases."""
    commands, dt = orders(ships, steps)
    rows = np.arange(len(ships)) if rows is None else np.asarray(rows)
    sim = ShipSim([ships[i] for i in rows], len(rows), sea, parallel)
    sim.expect(*traits)
    sim.reset(0)
    # ship i has the phases of stream i, alone as in company
    uniform = [np.random.default_rng(i).random(sim.water.n_phases) for i in rows]
    sim.set_sea(np.arange(len(rows)), np.array(uniform), sim.seas["wave_to"].copy())
    if change is not None:
        change(sim.records, rows)
    for command in commands:
        sim.step(command[rows], dt[rows])
    return sim


def same(one, other, rows=slice(None)):
    for name in SEEN:
        found, expected = getattr(one, name), getattr(other, name)[rows]
        columns = min(found.shape[-1], expected.shape[-1]) if name == "flow" else None
        if columns is not None:  # a ship of one propeller in the company of two has more columns
            found, expected = found[:, :columns], expected[:, :columns]
        np.testing.assert_array_equal(found, expected, err_msg=name)


def check_alone(ships, sea, alone=None, **other):
    whole = sailed(ships, sea, **other)
    for i in range(len(ships)) if alone is None else alone:
        same(sailed(ships, sea, [i], **other), whole, [i])


def randomised(records, rows):
    records["hull"]["R_0"] *= 1.0 + 0.01 * (rows % 11)
    records["rudder"]["f_alpha"] *= 1.0 - 0.005 * (rows % 7)


def drawn(records, rows):
    """Surrogates moved by their standard deviations."""
    for k, name in enumerate(("z_T", "z_Q", "z_S", "z_N", "z_A")):
        records["surrogate"][name] = 0.1 * ((rows + k) % 5 - 2)


@pytest.fixture(autouse=True)
def _own_versions(request):
    """The slow tests compile as for users; the others with the one version of most tests."""
    if request.node.get_closest_marker("slow"):
        request.getfixturevalue("own_versions")


@pytest.mark.compiled
@pytest.mark.parametrize("sea", SEAS)
def test_batches_of_every_size_are_the_ships_alone(sea):
    """Those of a smaller batch are the first ones of a larger, and some sail alone."""
    ships = [load_ship("kcs")] * max(SIZES)
    whole = sailed(ships, SEAS[sea])
    for n in SIZES:
        same(sailed(ships, SEAS[sea], range(n)), whole, slice(n))
    for i in (1, 62, 63, 64, 65, 127, 128, 199):
        same(sailed(ships, SEAS[sea], [i]), whole, [i])
    assert (np.diff(whole.state, axis=0)[:, 5] != 0.0).all()  # no ship is like her neighbour


@pytest.mark.compiled
def test_ships_that_differ_are_the_ships_alone():
    """Resistance and rudder randomised: columns of parameters instead of constants."""
    check_alone([load_ship("kcs")] * 70, ROUGH, (0, 1, 5, 63, 64, 69), change=randomised)


@pytest.mark.compiled
@pytest.mark.slow
def test_drawn_surrogates_are_the_ships_alone():
    check_alone(
        [load_ship("kcs")] * 66, ROUGH, (0, 1, 5, 63, 64, 65), change=drawn,
        traits=("each", "spread"),
    )  # fmt: skip


@pytest.mark.compiled
@pytest.mark.slow
@pytest.mark.parametrize("sea", SEAS)
def test_a_mixed_fleet_is_its_ships_alone(sea):
    """Of one propeller and two, of other wake laws; a ship alone is compiled for herself."""
    ships = [load_ship(name) for name in ("kcs", "onrt", "kvlcc2")] * 22
    check_alone(ships, SEAS[sea], (0, 1, 2, 62, 63, 64, 65))


@pytest.mark.compiled
@pytest.mark.slow
def test_a_fleet_of_two_scales_is_its_ships_alone():
    """The model takes many more integration steps than the ship in the same water."""
    ships = [load_ship("kcs"), load_ship("kcs_model")] * 33
    check_alone(ships, Sea(0.3, 1.0), (0, 1, 63, 64, 65))


@pytest.mark.compiled
def test_steps_of_other_numbers_do_not_disturb_each_other():
    """An interval of three steps is three intervals of one, beside ships that take one."""
    ship, steps = load_ship("kcs"), (3, 1, 2, 1)
    sim = ShipSim(ship, 4, ROUGH, False)
    sim.reset(0)
    command = np.tile([0.2, 1.4], (4, 1))
    h = 0.9 * longest_step(ship)
    for _ in range(3):
        sim.step(command, h * np.array(steps))
    for i, number in enumerate(steps):
        one = ShipSim(ship, 1, ROUGH)
        one.reset(i)
        for _ in range(3 * number):
            one.step(command[:1], h)
        # the clock adds up otherwise: t + 3 h, and t + h + h + h
        np.testing.assert_allclose(one.state[0], sim.state[i], rtol=1e-10, atol=1e-10)


@pytest.mark.compiled
@pytest.mark.parametrize("sea", SEAS)
def test_threads_change_no_bit(sea):
    ships = [load_ship("kcs")] * (3 * BLOCK + 5)
    same(sailed(ships, SEAS[sea], parallel=True), sailed(ships, SEAS[sea]))


@pytest.mark.compiled
@pytest.mark.slow
@pytest.mark.parametrize("name", ["kcs", "kvlcc2", "onrt", "s175"])
def test_the_version_of_one_ship_has_the_bits_of_the_version_of_all(name):
    ships = [load_ship(name)] * 5
    same(sailed(ships, ROUGH, traits=Traits._fields), sailed(ships, ROUGH))


@pytest.mark.slow
def test_records_written_while_sailing_are_noticed():
    """What was a constant of all ships is a column from then on."""
    ship, command = load_ship("kcs"), np.tile([0.1, 1.4], (3, 1))
    sim, other = ShipSim(ship, 3), ShipSim(ship, 3)
    for one in (sim, other):
        one.reset(0)
        one.step(command, 1.0)
    sim.records["hull"]["R_0"][1] *= 2.0
    for one in (sim, other):
        one.step(command, 1.0)
    assert sim.fleet.traits.each == 1 and other.fleet.traits.each is None
    assert (sim.state[[0, 2]] == other.state[[0, 2]]).all()
    assert sim.state[1, 0] < other.state[1, 0]  # twice the resistance


SAILED = """
import sys
import numpy as np
PLAIN
from ship_gym.sea.spectra import WaveSystem
from ship_gym.sea.state import Sea
from ship_gym.ships import load_ship
from ship_gym.simulation import ShipSim
waves = (WaveSystem("jonswap", 3.0, 9.0, spreading=1.0),)
sea = Sea(0.5, 1.0, 0.01, 0.001, waves=waves, wave_count=20, wind_speed=12.0, gusts=True,
          current_variation=0.3)
for names, sea in ((["kcs"] * 2, sea), (["onrt_model"] * 2, Sea(0.1, 1.0))):
    sim = ShipSim([load_ship(name) for name in names], 2, sea, parallel=False)
    sim.reset(3)
    for k in range(10):
        sim.step([[0.3, 1.5], [-0.2, 1.5]], 1.0)
    for values in (sim.state, sim.forces, sim.waves, sim.flow):
        print(*(x.hex() for x in values.ravel().tolist()))
"""
PLAIN = """
from ship_gym.physics import _compiler
_compiler.LOOP, _compiler.PART, _compiler.WORKS = {}, {}, False
"""


@functools.cache
def numbers(plain="", **extra):
    """What the script above prints, in a process of its own, by the version of all ships."""
    done = subprocess.run(
        [sys.executable, "-c", SAILED.replace("PLAIN", plain)],
        env={**os.environ, "SHIP_GYM_ONE_VERSION": "1", **extra},
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    return [np.array([float.fromhex(x) for x in row.split()]) for row in done.stdout.splitlines()]


@pytest.mark.compiled
@pytest.mark.slow
def test_compiled_is_as_interpreted():
    """Within 1e-9 of each column's size; a compiler may order a sum otherwise."""
    for one, other in zip(numbers(), numbers(NUMBA_DISABLE_JIT="1"), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-12 * np.abs(one).max())


@pytest.mark.compiled
@pytest.mark.slow
def test_compiled_by_numba_s_own_way_the_bits_are_the_same(tmp_path):
    """Where a version of numba does not know our compiler classes."""
    for one, other in zip(numbers(), numbers(PLAIN, NUMBA_CACHE_DIR=str(tmp_path)), strict=True):
        np.testing.assert_array_equal(one, other)
