"""Scenario: everything that defines an environment, read from one TOML file per id."""

from __future__ import annotations

import dataclasses
import functools
import json
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from ship_gym.config import ConfigError, build, check_known, check_number, merged, shown, told_of
from ship_gym.reading import read_toml
from ship_gym.scenarios.sea_range import SeaRange
from ship_gym.scenarios.sections import Failure, Randomisation, Sensors
from ship_gym.tasks import TASKS, bridge, measures, privileged
from ship_gym.tasks.base import NoLimits, Start, Task
from ship_gym.tasks.bridge import COMMON_FIELDS
from ship_gym.tasks.columns import ACTIONS
from ship_gym.tasks.rewards import COSTS, reward_section

_FOLDER = Path(__file__).parent


@dataclasses.dataclass(frozen=True, kw_only=True)
class Scenario:
    """Task, ship, control, times [full-scale s] and the sections of an environment.

    The task brings sections of its own, `start`, `limits` and `reward` among them: the scenario of
    a task is a subclass that has them as fields (`scenario_class`).

    Attributes
    ----------
    task : str
        One of ``ship_gym.tasks.TASKS``.
    ship : str
        One of ``available_ships()`` or the path of a ship file.
    surrogate : str
        One of ``available_surrogates(ship)``; None: the ship's own.
    control : str
        ``rudder`` or ``rudder+rpm``.
    astern : float
        How far ``rudder+rpm`` may brake: largest propeller speed astern by n_max (0: not at all;
        the engine's own limit holds too).
    speed : float
        Share of the ship's nominal speed at which she sails: what a scenario calls U0, to which
        everything non-dimensional refers (observation, rewards, gains), and the propeller speed
        without rpm control is that of self-propulsion at it. Resistance coefficients stay those of
        the ship file.
    control_interval, duration : float
        At full scale [s]; a model gets them Froude-scaled.
    privileged : bool
        Append what no bridge knows to the observation: waves, wind, current and forces.
    sea, sensors, randomisation, failure
        Sections, see their classes.
    """

    task: str
    ship: str
    control: str
    control_interval: float
    duration: float
    sea: SeaRange
    surrogate: str | None = None
    speed: float = 1.0
    astern: float = 0.0
    privileged: bool = False
    sensors: Sensors = dataclasses.field(default_factory=Sensors)
    randomisation: Randomisation = dataclasses.field(default_factory=Randomisation)
    failure: Failure = dataclasses.field(default_factory=Failure)

    # What it was loaded from: its name and the values there. No field, so that it is no part of
    # what defines an environment: two scenarios of the same values are equal.
    _source: ClassVar[tuple[str, Mapping[str, Any]] | None] = None

    if TYPE_CHECKING:  # the sections that its task brings: `start`, `limits`, `reward`

        def __getattr__(self, name: str) -> Any: ...

    def __post_init__(self) -> None:
        check_known("control", self.control, ACTIONS)
        check_number("speed", self.speed, 0.1, 2.0)
        check_number("astern", self.astern, 0.0, 1.0)
        check_number("control_interval", self.control_interval, 0.05, 60.0, "s")
        check_number("duration", self.duration, self.control_interval, 1e6, "s")
        if abs(self.duration / self.control_interval - self.steps) > 1e-9 * self.steps:
            raise ConfigError(
                f"duration = {self.duration}: must be a multiple of control_interval = "
                f"{self.control_interval}"
            )
        TASKS[self.task].check(self)

    @property
    def steps(self) -> int:
        """Control intervals until truncation."""
        return round(self.duration / self.control_interval)

    def to_dict(self) -> dict[str, Any]:
        """Nested dict of plain values, as JSON keeps them; `load_scenario` takes it back."""
        return json.loads(json.dumps(dataclasses.asdict(self)))

    @property
    def source(self) -> str:
        """Name or file by which it was asked for; of a mapping its base, else its task's own."""
        return self._source[0] if self._source else self.task

    def overrides(self) -> dict[str, Any]:
        """Nested dict of what differs from `source`, with the values that hold here."""
        name, values = self._source or (self.task, _read(self.task)[0])
        try:
            values = build(scenario_class(TASKS[values["task"]]), values, name).to_dict()
        except (ConfigError, KeyError):
            pass  # not whole without them
        return _difference(self.to_dict(), values)

    def with_duration(self, duration: float) -> Scenario:
        """The same of another duration [full-scale s]."""
        return _from(self._source, dataclasses.replace(self, duration=duration))

    def __reduce__(self) -> Any:
        """Pickle by values: the class is made for the task."""
        return _again, (self._source, self.to_dict())


def task_sections(task: Task) -> dict[str, type]:
    """Sections that a task brings to its scenario, name to dataclass."""
    usual = {"start": Start, "limits": NoLimits, "reward": reward_section(task.terms)}
    return usual | dict(task.sections)


def check_task(task: Task) -> None:
    """Refuse a task from outside whose names are taken already.

    Raises
    ------
    ConfigError
        Says which name, and of what.
    """
    named = f"task {task.name!r}"
    if task.name not in TASKS.own() and (_FOLDER / f"{task.name}.toml").exists():
        raise ConfigError(f"{named}: a scenario of the package has that name; choose another")
    taken = {field.name for field in dataclasses.fields(Scenario)} | set(dir(Scenario))
    _refuse_taken(f"{named}: section", task.sections, taken, "a key of every scenario")
    costs, terms = [term.name for term in COSTS], [term.name for term in task.terms]
    _refuse_taken(f"{named}: term", terms, costs, "a cost term of every task")
    fields = [name for name, _ in task.fields]
    own = [*terms, *costs, *COMMON_FIELDS]
    _refuse_taken(f"{named}: field", fields, own, "a term or a common field of the record")
    rows = [row.name for row in (*bridge.OBSERVATIONS, *privileged.OBSERVATIONS)]
    own = [row.name for row in task.observations]
    _refuse_taken(f"{named}: observation", own, rows, "a row of every task")
    _refuse_taken(f"{named}: metric", task.metrics, measures.COMMON, "a metric of every task")
    for name, metric in task.metrics.items():
        check_known(f"`better` of metric {name!r}", metric.better, ("lower", "higher"))
    check_known(f"headline of {named}", task.headline, [*task.metrics, *measures.COMMON])
    bridge.record_dtype(task)


def _refuse_taken(what: str, names: Iterable[str], taken: Iterable[str], of: str) -> None:
    double = sorted(set(names) & set(taken))
    if double:
        raise ConfigError(f"{what} {double[0]!r}: that is {of}; choose another name")


@functools.cache
def scenario_class(task: Task) -> type[Scenario]:
    """Class of the scenarios of a task."""
    fields = []
    for name, section in task_sections(task).items():
        needed = any(
            f.default is dataclasses.MISSING and f.default_factory is dataclasses.MISSING
            for f in dataclasses.fields(section)
        )
        default = () if needed else (dataclasses.field(default_factory=section),)
        fields.append((name, section, *default))
    return dataclasses.make_dataclass(
        "Scenario",
        fields,
        bases=(Scenario,),
        frozen=True,
        kw_only=True,
        namespace={"__doc__": f"Scenario of task `{task.name}`.", "__module__": __name__},
    )


def available_scenarios() -> list[str]:
    """Names of the scenarios of the package and of the tasks from outside."""
    own = {path.stem for path in _FOLDER.glob("*.toml")}
    return sorted(own | set(TASKS.outside()))


def load_scenario(
    scenario: str | Path | Mapping[str, Any] | Scenario = "heading_keeping",
    overrides: Mapping[str, Any] | None = None,
) -> Scenario:
    """Load a scenario and replace some of its keys.

    Parameters
    ----------
    scenario : str, path, mapping or Scenario
        One of `available_scenarios()`, the path of a ``.toml`` file, or a nested mapping. With a
        key ``base``, the name of another scenario, only what differs from that is in it.
    overrides : mapping, optional
        Nested (``{"reward": {"rudder": 1.0}}``) or dotted (``{"reward.rudder": 1.0}``) keys.

    Raises
    ------
    ConfigError
        Unknown scenario or key (with the nearest one), or a value that is not allowed.
    """
    if isinstance(scenario, Scenario):
        source, scenario = scenario._source, scenario.to_dict()
    else:
        source = _source_of(scenario)
    given, where = _read(scenario)
    if source is None and not isinstance(scenario, Mapping):
        source = (str(scenario), given)
    changes = _nested(overrides or {})
    values = merged(_without_other_task(given, changes), changes)
    with told_of(where):
        if "task" not in values:
            raise ConfigError("missing key 'task'")
        return _from(source, build(scenario_class(TASKS[values["task"]]), values, where))


def _source_of(scenario: str | Path | Mapping[str, Any]) -> tuple[str, Mapping[str, Any]] | None:
    """Name and values of the base of a mapping; None: it has none, or is no mapping."""
    if isinstance(scenario, Mapping) and "base" in scenario:
        given, _ = _read(scenario["base"])  # refuses what is no name
        return str(scenario["base"]), given
    return None


def _from(source: tuple[str, Mapping[str, Any]] | None, made: Scenario) -> Scenario:
    """A scenario that knows what it was loaded from."""
    object.__setattr__(made, "_source", source)
    return made


def _again(source: tuple[str, Mapping[str, Any]] | None, values: Mapping[str, Any]) -> Scenario:
    """A scenario from a pickle."""
    return _from(source, load_scenario(values))


def _difference(values: Mapping[str, Any], base: Mapping[str, Any]) -> dict[str, Any]:
    """Entries of a nested mapping that the base does not have, or has otherwise."""
    found = {}
    for key, value in values.items():
        other = base.get(key)
        if isinstance(value, Mapping) and isinstance(other, Mapping):
            if inner := _difference(value, other):
                found[key] = inner
        elif key not in base or value != other:
            found[key] = value
    return found


def _read(scenario: str | Path | Mapping[str, Any], depth: int = 0) -> tuple[dict[str, Any], str]:
    """Values of a scenario on top of those of its base, and where they come from."""
    if isinstance(scenario, Mapping):
        values: dict[str, Any] = dict(scenario)
        where = "scenario"
    elif not isinstance(scenario, str | os.PathLike):
        raise ConfigError(f"scenario = {shown(scenario)}: must be a name, a file or a mapping")
    elif str(scenario).endswith(".toml"):
        values, where = _beside(Path(scenario), read_toml(scenario)), str(scenario)
    else:
        name = check_known("scenario", str(scenario), available_scenarios())
        values, where = stated(name), f"scenario {name}"
    if "base" not in values:
        return values, where
    if depth > 5:
        base = shown(values["base"])
        raise ConfigError(f"{where}: base = {base}: more than five deep, or a circle")
    with told_of(where):
        below, _ = _read(values.pop("base"), depth + 1)
    return merged(_without_other_task(below, values), values), where


def stated(name: str) -> dict[str, Any]:
    """What a scenario of that name states itself, without its base."""
    outside = TASKS.outside()
    if name in outside:
        return {"task": name, **(outside[name].scenario or {})}
    return read_toml(_FOLDER / f"{name}.toml")


def _without_other_task(values: Mapping[str, Any], changes: Mapping[str, Any]) -> Mapping[str, Any]:
    """Values of a base without what only its task knows, where `changes` are of another task."""
    old: Any
    new: Any
    old, new = values.get("task"), changes.get("task", values.get("task"))
    if old == new or old not in TASKS or new not in TASKS:
        return values
    known = task_sections(TASKS[new])
    kept = dict(values)
    for name in task_sections(TASKS[old]):
        if name not in known:
            kept.pop(name, None)
        elif isinstance(kept.get(name), Mapping):
            keys = {field.name for field in dataclasses.fields(known[name])}
            kept[name] = {key: value for key, value in kept[name].items() if key in keys}
    return kept


def _beside(path: Path, values: dict[str, Any]) -> dict[str, Any]:
    """Values with the files that they name as paths from the folder of the scenario file."""
    values = dict(values)
    for key in ("base", "ship"):
        if isinstance(values.get(key), str) and values[key].endswith(".toml"):
            values[key] = str(path.parent / values[key])
    sections = [("sea", SeaRange)]
    sections += [pair for task in TASKS.values() for pair in task.sections.items()]
    for name, section in dict.fromkeys(sections):
        given: Any = values.get(name)
        for key in getattr(section, "PATHS", ()) if isinstance(given, Mapping) else ():
            if isinstance(given.get(key), str) and given[key]:
                values[name] = {**values[name], key: str(path.parent / given[key])}
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
