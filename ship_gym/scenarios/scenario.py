"""Scenario: everything that defines an environment, read from one TOML file per id."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError, build, check_known, check_number, merged, read_toml

_FOLDER = Path(__file__).parent
TASKS = ("heading_keeping",)
CONTROLS = ("rudder", "rudder+rpm")


@dataclasses.dataclass(frozen=True)
class Start:
    """Distribution of the start."""

    heading_error_deg: float


@dataclasses.dataclass(frozen=True)
class SeaRange:
    """Distribution of the sea; speeds at full scale."""

    current_speed: float
    sway_disturbance: float
    yaw_disturbance: float
    correlation_time: float


@dataclasses.dataclass(frozen=True)
class Limits:
    """What ends an episode as failed."""

    heading_error_deg: float


@dataclasses.dataclass(frozen=True)
class Reward:
    """Weights of the reward terms, per full-scale second (termination: once)."""

    heading: float
    rudder: float
    rudder_rate: float
    speed_loss: float
    termination: float


@dataclasses.dataclass(frozen=True)
class Randomisation:
    """What of the ship differs between episodes; everything is off by default.

    Attributes
    ----------
    surrogate_std : float
        Standard deviation of the draws by which thrust with torque, propeller side force and the
        rudder's two forces are moved, in standard deviations of the surrogate: 1 takes the
        surrogate at its word, 0 sails its mean. Cut at three of them.
    """

    surrogate_std: float = 0.0


@dataclasses.dataclass(frozen=True)
class Scenario:
    """Ship, control, times [full-scale s], start, sea, limits and reward of an environment."""

    task: str
    ship: str
    control: str
    control_interval: float
    duration: float
    start: Start
    sea: SeaRange
    limits: Limits
    reward: Reward
    surrogate: str | None = None
    randomisation: Randomisation = Randomisation()

    def __post_init__(self):
        check_known("task", self.task, TASKS)
        check_known("control", self.control, CONTROLS)
        check_number("control_interval", self.control_interval, 0.05, 60.0, "s")
        check_number("duration", self.duration, self.control_interval, 1e6, "s")
        if abs(self.duration / self.control_interval - self.steps) > 1e-9 * self.steps:
            raise ConfigError(
                f"duration = {self.duration}: must be a multiple of control_interval = "
                f"{self.control_interval}"
            )
        check_number("start.heading_error_deg", self.start.heading_error_deg, 0.0, 180.0, "deg")
        check_number("sea.current_speed", self.sea.current_speed, 0.0, 10.0, "m/s")
        for name in ("sway_disturbance", "yaw_disturbance"):
            check_number(f"sea.{name}", getattr(self.sea, name), 0.0, 1.0)
        check_number("sea.correlation_time", self.sea.correlation_time, 1e-3, 1e3)
        check_number("limits.heading_error_deg", self.limits.heading_error_deg, 1.0, 180.0, "deg")
        check_number("randomisation.surrogate_std", self.randomisation.surrogate_std, 0.0, 10.0)
        for field in dataclasses.fields(self.reward):
            check_number(f"reward.{field.name}", getattr(self.reward, field.name), 0.0, math.inf)
        if self.start.heading_error_deg >= self.limits.heading_error_deg < 180.0:
            raise ConfigError(
                f"start.heading_error_deg = {self.start.heading_error_deg}: must be below "
                f"limits.heading_error_deg = {self.limits.heading_error_deg}"
            )

    @property
    def steps(self) -> int:
        """Control intervals until truncation."""
        return round(self.duration / self.control_interval)

    def to_dict(self) -> dict[str, Any]:
        """Nested dict of plain values, as stored in artefacts; `load_scenario` takes it back."""
        return dataclasses.asdict(self)


def available_scenarios() -> list[str]:
    """Names of the scenarios that come with the package."""
    return sorted(path.stem for path in _FOLDER.glob("*.toml"))


def load_scenario(
    scenario: str | Path | Mapping[str, Any] = "heading_keeping",
    overrides: Mapping[str, Any] | None = None,
) -> Scenario:
    """Load a scenario and replace some of its keys.

    Parameters
    ----------
    scenario : str, path or mapping
        One of `available_scenarios()`, the path of a ``.toml`` file, or a nested mapping.
    overrides : mapping, optional
        Nested (``{"reward": {"rudder": 1.0}}``) or dotted (``{"reward.rudder": 1.0}``) keys.

    Raises
    ------
    ConfigError
        Unknown scenario or key (with the nearest one), or a value that is not allowed.
    """
    if isinstance(scenario, Mapping):
        base, where = dict(scenario), "scenario"
    elif str(scenario).endswith(".toml"):
        base, where = read_toml(scenario), str(scenario)
    else:
        name = check_known("scenario", str(scenario), available_scenarios())
        base, where = read_toml(_FOLDER / f"{name}.toml"), f"scenario {name}"
    return build(Scenario, merged(base, _nested(overrides or {})), where)


def _nested(overrides: Mapping[str, Any]) -> dict[str, Any]:
    """Dotted keys as nested mappings."""
    result: dict[str, Any] = {}
    for key, value in overrides.items():
        *path, last = str(key).split(".")
        nested: dict[str, Any] = {last: value}
        for part in reversed(path):
            nested = {part: nested}
        result = merged(result, nested)
    return result
