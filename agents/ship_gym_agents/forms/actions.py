"""What a decision in [-1, 1] does: four kinds of actions by name.

Each is made for a `Sailing` and asked every interval. Until the first decision of an episode, and
with decision 0 where there is a base, the base steers alone; without one the rudder stays amidships
and the propeller at self-propulsion.
"""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.evaluation.controller import ConstantController
from ship_gym.tasks.columns import action_columns
from ship_gym_agents.forms.look import Look, Sailing


class Action:
    """What the kinds have in common.

    Attributes
    ----------
    largest : float
        Of the scale of its rudder or heading decision.
    on_base : bool
        Whether it needs a classical controller.
    decisions : tuple of str
        What a decision holds.
    """

    largest: ClassVar[float] = 1.0
    on_base: ClassVar[bool] = False
    first: ClassVar[str] = "rudder"

    def __init__(self, sailing: Sailing):
        self._columns, form = action_columns(sailing.scenario), sailing.form
        self._scales = [form.scale]
        with_rpm = self._turns_propeller(form)
        if form.scale_rpm > 0.0 and not with_rpm:
            raise ConfigError(
                f"form.scale_rpm = {form.scale_rpm}: needs control = 'rudder+rpm', not "
                f"{sailing.scenario.control!r}"
            )
        self.decisions: tuple[str, ...] = (self.first, "rpm") if with_rpm else (self.first,)
        self._columns_of_decisions = [self._columns["rudder"]]
        if with_rpm:
            self._scales.append(form.scale_rpm)
            self._columns_of_decisions.append(self._columns["rpm"])

    def _turns_propeller(self, form) -> bool:
        return form.scale_rpm > 0.0 and "rpm" in self._columns

    def act(self, look: Look, decision: np.ndarray | None) -> np.ndarray:
        """Actions (count, n_actions) in [-1, 1]; None: the decision before is held."""
        raise NotImplementedError

    def restart(self, rows: np.ndarray) -> None:
        """Forget the decisions of these rows."""
        raise NotImplementedError


class Direct(Action):
    """The decision is the action."""

    def __init__(self, sailing: Sailing):
        super().__init__(sailing)
        self._order = self._steady = _steady(sailing)

    def _turns_propeller(self, form) -> bool:
        return "rpm" in self._columns

    def act(self, look: Look, decision: np.ndarray | None) -> np.ndarray:
        """See `Action.act`."""
        if decision is not None:
            self._order = self._steady.copy()
            self._order[:, self._columns_of_decisions] = decision
        return self._order.copy()

    def restart(self, rows: np.ndarray) -> None:
        """See `Action.restart`."""
        self._order = self._order.copy()
        self._order[rows] = self._steady[rows]


class Increment(Direct):
    """The decision moves the order on, 1 by as much as the gear moves until the next one."""

    def __init__(self, sailing: Sailing):
        super().__init__(sailing)
        gear, interval = sailing.ship.gear, sailing.scenario.control_interval
        stroke = gear.rate * interval / sailing.ship.time_unit / gear.delta_max
        self._scales[0] *= stroke * sailing.form.every

    def _turns_propeller(self, form) -> bool:
        return Action._turns_propeller(self, form)

    def act(self, look: Look, decision: np.ndarray | None) -> np.ndarray:
        """See `Action.act`."""
        if decision is not None:
            self._order = _added(self._order, self._columns_of_decisions, decision, self._scales)
        return self._order.copy()


class Residual(Action):
    """The decision is added to the action of the base."""

    largest = 2.0  # from hard over to hard over the other way
    on_base = True

    def __init__(self, sailing: Sailing):
        super().__init__(sailing)
        self._held = np.zeros((sailing.count, len(self.decisions)))

    def act(self, look: Look, decision: np.ndarray | None) -> np.ndarray:
        """See `Action.act`."""
        if decision is not None:
            self._held = decision
        assert look.own is not None  # as it is on a base
        return _added(look.own, self._columns_of_decisions, self._held, self._scales)

    def restart(self, rows: np.ndarray) -> None:
        """See `Action.restart`."""
        self._held = self._held.copy()
        self._held[rows] = 0.0


class Guidance(Residual):
    """The decision is added to the heading that the base steers; it steers every interval."""

    largest = math.pi
    first = "heading"

    def act(self, look: Look, decision: np.ndarray | None) -> np.ndarray:
        """See `Action.act`."""
        if decision is not None:
            self._held = decision
        base, perceived = look.steers
        action = base.steer(perceived, self._scales[0] * self._held[:, 0])
        return _added(action, self._columns_of_decisions[1:], self._held[:, 1:], self._scales[1:])


ACTIONS: dict[str, type[Action]] = {
    "direct": Direct,
    "increment": Increment,
    "residual": Residual,
    "guidance": Guidance,
}


def _steady(sailing: Sailing) -> np.ndarray:
    """Rudder amidships at self-propulsion, shape (count, n_actions)."""
    steady = ConstantController()
    steady.reset(sailing.count, sailing.ship, sailing.scenario)
    return np.array(steady.act(np.empty((sailing.count, 0))))


def _added(action: np.ndarray, columns: list[int], decision: np.ndarray, scales: list[float]):
    """The action with the scaled decision on top of some of its columns."""
    action = action.copy()
    for k, (column, scale) in enumerate(zip(columns, scales, strict=True)):
        action[:, column] = np.clip(action[:, column] + scale * decision[:, k], -1.0, 1.0)
    return action
