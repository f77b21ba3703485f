"""The surface of a sea that is known by its waves."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

WAVE_ENTRIES = ("amplitude", "omega", "k", "direction_to", "phase")


def elevation(waves: Mapping[str, Any], x: Any, y: Any, t: Any) -> np.ndarray:
    """Elevation of the surface above still water [m], positive up.

    zeta = sum a cos(omega t - k (x cos d + y sin d) + eps), the sum of ``sea.components`` in the
    phases of ``physics.waves``.

    Parameters
    ----------
    waves : mapping
        `WAVE_ENTRIES`, each of shape (N,): amplitude a [m], frequency omega of a fixed observer
        [rad/s], wave number k [1/m], direction d to which the wave goes [rad, from north], phase
        eps [rad]; such as the meta ``waves`` of a recording.
    x, y, t : array_like
        North and east [m] and time since the start of the episode [s], of shapes that go together.

    Returns
    -------
    numpy.ndarray
        Of the shape to which x, y and t broadcast; zero without waves.
    """
    a, omega, k, to, phase = (np.asarray(waves[name], dtype=np.float64) for name in WAVE_ENTRIES)
    x, y, t = np.broadcast_arrays(
        *(np.asarray(one, dtype=np.float64)[..., None] for one in (x, y, t))
    )
    along = x * np.cos(to) + y * np.sin(to)
    theta = omega * t - k * along + phase
    return np.cos(theta) @ a


def sum_of(waves: np.ndarray, x: Any, y: Any, t: Any) -> np.ndarray:
    """`elevation` of waves of shape (5, N), as ``sea.records.Waters.waves_of`` has them."""
    entries = wave_entries(waves)
    if entries is None:
        return np.zeros(np.broadcast_shapes(np.shape(x), np.shape(y), np.shape(t)))
    return elevation(entries, x, y, t)


def wave_entries(waves: np.ndarray) -> dict[str, list[float]] | None:
    """The waves of a ship as `elevation` takes them and a recording keeps them.

    Parameters
    ----------
    waves : numpy.ndarray
        Shape (5, N), of ``sea.records.Waters.waves_of``; its phases are in turns.

    Returns
    -------
    dict or None
        `WAVE_ENTRIES`; None: there are no waves.
    """
    if not waves.shape[1]:
        return None
    amplitude, omega, k, turns, to = waves
    entries = (amplitude, omega, k, to, 2.0 * np.pi * turns)
    return {name: row.tolist() for name, row in zip(WAVE_ENTRIES, entries, strict=True)}
