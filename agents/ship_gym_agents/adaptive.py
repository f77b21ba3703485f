"""Adaptive PID: gains scheduled by speed and propeller, and a yaw model estimated on the way.

Both say how much the rudder does now. Scheduling: the yaw acceleration by rudder angle of the
linearised ship at the present speed through the water and propeller speed, over that at the
nominal ones; so a thrust loss is known at once. Estimation: recursive least squares with
forgetting of Nomoto's first-order model with the measured sway beside it,
``dr'/dt' - N_v v' = -a r' + k delta + c``, on low-passed signals, pulled towards the linear ship as
long as the rudder moves little (`trust`), and bounded. The PID steers the nominal ship: its rudder
angle is turned into the one that gives this ship the same yaw acceleration.
"""

from __future__ import annotations

import dataclasses
from typing import Any, ClassVar

import numpy as np

from ship_gym.linear import LinearShip
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship
from ship_gym.tasks.columns import View
from ship_gym_agents.fresh import Fresh, begun
from ship_gym_agents.gains_files import find_gains
from ship_gym_agents.pid import PID, Gains, gains_of
from ship_gym_agents.reference import TUNED_TURN
from ship_gym_agents.rudder_effect import RudderEffect
from ship_gym_agents.wave_filter import check_gains

_BOUNDS = (0.5, 2.0)  # of the estimated a and k, by the nominal
_HELMSMAN = ("K_p", "K_d", "K_v", "K_b")
_ADAPTATION = {
    "schedule": (0.0, 1.5, 1.0),
    "learning": (0.0, 1.5, 1.0),
    "memory": (5.0, 200.0, 30.0),
    "filter_time": (0.1, 3.0, 0.5),
    "trust": (1e-2, 100.0, 0.5),
}


@dataclasses.dataclass(frozen=True)
class AdaptiveGains:
    """Gains of the PID and how it adapts; numbers, or arrays of shape (count,).

    Attributes
    ----------
    pid : Gains
        Of the nominal ship, with an observer.
    schedule : float
        Exponent on the effect of the rudder by speed and propeller; 0: not scheduled.
    learning : float
        Exponent on the estimated effect; 0: not estimated.
    memory : float
        Time constant of forgetting [L / U0].
    filter_time : float
        Time constant of the low pass of the signals [L / U0].
    trust : float
        How firmly the linear ship is held to: the estimate counts half as much as it where the
        sum of the squares of the filtered signals over the memory is this [rad2 L / U0].
    """

    pid: Gains
    schedule: float = 1.0
    learning: float = 1.0
    memory: float = 30.0
    filter_time: float = 0.5
    trust: float = 0.5

    def __post_init__(self):
        check_gains("gains", self, positive=("memory", "filter_time", "trust"))


class Adaptive(PID):
    """PID that adapts to speed, thrust and ship, see the module.

    Parameters
    ----------
    gains : AdaptiveGains, optional
        The tuned gains of the ship if omitted; without any, `first_gains`.
    name : str
    """

    KIND = "adaptive"
    needs = (*PID.needs, "surge", "propeller")
    TUNED: ClassVar = {
        **{f"pid.{name}": (*PID.TUNED[name][:2], None) for name in _HELMSMAN},
        **{f"pid.{name}": PID.TUNED[name] for name in ("error_limit", *TUNED_TURN)},
        **_ADAPTATION,
    }

    def __init__(self, gains: AdaptiveGains | None = None, name: str = "adaptive"):
        own: Any = gains  # which hold those of a PID
        super().__init__(own, name)

    @classmethod
    def first_gains(cls, ship: Ship) -> AdaptiveGains:  # type: ignore[override]
        """Those of the tuned PID of the ship, or those that its tuning begins at."""
        tuned = PID.first_gains(ship) if find_gains(ship.name) is None else gains_of(ship)
        return AdaptiveGains(tuned if tuned.observer is not None else PID.first_gains(ship))

    @classmethod
    def gains_for(  # type: ignore[override]
        cls, ship: Ship, task: str | None = None
    ) -> AdaptiveGains:
        """The tuned gains of a ship (and task), else those that tuning would begin at."""
        return super(PID, cls).gains_for(ship, task)

    @classmethod
    def structures(  # type: ignore[override]
        cls, ship: Ship
    ) -> dict[str, tuple[AdaptiveGains, tuple[str, ...]]]:
        """Scheduled only, then with the estimate too."""
        first = cls.first_gains(ship)
        feedback = tuple(f"pid.{name}" for name in _HELMSMAN)
        return {
            "schedule": (dataclasses.replace(first, learning=0.0), (*feedback, "schedule")),
            "schedule and estimate": (first, (*feedback, *_ADAPTATION)),
        }

    @classmethod
    def course_structures(  # type: ignore[override]
        cls, ship: Ship
    ) -> dict[str, tuple[AdaptiveGains, tuple[str, ...]]]:
        """Those of the PID around the adaptation that there is."""
        gains = Adaptive.gains_for(ship)
        return {
            name: (
                dataclasses.replace(
                    gains, pid=dataclasses.replace(gains.pid, reference=made.reference)
                ),
                (*(f"pid.{one}" for one in free), "schedule"),
            )
            for name, (made, free) in PID.course_structures(ship).items()
        }

    def reset(self, count: int, ship: Ship, scenario: Scenario) -> None:
        """Begin as the nominal ship; `count` episodes of `scenario` with `ship` begin together."""
        super().reset(count, ship, scenario)
        self._schedule = RudderEffect(ship, self._step)
        a = self._a
        self._estimate = YawEstimate(
            a.pid.observer.ship, count, self._step, a.memory, a.filter_time, a.trust
        )
        self._effect = np.ones(count)

    def restart(self, rows: np.ndarray) -> None:
        """Begin as the nominal ship in these rows; see `Autopilot.restart`."""
        super().restart(rows)
        self._schedule.restart(rows)
        self._estimate.restart(rows)

    def _gains_for(self, ship: Ship, task: str) -> Gains:
        self._a = super(PID, self)._gains_for(ship, task)
        return self._a.pid

    def _felt(self, seen: View, delta: np.ndarray) -> np.ndarray:
        """Rudder angle [rad] at which the nominal ship would turn as this one does."""
        scheduled = self._schedule(seen) ** self._a.schedule
        k, a = self._estimate(seen.yaw_rate, seen.sway, delta * scheduled)
        self._effect = scheduled * k**self._a.learning
        # what a ship of more damping than the nominal one turns less, as rudder angle
        self._damping = (a - 1.0) * self._a.learning * self._estimate.damping
        self._most = self._limit * self._effect
        return delta * self._effect - self._damping * seen.yaw_rate

    def _rudder(self, seen: View, motion, wanted) -> np.ndarray:
        """Rudder angle [rad] that may exceed the largest."""
        nominal = super()._rudder(seen, motion, wanted)
        return (nominal + self._damping * motion[1]) / self._effect


class YawEstimate:
    """a and k of the yaw model, by those of the linear ship, from r', v' and rudder.

    Parameters
    ----------
    ship : LinearShip
    count : int
    step : float
        Control interval over L / U0.
    memory, filter_time, trust : float or numpy.ndarray
        As in `AdaptiveGains`.

    Attributes
    ----------
    damping : float
        Nominal a by nominal k [rad].
    """

    def __init__(self, ship: LinearShip, count: int, step: float, memory, filter_time, trust):
        self._ship, self._time = ship, np.asarray(filter_time)
        self._share = 1.0 - np.exp(-step / self._time)
        self._kept = np.broadcast_to(np.exp(-step / np.asarray(memory)), count)[:, None, None]
        self._step = step
        self._nominal = np.array([-ship.N_r, ship.N_delta, 0.0])
        self.damping = -ship.N_r / ship.N_delta
        # one square on the scale of each unknown; a steady moment is not held to zero
        firm = np.broadcast_to(np.asarray(trust, dtype=float), count)
        self._prior = firm[:, None, None] * np.diag([1.0, 1.0, 1e-3])
        self._information = np.zeros((count, 3, 3))
        self._seen = np.zeros((count, 3))
        self._filtered: np.ndarray | None = None
        self._fresh = Fresh()

    def restart(self, rows: np.ndarray) -> None:
        """Begin as the nominal ship in these rows."""
        self._information[rows], self._seen[rows] = 0.0, 0.0
        self._fresh.add(rows)

    def __call__(self, r, v, delta) -> tuple[np.ndarray, np.ndarray]:
        """Estimated k and a by the nominal ones, shapes (count,); from one measurement."""
        now = np.stack([r, v, delta])
        before = begun(self._filtered, self._fresh.take(), now)
        change = now - before
        self._filtered = filtered = before + self._share * change
        r_f, v_f, delta_f = filtered
        # (1 - filter) / time: the derivative of the filtered yaw rate
        known = (1.0 - self._share) * change[0] / self._time - self._ship.N_v * v_f
        regressors = np.stack([-r_f, delta_f, np.ones(len(r_f))], axis=1)
        missed = known - (regressors[:, 0] * self._nominal[0] + regressors[:, 1] * self._nominal[1])
        squares = regressors[:, :, None] * regressors[:, None, :]
        self._information = self._kept * self._information + self._step * squares
        self._seen = self._kept[:, :, 0] * self._seen
        self._seen = self._seen + self._step * regressors * missed[:, None]
        found = np.linalg.solve(self._information + self._prior, self._seen[:, :, None])[:, :, 0]
        a, k = (1.0 + found[:, i] / self._nominal[i] for i in (0, 1))
        sound = np.isfinite(a) & np.isfinite(k)
        low, high = _BOUNDS
        return (
            np.where(sound, np.clip(k, low, high), 1.0),
            np.where(sound, np.clip(a, low, high), 1.0),
        )
