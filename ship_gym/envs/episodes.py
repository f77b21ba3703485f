"""EpisodeBatch: n episodes of one scenario, the engine of both environment classes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.special import ndtri

from ship_gym.config import ConfigError
from ship_gym.conventions import (
    DELTA,
    FLOW_EXTRAPOLATION,
    FLOW_NAMES,
    FLOW_TORQUE,
    FORCE_COMPONENTS,
    PSI,
    N,
    U,
)
from ship_gym.physics.dynamics import over_ground
from ship_gym.physics.waves import WAVE_EXTRAPOLATION
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Ship
from ship_gym.simulation import ShipSim, self_propulsion
from ship_gym.tasks import heading

N_ACTIONS = {"rudder": 1, "rudder+rpm": 2}
# What randomisation draws of a ship's surrogate, and the fields that each draw sets: thrust and
# torque err together, by the wake. And where the normal distribution is cut.
SURROGATE_DRAWS = {
    "propeller": ("z_T", "z_Q"),
    "side": ("z_S",),
    "rudder": ("z_N",),
    "chord": ("z_A",),
}
_CUT = 3.0
_SATURATED = 0.999


class EpisodeBatch:
    """n ships under way in one scenario; knows nothing of spaces and autoreset.

    Parameters
    ----------
    n : int
        Number of episodes.
    scenario : Scenario
    ship : Ship, optional
        Instead of the scenario's ship, e.g. one that is not in the package.
    parallel : bool, optional
        As in ``ShipSim``.

    Attributes
    ----------
    observations : numpy.ndarray
        float32, shape (n, 9).
    rewards, terminated, truncated : numpy.ndarray
        Shape (n,), of the last interval.
    terms : numpy.ndarray
        Reward terms, shape (n, 5), order of ``tasks.heading.REWARD_TERMS``.
    n_draws : int
        Uniform numbers that the start of one episode needs.
    """

    def __init__(
        self, n: int, scenario: Scenario, ship: Ship | None = None, parallel: bool | None = None
    ):
        self.scenario = scenario
        self.ship = load_ship(scenario.ship, surrogate=scenario.surrogate) if ship is None else ship
        self._surrogate_std = scenario.randomisation.surrogate_std
        if self._surrogate_std > 0.0:
            check_has_std(self.ship)
        self.sim = ShipSim(self.ship, n, scenario.sea.sea().scaled(self.ship.scale), parallel)
        self._largest = self.sim.water.components[0, :, 0].copy()  # amplitudes at `wave_height`
        extra = 3 if scenario.sea.wave_height > 0.0 or scenario.sea.wind_speed > 0.0 else 0
        drawn = len(SURROGATE_DRAWS) if self._surrogate_std > 0.0 else 0
        self._draws = np.cumsum([4, self.sim.water.n_phases, extra, drawn]).tolist()
        self.n_draws = self._draws[-1]
        self.n = n
        self.n_actions = N_ACTIONS[scenario.control]
        self.dt = scenario.control_interval / self.ship.time_unit
        self.tasks = np.zeros(n, heading.TASK_DTYPE)
        self._fill_tasks()
        self.sim.set_interval(self.dt)
        self._rudder_before = np.zeros(n)
        self._begun = False
        self.observations = np.zeros((n, heading.N_OBSERVATIONS), dtype=np.float32)
        self.terms = np.zeros((n, heading.N_TERMS))
        self.rewards = np.zeros(n)
        self.terminated = np.zeros(n, dtype=np.bool_)
        self.truncated = np.zeros(n, dtype=np.bool_)
        self.elapsed = np.zeros(n, dtype=np.int64)
        done = (self.terminated, self.truncated)
        self._verdict = (self.rewards, *done, self.elapsed, scenario.steps)

    def _fill_tasks(self) -> None:
        ship, scenario, tasks = self.ship, self.scenario, self.tasks
        tasks["speed"] = ship.speed
        tasks["n_order"] = self_propulsion(ship, ship.speed)
        tasks["interval"] = scenario.control_interval
        tasks["rudder_stroke"] = ship.gear.rate * self.dt
        tasks["heading_limit"] = math.radians(scenario.limits.heading_error_deg)
        for name in heading.REWARD_TERMS:
            tasks[name] = getattr(scenario.reward, name)

    def start(self, which: np.ndarray, draws: np.ndarray) -> None:
        """Begin new episodes.

        Parameters
        ----------
        which : numpy.ndarray
            Indices of the episodes, shape (m,).
        draws : numpy.ndarray
            Uniform numbers in [0, 1), shape (m, n_draws): all randomness of the episodes. Ordered
            heading, heading error, current speed and direction; phases; then, where the scenario
            has them, wave height, direction of waves and wind, wind speed; surrogate.
        """
        sim, tasks = self.sim, self.tasks
        order = math.pi * (2.0 * draws[:, 0] - 1.0)
        error = math.radians(self.scenario.start.heading_error_deg) * (2.0 * draws[:, 1] - 1.0)
        # Froude: speeds of a model are smaller by the square root of its scale
        speed = self.scenario.sea.current_speed * draws[:, 2] / self.ship.time_unit
        towards = 2.0 * math.pi * draws[:, 3]
        # The math module, not numpy, so that every batch size gives the same bits.
        north = np.array([V * math.cos(a) for V, a in zip(speed, towards, strict=True)])
        east = np.array([V * math.sin(a) for V, a in zip(speed, towards, strict=True)])
        seas = sim.seas[which]
        seas["V_north"], seas["V_east"] = north, east
        seas["mean_north"], seas["mean_east"] = north, east
        sim.seas[which] = seas
        phases, sea, drawn = np.split(draws[:, 4:], [k - 4 for k in self._draws[1:3]], axis=1)
        waves_to = self._draw_waves_and_wind(which, sea)
        if self._surrogate_std > 0.0:
            z = np.clip(ndtri(drawn), -_CUT, _CUT) * self._surrogate_std
            for fields, column in zip(SURROGATE_DRAWS.values(), z.T, strict=True):
                for name in fields:
                    sim.records["surrogate"][name][which] = column
        tasks["psi_ordered"][which] = order
        state = np.zeros((len(which), sim.state.shape[1]))
        state[:, PSI] = order + error
        state[:, U] = self.ship.speed
        state[:, N] = tasks["n_order"][which]
        over_ground(state, seas)
        sim.state[which] = state
        sim.time[which] = 0.0
        sim.forces[which], sim.flow[which] = 0.0, 0.0
        sim.commands[which, 0], sim.commands[which, 1] = 0.0, state[:, N]
        self.terms[which], self.rewards[which] = 0.0, 0.0
        self.terminated[which], self.truncated[which] = False, False
        self.elapsed[which] = 0
        self._begun = True
        sim.set_sea(which, phases, waves_to)
        self.observe()

    def _draw_waves_and_wind(self, which: np.ndarray, uniform: np.ndarray) -> np.ndarray:
        """Set height of the waves and wind of some episodes; where the waves go to [rad]."""
        if uniform.shape[1] == 0:
            return np.zeros(len(which))
        sea, sim = self.scenario.sea, self.sim
        if sim.water.n_waves:
            low = sea.wave_height_min / sea.wave_height
            share = low + (1.0 - low) * uniform[:, 0]
            sim.water.components[which, :, 0] = share[:, None] * self._largest
        towards = math.pi * (2.0 * uniform[:, 1] - 1.0)
        speed = sea.wind_speed / self.ship.time_unit * uniform[:, 2]
        seas = sim.seas[which]
        for k, (V, a) in enumerate(zip(speed.tolist(), towards.tolist(), strict=True)):
            seas["wind_north"][k], seas["wind_east"][k] = V * math.cos(a), V * math.sin(a)
        sim.seas[which] = seas
        return towards

    def observe(self) -> None:
        """Refresh the observations from the present states."""
        sim = self.sim
        heading.observe_batch(
            sim.state, sim.waves, sim.commands, sim.records, sim.seas, self.tasks, self.observations
        )

    def randomisation(self) -> dict[str, np.ndarray]:
        """What was drawn for the ship of each episode, arrays of shape (n,); empty if it is off.

        ``surrogate.propeller`` (thrust and torque), ``surrogate.side`` (propeller side force),
        ``surrogate.rudder`` (normal force) and ``surrogate.chord``: standard deviations by which
        the surrogate is moved. The normal force is moved at every rudder angle: at the trained one
        by the surrogate's standard deviation, amidships by the law's rms error at the samples.
        """
        if self._surrogate_std == 0.0:
            return {}
        drawn = self.sim.records["surrogate"]
        return {f"surrogate.{k}": drawn[v[0]].copy() for k, v in SURROGATE_DRAWS.items()}

    def step(self, actions: np.ndarray) -> None:
        """Sail one control interval under actions of shape (n, n_actions)."""
        if not self._begun:
            raise ConfigError("step before reset: call reset first")
        sim, before = self.sim, self._rudder_before
        actions = self._shaped(actions)
        good = heading.command_batch(
            actions, sim.state, sim.records, self.tasks, sim.commands, before
        )
        if good < self.n:
            row = int(np.flatnonzero(~np.isfinite(actions).all(axis=1))[0])
            raise ConfigError(f"action {row} = {actions[row].tolist()}: must be finite, in [-1, 1]")
        sim.advance()
        heading.judge_batch(sim.state, before, sim.seas, self.tasks, self.terms, self._verdict)
        self.observe()

    def _shaped(self, actions: Any) -> np.ndarray:
        """Actions as float64 of the right shape, else ConfigError."""
        actions = np.asarray(actions)
        if actions.shape != (self.n, self.n_actions):
            raise ConfigError(
                f"action has shape {actions.shape}, allowed is {(self.n, self.n_actions)} "
                f"for control = {self.scenario.control!r}"
            )
        if actions.dtype.kind not in "fiu":
            raise ConfigError(f"action has type {actions.dtype}, allowed are numbers in [-1, 1]")
        return actions.astype(np.float64)

    def info(self) -> dict[str, Any]:
        """What happened in the last interval, as arrays over the batch (zero after a reset).

        Returns
        -------
        dict
            ``reward_terms`` by name; ``forces`` by component, each (n, 3) X, Y [N], N [N m], and
            ``flow`` by name, both at the start of the interval; ``psi_ordered`` [rad]; ``time``
            [s]; ``power`` delivered at the propeller [W]; ``extrapolation`` (distance outside the
            surrogate's trained box, 0 inside); the safety ``cost`` (1 where the rudder is
            saturated or the episode terminated); with randomisation also ``randomisation``, what
            was drawn by name; in waves also ``waves_extrapolation``, how far the ship is faster
            than its wave table goes, or the share of the waves' energy outside it, 0 inside.
        """
        sim = self.sim
        forces, flow, terms = sim.forces.copy(), sim.flow.copy(), self.terms.copy()
        saturated = np.abs(sim.state[:, DELTA]) >= _SATURATED * self.ship.gear.delta_max
        extra = {"randomisation": self.randomisation()} if self._surrogate_std > 0.0 else {}
        if sim.water.n_waves:
            extra["waves_extrapolation"] = sim.waves[:, WAVE_EXTRAPOLATION].copy()
        return extra | {
            "reward_terms": {k: terms[:, i] for i, k in enumerate(heading.REWARD_TERMS)},
            "forces": {k: forces[:, i] for i, k in enumerate(FORCE_COMPONENTS)},
            "flow": {k: flow[:, i] for i, k in enumerate(FLOW_NAMES)},
            "psi_ordered": self.tasks["psi_ordered"].copy(),
            "time": sim.time.copy(),
            "power": 2.0 * math.pi * sim.state[:, N] * flow[:, FLOW_TORQUE],
            "extrapolation": flow[:, FLOW_EXTRAPOLATION],
            "cost": (saturated | self.terminated).astype(np.float64),
        }

    def info_of(self, i: int) -> dict[str, Any]:
        """Row i of `info` as plain numbers, without the detour over the batch."""
        sim, forces, flow = self.sim, self.sim.forces[i].copy(), self.sim.flow[i].tolist()
        delta, n = sim.state[i, DELTA].item(), sim.state[i, N].item()
        saturated = abs(delta) >= _SATURATED * self.ship.gear.delta_max
        extra: dict[str, Any] = {}
        if self._surrogate_std > 0.0:
            extra["randomisation"] = {k: z[i].item() for k, z in self.randomisation().items()}
        if sim.water.n_waves:
            extra["waves_extrapolation"] = sim.waves[i, WAVE_EXTRAPOLATION].item()
        return extra | {
            "reward_terms": dict(zip(heading.REWARD_TERMS, self.terms[i].tolist(), strict=True)),
            "forces": dict(zip(FORCE_COMPONENTS, forces, strict=True)),
            "flow": dict(zip(FLOW_NAMES, flow, strict=True)),
            "psi_ordered": self.tasks["psi_ordered"][i].item(),
            "time": sim.time[i].item(),
            "power": 2.0 * math.pi * n * flow[FLOW_TORQUE],
            "extrapolation": flow[FLOW_EXTRAPOLATION],
            "cost": float(saturated or self.terminated[i]),
        }


def check_has_std(ship: Ship) -> None:
    """Refuse to draw from a surrogate that has no standard deviation.

    Raises
    ------
    ConfigError
        The ship has no surrogate, or one made of printed coefficients.
    """
    table = ship.surrogate
    spread = 0.0
    if table is not None:
        columns = [i for i, name in enumerate(table.names) if "_std" in name]
        spread = float(np.abs(table.values[..., columns]).max())
    if spread == 0.0:
        raise ConfigError(
            f"randomisation.surrogate_std: surrogate {ship.surrogate_name!r} of {ship.name} has no "
            "standard deviation; allowed is 0, or a fitted surrogate such as 'gp'"
        )
