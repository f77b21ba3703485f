"""What a least-squares fit found: values, standard errors, correlations, residuals by group.

Groups (surge, sway, yaw) have scatters of their own, sigma, found from their residuals: a group of
m rows to which the numbers are fitted has sigma^2 = sum of squares / (m - sum of leverages), which
is unbiased where each number belongs to one group. With W = 1 / sigma^2 the covariance is
(J^T W J)^-1; J: derivative of the model's rows by the numbers.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence

import numpy as np
from scipy import stats

from ship_gym.config import ConfigError

ILL = 1e8  # condition of the scaled normal matrix from which digits are lost
_ROUNDS = 3  # of weighting; sigma of a group hardly moves after the second


@dataclasses.dataclass(frozen=True)
class Estimate:
    """Numbers fitted to rows of data.

    Attributes
    ----------
    names : tuple of str
        Shape (k,), as are `start`, `values` and their standard `errors`, all in SI.
    correlation : numpy.ndarray
        Of the estimates, shape (k, k).
    condition : float
        Of J^T W J scaled to a unit diagonal; 1: every number is told by rows of its own.
    sigma, rows, freedom : dict
        Of each group: standard deviation of its residuals, rows, degrees of freedom.
    residuals : numpy.ndarray
        Data minus model with the fitted numbers, shape (m,).
    """

    names: tuple[str, ...]
    start: np.ndarray
    values: np.ndarray
    errors: np.ndarray
    correlation: np.ndarray
    condition: float
    sigma: dict[str, float]
    rows: dict[str, int]
    freedom: dict[str, float]
    residuals: np.ndarray

    def interval(self, level: float = 0.95) -> np.ndarray:
        """Confidence interval of each number by Student's t, shape (k, 2)."""
        freedom = max(min(self.freedom.values()), 1.0)
        half = float(stats.t.ppf(0.5 + 0.5 * level, freedom)) * self.errors
        return np.column_stack([self.values - half, self.values + half])

    def closest_pair(self) -> tuple[str, str, float]:
        """The two numbers that the data tell apart worst, and their correlation."""
        rest = np.abs(np.triu(self.correlation, 1))
        i, j = np.unravel_index(int(rest.argmax()), rest.shape)
        return self.names[i], self.names[j], float(self.correlation[i, j])


def scatter(
    jacobian: np.ndarray,
    residuals: np.ndarray,
    groups: np.ndarray,
    begin: Mapping[str, float] | None = None,
    known: str = "",
) -> tuple[dict[str, float], dict[str, float]]:
    """Standard deviation and degrees of freedom of each group; rows as in `solve`.

    Parameters
    ----------
    begin : mapping, optional
        Standard deviations to begin with; 1 if omitted.
    known : str
        A group whose standard deviation is 1, such as a number's own from elsewhere.
    """
    sigma = {name: (begin or {}).get(name, 1.0) for name in np.unique(groups).tolist()}
    freedom: dict[str, float] = {}
    for _ in range(_ROUNDS):
        leverage = leverages(jacobian, groups, sigma)
        for name in sigma.keys() - {known}:
            own = groups == name
            freedom[name] = float(own.sum() - leverage[own].sum())
            if freedom[name] < 0.5:
                raise ConfigError(f"{own.sum()} rows of {name}: too few for the numbers to fit")
            square = float(residuals[own] @ residuals[own]) / freedom[name]
            sigma[name] = max(np.sqrt(square), 1e-15)
    return sigma, freedom


def weights_of(groups: np.ndarray, sigma: Mapping[str, float]) -> np.ndarray:
    """1 / sigma of the group of each row, shape (m,)."""
    return np.array([1.0 / sigma[group] for group in groups.tolist()])


def leverages(jacobian: np.ndarray, groups: np.ndarray, sigma: dict[str, float]) -> np.ndarray:
    """How far each row draws the fit to itself, 0 to 1, shape (m,); their sum is the numbers'."""
    weight = weights_of(groups, sigma)
    Q, _ = np.linalg.qr(jacobian * weight[:, None])
    return (Q * Q).sum(axis=1)


def solve(
    names: Sequence[str],
    jacobian: np.ndarray,
    gap: np.ndarray,
    groups: np.ndarray,
    start: np.ndarray,
) -> Estimate:
    """Weighted linear least squares of gap = jacobian (values - start) + residuals.

    Parameters
    ----------
    names : sequence of str, length k
    jacobian : numpy.ndarray
        Shape (m, k).
    gap : numpy.ndarray
        Data minus model at `start`, shape (m,).
    groups : numpy.ndarray of str, shape (m,)
    start : numpy.ndarray, shape (k,)

    Raises
    ------
    ConfigError
        Rows that do not tell the numbers apart, or too few of them.
    """
    check_told(names, jacobian)
    sigma = dict.fromkeys(np.unique(groups).tolist(), 1.0)
    for _ in range(_ROUNDS):
        weight = weights_of(groups, sigma)
        step = np.linalg.lstsq(jacobian * weight[:, None], gap * weight, rcond=None)[0]
        residuals = gap - jacobian @ step
        sigma, freedom = scatter(jacobian, residuals, groups)
    errors, correlation, condition = spread(jacobian, groups, sigma)
    rows = {name: int((groups == name).sum()) for name in sigma}
    parts = (correlation, condition, sigma, rows, freedom, residuals)
    return Estimate(tuple(names), start, start + step, errors, *parts)


def spread(
    jacobian: np.ndarray, groups: np.ndarray, sigma: dict[str, float]
) -> tuple[np.ndarray, np.ndarray, float]:
    """Standard errors, correlation and condition from the weighted rows."""
    weight = weights_of(groups, sigma)
    J = jacobian * weight[:, None]
    size = np.linalg.norm(J, axis=0)
    values = np.linalg.svd(J / size, compute_uv=False)
    covariance = np.linalg.pinv((J / size).T @ (J / size)) / np.outer(size, size)
    errors = np.sqrt(np.diag(covariance))
    correlation = covariance / np.outer(errors, errors)
    condition = float((values[0] / max(values[-1], 1e-300)) ** 2)
    return errors, correlation, condition


def of_some(
    some: int, errors: np.ndarray, correlation: np.ndarray
) -> tuple[np.ndarray, np.ndarray, float]:
    """Errors, correlation and condition of the first numbers, the others being found with them."""
    inner = correlation[:some, :some]
    normal = np.linalg.pinv(inner)
    size = np.sqrt(np.diag(normal))
    values = np.linalg.svd(normal / np.outer(size, size), compute_uv=False)
    return errors[:some], inner, float(values[0] / max(values[-1], 1e-300))


def check_told(names: Sequence[str], jacobian: np.ndarray) -> None:
    """Refuse numbers of which the data say nothing, alone or together."""
    size = np.linalg.norm(jacobian, axis=0)
    silent = [name for name, s in zip(names, size, strict=True) if s <= 1e-12]
    if silent:
        raise ConfigError(f"no test tells {', '.join(silent)}: leave out, or give tests that do")
    if len(jacobian) <= len(names):
        raise ConfigError(f"{len(jacobian)} values for {len(names)} numbers: too few")
    _, s, V = np.linalg.svd(jacobian / size, full_matrices=False)
    if (s[0] / max(s[-1], 1e-300)) ** 2 > ILL:
        shares = np.abs(V[-1]) / np.abs(V[-1]).max()
        mixed = [name for name, x in zip(names, shares, strict=True) if x > 0.2]
        raise ConfigError(f"the tests do not tell {', '.join(mixed)} apart: fit fewer of them")
