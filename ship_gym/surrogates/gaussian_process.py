"""Gaussian process in (J, beta) or (J, beta, delta): squared exponential, known noise."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, check_number

# Search ranges over the start values, so wide that no sample set of this project ends on one.
LENGTH_RANGE = (1e-3, 1e6)
VARIANCE_RANGE = (1e-8, 1e8)
SETTLED = 1e-6  # change of the constant over the standard deviation of y
MAX_STEPS = 200
_INPUTS = ("J", "beta", "delta")


class GaussianProcess:
    """y = constant + f(J, beta) + noise, with f a Gaussian process of mean zero.

    cov(f, f') = sigma_f^2 exp(-1/2 sum_d ((x_d - x'_d) / length_scale_d)^2); the noise is normal
    with the given standard deviation sigma_n. Rasmussen & Williams (2006) (RW06) chapters 2 and 5.

    Knight (2021) section 3.2.5 used MATLAB's ``fitrgp``. Its defaults and scikit-learn's part at:

    - *Mean.* MATLAB fits a constant by generalised least squares; scikit-learn takes zero. Here the
      constant and the process are fitted in turn until the constant rests: the highest likelihood
      of both together, which is the likelihood that MATLAB climbs.
    - *Start.* MATLAB starts from the standard deviation of each input, and of y over sqrt(2);
      scikit-learn from 1. Here as in MATLAB.
    - *Search.* Both climb once from there to the nearest top; scikit-learn restarts on request.

    The measure is the mean error of the eight-point K_T of KCS (grid G2) at points 1-4, printed as
    2.36 % for sigma_n 0.024 and 1.38 % for 1e-4 (Table 3.11). This class gives 2.36 and 1.42 %,
    mean zero 3.04 and 1.24 %. A constant with a flat prior inside the kernel, whose likelihood is
    averaged over the constant instead, gives 2.97 and 1.52 %. With restarts the highest top of all
    is found at 1e-4: length scale 0.14 in J, a wavy surface with 6.2 % error. Eight points without
    noise do not settle the length scales; the start does.

    Parameters
    ----------
    sigma_n : float or numpy.ndarray
        Standard deviation of the noise [unit of y], fixed; one for all points or one each, shape
        (n,). 1e-4 goes through the points; `error_budget.sigma_n` computes it from the spread of
        grids and turbulence models.
    restarts : int
        Further starts, drawn log-uniformly over the search ranges. 0 as in MATLAB.
    seed : int
        Of the further starts; without them nothing is random.
    trend : callable, optional
        What the mean has beside the constant: from X (m, inputs) to (m,), times a coefficient that
        is fitted with the constant.

    Attributes
    ----------
    constant : float
        Mean of the process [unit of y].
    coefficients : numpy.ndarray
        The constant and, with a trend, its factor; shape (1,) or (2,).
    sigma_f : float
        Standard deviation of f [unit of y].
    length_scales : numpy.ndarray
        Of J [-], beta and, where it is an input, delta [rad]. Far larger than the inputs' range:
        the input does not matter.
    log_marginal_likelihood : float
        At the constant and the values above, RW06 eq. 2.30.
    """

    def __init__(
        self,
        sigma_n: float | np.ndarray = 1e-4,
        *,
        restarts: int = 0,
        seed: int = 0,
        trend: Callable[[np.ndarray], np.ndarray] | None = None,
    ):
        self.sigma_n, self.restarts, self.seed, self.trend = sigma_n, restarts, seed, trend
        self.sigma_f = self.log_marginal_likelihood = float("nan")
        self.coefficients = np.full(1 if trend is None else 2, np.nan)
        self.length_scales = np.full(2, np.nan)
        self._process: Any = None
        self._precision = np.empty((0, 0))

    @property
    def constant(self) -> float:
        """Mean of the process [unit of y], without a trend."""
        return float(self.coefficients[0])

    def fit(self, X: np.ndarray, y: np.ndarray) -> GaussianProcess:
        """Fit to X (n, 2) or (n, 3), J [-], beta and delta [rad], and y (n,).

        Raises
        ------
        ConfigError
            Fewer than 3 points, a value that is not finite, an input or y that does not vary, or
            sigma_n below a millionth of the standard deviation of y or not finite.
        """
        X, y = _checked(X, y)
        self._check_noise(y)
        self._process, self.coefficients = self._climb(_start(X, y), X, y)
        found = self._process.kernel_
        self.sigma_f = float(np.sqrt(found.k1.constant_value))
        self.length_scales = np.array(found.k2.length_scale)
        self.log_marginal_likelihood = float(self._process.log_marginal_likelihood_value_)
        self._precision = self._inverse(found, X)
        return self

    def _check_noise(self, y: np.ndarray) -> None:
        if np.ndim(self.sigma_n) and np.shape(self.sigma_n) != y.shape:
            raise ConfigError(f"sigma_n has shape {np.shape(self.sigma_n)}, y has {y.shape}")
        for sigma_n in np.ravel(self.sigma_n).tolist():
            check_number("sigma_n", sigma_n, low=1e-6 * float(y.std(ddof=1)), unit="unit of y")

    def _basis(self, X: np.ndarray) -> np.ndarray:
        """What the coefficients of the mean multiply, shape (m, 1) or (m, 2)."""
        one = np.ones((len(X), 1))
        return one if self.trend is None else np.column_stack([one, self.trend(X)])

    def _climb(self, kernel, X: np.ndarray, y: np.ndarray):
        """Process and mean of highest likelihood, each fitted in turn with the other held."""
        from sklearn.exceptions import ConvergenceWarning
        from sklearn.gaussian_process import GaussianProcessRegressor

        basis, settled = self._basis(X), SETTLED * y.std()
        mean = self._mean(kernel, X, y)
        for step in range(MAX_STEPS):
            process = GaussianProcessRegressor(
                kernel,
                alpha=self.sigma_n**2,
                n_restarts_optimizer=0 if step else self.restarts,
                random_state=self.seed,
            )
            with warnings.catch_warnings():
                # a drawn start may end on its range where the likelihood is flat: no loss
                warnings.simplefilter("ignore", ConvergenceWarning)
                process.fit(X, y - basis @ mean)
            kernel, before = process.kernel_, mean
            mean = self._mean(kernel, X, y)
            if np.abs(basis @ (mean - before)).max() < settled:
                break
        else:
            warnings.warn(f"constant of the process moves after {MAX_STEPS} steps", stacklevel=3)
        return process, before

    def _inverse(self, kernel, X: np.ndarray) -> np.ndarray:
        """Inverse covariance of the observations, noise included."""
        return np.linalg.inv(kernel(X) + self.sigma_n**2 * np.eye(len(X)))

    def _mean(self, kernel, X: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Coefficients by generalised least squares, RW06 eq. 2.42 with h = 1 and the trend."""
        basis = self._basis(X)
        weights = self._inverse(kernel, X) @ basis
        return np.linalg.solve(basis.T @ weights, weights.T @ y)

    def predict(self, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Mean and standard deviation of constant + f at X (n, 2), without the noise, shapes (n,).

        The variance is that of f plus that of the fitted mean, RW06 eq. 2.42; the length scales
        and sigma_f are taken as known. A new CFD point scatters by sigma_n on top.
        """
        if self._process is None:
            raise RuntimeError("GaussianProcess.predict before fit")
        X = np.atleast_2d(np.asarray(X, dtype=float))
        with warnings.catch_warnings():
            # round-off at a training point, where the variance is all but zero
            warnings.filterwarnings("ignore", "Predicted variances smaller than 0")
            mean, std = self._process.predict(X, return_std=True)
        there, basis = self._process.X_train_, self._basis(X)
        weights, covariance = self._weights(there)
        share = basis - self._process.kernel_(X, there) @ weights
        of_mean = np.einsum("ij,jk,ik->i", share, covariance, share)
        return basis @ self.coefficients + mean, np.sqrt(std**2 + of_mean)

    def _weights(self, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Precision times the basis at the training points, and covariance of the coefficients."""
        basis = self._basis(X)
        weights = self._precision @ basis
        return weights, np.linalg.inv(basis.T @ weights)

    def leave_one_out(self) -> tuple[np.ndarray, np.ndarray]:
        """Residual of each training point from the fit to the others, and its standard deviation.

        RW06 eq. 5.12, from the inverse covariance with the constant fitted to the others too; the
        length scales and sigma_f stay. Unlike that of `predict` the standard deviation is that of
        an observation, noise included: residual / std should scatter by 1.

        Returns
        -------
        tuple of numpy.ndarray
            y - mean of the others, and standard deviation, [unit of y], shapes (n,).
        """
        if self._process is None:
            raise RuntimeError("GaussianProcess.leave_one_out before fit")
        weights, covariance = self._weights(self._process.X_train_)
        inverse = self._precision - weights @ covariance @ weights.T
        pivot = np.diag(inverse)
        return inverse @ self._process.y_train_ / pivot, 1.0 / np.sqrt(pivot)

    def describe(self) -> dict[str, Any]:
        """What was fitted, as plain data for the card of a table."""
        return {
            "family": "gaussian process",
            "sigma_n": np.asarray(self.sigma_n, dtype=float).tolist(),
            "constant": self.constant,
            "sigma_f": self.sigma_f,
            "length_scales": [float(x) for x in self.length_scales],
            "log_marginal_likelihood": self.log_marginal_likelihood,
            "restarts": self.restarts,
            "seed": self.seed,
        }


def _start(X: np.ndarray, y: np.ndarray):
    """Kernel at the start values of MATLAB's fitrgp."""
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel

    variance, lengths = float(y.var(ddof=1)) / 2.0, X.std(axis=0, ddof=1)
    low, high = VARIANCE_RANGE
    return ConstantKernel(variance, (low * variance, high * variance)) * RBF(
        lengths, np.outer(lengths, LENGTH_RANGE)
    )


def _checked(X, y) -> tuple[np.ndarray, np.ndarray]:
    X, y = np.asarray(X, dtype=float), np.asarray(y, dtype=float)
    if X.ndim != 2 or X.shape[1] not in (2, 3) or y.shape != X.shape[:1]:
        raise ConfigError(
            f"shapes {X.shape} and {y.shape}: must be (n, 2) or (n, 3) for X and (n,) for y"
        )
    if len(y) < 3:
        raise ConfigError(f"a Gaussian process needs at least 3 points, but {len(y)} given")
    for name, values in (*zip(_INPUTS, X.T, strict=False), ("y", y)):
        if not np.isfinite(values).all():
            first = int(np.flatnonzero(~np.isfinite(values))[0])
            raise ConfigError(f"{name} = {values[first]} at point {first}: must be finite")
        if np.ptp(values) == 0.0:
            raise ConfigError(f"{name} = {values[0]:g} at all points: must vary")
    return X, y
