"""The right-hand side: forces add up, kinematics, what a uniform current does; by substitution."""

import math

import numpy as np
import pytest

from ship_gym.physics.dynamics import accelerations, flow_of, forces
from ship_gym.physics.integrate import derivative
from ship_gym.physics.quantities import Force
from ship_gym.physics.rudder import axial_inflow
from ship_gym.sea.records import SEA_DTYPE
from ship_gym.ships import load_ship
from tests.conftest import tables_of

LOAD = Force(1.3, -0.7, 0.4)


def calm(north=0.0, east=0.0):
    record = np.zeros(1, SEA_DTYPE)
    record["V_north"], record["V_east"] = north, east
    return record[0]


@pytest.mark.parametrize("name", ["kcs_model", "onrt_model"])
def test_hull_propeller_rudder_and_held_loads_add_up(name):
    ship = load_ship(name)
    record, tables = tables_of(ship)
    body, controls = (0.9 * ship.speed, 0.1, 0.05, 3.0, 4.0, 0.7), (0.3, 9.0)
    rates, parts, units = derivative(body, controls, LOAD, record, calm(), tables)
    (H, P, R), seen = forces(body[:3], controls, record, tables)
    assert (parts, flow_of(body[:3], controls, units, record)) == ((H, P, R), seen)
    assert all(abs(x) > 1e-6 for part in parts for x in (part[0], part[2]))
    X, Y, N = (sum(part[k] for part in (H, P, R, LOAD)) for k in range(3))
    expected = accelerations(body[:3], X, Y, N, record.inertia)
    assert rates[:3] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("psi", "north", "east"),
    [
        (0.0, 1.0, 0.2),
        (0.5 * math.pi, -0.2, 1.0),
        (math.pi, -1.0, -0.2),
        (-0.5 * math.pi, 0.2, -1.0),
    ],
)
def test_position_moves_as_the_ship_heads_and_drifts(psi, north, east):
    """1 m/s ahead and 0.2 m/s to starboard; the heading turns at the yaw rate."""
    record, tables = tables_of(load_ship("kcs_model"))
    body = (1.0, 0.2, 0.03, 0.0, 0.0, psi)
    rates, _, _ = derivative(body, (0.0, 9.0), LOAD, record, calm(), tables)
    assert rates[3:] == pytest.approx((north, east, 0.03), abs=1e-12)


@pytest.mark.parametrize("psi", [0.0, 1.0, -2.0])
def test_in_a_current_the_velocity_through_the_water_counts(psi):
    """Over ground u_c and v_c more, and the water axes turn with the ship: r v_c and -r u_c."""
    record, tables = tables_of(load_ship("kcs_model"))
    u, v, r = 1.0, 0.1, 0.08
    c, s = math.cos(psi), math.sin(psi)
    u_c, v_c = 0.3 * c - 0.2 * s, -0.2 * c - 0.3 * s  # 0.3 m/s to the north, 0.2 to the west
    still, parts, units = derivative(
        (u, v, r, 0.0, 0.0, psi), (0.2, 9.0), LOAD, record, calm(), tables
    )
    body = (u + u_c, v + v_c, r, 0.0, 0.0, psi)
    found, same, seen = derivative(body, (0.2, 9.0), LOAD, record, calm(0.3, -0.2), tables)
    np.testing.assert_allclose(same, parts, rtol=1e-9)
    np.testing.assert_allclose(seen, units, rtol=1e-9)
    expected = (still[0] + r * v_c, still[1] - r * u_c, still[2])
    assert found[:3] == pytest.approx(expected, rel=1e-9)
    assert found[3:5] == pytest.approx((still[3] + 0.3, still[4] - 0.2), rel=1e-9)


@pytest.mark.parametrize("u", [-0.5, -2.0, 0.0])
def test_astern_race_and_flow_from_astern_work_against_each_other(u):
    """Squares with the signs of their velocities; at rest u_R = epsilon kappa u_s sqrt(eta)."""
    record, _ = tables_of(load_ship("kcs_model", surrogate="none"))
    k, D, thrust = record.rudder, record.propeller.D, 4.0
    race = 8.0 * thrust / (record.rho * math.pi * D * D) - u * u

    def root(x):
        return math.copysign(math.sqrt(abs(x)), x)

    u_in = u + k.kappa * (root(race) - u)
    expected = k.epsilon * root(k.eta * u_in * abs(u_in) - (1.0 - k.eta) * u * u)
    assert axial_inflow(u, (thrust, 1.0, 0.0), record) == pytest.approx(expected, rel=1e-12)
    if u == 0.0:
        still = k.epsilon * k.kappa * math.sqrt(k.eta * race)
        assert expected == pytest.approx(still, rel=1e-12)


def test_ahead_wake_and_race_mix_by_the_height_of_the_rudder():
    """Without thrust u_R = epsilon (1 - w_P) u; with it the mean of the squares."""
    record, _ = tables_of(load_ship("kcs_model", surrogate="none"))
    k, D = record.rudder, record.propeller.D
    assert axial_inflow(1.0, (0.0, 0.6, 0.0), record) == pytest.approx(0.6 * k.epsilon, rel=1e-12)
    u_s = math.sqrt(0.36 + 8.0 * 4.0 / (record.rho * math.pi * D * D))
    mixed = k.eta * (0.6 + k.kappa * (u_s - 0.6)) ** 2 + (1.0 - k.eta) * 0.36
    found = axial_inflow(1.0, (4.0, 0.6, 0.0), record)
    assert found == pytest.approx(k.epsilon * math.sqrt(mixed), rel=1e-12)
