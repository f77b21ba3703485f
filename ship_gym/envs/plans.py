"""What an episode is ordered to do: a heading, steps of it, or a track."""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np

from ship_gym.physics.angles import north_east, wrapped
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship
from ship_gym.tasks import heading, track
from ship_gym.tracks.files import load_track
from ship_gym.tracks.generator import n_draws, random_points
from ship_gym.tracks.shapes import SHAPES


class PlanMaker(Protocol):
    """Makes the plans of episodes.

    Attributes
    ----------
    rows : int
        Rows of a plan.
    n_draws : int
        Uniform numbers for one.
    """

    rows: int
    n_draws: int

    def make(self, which, uniform, order, plans, tasks) -> tuple[np.ndarray, np.ndarray]:
        """Write plans of some episodes.

        Parameters
        ----------
        which : numpy.ndarray
            Indices, shape (m,).
        uniform : numpy.ndarray
            Numbers in [0, 1), shape (m, n_draws).
        order : numpy.ndarray
            First ordered heading or bearing [rad], shape (m,).
        plans : numpy.ndarray
            Written, shape (n, rows, 2).
        tasks : numpy.ndarray
            ``count`` is written.

        Returns
        -------
        north, east : numpy.ndarray
            Where the ships start [m], shape (m,).
        """


def plan_maker(scenario: Scenario, ships: list[Ship]) -> PlanMaker:
    """What makes the plans of a scenario."""
    if not scenario.on_track:
        return Orders(scenario)
    return Tracks(scenario, np.array([ship.hull.L for ship in ships]))


class Orders:
    """One ordered heading, and for course changing steps of it.

    Each step has a size uniform between the two of the section ``course``, a side by chance and a
    time uniform between the two after the one before, in whole control intervals.
    """

    def __init__(self, scenario: Scenario):
        self._course = scenario.course
        self._interval = scenario.control_interval
        self._steps = scenario.course.changes if scenario.task == "course_changing" else 0
        self.rows, self.n_draws = 1 + self._steps, 3 * self._steps

    def make(self, which, uniform, order, plans, tasks):
        """See `PlanMaker`."""
        course = self._course
        tasks["count"][which] = self.rows
        psi, time = order.copy(), np.full(len(which), course.first)
        plans[which, 0, heading.FROM], plans[which, 0, heading.ORDER] = 0.0, psi
        for k in range(self._steps):
            size, side, gap = uniform[:, 3 * k : 3 * k + 3].T
            degrees = course.step_min_deg + (course.step_max_deg - course.step_min_deg) * size
            step = np.where(side < 0.5, -1.0, 1.0) * degrees * (math.pi / 180.0)
            psi = np.array([wrapped(a) for a in (psi + step).tolist()])
            plans[which, k + 1, heading.FROM] = np.maximum(np.rint(time / self._interval), 1.0)
            plans[which, k + 1, heading.ORDER] = psi
            time = time + course.interval_min + (course.interval_max - course.interval_min) * gap
        return np.zeros(len(which)), np.zeros(len(which))


class Tracks:
    """Way-points; the ship starts abreast of the first one.

    Random tracks and shapes are in ship lengths and turned to any first bearing; given way-points
    stay where they are.
    """

    def __init__(self, scenario: Scenario, L: np.ndarray):
        self._range, self._L = scenario.track, L
        self._aside = scenario.start.cross_track
        self._points = self._fixed_points()
        random = self._range.kind == "random"
        self._n_random = n_draws(self._range.legs) if random else 0
        self.rows = self._range.legs + 1 if random else len(self._points)
        self.n_draws = 1 + self._n_random

    def _fixed_points(self) -> np.ndarray | None:
        """Way-points that every episode sails, in metres or ship lengths; None: random ones."""
        kind = self._range.kind
        if kind == "random":
            return None
        if kind == "points":
            return load_track(self._range.file or list(self._range.points)).points
        return np.asarray(SHAPES[kind])

    def make(self, which, uniform, order, plans, tasks):
        """See `PlanMaker`."""
        tasks["count"][which] = self.rows
        L, bearing = self._L[which], order
        if self._range.kind == "points":
            plans[which] = self._points
        else:
            track.place_batch(which, self._made(uniform[:, 1:]), bearing, L, plans)
        legs = plans[which, 1] - plans[which, 0]
        bearing = np.array([math.atan2(e, n) for n, e in legs.tolist()])
        aside = self._aside * (2.0 * uniform[:, 0] - 1.0) * L
        north, east = np.zeros(len(which)), np.zeros(len(which))
        north_east(aside, bearing + 0.5 * math.pi, north, east)
        return plans[which, 0, 0] + north, plans[which, 0, 1] + east

    def _made(self, uniform: np.ndarray) -> np.ndarray:
        if self._range.kind != "random":
            return np.broadcast_to(self._points, (len(uniform), *self._points.shape))
        r = self._range
        return random_points(
            uniform,
            turn_radius=r.turn_radius,
            leg_min=r.leg_min,
            leg_max=r.leg_max,
            turn_max=math.radians(r.turn_max_deg),
        )
