"""Line-of-sight guidance with the estimated drift instead of an integral of the error.

Positions and the speeds through the water tell what the integral of ILOS has to find by error: how
the water, with the leeway of the ship, sets her along and across the leg. The course over ground is
then steered by the crab angle. Lengths are in L, times in L / U0, speeds in U0.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship
from ship_gym.tasks.columns import View
from ship_gym_agents.fresh import Fresh, begun
from ship_gym_agents.los import LOSPID
from ship_gym_agents.pid import Gains

_SLOWEST = 0.3  # speed through the water from which on a crab angle is sensible
_STEEPEST = 0.7  # sine of the largest crab angle
_FASTEST = 2.5  # along a leg over ground; more is a new leg
_FARTHEST, _BEHIND = 49.0, -4.5  # distances to go that are not yet cut off by the observation


class DriftLOS(LOSPID):
    """Steers the course ``-atan(e / look_ahead)`` off the leg over ground, by the estimated drift.

    The drift, over ground less the way of the ship along its heading, is
    ``(-ds/dt - u cos psi, de/dt - u sin psi)`` along and across the leg with the distance to go s,
    smoothed over `drift_time`; it holds the leeway too. The heading of the course chi is
    ``chi - asin(d / u)`` with the drift d across that course. A new leg turns the axes, not the
    drift. Parameters: see `LOSPID`.
    """

    needs = (*LOSPID.needs, "surge", "cross_track_rate")
    KIND: ClassVar[str] = "drift_los"
    TUNED: ClassVar[dict[str, tuple[float, float, float | None]]] = {
        "guidance.drift_time": (0.3, 60.0, None),
        **LOSPID.TUNED,
    }

    def __init__(self, gains: Gains | None = None, name: str = "drift_los"):
        super().__init__(gains, name)

    def reset(self, count: int, ship: Ship, scenario: Scenario) -> None:
        """Forget the drift; `count` episodes of `scenario` with `ship` begin together."""
        super().reset(count, ship, scenario)
        self._drift = np.zeros((2, count))
        self._taken = np.zeros((2, count))  # measurements in it
        self._to_go: np.ndarray | None = None
        self._fresh = Fresh()

    def restart(self, rows: np.ndarray) -> None:
        """Forget the drift of these rows; see `Autopilot.restart`."""
        super().restart(rows)
        self._drift[:, rows], self._taken[:, rows] = 0.0, 0.0
        self._fresh.add(rows)

    @property
    def drift(self) -> np.ndarray:
        """Estimated drift along and across the active leg over U0, shape (2, count)."""
        return self._drift

    def _wanted(self, seen: View, jump: np.ndarray) -> np.ndarray:
        along, across = self._estimate(seen, jump)
        turn, cross = self._leg(seen)
        course = turn - np.arctan(cross / self._g.guidance.look_ahead)
        aside = across * np.cos(course) - along * np.sin(course)
        speed = np.maximum(seen.surge, _SLOWEST)
        return course - np.arcsin(np.clip(aside / speed, -_STEEPEST, _STEEPEST))

    def _estimate(self, seen: View, jump: np.ndarray) -> np.ndarray:
        """Drift along and across the active leg, shape (2, count), one interval on."""
        c, s = np.cos(jump), np.sin(jump)
        along, across = self._drift
        self._drift = np.stack([along * c - across * s, along * s + across * c])
        first = self._fresh.take()
        made = (begun(self._to_go, first, seen.to_go) - seen.to_go) / self._step
        self._to_go = seen.to_go.copy()
        sailed = seen.surge * np.stack([seen.cos_error, seen.sin_error])
        measured = np.stack([made, seen.cross_track_rate]) - sailed
        known = np.ones(measured.shape, dtype=np.bool_)
        known[0] = (jump == 0.0) & (np.abs(made) < _FASTEST)
        known[0, first] = False
        known[0] &= (seen.to_go < _FARTHEST) & (seen.to_go > _BEHIND)
        # the mean of the first measurements, then of the last ones over `drift_time`
        self._taken = self._taken + known
        share = np.maximum(
            self._step / self._g.guidance.drift_time, 1.0 / np.maximum(self._taken, 1.0)
        )
        change = np.minimum(share, 1.0) * (measured - self._drift)
        self._drift = self._drift + np.where(known, change, 0.0)
        return self._drift
