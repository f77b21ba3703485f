"""Thrust and torque of a propeller at every advance angle: ahead, braking, astern, locked.

Harmonics of Wageningen B-series screws by Roddy, Hess & Faller (2006), NSWCCD-50-TR-2006/004, in
``four_quadrants.csv``. Not read in the report but in a public simulator; in the first quadrant they
agree with the polynomials of ``b_series`` within 0.045 in K_T and 0.007 in K_Q (tests/ships).
"""

from __future__ import annotations

import dataclasses
import functools
from pathlib import Path

import numpy as np

from ship_gym.csv_file import read_csv
from ship_gym.ships.b_series import b_series

_FILE = Path(__file__).with_name("four_quadrants.csv")
# 100 C_T* and -1000 C_Q* are tabulated
_UNITS = np.array([0.01, -0.001])
_COLUMNS = ("blades", "area_ratio", "pitch_ratio", "k", "A_T", "B_T", "A_Q", "B_Q")
_AREA, _SMALL_AREA = 0.70, 0.40  # of the four-bladed screws; the second at pitch ratio 1.0 only


@dataclasses.dataclass(frozen=True)
class Screw:
    """Propeller of the Wageningen B-series."""

    pitch_ratio: float
    area_ratio: float
    blades: int


@functools.cache
def _screws() -> dict[tuple[int, float, float], np.ndarray]:
    """(blades, area ratio, pitch ratio) to harmonics (31, 2, 2): order, C_T or C_Q, cos or sin."""
    table = read_csv(_FILE)
    rows = np.stack([table.columns[name] for name in _COLUMNS], axis=1)
    found: dict[tuple[int, float, float], np.ndarray] = {}
    for key in np.unique(rows[:, :3], axis=0):
        mine = rows[(rows[:, :3] == key).all(axis=1), 4:]
        found[int(key[0]), float(key[1]), float(key[2])] = mine.reshape(-1, 2, 2)
    return found


def harmonics(screw: Screw) -> np.ndarray:
    """Harmonics of the screws of the series that are nearest to a propeller.

    B4-70, linear in the pitch ratio from 0.6 to 1.4, plus what another screw differs from it at
    pitch ratio 1.0: B5-75 for five and more blades; B4-40, in proportion to the area, for fewer
    blades of less area, since a stopped propeller's drag goes with its blades. That difference of
    thrust and of torque grows with the pitch as the root mean square of B4-70 does. Estimated.

    Returns
    -------
    numpy.ndarray
        Shape (31, 2, 2): order k, 100 C_T* and -1000 C_Q*, cosine and sine.
    """
    known = _screws()
    pitches = sorted(pitch for blades, area, pitch in known if (blades, area) == (4, _AREA))
    pitch = min(max(screw.pitch_ratio, pitches[0]), pitches[-1])
    k = min(int(np.searchsorted(pitches, pitch, side="right")), len(pitches) - 1)
    low, high = pitches[k - 1], pitches[k]
    share = (pitch - low) / (high - low)
    found = (1.0 - share) * known[4, _AREA, low] + share * known[4, _AREA, high]
    plain = known[4, _AREA, 1.0]
    size = np.sqrt((found**2).sum(axis=(0, 2)) / (plain**2).sum(axis=(0, 2)))[:, None]
    if screw.blades >= 5:
        return found + size * (known[5, 0.75, 1.0] - plain)
    area = min(max(screw.area_ratio, _SMALL_AREA), _AREA)
    smaller = (_AREA - area) / (_AREA - _SMALL_AREA)
    return found + smaller * size * (known[4, _SMALL_AREA, 1.0] - plain)


def starred_of(screw: Screw, epsilon) -> np.ndarray:
    """C_T* and C_Q* of a series screw at any advance angle.

    Parameters
    ----------
    screw : Screw
    epsilon : array_like
        atan2(u_A, 0.7 pi n D) [rad], -pi to pi.

    Returns
    -------
    numpy.ndarray
        Shape (*shape of epsilon, 2). Positive torque resists a propeller that turns ahead.
    """
    table = harmonics(screw)
    angles = np.multiply.outer(np.asarray(epsilon, dtype=float), np.arange(len(table)))
    waves = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    return _UNITS * np.einsum("...kw,kcw->...c", waves, table)


def nearest_screw(J: np.ndarray, K_T: np.ndarray) -> Screw:
    """Tabulated screw whose thrust is nearest to a curve, by the root mean square.

    Parameters
    ----------
    J, K_T : numpy.ndarray
        Shape (n,).
    """
    screws = [Screw(pitch, area, blades) for blades, area, pitch in sorted(_screws())]
    return min(
        screws,
        key=lambda s: float(np.mean((b_series(J, **dataclasses.asdict(s))[0] - K_T) ** 2)),
    )
