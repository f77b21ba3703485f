import numpy as np
import pytest
from scipy.integrate import quad

from ship_gym.config import ConfigError
from ship_gym.sea.gusts import (
    FREQUENCIES,
    gust_harmonics,
    mean_speed,
    norsok_spectrum,
    turbulence_intensity,
)


def test_spectrum_as_printed():
    # limits of the printed formula: 320 m2/s at f = 0 and 10 m/s, f^(-5/3) at high frequency
    assert norsok_spectrum(0.0, 10.0) == pytest.approx(320.0)
    assert norsok_spectrum(0.0, 20.0, 40.0) == pytest.approx(320.0 * 4.0 * 4.0**0.45)
    assert norsok_spectrum(1.0 / 172.0, 10.0) == pytest.approx(320.0 * 2.0 ** (-5.0 / (3 * 0.468)))
    slope = np.log(norsok_spectrum(1e9, 10.0) / norsok_spectrum(1e8, 10.0)) / np.log(10.0)
    assert slope == pytest.approx(-5.0 / 3.0, abs=1e-3)


def test_profile_and_intensity_as_printed():
    assert mean_speed(15.0, 10.0) == 15.0
    assert mean_speed(20.0, 40.0) == pytest.approx(20.0 * (1.0 + 0.0573 * 2.0 * np.log(4.0)))
    assert turbulence_intensity(20.0) == pytest.approx(0.06 * 1.86)
    assert turbulence_intensity(20.0, 40.0) == pytest.approx(0.06 * 1.86 * 4.0**-0.22)


@pytest.mark.parametrize("U", [10.0, 15.0, 20.0, 25.0, 30.0])
def test_standard_deviation_is_the_published_intensity(U):
    _, amplitude = gust_harmonics(U)
    deviation = np.sqrt(0.5 * (amplitude**2).sum())
    assert deviation / U == pytest.approx(turbulence_intensity(U), rel=0.04)


@pytest.mark.parametrize("count", [1, 20, 100])
def test_harmonics_have_the_energy_of_the_spectrum(count):
    omega, amplitude = gust_harmonics(12.0, 20.0, count)
    energy = quad(lambda f: norsok_spectrum(f, 12.0, 20.0), *FREQUENCIES, limit=200)[0]
    assert 0.5 * (amplitude**2).sum() == pytest.approx(energy, rel=1e-4)
    assert len(omega) == count and (np.diff(omega) > 0.0).all()
    f = omega / (2.0 * np.pi)
    assert FREQUENCIES[0] < f[0] and f[-1] < FREQUENCIES[1]


def test_synthesised_gusts():
    omega, amplitude = gust_harmonics(15.0)
    time = np.arange(0.0, 6.0 * 3600.0, 0.5)
    phase = np.random.default_rng(1).uniform(0.0, 2.0 * np.pi, len(omega))
    gust = (amplitude[:, None] * np.cos(omega[:, None] * time + phase[:, None])).sum(axis=0)
    assert gust.mean() == pytest.approx(0.0, abs=0.05)
    assert gust.std() / 15.0 == pytest.approx(turbulence_intensity(15.0), rel=0.06)


def test_height_lowers_the_intensity():
    low, high = (gust_harmonics(15.0, z)[1] for z in (10.0, 40.0))
    assert np.linalg.norm(high) / mean_speed(15.0, 40.0) < np.linalg.norm(low) / 15.0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"U_10": -5.0}, r"wind\.speed"),
        ({"U_10": 0.0}, r"wind\.speed"),
        ({"z": 0.0}, r"wind\.height"),
        ({"count": 0}, r"wind\.count"),
    ],
)
def test_bad_gusts(options, message):
    with pytest.raises(ConfigError, match=message):
        gust_harmonics(**{"U_10": 10.0, **options})
