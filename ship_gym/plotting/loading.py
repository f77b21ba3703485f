"""Propeller loading of a manoeuvre: K_T over J, and q' and n' over t' (Adachi & Sugai 1978).

t' = K_T / J^2, q' = K_Q / J^3 and n' = t' / (2 pi q') with the ship's surge velocity, as Stern et
al. (2021) print them; n' is K_T J / (2 pi K_Q), the efficiency T u / (2 pi n Q). They find that
q'(t') and n'(t') of models and manoeuvres fall together better than K_T(J) does.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.colors import LinearSegmentedColormap

from ship_gym.config import ConfigError, check_known, check_number
from ship_gym.conventions import FLOW_THRUST, FLOW_TORQUE
from ship_gym.physics.propeller import J_LIMIT
from ship_gym.plotting.figure import AMBER, BLUE, INK, RED, headline, picture
from ship_gym.recording.trajectory import Trajectory
from ship_gym.reports.manoeuvre import CONDITION
from ship_gym.ships.particulars import Ship
from ship_gym.simulation import straight_forces, through_water

J_SMALLEST = 0.05  # below it t' and q' are those of a ship at rest, and have no scale
_SETTLED = 0.02  # of the range of t', within which a steady turn is one point
_COLOURS = {  # what colours the points: column -> (label, factor, map)
    "delta": (
        "rudder angle [deg], starboard positive",
        180.0 / math.pi,
        LinearSegmentedColormap.from_list("sides", [RED, "#d9d4c8", BLUE]),
    ),
    "t": ("time [s]", 1.0, LinearSegmentedColormap.from_list("time", [BLUE, "#79a69b", AMBER])),
}
_LABELS = {
    "J": "advance ratio $J = u/(nD)$ [-]",
    "K_T": "thrust coefficient $K_T$ [-]",
    "t_prime": "thrust loading $t' = K_T/J^2$ [-]",
    "q_prime": "torque loading $q' = K_Q/J^3$ [-]",
    "n_prime": r"efficiency $n' = t'/(2\pi q')$ [-]",
}
_PANELS = (("J", "K_T"), ("t_prime", "q_prime"), ("t_prime", "n_prime"))


def propeller_loading(
    columns: Mapping[str, np.ndarray] | Trajectory, D: float, rho: float, count: int = 1
) -> dict[str, np.ndarray]:
    """t', q' and n' of every sample in which ship and propeller go ahead.

    Parameters
    ----------
    columns : mapping or Trajectory
        ``u``, ``v`` [m/s], ``psi`` [rad], ``current_speed`` [m/s], ``current_direction_to`` [rad],
        ``n`` [rev/s], ``thrust`` [N] and ``torque`` [N m] of all propellers together; shapes (T,).
    D : float
        Propeller diameter [m].
    rho : float
        Density of water [kg/m3].
    count : int
        Number of propellers; the result is their mean.

    Returns
    -------
    dict
        ``kept``, shape (T,), true where 0.05 < J < 10 (the others are left out); ``J``, ``K_T``,
        ``K_Q``, ``t_prime``, ``q_prime``, ``n_prime`` of the samples kept, dimensionless.
    """
    check_number("D", D, 1e-6, 100.0, "m")
    check_number("rho", rho, 1e-6, 1e5, "kg/m3")
    check_number("count of propellers", count, 1, 10)
    u, _ = through_water(columns)
    n = np.asarray(columns["n"])
    kept = (n > 0.0) & (u > J_SMALLEST * n * D) & (u < J_LIMIT * n * D)
    u, n = u[kept], n[kept]
    J = u / (n * D)
    K_T = columns["thrust"][kept] / (count * rho * n**2 * D**4)
    K_Q = columns["torque"][kept] / (count * rho * n**2 * D**5)
    return {
        "kept": kept,
        "J": J,
        "K_T": K_T,
        "K_Q": K_Q,
        "t_prime": K_T / J**2,
        "q_prime": K_Q / J**3,
        "n_prime": K_T * J / (2.0 * math.pi * K_Q),
    }


def straight_ahead(
    ship: Ship, J_range: tuple[float, float], points: int = 121
) -> dict[str, np.ndarray]:
    """Loading of the ship's propeller on a straight course, rudder amidships, as the model has it.

    That is the open-water curve in the effective wake w_P0.

    Parameters
    ----------
    ship : Ship
    J_range : (float, float)
        Advance ratios u/(nD) to cover.
    points : int
        Number of samples.

    Returns
    -------
    dict
        As `propeller_loading`.
    """
    J = np.linspace(*J_range, points)
    n = ship.speed / (J * ship.propeller.D)
    flow = np.array([straight_forces(ship, ship.speed, float(k))[-1] for k in n])
    zeros = np.zeros(points)
    columns = {"u": np.full(points, ship.speed), "v": zeros, "psi": zeros, "n": n}
    columns |= {"current_speed": zeros, "current_direction_to": zeros}
    columns |= {"thrust": flow[:, FLOW_THRUST], "torque": flow[:, FLOW_TORQUE]}
    return propeller_loading(columns, ship.propeller.D, ship.rho, ship.propellers)


def plot_loading(
    trajectory: Trajectory,
    ship: Ship,
    path: str | os.PathLike,
    *,
    title: str,
    colour: str = "delta",
) -> None:
    """Draw the propeller loading of a recorded manoeuvre beside the curve on a straight course.

    Parameters
    ----------
    trajectory : Trajectory
        A recording of `ship`; samples outside 0.05 < J < 10 are left out.
    ship : Ship
    path : path-like
        PNG file; an interrupted write leaves an existing one as it was.
    title : str
        What was sailed, as of ``reports.manoeuvre.title``; what follows "; " is set smaller.
    colour : str
        What colours the points: "delta" (rudder angle) or "t" (time).

    Raises
    ------
    ConfigError
        Unknown colour, or a ship that never makes way ahead.
    """
    check_known("colour", colour, _COLOURS)
    found = propeller_loading(trajectory, ship.propeller.D, ship.rho, ship.propellers)
    J = found["J"]
    if not len(J):
        raise ConfigError(f"{title}: never {J_SMALLEST} < J < {J_LIMIT:g}: no loading to draw")
    curve = straight_ahead(ship, (0.97 * J.min(), 1.03 * J.max()))
    label, factor, colours = _COLOURS[colour]
    shade = factor * trajectory[colour][found["kept"]]
    what, *condition = title.split(CONDITION, 1)
    limits = _limits(colour, shade, found["t_prime"])
    with picture(path, 12.5, 4.9) as figure:
        details = (*condition, f"surrogate {ship.surrogate_name}", "u through the water")
        headline(figure, what, "; ".join(details))
        panels = figure.subplots(1, 3)
        for axes, (x, y) in zip(panels, _PANELS, strict=True):
            axes.plot(curve[x], curve[y], color=INK, linewidth=1.1)
            dots = _dots(axes, found[x], found[y], shade, colours, limits)
            axes.set_xlabel(_LABELS[x])
            axes.set_title(_LABELS[y])
        panels[0].legend(panels[0].lines, ["straight course, in the wake"], loc="upper right")
        more = "max" if shade.max() > limits[1] else "neither"
        bar = figure.colorbar(dots, ax=panels, pad=0.015, aspect=32, label=label, extend=more)
        bar.outline.set_visible(False)


def _limits(colour: str, shade: np.ndarray, t_prime: np.ndarray) -> tuple[float, float]:
    """Ends of the colour scale: rudder both sides, time until the loading has settled."""
    if colour == "delta":
        limit = max(float(np.abs(shade).max()), 1.0)
        return -limit, limit
    moving = np.flatnonzero(np.abs(t_prime - t_prime[-1]) > _SETTLED * np.ptp(t_prime))
    last = moving[-1] if len(moving) else len(shade) - 1
    return float(shade[0]), float(shade[last])


def _dots(axes: Axes, x, y, shade, colours, limits: tuple[float, float]) -> PathCollection:
    """Samples as small dots in the colour of `shade`."""
    style = {"s": 9, "linewidths": 0.0, "zorder": 3}
    return axes.scatter(x, y, c=shade, cmap=colours, vmin=limits[0], vmax=limits[1], **style)
