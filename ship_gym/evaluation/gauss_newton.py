"""Gauss-Newton on the corrections of a rudder, all episodes in one batch, derivatives by sailing.

Every episode has its own least-squares problem: its residuals, its corrections at the knots. They
share the batch alone. Nothing here is drawn by chance.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterable

import numpy as np

from ship_gym.evaluation.objectives import Objective, Scale, residuals
from ship_gym.evaluation.voyages import Pilot, Sailings

_NUDGE = math.radians(0.4)  # of a correction, for the differences [rad]
_DAMPINGS = (1e-3, 1e-2, 1e-1, 1.0, 10.0)  # Levenberg-Marquardt, over the diagonal; all are tried
_LEAST_GAIN = 1e-3  # of the cost in an iteration; an episode that gains less is finished


@dataclasses.dataclass(frozen=True, eq=False)
class Problem:
    """What is minimised for n episodes.

    Attributes
    ----------
    sailings : Sailings
    objective : Objective
    scale : Scale
        Of the n episodes.
    reach : int
        Knots after which a correction is taken to be forgotten: knots so far apart are moved in
        one voyage. The derivative alone is cut off there, never the cost.
    """

    sailings: Sailings
    objective: Objective
    scale: Scale
    reach: int

    def evaluate(self, pilot: Pilot, rows: np.ndarray, corrections: np.ndarray):
        """Residuals (parts, T, m) and costs (m,) of rows of episodes with corrections (m, K)."""
        sailed = self.sailings.sail(pilot, rows, corrections)
        return residuals(self.objective, self.scale.rows(rows), sailed)


def minimise(
    problem: Problem,
    pilot: Pilot,
    start: np.ndarray,
    iterations: int,
    progress: Callable[[Iterable], Iterable] = iter,
) -> tuple[np.ndarray, np.ndarray]:
    """Lower the cost of every episode from where it starts; it never rises.

    Parameters
    ----------
    problem : Problem
    pilot : Pilot
    start : numpy.ndarray
        Corrections at the knots [rad], shape (n, K).
    iterations : int
        At most so many, each of one derivative and one search.
    progress : callable
        Wraps the iterable of iterations.

    Returns
    -------
    corrections : numpy.ndarray
        Shape (n, K).
    costs : numpy.ndarray
        Shape (n,).
    """
    found = np.array(start)
    costs = problem.evaluate(pilot, np.arange(len(found)), found)[1]
    active = np.arange(len(found))
    for _ in progress(range(iterations)):
        if not len(active):
            break
        gain = _iterate(problem, pilot, active, found, costs)
        active = active[gain > _LEAST_GAIN]
    return found, costs


def _iterate(problem: Problem, pilot: Pilot, active, found, costs) -> np.ndarray:
    """One step for the `active` episodes, written to `found` and `costs`; relative gains."""
    moves = _moves(problem, pilot, active, found[active])
    limit = 2.0 * problem.sailings.ship.gear.delta_max  # from hard over to hard over
    tried = np.clip(found[active] + moves, -limit, limit)
    flat = tried.reshape(-1, tried.shape[2])
    new = problem.evaluate(pilot, np.tile(active, len(_DAMPINGS)), flat)[1]
    new = new.reshape(len(_DAMPINGS), len(active))
    best, each = new.argmin(axis=0), np.arange(len(active))
    lower, before = new[best, each] < costs[active], costs[active]
    found[active[lower]] = tried[best, each][lower]
    costs[active[lower]] = new[best, each][lower]
    return 1.0 - costs[active] / np.maximum(before, 1e-300)


def _moves(problem: Problem, pilot: Pilot, rows: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Steps for each damping, shape (dampings, m, K)."""
    base, slopes = _slopes(problem, pilot, rows, x)
    knots = problem.sailings.knots
    # A knot acts from the knot before it, and alone until the next of its voyage begins to.
    begins = np.append(0.0, knots)[: len(knots)].astype(int)
    ends = np.append(begins, np.full(problem.reach, base.shape[1]))[problem.reach :]
    moves = np.zeros((len(_DAMPINGS), *x.shape))
    for i in range(len(rows)):
        jacobian = np.zeros((base[..., 0].size, len(knots)))
        shaped = jacobian.reshape(*base.shape[:2], len(knots))
        for k, (begin, end) in enumerate(zip(begins.tolist(), ends.tolist(), strict=False)):
            shaped[:, begin:end, k] = slopes[k % problem.reach, :, begin:end, i]
        gradient, hessian = jacobian.T @ base[..., i].ravel(), jacobian.T @ jacobian
        diagonal = np.diag(hessian)
        for damping, move in zip(_DAMPINGS, moves, strict=True):
            # what no residual feels stays where it is
            extra = damping * diagonal + 1e-9 * max(diagonal.max(), 1e-30)
            move[i] = np.linalg.solve(hessian + np.diag(extra), -gradient)
    return moves


def _slopes(problem: Problem, pilot: Pilot, rows: np.ndarray, x: np.ndarray):
    """Residuals (parts, T, m) and their slopes (voyages, parts, T, m) for every so many-th knot."""
    m, K = x.shape
    voyages = 1 + min(problem.reach, K)  # the first is the one as it is
    nudges = np.zeros((voyages, K))
    for k in range(K):
        nudges[1 + k % problem.reach, k] = _NUDGE
    moved = (x[None] + nudges[:, None]).reshape(-1, K)
    found = problem.evaluate(pilot, np.tile(rows, voyages), moved)[0]
    found = np.moveaxis(found.reshape(*found.shape[:2], voyages, m), 2, 0)
    return found[0], (found[1:] - found[0]) / _NUDGE
