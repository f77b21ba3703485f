"""The one-dimensional example of Knight (2021) section 2.5: K_T(J) from CFD on three grids.

The thesis draws its CFD points and does not tabulate them, so ours are SYNTHETIC: the measured
open-water curve of KCS less an error that grows away from the design point as (1 - J)^2 and with
the cell size, one over the cube root of the cells (order 1, assumed). Its mean on the finest grid
is taken as large as the numerical uncertainty (GCI) that section 2.5 gives for that grid, 3.27 %;
the error itself is only drawn. So what the example shows can be looked for.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.polynomial import Polynomial
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel

from ship_gym.ships.loader import load_ship
from ship_gym.ships.open_water import coefficients
from ship_gym.surrogates.fit import INTERPOLATING
from ship_gym.text import paragraph, table

J_POINTS = np.array([0.1, 0.3, 0.5, 0.7, 0.9])
MILLION_CELLS = {"G1": 0.3, "G2": 1.3, "G3": 7.2}
_MEAN_ERROR = 0.0327  # the GCI of grid G3, section 2.5
_FINE_POINTS = 2  # of the mixed set: G3 at J 0.1 and 0.3, G1 at the others
_SHOWN = np.linspace(0.1, 0.9, 81)
_TWO_SIDED_95 = 1.96


def measured(J: np.ndarray) -> np.ndarray:
    """Measured K_T of KCS in open water."""
    return coefficients(load_ship("kcs_model").open_water, J)[0]


def points(grid: str) -> np.ndarray:
    """SYNTHETIC K_T of a grid at `J_POINTS`; ``mixed`` has the finest grid at low J only."""
    if grid == "mixed":
        low = np.arange(len(J_POINTS)) < _FINE_POINTS
        return np.where(low, points("G3"), points("G1"))
    shape = (1.0 - J_POINTS) ** 2
    size = (MILLION_CELLS["G3"] / MILLION_CELLS[grid]) ** (1.0 / 3.0)
    return measured(J_POINTS) * (1.0 - _MEAN_ERROR * size * shape / shape.mean())


def noise(grid: str) -> float:
    """Standard deviation of the differences to the measured values, Eq. 2.36."""
    return float(np.std(measured(J_POINTS) - points(grid), ddof=1))


def fits(grid: str) -> dict[str, Any]:
    """Regression and process of one set of points.

    Returns
    -------
    dict
        ``sigma_n``; root mean square of the difference to the measured curve over J 0.1 to 0.9 of
        the ``regression`` and of the process with sigma_n 1e-4 (``exact``) and by Eq. 2.36
        (``noisy``); mean width of its 95 % prediction interval, ``width_exact``, ``width_noisy``.
    """
    K_T, truth = points(grid), measured(_SHOWN)
    regression = Polynomial.fit(J_POINTS, K_T, 2)(_SHOWN)
    found = {"grid": grid, "sigma_n": noise(grid), "regression": _rms(regression - truth)}
    for name, sigma in (("exact", INTERPOLATING), ("noisy", noise(grid))):
        mean, std = process(K_T, sigma)
        found[name] = _rms(mean - truth)
        found[f"width_{name}"] = float(2.0 * _TWO_SIDED_95 * np.hypot(std, sigma).mean())
    return found


def process(K_T: np.ndarray, sigma: float) -> tuple[np.ndarray, np.ndarray]:
    """Mean and standard deviation at J 0.1 to 0.9 of a process through five points.

    Of one input: our class ``GaussianProcess`` takes J and beta. Its search starts the same, from
    the standard deviations of input and output.
    """
    kernel = ConstantKernel(np.var(K_T)) * RBF(np.std(J_POINTS))
    made = GaussianProcessRegressor(kernel, alpha=sigma**2).fit(J_POINTS[:, None], K_T - K_T.mean())
    mean, std = made.predict(_SHOWN[:, None], return_std=True)
    return mean + K_T.mean(), std


def _rms(x: np.ndarray) -> float:
    return float(np.sqrt(np.mean(x**2)))


def as_dict() -> dict[str, Any]:
    """All sets of points as plain data, for ``--json``."""
    return {"synthetic": True, "fits": [fits(grid) for grid in (*MILLION_CELLS, "mixed")]}


def as_text(data: dict[str, Any]) -> str:
    """The example for people, from `as_dict`."""
    keys = ("sigma_n", "regression", "exact", "noisy", "width_exact", "width_noisy")
    cells = [[row["grid"], *(f"{row[k]:.4f}" for k in keys)] for row in data["fits"]]
    header = ["points", "sigma_n", "regression", "process, 1e-4", "process, sigma_n"]
    header += ["95 % width, 1e-4", "95 % width, sigma_n"]
    return "\n".join(
        [
            "K_T(J) in open water from five SYNTHETIC CFD points, section 2.5; rms to the measured",
            table(header, cells),
            paragraph(
                "mixed: the finest grid at J 0.1 and 0.3, the coarsest at 0.5, 0.7 and 0.9, 40 % "
                "of the fine runs. As the thesis says: the polynomial and the process agree, the "
                "interval by sigma_n narrows with the grid, and the mixed set comes near the "
                "finest. The size of the errors is ours."
            ),
        ]
    )
