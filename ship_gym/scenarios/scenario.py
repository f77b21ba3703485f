"""Scenario: everything that defines an environment, read from one TOML file per id."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError, build, check_known, check_number, merged, read_toml
from ship_gym.scenarios.sea_range import SeaRange
from ship_gym.scenarios.sections import (
    Course,
    Failure,
    Limits,
    Randomisation,
    Reward,
    Sensors,
    Start,
    TrackRange,
)

_FOLDER = Path(__file__).parent
TASKS = ("heading_keeping", "course_changing", "track_following")
CONTROLS = ("rudder", "rudder+rpm")


@dataclasses.dataclass(frozen=True)
class Scenario:
    """Task, ship, control, times [full-scale s] and the sections of an environment.

    Attributes
    ----------
    task : str
        One of `TASKS`.
    ship : str
        One of ``available_ships()`` or the path of a ship file.
    surrogate : str
        One of ``available_surrogates(ship)``; None: the ship's own.
    control : str
        ``rudder`` or ``rudder+rpm``.
    control_interval, duration : float
        At full scale [s]; a model gets them Froude-scaled.
    privileged : bool
        Append what no bridge knows to the observation: waves, wind, current and forces.
    start, sea, limits, reward, course, track, sensors, randomisation, failure
        Sections, see their classes.
    """

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
    privileged: bool = False
    course: Course = dataclasses.field(default_factory=Course)
    track: TrackRange = dataclasses.field(default_factory=TrackRange)
    sensors: Sensors = dataclasses.field(default_factory=Sensors)
    randomisation: Randomisation = dataclasses.field(default_factory=Randomisation)
    failure: Failure = dataclasses.field(default_factory=Failure)

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
        self._check_start()
        self._check_unused()
        other = "heading" if self.on_track else "cross_track"
        if getattr(self.reward, other) > 0.0:
            raise ConfigError(
                f"reward.{other} = {getattr(self.reward, other)}: allowed is 0 for task "
                f"{self.task!r}, which is paid for {self.error_term!r}"
            )

    def _check_start(self) -> None:
        name, unit = ("cross_track", "L") if self.on_track else ("heading_error_deg", "deg")
        start, limit = getattr(self.start, name), getattr(self.limits, name)
        if start >= limit and not (unit == "deg" and limit == 180.0):
            raise ConfigError(f"start.{name} = {start}: must be below limits.{name} = {limit}")

    def _check_unused(self) -> None:
        """Refuse what only another task uses: a key that does nothing is a mistake."""
        nominal = Limits().cross_track
        unused = {
            "course": self.task != "course_changing" and self.course != Course(),
            "track": not self.on_track and self.track != TrackRange(),
            "start.cross_track": not self.on_track and self.start.cross_track > 0.0,
            "limits.cross_track": not self.on_track and self.limits.cross_track != nominal,
        }
        for key, given in unused.items():
            if given:
                raise ConfigError(f"{key}: task {self.task!r} does not use it; leave it out")

    @property
    def on_track(self) -> bool:
        """Whether the task is to sail a track, not a heading."""
        return self.task == "track_following"

    @property
    def error_term(self) -> str:
        """Name of the reward term of the error: ``heading`` or ``cross_track``."""
        return "cross_track" if self.on_track else "heading"

    @property
    def steps(self) -> int:
        """Control intervals until truncation."""
        return round(self.duration / self.control_interval)

    def to_dict(self) -> dict[str, Any]:
        """Nested dict of plain values, as JSON keeps them; `load_scenario` takes it back."""
        return json.loads(json.dumps(dataclasses.asdict(self)))


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
        One of `available_scenarios()`, the path of a ``.toml`` file, or a nested mapping. With a
        key ``base``, the name of another scenario, only what differs from that is in it.
    overrides : mapping, optional
        Nested (``{"reward": {"rudder": 1.0}}``) or dotted (``{"reward.rudder": 1.0}``) keys.

    Raises
    ------
    ConfigError
        Unknown scenario or key (with the nearest one), or a value that is not allowed.
    """
    values, where = _read(scenario)
    return build(Scenario, merged(values, _nested(overrides or {})), where)


def _read(scenario: str | Path | Mapping[str, Any], depth: int = 0) -> tuple[dict[str, Any], str]:
    """Values of a scenario on top of those of its base, and where they come from."""
    if isinstance(scenario, Mapping):
        values, where = dict(scenario), "scenario"
    elif str(scenario).endswith(".toml"):
        values, where = _beside(Path(scenario), read_toml(scenario)), str(scenario)
    else:
        name = check_known("scenario", str(scenario), available_scenarios())
        values, where = read_toml(_FOLDER / f"{name}.toml"), f"scenario {name}"
    if "base" not in values:
        return values, where
    if depth > 5:
        raise ConfigError(f"{where}: base = {values['base']!r}: more than five deep, or a circle")
    base, _ = _read(values.pop("base"), depth + 1)
    return merged(base, values), where


def _beside(path: Path, values: dict[str, Any]) -> dict[str, Any]:
    """Values with the files that they name as paths from the folder of the scenario file."""
    values, track = dict(values), values.get("track")
    for key in ("base", "ship"):
        if str(values.get(key, "")).endswith(".toml"):
            values[key] = str(path.parent / values[key])
    if isinstance(track, Mapping) and isinstance(track.get("file"), str) and track["file"]:
        values["track"] = {**track, "file": str(path.parent / track["file"])}
    return values


def _nested(overrides: Mapping[str, Any]) -> dict[str, Any]:
    """Dotted keys as nested mappings."""
    result: dict[str, Any] = {}
    for key, value in overrides.items():
        *path, last = str(key).split(".")
        nested: dict[str, Any] = {last: value}
        for part in reversed(path):
            nested = {part: nested}
        section = path[0] if path else last
        if section in result and not (
            isinstance(result[section], Mapping) and isinstance(nested[section], Mapping)
        ):
            raise ConfigError(
                f"overrides: {section!r} is given twice, and not as keys of a section"
            )
        result = merged(result, nested)
    return result
