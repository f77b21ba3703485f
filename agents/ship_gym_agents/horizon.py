"""Prediction of the linear ship over a horizon, and the quadratic program of its cheapest rudder.

The rudder moves evenly in blocks of intervals, short ones first. Motion x is psi, v', r' and rudder
angle; on a track the cross-track error e [L] stands before them, with ``e' = psi + v'`` and what
the path and the water add from outside. What is minimised over N intervals is the sum of

    psi^2 + rudder delta^2 + rate (d delta / dt')^2                          on a heading,
    cross_track e^2 + (psi + v')^2 + rudder delta^2 + rate (d delta / dt')^2   on a track,

and ``x P x`` at the end, the cost from there on without limits (Riccati equation). So a plan that
meets no limit is that of the linear-quadratic regulator.
"""

from __future__ import annotations

import itertools

import numpy as np
from scipy.linalg import block_diag, expm, solve_discrete_are

from ship_gym.linear import LinearShip
from ship_gym_agents.lqg import over_interval

# lengths of the blocks [L / U0], 3.6 together; each is one interval at least
BLOCKS = (0.03, 0.03, 0.03, 0.06, 0.06, 0.1, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.8)


def block_lengths(step: float) -> tuple[int, ...]:
    """Intervals of each block, for intervals of `step` [L / U0]."""
    return tuple(max(1, round(length / step)) for length in BLOCKS)


class Horizon:
    """Matrices of one ship, one set of weights and one interval.

    Parameters
    ----------
    ship : LinearShip
    step : float
        Control interval over L / U0.
    stroke : float
        Largest rudder change in an interval [rad], the unit of the plan.
    rudder, rate : float
        Weights.
    cross_track : float, optional
        Weight on a track; None: on a heading.
    blocks : tuple of int
        Intervals of each block.

    Attributes
    ----------
    N, blocks : int
        Intervals and blocks.
    H : numpy.ndarray
        Of the program ``1/2 w H w + q w``, w = rudder stroke in each block by `stroke`, shape
        (blocks, blocks).
    angles : numpy.ndarray
        Rudder angle at the ends of the blocks, by `stroke`, from w; shape (blocks, blocks).
    """

    def __init__(
        self,
        ship: LinearShip,
        step: float,
        stroke: float,
        rudder: float,
        rate: float,
        cross_track: float | None = None,
        blocks: tuple[int, ...] | None = None,
    ):
        lengths = block_lengths(step) if blocks is None else blocks
        self.N, self.blocks, self.stroke = sum(lengths), len(lengths), stroke
        A, B, Q = _model(ship, step, rudder, cross_track)
        R = rate / step**2
        P = solve_discrete_are(A, B, Q, np.array([[R]]))
        moves = np.repeat(np.eye(self.blocks), lengths, axis=0) * stroke  # (N, blocks)
        m = len(A)
        powers, answers = np.empty((self.N, m, m)), np.empty((self.N, m, self.blocks))
        power, answer = np.eye(m), np.zeros((m, self.blocks))
        for k in range(self.N):
            power, answer = A @ power, A @ answer + B * moves[k]
            powers[k], answers[k] = power, answer
        weights = np.repeat(Q[None], self.N, axis=0)
        weights[-1] = P
        felt = np.einsum("kib,kij->bkj", answers, weights)
        H = np.einsum("bkj,kjc->bc", felt, answers) + R * moves.T @ moves
        # the scale of a cost is free: about 1 suits the solver
        scale = 1.0 / H.diagonal().max()
        self.H = scale * 0.5 * (H + H.T)
        self._by_motion = scale * np.einsum("bkj,kji->bi", felt, powers)
        self._by_aside = scale * felt.reshape(self.blocks, -1)
        ends = list(itertools.accumulate(lengths))
        self.angles = np.cumsum(moves, axis=0)[[end - 1 for end in ends]] / stroke

    def slope(self, x: np.ndarray, aside: np.ndarray | None = None) -> np.ndarray:
        """Q of the program.

        Parameters
        ----------
        x : numpy.ndarray
            Motion now, shape (4,) or on a track (5,).
        aside : numpy.ndarray, optional
            What is added to the motion after each interval from outside, shape (N, 5).
        """
        q = self._by_motion @ x
        return q if aside is None else q + self._by_aside @ aside.ravel()


def _model(ship: LinearShip, step: float, rudder: float, cross_track: float | None):
    """Transition, input column (of the stroke in an interval) and weights of the motion."""
    A, B = over_interval(ship, step)
    Q = np.diag([1.0, 0.0, 0.0, rudder])
    if cross_track is None:
        return A, B, Q
    slopes = np.zeros((6, 6))  # of e, psi, v', r', delta and the stroke
    slopes[0, 1] = slopes[0, 2] = slopes[1, 3] = 1.0
    slopes[2:4, 2:4], slopes[2:4, 4] = ship.A, ship.B
    slopes[4, 5] = 1.0 / step
    held = expm(slopes * step)
    course = np.array([1.0, 1.0])
    Q = block_diag(cross_track, np.outer(course, course), 0.0, rudder)
    return held[:5, :5], held[:5, 5:], Q
