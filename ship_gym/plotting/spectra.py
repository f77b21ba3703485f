"""Picture of a measured spectrum, of the regular waves made of it, and of the sea they make."""

from __future__ import annotations

import os

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ship_gym.plotting.figure import AMBER, BLUE, INK, headline, picture
from ship_gym.sea.measured import MeasuredSpectrum
from ship_gym.sea.state import Sea, measured_sea

_MAP = 600.0  # [m] of the sea surface to every side
_HIGHEST = 0.35  # frequency [Hz] to which pictures go
_POWER = 0.5  # of the density, so that both systems are seen


def plot_spectrum(
    spectrum: MeasuredSpectrum, path: str | os.PathLike, count: int = 60, title: str = ""
) -> None:
    """Draw a spectrum with directions, its waves and their surface at one instant.

    Parameters
    ----------
    spectrum : MeasuredSpectrum
        With directions.
    path : path-like
        PNG file; an interrupted write leaves an existing one as it was.
    count : int
        Number of regular waves.
    title : str
        Of the picture.
    """
    sea = measured_sea(spectrum, wave_count=count)
    with picture(path, 13.0, 4.6) as figure:
        facts = f"H_s {spectrum.height:.2f} m, T_p {spectrum.peak_period:.1f} s"
        come = (np.degrees(spectrum.mean_direction) + 180.0) % 360.0
        headline(figure, title or "Measured spectrum", f"{facts}, from {come:.0f} deg in the mean")
        _polar(figure.add_subplot(1, 3, 1, projection="polar"), spectrum, sea)
        _over_frequency(figure.add_subplot(1, 3, 2), spectrum, sea)
        _surface(figure, figure.add_subplot(1, 3, 3), sea)


def _polar(ax: Axes, spectrum: MeasuredSpectrum, sea: Sea) -> None:
    """Density over frequency and direction, waves as dots; where they come from, as at sea."""
    f = np.array(spectrum.frequency)
    come = np.array(spectrum.direction) + np.pi
    energy = (np.array(spectrum.density)[:, None] * np.array(spectrum.shares)) ** _POWER
    around = np.append(come, come[0] + 2.0 * np.pi)
    energy = np.column_stack([energy, energy[:, 0]])
    ax.set_theta_zero_location("N")
    ax.set_theta_direction(-1)
    ax.contourf(around, f, energy, levels=np.linspace(0.03, 1.0, 12) * energy.max(), cmap="Blues")
    ax.set_axisbelow(False)
    ax.set_rlabel_position(110.0)
    waves = sea.components()
    ax.plot(
        sea.wave_direction_to + waves.direction + np.pi, waves.omega / (2.0 * np.pi), "o",
        color=AMBER, markersize=3.5, markeredgecolor=INK, markeredgewidth=0.4,
    )  # fmt: skip
    ax.set_ylim(0.0, _HIGHEST)
    ax.set_yticks([0.1, 0.2, 0.3], ["0.1", "0.2", "0.3 Hz"])
    ax.set_title("where waves come from; root of the density")


def _over_frequency(ax: Axes, spectrum: MeasuredSpectrum, sea: Sea) -> None:
    ax.plot(spectrum.frequency, spectrum.density, color=BLUE, label="file")
    waves = sea.components()
    f = np.sort(waves.omega) / (2.0 * np.pi)
    level = np.interp(f, spectrum.frequency, spectrum.density)
    ax.vlines(f, 0.0, level, color=AMBER, linewidth=0.9, label=f"{len(f)} waves of one energy")
    ax.set_xlim(0.0, _HIGHEST)
    ax.set_ylim(0.0)
    ax.set_xlabel("frequency [Hz]")
    ax.set_ylabel("density [m2/Hz]")
    ax.legend()


def _surface(figure: Figure, ax: Axes, sea: Sea) -> None:
    axis = np.linspace(-_MAP, _MAP, 241)
    east, north = np.meshgrid(axis, axis)
    zeta = sea.elevation(north, east, 0.0, seed=1)
    most = np.abs(zeta).max()
    shown = ax.pcolormesh(east, north, zeta, cmap="RdBu_r", vmin=-most, vmax=most, rasterized=True)
    ax.set_aspect("equal")
    ax.grid(False)
    ax.set_xlabel("east [m]")
    ax.set_ylabel("north [m]")
    figure.colorbar(shown, ax=ax, label="elevation [m]", shrink=0.8)
