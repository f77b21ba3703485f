"""Two propellers and rudders: the samples come back on each side; the ship mirrors itself."""

import dataclasses
import math

import numpy as np
import pytest

from ship_gym.conventions import FLOW_OF_UNITS, N_FLOW, UNIT_NAMES
from ship_gym.manoeuvres import turning_circle
from ship_gym.physics.dynamics import unit_forces
from ship_gym.ships import load_ship
from ship_gym.simulation import ShipSim, self_propulsion
from ship_gym.surrogates.regression import Regression
from ship_gym.surrogates.samples import ONRT
from tests.conftest import forces, tables_of

D35, N, D, S_R = math.radians(35.0), 8.97, 0.1066, 0.012
SHIP = load_ship("onrt_model")
RECORD, TABLES = tables_of(SHIP)
SIGN = np.array([1.0, -1.0, -1.0])


def drifting(J, beta, delta):
    """Motion, controls and flow of pure drift; beta > 0 as in a turn to starboard."""
    u = J * N * D
    v = -u * math.tan(beta)
    return (u, v, 0.0), (delta, N), (math.hypot(u, v), math.atan2(-v, u))


@pytest.mark.parametrize("J", [0.6, 0.8, 1.0, 1.3])
@pytest.mark.parametrize("beta_deg", [0.0, 10.0, 20.0, 33.0])
@pytest.mark.parametrize(("side", "turn"), [("leeward", 1.0), ("windward", -1.0)])
def test_trained_angle_gives_each_sides_regression_back(J, beta_deg, side, turn):
    """The starboard unit is leeward in a turn to starboard and windward in one to port."""
    beta = math.radians(beta_deg)
    propeller, rudder, seen = unit_forces(*drifting(J, turn * beta, turn * D35), RECORD, TABLES)
    thrust = seen[2]
    u, scale = J * N * D, SHIP.rho * N**2 * D**4
    v = u * math.tan(beta)
    q = 0.5 * SHIP.rho * S_R * (u**2 + 8.0 * thrust / (SHIP.rho * math.pi * D**2) + v**2)
    # Y_source = -Y in a turn to port; one to starboard is mirrored first, which is one more sign
    K_S = turn * propeller[1] / scale
    C_Fy = turn * rudder[1] / (1.0 + SHIP.rudder.a_H) / q
    ours = [thrust / scale, K_S, rudder[0] / q, C_Fy]
    models = SHIP.surrogate.card["models"][side]
    X = np.array([[J, beta]])
    expected = [
        Regression(coefficients=models[k]["coefficients"]).predict(X)[0][0]
        for k in ("K_X", "K_S", "C_Fx", "C_Fy")
    ]
    np.testing.assert_allclose(ours, expected, atol=1e-3)


def test_yaw_moment_of_each_side_has_its_lever():
    """Knight (2021): M = -(d S + d_y F_x) in the source's axes, y to port, z up."""
    motion, controls, drift = drifting(0.9, 0.3, D35)
    X, Y, moment = unit_forces(motion, controls, drift, RECORD, TABLES)[0]
    # the starboard propeller in the source's axes: d_y = -0.084 to port, S = -Y, moment up = -N
    d, d_y = -SHIP.propeller.x_P, -0.084
    assert -moment == pytest.approx(-(d * -Y + d_y * X))


@pytest.mark.parametrize(
    ("side", "turn", "low", "high"),
    [("leeward", 1.0, 0.995, 1.01), ("windward", -1.0, 1.01, 1.11)],
)
def test_yaw_moment_of_each_rudder_is_the_printed_one(side, turn, low, high):
    """C_Mz of Knight (2021) Tables 5.3-5.6 by the lever times the force, both from the CFD.

    To leeward the two agree within 0.6 %, which confirms sign and lever. To windward the printed
    moment is 1 to 11 % larger: its force attacks further aft than the stock; the model has no such
    shift.
    """
    rudder = dataclasses.replace(SHIP.rudder, a_H=0.0)
    record, tables = tables_of(dataclasses.replace(SHIP, rudder=rudder))
    samples = ONRT.read("G2", "SA", side).pick(ONRT.training)
    x_R = SHIP.rudder.x_R - SHIP.hull.x_G  # moments of the source are about the centre of gravity
    ratios = []
    for (J, beta), C_Mz in zip(samples.X, samples.values["C_Mz"], strict=True):
        motion, controls, drift = drifting(J, turn * beta, turn * D35)
        _, (X, Y, N_R), seen = unit_forces(motion, controls, drift, record, tables)
        u, v = motion[0], motion[1]
        q = 0.5 * SHIP.rho * S_R * (u**2 + 8.0 * seen[2] / (SHIP.rho * math.pi * D**2) + v**2)
        about_G = N_R - SHIP.hull.x_G * Y
        assert about_G == pytest.approx(x_R * Y - 0.084 * X, rel=1e-9)
        # the model's own error of the force is taken out by the CFD forces at the same lever
        F_x, F_y = samples.values["C_Fx"], samples.values["C_Fy"]
        k = len(ratios)
        y = 0.084 if side == "leeward" else -0.084  # to port in the source's axes
        ratios.append(C_Mz / ((1.384 * -F_y[k] - y * F_x[k]) / 1.384))
        # a turn to port in the source has a positive moment up; ours is mirrored to leeward
        assert math.copysign(1.0, C_Mz) == math.copysign(1.0, turn * about_G)
        # scale only: the regression misses its own windward training points by up to 0.035
        assert abs(about_G) / (q * 1.384) == pytest.approx(abs(C_Mz), abs=0.06)
    assert low < np.min(ratios) and np.max(ratios) < high


def test_yaw_rate_changes_the_axial_inflow_of_each_rudder():
    """The starboard rudder of a starboard yaw goes slower by y_R r (propeller stopped)."""
    still = dataclasses.replace(SHIP, rudder=dataclasses.replace(SHIP.rudder, l_R=0.0, x_R=0.0))
    record, tables = tables_of(still)
    slower = 1.0 - 0.084 * 0.2
    turning = unit_forces((1.0, 0.0, 0.2), (0.05, 0.0), (1.0, 0.0), record, tables)[1]
    same = unit_forces((slower, 0.0, 0.0), (0.05, 0.0), (1.0, 0.0), record, tables)[1]
    assert turning[1] == pytest.approx(same[1], rel=1e-9)


@pytest.mark.compiled
def test_the_calibrated_tactical_diameter():
    """Knight (2021): 3.00 L, measured in waves; N_r of the ship file is calibrated to it."""
    found = turning_circle(SHIP, -D35, 1.11, N)
    assert found.tactical_diameter == pytest.approx(3.00, abs=0.01)


def test_both_propellers_add_up_and_the_lateral_levers_count():
    motion, controls, drift = drifting(0.9, 0.3, D35)
    _, P, R, flow = forces(motion, controls, RECORD, TABLES)
    starboard = unit_forces(motion, controls, drift, RECORD, TABLES)
    port = unit_forces(tuple(SIGN * motion), (-D35, N), (drift[0], -drift[1]), RECORD, TABLES)
    np.testing.assert_allclose(P, np.add(starboard[0], SIGN * port[0]))
    np.testing.assert_allclose(R, np.add(starboard[1], SIGN * port[1]))
    assert flow[3] == pytest.approx(starboard[2][2] + port[2][2])
    # leeward and windward thrust differ, so the pair turns the ship: windward (port) pushes harder
    assert port[2][2] > 1.05 * starboard[2][2]


def test_yaw_rate_changes_the_axial_inflow_of_each_propeller():
    """At a yaw rate to starboard the starboard propeller goes slower by y_P r than the ship."""
    inner = unit_forces((1.0, 0.0, 0.2), (0.0, N), (1.0, 0.0), RECORD, TABLES)[2][2]
    slower = 1.0 - 0.084 * 0.2
    same = unit_forces((slower, 0.0, 0.0), (0.0, N), (slower, 0.0), RECORD, TABLES)[2][2]
    assert inner == pytest.approx(same, rel=1e-12)


@pytest.mark.compiled
def test_turns_to_port_and_starboard_mirror_each_other():
    starboard, port = (
        turning_circle(SHIP, delta, SHIP.speed, N).trajectory for delta in (D35, -D35)
    )
    for name in ("x", "u", "n", "thrust"):
        np.testing.assert_allclose(starboard[name], port[name], rtol=0, atol=1e-6)
    for name in ("y", "v", "r", "psi"):
        np.testing.assert_allclose(starboard[name], -port[name], rtol=0, atol=1e-6)


@pytest.mark.compiled
def test_without_propeller_side_force_the_ship_turns_tighter():
    """Knight (2021): yaw rate 15 % too high without K_S; here 10 %, with an estimated hull."""
    table = SHIP.surrogate
    values = table.values.copy()
    for i, name in enumerate(table.names):
        if name.startswith("C_S"):
            values[..., i] = 0.0
    bare = dataclasses.replace(SHIP, surrogate=dataclasses.replace(table, values=values))
    rates = []
    for ship in (SHIP, bare):
        found = turning_circle(ship, -D35, SHIP.speed, N).measures()
        rates.append(abs(found["steady_yaw_rate"]) * found["steady_speed_ratio"])
    assert 1.05 < rates[1] / rates[0] < 1.20


def test_self_propulsion_is_the_printed_point():
    assert self_propulsion(SHIP, 1.11) == pytest.approx(8.97, abs=0.01)  # calibrated, ship file


def test_torque_is_of_both_and_the_same_at_the_same_thrust():
    """The samples have no torque: open-water torque at the same thrust stands in."""
    card = SHIP.surrogate.card
    assert card["torque"].startswith("open-water torque at the same thrust")
    flow = forces((1.11, 0.0, 0.0), (0.0, N), RECORD, TABLES)[3]
    efficiency = flow[3] * 1.11 / (2.0 * math.pi * N * flow[4])
    assert 0.6 < efficiency < 0.85


@pytest.mark.parametrize("delta_deg", [-20.0, -5.0, 5.0, 20.0])
def test_normal_force_of_the_port_rudder_adds_to_that_of_the_starboard_one(delta_deg):
    """Straight ahead both rudders stand alike: twice 1/2 rho A_R f_alpha u_R^2 sin(delta).

    The port rudder is the starboard one of the mirrored ship, at -delta, whose force counts with
    the other sign.
    """
    record, tables = tables_of(load_ship("onrt_model", surrogate="none"))
    delta = math.radians(delta_deg)
    motion, drift = (1.11, 0.0, 0.0), (1.11, 0.0)
    F_N = forces(motion, (delta, N), record, tables)[3][5]
    one = unit_forces(motion, (delta, N), drift, record, tables)[2][4]
    assert F_N == pytest.approx(2.0 * one, rel=1e-12)
    # the inflow from the force itself must be a ship's: between the speed and that of the race
    rudder = record.rudder
    u_R = math.sqrt(one / (0.5 * record.rho * rudder.A_R * rudder.f_alpha * math.sin(delta)))
    assert 1.11 < u_R < 3.0
    mirrored = forces(motion, (-delta, N), record, tables)[3][5]
    assert mirrored == pytest.approx(-F_N, rel=1e-12) and F_N * delta > 0.0


@pytest.mark.parametrize("motion", [(1.0, 0.1, 0.0), (1.0, -0.2, 0.15), (0.9, 0.15, -0.2)])
def test_flow_of_the_mirrored_ship_is_mirrored(motion):
    """J, thrust and torque alike; drift at propeller and rudder and F_N with the other sign."""
    u, v, r = motion
    here = forces((u, v, r), (0.3, N), RECORD, TABLES)
    there = forces((u, -v, -r), (-0.3, N), RECORD, TABLES)
    sign, n = [1.0, -1.0, -1.0, 1.0, 1.0, -1.0, 1.0], N_FLOW
    np.testing.assert_allclose(there[3][:n], np.multiply(sign, here[3][:n]), rtol=1e-12, atol=1e-12)
    one, other = np.split(np.array(there[3][n:]), 2)  # starboard, port
    exchanged = np.concatenate([sign[:6] * other, sign[:6] * one])
    np.testing.assert_allclose(exchanged, here[3][n:], rtol=1e-12, atol=1e-12)
    for a, b in zip(here[:3], there[:3], strict=True):
        np.testing.assert_allclose(b, np.multiply(SIGN, a), rtol=1e-9, atol=1e-12)
    # the drift angles of the centreline: between those of the two sides
    sides = [
        unit_forces(m, (d, N), (math.hypot(u, v), math.atan2(-m[1], u)), RECORD, TABLES)[2]
        for m, d in (((u, v, r), 0.3), ((u, -v, -r), -0.3))
    ]
    for k, name in ((1, "beta_P"), (2, "beta_R")):
        mean = 0.5 * (sides[0][k - 1] - sides[1][k - 1])
        assert here[3][k] == pytest.approx(mean, rel=1e-12), name
        assert here[3][k] != 0.0


TURN = (1.0, -0.3, 0.15), (D35, N)  # to starboard, with drift


def test_loads_of_each_unit_add_up_to_those_of_the_ship():
    flow = forces(*TURN, RECORD, TABLES)[3]
    starboard, port = np.split(np.array(flow[N_FLOW:]), 2)
    for name in ("thrust", "torque", "rudder_normal_force"):
        k = UNIT_NAMES.index(name)
        assert getattr(flow, name) == pytest.approx(starboard[k] + port[k], rel=1e-12), name
        assert abs(starboard[k] / port[k] - 1.0) > 0.01, name  # leeward and windward differ
    for name in ("J", "beta_P", "beta_R"):
        k = UNIT_NAMES.index(name)
        mean = pytest.approx(0.5 * (starboard[k] + port[k]), rel=1e-12)
        assert getattr(flow, name) == mean, name


def test_advance_and_drift_of_each_unit_are_those_of_its_place():
    """u -+ y_P r ahead and v + x r across, at the propeller and at the rudder of each side."""
    (u, v, r), controls = TURN
    flow = forces(*TURN, RECORD, TABLES)[3]
    p, k = SHIP.propeller, SHIP.rudder
    for side, sign in (("starboard", 1.0), ("port", -1.0)):
        J = (u - sign * p.y_P * r) / (controls[1] * p.D)
        assert getattr(flow, f"J_{side}") == pytest.approx(J, rel=1e-12)
        beta_P = math.atan2(-(v + p.x_P * r), u - sign * p.y_P * r)
        assert getattr(flow, f"beta_P_{side}") == pytest.approx(beta_P, rel=1e-12)
        beta_R = math.atan2(-(v + k.x_R * r), u - sign * k.y_R * r)
        assert getattr(flow, f"beta_R_{side}") == pytest.approx(beta_R, rel=1e-12)


def test_force_of_each_unit_makes_the_yaw_moment_of_the_pair():
    """N of the propellers beyond their side force: (1 - t_P) y_P (T_port - T_starboard)."""
    _, P, _, flow = forces(*TURN, RECORD, TABLES)
    p = SHIP.propeller
    pair = (1.0 - p.t_P) * p.y_P * (flow.thrust_port - flow.thrust_starboard)
    assert P.N - p.x_P * P.Y == pytest.approx(pair, rel=1e-9)


def test_a_single_unit_stands_as_the_starboard_one():
    record, tables = tables_of(load_ship("kcs_model"))
    flow = forces((1.0, -0.3, 0.3), (0.5, N), record, tables)[3]
    whole = [getattr(flow, name) for name in UNIT_NAMES]
    assert list(flow[N_FLOW:]) == whole + [0.0] * 6


def test_a_step_writes_the_loads_of_each_unit_where_a_ship_has_two():
    sim = ShipSim(["kcs_model", "onrt_model"], 2)
    sim.reset(0)
    sim.step([[0.4, 9.0], [0.4, 9.0]], 2.0)
    state = sim.state.copy()
    sim.step([[0.4, 9.0], [0.4, 9.0]], 0.1)
    for i, ship in enumerate(sim.ships):
        record, tables = tables_of(ship)
        flow = forces(state[i, :3], state[i, 6:], record, tables)[3]
        np.testing.assert_allclose(sim.flow[i], flow, rtol=1e-12)
    assert sim.flow.shape == (2, len(FLOW_OF_UNITS))
    assert ShipSim("kcs_model").flow.shape == (1, N_FLOW)
