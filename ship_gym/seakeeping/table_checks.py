"""What is known of a wave table: how sure each cell is, and how it compares with SNNM."""

from __future__ import annotations

import numpy as np

from ship_gym.sea.wave_table import SNNM_SHORT, WaveTable
from ship_gym.seakeeping import calibration


def critical(froude: np.ndarray, heading: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """Cells above tau = 1/4 in seas from ahead to abeam, where tau grows with speed, (f, h, w)."""
    U, mu, w = np.meshgrid(froude, heading, omega, indexing="ij")
    tau = U * (w - w**2 * U * np.cos(mu))
    inside = (tau > calibration.CRITICAL_START) & (tau < calibration.CRITICAL_END)
    return inside & (np.cos(mu) < 1e-9)


def uncertainty(froude: np.ndarray, heading: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """Class of every cell, see `UNCERTAINTY`, uint8, shape (f, h, w)."""
    U, mu, w = np.meshgrid(froude, heading, omega, indexing="ij")
    omega_e = w - w**2 * U * np.cos(mu)
    found = np.select([mu > np.radians(149.9), mu > np.radians(89.9)], [1, 2], 3)
    found = np.where(2.0 * np.pi / w**2 < SNNM_SHORT, 4, found)
    narrow = np.abs(np.abs(omega_e) * U - 0.25) < calibration.TAU_BAND
    narrow |= critical(froude, heading, omega)
    found = np.where(narrow | (np.abs(omega_e) < calibration.FADE_FREQUENCY), 5, found)
    return np.where(U == 0.0, 0, found).astype(np.uint8)


def compare_with_snnm(table: WaveTable) -> dict[str, dict[str, list[float]]]:
    """Surge of the boundary elements beside SNNM, in waves of 0.4 to 2 L.

    Returns
    -------
    dict
        ``rms``: rms difference over lambda / L by SNNM's peak; ``peak``, ``peak_snnm``: largest
        -CX; ``at``, ``at_snnm``: lambda / L of it. Each {Froude number: one value per heading}.
    """
    from scipy.interpolate import CubicSpline

    ratio = np.linspace(SNNM_SHORT, 2.0, 200)
    omega = np.sqrt(2.0 * np.pi / ratio)
    names = ("rms", "peak", "peak_snnm", "at", "at_snnm")
    found: dict[str, dict[str, list[float]]] = {name: {} for name in names}
    for i, speed in enumerate(table.froude):
        bem, snnm = (
            -CubicSpline(table.omega, values[i], axis=1)(omega)
            for values in (table.CX_bem, table.CX_snnm)
        )
        rms = np.sqrt(np.mean((bem - snnm) ** 2, axis=1)) / np.abs(snnm).max(axis=1)
        at = [ratio[c.argmax(axis=1)] for c in (bem, snnm)]
        columns = (rms, bem.max(axis=1), snnm.max(axis=1), *at)
        for name, column in zip(names, columns, strict=True):
            found[name][f"{speed:.2f}"] = [round(float(x), 3) for x in column]
    return found
