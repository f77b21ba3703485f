"""Measured spectra: moments, directions and heights kept, beside independent sums and formulas."""

import dataclasses
import math

import numpy as np
import pytest

from ship_gym import ShipSim
from ship_gym.config import ConfigError
from ship_gym.conventions import G
from ship_gym.sea import Sea, measured_sea
from ship_gym.sea.components import N_DIRECTIONS, wave_components
from ship_gym.sea.measured import MeasuredSpectrum
from ship_gym.sea.measured_forms import of_directions, of_moments
from ship_gym.sea.spectra import WaveSystem, jonswap, spreading

F = np.linspace(0.04, 0.5, 80)
TO = np.radians(np.arange(5.0, 360.0, 10.0))


def over_hertz(height, period):
    """JONSWAP per hertz."""
    return 2.0 * np.pi * jonswap(2.0 * np.pi * F, height, period)


def spread_about(centre, s):
    off = (TO - math.radians(centre) + np.pi) % (2.0 * np.pi) - np.pi
    return spreading(off, s)


def moments_of(f, to, density):
    """m_0, mean direction and spread by sums of the bins, written again."""
    width = np.radians(10.0)
    column = (density * width).sum(axis=1)
    m_0 = sum(0.5 * (column[i] + column[i + 1]) * (f[i + 1] - f[i]) for i in range(len(f) - 1))
    vector = 0.0
    for i in range(len(f) - 1):
        pair = 0.5 * (density[i] + density[i + 1]) * width
        vector += (pair * np.exp(1j * to)).sum() * (f[i + 1] - f[i])
    r = abs(vector) / m_0
    return m_0, np.angle(vector), math.sqrt(2.0 * (1.0 - r))


ONE = over_hertz(3.0, 9.0)[:, None] * spread_about(120.0, 4.0)
BOTH = ONE + over_hertz(2.0, 14.0)[:, None] * spread_about(30.0, 12.0)


@pytest.mark.parametrize("density", [ONE, BOTH], ids=["one", "two systems"])
@pytest.mark.parametrize("count", [40, 60, 200])
def test_variance_direction_and_spread_of_two_dimensions(density, count):
    spectrum = of_directions(F, TO, density)
    m_0, mean, spread = moments_of(F, TO, density)
    assert spectrum.m_0 == pytest.approx(m_0, rel=1e-12)
    assert spectrum.mean_direction == pytest.approx(mean, abs=1e-12)
    assert spectrum.spread == pytest.approx(spread, abs=1e-9)
    waves = spectrum.components(count)
    energy = 0.5 * waves.amplitude**2
    assert energy.sum() == pytest.approx(m_0, rel=1e-12)
    np.testing.assert_allclose(energy, m_0 / count, rtol=1e-12)
    np.testing.assert_allclose(waves.k, waves.omega**2 / G, rtol=1e-15)
    unit = np.exp(1j * waves.direction).mean()
    assert np.angle(unit) == pytest.approx(0.0, abs=1e-12)
    found = math.sqrt(2.0 * (1.0 - abs(unit)))
    assert found == pytest.approx(spread, rel=0.06)
    assert len(np.unique(waves.direction)) <= N_DIRECTIONS


def test_each_system_of_a_file_keeps_its_direction():
    """Below 0.08 Hz the swell that goes to 30 deg, above 0.12 Hz mostly the wind sea."""
    spectrum = of_directions(F, TO, BOTH)
    waves = spectrum.components(200)
    to = waves.direction + spectrum.mean_direction
    f = waves.omega / (2.0 * np.pi)
    for low, high, near in ((0.0, 0.08, 30.0), (0.12, 1.0, 115.0)):
        mean = np.degrees(np.angle(np.exp(1j * to[(f > low) & (f < high)]).mean()))
        inside = (F > low) & (F < high)
        own = np.degrees(np.angle((BOTH[inside] * np.exp(1j * TO)).sum()))
        assert own == pytest.approx(near, abs=3.0)
        assert mean == pytest.approx(own, abs=3.0)
    between = (to > np.radians(60.0)) & (to < np.radians(75.0))
    assert between.mean() < 0.1  # no waves of the mean of the two


@pytest.mark.parametrize("apart", [180.0, 175.0, 150.0])
def test_seas_against_each_other_keep_their_directions(apart):
    """The mean direction of two that cancel is chance; turning all by it would turn both."""
    f, deg = np.linspace(0.04, 0.4, 60), np.arange(0.0, 360.0, 10.0)
    S = 2.0 * np.pi * jonswap(2.0 * np.pi * f, 2.0, 8.0)
    off = np.radians((deg[None] - np.array([[0.0], [apart]]) + 180.0) % 360.0 - 180.0)
    D = (np.cos(0.5 * off) ** 100).sum(axis=0)
    spectrum = of_directions(f, np.radians(deg), S[:, None] * D)
    to = spectrum.components(60).direction + spectrum.mean_direction
    for centre in np.radians([0.0, apart]):
        near = np.abs(np.angle(np.exp(1j * (to - centre)))) < np.radians(45.0)
        assert near.mean() == pytest.approx(0.5, abs=0.05)
        assert np.angle(np.exp(1j * (to[near] - centre)).sum()) == pytest.approx(0.0, abs=0.06)


def test_period_of_the_peak_and_height():
    spectrum = MeasuredSpectrum(F, over_hertz(3.0, 9.0))
    assert spectrum.peak_period == pytest.approx(9.0, rel=0.03)  # steps of 0.006 Hz
    tail = jonswap(np.linspace(np.pi, 40.0, 40_001), 3.0, 9.0)  # above 0.5 Hz
    lost = np.trapezoid(tail, np.linspace(np.pi, 40.0, 40_001))
    assert spectrum.m_0 == pytest.approx(9.0 / 16.0 - lost, rel=2e-3)
    assert spectrum.with_height(1.2).height == pytest.approx(1.2, rel=1e-12)


def test_a_finely_measured_spectrum_gives_the_waves_of_its_formula():
    f = np.geomspace(0.3, 12.0, 3001) / 9.0
    S = 2.0 * np.pi * jonswap(2.0 * np.pi * f, 3.0, 9.0)
    found = MeasuredSpectrum(f, S).components(60)
    wanted = wave_components((WaveSystem("jonswap", 3.0, 9.0),), 60)
    np.testing.assert_allclose(found.omega, wanted.omega, rtol=1e-3)
    np.testing.assert_allclose(found.amplitude, wanted.amplitude, rtol=2e-3)
    short = MeasuredSpectrum(f, S, spreading=4.0).components(60)
    system = WaveSystem("jonswap", 3.0, 9.0, spreading=4.0)
    np.testing.assert_array_equal(short.direction, wave_components((system,), 60).direction)


@pytest.mark.parametrize("r_1", [0.5, 0.9])
def test_moments_of_a_buoy_come_back(r_1):
    to = np.radians(np.linspace(100.0, 140.0, len(F)))
    spectrum = of_moments(F, over_hertz(3.0, 9.0), to, np.full(len(F), r_1))
    shares, grid = np.array(spectrum.shares), np.array(spectrum.direction)
    unit = (shares * np.exp(1j * grid)).sum(axis=1)
    np.testing.assert_allclose(np.abs(unit), r_1, atol=1e-9)
    np.testing.assert_allclose(np.angle(unit), to, atol=1e-9)


def test_a_model_has_the_same_waves_smaller():
    spectrum = of_directions(F, TO, BOTH)
    full, model = spectrum.components(60), spectrum.scaled(49.0).components(60)
    np.testing.assert_allclose(model.amplitude * 49.0, full.amplitude, rtol=1e-9)
    np.testing.assert_allclose(model.omega / 7.0, full.omega, rtol=1e-9)
    np.testing.assert_allclose(model.direction, full.direction, atol=1e-9)


def test_a_sea_of_it_sails_and_goes_where_the_file_says():
    sea = measured_sea(of_directions(F, TO, ONE))
    assert sea.has_waves and sea.height == pytest.approx(3.0, rel=0.02)
    sim = ShipSim("kcs", 2, sea)
    sim.reset(1)
    amplitude, _, _, _, to = sim.water.waves_of(1)
    assert 0.5 * (amplitude**2).sum() == pytest.approx(sea.spectrum.m_0, rel=1e-12)
    assert np.degrees(np.angle(np.exp(1j * to).mean())) == pytest.approx(120.0, abs=1e-6)
    sim.step([[0.0, 1.5]] * 2, 5.0)
    assert np.abs(sim.forces[:, -3:]).sum() > 0.0
    turned = measured_sea(of_directions(F, TO, ONE), direction_from=0.0)
    assert turned.wave_direction_to == pytest.approx(-math.pi)


def test_one_direction_comes_from_north_unless_said():
    sea = measured_sea(MeasuredSpectrum(F, over_hertz(2.0, 8.0)))
    assert sea.wave_direction_to == math.pi and not sea.components().direction.any()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"frequency": F[::-1]}, "must rise"),
        ({"frequency": F[:2], "density": F[:2]}, "3 or more"),
        ({"density": -F}, r"density\[0\] = -0.04: allowed is 0"),
        ({"density": 0.0 * F}, "no energy"),
        ({"density": F[:5]}, "5 of density for 80"),
        ({"density": 1e4 * F}, "significant height"),
        ({"spreading": 0.3}, "allowed is 1 to 100"),
    ],
)
def test_what_is_no_spectrum(changes, words):
    with pytest.raises(ConfigError, match=words):
        MeasuredSpectrum(**{"frequency": F, "density": over_hertz(2.0, 8.0)} | changes)


def test_directions_that_have_no_equal_steps():
    with pytest.raises(ConfigError, match="equal steps"):
        of_directions(F, np.append(TO[:-1], TO[-1] - 0.05), ONE)
    with pytest.raises(ConfigError, match="allowed is 0 or more"):
        of_directions(F, TO, ONE - 1.0)
    of_directions(F, TO[5:20], ONE[:, 5:20])  # a sector


def test_a_measured_spectrum_beside_other_waves_is_refused():
    sea = measured_sea(MeasuredSpectrum(F, over_hertz(2.0, 8.0)))
    with pytest.raises(ConfigError, match="not both"):
        dataclasses.replace(sea, waves=(WaveSystem("jonswap", 1.0, 8.0),))
    assert Sea().has_waves is False and Sea().height == 0.0 and Sea().period == 0.0
