"""Picture of a propeller and rudder surrogate, from the very kernels that the simulation runs."""

from __future__ import annotations

import math
import os

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator

from ship_gym.config import ConfigError, CsvTable
from ship_gym.physics.dynamics import forces
from ship_gym.plotting.figure import AMBER, BLUE, FAINT, INK, RED, TEAL, headline, picture
from ship_gym.ships.particulars import Ship
from ship_gym.ships.records import fleet
from ship_gym.simulation import self_propulsion

QUANTITIES = ("K_T", "10K_Q", "C_Fx", "C_Fy")
_J = np.linspace(0.1, 1.1, 51)
_BETA = np.radians(np.linspace(-10.0, 55.0, 53))
_DRIFTS_DEG = (-10.0, 0.0, 10.0, 20.0, 30.0)
# light enough that contour labels stay readable
_WATER = LinearSegmentedColormap.from_list("water", ["#fbfaf0", "#cfe6d8", "#8cc3c9", "#5d98bd"])
_TITLES = {
    "K_T": "thrust coefficient $K_T$",
    "10K_Q": "torque coefficient 10 $K_Q$",
    "C_Fx": "rudder surge coefficient $C_{Fx}$",
    "C_Fy": "rudder side coefficient $C_{Fy}$ (to port)",
}


def response(ship: Ship, J: float, beta: float) -> tuple[float, float, float, float]:
    """Coefficients K_T, 10K_Q, C_Fx, C_Fy of a ship in pure drift at the trained rudder angle.

    Parameters
    ----------
    ship : Ship
        With a surrogate.
    J : float
        u / (n D) of the ship's surge velocity.
    beta : float
        Drift angle [rad].

    Returns
    -------
    tuple of float
        In the axes of the samples: side force positive to port. Outside the trained box this is
        what the simulation uses there: open water behind the wake and effective inflow.
    """
    made = fleet([ship])
    return _response(made.records[0], (made.water[0], made.deflected[0]), J, beta)


def _response(record, tables, J: float, beta: float) -> tuple[float, float, float, float]:
    D, rho, box = float(record.propeller.D), float(record.rho), record.surrogate
    n = 1.0 / D  # n D = 1, so u = J; coefficients do not depend on the speed
    u, v = J, -J * math.tan(beta)
    _, _, on_rudder, flow = forces((u, v, 0.0), (float(box.delta), n), record, tables)
    T, Q = flow[3], flow[4]
    u_R2 = u * u + 8.0 * T / (rho * math.pi * D * D) + v * v
    q = 0.5 * rho * float(box.S_R) * u_R2
    C_Fx = on_rudder[0] / (1.0 - record.rudder.t_R) / q
    C_Fy = -on_rudder[1] / (1.0 + record.rudder.a_H) / q
    return T / (rho * n**2 * D**4), 10.0 * Q / (rho * n**2 * D**5), C_Fx, C_Fy


def side_force(ship: Ship, delta: np.ndarray, beta: float) -> np.ndarray:
    """Rudder side force F_Ry [N], to starboard, in pure drift at nominal speed and propulsion.

    Parameters
    ----------
    delta : numpy.ndarray
        Rudder angles [rad], shape (n,).
    beta : float
        Drift angle [rad].
    """
    made = fleet([ship])
    tables, record = (made.water[0], made.deflected[0]), made.records[0]
    n = self_propulsion(ship, ship.speed)
    motion = (ship.speed * math.cos(beta), -ship.speed * math.sin(beta), 0.0)
    sway = [forces(motion, (float(d), n), record, tables)[2][1] for d in delta]
    return np.array(sway) / (1.0 + ship.rudder.a_H)


def plot_surrogate(
    ship: Ship,
    path: str | os.PathLike,
    training: CsvTable | None = None,
    validation: CsvTable | None = None,
) -> None:
    """Draw the response surfaces of a surrogate, its held-out errors and the rudder's side force.

    Parameters
    ----------
    ship : Ship
        With a surrogate attached.
    path : path-like
        PNG file; an interrupted write leaves an existing one as it was.
    training, validation : CsvTable, optional
        Rows of CFD samples with J, beta and the four coefficients, drawn in the colour of their
        value.

    Raises
    ------
    ConfigError
        The ship has no surrogate.
    """
    if ship.surrogate is None:
        raise ConfigError(f"{ship.name}: has no surrogate to draw; name one, e.g. G2_SA")
    made = fleet([ship])
    tables = (made.water[0], made.deflected[0])
    values = np.array([[_response(made.records[0], tables, J, b) for J in _J] for b in _BETA])
    with picture(path, 12.5, 7.4) as figure:
        angle = math.degrees(ship.surrogate.card["domain"]["delta"])
        headline(
            figure,
            f"{ship.name}: propeller and rudder surrogate {ship.surrogate_name}",
            f"behind the hull at {angle:.0f} deg rudder, as the simulation evaluates it; black "
            f"frame: trained box{_legend(training, validation)}",
        )
        grid = figure.add_gridspec(2, 3, width_ratios=(1.0, 1.0, 1.05))
        for k, name in enumerate(QUANTITIES):
            axes = figure.add_subplot(grid[k // 2, k % 2])
            _surface(figure, axes, ship, name, values[..., k], (training, validation))
        _side_force(figure.add_subplot(grid[0, 2]), ship)
        _held_out(figure.add_subplot(grid[1, 2]), ship)


def _legend(training: CsvTable | None, validation: CsvTable | None) -> str:
    """What the marks are, for those that are drawn."""
    marks = [(training, "circles: training"), (validation, "diamonds: validation")]
    drawn = [text for rows, text in marks if rows is not None]
    return f"; {', '.join(drawn)} points, in the colour of CFD" if drawn else ""


def _surface(figure: Figure, axes: Axes, ship: Ship, name: str, values, samples) -> None:
    """Contours of one coefficient over J and beta with the samples in their own colour."""
    beta = np.degrees(_BETA)
    box = ship.surrogate.card["domain"]
    low, high = math.degrees(box["beta_min"]), math.degrees(box["beta_max"])
    inside = values[
        np.ix_((beta >= low) & (beta <= high), (_J >= box["J_min"]) & (_J <= box["J_max"]))
    ]
    levels = MaxNLocator(12).tick_values(inside.min(), inside.max())
    filled = axes.contourf(_J, beta, values, levels=levels, cmap=_WATER, extend="both")
    lines = axes.contour(_J, beta, values, levels=levels, colors=INK, linewidths=0.4)
    axes.clabel(lines, levels[::2], fontsize=7, fmt="%.2f")
    corner, width = (box["J_min"], low), box["J_max"] - box["J_min"]
    axes.add_patch(Rectangle(corner, width, high - low, fill=False, edgecolor=INK, linewidth=1.1))
    for rows, marker in zip(samples, ("o", "D"), strict=True):
        if rows is None:
            continue
        axes.scatter(
            rows.columns["J"],
            rows.columns["beta"],
            c=rows.columns[name],
            cmap=filled.cmap,
            norm=filled.norm,
            marker=marker,
            s=38,
            edgecolors=RED if marker == "D" else INK,
            linewidths=1.2,
            zorder=4,
        )
    bar = figure.colorbar(filled, ax=axes, pad=0.02)
    bar.outline.set_visible(False)
    axes.set_title(f"{_TITLES[name]} [-]")
    axes.set_xlabel("advance ratio J = u/(nD) [-]")
    axes.set_ylabel("drift angle at the propeller [deg]")
    axes.grid(False)


def _side_force(axes: Axes, ship: Ship) -> None:
    """Rudder side force over the rudder angle for several drift angles."""
    delta = np.linspace(-ship.gear.delta_max, ship.gear.delta_max, 141)
    colours = (FAINT, INK, BLUE, TEAL, AMBER)
    for beta, colour in zip(_DRIFTS_DEG, colours, strict=True):
        force = side_force(ship, delta, math.radians(beta))
        axes.plot(np.degrees(delta), force, color=colour, label=f"{beta:.0f} deg")
    axes.axhline(0.0, color=FAINT, linewidth=0.8)
    axes.axvline(0.0, color=FAINT, linewidth=0.8)
    axes.set_title("rudder side force $F_{Ry}$ [N], to starboard")
    axes.set_xlabel("rudder angle delta [deg]")
    axes.legend(title="drift angle beta", loc="lower left", ncols=2)


def _held_out(axes: Axes, ship: Ship) -> None:
    """Errors of the regression on the validation points, as bars by quantity."""
    errors = ship.surrogate.card["held_out_errors_percent"]
    points = ship.surrogate.card["held_out_points"]
    colours = (BLUE, TEAL, AMBER, RED)
    width = 0.8 / len(points)
    for i, point in enumerate(points):
        places = np.arange(len(QUANTITIES)) + (i - 0.5 * (len(points) - 1)) * width
        values = [errors[name][i] for name in QUANTITIES]
        axes.bar(places, values, 0.9 * width, color=colours[i % 4], label=f"point {point}")
    axes.axhline(0.0, color=FAINT, linewidth=0.8)
    axes.set_xticks(range(len(QUANTITIES)), ["$K_T$", "10 $K_Q$", "$C_{Fx}$", "$C_{Fy}$"])
    axes.grid(False, axis="x")
    axes.set_title("validation error, (CFD - model)/CFD [%]")
    axes.margins(y=0.2)
    axes.legend(ncols=2, loc="best", columnspacing=1.0, handlelength=1.0)
