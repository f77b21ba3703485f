"""Errors of CFD samples by grid and turbulence model, and the 95 % width of a process.

After Knight (2021) Figs. 3.7 to 3.12, 5.6, 5.7, 5.10 (errors) and 3.20, 3.21, 5.16 (width).
"""

from __future__ import annotations

import os

import numpy as np
from matplotlib.axes import Axes
from scipy.special import ndtri

from ship_gym.config import ConfigError
from ship_gym.plotting.figure import AMBER, BLUE, INK, SKY, TEAL, VIOLET, headline, picture
from ship_gym.plotting.surrogate_maps import SAND, SYMBOLS, draw_map
from ship_gym.surrogates.base import percent_error
from ship_gym.surrogates.error_budget import (
    FINE_GRID,
    GRID,
    OTHER_TURBULENCE,
    TURBULENCE,
    error_budget,
)
from ship_gym.surrogates.fit import Fit
from ship_gym.surrogates.samples import Samples

COARSE_GRID = "G1"
_Z_95 = float(ndtri(0.975))  # half width of the 95 % interval in standard deviations, 1.96
_SHORT = {
    "grid G1": "G1",
    "grid G2": "G2",
    "turbulence": "SST",
    "regression": "fit",
    "norm": "norm",
}
_COLOURS = {
    "grid G1": SKY,
    "grid G2": BLUE,
    "turbulence": TEAL,
    "regression": AMBER,
    "norm": VIOLET,
}


def sample_errors(fit: Fit, side: str) -> dict[str, dict[str, np.ndarray]]:
    """Sizes of the errors of each quantity at the points at which they are known [%].

    Parameters
    ----------
    fit : Fit
        Of a project data set, on grid G2 with Spalart-Allmaras.
    side : str

    Returns
    -------
    dict
        Quantity to ``grid G1``, ``grid G2`` (each against G3, all points), ``turbulence`` (SST
        against SA on G2) and ``regression`` (held-out points), sizes of 100 (a - b) / a [%],
        shapes (points,). What the file does not have is left out.

    Raises
    ------
    ConfigError
        The samples have no grids.
    """
    data = fit.data
    if not data.choices:
        raise ConfigError(f"{data.name}: samples without grids have no errors to draw")
    base = data.read(GRID, TURBULENCE, side)
    fine = data.read(FINE_GRID, TURBULENCE, side)
    pairs = {
        "grid G1": (fine, data.read(COARSE_GRID, TURBULENCE, side)),
        "grid G2": (fine, base),
        "turbulence": (base, data.read(GRID, OTHER_TURBULENCE, side)),
    }
    found: dict[str, dict[str, np.ndarray]] = {}
    for name in data.quantities:
        parts = {k: _pair(truth, model, name) for k, (truth, model) in pairs.items()}
        parts["regression"] = np.abs(fit.errors(side).get(name, []))
        found[name] = {k: values for k, values in parts.items() if len(values)}
    return found


def _pair(truth: Samples, model: Samples, name: str) -> np.ndarray:
    """Sizes of the error at the points that both have [%]."""
    both = [p for p in truth.points.tolist() if p in set(model.points.tolist())]
    a, b = (s.pick(both).values[name] for s in (truth, model))
    return np.abs(percent_error(a, b))


def plot_errors(fit: Fit, path: str | os.PathLike) -> dict[str, dict[str, dict[str, float]]]:
    """Draw the mean errors as bars with the range over the points; return the means [%].

    Each is over all points at which it is known; the norm is that of the error budget, whose means
    are over the held-out points.

    Returns
    -------
    dict
        Propeller and rudder to quantity to error to mean [%].
    """
    data = fit.data
    found = {side: sample_errors(fit, side) for side in fit.models}
    columns = len(data.quantities)
    means: dict[str, dict[str, dict[str, float]]] = {}
    with picture(path, 3.2 * columns, 0.7 + 3.2 * len(found)) as figure:
        headline(
            figure,
            f"{data.name}: errors of the samples by grid and turbulence, and of the {fit.name} fit",
            f"mean size [%] over the points (their number below), range as a line; G1, G2 against "
            f"{FINE_GRID}, {OTHER_TURBULENCE} against {TURBULENCE} on {GRID}, fit on held-out "
            "points; norm: of G2, SST and fit in the error budget",
        )
        for row, (side, quantities) in enumerate(found.items()):
            means[side] = {}
            for column, (name, parts) in enumerate(quantities.items()):
                axes = figure.add_subplot(len(found), columns, row * columns + column + 1)
                norm = error_budget(data, name, side, fit.errors(side)[name]).total
                means[side][name] = _bars(axes, parts, norm)
                axes.set_title(SYMBOLS[name] + ("" if side == "single" else f", {side}"))
    return means


def _bars(axes: Axes, parts: dict[str, np.ndarray], norm: float) -> dict[str, float]:
    """Bars of one quantity with their number of points; returns the means, with the norm."""
    means = {**{k: float(values.mean()) for k, values in parts.items()}, "norm": norm}
    for place, (name, mean) in enumerate(means.items()):
        axes.bar(place, mean, 0.7, color=_COLOURS[name])
        if name in parts:
            ends = [parts[name].min(), parts[name].max()]
            axes.plot([place, place], ends, color=INK, linewidth=1.0)
    labels = [f"{_SHORT[k]}\n{len(parts[k])}" if k in parts else _SHORT[k] for k in means]
    axes.set_xticks(range(len(means)), labels, fontsize=8)
    axes.grid(False, axis="x")
    return means


def width_95(fit: Fit, side: str, X: np.ndarray) -> dict[str, np.ndarray]:
    """Upper less lower end of the 95 % interval over the local mean [%], Knight (2021) Eq. 3.9.

    Parameters
    ----------
    fit : Fit
        Of models that know their standard deviation.
    X : numpy.ndarray
        J [-] and beta [rad], shape (n, 2).

    Returns
    -------
    dict
        Quantity to width [%], shape (n,).

    Raises
    ------
    ConfigError
        No model of the side knows its standard deviation.
    """
    found = {}
    for name in fit.training[side].values:
        mean, std = fit.models[side][name].predict(X)
        if np.isfinite(std).all():
            found[name] = 200.0 * _Z_95 * std / np.abs(mean)
    if not found:
        raise ConfigError(f"{fit.name}: its models know no standard deviation; fit a process, gp")
    return found


def plot_width(fit: Fit, path: str | os.PathLike, count: int = 41) -> dict[str, dict[str, float]]:
    """Draw `width_95` over the box with the samples; return its mean [%] by side and quantity."""
    box = dict(zip(("J_min", "J_max", "beta_min", "beta_max"), fit.data.box, strict=True))
    J, beta = (np.linspace(*ends, count) for ends in (fit.data.box[:2], fit.data.box[2:]))
    X = np.stack(np.meshgrid(J, beta), axis=-1).reshape(-1, 2)
    found = {side: width_95(fit, side, X) for side in fit.models}
    columns = max(map(len, found.values()))
    with picture(path, 3.6 * columns, 0.7 + 3.3 * len(found)) as figure:
        headline(
            figure,
            f"{fit.data.name}: width of the 95 % interval of {fit.name}",
            "upper less lower end, in percent of the local value; circles: training points",
        )
        for row, (side, maps) in enumerate(found.items()):
            for column, (name, values) in enumerate(maps.items()):
                axes = figure.add_subplot(len(found), columns, row * columns + column + 1)
                shown = values.reshape(count, count)
                draw_map(figure, axes, (J, beta), shown, box, SAND, bands=8)
                places = fit.training[side].X.T
                axes.plot(places[0], np.degrees(places[1]), "o", color=INK, markersize=4)
                axes.set_title(SYMBOLS[name] + ("" if side == "single" else f", {side}") + " [%]")
    return {side: {k: float(v.mean()) for k, v in maps.items()} for side, maps in found.items()}
