"""EpisodeBatch: n episodes of one scenario, the engine of both environment classes."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from gymnasium.utils import seeding

from ship_gym.config import ConfigError, check_number, shown
from ship_gym.conventions import (
    FLOW_EXTRAPOLATION,
    FLOW_OF_UNITS,
    FORCE_COMPONENTS,
    N_FLOW,
)
from ship_gym.envs.info import Info, Layout, info_of_all, info_of_one, side_by_side
from ship_gym.envs.interval import BAD_ACTION, BAD_OUTCOME, Episodes, Failure, Loops, loops_of
from ship_gym.envs.probe import check_outcomes, try_kernels
from ship_gym.envs.randomisation import ShipDraws, check_draws, check_has_std
from ship_gym.envs.watcher import Watcher
from ship_gym.envs.weather import Weathers
from ship_gym.physics._threads import BLOCK, in_parts
from ship_gym.physics.waves import WAVE_EXTRAPOLATION
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Ship
from ship_gym.ships.records import numbered
from ship_gym.simulation import ShipSim
from ship_gym.tasks import TASKS, bridge, observations_of
from ship_gym.tasks.columns import ACTIONS
from ship_gym.tasks.rewards import COSTS

_KEY_BITS = 2.0**32


class EpisodeBatch:
    """n ships under way in one scenario; knows nothing of spaces and autoreset.

    Parameters
    ----------
    n : int
        Number of episodes.
    scenario : Scenario
    ship : Ship or sequence of Ship, optional
        Instead of the scenario's ship, e.g. one that is not in the package. Of several, episode i
        sails number i modulo their number.
    parallel : bool, optional
        As in ``ShipSim``.

    Attributes
    ----------
    observations : numpy.ndarray
        float32, shape (n, n_observations), columns of ``tasks.observations_of``.
    actions : numpy.ndarray
        Of the last interval as they were given, before any limit, shape (n, n_actions).
    rewards, terminated, truncated : numpy.ndarray
        Shape (n,), of the last interval.
    outcomes : numpy.ndarray
        Why an episode terminated, index of ``task.all_outcomes``, shape (n,).
    reward_terms : tuple of str
        Names of the terms.
    terms : numpy.ndarray
        Reward terms, shape (n, len(reward_terms)).
    errors : numpy.ndarray
        Error at the end of the interval in the unit of the task, such as the heading error [rad]
        or the cross-track error from the active leg [m], shape (n,).
    power, energy, cost, success : numpy.ndarray
        As in `info`, shape (n,).
    plans : numpy.ndarray
        What the task orders, such as headings with their times, or way-points north and east [m];
        shape (n, *shape of the task's plan).
    n_draws : int
        Uniform numbers that the start of one episode needs.
    """

    def __init__(
        self,
        n: int,
        scenario: Scenario,
        ship: Ship | Sequence[Ship] | None = None,
        parallel: bool | None = None,
    ):
        self.scenario, self.n = scenario, n
        self._made: Loops | None = None
        self._watching: list[Watcher] = []
        if ship is None:
            ship = load_ship(scenario.ship, surrogate=scenario.surrogate)
        different, numbers = numbered([ship] if isinstance(ship, Ship) else list(ship))
        self.fleet = [one.at_share(scenario.speed) for one in different]
        given = [self.fleet[k] for k in numbers]
        self.ships = [given[i % len(given)] for i in range(n)]
        for one in self.fleet:
            if scenario.randomisation.surrogate_std > 0.0:
                check_has_std(one)
            check_draws(scenario.randomisation, one)
        self.task = TASKS[scenario.task]
        self.sim = ShipSim(self.ships, n, parallel=parallel)
        self.ships = self.sim.ships
        self._weathers = Weathers(scenario.sea, self.ships)
        self.sim.set_water(self._weathers.water)
        self._plan = self.task.plan(scenario, self.ships)
        self._ship_draws = ShipDraws(scenario.randomisation, self.sim.records, len(given))
        if self._ship_draws.names or scenario.failure.any:
            drawn = scenario.randomisation.surrogate_std > 0.0
            self.sim.expect("each", *(("spread",) if drawn else ()))
        parts = (
            2,  # ordered heading, heading error
            self._weathers.n_draws,
            self._plan.n_draws,
            len(self._ship_draws.names),
            1,  # key of the sensors' noise
            self.sim.water.n_phases,
        )
        ends = np.cumsum(parts).tolist()
        self._parts = [slice(end - size, end) for end, size in zip(ends, parts, strict=True)]
        self.n_draws = sum(parts)
        self.n_actions = len(ACTIONS[scenario.control])
        self.reward_terms = tuple(term.name for term in (*self.task.terms, *COSTS))
        self.tasks = np.zeros(n, bridge.record_dtype(self.task))
        self._fill_tasks()
        self.sim.set_interval(self.dt)
        self._make_arrays()
        self._fails_at = self._intervals(scenario.failure.time)

    @property
    def given(self) -> dict[str, Any]:
        """What the plan of the task says of all episodes: entries of a recording's meta."""
        return dict(getattr(self._plan, "meta", {}))

    @property
    def _loops(self) -> Loops:
        """Compiled loops over the arrays of this batch, as they are now."""
        if self._made is None or self._made.fleet is not self.sim.fleet:
            self._made = self._make_loops()
        return self._made

    def compile(self) -> None:
        """Compile every loop of the task for ships and water of these types, or load what is kept.

        Without it each is compiled when it is first called.
        """
        for name in loops_of(self.task):
            getattr(self._loops, name)

    def _make_loops(self) -> Loops:
        episodes = Episodes(
            self.actions, self._before, self.tasks, self._results, self.plans, self.terms,
            self.observations, self._failures, self._aims, self._diverged, self._failure(),
            self._privileged_from,
        )  # fmt: skip
        return Loops(self.task, self.sim.fleet, episodes)

    def _failure(self) -> Failure:
        """The failure of the scenario, as the loops take it."""
        given = self.scenario.failure
        propeller = -1.0 if given.propeller_speed is None else given.propeller_speed
        return Failure(
            at=self._fails_at if given.any else -1,
            heading_bias=math.radians(given.heading_bias_deg),
            propeller=float(propeller),
            rudder=float(given.rudder_rate),
            dropout=self._intervals(given.dropout),
        )

    def _intervals(self, time: float) -> int:
        """Control intervals that take a time [full-scale s], whatever the division rounds to."""
        return math.ceil(time / self.scenario.control_interval - 1e-9)

    @property
    def _privileged_from(self) -> int:
        """First privileged column of the observation, 0 without."""
        first = bridge.N_BRIDGE + len(self.task.observations)
        return first if self.scenario.privileged else 0

    @property
    def ship(self) -> Ship:
        """The ship that sails in every episode.

        Raises
        ------
        ConfigError
            There are several.
        """
        if len(self.fleet) > 1:
            raise ConfigError(
                f"a mixed fleet of {', '.join(s.name for s in self.fleet)} has no one ship: use "
                "`ships`"
            )
        return self.fleet[0]

    def _make_arrays(self) -> None:
        n, scenario = self.n, self.scenario
        self._before = np.zeros((BLOCK * self.sim.threads, self.sim.state.shape[1]))
        self._waiting = np.ones(n, dtype=np.bool_)  # for their first reset
        self._begun = False  # all of them
        columns = len(observations_of(scenario.task, scenario.privileged))
        self.observations = np.zeros((n, columns), dtype=np.float32)
        self.plans = np.zeros((n, *self._plan.shape))
        self.terms = np.zeros((n, len(self.reward_terms)))
        self._results = np.zeros(n, bridge.RESULT_DTYPE)
        self._gather()
        outcomes = self.task.all_outcomes
        self._failures = np.array([outcome.failed for outcome in outcomes])
        self._aims = np.array([outcome.reached for outcome in outcomes])
        self.actions = np.zeros((n, self.n_actions))
        self._diverged = np.zeros(n, dtype=np.bool_)

    @property
    def dt(self) -> np.ndarray:
        """Control interval of each ship [s], shape (n,)."""
        return self.tasks["dt"]

    def _fill_tasks(self) -> None:
        scenario, tasks = self.scenario, self.tasks
        unit = np.array([one.time_unit for one in self.ships])
        tasks["dt"] = scenario.control_interval / unit
        tasks["speed"] = [one.speed for one in self.ships]
        tasks["file_speed"] = [one.file_speed for one in self.ships]
        tasks["L"] = [one.hull.L for one in self.ships]
        tasks["n_order"] = self.sim.self_propulsion(tasks["speed"])
        tasks["interval"], tasks["steps"] = scenario.control_interval, scenario.steps
        tasks["astern"] = scenario.astern
        tasks["rudder_stroke"] = [one.gear.rate for one in self.ships] * self.dt
        for name in self.reward_terms:
            tasks[name] = getattr(scenario.reward, name)
        self.task.fill(scenario, tasks)
        sensors = scenario.sensors
        tasks["noisy"] = sensors.noise
        tasks["gyro_fails"] = sensors.dropout_rate > 0.0 or scenario.failure.dropout > 0.0
        hours = scenario.control_interval / 3600.0
        tasks["dropout_chance"] = -math.expm1(-sensors.dropout_rate * hours)
        tasks["dropout_steps"] = self._intervals(sensors.dropout_time)
        noise = {
            "heading_noise": np.full(self.n, math.radians(sensors.heading_deg)),
            "yaw_rate_noise": math.radians(sensors.yaw_rate_deg_s) * unit,
            "speed_noise": sensors.speed / unit,
            "position_noise": sensors.position / (unit * unit) * self.task.sees_position,
        }
        for name, size in noise.items():
            tasks[name] = size
        self._noise = noise if "sensors" in self._ship_draws.names else {}  # before any draw

    def start(
        self,
        which: np.ndarray,
        draws: np.ndarray,
        given: Mapping[str, np.ndarray] | None = None,
    ) -> None:
        """Begin new episodes.

        Parameters
        ----------
        which : numpy.ndarray
            Indices of the episodes, shape (m,).
        draws : numpy.ndarray
            Uniform numbers in [0, 1), shape (m, n_draws): all randomness of the episodes. Ordered
            heading, heading error; current, then, where the scenario has them, waves and wind;
            plan; ship; key of the noise; phases of disturbance, gusts and waves.
        given : mapping, optional
            What is not drawn, arrays of m rows, see ``envs.start_options``.
        """
        sim, tasks, given = self.sim, self.tasks, given or {}
        which = np.ascontiguousarray(which, dtype=np.int64)
        if "speed" in given:
            self._check_speed(which, given["speed"])
        for watcher in self._watching:
            watcher.leave(which)
        if "sea_seed" in given:
            draws = self._with_seas_of(draws, given["sea_seed"])
        begin, sea, plan, ship, key, phases = (draws[:, part] for part in self._parts)
        self._draw_ships(which, ship)
        tasks["noise_key"][which] = (key[:, 0] * _KEY_BITS).astype(np.int64)
        order = math.pi * (2.0 * begin[:, 0] - 1.0)
        x, y = self._plan.make(which, plan, order, self.plans, tasks)
        if self.task.begin is not None:
            self._loops.begin(which)
        order = tasks["psi_ordered"][which]
        waves_to = self._weathers.draw(which, sea, order, tasks)
        starts = np.empty((len(which), 4))
        starts[:, 0], starts[:, 1], starts[:, 3] = x, y, tasks["speed"][which]
        error = math.radians(self.scenario.start.heading_error_deg) * (2.0 * begin[:, 1] - 1.0)
        if "heading_error_deg" in given:
            error = given["heading_error_deg"] * (math.pi / 180.0)
        if "position" in given:
            starts[:, :2] = given["position"]
        if "speed" in given:
            starts[:, 3] = given["speed"]
        starts[:, 2] = order + error
        if not self._begun:
            self._waiting[which] = False
            self._begun = not self._waiting.any()
        self._loops.start(which, starts)
        sim.set_sea(which, phases, waves_to)
        try_kernels(self.task, self._loops, len(self.reward_terms))
        self.observe(which)
        for watcher in self._watching:
            watcher.begin(which, given)

    def _draw_ships(self, which: np.ndarray, uniform: np.ndarray) -> None:
        """Draw the ships of some episodes, with everything in order."""
        draws, scenario = self._ship_draws, self.scenario
        draws.draw(which, uniform)
        if draws.names or scenario.failure.any:
            draws.set_rudder_rate(which)
        for name, size in self._noise.items():
            self.tasks[name][which] = size[which] * draws.sensor_factor(which)

    def _check_speed(self, which: np.ndarray, speeds: np.ndarray) -> None:
        """Refuse a speed at the start that no ship has."""
        fastest = self.sim.limits[which, 0]
        for speed, limit in zip(speeds, fastest, strict=True):
            check_number("options['speed']", speed, -limit, limit, "m/s")

    def _with_seas_of(self, draws: np.ndarray, seeds: np.ndarray) -> np.ndarray:
        """Draws with the numbers of the sea as the episodes of other seeds have them."""
        draws = draws.copy()
        _, sea, *_, phases = self._parts
        for row, seed in zip(draws, seeds.tolist(), strict=True):
            other = seeding.np_random(seed)[0].random(self.n_draws)
            row[sea], row[phases] = other[sea], other[phases]
        return draws

    def observe(self, which: np.ndarray | None = None) -> None:
        """Refresh the observations of some episodes, shape (m,), or all from the present states."""
        self._loops.observe(np.arange(self.n) if which is None else which)

    def randomisation(self) -> dict[str, np.ndarray]:
        """What was drawn for the ship of each episode, arrays of shape (n,); empty if it is off.

        Names are those of ``scenarios.sections.Randomisation``; values are factors of the ship
        file's value, of the surrogate standard deviations by which it is moved.
        """
        return self._ship_draws.drawn()

    def step(self, actions: np.ndarray) -> None:
        """Sail one control interval under actions of shape (n, n_actions)."""
        if not self._begun:
            raise ConfigError(f"step before reset: call reset first{self._who_waits()}")
        self.actions[:] = shaped_actions(actions, self.n, self.scenario.control)
        watching = self._watching
        if watching:
            for watcher in watching:
                watcher.before()
        lost = in_parts(self._loops.interval, self.n, self.sim.threads)
        if any(lost):
            self._told(min(lost))
        if watching:
            for watcher in watching:
                watcher.after()

    def watch(self, watcher: Watcher) -> None:
        """Call a watcher at every interval and start from now on; a copy has none."""
        self._watching.append(watcher)

    def unwatch(self, watcher: Watcher) -> None:
        """Call it no more."""
        if watcher in self._watching:
            self._watching.remove(watcher)

    def _told(self, lost: int) -> None:
        """What the interval has found: a bad action or outcome, or ships that are none any more."""
        if lost == BAD_ACTION:
            row = int(np.flatnonzero(~np.isfinite(self.actions).all(axis=1))[0])
            action = self.actions[row].tolist()
            raise ConfigError(f"action {row} = {action}: must be finite, in [-1, 1]")
        if lost == BAD_OUTCOME:
            check_outcomes(self.task, self.outcomes)
        self._end_diverged(np.flatnonzero(self._diverged))

    def _end_diverged(self, which: np.ndarray) -> None:
        """End episodes whose ship is none any more and has its last state back; the rest sails on.

        That is where a state is not finite, where she was faster than any ship at any step of the
        interval (``simulation.FASTEST``), or where her reward is no number.
        """
        sim = self.sim
        for loads in (sim.forces, sim.flow):
            loads[which] = np.where(np.isfinite(loads[which]), loads[which], 0.0)
        sim.see_waves(which)
        self._loops.end(which)
        self.observe(which)

    def _who_waits(self) -> str:
        if self._waiting.all():
            return ""
        return f", also of the environments {shown(np.flatnonzero(self._waiting).tolist())}"

    def info(self, mask: np.ndarray, copy: bool = True) -> Info:
        """What happened in the last interval, as arrays over the batch (zero after a reset).

        Built when it is looked at, of what holds now, or, without `copy`, of what holds then.

        Parameters
        ----------
        mask : numpy.ndarray
            Of whom, bool (n,), as Gymnasium has it for each key.
        copy : bool

        Returns
        -------
        Info
            ``reward_terms`` by name; ``forces`` by component, each (n, 3) X, Y [N], N [N m], and
            ``flow`` by name, both at the start of the interval, with two propellers also of each
            (``thrust_starboard``, ``thrust_port``); ``psi_ordered`` [rad], of a track
            the bearing of the active leg; ``time`` [s]; ``power`` delivered at the propeller at
            the start of the interval [W] and ``energy`` since the reset [J]; ``extrapolation``
            (distance outside the surrogate's trained box, 0 inside); the safety ``cost`` (1 where
            the rudder is saturated or a limit ended the episode); ``outcome``, index of
            the task's outcomes; ``is_success``, whether the episode has ended as it should: its aim
            reached where the task has one, else held to the end. What the task adds; with
            randomisation ``randomisation``, what was drawn by name; with a failure ``failed``,
            whether it has begun; in waves ``waves_extrapolation``, how far the ship is faster than
            its wave table goes, 0 inside, and ``waves_outside``, the share of the waves' energy at
            frequencies outside it, where its ends hold (0.05 to 0.3 in the default sea).
        """
        return info_of_all(self._layout, mask, self._only, copy)

    def info_of(self, i: int, copy: bool = True) -> Info:
        """Row i of `info` as plain numbers, without the detour over the batch."""
        return info_of_one(self._layout, i, copy)

    @functools.cached_property
    def _only(self) -> dict[str, np.ndarray]:
        """Who has loads of each propeller."""
        two = np.array([ship.propellers == 2 for ship in self.ships])
        return dict.fromkeys(FLOW_OF_UNITS[N_FLOW:], two)

    @functools.cached_property
    def _layout(self) -> Layout:
        """Groups of the info (names, present values) and its single values."""
        sim = self.sim
        groups: dict[str, tuple[Sequence[str], np.ndarray]] = {
            "reward_terms": (self.reward_terms, self.terms),
            "forces": (FORCE_COMPONENTS, sim.forces),
            "flow": (FLOW_OF_UNITS[: sim.flow.shape[1]], sim.flow),
        }
        if self._ship_draws.names:
            groups["randomisation"] = (self._ship_draws.names, self._ship_draws.values)
        columns = {
            "psi_ordered": self._results["psi_ordered"],
            "time": sim.time,
            "power": self.power,
            "energy": self.energy,
            "extrapolation": sim.flow[:, FLOW_EXTRAPOLATION],
            "cost": self.cost,
            "outcome": self.outcomes,
            "is_success": self.success,
        }
        columns |= self.task.info(self)
        if sim.water.n_waves:
            columns["waves_extrapolation"] = sim.waves[:, WAVE_EXTRAPOLATION]
            columns["waves_outside"] = self._results["waves_outside"]
        if self.scenario.failure.any:
            columns["failed"] = self._results["failed"]
        return Layout(self._buffer, groups, columns)

    def _gather(self) -> None:
        """Put the arrays that an info shows side by side in one buffer."""
        sim = self.sim
        loads = {name: getattr(sim, name) for name in ("forces", "flow", "waves", "time")}
        self._buffer, views = side_by_side({**loads, "terms": self.terms, "results": self._results})
        self.terms, self._results = views.pop("terms"), views.pop("results")
        sim.replace(**views)
        results = self._results
        self.rewards, self.errors = results["reward"], results["error"]
        self.terminated, self.truncated = results["terminated"], results["truncated"]
        self.elapsed, self.outcomes = results["elapsed"], results["outcome"]
        self.power, self.energy = results["power"], results["energy"]
        self.cost, self.success = results["cost"], results["success"]

    def __getstate__(self) -> dict[str, Any]:
        """Without the views and what is made of the arrays: a copy would lose their ties."""
        made = ("_layout", "_buffer")
        kept = {key: value for key, value in self.__dict__.items() if key not in made}
        return kept | {"_made": None, "_watching": []}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """With arrays side by side again; of the type that numba knows by its identity."""
        self.__dict__.update(state)
        self.tasks = self.tasks.astype(bridge.record_dtype(self.task), copy=False)
        self._results = self._results.astype(bridge.RESULT_DTYPE, copy=False)
        self._gather()


def shaped_actions(actions: Any, n: int, control: str) -> np.ndarray:
    """Actions of n ships, of the right shape and a type of numbers, else ConfigError."""
    n_actions = len(ACTIONS[control])
    try:
        actions = np.asarray(actions)
    except ValueError:
        raise ConfigError(
            f"action = {actions!r}: must be {n_actions} numbers in [-1, 1] for each ship"
        ) from None
    if actions.shape != (n, n_actions):
        raise ConfigError(
            f"actions have shape {actions.shape}, allowed is {(n, n_actions)} "
            f"for control = {control!r}"
        )
    if actions.dtype.kind not in "fiu":
        raise ConfigError(f"action has type {actions.dtype}, allowed are numbers in [-1, 1]")
    return actions
