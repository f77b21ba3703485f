"""What heading autopilots have in common; each adds its own rudder law.

Order of work in `Autopilot.act`. `perceive`: did the order change (module ``reference``), what of
the measured motion counts (``wave_filter``), which heading is wanted. `steer`: which heading to be
at now (``reference``), rudder angle. A learned guidance may stand between the two.
"""

from __future__ import annotations

import dataclasses
import math
from typing import Any, ClassVar, NamedTuple

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.conventions import wrap_angle
from ship_gym.evaluation.controller import ConstantController
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship
from ship_gym.tasks.columns import View, action_columns, observation_columns
from ship_gym_agents.gains_files import find_gains, find_tuned
from ship_gym_agents.reference import OrderWatch, ReferenceModel
from ship_gym_agents.wave_filter import Observer


class Perceived(NamedTuple):
    """What an autopilot makes of one measurement; arrays of shape (count,).

    Attributes
    ----------
    seen : View
        The observations.
    jump : numpy.ndarray
        By how much headings less ordered heading jumped, because the order changed [rad].
    motion : tuple
        psi less ordered heading [rad], r', v' and rudder bias [rad], filtered.
    wanted : numpy.ndarray
        Wanted heading less ordered heading [rad].
    """

    seen: View
    jump: np.ndarray
    motion: tuple
    wanted: np.ndarray


class Autopilot:
    """A rudder law on filtered motion; batch first. With rpm control: self-propulsion.

    Parameters
    ----------
    gains : dataclass, optional
        With `wave_filter`, `observer` and `reference`, each of which may be None. If omitted, the
        tuned gains of the ship, for the task if it has such, or those that tuning would begin at
        where there are none.
    name : str

    Attributes
    ----------
    KIND : str
        Name in files of gains.
    TUNED : dict
        Gain, by its dotted name, to lowest, highest and first value of a tuning.
    lent_by : Ship or None
        The ship whose tuned gains steer, whatever ship sails; None: her own or those given.
    own_model : bool
        Whether lent gains come without the linear model of the ship that lends them: filter, and
        with lqg the regulator, are those of the ship that sails, linearised.
    filter_noise : float
        Noise of the ship's own motion that the observer assumes, by that of the gains; 1 unless
        set before `reset`. Below 1 more of the measured motion is taken for waves.
    followed : tuple
        Heading less ordered heading [rad], r', v' and rudder angle [rad] that the last `steer`
        led to: those of the reference model, without one the wanted heading and zeros.
    """

    KIND: ClassVar[str]
    TUNED: ClassVar[dict[str, tuple[float, float, float | None]]] = {}
    # of the observation
    needs: ClassVar[tuple[str, ...]] = ("sin_error", "cos_error", "yaw_rate", "sway", "rudder")

    def __init__(self, gains: Any = None, name: str = ""):
        self.gains, self.name, self._source = gains, name or self.KIND, "of the ship"
        self.lent_by: Ship | None = None
        self.own_model = False
        self.filter_noise = 1.0

    def reset(self, count: int, ship: Ship, scenario: Scenario) -> None:
        """Forget everything; `count` episodes of `scenario` with `ship` begin together.

        Raises
        ------
        ConfigError
            The observation of the scenario lacks what the controller needs.
        """
        self._columns = observation_columns(scenario).require(self.needs, f"controller {self.name}")
        self._rudder_column = action_columns(scenario)["rudder"]
        self._g = g = self._gains_for(ship, scenario.task)
        self._limit = ship.gear.delta_max
        # control interval over L / U0
        self._step = scenario.control_interval / ship.time_unit * ship.speed / ship.hull.L
        # largest rudder change in an interval [rad]
        self._stroke = ship.gear.rate * scenario.control_interval / ship.time_unit
        self._watch = OrderWatch(self._step)
        chosen = g.wave_filter
        if self.filter_noise != 1.0:
            chosen = self._calmer(chosen)
        self._filter = _as_measured if chosen is None else chosen.start(count, self._step)
        self._reference = None
        if g.reference is not None:
            linear = None if g.observer is None else g.observer.ship
            self._reference = ReferenceModel(g.reference, self._step, linear)
        steady = ConstantController()
        steady.reset(count, ship, scenario)
        self._action = np.array(steady.act(np.empty((count, 0))))

    def act(self, observations: np.ndarray) -> np.ndarray:
        """Actions in [-1, 1], shape (count, n_actions), for observations of the scenario."""
        return self.steer(self.perceive(observations))

    def restart(self, rows: np.ndarray) -> None:
        """Begin new episodes in these rows with the next observations, the others sail on.

        From then on such a row is steered as by a controller that was reset then.

        Parameters
        ----------
        rows : numpy.ndarray
            Indices, or a mask of shape (count,).
        """
        part: Any
        for part in (self._watch, self._filter, self._reference):
            if hasattr(part, "restart"):
                part.restart(rows)

    def perceive(self, observations: np.ndarray) -> Perceived:
        """Take one measurement; once an interval, before `steer`."""
        seen = self._columns.view(observations)
        measured = np.arctan2(seen.sin_error, seen.cos_error)
        jump = self._watch(measured, seen.yaw_rate)
        delta = self._felt(seen, seen.rudder * self._limit)
        motion = self._filter(measured, seen.yaw_rate, seen.sway, delta, jump)
        return Perceived(seen, jump, motion, self._wanted(seen, jump))

    def steer(self, perceived: Perceived, offset: np.ndarray | None = None) -> np.ndarray:
        """Actions in [-1, 1], shape (count, n_actions), for what was perceived in this interval.

        Parameters
        ----------
        perceived : Perceived
        offset : numpy.ndarray, optional
            Added to the wanted heading [rad], shape (count,).
        """
        seen, jump, motion, aim = perceived
        aim = aim if offset is None else aim + offset
        wanted = aim, 0.0, 0.0, 0.0
        if self._reference is not None:
            wanted = self._reference(aim, motion[0], jump)
        self.followed = wanted
        delta = self._rudder(seen, motion, wanted)
        action = self._action.copy()
        action[:, self._rudder_column] = np.clip(delta / self._limit, -1.0, 1.0)
        return action

    @classmethod
    def first_gains(cls, ship: Ship) -> Any:
        """Gains that tuning begins at; the annotation of the result says what gains are."""
        raise NotImplementedError(f"{cls.__name__} has no gains: define first_gains")

    def about(self) -> dict[str, Any]:
        """What stands beside results: kind of controller and where its gains are from."""
        return {"kind": "classical", "gains": self._source}

    @property
    def gains_given(self) -> bool:
        """Whether the same gains steer in every task and ship."""
        return self.lent_by is None and self.gains is not None

    @classmethod
    def gains_for(cls, ship: Ship, task: str | None = None) -> Any:
        """The tuned gains of a ship (and task), else those that tuning would begin at."""
        found = find_tuned(ship, cls, task)
        return cls.first_gains(ship) if found is None else found.gains

    def _gains_for(self, ship: Ship, task: str) -> Any:
        if self.gains_given:
            self._source = "given"
            return self.gains
        sailing, ship = ship, self.lent_by or ship
        path = find_gains(ship.name, self.KIND, task)
        self._source = "first gains, not tuned" if path is None else path.name
        gains = self.gains_for(ship, task)
        if not self.own_model:
            return gains
        self._source += f", on the linear model of {sailing.name}"
        return with_model_of(sailing, gains, self.name)

    def _calmer(self, chosen: Any) -> Observer:
        """The observer of the gains with `filter_noise` times the noise of the ship's motion."""
        if not isinstance(chosen, Observer):
            raise ConfigError(
                f"filter_noise = {self.filter_noise}: controller {self.name} has no observer here; "
                "allowed is 1"
            )
        return dataclasses.replace(
            chosen,
            sway_noise=self.filter_noise * chosen.sway_noise,
            yaw_noise=self.filter_noise * chosen.yaw_noise,
        )

    def _felt(self, seen: View, delta: np.ndarray) -> np.ndarray:
        """Rudder angle [rad] as the observer's ship would feel that achieved, shape (count,)."""
        return delta

    def _wanted(self, seen: View, jump: np.ndarray) -> np.ndarray:
        """Wanted heading less ordered heading [rad], shape (count,)."""
        return np.zeros(len(seen))

    def _rudder(self, seen: View, motion, wanted) -> np.ndarray:
        """Rudder angle [rad] that may exceed the largest, shape (count,).

        Parameters
        ----------
        seen : View
            The observations.
        motion : tuple
            psi [rad], r', v' and rudder bias [rad].
        wanted : tuple
            Those of the reference, and its rudder angle [rad].
        """
        raise NotImplementedError(f"{type(self).__name__} has no rudder law: define _rudder")


def with_model_of(ship: Ship, gains: Any, name: str) -> Any:
    """Gains whose observer has the linear model of a ship; all else stays.

    Raises
    ------
    ConfigError
        They have no observer.
    """
    if hasattr(gains, "pid"):
        return dataclasses.replace(gains, pid=with_model_of(ship, gains.pid, name))
    if getattr(gains, "observer", None) is None:
        raise ConfigError(f"controller {name}: its gains have no observer, so no linear model")
    model = Observer.first(ship).ship
    return dataclasses.replace(gains, observer=dataclasses.replace(gains.observer, ship=model))


def wrapped(angle: np.ndarray) -> np.ndarray:
    """Angles in [-pi, pi), untouched where they are.

    Wrapping rounds, and a mirrored error shall give the mirrored rudder.
    """
    return np.where(np.abs(angle) > math.pi, wrap_angle(angle), angle)


def _as_measured(psi, r, v, delta, jump):
    """No filter: psi [rad], r', v' as they are measured, and no bias."""
    return psi, r, v, 0.0
