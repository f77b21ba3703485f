"""Steps of Gauss-Newton with Levenberg's damping and a ridge."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

SHARES = (0.1, 1.0, 10.0, 100.0)  # of the damping; all of them are tried
LEAST_DAMPING, MOST_DAMPING = 1e-6, 1e6
_LEAST = 1e-12  # of the largest diagonal, so that the matrix can be inverted
_RAISED = 30.0  # where no step lowers the cost


def steps(
    jacobian: np.ndarray,
    residuals: np.ndarray,
    vector: np.ndarray,
    dampings: Sequence[float],
    ridge: float,
) -> np.ndarray:
    """Weights after one step for each damping, shape (len(dampings), P).

    Least squares of the linearised residuals, ``|r + J s|^2 + ridge |x + s|^2``, with the diagonal
    of ``J J'`` times the damping added to its matrix (Levenberg-Marquardt).

    Parameters
    ----------
    jacobian : numpy.ndarray
        Slope of the residuals with each weight, shape (P, R).
    residuals : numpy.ndarray
        Shape (R,).
    vector : numpy.ndarray
        Weights x, shape (P,).
    dampings : sequence of float
    ridge : float
    """
    # float32 slopes are summed in float64: R is large
    matrix = np.empty((len(vector), len(vector)))
    wide = [row.astype(np.float64) for row in jacobian]
    for i, row in enumerate(wide):
        matrix[i, : i + 1] = [row @ other for other in wide[: i + 1]]
        matrix[: i + 1, i] = matrix[i, : i + 1]
    gradient = np.array([row @ residuals for row in wide]) + ridge * vector
    found = []
    for damping in dampings:
        diagonal = np.diag(matrix)
        # what no residual feels, as layers behind weights of zero, stays where it is
        extra = damping * diagonal + ridge + _LEAST * max(float(diagonal.max()), _LEAST)
        found.append(vector - np.linalg.solve(matrix + np.diag(extra), gradient))
    return np.array(found)


def next_damping(damping: float, taken: float | None) -> float:
    """Damping of the next iteration: that of the step taken; more where None was."""
    wanted = damping * _RAISED if taken is None else taken
    return float(np.clip(wanted, LEAST_DAMPING, MOST_DAMPING))
