"""What every surrogate of printed CFD samples has in common."""

from __future__ import annotations

import math
from typing import Any, Protocol

import numpy as np


class SurrogateModel(Protocol):
    """A fitted map from inputs to one quantity."""

    def fit(self, X: np.ndarray, y: np.ndarray) -> SurrogateModel:
        """Fit to inputs X of shape (n, 2), (J [-], beta [rad]), and values y of shape (n,)."""

    def predict(self, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Mean and standard deviation at inputs X, each of shape (n,)."""

    def describe(self) -> dict[str, Any]:
        """What was fitted, as plain data for the card of a table."""


def percent_error(truth: np.ndarray, model: np.ndarray) -> np.ndarray:
    """Error as the source prints it, 100 (CFD - model) / CFD [%]."""
    return 100.0 * (truth - model) / truth


def mean_size(errors: np.ndarray) -> float:
    """Mean of the sizes of some errors, in their unit."""
    return float(np.abs(errors).mean())


def held_out_score(model: SurrogateModel, X: np.ndarray, y: np.ndarray) -> dict[str, float]:
    """Errors of a fitted model on points that it has not seen.

    Returns
    -------
    dict
        ``rmse`` in the unit of y, ``mean_abs_percent`` and ``max_abs_percent`` [%].
    """
    mean, _ = model.predict(X)
    errors = np.abs(percent_error(y, mean))
    return {
        "rmse": math.sqrt(np.mean((y - mean) ** 2)),
        "mean_abs_percent": float(errors.mean()),
        "max_abs_percent": float(errors.max()),
    }
