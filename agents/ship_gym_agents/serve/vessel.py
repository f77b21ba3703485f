"""`SteeredShip`: one ship in a heading scenario, steered by orders instead of by a policy alone."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium.utils import seeding

from ship_gym.config import ConfigError, check_number
from ship_gym.conventions import wrap_angle
from ship_gym.envs.env import resolved_scenario
from ship_gym.envs.episodes import EpisodeBatch
from ship_gym.evaluation.controller import ConstantController, Controller
from ship_gym.evaluation.guard import Guarded
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Ship
from ship_gym.tasks.columns import action_columns, observation_columns
from ship_gym_agents.serve.instruments import Seen, seen
from ship_gym_agents.serve.orders import HEADING, RUDDER, Order

TASK = "heading_keeping"
_LONGEST = 1e6  # full-scale seconds that a scenario may take
_INTERVALS = 0.05, 60.0  # full-scale seconds, as a scenario takes them
_ONE = np.array([0])


class SteeredShip:
    """A ship that holds the heading she starts with until an order comes.

    Parameters
    ----------
    controller : Controller
        Keeps a heading that was ordered.
    scenario : str, mapping or Scenario
        Of the task `heading_keeping`: sea, sensors, randomisation, failures.
    ship, control, overrides
        As in ``ShipEnv``.
    seed : int
        Of sea, noise and what else is drawn.
    heading : float
        At the start, and ordered until an order comes [rad].
    interval : float, optional
        Between two orders [s]; default: that of the scenario.
    duration : float, optional
        Of the voyage [s]; without it as long as a scenario can be.
    position : tuple of float
        North and east at the start [m].

    Attributes
    ----------
    batch : EpisodeBatch
    steps : int
        Intervals of the voyage.
    order : Order
        That holds now.
    """

    def __init__(
        self,
        controller: Controller,
        scenario: str | Mapping[str, Any] | Scenario = "heading_calm",
        *,
        ship: str | Ship | None = None,
        control: str | None = None,
        overrides: Mapping[str, Any] | None = None,
        seed: int = 0,
        heading: float = 0.0,
        interval: float | None = None,
        duration: float | None = None,
        position: tuple[float, float] = (0.0, 0.0),
    ):
        given = {"scenario": scenario, "ship": ship, "control": control}
        self.scenario, made = _scenario(given, dict(overrides or {}), interval, duration)
        self.seed, self.steps = seed, self.scenario.steps
        self.batch = EpisodeBatch(1, self.scenario, made, parallel=False)
        self.ship, self.interval = self.batch.ship, float(self.batch.dt[0])
        self._columns = observation_columns(self.scenario)
        self._rudder = action_columns(self.scenario)["rudder"]
        steady = ConstantController()
        steady.reset(1, self.ship, self.scenario)
        self._action = np.array(steady.act(np.empty((1, 0))), dtype=np.float64)
        self._pilot = Guarded(controller, [seed])
        self.name = controller.name
        self.order = Order(HEADING, heading)
        self._begin(position)
        self.batch.compile()  # now, and not while a clock runs
        self._pilot.reset(1, self.ship, self.scenario)

    def _begin(self, position: tuple[float, float]) -> None:
        draws = seeding.np_random(self.seed)[0].random((1, self.batch.n_draws))
        draws[0, 0] = 0.5 + 0.5 * wrap_angle(self.order.angle) / math.pi  # the ordered heading
        start = {"position": np.array([position]), "heading_error_deg": np.zeros(1)}
        self.batch.start(_ONE, draws, start)
        self._command(self.order.angle)

    def seen(self) -> Seen:
        """What her instruments show."""
        return seen(self.batch, self._columns)

    def obey(self, order: Order) -> None:
        """Steer by an order from now on; a heading after a rudder order begins anew."""
        if order.what == HEADING:
            if self.order.what == RUDDER:
                self._pilot.reset(1, self.ship, self.scenario)
            self._command(order.angle)
        self.order = order

    def _command(self, heading: float) -> None:
        self.batch.tasks["psi_ordered"] = wrap_angle(heading)
        self.batch.observe()

    def sail(self) -> None:
        """Sail one interval.

        Raises
        ------
        ControllerFailed
            The controller of headings did what it must not.
        ConfigError
            The ship is none any more.
        """
        delta_max = self.ship.gear.delta_max
        if self.order.what == HEADING:
            action = np.array(self._pilot.act(self.batch.observations), dtype=np.float64)
            most = min(self.order.limit / delta_max, 1.0)
            action[0, self._rudder] = np.clip(action[0, self._rudder], -most, most)
        else:
            action = self._action.copy()
            action[0, self._rudder] = np.clip(self.order.angle / delta_max, -1.0, 1.0)
        self.batch.step(action)
        if self.batch.terminated[0]:
            outcome = self.batch.task.all_outcomes[int(self.batch.outcomes[0])].name
            raise ConfigError(f"the voyage ends after {self.batch.sim.time[0]:.1f} s: {outcome}")


def _scenario(
    given: Mapping[str, Any],
    overrides: dict[str, Any],
    interval: float | None,
    duration: float | None,
) -> tuple[Scenario, Ship]:
    """The scenario with the times of the ship herself, which are full-scale in it, and the ship."""
    names: dict[str, Any] = {"surrogate": None, "privileged": None}
    scenario, ship = resolved_scenario(**given, **names, overrides=overrides)
    if scenario.task != TASK:
        raise ConfigError(f"scenario {given['scenario']}: is of task {scenario.task}, not {TASK}")
    ship = ship or load_ship(scenario.ship, surrogate=scenario.surrogate)
    unit = ship.time_unit
    step = scenario.control_interval
    if interval is not None:
        low, high = (limit / unit for limit in _INTERVALS)
        check_number("interval", interval, low * (1.0 - 1e-9), high, "s")
        step = interval * unit
    longest = int(_LONGEST / step)
    steps = longest if duration is None else max(1, math.ceil(duration * unit / step - 1e-9))
    if steps > longest:
        raise ConfigError(f"duration = {duration:g}: allowed are up to {longest * step / unit:g} s")
    overrides |= {"control_interval": step, "duration": steps * step}
    overrides |= {"limits.heading_error_deg": 180.0, "start.heading_error_deg": 0.0}
    scenario, object_ = resolved_scenario(**given, **names, overrides=overrides)
    return scenario, object_ or ship
