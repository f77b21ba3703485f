"""Propeller and rudder braking, astern and at rest: no jump, the right scale, the right size."""

import dataclasses
import math

import numpy as np
import pytest

from ship_gym.physics.propeller import TRUST, advance_ratio, shaft_power
from ship_gym.physics.rudder import KAPPA_ASTERN, axial_inflow, normal_force, race_inflow
from ship_gym.ships import available_ships, load_ship
from ship_gym.ships.scaling import scaled
from ship_gym.simulation import self_propulsion, straight_forces
from tests.conftest import forces, tables_of

SHIPS = {name: tables_of(load_ship(name)) for name in available_ships()}


def loads(name, motion, controls):
    """Propeller and rudder forces, thrust, torque and F_N."""
    _, P, R, flow = forces(motion, controls, *SHIPS[name])
    return np.array([*P, *R, flow[3], flow[4], flow[5]])


@pytest.mark.compiled
@pytest.mark.parametrize("name", ["kcs_model", "kvlcc2_model", "dtc_model", "onrt_model", "s175"])
@pytest.mark.parametrize("delta", [0.0, 0.5])
def test_no_jump_through_stopped_propeller_and_stopped_ship(name, delta):
    """The largest step falls with the grid: 1/16 where smooth, 0.36 at a root, 1 at a jump."""
    n, U = 0.4 * float(SHIPS[name][0].engine.n_max), 0.5 * load_ship(name).speed
    paths = {
        "n through 0, ahead": lambda s: ((U, 0.1 * U, 0.0), (delta, n * s)),
        "n through 0, astern": lambda s: ((-U, 0.1 * U, 0.0), (delta, n * s)),
        "n through 0, at rest": lambda s: ((0.0, 0.0, 0.0), (delta, n * s)),
        "u through 0, turning ahead": lambda s: ((U * s, 0.0, 0.0), (delta, n)),
        "u through 0, reversed": lambda s: ((U * s, 0.0, 0.0), (delta, -n)),
        "u through 0, stopped": lambda s: ((U * s, 0.0, 0.0), (delta, 0.0)),
        "both through 0": lambda s: ((U * s, 0.1 * U, 0.0), (delta, -n * s)),
    }
    for what, path in paths.items():
        # a grid that has no point at zero, where a jump would hide
        rows = np.array([loads(name, *path(s)) for s in np.linspace(-1.0, 1.0, 8000)])
        fine = np.abs(np.diff(rows, axis=0)).max(axis=0)
        coarse = np.abs(np.diff(rows[::16], axis=0)).max(axis=0)
        changing = coarse > 1e-6 * np.abs(rows).max(axis=0)
        assert (fine[changing] / coarse[changing]).max() < 0.45, what


@pytest.mark.parametrize("name", ["kcs_model", "kvlcc2_model", "dtc_model", "onrt_model"])
@pytest.mark.parametrize(("u", "n"), [(0.8, -0.5), (-0.4, -0.5), (-0.4, 0.3), (0.8, 0.0)])
def test_froude_scale_of_every_quadrant(name, u, n):
    """Forces go with the cube of the length, moments with its fourth power."""
    ship, ratio = load_ship(name), 30.0
    big = scaled(ship, ratio * ship.hull.L, rho=ship.rho, nu=ship.nu, friction_correction=False)
    speed, rpm, root = u * ship.speed, n * ship.engine.n_max, math.sqrt(ratio)
    motion = (speed, 0.05 * speed, 0.1 * ship.speed / ship.hull.L)
    _, P, R, flow = forces(motion, (0.3, rpm), *tables_of(ship))
    moved = (root * motion[0], root * motion[1], motion[2] / root)
    _, P2, R2, flow2 = forces(moved, (0.3, rpm / root), *tables_of(big))
    power = np.array([3, 3, 4])
    for a, b in ((P, P2), (R, R2)):
        np.testing.assert_allclose(np.array(b), ratio**power * np.array(a), rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(flow2[3:6], ratio ** np.array([3, 4, 3]) * flow[3:6], rtol=1e-9)
    np.testing.assert_allclose(flow2[:3], flow[:3], rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(("share", "drag"), [(0.0, -0.76), (0.3, -0.55)])
def test_slow_and_stopped_propeller_of_kcs(share, drag):
    """Thrust over resistance that B5-75 gives in a wake of 0.353, an independent evaluation."""
    ship = load_ship("kcs")
    propeller = dataclasses.replace(ship.propeller, w_P0=0.353)
    ship = dataclasses.replace(ship, propeller=propeller)
    n = self_propulsion(ship, ship.speed)
    resistance = -straight_forces(ship, ship.speed, n)[0].hull.X
    _, flow = straight_forces(ship, ship.speed, share * n)
    assert flow.thrust / resistance == pytest.approx(drag, abs=0.01)


def test_surrogate_ends_before_stopped_and_reversed(ship):
    """Trained ahead only: its table has no weight left at its ends, and these lie ahead."""
    if ship.surrogate is None:
        pytest.skip("no surrogate")
    epsilon = ship.surrogate.axes[0]
    assert 0.0 < epsilon.start and epsilon.stop < math.pi / 2
    ends = ship.surrogate.values[[0, -1]]
    assert (ends[..., TRUST] == 0.0).all()


def test_signs_of_thrust_and_torque(ship):
    """Braking and astern the thrust is to the stern; power is taken in both."""
    n, U = 0.5 * ship.engine.n_max, 0.5 * ship.speed
    for u in (U, 0.0, -0.3 * U):
        own, flow = straight_forces(ship, u, -n)
        assert flow.thrust < 0.0 and own.propeller.X < 0.0 and flow.torque < 0.0
    assert straight_forces(ship, -U, n)[1].thrust > 0.0


def test_advance_ratio_of_a_reversed_propeller():
    assert advance_ratio(1.0, -5.0, 0.2) == pytest.approx(-1.0)
    assert advance_ratio(-1.0, -5.0, 0.2) == pytest.approx(1.0)
    assert advance_ratio(1.0, -1e-9, 0.2) == -10.0 and advance_ratio(-1.0, 0.0, 0.2) == -10.0


def test_race_at_the_rudder_by_hand():
    record = SHIPS["kvlcc2_model"][0]
    k, D, rho = record.rudder, 0.2, 1000.0
    unit = rho * math.pi * D * D / 8.0  # of thrust: changes the square of the race by 1
    assert race_inflow(1.0, 3.0 * unit, k, D, rho) == pytest.approx(1.0 + 0.5 * (2.0 - 1.0))
    assert race_inflow(1.0, -0.75 * unit, k, D, rho) == pytest.approx(1.0 - 0.5 * 0.5)
    # race stopped by a braking propeller, then drawn forward
    assert race_inflow(1.0, -1.0 * unit, k, D, rho) == pytest.approx(0.5)
    assert race_inflow(1.0, -5.0 * unit, k, D, rho) == pytest.approx(0.5 - 2.0 * KAPPA_ASTERN)
    assert race_inflow(0.0, -4.0 * unit, k, D, rho) == pytest.approx(-2.0 * KAPPA_ASTERN)
    # sternway: propeller reversed, idle, and turning ahead against it
    assert race_inflow(-1.0, -3.0 * unit, k, D, rho) == pytest.approx(-1.0 - KAPPA_ASTERN)
    assert race_inflow(-1.0, 0.0, k, D, rho) == -1.0
    assert race_inflow(-1.0, 5.0 * unit, k, D, rho) == pytest.approx(-1.0 + 0.5 * 3.0)


def test_rudder_in_flow_from_astern_works_the_other_way():
    record = SHIPS["kvlcc2_model"][0]
    direction = (math.sin(0.2), math.cos(0.2))
    ahead, astern = (normal_force(direction, u, 0.0, record.rudder, 1000.0) for u in (1.0, -1.0))
    assert astern == -ahead < 0.0
    thrust = -20.0
    assert axial_inflow(0.0, (thrust, 0.6, 0.0), record) < 0.0
    assert axial_inflow(-0.5, (0.0, 1.0, 0.0), record) == pytest.approx(
        -0.5 * float(record.rudder.epsilon)
    )


def test_sternway_has_no_wake():
    """Astern the propeller meets undisturbed water: bollard thrust changes with u, not 0.6 u."""
    ship = load_ship("kvlcc2_model")
    n, u, D = -8.0, -0.5, ship.propeller.D
    C_T = ship.open_water(math.atan2(u, 0.7 * math.pi * n * D))[0]
    q = 0.125 * math.pi * ship.rho * (u**2 + (0.7 * math.pi * n * D) ** 2) * D**2
    assert straight_forces(ship, u, n)[1].thrust == pytest.approx(q * C_T, rel=1e-9)


@pytest.mark.compiled
@pytest.mark.parametrize("name", available_ships())
def test_calm_water_takes_energy_from_every_motion(name):
    """The forces of hull, propellers and rudders do less work than the shafts put in."""
    ship, rng = load_ship(name), np.random.default_rng(0)
    low = np.array([-1.0, -0.6, -1.0, -ship.gear.delta_max, -ship.engine.n_astern])
    high = np.array([1.2, 0.6, 1.0, ship.gear.delta_max, ship.engine.n_max])
    for row in rng.uniform(low, high, (2000, 5)):
        motion = row[:3] * ship.speed * np.array([1.0, 1.0, 1.0 / ship.hull.L])
        for n in (row[4], 0.0):  # in every quadrant, and with the shaft stopped
            hull, propeller, rudder, flow = forces(tuple(motion), (row[3], n), *SHIPS[name])
            work = (np.array(hull) + propeller + rudder) @ motion
            assert work < shaft_power(n, flow[4])
