"""Gaussian process of few dear samples on top of many cheap ones."""

from __future__ import annotations

from typing import Any

import numpy as np

from ship_gym.surrogates.gaussian_process import GaussianProcess

SETTLED = 1e-3  # change of the factor of the cheap process
MAX_STEPS = 20


class TwoFidelities(GaussianProcess):
    """y = rho y_cheap + constant + f + noise: a coarse grid lifted to a fine one.

    Autoregressive model of Kennedy & O'Hagan (2000), Biometrika 87, 1-13: y_cheap is a Gaussian
    process, f another one that is independent of it, rho one number. It is built in two steps
    (recursive co-kriging, Le Gratiet & Garnier 2014, Int. J. Uncertainty Quantification 4): first
    the cheap process alone, then f on what the dear samples differ by, with the mean of the cheap
    process as `trend`. Where each dear point is a cheap one too and the cheap samples are without
    noise, this is exactly the conditional distribution given both sets. Elsewhere it is close: what
    the cheap process does not know at a dear point counts as noise there, of variance
    rho^2 std^2, from point to point independent.

    Parameters
    ----------
    cheap : GaussianProcess
        Fitted to the cheap samples.
    sigma_n, restarts, seed
        Of the dear samples, as in `GaussianProcess`.

    Attributes
    ----------
    rho : float
        Factor of the cheap process.
    """

    def __init__(
        self,
        cheap: GaussianProcess,
        sigma_n: float | np.ndarray = 1e-4,
        *,
        restarts: int = 0,
        seed: int = 0,
    ):
        super().__init__(sigma_n, restarts=restarts, seed=seed, trend=lambda X: cheap.predict(X)[0])
        self.cheap, self.given_noise = cheap, sigma_n

    @property
    def rho(self) -> float:
        """Factor of the cheap process."""
        return float(self.coefficients[1])

    def fit(self, X: np.ndarray, y: np.ndarray) -> TwoFidelities:
        """Fit to the dear samples, see `GaussianProcess.fit`; ``sigma_n`` becomes one per point."""
        rho, unknown = 1.0, self.cheap.predict(X)[1]
        for _ in range(MAX_STEPS):
            self.sigma_n = np.hypot(self.given_noise, rho * unknown)
            super().fit(X, y)
            if abs(self.rho - rho) < SETTLED:
                break
            rho = self.rho
        return self

    def predict(self, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Mean and standard deviation at X, see `GaussianProcess.predict`, of both processes."""
        mean, std = super().predict(X)
        return mean, np.hypot(std, self.rho * self.cheap.predict(X)[1])

    def describe(self) -> dict[str, Any]:
        """What was fitted, as plain data for the card of a table."""
        found = super().describe() | {"family": "two fidelities", "rho": self.rho}
        return found | {"cheap": self.cheap.describe()}
