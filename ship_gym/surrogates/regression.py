"""Polynomial least squares in (J, beta), Knight (2021) section 2.3."""

from __future__ import annotations

import numpy as np

from ship_gym.config import ConfigError

# powers of J and beta of each feature, in the order in which the source prints them
FEATURES: dict[str, tuple[tuple[int, int], ...]] = {
    "first": ((0, 0), (1, 0), (0, 1), (1, 1)),
    "second": ((0, 0), (1, 0), (2, 0), (0, 1), (0, 2), (1, 1)),
}


def features(X: np.ndarray, order: str = "second") -> np.ndarray:
    """Feature matrix; ``second`` is [1, J, J^2, beta, beta^2, J beta], beta in rad.

    Parameters
    ----------
    X : numpy.ndarray
        Shape (n, 2): J [-], beta [rad].

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
        self.coefficients, _, rank, _ = np.linalg.lstsq(matrix, y, rcond=1e-10)
        if rank < k:
            raise ConfigError(
                f"the {n} points do not span the {k} features of the {self.order} order regression "
                f"(rank {rank}): they are collinear or repeated"
            )
        if n > k:
            residual = y - matrix @ self.coefficients
            self.sigma = float(np.sqrt(residual @ residual / (n - k)))
        self._covariance = np.linalg.inv(matrix.T @ matrix)
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
