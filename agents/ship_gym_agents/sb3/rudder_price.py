"""What the rudder moves in training, and a price on it that finds itself.

A price alone has to be guessed for each task. With a limit it is a Lagrange multiplier: after every
rollout ``price <- max(0, price + rate (travel / limit - 1))``, so it settles where the travel is at
the limit, or at zero where the policy travels less of its own accord.
"""

from __future__ import annotations

import numpy as np

from ship_gym.tasks.measures import DEAD_BAND_DEG
from ship_gym_agents.sb3.sections import Price

_LEAST = 10_000  # intervals of ships between two changes of the price: fewer are noise


class RudderMeter:
    """Travel and reversals of the rudders of a batch, interval by interval.

    As ``ship_gym.tasks.measures`` has them of a whole trajectory.

    Parameters
    ----------
    count : int
        Ships.
    """

    def __init__(self, count: int):
        self._angle, self._direction = np.zeros(count), np.zeros(count, dtype=np.int64)
        self._low, self._high = np.zeros(count), np.zeros(count)

    def restart(self, rows: np.ndarray, angle: np.ndarray) -> None:
        """These rows, indices or a mask, begin with rudder angles [deg]."""
        self._angle[rows] = self._low[rows] = self._high[rows] = angle
        self._direction[rows] = 0

    def __call__(self, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Travel [deg] and reversals (0 or 1) since the last call, shapes (count,)."""
        travel = np.abs(angle - self._angle)
        self._angle = angle.copy()
        low, high = np.minimum(self._low, angle), np.maximum(self._high, angle)
        before = self._direction
        up = (before <= 0) & (angle - low > DEAD_BAND_DEG)
        down = ~up & (before >= 0) & (high - angle > DEAD_BAND_DEG)
        self._high, self._low = np.where(up, angle, high), np.where(down, angle, low)
        self._direction = np.where(up, 1, np.where(down, -1, before))
        return travel, (up & (before < 0)) | (down & (before > 0))


class RudderPrice:
    """The price of travel and reversals, and what has been travelled since it last changed.

    Parameters
    ----------
    price : Price
    interval : float
        Control interval [full-scale s].

    Attributes
    ----------
    travel_price : float
        Reward for a degree now: the multiplier.
    limit : float
        Travel to keep below [deg/h]; 0: none, or not yet known.
    travel : float
        Travel of the last rollouts that were counted [deg/h].
    """

    def __init__(self, price: Price, interval: float):
        self.config, self._interval = price, interval
        self.travel_price = price.travel
        self.limit = 0.0 if price.limit in ("", "base") else float(price.limit)
        self.travel = 0.0
        self._degrees, self._intervals = 0.0, 0

    @property
    def waits_for_limit(self) -> bool:
        """Whether the limit is that of the base, which has not been measured."""
        return self.config.limit == "base" and self.limit == 0.0

    def cost(self, travel: np.ndarray, reversals: np.ndarray, live: np.ndarray) -> np.ndarray:
        """Reward to subtract; only rows that are `live` count, shape (count,)."""
        self._degrees += float(travel[live].sum())
        self._intervals += int(np.count_nonzero(live))
        return self.travel_price * travel + self.config.reversals * reversals

    def update(self) -> bool:
        """After a rollout: whether it was long enough to tell the travel and change the price."""
        if self._intervals < _LEAST:
            return False
        self.travel = self.rate_so_far()
        if self.limit:
            change = self.config.rate * (self.travel / self.limit - 1.0)
            self.travel_price = max(0.0, self.travel_price + change)
        self.forget()
        return True

    def rate_so_far(self) -> float:
        """Travel since the last change of the price [deg/h]."""
        return self._degrees / (max(1, self._intervals) * self._interval / 3600.0)

    def forget(self) -> None:
        """Begin to count anew."""
        self._degrees, self._intervals = 0.0, 0

    def state(self) -> dict[str, float]:
        """What a checkpoint keeps."""
        return {name: getattr(self, name) for name in ("travel_price", "limit", "travel")}

    def restore(self, state: dict[str, float]) -> None:
        """Put back what `state` gave."""
        for name, value in state.items():
            setattr(self, name, value)
