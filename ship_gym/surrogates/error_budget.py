"""How far a surrogate can be trusted: error of grid, turbulence model and fit, and their norm."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence

import numpy as np
from scipy.special import chdtri

from ship_gym.config import ConfigError
from ship_gym.csv_file import read_csv
from ship_gym.surrogates.base import mean_size, percent_error
from ship_gym.surrogates.samples import DataSet

GRID, FINE_GRID = "G2", "G3"
TURBULENCE, OTHER_TURBULENCE = _MODELS = "SA", "SST"


@dataclasses.dataclass(frozen=True)
class ErrorBudget:
    """Mean sizes of the errors of one quantity, and their norm [%].

    Attributes
    ----------
    quantity, side : str
        Column of the samples, and which propeller and rudder (``samples.SINGLE`` and so on).
    grid : float
        |G3 - G2| / |G3| [%], mean over the validation points.
    turbulence : float
        |SST - SA| / |SA| on grid G2 [%], mean over `turbulence_points`.
    surrogate : float
        |CFD - model| / |CFD| on grid G2 [%], mean over the validation points.
    turbulence_points : tuple of int
        Of `turbulence_points`.
    """

    quantity: str
    side: str
    grid: float
    turbulence: float
    surrogate: float
    turbulence_points: tuple[int, ...]

    @property
    def total(self) -> float:
        """Norm sqrt(grid^2 + turbulence^2 + surrogate^2) of the three means [%]."""
        return math.hypot(self.grid, self.turbulence, self.surrogate)

    def as_row(self) -> dict[str, object]:
        """Plain data for a report."""
        return {**dataclasses.asdict(self), "total": self.total}


def error_budget(data: DataSet, quantity: str, side: str, errors: Sequence[float]) -> ErrorBudget:
    """Error budget of one quantity on grid G2: Knight (2021) Eqs. 3.2-3.4, 3.6 and 3.7.

    The norm is that of the means: it gives the four printed norms of KCS within 0.06 percentage
    points (regression, 8 points), the mean of the norms at each point is 0.4 to 1.1 points above.

    Parameters
    ----------
    data : DataSet
        With the grids and turbulence models of the thesis.
    quantity, side : str
        One of its quantities; one of its propellers.
    errors : sequence of float
        Of the surrogate on the validation points of grid G2 (Eq. 3.6) [%], as of ``Fit.errors``.

    Raises
    ------
    ConfigError
        A point is missing.
    """
    both = turbulence_points(data, side)
    return ErrorBudget(
        quantity=quantity,
        side=side,
        grid=mean_size(grid_errors(data, quantity, side, GRID, data.validation)),
        turbulence=mean_size(turbulence_errors(data, quantity, side, GRID, both)),
        surrogate=mean_size(np.asarray(errors)),
        turbulence_points=both,
    )


def grid_errors(
    data: DataSet, quantity: str, side: str, grid: str, points: Sequence[int]
) -> np.ndarray:
    """100 (G3 - grid) / G3 [%] at some points, Eqs. 3.2 (G1) and 3.3 (G2), shape (n,)."""
    coarse, fine = (data.read(g, TURBULENCE, side).pick(points) for g in (grid, FINE_GRID))
    return percent_error(fine.values[quantity], coarse.values[quantity])


def turbulence_errors(
    data: DataSet, quantity: str, side: str, grid: str, points: Sequence[int]
) -> np.ndarray:
    """100 (SA - SST) / SA [%] on one grid at some points, Eq. 3.4, shape (n,)."""
    first, second = (data.read(grid, model, side).pick(points) for model in _MODELS)
    return percent_error(first.values[quantity], second.values[quantity])


def turbulence_points(data: DataSet, side: str) -> tuple[int, ...]:
    """The validation points if both models were run there, else all points with both."""
    other = data.read(GRID, OTHER_TURBULENCE, side).points.tolist()
    return data.validation if set(data.validation) <= set(other) else tuple(other)


def sigma_n(data: DataSet, quantity: str, side: str) -> float:
    """Noise sigma_n of a quantity by the rule of Knight (2021) [unit of the quantity].

    Standard deviation of the differences G3 - G2 over all points, plus that of the differences
    SST - SA over all points on grid G2 with both (sections 3.2.5 and 5.3.4). A mean difference is a
    bias, not noise, and is left out. Of KCS section 3.2.5 takes both models at points 1-12; the
    tables have SST at points 1-4 (3.5, 3.6, A.7, A.8).

    It gives the printed values of KCS, 0.024, 0.034, 0.046 and 0.079 for K_T, 10K_Q, C_Fx, C_Fy,
    to 0.0006. It does not give those of ONRT (0.028 for 0.037, 0.061 for 0.045): see
    `sigma_n_limit`.

    Raises
    ------
    ConfigError
        The file has no columns grid and turbulence, or fewer than 3 points with both grids or both
        models.
    """
    coarse, fine = (_by_point(data, quantity, side, g, TURBULENCE) for g in (GRID, FINE_GRID))
    other = _by_point(data, quantity, side, GRID, OTHER_TURBULENCE)
    pairs = (("grids", fine), ("turbulence models", other))
    return sum(float(np.std(_differences(data, what, coarse, x), ddof=1)) for what, x in pairs)


def sigma_n_limit(data: DataSet, quantity: str, side: str) -> float:
    """Noise sigma_n from the turbulence models alone, an upper limit [unit of the quantity].

    Upper 95 % limit s sqrt((n - 1) / chi2) of the standard deviation, with s that of the n
    differences SST - SA over all points and grids on which both were run, and chi2 the 5 % quantile
    of the chi-square distribution with n - 1 degrees of freedom.

    No source prints this rule. It gives the eight printed values of ONRT within 0.0006 (n = 8),
    which the printed one (`sigma_n`) does not; for KCS it gives 6 to 25 % more than is printed. The
    grids of one point are not independent, so the limit is too narrow where there are several.

    Raises
    ------
    ConfigError
        As `sigma_n`, for the turbulence models.
    """
    differences: list[float] = []
    for grid in _grids(data):
        first, second = (_by_point(data, quantity, side, grid, m) for m in _MODELS)
        differences += [second[point] - first[point] for point in first if point in second]
    n = len(_enough(data, "turbulence models", differences))
    return float(np.std(differences, ddof=1) * math.sqrt((n - 1) / chdtri(n - 1, 0.95)))


def has_grids(data: DataSet) -> bool:
    """Whether a file has both grids that `sigma_n` compares."""
    return {GRID, FINE_GRID} <= set(_grids(data))


def _grids(data: DataSet) -> list[str]:
    return sorted(set(read_csv(data.path).require("grid", "turbulence").columns["grid"]))


def _differences(
    data: DataSet, what: str, first: dict[int, float], second: dict[int, float]
) -> list[float]:
    found = [second[point] - first[point] for point in first if point in second]
    return _enough(data, what, found)


def _enough(data: DataSet, what: str, differences: list[float]) -> list[float]:
    if len(differences) < 3:
        raise ConfigError(
            f"{data.path}: {len(differences)} points with both {what}; sigma_n needs at least 3"
        )
    return differences


def _by_point(data: DataSet, quantity: str, side: str, grid: str, model: str) -> dict[int, float]:
    """Values of one turbulence model on one grid by point; empty where it was not run."""
    rows = read_csv(data.path).require("grid", "turbulence").columns
    if not ((rows["grid"] == grid) & (rows["turbulence"] == model)).any():
        return {}
    samples = data.read(grid, model, side)
    return dict(zip(samples.points.tolist(), samples.values[quantity].tolist(), strict=True))
