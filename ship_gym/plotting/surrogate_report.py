"""The report on a fitted surrogate as one HTML page with its pictures."""

from __future__ import annotations

import functools
import math
import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ship_gym.plotting.figure import BLUE, FAINT, INK, RED, TEAL, for_page, picture
from ship_gym.plotting.surrogate import (
    draw_force_map,
    draw_side_force,
    draw_slope,
    draw_surfaces,
    legend,
    panels,
)
from ship_gym.plotting.surrogate_maps import SAND, SYMBOLS, TITLES, draw_map, turned
from ship_gym.reports.page import Picture, write_page
from ship_gym.reports.surrogate_sections import provenance, sections
from ship_gym.ships.particulars import Ship
from ship_gym.surrogates.fit import Fit
from ship_gym.surrogates.sampling import relative_std

_GRID = 41  # points of the maps of the standard deviation along J and along beta


def write_surrogate_report(
    path: str | os.PathLike, fit: Fit, ship: Ship, data: Mapping[str, Any]
) -> None:
    """Write the page, whole or not at all.

    Parameters
    ----------
    path : path-like
        HTML file.
    fit : Fit
    ship : Ship
        With the table of this fit attached.
    data : mapping
        Of ``reports.surrogate.as_dict``.
    """
    pictures = report_pictures(fit, ship, data)
    parts = [*sections(data, pictures), provenance(data)]
    under = f"{data['made_for']['ship']}; samples: {data['source']}"
    write_page(path, data["title"], under, parts)


def report_pictures(fit: Fit, ship: Ship, data: Mapping[str, Any]) -> dict[str, list[Picture]]:
    """Pictures by ``reports.surrogate_sections.PICTURES``."""
    found: dict[str, list[Picture]] = {name: [] for name in ("parity", "surfaces", "std")}
    for side in fit.models:
        of = "" if side == "single" else f", {side} propeller and rudder"
        if fit.training[side].values or fit.validation[side].values:
            text = f"Model against CFD{of}. Bars: one standard deviation of the model."
            found["parity"].append(for_page(text, functools.partial(plot_parity, fit, side)))
        text = f"At the trained angle, as the simulation evaluates it{of}{legend(fit)}."
        found["surfaces"].append(for_page(text, functools.partial(plot_surfaces, fit, ship, side)))
        if relative_std(fit, side, fit.training[side].X):
            text = f"Standard deviation in percent of the range of the training values{of}."
            found["std"].append(for_page(text, functools.partial(plot_std, fit, side)))
    text = (
        "Side force of the rudder in pure drift at nominal speed and propulsion. A kink over the "
        "rudder angle would be a jump in its slope. The bend of the map at zero drift is the law's "
        "flow straightening, which differs with the side of the inflow."
    )
    found["rudder"] = [for_page(text, lambda p: plot_rudder(ship, p))]
    text = "Mean standard deviation of all quantities [% of range] and where to sample next."
    found["next"] = [for_page(text, lambda p: plot_next(fit, data["next_samples"], p))]
    return found


def _rows(count: int, columns: int = 3) -> tuple[int, int]:
    """Rows and columns of a figure with some panels; four stand in a square or in one row."""
    columns = min(count, columns)
    return math.ceil(count / columns), columns


def plot_parity(fit: Fit, side: str, path: str | os.PathLike) -> None:
    """Model against CFD for every quantity, at the training and the held-out points."""
    names = list(fit.training[side].values or fit.validation[side].values)
    rows, columns = _rows(len(names), 4 if len(names) == 4 else 3)
    with picture(path, 3.2 * columns, 3.1 * rows) as figure:
        for k, name in enumerate(names):
            _parity(figure.add_subplot(rows, columns, k + 1), fit, side, name, named=k == 0)


def _parity(axes: Axes, fit: Fit, side: str, name: str, named: bool) -> None:
    """One quantity; `named` panels tell what the marks are."""
    ends = []
    marks = ((fit.training, "o", BLUE, "training"), (fit.validation, "D", RED, "held out"))
    for samples, marker, colour, label in marks:
        part = fit.comparable(samples[side], side)
        if name not in part.values or not len(part.points):
            continue
        mean, std = fit.models[side][name].predict(part.X)
        truth, mean = turned(fit, name, part.values[name]), turned(fit, name, mean)
        style = {"fmt": marker, "color": colour, "markersize": 4.5, "elinewidth": 0.9}
        axes.errorbar(truth, mean, np.nan_to_num(std), label=label, **style)
        ends += [truth, mean]
    low, high = np.concatenate(ends).min(), np.concatenate(ends).max()
    room = 0.06 * (high - low)
    line = np.array([low - room, high + room])
    axes.plot(line, line, color=FAINT, linewidth=0.9, zorder=1)
    axes.set_title(TITLES[name])
    axes.set_xlabel(f"CFD {SYMBOLS[name]} [-]")
    axes.set_ylabel("model [-]")
    axes.locator_params(nbins=5)
    if named:
        axes.legend(loc="upper left")


def plot_surfaces(fit: Fit, ship: Ship, side: str, path: str | os.PathLike) -> None:
    """Response surfaces of one propeller and rudder with the samples, from the kernels."""
    names = panels(fit.models[side])
    rows, columns = _rows(len(names), 2 if len(names) == 4 else 3)
    with picture(path, 4.2 * columns, 3.6 * rows) as figure:
        cells = {n: figure.add_subplot(rows, columns, k + 1) for k, n in enumerate(names)}
        draw_surfaces(figure, cells, ship, side, fit)


def _box(fit: Fit) -> dict[str, float]:
    return dict(zip(("J_min", "J_max", "beta_min", "beta_max"), fit.data.box, strict=True))


def _std_maps(fit: Fit, side: str):
    """J, beta of a map over the box and relative_std [%] on it by quantity, shapes (n, m)."""
    J, beta = (np.linspace(*ends, _GRID) for ends in (fit.data.box[:2], fit.data.box[2:]))
    X = np.stack(np.meshgrid(J, beta), axis=-1).reshape(-1, 2)
    shares = relative_std(fit, side, X)
    shape = (len(beta), len(J))
    return (J, beta), {name: 100.0 * share.reshape(shape) for name, share in shares.items()}


def plot_std(fit: Fit, side: str, path: str | os.PathLike) -> None:
    """Standard deviation of every quantity over the box [% of the range of training values]."""
    grid, maps = _std_maps(fit, side)
    # the ship's yaw moment follows from the side force: that of the samples is not drawn
    maps.pop("C_Mz", None)
    rows, columns = _rows(len(maps), 2 if len(maps) == 4 else 3)
    with picture(path, 4.2 * columns, 3.6 * rows) as figure:
        for k, (name, values) in enumerate(maps.items()):
            axes = figure.add_subplot(rows, columns, k + 1)
            draw_map(figure, axes, grid, values, _box(fit), SAND, bands=7)
            _places(axes, fit, side)
            axes.set_title(f"std of {SYMBOLS[name]} [% of range]")


def _places(axes: Axes, fit: Fit, side: str) -> None:
    """Training points as dots, held-out ones as open diamonds."""
    J, beta = fit.training[side].X.T[:2]
    axes.plot(J, np.degrees(beta), "o", color=INK, markersize=4, label="training")
    J, beta = fit.validation[side].X.T[:2]
    style = {"color": RED, "markersize": 5, "fillstyle": "none"}
    if len(J):
        axes.plot(J, np.degrees(beta), "D", label="held out", **style)


def plot_next(fit: Fit, proposals: Mapping[str, Any], path: str | os.PathLike) -> None:
    """Where to sample next, on the mean standard deviation of all quantities and sides."""
    sides = list(fit.models)
    found = [_std_maps(fit, side) for side in sides]
    maps = [values for _, by_name in found for values in by_name.values()]
    with picture(path, 6.6, 4.6) as figure:
        axes = figure.add_subplot()
        if maps:
            draw_map(figure, axes, found[0][0], np.mean(maps, axis=0), _box(fit), SAND)
        _places(axes, fit, sides[0])
        least = [row for row in proposals["least_sure"] if row["quantity"] == "mean"]
        _marks(axes, least, "X", "least sure (mean of a side)", BLUE)
        _marks(axes, proposals["space_filling"], "P", "Latin hypercube", TEAL)
        axes.set_xlabel("advance ratio J = u/(nD) [-]")
        axes.set_ylabel("drift angle [deg]")
        figure.legend(loc="outside lower center", ncols=4)


def _marks(axes: Axes, rows, marker: str, label: str, colour: str) -> None:
    J, beta = [row["J"] for row in rows], np.degrees([row["beta"] for row in rows])
    style = {"markersize": 9, "markeredgecolor": "white", "clip_on": False, "zorder": 5}
    axes.plot(J, beta, marker, color=colour, label=label, linestyle="none", **style)


def plot_rudder(ship: Ship, path: str | os.PathLike) -> None:
    """Rudder side force over rudder and drift angle, from the kernels."""
    with picture(path, 12.5, 3.9) as figure:
        cells = [figure.add_subplot(1, 3, k + 1) for k in range(3)]
        draw_side_force(cells[0], ship)
        draw_slope(cells[1], ship)
        draw_force_map(figure, cells[2], ship)
