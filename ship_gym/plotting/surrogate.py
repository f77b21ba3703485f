"""Picture of a propeller and rudder surrogate, from the very kernels that the simulation runs."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ship_gym.config import ConfigError
from ship_gym.plotting.figure import AMBER, BLUE, FAINT, INK, RED, TEAL, headline, picture
from ship_gym.plotting.surrogate_maps import (
    SYMBOLS,
    TITLES,
    WATER,
    draw_map,
    draw_samples,
    map_axes,
    responses,
    side_force,
)
from ship_gym.ships.particulars import Ship
from ship_gym.surrogates.fit import Fit

DRIFTS_DEG = (-10.0, 0.0, 10.0, 20.0, 30.0)
_COLOURS = (FAINT, INK, BLUE, TEAL, AMBER, RED)


def plot_surrogate(ship: Ship, path: str | os.PathLike, fit: Fit | None = None) -> None:
    """Draw the response surfaces of a surrogate, its held-out errors and the rudder's side force.

    Parameters
    ----------
    ship : Ship
        With a surrogate attached.
    path : path-like
        PNG file; an interrupted write leaves an existing one as it was.
    fit : Fit, optional
        What the surrogate was made of: its samples are drawn in the colour of their value.

    Raises
    ------
    ConfigError
        The ship has no surrogate.
    """
    if ship.surrogate is None:
        raise ConfigError(f"{ship.name}: has no surrogate to draw; name one, e.g. G2_SA")
    card = ship.surrogate.card
    sides = list(card["effective_inflow"]["gamma_R"])
    with picture(path, 12.5, 0.9 + 6.5 * len(sides)) as figure:
        angle = math.degrees(card["domain"]["delta"])
        headline(
            figure,
            f"{ship.name}: propeller and rudder surrogate {ship.surrogate_name}",
            f"behind the hull at {angle:.0f} deg rudder, turning to starboard, as the simulation "
            f"evaluates it; black frame: trained box{legend(fit)}",
        )
        grid = figure.add_gridspec(2 * len(sides), 3, width_ratios=(1.0, 1.0, 1.05))
        for row, side in enumerate(sides):
            names = panels(card["models"][side])[:4]
            cells = [figure.add_subplot(grid[2 * row + k // 2, k % 2]) for k in range(len(names))]
            draw_surfaces(figure, dict(zip(names, cells, strict=True)), ship, side, fit)
            third = [figure.add_subplot(grid[2 * row + k, 2]) for k in range(2)]
            if row == 0:
                draw_side_force(third[0], ship)
            else:
                draw_force_map(figure, third[0], ship)
            _held_out(third[1], ship, side)


def panels(models) -> list[str]:
    """Quantities to draw: those of the propeller and rudder whose forces the ship feels."""
    names = [name for name in ("K_T", "K_X", "10K_Q", "K_S", "C_Fx", "C_Fy") if name in models]
    # five surfaces have no place for the smallest, where the torque is known too
    return sorted(names, key=lambda name: name == "K_S" and len(names) > 4)


def legend(fit: Fit | None) -> str:
    """What the marks are, for those that are drawn."""
    if fit is None:
        return ""
    held = any(len(samples.points) for samples in fit.validation.values())
    marks = "circles: training" + (", diamonds: held-out" if held else "")
    scattered = any(samples.X.shape[1] > 2 for samples in fit.training.values())
    colour = "of all rudder angles" if scattered else "in the colour of CFD"
    return f"; {marks} points, {colour}"


def draw_surfaces(
    figure: Figure, cells: Mapping[str, Axes], ship: Ship, side: str, fit: Fit | None
) -> None:
    """Surfaces of some quantities of one side with the samples on them."""
    assert ship.surrogate is not None
    box = ship.surrogate.card["domain"]
    grid = map_axes(box)
    found = responses(ship, *grid, side)
    for name, axes in cells.items():
        key = "K_T" if name == "K_X" else name
        values = np.array([[cell[key] for cell in row] for row in found])
        filled = draw_map(figure, axes, grid, values, box, WATER)
        if fit is not None:
            draw_samples(axes, fit, side, name, filled)
        axes.set_title(TITLES[name] + ("" if side == "single" else f", {side}"))


def draw_side_force(axes: Axes, ship: Ship) -> None:
    """Rudder side force over the rudder angle for several drift angles."""
    delta = np.linspace(-ship.gear.delta_max, ship.gear.delta_max, 141)
    for beta, colour in zip(DRIFTS_DEG, _COLOURS, strict=False):
        force = side_force(ship, delta, math.radians(beta))
        axes.plot(np.degrees(delta), force, color=colour, label=f"{beta:.0f} deg")
    axes.axhline(0.0, color=FAINT, linewidth=0.8)
    axes.axvline(0.0, color=FAINT, linewidth=0.8)
    axes.set_title("rudder side force $F_{Ry}$ [N], to starboard")
    axes.set_xlabel("rudder angle delta [deg]")
    axes.legend(title="drift angle beta", loc="lower left", ncols=2)


def draw_slope(axes: Axes, ship: Ship) -> None:
    """Slope of `draw_side_force`, in which a kink would be a jump."""
    delta = np.linspace(-ship.gear.delta_max, ship.gear.delta_max, 281)
    for beta, colour in zip(DRIFTS_DEG, _COLOURS, strict=False):
        force = side_force(ship, delta, math.radians(beta))
        axes.plot(np.degrees(delta), np.gradient(force, np.degrees(delta)), color=colour)
    axes.axhline(0.0, color=FAINT, linewidth=0.8)
    axes.set_title("its slope over the rudder angle [N/deg]")
    axes.set_xlabel("rudder angle delta [deg]")


def draw_force_map(figure: Figure, axes: Axes, ship: Ship) -> None:
    """Rudder side force over rudder angle and drift angle."""
    delta = np.linspace(-ship.gear.delta_max, ship.gear.delta_max, 71)
    beta = np.radians(np.linspace(-40.0, 40.0, 41))
    values = np.array([side_force(ship, delta, b) for b in beta])
    filled = axes.contourf(np.degrees(delta), np.degrees(beta), values, levels=14, cmap=WATER)
    lines = axes.contour(filled, colors=INK, linewidths=0.4)
    axes.clabel(lines, lines.levels[::2], fontsize=7)
    figure.colorbar(filled, ax=axes, pad=0.02).outline.set_visible(False)
    axes.set_title("rudder side force $F_{Ry}$ [N], to starboard")
    axes.set_xlabel("rudder angle delta [deg]")
    axes.set_ylabel("drift angle beta [deg]")
    axes.grid(False)


def _held_out(axes: Axes, ship: Ship, side: str) -> None:
    """Errors on the held-out points, as bars by quantity."""
    assert ship.surrogate is not None
    errors = ship.surrogate.card["held_out_errors_percent"][side]
    points = ship.surrogate.card["held_out_points"]
    axes.set_title(
        "held-out error, (CFD - model)/CFD [%]" + ("" if side == "single" else f", {side}")
    )
    if not errors:
        axes.text(0.5, 0.5, "no points held out", ha="center", color=FAINT)
        axes.set_axis_off()
        return
    colours = (BLUE, TEAL, AMBER, RED)
    width = 0.8 / len(points)
    for i, point in enumerate(points):
        places = np.arange(len(errors)) + (i - 0.5 * (len(points) - 1)) * width
        values = [by_point[i] for by_point in errors.values()]
        axes.bar(places, values, 0.9 * width, color=colours[i % 4], label=f"point {point}")
    axes.axhline(0.0, color=FAINT, linewidth=0.8)
    axes.set_xticks(range(len(errors)), [SYMBOLS[name] for name in errors])
    axes.grid(False, axis="x")
    axes.margins(y=0.25)
    axes.legend(ncols=min(len(points), 4), loc="upper left", columnspacing=1.0, handlelength=1.0)
