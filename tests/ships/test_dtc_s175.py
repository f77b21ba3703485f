"""DTC from its tank tests, S-175 from Son & Nomoto's printed numbers, recomputed here."""

import math

import numpy as np
import pytest

from ship_gym.conventions import KNOT
from ship_gym.physics.hull import polynomial_forces
from ship_gym.physics.propeller import wake
from ship_gym.physics.rudder import axial_inflow, cubic_inflow, lateral_inflow
from ship_gym.ships import load_ship
from ship_gym.ships.b_series import b_series
from ship_gym.ships.estimators import estimated_hull
from ship_gym.ships.open_water import coefficients
from ship_gym.ships.scaling import ittc57
from ship_gym.simulation import self_propulsion
from tests.conftest import tables_of

# el Moctar, Shigunov & Zorn (2012), Table 4, model of 5.976 m with S = 6.243 m2:
# speed [m/s], R_T [N], C_T, C_F, C_W, all three by 1e3
DTC_TANK = (
    (1.335, 20.34, 3.661, 3.170, 0.1932),
    (1.401, 22.06, 3.605, 3.142, 0.1672),
    (1.469, 24.14, 3.588, 3.116, 0.1791),
    (1.535, 26.46, 3.602, 3.092, 0.2194),
    (1.602, 28.99, 3.623, 3.069, 0.2660),
    (1.668, 31.83, 3.670, 3.047, 0.3360),
)
# Son & Nomoto (1982) as in container.m of MSS, by 1/2 rho L^2 U^2 and 1/2 rho L^3 U^2 about G
L, D = 175.0, 8.5  # length, draught [m]
M, M_X, M_Y = 0.00792, 0.000238, 0.007049
I_X, I_Z, J_Z, ALPHA_Y = 0.0000176, 0.000456, 0.000419, 0.05
X_UU, X_VR, X_VV, X_RR = -0.0004226, -0.00311, -0.00386, 0.00020
Y_PRINTED = (-0.0116, 0.00242, -0.109, 0.0214, -0.0405, 0.00177)  # v r vvv vvr vrr rrr
N_PRINTED = (-0.0038545, -0.00222, 0.001492, -0.0424, 0.00156, -0.00229)


@pytest.mark.parametrize(("speed", "R_T", "C_T", "C_F", "C_W"), DTC_TANK)
def test_dtc_tank_table_is_consistent(speed, R_T, C_T, C_F, C_W):
    """Two public files, one with forces and one with coefficients, say the same: rho 998.8."""
    assert R_T / (0.5 * 998.8 * 6.243 * speed**2) == pytest.approx(1e-3 * C_T, rel=1.5e-3)
    assert C_T - 1.094 * C_F == pytest.approx(C_W, abs=2e-3)
    assert 1e3 * ittc57(speed * 5.976 / 1.09e-6) == pytest.approx(C_F, rel=2e-3)


def test_dtc_resistance_is_that_of_the_tank_at_the_same_froude_number():
    ship = load_ship("dtc_model")
    h = ship.hull
    assert ship.froude(ship.speed) == pytest.approx(0.200, abs=5e-4)
    friction = ittc57(ship.speed * h.L / ship.nu)
    C_T = 1.094 * friction + 1e-3 * (3.602 - 1.094 * 3.092)
    assert h.R_0 == pytest.approx(C_T * h.S / (h.L * h.d), rel=1e-3)
    # the larger model's friction gives the printed coefficient back
    larger = h.R_0 * h.L * h.d / h.S - 1.094 * (friction - 3.092e-3)
    assert larger == pytest.approx(3.602e-3, rel=1e-3)


def test_dtc_model_and_ship_have_the_printed_particulars():
    model, ship = load_ship("dtc_model").hull, load_ship("dtc").hull
    assert load_ship("dtc_model").scale == pytest.approx(63.65, rel=1e-3)
    for name, printed in (("B", 51.0), ("d", 14.5), ("volume", 173468.0), ("S", 22032.0)):
        assert getattr(ship, name) == pytest.approx(printed, rel=5e-4)
    assert model.volume / (model.L * model.B * model.d) == pytest.approx(0.661, abs=5e-4)
    assert ship.L / 2 + ship.x_G == pytest.approx(174.3, abs=0.05)  # forward of the aft end
    assert load_ship("dtc").propeller.D == pytest.approx(8.911, rel=5e-4)


def test_dtc_propeller_is_the_b_series_and_its_pitch_calibrated():
    ship = load_ship("dtc_model")
    J = np.linspace(0.0, 1.05, 43)
    K_T, K_Q = b_series(J, 0.988, 0.80, 5)
    found = coefficients(ship.open_water, J)
    np.testing.assert_allclose(found[0], K_T, atol=2e-4)
    np.testing.assert_allclose(found[1], K_Q, atol=2e-4)
    assert self_propulsion(ship, 1.48) == pytest.approx(15.7, rel=1e-3)  # White (2020)
    assert "calibrated" in ship.estimated["open_water"]


def test_dtc_marks_what_nobody_measured():
    ship = load_ship("dtc_model")
    derivatives = estimated_hull(5.577, ship.hull.B, ship.hull.d, ship.hull.volume, -0.05)
    assert {f"hull.{name}" for name in derivatives} <= set(ship.estimated)
    for name in ("propeller.w_P0", "propeller.t_P", "rudder.A_R", "rudder.a_H", "rudder.gamma_R_p"):
        assert name in ship.estimated
    for name in ("hull.R_0", "hull.k_zz", "hull.form_factor", "propeller.D", "gear.rate"):
        assert name not in ship.estimated
    # the printed 255 m2 cannot be the lateral area: three times L d / 60
    assert load_ship("dtc").rudder.A_R == pytest.approx(355.0 * 14.5 / 60.0, rel=1e-3)


def test_dtc_full_scale_speed_and_rudder_rate():
    ship = load_ship("dtc")
    assert math.degrees(ship.gear.rate) == pytest.approx(18.0 / math.sqrt(63.65), rel=1e-3)
    assert 60.0 * self_propulsion(ship, 24.0 * KNOT) == pytest.approx(99.75, abs=0.1)  # ours


def printed(P, v, r):
    """Cubic polynomial of Son & Nomoto."""
    return np.dot(P, (v, r, v**3, v * v * r, v * r * r, r**3))


def converted_forces(v, r):
    """X, Y, N of the ship file at midship by 1/2 rho L d U^2, L."""
    record, _ = tables_of(load_ship("s175"))
    motion = (math.sqrt(1.0 - v * v), v, r / L)
    return np.array(polynomial_forces(*motion, record.hull, 1.0)) / (0.5 * L * D) / (1.0, 1.0, L)


def forces_from_print(v, r):
    """The same from the printed model at G; v' and r' at midship.

    With what the two equations of motion do not have in common moved to the force side: m_y v_G r
    of the paper beside m_y v r here, m_x u r at G beside at midship.
    """
    u, x = math.sqrt(1.0 - v * v), load_ship("s175").hull.x_G / L
    v_G = v + x * r
    U_G = math.hypot(u, v_G)
    q = U_G**2  # U = 1
    a, b = v_G / U_G, r / U_G
    X = X_UU * u * u + q * (X_VV * a * a + X_VR * a * b + X_RR * b * b) + M_Y * x * r * r
    Y, N = q * printed(Y_PRINTED, a, b), q * printed(N_PRINTED, a, b)
    return np.array([X, Y, N + x * (Y - M_X * u * r)]) * L / D


@pytest.mark.parametrize("v", [-0.3, -0.2, -0.1, 0.0, 0.1])
@pytest.mark.parametrize("r", [0.0, 0.2, 0.6, 0.8])
def test_s175_forces_are_those_of_the_printed_numbers(v, r):
    """The fifth order, which is left out, is 0.3 % of Y and N at the tightest of these states."""
    gap = converted_forces(v, r) - forces_from_print(v, r)
    tightest = np.abs(forces_from_print(-0.3, 0.8))
    assert (np.abs(gap) < (1e-6, *0.0035 * tightest[1:])).all(), gap
    if abs(v) <= 0.1 and r <= 0.2:  # where an autopilot lives
        assert (np.abs(gap) < (1e-6, 5e-6, 5e-6)).all(), gap


def test_s175_conversion_is_exact_to_third_order():

    def gap(size):
        motion = (-0.3 * size, 0.8 * size)
        return np.abs(converted_forces(*motion) - forces_from_print(*motion))[1:]

    order = np.log2(gap(2.0) / gap(1.0))
    assert (order > 4.5).all(), order


def test_s175_masses_and_inertia():
    ship = load_ship("s175")
    h, c = ship.hull, L / D
    assert h.volume == pytest.approx(M * 0.5 * L**3, rel=1e-4)
    assert (h.m_x, h.m_y) == pytest.approx((c * M_X, c * M_Y), rel=1e-5)
    assert (h.k_zz / L) ** 2 == pytest.approx(I_Z / M, rel=1e-4)
    assert (ship.form.k_xx / L) ** 2 == pytest.approx(I_X / M, rel=1e-3)
    # yaw inertia at midship: J_z with the added mass ALPHA_Y forward of G moved there
    x = h.x_G / L
    J_z = J_Z + 2.0 * x * ALPHA_Y * M_Y + x * x * M_Y
    assert h.J_z == pytest.approx(c * J_z, rel=1e-4)
    I_r = ship.inertia.I_r / (0.5 * ship.rho * L**5)
    assert I_r == pytest.approx(I_Z + x * x * h.volume / (0.5 * L**3) + J_z, rel=1e-4)


@pytest.mark.parametrize("speed", [7.3, 10.36])
def test_s175_propeller_straight_ahead(speed):
    """X_uu u^2 + (1 - t) T = 0 with the printed numbers."""
    n = self_propulsion(load_ship("s175"), speed)
    J = (1.0 - 0.184) * speed / (n * 6.533)
    thrust = n * n * 6.533**4 * (0.527 - 0.455 * J)
    assert (1.0 - 0.175) * thrust == pytest.approx(-X_UU * 0.5 * L**2 * speed**2, rel=1e-3)


def test_s175_wake_is_the_printed_one():
    ship = load_ship("s175")
    record, _ = tables_of(ship)
    x = ship.hull.x_G / L
    for v, r in ((-0.05, 0.05), (-0.05, 0.15), (0.1, 0.0), (-0.25, 0.5)):
        theirs = 0.816 + 1.09 * (v + x * r - 0.526 * r) ** 2
        flow = (1.0, math.asin(-v))
        assert wake(flow, r / L, record.propeller) == pytest.approx(theirs, abs=1e-6)
    assert wake((1.0, 0.5), 9.0 / L, record.propeller) == pytest.approx(0.816 + 1.09 * 0.3)


def test_s175_rudder_inflow_is_the_printed_law():
    """uR = epsilon uP sqrt(1 + 8 k KT / (pi J^2)), vR = 0.088 v - 0.156 r at G and its cubics."""
    ship = load_ship("s175")
    record, _ = tables_of(ship)
    rho, d_P, n, u = ship.rho, 6.533, 1.6, 9.0
    J = 0.816 * u / (n * d_P)
    K_T = 0.527 - 0.455 * J
    theirs = 0.921 * 0.816 * u * math.sqrt(1.0 + 8.0 * 0.631 * K_T / (math.pi * J * J))
    race = (K_T * rho * n * n * d_P**4, 0.816, 0.0)
    assert axial_inflow(u, race, record) == pytest.approx(theirs, rel=1e-6)
    v, r, x = -0.02, 0.05, ship.hull.x_G / L  # small: U beta = -v
    k = ship.rudder
    ours = -k.gamma_R_p * lateral_inflow((1.0, math.asin(-v)), r / L, record.rudder)
    assert ours == pytest.approx(0.088 * (v + x * r) - 0.156 * r, rel=1e-3)
    v, r = -0.2, 0.6
    cubics = -0.275 * r**3 + 1.96 * r * r * (v + x * r)
    assert -cubic_inflow((0.98, v, r / L), 1.0, record) == pytest.approx(cubics, rel=1e-5)
    assert k.f_alpha == pytest.approx(6.13 * 1.8219 / (1.8219 + 2.25), rel=1e-4)
    # moment about midship of a force that the paper places from G
    arm = (k.x_R + k.a_H * k.x_H) / L
    assert arm == pytest.approx(-0.5 - 0.237 * 0.48 + x * 1.237, rel=1e-5)


def test_s175_torque_coefficient_belongs_to_a_propeller_with_the_printed_thrust():
    J = np.linspace(0.2, 1.0, 17)
    K_T, _ = b_series(J, 1.073, 0.70, 4)
    np.testing.assert_allclose(K_T, 0.527 - 0.455 * J, atol=0.009)
