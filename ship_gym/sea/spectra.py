"""Wave spectra S(omega) and the spreading of their energy over directions.

Every spectrum has a significant wave height H_s = 4 sqrt(m_0), so that its integral over omega is
H_s^2 / 16, and a peak at omega_p = 2 pi / T_p. A seaway is one or more `WaveSystem`: the wind sea
and, if there is one, the swell; their spectra add (`sea_spectrum`).

Printed forms: Bretschneider, also called ITTC two-parameter or modified Pierson-Moskowitz,
S = A omega^-5 exp(-B omega^-4) with A = 487 H_s^2 / T^4, B = 1949 / T^4 for T = T_p, 173 and 691
for T_1, 123 and 495 for T_z (Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control,
section 10.2); JONSWAP in the form of DNV-RP-C205, section 3.5.5.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, check_angle, check_known, check_number
from ship_gym.conventions import G

STEEPEST = 0.142  # height / length of the steepest regular wave in deep water, Michell (1893)
SPECTRA = ("bretschneider", "jonswap")


@dataclasses.dataclass(frozen=True)
class WaveSystem:
    """One peak of a seaway: a wind sea or a swell. Height 0 is no waves.

    Attributes
    ----------
    spectrum : str
        ``"jonswap"`` or ``"bretschneider"``.
    height : float
        Significant wave height H_s [m].
    peak_period : float
        T_p [s]; from T_1 or T_z by `peak_period`.
    gamma : float
        Peak enhancement of JONSWAP, 1 to 10; not used by Bretschneider.
    direction : float
        Where this system goes to, relative to the seaway's main direction, clockwise [rad].
    spreading : float
        s of cos^(2s) over +-90 deg, at least 1; 0: long-crested.
    """

    spectrum: str = "jonswap"
    height: float = 0.0
    peak_period: float = 10.0
    gamma: float = 3.3
    direction: float = 0.0
    spreading: float = 0.0

    def __post_init__(self) -> None:
        check_known("spectrum", self.spectrum, SPECTRA)
        check_number("waves.height", self.height, 0.0, 30.0, "m")
        check_number("waves.peak_period", self.peak_period, 0.1, 40.0, "s")
        check_number("waves.gamma", self.gamma, 1.0, 10.0)
        check_angle("waves.direction", self.direction)
        check_steepness(self.height, self.peak_period)
        if self.spreading != 0.0:
            check_spreading(self.spreading)

    @property
    def omega_p(self) -> float:
        """Frequency of the peak [rad/s]."""
        return 2.0 * math.pi / self.peak_period

    def density(self, omega: Any) -> np.ndarray:
        """S(omega) [m2 s] at omega [rad/s] > 0."""
        if self.spectrum == "jonswap":
            return jonswap(omega, self.height, self.peak_period, self.gamma)
        return bretschneider(omega, self.height, self.peak_period)

    def scaled(self, scale: float) -> WaveSystem:
        """The same waves for a model of a scale, by Froude's law."""
        return dataclasses.replace(
            self, height=self.height / scale, peak_period=self.peak_period / math.sqrt(scale)
        )


def check_steepness(height: float, peak_period: float) -> None:
    """Refuse a significant height [m] that is too much for its peak period [s]."""
    steepness = 2.0 * math.pi * height / (G * peak_period**2)
    if steepness > STEEPEST:
        raise ConfigError(
            f"waves.height = {height} m at peak_period = {peak_period} s: height by "
            f"length of the peak {steepness:.3f}, a wave breaks above {STEEPEST}"
        )


def sea_spectrum(omega: Any, systems: tuple[WaveSystem, ...]) -> np.ndarray:
    """Sum of the spectra of all systems [m2 s]: one or more peaks."""
    return sum((s.density(omega) for s in systems), np.zeros(np.shape(omega)))


def bretschneider(omega: Any, height: float, peak_period: float) -> np.ndarray:
    """Bretschneider (ITTC two-parameter) spectrum.

    Parameters
    ----------
    omega : array_like
        Frequency [rad/s], > 0.
    height : float
        Significant wave height H_s [m].
    peak_period : float
        T_p [s].

    Returns
    -------
    numpy.ndarray
        S(omega) [m2 s], one-sided.

    Notes
    -----
    B = (5/4) omega_p^4 puts the peak at omega_p, A = B H_s^2 / 4 makes the integral H_s^2 / 16:
    1948.2 / T_p^4 and 487.0 H_s^2 / T_p^4, where 1949 and 487 are printed.
    """
    omega = np.asarray(omega, dtype=float)
    B = 1.25 * (2.0 * math.pi / peak_period) ** 4
    return 0.25 * height**2 * B * omega**-5.0 * np.exp(-B * omega**-4.0)


def jonswap(omega: Any, height: float, peak_period: float, gamma: float = 3.3) -> np.ndarray:
    """JONSWAP spectrum of given height and peak, DNV-RP-C205 (2010) section 3.5.5.

    Parameters
    ----------
    omega, height, peak_period
        As in `bretschneider`, which is gamma = 1.
    gamma : float
        Peak enhancement.

    Returns
    -------
    numpy.ndarray
        S(omega) [m2 s], one-sided. The factor that keeps H_s is integrated, not the printed
        fit 1 - 0.287 ln(gamma).
    """
    omega = np.asarray(omega, dtype=float)
    peak = _peak_enhancement(omega * peak_period / (2.0 * math.pi), gamma)
    return _jonswap_factor(gamma) * bretschneider(omega, height, peak_period) * peak


def _peak_enhancement(x: np.ndarray, gamma: float) -> np.ndarray:
    """gamma^r at x = omega / omega_p; sigma is 0.07 below the peak and 0.09 above."""
    sigma = np.where(x <= 1.0, 0.07, 0.09)
    return gamma ** np.exp(-0.5 * ((x - 1.0) / sigma) ** 2)


@functools.lru_cache(maxsize=64)
def _jonswap_factor(gamma: float) -> float:
    """Factor A_gamma of DNV-RP-C205, by which the enhanced spectrum keeps its height."""
    x = np.linspace(0.3, 2.0, 3401)  # the enhancement differs from 1 only here
    added = bretschneider(x, 4.0, 2.0 * math.pi) * (_peak_enhancement(x, gamma) - 1.0)
    return 1.0 / (1.0 + float(np.trapezoid(added, x)))


# period / T_p of a Bretschneider spectrum: T_1 = 2 pi m_0/m_1 and T_z = 2 pi sqrt(m_0/m_2)
_PERIODS = {
    "T_p": 1.0,
    "T_1": 1.25**-0.25 / math.gamma(0.75),
    "T_z": (1.25 * math.pi) ** -0.25,
}


def peak_period(period: float, kind: str) -> float:
    """Peak period T_p [s] of the Bretschneider spectrum with a mean period.

    Parameters
    ----------
    period : float
        [s]
    kind : str
        ``"T_p"``, ``"T_1"`` (mean, 2 pi m_0/m_1) or ``"T_z"`` (zero-crossing, 2 pi sqrt(m_0/m_2)).
    """
    ratio = _PERIODS[check_known("kind of wave period", kind, _PERIODS)]
    return check_number("wave period", period, 1e-3, 60.0, "s") / ratio


def fully_developed(wind_speed: float) -> WaveSystem:
    """Pierson-Moskowitz: the wind sea that a steady wind raises on unlimited fetch.

    S = alpha g^2 omega^-5 exp(-beta (g / (U omega))^4), alpha = 8.1e-3, beta = 0.74 (Pierson &
    Moskowitz 1964, J. Geophys. Res. 69, 5181-5190), which is a Bretschneider spectrum.

    Parameters
    ----------
    wind_speed : float
        U at 19.5 m above the sea [m/s].
    """
    U = check_number("wind_speed", wind_speed, 0.5, 60.0, "m/s")
    alpha, beta = 8.1e-3, 0.74
    height = 2.0 * math.sqrt(alpha / beta) * U**2 / G
    period = 2.0 * math.pi * U / (G * (0.8 * beta) ** 0.25)
    return WaveSystem("bretschneider", height, period)


def spreading(theta: Any, s: float) -> np.ndarray:
    """cos^(2s) spreading function, one from -90 to 90 deg and zero elsewhere, of unit integral.

    Parameters
    ----------
    theta : array_like
        Direction relative to the mean one [rad], within [-pi, pi].
    s : float
        At least 1; 1 is (2 / pi) cos^2.

    Returns
    -------
    numpy.ndarray
        D(theta) [1/rad].
    """
    check_spreading(s)
    theta = np.asarray(theta, dtype=float)
    norm = math.exp(math.lgamma(s + 1.0) - math.lgamma(s + 0.5)) / math.sqrt(math.pi)
    return norm * np.where(np.abs(theta) < 0.5 * math.pi, np.cos(theta) ** 2, 0.0) ** s


def check_spreading(s: float) -> None:
    """Refuse an exponent of `spreading` that is none."""
    if not 1.0 <= check_number("waves.spreading", s, 0.0, 100.0):
        raise ConfigError(f"waves.spreading = {s}: allowed is 1 to 100, or 0 for long-crested")
