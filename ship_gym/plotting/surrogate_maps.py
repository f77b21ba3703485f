"""Maps over advance ratio and drift angle, and the forces of the simulation's kernels on them."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator

from ship_gym.physics.dynamics import forces, unit_forces
from ship_gym.physics.quantities import Tables
from ship_gym.plotting.figure import INK, RED
from ship_gym.ships.particulars import Ship
from ship_gym.ships.records import as_computed, fleet
from ship_gym.simulation import self_propulsion
from ship_gym.surrogates.fit import Fit
from ship_gym.surrogates.samples import WINDWARD

QUANTITIES = ("K_T", "10K_Q", "K_S", "C_Fx", "C_Fy")
TITLES = {
    "K_T": "thrust $K_T$",
    "K_X": "axial force $K_X$",
    "10K_Q": "torque 10 $K_Q$",
    "K_S": "propeller side force $K_S$, to port",
    "C_Fx": "rudder surge $C_{Fx}$",
    "C_Fy": "rudder side force $C_{Fy}$, to port",
    "C_Mz": "rudder yaw moment $C_{Mz}$",
}
SYMBOLS = {
    "K_T": "$K_T$",
    "K_X": "$K_X$",
    "10K_Q": "10 $K_Q$",
    "K_S": "$K_S$",
    "C_Fx": "$C_{Fx}$",
    "C_Fy": "$C_{Fy}$",
    "C_Mz": "$C_{Mz}$",
}
SIDE_FORCES = ("K_S", "C_Fy", "C_Mz")  # change their sign with the side of the turn
MARGIN = (0.1, math.radians(6.0))  # drawn around the trained box
# light enough that contour labels stay readable
WATER = LinearSegmentedColormap.from_list("water", ["#fbfaf0", "#cfe6d8", "#8cc3c9", "#5d98bd"])
SAND = LinearSegmentedColormap.from_list("sand", ["#fdfcf7", "#f3e3c0", "#e3b778", "#cd8a4d"])
SIGNED = LinearSegmentedColormap.from_list("signed", ["#c96a5a", "#f7f4ec", "#6d9cc4"])


def map_axes(box: Mapping[str, float], count: int = 49) -> tuple[np.ndarray, np.ndarray]:
    """J [-] and beta [rad] of a map a little larger than the trained box, shapes (count,)."""
    low = max(box["J_min"] - MARGIN[0], 0.02)
    J = np.linspace(low, box["J_max"] + MARGIN[0], count)
    return J, np.linspace(box["beta_min"] - MARGIN[1], box["beta_max"] + MARGIN[1], count)


def response(ship: Ship, J: float, beta: float, side: str = "single") -> dict[str, float]:
    """Coefficients of a ship in pure drift at the trained rudder angle, turning to starboard.

    Parameters
    ----------
    ship : Ship
        With a surrogate.
    J : float
        u / (n D) of the ship's surge velocity.
    beta : float
        Drift angle [rad].
    side : str
        ``windward`` for the port one of two propellers, else the only or the leeward one.

    Returns
    -------
    dict
        `QUANTITIES` in the frame of the samples: side force positive to port. ``K_T`` is along the
        ship's axis where the samples are. Thrust and torque are the samples', without the shift of
        `records.anchored`. Outside the trained box this is what the simulation uses there: open
        water behind the wake and effective inflow.
    """
    return responses(ship, np.array([J]), np.array([beta]), side)[0, 0]


def responses(ship: Ship, J: np.ndarray, beta: np.ndarray, side: str = "single") -> np.ndarray:
    """`response` at every pair, object array of shape (len(beta), len(J))."""
    assert ship.surrogate is not None
    made = fleet([as_computed(ship)])
    record, tables = made.records[0], Tables(made.open_water[0], made.deflected[0])
    mirror = -1.0 if side == WINDWARD else 1.0
    delta = mirror * ship.surrogate.card["domain"]["delta"]  # of several, the largest
    found = np.empty((len(beta), len(J)), dtype=object)
    for i, angle in enumerate(beta):
        for j, ratio in enumerate(J):
            found[i, j] = _response(record, tables, (float(ratio), float(angle)), delta, mirror)
    return found


def _response(
    record, tables, place: tuple[float, float], delta: float, mirror: float
) -> dict[str, float]:
    """The kernels compute the starboard one; the port one is that of the mirrored ship."""
    (J, beta), box = place, record.surrogate
    D, rho = float(record.propeller.D), float(record.rho)
    n = 1.0 / D  # n D = 1, so u = J; coefficients do not depend on the speed
    u, v = J, -J * math.tan(beta)
    drift = (math.hypot(u, v), mirror * math.atan2(-v, abs(u)))
    controls = (delta, n)
    P, R, (_, _, T, Q, _) = unit_forces((u, mirror * v, 0.0), controls, drift, record, tables)
    u_R2 = u * u + 8.0 * T / (rho * math.pi * D * D) + v * v
    q, unit = 0.5 * rho * float(box.S_R) * u_R2, rho * n**2 * D**4
    return {
        "K_T": T / unit,
        "10K_Q": 10.0 * Q / (unit * D),
        "K_S": -mirror * P[1] / unit,
        "C_Fx": R[0] / (1.0 - record.rudder.t_R) / q,
        "C_Fy": -mirror * R[1] / (1.0 + record.rudder.a_H) / q,
    }


def side_force(ship: Ship, delta: np.ndarray, beta: float) -> np.ndarray:
    """Side force F_Ry [N] of all rudders, to starboard, in pure drift at nominal speed.

    Parameters
    ----------
    delta : numpy.ndarray
        Rudder angles [rad], shape (n,).
    beta : float
        Drift angle [rad].
    """
    made = fleet([ship])
    tables, record = Tables(made.open_water[0], made.deflected[0]), made.records[0]
    n = self_propulsion(ship, ship.speed)
    motion = (ship.speed * math.cos(beta), -ship.speed * math.sin(beta), 0.0)
    sway = [forces(motion, (float(d), n), record, tables)[0].rudder.Y for d in delta]
    return np.array(sway) / (1.0 + ship.rudder.a_H)


def turned(fit: Fit, name: str, values: np.ndarray) -> np.ndarray:
    """Values of a quantity in a turn to starboard, y to port."""
    return fit.data.sign * values if name in SIDE_FORCES else values


def draw_map(
    figure: Figure,
    axes: Axes,
    grid,
    values,
    box: Mapping[str, float],
    cmap=WATER,
    bands: int = 11,
    limit: float | None = None,
):
    """Contours over J and beta with a frame around the trained box.

    Parameters
    ----------
    grid : (numpy.ndarray, numpy.ndarray)
        J [-] and beta [rad], shapes (m,) and (n,).
    values : numpy.ndarray
        Shape (n, m). The levels are those of the trained box, unless there is a `limit`.
    bands : int
        About how many levels.
    limit : float, optional
        Levels from minus to plus this instead, for differences.

    Returns
    -------
    matplotlib.contour.QuadContourSet
        For the colours of what is drawn on top.
    """
    J, beta = grid
    inside = values[
        np.ix_(
            (beta >= box["beta_min"]) & (beta <= box["beta_max"]),
            (box["J_min"] <= J) & (box["J_max"] >= J),
        )
    ]
    ends = (inside.min(), inside.max()) if limit is None else (-limit, limit)
    levels = MaxNLocator(bands).tick_values(*ends)
    degrees = np.degrees(beta)
    filled = axes.contourf(J, degrees, values, levels=levels, cmap=cmap, extend="both")
    drawn = axes.contour(J, degrees, values, levels=levels, colors=INK, linewidths=0.4)
    axes.clabel(drawn, levels[::2], fontsize=7)
    low, high = math.degrees(box["beta_min"]), math.degrees(box["beta_max"])
    corner, width = (box["J_min"], low), box["J_max"] - box["J_min"]
    axes.add_patch(Rectangle(corner, width, high - low, fill=False, edgecolor=INK, linewidth=1.1))
    bar = figure.colorbar(filled, ax=axes, pad=0.02)
    bar.outline.set_visible(False)
    axes.set_xlabel("advance ratio J = u/(nD) [-]")
    axes.set_ylabel("drift angle [deg]")
    axes.grid(False)
    return filled


def draw_samples(axes: Axes, fit: Fit, side: str, name: str, filled) -> None:
    """Samples in the colour of their value: training circles, held-out diamonds.

    Those of a scattered set are at other rudder angles than the map, so they have no colour.
    """
    for samples, marker, edge in ((fit.training, "o", INK), (fit.validation, "D", RED)):
        rows = samples[side]
        style = {"marker": marker, "s": 38, "edgecolors": edge, "linewidths": 1.2, "zorder": 4}
        J, beta = rows.X.T[:2]
        if name in rows.values and rows.X.shape[1] == 2:
            colour = turned(fit, name, rows.values[name])
            axes.scatter(J, np.degrees(beta), c=colour, cmap=filled.cmap, norm=filled.norm, **style)
        elif len(J):  # known by its place only
            axes.scatter(J, np.degrees(beta), facecolors="none", **style)
