"""How far a surrogate can be trusted: error of grid, turbulence model and fit, and their norm."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from scipy.special import chdtri

from ship_gym.config import ConfigError
from ship_gym.csv_file import read_csv
from ship_gym.surrogates.base import SurrogateModel, mean_size, percent_error
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
        The validation points, or the training points where the second model was not run there.
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


def error_budget(data: DataSet, quantity: str, side: str, model: SurrogateModel) -> ErrorBudget:
    """Error budget of one quantity, after the combined error metric of Knight (2021).

    Only the norm is printed there, not the definitions of its parts. Those of `ErrorBudget` give
    the four printed norms of KCS within 0.06 percentage points (regression, 8 points, grid G2); the
    norm is of the means: the mean of the norms at each point is 0.4 to 1.1 points above the print.

    Parameters
    ----------
    data : DataSet
        With the grids and turbulence models of the thesis.
    quantity, side : str
        One of its quantities; one of its propellers.
    model : SurrogateModel
        Fitted to the training points on grid G2.

    Raises
    ------
    ConfigError
        A point is missing.
    """
    points = data.read(GRID, TURBULENCE, side)
    held = points.pick(data.validation)
    truth = held.values[quantity]
    fine = data.read(FINE_GRID, TURBULENCE, side).pick(data.validation).values[quantity]
    predicted, _ = model.predict(held.X)
    other = data.read(GRID, OTHER_TURBULENCE, side)
    both = data.validation if set(data.validation) <= set(other.points) else data.training
    first, second = (s.pick(both).values[quantity] for s in (points, other))
    return ErrorBudget(
        quantity=quantity,
        side=side,
        grid=mean_size(percent_error(fine, truth)),
        turbulence=mean_size(percent_error(first, second)),
        surrogate=mean_size(percent_error(truth, predicted)),
        turbulence_points=both,
    )


def sigma_n(data: DataSet, quantity: str, side: str) -> float:
    """Noise sigma_n of a quantity from the spread of turbulence models [unit of the quantity].

    Upper 95 % limit s sqrt((n - 1) / chi2) of the standard deviation, with s that of the n
    differences SST - SA over all points and grids on which both were run, and chi2 the 5 % quantile
    of the chi-square distribution with n - 1 degrees of freedom. The mean difference is a bias, not
    noise, and is left out.

    Knight (2021) prints the values, not the rule, which is inferred: it gives the eight printed
    values of ONRT within 0.0006 (n = 8). For KCS the thesis' training points with SST are not
    printed; points 1-4 on three grids (n = 12) give 0.029, 0.042, 0.056, 0.084 for K_T, 10K_Q,
    C_Fx, C_Fy, where the thesis has 0.024, 0.034, 0.046, 0.079. The grids of one point are not
    independent, so the limit is too narrow there.

    Raises
    ------
    ConfigError
        The file has no columns grid and turbulence, or fewer than 3 points with both models.
    """
    grids = sorted(set(read_csv(data.path).require("grid", "turbulence").columns["grid"]))
    differences: list[float] = []
    for grid in grids:
        first, second = (_by_point(data, quantity, side, grid, m) for m in _MODELS)
        differences += [second[point] - first[point] for point in first if point in second]
    n = len(differences)
    if n < 3:
        raise ConfigError(
            f"{data.path}: {quantity} {side} has {n} points with both {TURBULENCE} and "
            f"{OTHER_TURBULENCE}; sigma_n needs at least 3"
        )
    return float(np.std(differences, ddof=1) * math.sqrt((n - 1) / chdtri(n - 1, 0.95)))


def _by_point(data: DataSet, quantity: str, side: str, grid: str, model: str) -> dict[int, float]:
    """Values of one turbulence model on one grid by point; empty where it was not run."""
    rows = read_csv(data.path).columns
    if not ((rows["grid"] == grid) & (rows["turbulence"] == model)).any():
        return {}
    samples = data.read(grid, model, side)
    return dict(zip(samples.points.tolist(), samples.values[quantity].tolist(), strict=True))
