import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ship_gym.physics.hull import (
    crossflow_forces,
    hull_forces,
    polynomial_forces,
    polynomial_share,
)
from ship_gym.ships import available_ships, load_ship
from tests.conftest import tables_of

RHO = 1000.0
speeds = st.floats(-20.0, 20.0)
rates = st.floats(-2.0, 2.0)
names = st.sampled_from(available_ships())


def record(name="kcs_model"):
    return tables_of(load_ship(name, surrogate="none"))[0].hull


def test_straight_ahead_is_the_resistance():
    hull = record()
    X, Y, N = hull_forces(0.86, 0.0, 0.0, hull, RHO)
    assert X == pytest.approx(-0.0183 * 0.5 * RHO * 3.057 * 0.144 * 0.86**2)
    assert Y == N == 0.0


def test_published_polynomial_by_hand():
    """KVLCC2, YY15 derivatives, v' = -0.3, r' = 0.8 written out term by term."""
    hull = record("kvlcc2_model")
    U, v_, r_ = 1.0, -0.3, 0.8
    v, r = v_ * U, r_ * U / 7.0
    X, Y, N = hull_forces(math.sqrt(U**2 - v**2), v, r, hull, RHO)
    q = 0.5 * RHO * 7.0 * 0.46
    assert X / q == pytest.approx(
        -0.01588 - 0.040 * 0.09 + 0.002 * v_ * r_ + 0.011 * 0.64 + 0.771 * 0.0081
    )
    assert Y / q == pytest.approx(
        -0.315 * v_
        + 0.083 * r_
        - 1.607 * v_**3
        + 0.379 * 0.09 * r_
        - 0.391 * v_ * 0.64
        + 0.008 * 0.512
    )
    assert N / (7.0 * q) == pytest.approx(
        -0.137 * v_
        - 0.049 * r_
        - 0.030 * v_**3
        - 0.294 * 0.09 * r_
        + 0.055 * v_ * 0.64
        - 0.013 * 0.512
    )


def test_forces_go_with_speed_squared_at_one_attitude():
    """The trap of public codes: the U'^2 factor lost during speed loss."""
    hull = record()
    whole = np.array(hull_forces(0.80, -0.2, 0.1, hull, RHO))
    half = np.array(hull_forces(0.40, -0.1, 0.05, hull, RHO))
    np.testing.assert_allclose(whole, 4.0 * half, rtol=1e-12)


@settings(max_examples=300)
@given(names, speeds, speeds, rates)
def test_finite_everywhere_and_mirror_symmetric(name, u, v, r):
    hull = record(name)
    X, Y, N = hull_forces(u, v, r, hull, RHO)
    assert math.isfinite(X) and math.isfinite(Y) and math.isfinite(N)
    assert hull_forces(u, -v, -r, hull, RHO) == (X, -Y, -N)


@settings(max_examples=200)
@given(names, speeds, rates)
def test_a_ship_without_headway_only_loses_energy(name, v, r):
    X, Y, N = hull_forces(0.0, v, r, record(name), RHO)
    assert X == 0.0
    assert Y * v + N * r <= 0.0


def test_at_rest_nothing_acts():
    assert hull_forces(0.0, 0.0, 0.0, record(), RHO) == (0.0, 0.0, 0.0)


def test_polynomial_rules_in_its_range_and_crossflow_outside():
    hull, L = record(), 3.057
    # steady 35 deg turns: drift 15-20 deg, r' 0.75-0.9
    assert polynomial_share(math.cos(0.35), -math.sin(0.35), 0.95 / L, L) == 1.0
    assert polynomial_share(-1.0, 0.0, 0.0, L) == 0.0
    assert polynomial_share(0.01, 0.0, 1.0, L) == 0.0
    state = (1.0, -0.3, 0.2)
    assert hull_forces(*state, hull, RHO) == polynomial_forces(*state, hull, RHO)
    state = (-1.0, 0.3, 0.2)
    assert hull_forces(*state, hull, RHO) == crossflow_forces(*state, hull, RHO)


@pytest.mark.compiled
@pytest.mark.parametrize("name", available_ships())
def test_no_jump_over_all_drift_angles_and_yaw_rates(name):
    hull = record(name)
    L, q = float(hull.L), 0.5 * RHO * float(hull.L) * float(hull.d)

    def forces(beta, r_):
        F = hull_forces(math.cos(beta), -math.sin(beta), r_ / L, hull, RHO)
        return np.array([F[0] / q, F[1] / q, F[2] / (q * L)])

    def largest_step(points):
        return np.abs(np.diff(points, axis=0)).max()

    for r_ in (0.0, 0.8, 1.5):
        fine = np.array([forces(b, r_) for b in np.linspace(-math.pi, math.pi, 8001)])
        coarse = fine[::2]
        # continuous: halving the step halves the largest difference
        assert largest_step(fine) < 0.6 * largest_step(coarse)
    fine = np.array([forces(0.2, r_) for r_ in np.linspace(-4.0, 4.0, 8001)])
    assert largest_step(fine) < 0.6 * largest_step(fine[::2])


def test_continuous_down_to_zero_speed():
    hull = record()
    for u in (1e-3, 1e-6, 1e-12, 0.0, -1e-12):
        X, Y, N = hull_forces(u, 0.0, 0.1, hull, RHO)
        X0, Y0, N0 = hull_forces(0.0, 0.0, 0.1, hull, RHO)
        assert abs(X - X0) + abs(Y - Y0) + abs(N - N0) <= 200.0 * abs(u)
