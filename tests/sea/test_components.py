import math

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.conventions import G
from ship_gym.sea.components import (
    N_DIRECTIONS,
    direction_offsets,
    equal_energy,
    omega_of_length,
    regular_wave,
    wave_components,
)
from ship_gym.sea.spectra import WaveSystem

SYSTEMS = [WaveSystem("jonswap", 3.0, 10.0), WaveSystem("bretschneider", 3.0, 10.0)]
COUNTS = [40, 60, 200]


def moments(system):
    omega = np.linspace(0.2, 20.0, 200_001) * system.omega_p
    S = system.density(omega)
    return [np.trapezoid(S * omega**n, omega) for n in range(3)]


def record(waves, time, seed=0):
    phase = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, len(waves.omega))
    zeta = np.zeros_like(time)
    for a, omega, eps in zip(waves.amplitude, waves.omega, phase, strict=True):
        zeta += a * np.cos(omega * time + eps)
    return zeta


@pytest.mark.parametrize("system", SYSTEMS, ids=lambda s: s.spectrum)
@pytest.mark.parametrize("count", COUNTS)
def test_moments_of_the_components(system, count):
    waves = wave_components((system,), count)
    energy = 0.5 * waves.amplitude**2
    m_0, m_1, m_2 = moments(system)
    assert len(energy) == count
    assert energy.sum() == pytest.approx(system.height**2 / 16.0, rel=1e-12)
    np.testing.assert_allclose(energy, energy[0])
    T_1 = (energy.sum() / (energy @ waves.omega)) / (m_0 / m_1)
    assert T_1 == pytest.approx(1.0, abs=1e-3)
    T_z = math.sqrt(energy.sum() / (energy @ waves.omega**2)) / math.sqrt(m_0 / m_2)
    assert 1.0 < T_z < {40: 1.0125, 60: 1.0105, 200: 1.007}[count]  # as the module says
    np.testing.assert_allclose(waves.k, waves.omega**2 / G)
    assert not waves.direction.any()


@pytest.mark.parametrize("system", SYSTEMS, ids=lambda s: s.spectrum)
def test_synthesised_record_has_the_height_and_the_zero_crossing_period(system):
    time = np.arange(0.0, 3.0 * 3600.0, 0.1)
    zeta = record(wave_components((system,), 100), time)
    assert 4.0 * zeta.std() == pytest.approx(system.height, rel=0.03)
    ups = np.flatnonzero((zeta[:-1] <= 0.0) & (zeta[1:] > 0.0))
    m_0, _, m_2 = moments(system)
    T_z = 2.0 * np.pi * math.sqrt(m_0 / m_2)
    assert np.diff(time[ups]).mean() == pytest.approx(T_z, rel=0.03)


@pytest.mark.parametrize("system", SYSTEMS, ids=lambda s: s.spectrum)
def test_record_does_not_repeat(system):
    waves = wave_components((system,), 60)
    assert (np.diff(waves.omega) > 0.0).all()
    gaps = np.diff(waves.omega)
    assert len(np.unique(np.round(gaps / gaps.min(), 3))) > 50
    lag = np.arange(60.0, 7200.0, 0.25)
    autocorrelation = sum(np.cos(omega * lag) for omega in waves.omega) / 60.0
    assert np.abs(autocorrelation).max() < 0.43  # as the module says; 1 would be a repetition


@pytest.mark.parametrize("s", [1.0, 4.0])
@pytest.mark.parametrize("count", COUNTS)
def test_directional_moments(s, count):
    system = WaveSystem("jonswap", 2.0, 8.0, spreading=s)
    waves = wave_components((system,), count)
    energy = 0.5 * waves.amplitude**2 / (system.height**2 / 16.0)
    assert energy.sum() == pytest.approx(1.0, rel=1e-12)  # N stays N, and so does the energy
    d = waves.direction
    assert energy @ np.sin(d) == pytest.approx(0.0, abs=1e-9)
    assert energy @ np.sin(d) ** 2 == pytest.approx(0.5 / (s + 1.0), rel=0.02)
    mean_cos = math.gamma(s + 1.0) ** 2 / (math.gamma(s + 0.5) * math.gamma(s + 1.5))
    assert energy @ np.cos(d) == pytest.approx(mean_cos, rel=5e-3)
    assert len(np.unique(waves.omega)) == count and len(np.unique(d)) == N_DIRECTIONS


def test_every_part_of_the_spectrum_sees_all_directions():
    waves = wave_components((WaveSystem("jonswap", 2.0, 8.0, spreading=1.0),), 60)
    for part in np.split(waves.direction, 4):
        assert abs(part.mean()) < waves.direction.std() / math.sqrt(15.0)  # better than by chance
        assert part.std() == pytest.approx(waves.direction.std(), rel=0.15)


def test_wind_sea_and_swell():
    sea = WaveSystem("bretschneider", 2.0, 7.0, direction=0.3, spreading=2.0)
    swell = WaveSystem("jonswap", 1.0, 14.0, direction=-1.0)
    waves = wave_components((sea, swell), 60)
    assert len(waves.amplitude) == 60
    assert 0.5 * (waves.amplitude**2).sum() == pytest.approx((2.0**2 + 1.0**2) / 16.0)
    of_swell = waves.direction == -1.0
    assert of_swell.sum() == 20
    assert 0.5 * (waves.amplitude[of_swell] ** 2).sum() == pytest.approx(1.0 / 16.0)
    assert waves.direction[~of_swell].mean() == pytest.approx(0.3)
    assert len(wave_components((sea, swell), 2).omega) == 2


def test_no_waves():
    for systems in ((), (WaveSystem(height=0.0),)):
        assert all(len(column) == 0 for column in wave_components(systems, 60))
    only = wave_components((WaveSystem(height=0.0), SYSTEMS[0]), 60)
    np.testing.assert_array_equal(only, wave_components((SYSTEMS[0],), 60))


def test_same_waves_every_time():
    np.testing.assert_array_equal(*(wave_components(tuple(SYSTEMS), 50) for _ in range(2)))


def test_froude_scaling_of_the_components():
    system = WaveSystem("jonswap", 3.0, 10.0, spreading=1.0)
    full, model = wave_components((system,), 60), wave_components((system.scaled(49.0),), 60)
    np.testing.assert_allclose(model.amplitude * 49.0, full.amplitude)
    np.testing.assert_allclose(model.omega / 7.0, full.omega)
    np.testing.assert_allclose(model.direction, full.direction)


def test_regular_wave_of_the_published_turning_circle():
    # White (2020), KCS model: lambda = L = 3.057 m, omega_0 4.49 rad/s, amplitude 0.024 m
    omega = omega_of_length(3.057)
    assert omega == pytest.approx(4.49, abs=5e-3)
    waves = regular_wave(0.024, omega)
    assert [len(column) for column in waves] == [1, 1, 1, 1]
    assert waves.k[0] == pytest.approx(2.0 * np.pi / 3.057)
    assert waves.direction[0] == 0.0


def test_equal_energy_of_a_flat_spectrum_is_an_even_division():
    x = np.linspace(1.0, 3.0, 1001)
    centre, area = equal_energy(x, np.full(1001, 5.0), 4)
    np.testing.assert_allclose(centre, [1.25, 1.75, 2.25, 2.75], rtol=1e-6)
    np.testing.assert_allclose(area, 2.5)


def test_long_crested_goes_one_way():
    assert not direction_offsets(0.0, 7).any()


@pytest.mark.parametrize("count", [0, -3, 501, 10.0, True])
def test_bad_count(count):
    with pytest.raises(ConfigError, match=r"waves\.count"):
        wave_components((SYSTEMS[0],), count)


def test_bad_regular_waves():
    with pytest.raises(ConfigError, match=r"wave\.amplitude = -1"):
        regular_wave(-1.0, 1.0)
    with pytest.raises(ConfigError, match=r"wave\.omega = 0"):
        regular_wave(1.0, 0.0)
    with pytest.raises(ConfigError, match="breaks above"):
        regular_wave(0.08 * 10.0, omega_of_length(10.0))
    with pytest.raises(ConfigError, match="wavelength"):
        omega_of_length(0.0)


@pytest.mark.parametrize("systems", [(), (WaveSystem("bretschneider", 2.0, 8.0),)])
def test_a_count_below_one_is_refused_with_and_without_waves(systems):
    with pytest.raises(ConfigError, match=r"waves\.count"):
        wave_components(systems, 0)
