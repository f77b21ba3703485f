"""A measured or hindcast spectrum, one- or two-dimensional, as a sum of regular waves.

The spectrum is linear between its frequencies, nothing lies outside them, and it is cut into strips
of equal energy as any other (``sea.components``): its m_0, the trapezoidal sum over frequency, is
kept to rounding. A strip has the distribution over directions of its own frequencies; its wave goes
to one quantile of it, and the quantiles are dealt in the order of multiples of the golden ratio, as
those of a spreading function are. At most `N_DIRECTIONS` different directions are left, which
neighbours share (Ward's clusters), and all are turned together until the mean direction is that of
the spectrum, if it has one: of seas that go against each other it is chance. What a wave number
is, is said of deep water.

Directions here are those to which waves go, clockwise from north; ``sea.spectrum_files`` converts.
"""

from __future__ import annotations

import dataclasses
import functools
import math

import numpy as np

from ship_gym.config import SMALLEST, ConfigError, check_number, shown
from ship_gym.conventions import G, wrap_angle
from ship_gym.sea.components import (
    N_DIRECTIONS,
    WaveComponents,
    check_count,
    direction_offsets,
    equal_energy,
    golden_order,
)
from ship_gym.sea.spectra import check_spreading, check_steepness

_HIGHEST = 30.0  # significant height [m]
_FINE = (20001, 4001)  # frequencies of the integration, without and with directions
_LEAST = 3  # frequencies
_AIMLESS = 0.2  # length of the mean unit vector below which its direction is chance


@dataclasses.dataclass(frozen=True)
class MeasuredSpectrum:
    """Variance density over frequency, and where it goes.

    Attributes
    ----------
    frequency : tuple of float
        [Hz], rising, F of them.
    density : tuple of float
        S [m2/Hz], F.
    direction : tuple of float
        Where waves go to, clockwise from north [rad], the middles of D bins of equal width; empty:
        not known, all go one way.
    shares : tuple of tuple of float
        Share of each direction in the density of each frequency, (F, D); the sum over directions is
        1, or 0 where there is no energy.
    spreading : float
        Without directions: s of cos^(2s) as in ``sea.spectra.WaveSystem``; 0: long-crested.
    """

    frequency: tuple[float, ...]
    density: tuple[float, ...]
    direction: tuple[float, ...] = ()
    shares: tuple[tuple[float, ...], ...] = ()
    spreading: float = 0.0

    def __post_init__(self) -> None:
        for name in ("frequency", "direction"):
            object.__setattr__(self, name, tuple(map(float, getattr(self, name))))
        object.__setattr__(self, "density", _without_traces(self.density))
        object.__setattr__(self, "shares", tuple(map(_without_traces, self.shares)))
        f = check_frequencies(self.frequency)
        for k, value in enumerate(check_length("density", self.density, len(f))):
            check_number(f"density[{k}]", value, 0.0, 1e6, "m2/Hz", tiny=True)
        if self.spreading != 0.0:
            check_spreading(self.spreading)
        if self.direction and self.spreading:
            raise ConfigError(
                f"spreading = {self.spreading}: the spectrum has its own directions; allowed is 0"
            )
        check_length("shares", self.shares, len(f) if self.direction else 0)
        if not self.m_0 > 0.0:
            raise ConfigError("the spectrum has no energy; allowed is a density above 0 somewhere")
        check_number("significant height of the spectrum", self.height, 1e-6, _HIGHEST, "m")
        check_steepness(self.height, self.peak_period)

    @property
    def m_0(self) -> float:
        """Variance of the surface [m2]: the trapezoidal sum of the density."""
        return float(np.trapezoid(self.density, self.frequency))

    @property
    def height(self) -> float:
        """Significant height 4 sqrt(m_0) [m]."""
        return 4.0 * math.sqrt(self.m_0)

    @property
    def peak_period(self) -> float:
        """Period of the largest density [s]."""
        return 1.0 / self.frequency[int(np.argmax(self.density))]

    @property
    def mean_direction(self) -> float:
        """Where the energy goes to in the mean [rad]; 0 without directions."""
        north, east = self._moment
        return math.atan2(east, north)

    @property
    def spread(self) -> float:
        """Standard deviation of the directions [rad], 0 without directions.

        sqrt(2 (1 - r)), r the length of the mean unit vector of the energy.
        """
        return math.sqrt(2.0 * max(0.0, 1.0 - math.hypot(*self._moment)))

    @property
    def _moment(self) -> tuple[float, float]:
        """Mean unit vector of the energy, north and east."""
        if not self.direction:
            return 1.0, 0.0
        energy = np.array(self.density)[:, None] * np.array(self.shares)
        unit = np.stack([np.cos(self.direction), np.sin(self.direction)], axis=1)
        north, east = np.trapezoid(energy @ unit, self.frequency, axis=0) / self.m_0
        return float(north), float(east)

    def scaled(self, scale: float) -> MeasuredSpectrum:
        """The same waves for a model of a scale, by Froude's law."""
        return dataclasses.replace(
            self,
            frequency=tuple(f * math.sqrt(scale) for f in self.frequency),
            density=tuple(s / scale**2.5 for s in self.density),
        )

    def with_height(self, height: float) -> MeasuredSpectrum:
        """The same shape with a significant height [m]."""
        check_number("wave_height", height, 1e-6, _HIGHEST, "m")
        factor = (height / self.height) ** 2
        return dataclasses.replace(self, density=tuple(factor * s for s in self.density))

    def components(self, count: int = 60) -> WaveComponents:
        """Regular waves of equal energy, directions relative to the mean one; shapes (count,)."""
        return _components(self, count)


def check_frequencies(frequency) -> tuple[float, ...]:
    """Refuse frequencies [Hz] that do not rise or are none of waves."""
    if len(frequency) < _LEAST:
        raise ConfigError(f"{len(frequency)} frequencies: allowed are {_LEAST} or more")
    before = 0.0
    for k, f in enumerate(frequency):
        check_number(f"frequency[{k}]", f, 1e-3, 100.0, "Hz")
        if f <= before:
            raise ConfigError(f"frequency[{k}] = {shown(float(f))} Hz after {shown(float(before))}"
                              ": frequencies must rise")  # fmt: skip
        before = f
    return frequency


def check_length(name: str, values: tuple, wanted: int) -> tuple:
    """Refuse a list of another length than there are frequencies."""
    if len(values) != wanted:
        raise ConfigError(f"{len(values)} of {name} for {wanted} frequencies")
    return values


def bin_width(to: np.ndarray) -> float:
    """Width of the bins whose middles these are [rad]; refuse what has no equal steps."""
    if len(to) < _LEAST:
        raise ConfigError(f"{len(to)} directions: allowed are {_LEAST} or more")
    steps = np.diff(np.append(to, to[0] + 2.0 * math.pi))
    steps = np.delete(steps, int(np.argmax(steps)))  # the gap of a sector, or any of the circle
    width = float(steps.mean())
    if not np.ptp(steps) <= 0.01 * width:
        low, high = np.degrees([steps.min(), steps.max()])
        raise ConfigError(
            f"directions have steps of {low:.4g} to {high:.4g} deg: allowed are equal steps, each "
            "direction once (0 and 360 deg are one)"
        )
    return width


def _without_traces(values) -> tuple[float, ...]:
    """Numbers, those that no quantity has as zero."""
    return tuple(0.0 if abs(value) < SMALLEST else float(value) for value in values)


@functools.lru_cache(maxsize=64)
def _components(spectrum: MeasuredSpectrum, count: int) -> WaveComponents:
    """Made once for each spectrum, since a sea is asked for its waves many times."""
    check_count("waves.count", count)
    f = np.array(spectrum.frequency)
    fine = np.union1d(f, np.linspace(f[0], f[-1], _FINE[bool(spectrum.direction)]))
    centre, energy = equal_energy(fine, np.interp(fine, f, spectrum.density), count)
    energy *= spectrum.m_0 / energy.sum()
    omega = 2.0 * math.pi * centre
    if spectrum.direction:
        offsets = _directions(spectrum, fine, count)
    else:
        offsets = direction_offsets(spectrum.spreading, count)
    found = WaveComponents(np.sqrt(2.0 * energy), omega, omega**2 / G, offsets)
    for column in found:
        column.flags.writeable = False  # shared by all that ask
    return found


def _directions(spectrum: MeasuredSpectrum, fine: np.ndarray, count: int) -> np.ndarray:
    """Direction of each strip's wave, relative to the mean one [rad], shape (count,)."""
    off = wrap_angle(np.array(spectrum.direction) - spectrum.mean_direction)
    order = np.argsort(off)
    energy = (np.array(spectrum.density)[:, None] * np.array(spectrum.shares))[:, order]
    shares = _of_strips(np.array(spectrum.frequency), energy, fine, count)
    half = 0.5 * bin_width(np.sort(np.array(spectrum.direction)))
    u = (golden_order(count) + 0.5) / count
    found = np.array([_quantile(*pair, off[order], half) for pair in zip(shares, u, strict=True)])
    found = _shared(found)
    if math.hypot(*spectrum._moment) < _AIMLESS:
        return found
    return found - math.atan2(np.sin(found).mean(), np.cos(found).mean())


def _of_strips(f: np.ndarray, energy: np.ndarray, fine: np.ndarray, count: int) -> np.ndarray:
    """Energy of each direction in each of `count` strips of equal energy, shape (count, D)."""
    at = np.stack([np.interp(fine, f, column) for column in energy.T], axis=1)
    steps = 0.5 * (at[1:] + at[:-1]) * np.diff(fine)[:, None]
    area = np.concatenate([np.zeros((1, at.shape[1])), np.cumsum(steps, axis=0)])
    total = area.sum(axis=1)
    edges = np.interp(np.linspace(0.0, total[-1], count + 1), total, fine)
    return np.diff([np.interp(edges, fine, column) for column in area.T], axis=1).T


def _quantile(share: np.ndarray, u: float, middle: np.ndarray, half: float) -> float:
    """Direction below which the part u of a strip's energy goes, even within a bin."""
    below = np.append(0.0, np.cumsum(share))
    k = int(np.clip(np.searchsorted(below, u * below[-1], side="right") - 1, 0, len(middle) - 1))
    within = (u * below[-1] - below[k]) / share[k] if share[k] > 0.0 else 0.5
    return float(middle[k] + half * (2.0 * within - 1.0))


def _shared(direction: np.ndarray) -> np.ndarray:
    """The same with at most `N_DIRECTIONS` different ones, each the mean of its neighbours."""
    if len(np.unique(direction)) <= N_DIRECTIONS:
        return direction
    from scipy.cluster.hierarchy import fcluster, linkage

    points = np.stack([np.cos(direction), np.sin(direction)], axis=1)
    group = fcluster(linkage(points, "ward"), N_DIRECTIONS, "maxclust") - 1
    north, east = (np.bincount(group, column) for column in points.T)
    return np.arctan2(east, north)[group]
