"""Measured spectra of the forms that hindcasts and buoys have."""

from __future__ import annotations

import math

import numpy as np

from ship_gym.config import ConfigError, shown
from ship_gym.sea.measured import MeasuredSpectrum, bin_width

LONGEST_R_1 = 1.02  # of a mean unit vector of rounded numbers; none is above 1


def of_directions(frequency, direction, density) -> MeasuredSpectrum:
    """A two-dimensional spectrum.

    Parameters
    ----------
    frequency : array_like
        [Hz], rising, shape (F,).
    direction : array_like
        Where waves go to [rad], in any order, shape (D,): middles of bins of equal width, which
        need not fill the circle.
    density : array_like
        [m2/Hz/rad], shape (F, D).

    Raises
    ------
    ConfigError
        Directions that do not have equal steps, or a density below 0.
    """
    to = np.asarray(direction, dtype=float) % (2.0 * math.pi)
    order = np.argsort(to)
    to, density = to[order], np.asarray(density, dtype=float)[:, order]
    width = bin_width(to)
    if not np.all(density >= 0.0):
        i, j = np.argwhere(~(density >= 0.0))[0]
        raise ConfigError(
            f"density = {shown(density[i, j])} at {shown(float(frequency[i]))} Hz, going to "
            f"{math.degrees(to[j]):.4g} deg: allowed is 0 or more"
        )
    total = density.sum(axis=1)
    shares = density / np.where(total > 0.0, total, 1.0)[:, None]
    return MeasuredSpectrum(tuple(frequency), tuple(total * width), tuple(to), _rows(shares))


def of_moments(frequency, density, direction, r_1) -> MeasuredSpectrum:
    """A spectrum of a buoy that knows the mean direction and its sharpness of each frequency.

    Over directions it is that of Longuet-Higgins et al., cos^(2s)(theta / 2) with s = r_1 /
    (1 - r_1), whose first moment is r_1; a buoy's spread sigma is sqrt(2 (1 - r_1)) (Kuik et al.
    1988, J. Phys. Oceanogr. 18, 1020-1034).

    Parameters
    ----------
    frequency, density, direction, r_1 : array_like
        [Hz], [m2/Hz], where waves go to [rad], and the length of the mean unit vector, 0 to 1;
        shape (F,) each.
    """
    to = np.radians(np.arange(0.0, 360.0, 3.0))
    r = np.clip(np.asarray(r_1, dtype=float), 0.0, 0.995)  # 5.7 deg of spread: two bins
    half = 0.5 * (to - np.asarray(direction, dtype=float)[:, None])
    shares = np.cos(half) ** 2
    shares **= (r / (1.0 - r))[:, None]
    shares /= shares.sum(axis=1)[:, None]
    return MeasuredSpectrum(tuple(frequency), tuple(density), tuple(to), _rows(shares))


def r_1_of(spread: np.ndarray) -> np.ndarray:
    """Length of the mean unit vector by the spread sqrt(2 (1 - r)) of a buoy [rad]."""
    return 1.0 - 0.5 * np.asarray(spread) ** 2


def check_spread(spread: np.ndarray) -> np.ndarray:
    """Refuse spreads [rad] that no directions have, which reach sqrt(2)."""
    for value in spread[~((spread >= 0.0) & (spread <= math.sqrt(2.0)))]:
        deg = math.degrees(value)
        raise ConfigError(f"spread = {deg:.4g} deg: allowed is 0 to 81 deg (1.414 rad)")
    return spread


def _rows(values: np.ndarray) -> tuple[tuple[float, ...], ...]:
    return tuple(map(tuple, values.tolist()))
