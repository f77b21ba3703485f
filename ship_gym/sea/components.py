"""A spectrum as a sum of N regular waves: zeta = sum a_n cos(omega_n t - k_n x . d_n + eps_n).

Frequencies by equal energy: the spectrum is cut into N strips of the same area, each becomes one
wave at the centre of its area. So all N have one amplitude, the height is exact, and frequencies
lie close together where the energy is, which the slowly varying drift needs. The mean period T_1
is 0.1 % long; the price is the tail, in which one strip is wide: T_z is 0.6 % (N = 200), 1.0 % (60)
or 1.2 % (40) longer than that of the full spectrum.

The spacing is irregular, no two differences are alike, and so the record has no period. How near it
comes to a repetition: with 60 waves of T_p 10 s the autocorrelation stays below 0.43 from the
second minute to the tenth hour (60 frequencies drawn by chance: 0.31 to 0.40 in two hours), with
100 waves below 0.36. With a regular spacing it returns to 1 after 2 pi / d_omega.

Short-crested: every wave has one frequency and one direction, so no two waves of one frequency from
two directions make a standing pattern (Jefferys 1987, Appl. Ocean Res. 9, 235-237). The directions
are the middles of N strips of equal area under the spreading function, neighbours sharing one of
N_DIRECTIONS, because a kernel looks the ship's response up once for each. They are dealt to the
frequencies in the order of multiples of the golden ratio, so that each part of the spectrum sees
all directions.

Nothing here is random: the phases eps_n are drawn at reset.
"""

from __future__ import annotations

import functools
import math
from typing import NamedTuple

import numpy as np

from ship_gym.config import ConfigError, check_number, shown
from ship_gym.conventions import G
from ship_gym.sea.spectra import STEEPEST, WaveSystem, spreading

_RANGE = (0.3, 12.0)  # of omega / omega_p; above lie 0.1 % of the first moment, 1 % of the second
N_DIRECTIONS = 12
_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


class WaveComponents(NamedTuple):
    """N regular waves, all arrays of shape (N,).

    Attributes
    ----------
    amplitude : numpy.ndarray
        a_n [m].
    omega : numpy.ndarray
        omega_n [rad/s], of a fixed observer.
    k : numpy.ndarray
        Wave number omega_n^2 / g [1/m], deep water.
    direction : numpy.ndarray
        Where each goes to, relative to the main direction_to of the sea, clockwise [rad].
    """

    amplitude: np.ndarray
    omega: np.ndarray
    k: np.ndarray
    direction: np.ndarray


def regular_wave(amplitude: float, omega: float) -> WaveComponents:
    """One regular wave along the main direction.

    Parameters
    ----------
    amplitude : float
        a [m], half the wave height.
    omega : float
        Frequency [rad/s]; of a wavelength by `omega_of_length`.

    Raises
    ------
    ConfigError
        Negative amplitude, frequency not positive, or a wave steeper than height / length 0.142.
    """
    check_number("wave.amplitude", amplitude, 0.0, 20.0, "m")
    check_number("wave.omega", omega, 0.05, 50.0, "rad/s")
    k = omega**2 / G
    steepness = amplitude * k / math.pi
    if steepness > STEEPEST:
        raise ConfigError(
            f"wave.amplitude = {amplitude} m at omega {omega:.4g} rad/s: height / length "
            f"{steepness:.3f}, a wave breaks above {STEEPEST}"
        )
    return WaveComponents(
        np.array([float(amplitude)]), np.array([float(omega)]), np.array([k]), np.zeros(1)
    )


def omega_of_length(wavelength: float) -> float:
    """Frequency [rad/s] of a deep-water wave of a length [m]: sqrt(2 pi g / lambda)."""
    return math.sqrt(2.0 * math.pi * G / check_number("wavelength", wavelength, 1e-2, 1e4, "m"))


def wave_components(systems: tuple[WaveSystem, ...], count: int = 60) -> WaveComponents:
    """Regular waves that stand for an irregular sea, sorted by frequency within each system.

    Parameters
    ----------
    systems : tuple of WaveSystem
        Wind sea, swell; a system of height 0 has no waves.
    count : int
        Number of waves of all systems together, shared in proportion to their heights.

    Returns
    -------
    WaveComponents
        `count` waves, or none if all heights are 0. sum a^2 / 2 = sum H_s^2 / 16 exactly.
    """
    numbers = wave_numbers(systems, count)
    parts = [_of_system(s, n) for s, n in zip(systems, numbers, strict=True) if n]
    columns = zip(*parts, strict=True) if parts else [[np.zeros(0)]] * 4
    return WaveComponents(*(np.concatenate(column) for column in columns))


def wave_numbers(systems: tuple[WaveSystem, ...], count: int) -> list[int]:
    """How many of `count` waves each system gets, none of height 0; as `wave_components` has it."""
    waves = [s for s in systems if s.height > 0.0]
    check_count("waves.count", count, max(1, len(waves)))
    shares = iter(_shares(waves, count))
    return [next(shares) if s.height > 0.0 else 0 for s in systems]


def check_count(field: str, count: int, low: int = 1) -> None:
    """Refuse a number of harmonics that is not a whole number from `low` to 500."""
    whole = isinstance(count, int | np.integer) and not isinstance(count, bool)
    if not (whole and low <= count <= 500):
        raise ConfigError(f"{field} = {shown(count)}: allowed is a whole number, {low} to 500")


def _shares(waves: list[WaveSystem], count: int) -> list[int]:
    """Whole numbers of waves in proportion to the heights, at least one each, of sum `count`."""
    heights = np.array([s.height for s in waves])
    ends = np.cumsum(heights) / heights.sum() if waves else heights
    shares = np.diff(np.rint(ends * (count - len(waves))), prepend=0.0) + 1.0
    return [int(n) for n in shares]


@functools.lru_cache(maxsize=256)
def _of_system(system: WaveSystem, count: int) -> WaveComponents:
    """Waves of one system; made once for each system, since a sea is asked for them many times."""
    x = np.geomspace(*_RANGE, 20001) * system.omega_p
    omega, energy = equal_energy(x, system.density(x), count)
    energy *= system.height**2 / 16.0 / energy.sum()  # what lies outside the range comes back
    offsets = direction_offsets(system.spreading, count)
    found = WaveComponents(np.sqrt(2.0 * energy), omega, omega**2 / G, system.direction + offsets)
    for column in found:
        column.flags.writeable = False  # shared by all that ask
    return found


def equal_energy(x: np.ndarray, density: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Cut a spectrum into strips of equal area.

    Parameters
    ----------
    x, density : numpy.ndarray
        Frequencies, increasing, and spectral density there, shape (n,), n much above `count`.
    count : int
        Number of strips.

    Returns
    -------
    centre, area : numpy.ndarray
        Frequency of the centre of area of each strip, and its area, shape (count,).
    """
    width = np.diff(x)
    area = np.append(0.0, np.cumsum(0.5 * (density[1:] + density[:-1]) * width))
    first = np.append(0.0, np.cumsum(0.5 * ((density * x)[1:] + (density * x)[:-1]) * width))
    edges = np.interp(np.linspace(0.0, area[-1], count + 1), area, x)
    centre = np.diff(np.interp(edges, x, first)) / np.diff(np.interp(edges, x, area))
    return centre, np.full(count, area[-1] / count)


def direction_offsets(s: float, count: int) -> np.ndarray:
    """Directions of the waves relative to the mean one [rad], shape (count,).

    Parameters
    ----------
    s : float
        Exponent of `spreading`; 0: all waves go the mean way.
    """
    if s == 0.0:
        return np.zeros(count)
    theta = np.linspace(-0.5 * math.pi, 0.5 * math.pi, 4001)
    D = spreading(theta, s)
    area = np.append(0.0, np.cumsum(0.5 * (D[1:] + D[:-1]) * np.diff(theta)))
    middles = np.interp((np.arange(count) + 0.5) / count * area[-1], area, theta)
    # neighbours share a direction; port mirrors starboard
    groups, half = min(count, N_DIRECTIONS), count // 2
    group = ((np.arange(count) + 0.5) * groups / count).astype(int)
    group[count - half :] = groups - 1 - group[:half][::-1]
    size = np.bincount(group)
    aside = np.sqrt(np.bincount(group, np.sin(middles) ** 2) / size)  # keeps their mean square
    shared = np.sign(np.round(np.bincount(group, middles) / size, 9)) * np.arcsin(aside)
    return shared[group][golden_order(count)]


def golden_order(count: int) -> np.ndarray:
    """Numbers 0 to count - 1 in the order of multiples of the golden ratio, shape (count,)."""
    return np.argsort(np.argsort(np.arange(1, count + 1) * _GOLDEN % 1.0))
