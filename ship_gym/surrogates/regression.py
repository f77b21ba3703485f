"""Polynomial least squares in (J, beta): Knight (2021) 2.4.1.1, Knight & Maki (2020) Eq. 21."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ship_gym.config import ConfigError


def monomials(degree: int) -> tuple[tuple[int, int], ...]:
    """Powers (i, j) of J^i beta^j up to a total degree, by degree, within it by falling power of J.

    Degree 2 gives 1, J, beta, J^2, J beta, beta^2.
    """
    return tuple((d - j, j) for d in range(degree + 1) for j in range(d + 1))


# Powers of J and beta of each feature. "first" and "second" in the order in which Knight (2021)
# prints them; "third" and "fourth" as `monomials` orders them; "network" as Knight & Maki (2020)
# list the inputs of their network, [1, J, J^2, |a|..|a|^6, J|a|..J|a|^6, J^2|a|..J^2|a|^6].
FEATURES: dict[str, tuple[tuple[int, int], ...]] = {
    "first": ((0, 0), (1, 0), (0, 1), (1, 1)),
    "second": ((0, 0), (1, 0), (2, 0), (0, 1), (0, 2), (1, 1)),
    "third": monomials(3),
    "fourth": monomials(4),
    "network": (((0, 0), (1, 0), (2, 0)) + tuple((i, j) for i in (0, 1, 2) for j in range(1, 7))),
}


def features(X: np.ndarray, order: str = "second") -> np.ndarray:
    """Feature matrix; ``second`` is [1, J, J^2, beta, beta^2, J beta], beta in rad.

    Parameters
    ----------
    X : numpy.ndarray
        Shape (n, 2): J [-], beta [rad]. Where the flow is the same to both sides, as in open
        water, the angle is its magnitude |alpha| (Knight & Maki 2020 Eq. 21).
    order : str
        One of `FEATURES`.

    Returns
    -------
    numpy.ndarray
        Shape (n, features).
    """
    X = np.atleast_2d(np.asarray(X, dtype=float))
    return np.stack([X[:, 0] ** i * X[:, 1] ** j for i, j in FEATURES[order]], axis=1)


class Regression:
    """Least squares on polynomial features.

    Attributes
    ----------
    coefficients : numpy.ndarray
        Shape (features,), after `fit` or given.
    sigma : float
        Standard deviation of the residuals with n - features degrees of freedom; nan without any.
    """

    def __init__(self, order: str = "second", coefficients: np.ndarray | None = None):
        self.order = order
        self.coefficients = None if coefficients is None else np.asarray(coefficients, dtype=float)
        self.sigma = float("nan")
        self._covariance: np.ndarray | None = None

    def fit(self, X: np.ndarray, y: np.ndarray) -> Regression:
        """Fit to X (n, 2) and y (n,).

        Raises
        ------
        ConfigError
            Fewer points than features, or points that do not span the features.
        """
        matrix, y = features(X, self.order), np.asarray(y, dtype=float)
        n, k = matrix.shape
        if n < k:
            raise ConfigError(
                f"{self.order} order regression has {k} features, but {n} points given"
            )
        # columns of equal length: the high powers of a small angle are small, but not dependent
        length = np.linalg.norm(matrix, axis=0)
        length[length == 0.0] = 1.0
        scaled, _, rank, _ = np.linalg.lstsq(matrix / length, y, rcond=1e-10)
        if rank < k:
            raise ConfigError(
                f"the {n} points do not span the {k} features of the {self.order} order regression "
                f"(rank {rank}): they are collinear or repeated"
            )
        self.coefficients = scaled / length
        if n > k:
            residual = y - matrix @ self.coefficients
            self.sigma = float(np.sqrt(residual @ residual / (n - k)))
        inverse = np.linalg.pinv(matrix / length) / length[:, None]
        self._covariance = inverse @ inverse.T
        return self

    def predict(self, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Mean and standard deviation of the mean (nan for printed coefficients), shapes (n,)."""
        if self.coefficients is None:
            raise RuntimeError("Regression.predict before fit")
        matrix = features(X, self.order)
        mean = matrix @ self.coefficients
        if self._covariance is None:
            return mean, np.full(len(mean), np.nan)
        spread = np.einsum("ij,jk,ik->i", matrix, self._covariance, matrix)
        return mean, self.sigma * np.sqrt(spread)

    def describe(self) -> dict[str, Any]:
        """What was fitted, as plain data for the card of a table."""
        if self.coefficients is None:
            raise RuntimeError("Regression.describe before fit")
        return {
            "family": "regression",
            "order": self.order,
            "features": [f"J^{i} beta^{j}" for i, j in FEATURES[self.order]],
            "coefficients": [float(c) for c in self.coefficients],
            "sigma": None if math.isnan(self.sigma) else self.sigma,
        }
