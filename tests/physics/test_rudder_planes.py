"""A surrogate of several rudder angles in the kernels: planes, what lies between, and outside."""

import dataclasses
import math

import numpy as np
import pytest

from ship_gym.physics.interpolate import bilinear
from ship_gym.physics.propeller import (
    C_N,
    C_T,
    advance_angle,
    sampled,
    surrogate_cell,
    surrogate_plane,
    surrogate_unit,
    trained_direction,
)
from ship_gym.physics.rudder import race_speed_squared
from ship_gym.ships import load_ship
from ship_gym.ships.loader import attach_surrogate
from ship_gym.ships.records import as_computed
from ship_gym.simulation import ShipSim
from ship_gym.tables import Axis, Table
from tests.conftest import forces, symmetric, tables_of

N = 10.4
ANGLES = np.radians([10.0, 22.5, 35.0])


def motion(ship):
    """In the trained box of either ship: J 0.8 and 17 deg of drift."""
    u = 0.8 * N * ship.propeller.D
    return u, -0.3 * u, 0.0


def with_planes(ship, factors=(1.0, 1.0, 1.0)):
    """The ship with its one plane as three, each with its forces times a factor."""
    table = ship.surrogate
    axis = Axis("rudder angle", ANGLES[0], ANGLES[1] - ANGLES[0], len(factors))
    values = np.stack([table.values] * len(factors))
    for k, name in enumerate(table.names):
        if not name.startswith("trust"):
            values[..., k] *= np.array(factors)[:, None, None]
    made = Table((axis, *table.axes), table.names, values, table.card)
    return dataclasses.replace(ship, surrogate=made)


@pytest.fixture(scope="module", params=["kcs_model", "onrt_model"])
def shipped(request):
    return symmetric(load_ship(request.param))


@pytest.fixture(scope="module")
def ship(shipped):
    """The ship with its table as it stands, not shifted to the point straight ahead."""
    return as_computed(shipped)


def test_planes_that_are_alike_are_one_plane_from_the_smallest_angle_on(shipped):
    """With 35 deg as the smallest angle nothing changes, at whatever rudder angle.

    The shift to the point straight ahead included, which each plane gets. But for the direction of
    the smallest angle, which is looked up for one angle and computed, to 1e-12, for several.
    """
    table = shipped.surrogate
    axis = Axis("rudder angle", ANGLES[2], 0.1, 2)
    made = Table((axis, *table.axes), table.names, np.stack([table.values] * 2), table.card)
    record, tables = tables_of(dataclasses.replace(shipped, surrogate=made))
    one = tables_of(shipped)
    for delta in np.radians([-35.0, -20.0, -1.0, 0.0, 3.0, 17.0, 35.0]):
        here = forces(motion(shipped), (delta, N), record, tables)
        for part, expected in zip(here, forces(motion(shipped), (delta, N), *one), strict=True):
            assert part == pytest.approx(expected, rel=1e-10, abs=1e-12)


def test_each_plane_is_met_at_its_angle_and_between_two_the_coefficients_are_linear(ship):
    factors = (0.4, 0.7, 1.0)
    record, tables = tables_of(with_planes(ship, factors))
    one = tables_of(ship)[1]
    box = record.surrogate
    for side in (1.0, -1.0):
        for delta, factor in (
            *zip(ANGLES, factors, strict=True),
            (0.5 * (ANGLES[0] + ANGLES[1]), 0.55),
            (0.1, 0.4),
            (0.7, 1.0),
        ):
            table, single = (t.deflected[surrogate_unit(side)] for t in (tables, one))
            plane = surrogate_plane(side * delta, box, table)
            at = surrogate_cell(0.3, 0.2, box, table)
            for channel in (C_T, C_N):
                expected = factor * bilinear(single, at, channel)
                assert sampled(table, at, plane, channel, 0.0) == pytest.approx(expected, rel=1e-12)
            met = min(max(delta, ANGLES[0]), ANGLES[2])
            s, c = trained_direction(side * delta, side, box, table)
            assert (s, c) == pytest.approx((side * math.sin(met), math.cos(met)), rel=1e-12)


def test_the_force_on_the_rudder_is_that_of_the_table_from_the_smallest_angle_on(ship):
    """C_N of the table times its reference pressure: the law enters below that angle only."""
    record, tables = tables_of(with_planes(ship, (0.4, 0.7, 1.0)))
    D, box = ship.propeller.D, record.surrogate
    u, v, r = motion(ship)
    alike = tables_of(with_planes(ship))
    for delta, factor in (*zip(ANGLES, (0.4, 0.7, 1.0), strict=True), (ANGLES[:2].mean(), 0.55)):
        flow = forces((u, v, r), (delta, N), record, tables)[3]
        thrust = forces((u, v, r), (delta, N), *alike)[3].thrust
        assert flow.thrust == pytest.approx(factor * thrust, rel=1e-9)
        table, plane = (
            tables.deflected[surrogate_unit(1.0)],
            surrogate_plane(delta, box, tables.deflected[surrogate_unit(1.0)]),
        )
        at = surrogate_cell(advance_angle(u, N, D), flow.beta_R_starboard, box, table)
        q = race_speed_squared(u, flow.thrust_starboard, D, ship.rho) + v * v
        expected = 0.5 * ship.rho * box.S_R * q * sampled(table, at, plane, C_N, 0.0)
        assert flow.rudder_normal_force_starboard == pytest.approx(expected, rel=1e-9)


def test_forces_are_continuous_in_the_rudder_angle_and_mirror_each_other(ship):
    record, tables = tables_of(with_planes(ship, (0.4, 0.7, 1.0)))
    sign = np.array([1.0, -1.0, -1.0])
    delta = np.radians(np.linspace(-40.0, 40.0, 4001))
    u, v, r = motion(ship)
    found = np.array([forces((u, v, r), (d, N), record, tables)[:3] for d in delta])
    steps = np.abs(np.diff(found, axis=0)).max(axis=0)
    assert (steps < 3e-3 * np.abs(found).max(axis=0) + 1e-12).all()
    there = np.array([forces((u, -v, -r), (-d, N), record, tables)[:3] for d in delta[::100]])
    np.testing.assert_allclose(there, sign * found[::100], rtol=1e-9, atol=1e-9)


@pytest.mark.slow
def test_a_step_sails_with_planes_and_a_table_file_attaches(ship):
    bare = load_ship(ship.name, surrogate="none")
    sailing = attach_surrogate(bare, with_planes(ship, (0.8, 0.9, 1.0)).surrogate, "planes")
    sim = ShipSim([sailing, sailing], 2)
    start = sim.reset(0)[:, 7].copy()
    for _ in range(20):
        sim.step(np.column_stack([[0.4, -0.4], start]), 0.5)
    assert (np.abs(sim.state[:, 2]) > 0.01).all() and sim.state[0, 2] > 0.0 > sim.state[1, 2]
