"""A recording of an episode: its columns and its meta, from rows of a log and what it sailed in."""

from __future__ import annotations

import dataclasses
import functools
import math
import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.conventions import N_FLOW, polar, wrap_angle
from ship_gym.envs.episodes import EpisodeBatch
from ship_gym.physics.waves import WAVE_EXTRAPOLATION
from ship_gym.provenance import sha256
from ship_gym.recording.about import frame, ship_meta
from ship_gym.recording.panels import plots_meta
from ship_gym.recording.trajectory import Trajectory
from ship_gym.scenarios.scenario import Scenario
from ship_gym.sea.records import current_at
from ship_gym.sea.surface import wave_entries
from ship_gym.ships.particulars import Ship
from ship_gym.simulation import history_columns
from ship_gym.tasks import TASKS
from ship_gym.tasks.columns import action_columns, observation_columns
from ship_gym.tasks.metrics import metrics, metrics_of
from ship_gym.tasks.rewards import COSTS

_HISTORIES = ("time", "states", "commands", "forces", "flow", "waves")
CUT_SHORT = "cut short"  # outcome of an episode that its owner left before its end


class Setting:
    """What the episodes of one ship in one scenario have in common.

    Parameters
    ----------
    scenario : Scenario
    ship : Ship
    given : mapping, optional
        As ``EpisodeBatch.given``.
    """

    def __init__(self, scenario: Scenario, ship: Ship, given: Mapping[str, Any] | None = None):
        self.scenario, self.ship, self.task = scenario, ship, TASKS[scenario.task]
        self.given = given or {}
        self.seen, self.done = observation_columns(scenario), action_columns(scenario)

    @functools.cached_property
    def meta(self) -> dict[str, Any]:
        """What a recording says of them; without provenance."""
        scenario, task = self.scenario, self.task
        shown = task.error_column
        rudder = {"rudder_deg": math.degrees(self.ship.gear.delta_max)}
        return {
            "kind": "episode",
            "task": task.name,
            "scenario": scenario.source,
            **self._own_task(),
            "overrides": scenario.overrides(),
            "config": scenario.to_dict(),
            "ship": ship_meta(self.ship),
            "error": None if shown is None else shown._asdict(),
            "limits": rudder | task.limits(scenario, self.ship),
            "observations": list(self.seen),
            "actions": list(self.done),
            "frame": frame(self.given),
            **plots_meta(task.plots),
            **self.given,
        }

    def _own_task(self) -> dict[str, str]:
        """The file of a task from outside the package, "" if it was registered by other means."""
        name = self.task.name
        return {"task_file": TASKS.files.get(name, "")} if name in TASKS.outside() else {}


@dataclasses.dataclass(frozen=True, eq=False)
class Conditions:
    """What an episode has that does not change while it sails.

    Attributes
    ----------
    setting : Setting
    plan : numpy.ndarray
        As a row of ``EpisodeBatch.plans``.
    weather : dict
        ``wave_height`` [m], ``wave_period`` [s], ``wave_direction_to`` [rad], ``wind_speed``
        [m/s], ``wind_direction_to`` [rad].
    current : tuple of float
        Of `currents_of`.
    randomisation : dict
        What was drawn for the ship, by name.
    waves : numpy.ndarray
        As ``sea.records.Waters.waves_of``, shape (5, N).
    """

    setting: Setting
    plan: np.ndarray
    weather: dict[str, float]
    current: tuple[float, ...]
    randomisation: dict[str, float]
    waves: np.ndarray

    def columns(self, rows: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
        """Columns of a recording from rows of an ``EpisodeLog``.

        Parameters
        ----------
        rows : mapping
            By name, shape (T, ...); ``rewards`` and ``terms`` may lack the last one, which has
            none.
        """
        rows, task = dict(rows), self.setting.task
        if self.setting.ship.propellers == 1:  # beside one with two there is room for another
            rows["flow"] = rows["flow"][:, :N_FLOW]
        found = history_columns(*(rows[name] for name in _HISTORIES))
        count = len(rows["time"])
        history = {name: rows[name] for name in task.history}
        found |= task.columns(found, history, self.plan)
        found |= {name: np.full(count, value) for name, value in self._surroundings().items()}
        if self.current[2] > 0.0:
            variation, omega, phase = self.current[2:]
            found["current_speed"] *= current_at(variation, omega, phase, rows["time"])
        if self.waves.shape[1]:
            found["waves_extrapolation"] = rows["waves"][:, WAVE_EXTRAPOLATION]
        found["reward"] = _padded(rows["rewards"], count)
        for k, term in enumerate((*task.terms, *COSTS)):
            found[f"reward_{term.name}"] = _padded(rows["terms"][:, k], count)
        return found | self._seen_and_done(rows, found)

    def _surroundings(self) -> dict[str, float]:
        """Mean current and wind, which are the same in every row."""
        speed, to, *_ = self.current
        found = {"current_speed": speed, "current_direction_to": to}
        if self.weather["wind_speed"] > 0.0:
            origin = (self.weather["wind_direction_to"] + math.pi) % (2.0 * math.pi)
            found |= {"wind_speed": self.weather["wind_speed"], "wind_direction_from": origin}
        return found

    def _seen_and_done(self, rows: Mapping, columns: Mapping) -> dict[str, np.ndarray]:
        """Observation and action, and the heading that the observation shows [rad]."""
        seen, done = self.setting.seen, self.setting.done
        found = {f"observation_{k}": rows["observations"][:, j] for j, k in enumerate(seen)}
        found |= {f"action_{k}": rows["actions"][:, j] for j, k in enumerate(done)}
        if "psi_ordered" in columns and "sin_error" in seen and "cos_error" in seen:
            sine, cosine = found["observation_sin_error"], found["observation_cos_error"]
            error = np.arctan2(sine.astype(np.float64), cosine.astype(np.float64))
            psi = columns["psi"]
            found["psi_measured"] = psi + wrap_angle(columns["psi_ordered"] + error - psi)
        return found

    def meta(self) -> dict[str, Any]:
        """What a recording says of the episode whatever becomes of it; without provenance."""
        return {
            **self.setting.meta,
            "randomisation": self.randomisation,
            "sea": self._sea(),
            "waves": wave_entries(self.waves),
            **self.setting.task.meta(self.plan),
        }

    def _sea(self) -> dict[str, float | None]:
        """Weather in SI, and for people in degrees: from where wind and waves come; None: none."""
        speed, to, *_ = self.current
        weather = self.weather
        ways = (
            ("wave_from_deg", weather["wave_height"], weather["wave_direction_to"] + math.pi),
            ("wind_from_deg", weather["wind_speed"], weather["wind_direction_to"] + math.pi),
            ("current_to_deg", speed, to),
        )
        degrees = {name: math.degrees(way) % 360.0 if size else None for name, size, way in ways}
        return {**weather, "current_speed": speed, "current_direction_to": to, **degrees}

    def trajectory(
        self, rows: Mapping[str, np.ndarray], outcome: int, about: Mapping[str, Any]
    ) -> Trajectory:
        """The recording of the whole episode.

        Parameters
        ----------
        rows : mapping
            See `columns`; the last of them is the final state.
        outcome : int
            Index of ``task.all_outcomes``; 0: it did not terminate; -1: `CUT_SHORT`.
        about : mapping
            Further meta: controller, policy, seed, provenance.
        """
        found = Trajectory(self.columns(rows), self.meta() | self.end(outcome) | dict(about))
        found.meta["metrics"] = measured(found)
        units = metrics_of(found.meta["task"]) if found.meta["metrics"] else {}
        found.meta["units"] = {name: metric.unit for name, metric in units.items()}
        return found

    def end(self, outcome: int) -> dict[str, Any]:
        """What the meta says of how the episode ended, see `trajectory`."""
        ended = self.setting.task.all_outcomes[max(outcome, 0)]
        name = ended.name if outcome > 0 else CUT_SHORT if outcome < 0 else "end of time"
        return {
            "complete": True,
            "terminated": outcome > 0,
            "truncated": outcome <= 0,
            "outcome": name,
            "failed": outcome > 0 and ended.failed,
        }


def measured(trajectory: Trajectory) -> dict[str, float | None]:
    """Metrics of a recording; none of a task without, or of a single row."""
    if TASKS[trajectory.meta["task"]].measure is None or len(trajectory) < 2:
        return {}
    return metrics(trajectory)


def conditions_of(batch: EpisodeBatch, i: int, setting: Setting) -> Conditions:
    """Conditions of episode i of a batch, which has begun; the setting is that of its ship."""
    seas = batch.sim.seas[i : i + 1]
    return Conditions(
        setting,
        batch.plans[i].copy(),
        {name: values.item(0) for name, values in weather_of(batch, [i]).items()},
        tuple(currents_of(seas)[0].tolist()),
        {name: values[i].item() for name, values in batch.randomisation().items()},
        batch.sim.water.waves_of(i),
    )


def currents_of(seas: np.ndarray) -> np.ndarray:
    """Current of episodes that have begun, shape (m, 5).

    Mean speed [m/s], direction it flows to [rad], and the speed's variation as a share, its
    frequency [rad/s] and phase [turns], see ``sea.records.current_at``.
    """
    vary = (seas[f"variation{name}"] for name in ("", "_omega", "_phase"))
    return np.column_stack([*polar(seas["mean_north"], seas["mean_east"]), *vary])


def weather_of(batch: EpisodeBatch, which: Any = slice(None)) -> dict[str, np.ndarray]:
    """Waves and wind of episodes that have begun, as `Conditions.weather`, shapes (m,)."""
    seas, tasks = batch.sim.seas[which], batch.tasks[which]
    wind_speed, wind_to = polar(seas["wind_north"], seas["wind_east"])
    return {
        "wave_height": tasks["wave_height"].copy(),
        "wave_period": tasks["wave_period"].copy(),
        "wave_direction_to": tasks["wave_to"] % (2.0 * math.pi),
        "wind_speed": wind_speed,
        "wind_direction_to": wind_to,
    }


def policy_meta(file: Any) -> dict[str, str] | None:
    """File and SHA-256 of what decides how a controller steers; None: no file.

    Raises
    ------
    ConfigError
        No such file.
    """
    if not isinstance(file, str | os.PathLike):
        return None
    if not os.path.isfile(file):
        raise ConfigError(f"policy = {os.fspath(file)!r}: no such file")
    return {"file": os.fspath(file), "sha256": sha256(file)}


def _padded(values: np.ndarray, count: int) -> np.ndarray:
    """Rewards of `count` rows; the last may have none."""
    return values if len(values) == count else np.append(values, 0.0)
