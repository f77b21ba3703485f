"""What a planning autopilot knows of its route: path ahead with the next turn, and the current.

Lengths are in L, times in L / U0, angles from the bearing of the active leg.
"""

from __future__ import annotations

import numpy as np

from ship_gym.tasks.columns import View

_SLOWEST = 0.2  # speed through the water by U0 below which the drift angle is no longer meant
_FASTEST = 2.5  # along a leg over ground by U0; more is a new leg
_FARTHEST, _BEHIND = 49.0, -4.5  # distances to go that the observation does not cut off yet
_LARGEST_DRIFT = 0.8  # current and leeway by the speed through the water


class Current:
    """Current by what the ship makes over ground beyond her way through the water.

    Across the leg from the rate of the cross-track error, along it from the distance to go; low
    pass, a plain mean at first. A new leg turns it into its axes.

    Parameters
    ----------
    count : int
    step : float
        Control interval.
    time : float or numpy.ndarray
        Time constant of the low pass.
    """

    def __init__(self, count: int, step: float, time):
        self._step, self.share = step, 1.0 - np.exp(-step / np.asarray(time))
        self.along, self.across = np.zeros(count), np.zeros(count)
        self._to_go: np.ndarray | None = None
        self._age = 0

    def __call__(self, seen: View, psi: np.ndarray, jump: np.ndarray) -> None:
        """Take one measurement; psi [rad] and `jump` as the autopilot has them, shape (count,)."""
        c, s = np.cos(jump), np.sin(jump)
        along, across = c * self.along - s * self.across, s * self.along + c * self.across
        c, s = np.cos(psi), np.sin(psi)
        self._age += 1
        share = np.maximum(self.share, 1.0 / self._age)
        seen_across = seen.cross_track_rate - (seen.surge * s + seen.sway * c)
        self.across = across + share * (seen_across - across)
        if self._to_go is not None:
            made = (self._to_go - seen.to_go) / self._step
            seen_along = made - (seen.surge * c - seen.sway * s)
            same = (jump == 0.0) & (np.abs(made) < _FASTEST)
            same &= (seen.to_go < _FARTHEST) & (seen.to_go > _BEHIND)
            self.along = along + np.where(same, share * (seen_along - along), 0.0)
        self._to_go = np.array(seen.to_go)


class Path:
    """The active leg, an arc into the next one and that leg, and where the ship is beside them.

    The arc has the radius R and touches both legs; of a sharp turn it begins at the most
    `reach` before the way-point.
    """

    def __init__(self, seen: View, radius, reach: float = np.inf):
        turn = seen.next_turn * np.pi
        self._side, self._turn = np.where(turn < 0.0, -1.0, 1.0), np.abs(turn)
        half = np.tan(0.5 * np.minimum(self._turn, 0.9 * np.pi))
        self._radius = np.minimum(radius, reach / np.maximum(half, 1e-9))
        # seen with the turn to starboard, from the place where the arc begins
        x = self._radius * half - seen.to_go
        y = self._side * seen.cross_track
        inward = self._radius - y
        angle = np.where(x > 0.0, np.arctan2(x, inward), 0.0)
        on_arc = (x > 0.0) & (angle < self._turn)
        # beyond the arc: along the next leg, from where the arc ends
        c, s = np.cos(self._turn), np.sin(self._turn)
        end_x, end_y = self._radius * s, self._radius * (1.0 - c)
        further = c * (x - end_x) + s * (y - end_y)
        beside = -s * (x - end_x) + c * (y - end_y)
        error = np.where(on_arc, self._radius - np.hypot(x, inward), beside)
        error = np.where(x <= 0.0, y, error)
        arc = self._radius * self._turn
        self.way = np.where(on_arc, self._radius * angle, arc + further)
        self.way = np.where(x <= 0.0, x, self.way)
        self.error = self._side * error

    def bearings(self, ahead: np.ndarray) -> np.ndarray:
        """Bearing of the path [rad] some way ahead of the ship, shapes (count, N) both."""
        way = self.way[:, None] + ahead
        turned = np.clip(way / self._radius[:, None], 0.0, self._turn[:, None])
        return self._side[:, None] * turned


def drift_angle(current: Current, bearing, surge, sway):
    """Angle [rad] by which the ship's heading must be less than the path's bearing.

    Parameters
    ----------
    current : Current
    bearing : numpy.ndarray
        Of the path, shape (count, N) [rad].
    surge, sway : numpy.ndarray
        Low-frequency motion through the water over U0, shape (count,).
    """
    across = current.across[:, None] * np.cos(bearing) - current.along[:, None] * np.sin(bearing)
    speed = np.maximum(surge, _SLOWEST)[:, None]
    limit = _LARGEST_DRIFT
    return np.arcsin(np.clip((across + sway[:, None]) / speed, -limit, limit))
