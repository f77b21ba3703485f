"""Pictures of a wave table, and the report on it as one HTML page."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import MaxNLocator

from ship_gym.plotting.figure import AMBER, BLUE, DASHED, FAINT, INK, RED, TEAL, for_page, picture
from ship_gym.plotting.hull import hull_picture
from ship_gym.reports.page import Picture, write_page
from ship_gym.reports.wave_table import chosen, provenance, sections
from ship_gym.sea.wave_table import MODES, UNCERTAINTY, WaveTable
from ship_gym.seakeeping.hull_mesh import HullMesh
from ship_gym.ships.particulars import Ship

_MODES = ("heave", "pitch", "roll", "sway", "yaw")
_HEADINGS_DEG = (180.0, 150.0, 120.0, 90.0, 60.0, 30.0, 0.0)
_RATIOS = (0.3, 0.5, 0.8, 1.1, 1.6, 2.5)  # wavelength / L of the roses
_CLASS_COLOURS = (TEAL, "#8fc9bd", "#e8d8a8", AMBER, "#9db4cc", FAINT)


def write_wave_report(
    path: str | os.PathLike, table: WaveTable, ship: Ship, mesh: HullMesh | None, source: Path
) -> None:
    """Write the page, whole or not at all.

    Parameters
    ----------
    path : path-like
        HTML file.
    table : WaveTable
    ship : Ship
        The ship of the table.
    mesh : HullMesh or None
        The panels it was computed with, of the size of `ship`; None if they are not at hand.
    source : Path
        File of the table.
    """
    pictures = report_pictures(table, ship, mesh)
    parts = [*sections(table, ship, mesh, pictures), provenance(table, source)]
    under = "Drift forces and wave-frequency motions by boundary elements, linear in the waves"
    write_page(path, f"Wave table: {table.card['title']}", under, parts)


def report_pictures(
    table: WaveTable, ship: Ship, mesh: HullMesh | None
) -> dict[str, list[Picture]]:
    """Pictures by ``reports.wave_table.PICTURES``."""
    drawings: dict[str, tuple[str, Callable[[Path], None]]] = {
        "motions": (
            "Motions of midship over the wavelength: displacements by the wave amplitude A, "
            "rotations by the wave slope k A. Surge, sway and yaw are faded out where the ship "
            "keeps pace with the waves, because there they belong to the manoeuvring motion. Each "
            "panel has its own scale.",
            lambda p: plot_motions(table, p),
        ),
        "drift": (
            "Drift coefficients over where the waves come from, as seen from the ship: bow up, "
            "starboard to the right. The dark circle is zero, inside it (grey) is negative. CX < 0 "
            "slows the ship, CY > 0 pushes it to starboard, CN > 0 turns it to starboard. CX is "
            "the blend of boundary elements and SNNM that a simulation uses by default. Each panel "
            "has its own scale.",
            lambda p: plot_drift(table, p),
        ),
        "surge": (
            "Added resistance -CX: boundary elements, SNNM, and the blend that a simulation uses "
            "by default. Each panel has its own scale.",
            lambda p: plot_surge(table, p),
        ),
        "classes": (
            "Class of every cell. The yaw moment at speed is within a factor 2 at best.",
            lambda p: plot_classes(table, p),
        ),
    }
    if mesh is not None:
        drawings["mesh"] = "Panels below the waterline.", lambda p: hull_picture(p, mesh, ship)
    return {name: [for_page(*drawing)] for name, drawing in drawings.items()}


def _ratio(table: WaveTable) -> np.ndarray:
    """Wavelength / L of the table's frequencies, decreasing, shape (w,)."""
    return 2.0 * np.pi / table.omega**2


def _speeds(table: WaveTable) -> list[int]:
    """Rest, a middle speed and the last one."""
    last = table.froude[-1]
    return chosen(table.froude, (0.0, 0.55 * last, last))


def _shades(count: int) -> np.ndarray:
    """Colours of an ordered family of lines."""
    return colormaps["viridis"](np.linspace(0.0, 0.9, count))


def plot_motions(table: WaveTable, path: str | os.PathLike) -> None:
    """Size of heave, pitch, roll, sway and yaw over the wavelength, a column for each speed."""
    speeds = _speeds(table)
    with picture(path, 3.7 * len(speeds) + 0.4, 2.2 * len(_MODES) + 0.4) as figure:
        cells = figure.subplots(len(_MODES), len(speeds), squeeze=False, sharex=True)
        for mode, row in zip(_MODES, cells, strict=True):
            for i, axes in zip(speeds, row, strict=True):
                _motion(axes, table, i, mode)
            by = "A" if mode in ("heave", "sway") else "kA"
            row[0].set_ylabel(f"{mode} / {by} [-]")
            for axes in row:
                axes.set_ylim(bottom=0.0)
                axes.locator_params(axis="y", nbins=5)
        for i, axes in zip(speeds, cells[0], strict=True):
            axes.set_title(f"Fn {table.froude[i]:g}")
        for axes in cells[-1]:
            axes.set_xlabel("wavelength / L [-]")
        lines, names = cells[0, 0].get_legend_handles_labels()
        figure.legend(lines, names, loc="outside lower center", ncols=len(names))


def _motion(axes: Axes, table: WaveTable, i: int, mode: str) -> None:
    every = chosen(np.degrees(table.heading), _HEADINGS_DEG)
    for colour, j in zip(_shades(len(every)), every, strict=True):
        size = np.abs(table.motions[i, j, :, MODES.index(mode)])
        name = f"{np.degrees(table.heading[j]):.0f} deg"
        axes.plot(_ratio(table), size, color=colour, linewidth=1.3, label=name)


def all_round(heading: np.ndarray, values: np.ndarray, odd: bool) -> tuple[np.ndarray, np.ndarray]:
    """Where waves come from [rad], clockwise from the bow, and a coefficient there, all round.

    Parameters
    ----------
    heading : numpy.ndarray
        mu from 0 to pi [rad], shape (h,): waves from ahead at pi, from starboard at pi/2.
    values : numpy.ndarray
        Shape (h,).
    odd : bool
        Whether it changes sign between starboard and port.

    Returns
    -------
    bearing, values : numpy.ndarray
        Shapes (2 h,): starboard from ahead to astern, then port back to ahead.
    """
    starboard = np.pi - heading[::-1]
    port = -values if odd else values
    bearing = np.concatenate([starboard, 2.0 * np.pi - starboard[::-1]])
    return bearing, np.concatenate([values[::-1], port])


def plot_drift(table: WaveTable, path: str | os.PathLike) -> None:
    """CX, CY and CN over where the waves come from, a column for each speed."""
    speeds = _speeds(table)
    rows = (("CX", table.surge(), False), ("CY", table.CY, True), ("CN", table.CN, True))
    waves = chosen(_ratio(table), _RATIOS)
    with picture(path, 3.7 * len(speeds) + 0.3, 11.2) as figure:
        for r, (name, values, odd) in enumerate(rows):
            for c, i in enumerate(speeds):
                place = len(speeds) * r + c + 1
                axes = figure.add_subplot(len(rows), len(speeds), place, projection="polar")
                _rose(axes, 1.08 * float(np.abs(values[i][:, waves]).max()))
                axes.set_title(f"{name}, Fn {table.froude[i]:g}", loc="left")
                for colour, w in zip(_shades(len(waves)), waves, strict=True):
                    label = f"{_ratio(table)[w]:.2f} L" if r == c == 0 else None
                    bearing, C = all_round(table.heading, values[i, :, w], odd)
                    axes.plot(bearing, C, color=colour, linewidth=1.3, label=label)
        figure.legend(loc="outside lower center", ncols=len(waves), title="wavelength")


def _rose(axes: PolarAxes, largest: float) -> None:
    """Bow up, clockwise, zero on a dark circle and the negative side inside it grey."""
    axes.set_theta_zero_location("N")
    axes.set_theta_direction(-1)
    axes.set_rlim(-largest, largest)
    axes.set_rorigin(-1.35 * largest)
    around = np.linspace(0.0, 2.0 * np.pi, 181)
    axes.fill_between(around, -largest, 0.0, color="#f1f3f5", zorder=0)
    axes.plot(around, np.zeros(181), color=INK, linewidth=0.9, zorder=1)
    names = ["ahead", "", "stbd", "", "astern", "", "port", ""]
    axes.set_thetagrids(np.arange(0, 360, 45), names, color=FAINT)
    axes.set_rlabel_position(192.0)
    axes.set_rticks(MaxNLocator(5).tick_values(-0.9 * largest, 0.9 * largest)[1:-1])
    axes.tick_params(axis="y", labelsize=7)


def plot_surge(table: WaveTable, path: str | os.PathLike) -> None:
    """Added resistance by boundary elements, by SNNM and blended: speeds down, headings across."""
    speeds = _speeds(table)
    every = chosen(np.degrees(table.heading), (180.0, 150.0, 120.0, 90.0, 45.0, 0.0))
    kinds: Sequence[tuple] = (
        ("blend", {"color": "#c9d3dc", "linewidth": 5.0, "label": "blend (default)"}),
        ("bem", {"color": BLUE, "label": "boundary elements"}),
        ("snnm", {"color": RED, "linestyle": DASHED, "label": "SNNM"}),
    )
    with picture(path, 2.15 * len(every), 2.2 * len(speeds) + 0.4) as figure:
        cells = figure.subplots(len(speeds), len(every), squeeze=False, sharex=True)
        for i, row in zip(speeds, cells, strict=True):
            for j, axes in zip(every, row, strict=True):
                for model, style in kinds:
                    axes.plot(_ratio(table), -table.surge(model)[i, j], **style)
                axes.axhline(0.0, color=FAINT, linewidth=0.8)
                axes.set_title(f"Fn {table.froude[i]:g}, {np.degrees(table.heading[j]):.0f} deg")
                axes.locator_params(nbins=5)
            row[0].set_ylabel("-CX [-]")
        for axes in cells[-1]:
            axes.set_xlabel("wavelength / L [-]")
        lines, names = cells[0, 0].get_legend_handles_labels()
        figure.legend(lines, names, loc="outside lower center", ncols=len(names))


def plot_classes(table: WaveTable, path: str | os.PathLike) -> None:
    """Class of uncertainty over heading and wavelength, a map for each speed."""
    columns = 2 if len(table.froude) == 4 else min(len(table.froude), 3)
    rows = -(-len(table.froude) // columns)
    colours = ListedColormap(_CLASS_COLOURS)
    norm = BoundaryNorm(np.arange(len(UNCERTAINTY) + 1) - 0.5, len(UNCERTAINTY))
    with picture(path, 3.7 * columns, 2.7 * rows + 1.3) as figure:
        cells = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
        for axes in cells.flat[len(table.froude) :]:
            axes.set_axis_off()
        for i, axes in enumerate(cells.flat[: len(table.froude)]):
            cell_map = np.degrees(table.heading), _ratio(table), table.uncertainty[i].T
            axes.pcolormesh(*cell_map, cmap=colours, norm=norm, shading="nearest")
            axes.set(title=f"Fn {table.froude[i]:g}", yscale="log", xticks=range(0, 181, 45))
            axes.set_yticks([0.2, 0.4, 1.0, 3.0], ["0.2", "0.4", "1", "3"])
            axes.minorticks_off()
            axes.grid(False)
            if i + columns >= len(table.froude):  # the lowest of its column
                axes.set_xlabel("heading [deg], 180 = head sea")
                axes.tick_params(labelbottom=True)
        for axes in cells[:, 0]:
            axes.set_ylabel("wavelength / L [-]")
        marks = [axes.plot([], [], "s", color=colour, markersize=9)[0] for colour in _CLASS_COLOURS]
        texts = [f"{key}: {text}" for key, text in UNCERTAINTY.items()]
        figure.legend(marks, texts, loc="outside lower left", ncols=1)
