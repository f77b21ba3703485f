"""Residuals of a task: what Gauss-Newton squares and makes small, for every interval and episode.

Their squares add up to the cost of an episode, a mean over its planned intervals; the scores that
policies are chosen by are another thing. The rudder's movement counts by its angle, not by its
square: what is wanted is less travel, whatever the size of the strokes.
"""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.conventions import DELTA, FLOW_TORQUE, PSI, N, U, X, Y, wrap_angle
from ship_gym.envs.episodes import EpisodeBatch
from ship_gym.physics.propeller import shaft_power
from ship_gym.ships.particulars import Ship
from ship_gym.simulation import ShipSim, self_propulsion
from ship_gym.tasks.measures import TURN
from ship_gym.tracks.guidance import share_left
from ship_gym_agents.sb3.options import GaussNewtonOptions
from ship_gym_agents.tuning.objective import objective_of

LAMBDA = 0.1  # of J, weight of the squared rudder angle
_SMALL = 0.3  # rudder movement below which its price is that of its square [deg]
_SLACK = 0.02  # share of the time of a voyage in which an arrival is late already
_LATE = 10.0  # of the share by which it is late: 1 % of the time weighs as 1 % of the energy
_HOLD = 6e-4  # courses: weight of the squared rudder angle [deg2], by band squared


class Residuals:
    """What the tasks have in common: the rudder's movement, episodes that have ended.

    Call `begin` before and `end` after each interval of the batch.

    Parameters
    ----------
    batch : EpisodeBatch
    options : GaussNewtonOptions

    Attributes
    ----------
    PARTS : int
        Residuals of an interval.
    """

    PARTS: ClassVar[int]

    def __init__(self, batch: EpisodeBatch, options: GaussNewtonOptions):
        self._batch, self._options = batch, options
        self._failing = np.array([outcome.failed for outcome in batch.task.all_outcomes])
        self.sailing = np.ones(batch.n, dtype=np.bool_)
        self._failed = np.zeros(batch.n, dtype=np.bool_)

    @property
    def price_of_travel(self) -> float:
        """What a policy is chosen by, beside the score of its task [unit of the score h/deg].

        That of tuning, so that learned and classical controllers are chosen alike.
        """
        return objective_of(self._batch.scenario.task).price

    def begin(self) -> None:
        """Keep what the interval is judged by."""
        self._delta = self._batch.sim.state[:, DELTA].copy()

    def end(self) -> np.ndarray:
        """Residuals of the interval, shape (PARTS, n): zero once an episode has ended well."""
        batch = self._batch
        moved = np.degrees(batch.sim.state[:, DELTA] - self._delta)
        parts = np.stack([*self._of_task(), movement(moved, self._options.price)])
        worst = np.append(self._worst(), 0.0)[:, None]
        # the interval in which an episode ends counts as it was; a diverged ship has no numbers
        found = np.where(self.sailing, np.nan_to_num(parts), np.where(self._failed, worst, 0.0))
        ended = self.sailing & (batch.terminated | batch.truncated)
        self._failed |= ended & batch.terminated & self._failing[batch.outcomes]
        self.sailing = self.sailing & ~ended
        return found

    def _of_task(self) -> tuple[np.ndarray, ...]:
        """Residuals of the interval but for the movement, each of shape (n,)."""
        raise NotImplementedError

    def _worst(self) -> tuple[float, ...]:
        """The same in the intervals that an episode does not sail since it has failed."""
        raise NotImplementedError


class Heading(Residuals):
    """psi_e and sqrt(lambda) delta [deg]; those of turns with a weight of their own."""

    PARTS = 3

    def __init__(self, batch: EpisodeBatch, options: GaussNewtonOptions):
        super().__init__(batch, options)
        self._since = np.zeros(batch.n)  # the last order [full-scale s]

    @property
    def price_of_travel(self) -> float:
        """As in the cost: J is tuned without a price."""
        return self._options.price * self._batch.scenario.control_interval / 3600.0

    def begin(self) -> None:
        """See `Residuals`."""
        super().begin()
        self._ordered = self._batch.tasks["psi_ordered"].copy()

    def _of_task(self) -> tuple[np.ndarray, ...]:
        share = np.sqrt(np.where(self._since < TURN, self._options.turn, 1.0))
        delta = np.degrees(self._batch.sim.state[:, DELTA])
        found = share * self._error(), share * math.sqrt(LAMBDA) * delta
        self._take_orders()
        return found

    def _error(self) -> np.ndarray:
        """Heading error by the order that held in the interval [deg]."""
        return np.degrees(wrap_angle(self._batch.sim.state[:, PSI] - self._ordered))

    def _take_orders(self) -> np.ndarray:
        """Let the time since the last order go on; whose order is new."""
        new = self._batch.tasks["psi_ordered"] != self._ordered
        self._since = np.where(new, 0.0, self._since + self._batch.scenario.control_interval)
        return new

    def _worst(self) -> tuple[float, ...]:
        limit = self._batch.scenario.limits.heading_error_deg
        hard_over = max(math.degrees(ship.gear.delta_max) for ship in self._batch.fleet)
        return limit, math.sqrt(LAMBDA) * hard_over


class Course(Heading):
    """Steps of the order: how long the error is more than `band` deg, and how far beyond the order.

    The error counts as ``band tanh(psi_e / band)``, so a turn costs by its time and not by its
    size. What is beyond a new order on the other side than the ship came from counts once more,
    with the weight `overshoot`.
    """

    PARTS = 4
    price_of_travel = Residuals.price_of_travel

    def __init__(self, batch: EpisodeBatch, options: GaussNewtonOptions):
        super().__init__(batch, options)
        self._side = np.zeros(batch.n)  # of the new order, from which the ship came
        self._since += TURN  # the order that holds at first is no step

    def _of_task(self) -> tuple[np.ndarray, ...]:
        batch, options, error = self._batch, self._options, self._error()
        beyond = np.where(self._since < TURN, np.maximum(-self._side * error, 0.0), 0.0)
        left = wrap_angle(batch.sim.state[:, PSI] - batch.tasks["psi_ordered"])
        self._side = np.where(self._take_orders(), np.sign(left), self._side)
        return (
            options.band * np.tanh(error / options.band),
            math.sqrt(_HOLD) * options.band * np.degrees(batch.sim.state[:, DELTA]),
            math.sqrt(options.overshoot) * beyond,
        )

    def _worst(self) -> tuple[float, ...]:
        limit, hard_over = super()._worst()
        band = self._options.band
        return band, math.sqrt(_HOLD / LAMBDA) * band * hard_over, limit


class Track(Residuals):
    """Distance to the route [L]."""

    PARTS = 2

    def _of_task(self) -> tuple[np.ndarray, ...]:
        return (self._batch.errors / self._batch.tasks["L"],)

    def _worst(self) -> tuple[float, ...]:
        return (self._batch.scenario.limits.cross_track,)


class Economy(Residuals):
    """Energy of a voyage with a deadline, by that at the power of self-propulsion, and lateness.

    An episode that arrives in the last `_SLACK` of the time, or has not arrived when it is up, is
    late by ``_LATE`` times the share of the time, or of the route that is left beside that slack.
    The metric knows no such slope: who is late has failed.
    """

    PARTS = 3

    def __init__(self, batch: EpisodeBatch, options: GaussNewtonOptions):
        super().__init__(batch, options)
        self._steps = batch.scenario.steps
        self._full = np.array([_power_at_speed(ship) for ship in batch.ships])

    @property
    def price_of_travel(self) -> float:
        """None: the energy counts."""
        return 0.0

    def _of_task(self) -> tuple[np.ndarray, ...]:
        batch = self._batch
        power = np.sqrt(np.maximum(batch.power, 0.0) / self._full)
        return power, math.sqrt(self._steps) * _LATE * self._late()

    def _late(self) -> np.ndarray:
        """Share by which an episode that ends in this interval is late; 0 of the others."""
        batch, late = self._batch, np.zeros(self._batch.n)
        for i in np.flatnonzero(self.sailing & (batch.terminated | batch.truncated)).tolist():
            time = batch.elapsed[i] / self._steps
            leg, at = int(batch.tasks["active"][i]), batch.sim.state[i, [X, Y]]
            left = 0.0 if batch.terminated[i] else share_left(self._route(i), leg, *at)
            late[i] = max(time - (1.0 - _SLACK), 0.0) + left
        return late

    def _route(self, i: int) -> np.ndarray:
        return self._batch.plans[i, : int(self._batch.tasks["count"][i]), :2]

    def _worst(self) -> tuple[float, ...]:
        return 2.0, 0.0  # of an episode that has left the route: four times the power


_OF_HEADLINE: dict[str, type[Residuals]] = {
    "J_steady": Heading,
    "settling_time": Course,
    "rms_route": Track,
}


def residuals_of(batch: EpisodeBatch, options: GaussNewtonOptions) -> Residuals:
    """Residuals of the task of a batch.

    Raises
    ------
    ConfigError
        A task that has none.
    """
    headline = batch.task.headline
    if headline not in _OF_HEADLINE:
        able = ", ".join(_OF_HEADLINE)
        raise ConfigError(
            f"gauss_newton: task {batch.scenario.task!r} has no residuals; allowed are tasks whose "
            f"headline is one of {able}, not {headline!r}"
        )
    found = _OF_HEADLINE[headline]
    if found is Track and batch.scenario.control == "rudder+rpm":
        found = Economy
    return found(batch, options)


def _power_at_speed(ship: Ship) -> float:
    """Power delivered at the propeller at self-propulsion in calm water [W]."""
    one = ShipSim(ship, 1, parallel=False)
    one.state[0, [U, N]] = ship.speed, self_propulsion(ship, ship.speed)
    one.commands[0] = 0.0, one.state[0, N]
    one.set_interval(1.0 / ship.time_unit)
    one.advance()
    return float(shaft_power(one.state[0, N], one.flow[0, FLOW_TORQUE]))


def movement(moved: np.ndarray, price: float) -> np.ndarray:
    """Residual whose square is ``price * (sqrt(moved^2 + small^2) - small)``, moved in deg.

    So large movements cost by their size, small ones by their square (pseudo-Huber loss), and the
    residual itself is smooth.
    """
    size = np.sqrt(moved * moved + _SMALL * _SMALL) - _SMALL
    return np.sign(moved) * np.sqrt(price * size)
