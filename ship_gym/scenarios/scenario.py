"""Scenario: everything that defines an environment, read from one TOML file per id."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError, build, check_known, check_number, merged, read_toml
from ship_gym.sea.spectra import WaveSystem
from ship_gym.sea.state import Sea

_FOLDER = Path(__file__).parent
TASKS = ("heading_keeping",)
CONTROLS = ("rudder", "rudder+rpm")


@dataclasses.dataclass(frozen=True)
class Start:
    """Distribution of the start."""

    heading_error_deg: float


@dataclasses.dataclass(frozen=True)
class SeaRange:
    """Distribution of the sea, everything at full scale.

    Attributes
    ----------
    current_speed : float
        Uniform from 0 to this [m/s], any direction.
    sway_disturbance, yaw_disturbance, correlation_time : float
        As in ``sea.Sea``.
    wave_height, wave_height_min : float
        Significant height, uniform from `wave_height_min` to `wave_height` [m], any direction.
    peak_period, spectrum, spreading, wave_count, drift, surge_model
        As in ``sea.Sea`` and ``sea.spectra.WaveSystem``.
    wind_speed : float
        Uniform from 0 to this [m/s], from where the waves come.
    gusts : bool
    """

    current_speed: float
    sway_disturbance: float
    yaw_disturbance: float
    correlation_time: float
    wave_height: float = 0.0
    wave_height_min: float = 0.0
    peak_period: float = 8.8
    spectrum: str = "bretschneider"
    spreading: float = 0.0
    wave_count: int = 60
    drift: str = "slow"
    surge_model: str = "blend"
    wind_speed: float = 0.0
    gusts: bool = False

    def sea(self) -> Sea:
        """The sea with the largest waves and wind, at full scale, without current.

        Raises
        ------
        ConfigError
            A value that no sea has.
        """
        check_number("sea.wave_height_min", self.wave_height_min, 0.0, self.wave_height, "m")
        waves = WaveSystem(
            self.spectrum, self.wave_height, self.peak_period, spreading=self.spreading
        )
        return Sea(
            sway_disturbance=self.sway_disturbance,
            yaw_disturbance=self.yaw_disturbance,
            correlation_time=self.correlation_time,
            waves=(waves,) if self.wave_height > 0.0 else (),
            wave_count=self.wave_count,
            drift=self.drift,
            surge_model=self.surge_model,
            wind_speed=self.wind_speed,
            gusts=self.gusts,
        )


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
        self.sea.sea()  # refuses what no sea has
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
