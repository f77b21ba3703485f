"""Picture of a fit to captive runs: measured over computed, before and after, and the residuals."""

from __future__ import annotations

import os

import numpy as np

from ship_gym.identification.captive_fit import CaptiveFit
from ship_gym.plotting.figure import AMBER, BLUE, picture

_GREY = "#c5ccd2"


def plot_fit(fit: CaptiveFit, path: str | os.PathLike) -> None:
    """Draw each axis' coefficients, computed over measured, and residuals by file, to a PNG file.

    Parameters
    ----------
    fit : CaptiveFit
    path : path-like
        PNG file; an interrupted write leaves an existing one as it was.
    """
    axes_of = [axis for axis in "XYNT" if any(row.axis == axis for row in fit.rows)]
    with picture(path, 4.2 * len(axes_of), 7.0) as figure:
        title = f"{fit.ship.name}: {len(fit.estimate.names)} numbers fitted to captive tests"
        what = "coefficients x 1000, forces by 1/2 rho L d U^2, moments by that times L"
        figure.suptitle(f"{title}\n{what}", fontsize=10, x=0.01, ha="left")
        panels = figure.subplots(2, len(axes_of), squeeze=False)
        for axis, (top, below) in zip(axes_of, panels.T, strict=True):
            own = np.array([row.axis == axis for row in fit.rows])
            data, before, after = (1e3 * x[own] for x in (fit.measured, fit.before, fit.after))
            top.plot(data, before, "o", ms=3.5, color=AMBER, label="before", alpha=0.7)
            top.plot(data, after, "o", ms=3.5, color=BLUE, label="fitted", alpha=0.7)
            ends = [min(data.min(), after.min()), max(data.max(), after.max())]
            top.plot(ends, ends, color=_GREY, lw=0.8, zorder=0)
            top.set_title(axis)
            top.set_xlabel("measured")
            below.axhline(0.0, color=_GREY, lw=0.8)
            below.plot(data, data - after, "o", ms=3.5, color=BLUE)
            below.set_xlabel("measured")
        panels[0, 0].set_ylabel("computed")
        panels[1, 0].set_ylabel("measured - fitted")
        panels[0, 0].legend()
