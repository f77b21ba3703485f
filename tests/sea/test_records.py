import numpy as np
import pytest

from ship_gym.physics.disturbance import disturbance_forces
from ship_gym.sea import Sea
from ship_gym.sea.records import (
    N_DISTURBANCE,
    SEA_DTYPE,
    disturbance_harmonics,
    disturbance_spectrum,
    set_phases,
    waters,
)
from ship_gym.ships import load_ship


def test_spectrum_has_unit_variance():
    omega = np.linspace(0.0, 2000.0, 2_000_001)
    assert np.trapezoid(disturbance_spectrum(omega, 3.0), omega) == pytest.approx(1.0, abs=2e-4)


def test_harmonics_have_unit_variance_and_the_spectrum_s_shape():
    omega, amplitude = disturbance_harmonics(60.0)
    assert 0.5 * (amplitude**2).sum() == pytest.approx(1.0)
    ratio = amplitude**2 / disturbance_spectrum(omega, 60.0)
    np.testing.assert_allclose(ratio, ratio[0])
    assert 2.0 * np.pi / omega[0] > 900.0  # longer than an episode of 600 s


def records(count, seed=0):
    ship = load_ship("kcs")
    made = waters([ship] * count, Sea(sway_disturbance=0.01, yaw_disturbance=0.002))
    set_phases(made, np.arange(count), np.random.default_rng(seed).random((count, N_DISTURBANCE)))
    return ship, made


def forces(water, ship, times):
    omega_1, harmonics = water.records["omega_1"][ship], water.harmonics[ship]
    return np.array([disturbance_forces(t, omega_1, harmonics) for t in times])


def test_disturbance_has_the_stated_standard_deviation():
    ship, made = records(4)
    period = 2.0 * np.pi / made.records[0]["omega_1"]
    force = 0.5 * ship.rho * ship.hull.L * ship.hull.d * ship.speed**2
    for i in range(4):
        F = forces(made, i, np.linspace(0, period, 2001)[:-1])
        np.testing.assert_allclose(F.mean(axis=0), 0.0, atol=1e-6 * force * ship.hull.L)
        assert F[:, 0].std() == pytest.approx(0.01 * force, rel=1e-6)
        assert F[:, 1].std() == pytest.approx(0.002 * force * ship.hull.L, rel=1e-6)


def test_disturbance_is_the_sum_of_cosines():
    _, made = records(1, seed=3)
    phases = 2.0 * np.pi * np.random.default_rng(3).random((1, N_DISTURBANCE))[0]
    sea, k = made.records[0], np.arange(1, 17)
    amplitude = disturbance_harmonics(0.4 / sea["omega_1"])[1]
    for t in (0.0, 12.3, 456.7):
        angle = k * sea["omega_1"] * t
        Y = sea["Y_std"] * (amplitude * np.cos(angle + phases[:16])).sum()
        N = sea["N_std"] * (amplitude * np.cos(angle + phases[16:])).sum()
        np.testing.assert_allclose(forces(made, 0, [t])[0], (Y, N), rtol=1e-9)


def test_calm_costs_and_does_nothing():
    made = waters([load_ship("kcs")])
    assert made.records.dtype == SEA_DTYPE and made.records[0]["disturbed"] == 0
    assert made.harmonics.shape == (1, 4, 0)
    assert (forces(made, 0, [3.0]) == 0.0).all()
