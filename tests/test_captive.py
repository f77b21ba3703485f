"""Captive tests: the gauge is the equation of motion, and harmonics by hand."""

from __future__ import annotations

import dataclasses
import math

import pytest

from ship_gym.captive import SWAY, TESTS, Condition, gauge, kind, measure, programme
from ship_gym.config import ConfigError
from ship_gym.physics.dynamics import accelerations
from ship_gym.physics.quantities import Force, Motion
from ship_gym.ships import load_ship, scaled
from ship_gym.ships.plausible import checked
from ship_gym.simulation import straight_forces
from tests.conftest import forces, symmetric, tables_of

SHIP = load_ship("kvlcc2_model")
L, Q = SHIP.hull.L, 0.5 * SHIP.rho * SHIP.hull.L * SHIP.hull.d  # [m], [kg/m]


def test_what_the_gauge_holds_back_is_what_the_ship_would_do():
    """Water and gauge together give the imposed accelerations in the equation of motion."""
    motion, rates = Motion(1.1, -0.2, 0.05), Motion(0.02, 0.01, -0.03)
    water = Force(3.0, -7.0, 4.0)
    inertia = tables_of(SHIP)[0].inertia
    X, Y, N = gauge(water, motion, rates, SHIP.inertia)
    held = accelerations(motion, water.X - X, water.Y - Y, water.N - N, inertia)
    assert held == pytest.approx(rates, rel=1e-12)
    free = Motion(*accelerations(motion, *water, inertia))
    assert gauge(water, motion, free, SHIP.inertia) == pytest.approx((0.0, 0.0, 0.0), abs=1e-10)


def test_static_drift_is_the_force_of_the_water_alone():
    U, beta, n = 1.179, math.radians(12.0), 10.0
    motion = (U * math.cos(beta), -U * math.sin(beta), 0.0)
    H, P, R, flow = forces(motion, (0.1, n), *tables_of(SHIP))
    (found,) = measure(SHIP, [Condition(U, n, beta, 0.1)])
    q = Q * U * U
    assert found["X"] == pytest.approx((H.X + P.X + R.X) / q, rel=1e-12)
    assert found["Y"] == pytest.approx((H.Y + P.Y + R.Y) / q, rel=1e-12)
    assert found["N"] == pytest.approx((H.N + P.N + R.N) / (q * L), rel=1e-12)
    assert found["T"] == pytest.approx(flow.thrust / q, rel=1e-12)
    assert found["Y"] > 0.0 and found["N"] > 0.0  # drift to port pushes to starboard, bow up


def test_carriage_at_self_propulsion_feels_nothing():
    ship = symmetric(SHIP)  # a single screw's bias would be felt
    (first, *_, zero), n = programme(ship, "rudder"), programme(ship, "rudder")[0].n
    assert first.delta == pytest.approx(-math.radians(35.0)) == -zero.delta
    own, _ = straight_forces(ship, ship.speed, n)
    (found,) = measure(ship, [Condition(ship.speed, n)])
    assert own.hull.X < -1.0
    assert (found["X"], found["Y"], found["N"]) == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


def test_rotating_arm_adds_the_centrifugal_force():
    U, r = 1.179, 0.4
    motion = (U, 0.0, r * U / L)
    H, P, R, _ = forces(motion, (0.0, 10.0), *tables_of(SHIP))
    (found,) = measure(SHIP, [Condition(U, 10.0, yaw_rate=r)])
    b = SHIP.inertia
    Y = H.Y + P.Y + R.Y - b.m_u * U * U * r / L
    N = H.N + P.N + R.N - b.m_xG * U * U * r / L
    assert found["Y"] == pytest.approx(Y / (Q * U * U), rel=1e-12)
    assert found["N"] == pytest.approx(N / (Q * U * U * L), rel=1e-12)
    assert kind([Condition(U, 10.0, yaw_rate=r)]) == "yaw"


def test_inertia_of_pure_yaw_by_hand():
    """In phase: m x_G and I_z with r' omega'; at twice the frequency m_u u' of u = U / cos(chi)."""
    run = programme(SHIP, "yaw", speed=1.179)[0]
    r, omega = run.yaw_rate, run.omega * L / run.speed
    chi = r / omega
    assert chi / omega == pytest.approx(SWAY)  # the path's amplitude in lengths
    (found,) = measure(SHIP, [run])
    b, q = SHIP.inertia, Q * L
    assert found["Y_in"] == pytest.approx(b.m_xG / (q * L) * r * omega, rel=1e-9)
    assert found["N_in"] == pytest.approx(b.I_r / (q * L * L) * r * omega, rel=1e-9)
    # u' = U chi_0^2 omega / 2 sin(2 omega t) to second order of a small angle
    assert found["X_in2"] == pytest.approx(-b.m_u / q * 0.5 * chi * chi * omega, rel=0.02)


def test_damping_of_pure_yaw_by_hand():
    """Without rudder and propeller: Y_out = (Y_r - m_u') r', N_out = (N_r - m' x_G') r'."""
    bare = dataclasses.replace(SHIP.rudder, A_R=1e-9)
    # alike to both sides, for the stopped screw drags as its wake does
    ship, r = symmetric(checked(dataclasses.replace(SHIP, rudder=bare, strict=False))), 1e-3
    (found,) = measure(ship, [Condition(1.179, 0.0, yaw_rate=r, omega=0.1)])
    b, h = ship.inertia, ship.hull
    assert found["Y_out"] == pytest.approx((h.Y_r - b.m_u / (Q * L)) * r, rel=1e-3)
    assert found["N_out"] == pytest.approx((h.N_r - b.m_xG / (Q * L * L)) * r, rel=1e-3)
    assert found["X_mean"] < 0.0 and abs(found["X_out"]) < 1e-9


@pytest.mark.parametrize("test", TESTS)
def test_mirrored_ship_has_the_mirrored_forces(test):
    ship = symmetric(SHIP)
    runs = programme(ship, test)
    other = [
        dataclasses.replace(c, beta=-c.beta, delta=-c.delta, yaw_rate=-c.yaw_rate) for c in runs
    ]
    assert kind(runs) == kind(other) == test
    for a, b in zip(measure(ship, runs), measure(ship, other), strict=True):
        for name, value in a.items():
            sign = -1.0 if name[0] in "YN" else 1.0
            assert b[name] == pytest.approx(sign * value, abs=1e-9), name


def test_froude_scaled_ship_has_the_same_coefficients():
    large = scaled(SHIP, 4.0 * L, rho=SHIP.rho, friction_correction=False)
    runs = programme(SHIP, "yaw_drift")
    other = [
        dataclasses.replace(c, speed=2.0 * c.speed, n=0.5 * c.n, omega=0.5 * c.omega) for c in runs
    ]
    for a, b in zip(measure(SHIP, runs), measure(large, other), strict=True):
        assert b == pytest.approx(a, abs=1e-12)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"speed": 0.0}, "captive speed = 0"),
        ({"n": -1.0}, "captive n = -1"),
        ({"beta": 20.0}, "looks like degrees"),
        ({"delta": 35.0}, "captive delta"),
        ({"yaw_rate": 9.0}, "captive yaw_rate = 9"),
        ({"omega": 1.0}, "a model that swings has a yaw rate"),
    ],
)
def test_a_run_that_is_none_is_refused(values, words):
    with pytest.raises(ConfigError, match=words):
        Condition(**{"speed": 1.0, "n": 10.0} | values)


def test_runs_of_two_kinds_and_unknown_tests_are_refused():
    steady, swinging = Condition(1.0, 10.0), Condition(1.0, 10.0, yaw_rate=0.1, omega=0.1)
    for runs in ([steady, swinging], []):
        with pytest.raises(ConfigError, match="either all of a swinging model or all steady"):
            kind(runs)
    assert kind([steady]) == "drift"
    with pytest.raises(ConfigError, match="unknown captive test 'sway'"):
        programme(SHIP, "sway")
