"""Search space of hyperparameters: ranges by dotted name, from a TOML file.

A range is ``{ low = 1e-4, high = 3e-3, log = true }``, of whole numbers if both ends are, or
``{ choices = [...] }``. The package has a file for each algorithm in ``ranges``.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError, check_known, check_number, shown
from ship_gym.reading import read_toml
from ship_gym_agents.sb3.config import run_config
from ship_gym_agents.sb3.sections import partial

RANGES = Path(__file__).with_name("ranges")


@dataclasses.dataclass(frozen=True)
class Range:
    """Values of one hyperparameter.

    Attributes
    ----------
    low, high : float or int
        Ends, included; whole numbers if both are.
    log : bool
        Search evenly on a logarithmic scale.
    choices : tuple
        Instead of ends: one of these.
    """

    low: float | None = None
    high: float | None = None
    log: bool = False
    choices: tuple[Any, ...] = ()

    def __post_init__(self):
        ends = (self.low, self.high)
        for name in ("low", "high"):
            if getattr(self, name) is not None:
                check_number(name, getattr(self, name))
        if not isinstance(self.log, bool):
            raise ConfigError(f"log = {shown(self.log)}: must be true or false")
        if self.choices:
            if ends != (None, None) or self.log:
                raise ConfigError("choices beside low, high or log: allowed is one or the other")
            return
        if self.low is None or self.high is None or not self.low < self.high:
            raise ConfigError(f"low = {self.low}, high = {self.high}: needed are low < high")
        if self.log and self.low <= 0.0:
            raise ConfigError(f"low = {self.low} with log = true: allowed is low above 0")

    @property
    def whole(self) -> bool:
        """Whether these are whole numbers between two ends."""
        return not self.choices and isinstance(self.low, int) and isinstance(self.high, int)

    @property
    def samples(self) -> tuple[Any, ...]:
        """Values to try out whether they are allowed."""
        return self.choices or (self.low, self.high)

    def suggest(self, trial: Any, name: str) -> Any:
        """The value that a trial of Optuna draws."""
        if self.choices:  # as text: Optuna's choices are no lists
            return json.loads(trial.suggest_categorical(name, [*map(json.dumps, self.choices)]))
        if self.whole:
            return trial.suggest_int(name, self.low, self.high, log=self.log)
        return float(f"{trial.suggest_float(name, self.low, self.high, log=self.log):.4g}")

    def parameter(self, value: Any) -> Any:
        """A value as Optuna keeps it; None if it is not in the range."""
        if self.choices:
            found = _plain(value) in [*map(_plain, self.choices)]
            return json.dumps(_plain(value)) if found else None
        if not isinstance(value, int | float) or self.low is None or self.high is None:
            return None
        return value if self.low <= value <= self.high else None


def load_ranges(algorithm: str, source: str | Path | None, given: Mapping[str, Any]):
    """Ranges by dotted name, each of its values tried out on the config.

    Parameters
    ----------
    algorithm : str
    source : path, optional
        A TOML file in the place of the package's own for the algorithm.
    given : mapping
        Arguments of ``run_config``.

    Returns
    -------
    dict of str to Range

    Raises
    ------
    ConfigError
        A file without ranges, an unknown key, a range that is none or a value not allowed.
    """
    file = RANGES / f"{algorithm}.toml" if source is None else Path(source)
    values = partial(read_toml(file), file.name)
    has_base = bool(run_config(**given).hyperparameters.form.base)
    found = {}
    for section, keys in values.items():
        if section == "form" and source is None and not has_base:
            continue
        for key, range_ in keys.items():
            name = f"{section}.{key}"
            if not isinstance(range_, Mapping):
                raise ConfigError(
                    f"{file.name}: {name} = {shown(range_)}: must be low, high or choices"
                )
            found[name] = _checked(name, range_, given, file.name)
    if not found:
        raise ConfigError(f"{file}: names no range to search")
    return found


def _checked(name: str, values: Mapping[str, Any], given: Mapping[str, Any], file: str) -> Range:
    """The range, all its ends or choices accepted by the config one by one."""
    try:
        for key in values:
            check_known("key of a range", key, [field.name for field in dataclasses.fields(Range)])
        if not isinstance(choices := values.get("choices", []), list):
            raise ConfigError(f"choices = {shown(choices)}: must be a list")
        made = Range(**{**values, "choices": tuple(choices)})
    except ConfigError as error:
        raise ConfigError(f"{file}: {name}: {error}") from None
    for value in made.samples:
        try:
            run_config(**with_settings(given, {name: value}))
        except ConfigError as error:
            raise ConfigError(f"{file}: {name} with {shown(value)}: {error}") from None
    return made


def with_settings(given: Mapping[str, Any], settings: Mapping[str, Any]) -> dict[str, Any]:
    """Arguments of ``run_config`` with further settings by dotted name."""
    return {**given, "settings": {**(given.get("settings") or {}), **settings}}


def start_of(ranges: Mapping[str, Range], given: Mapping[str, Any]) -> dict[str, Any]:
    """Parameters of the trial that is the config as it is, as far as they are in the ranges."""
    hyper = _plain(dataclasses.asdict(run_config(**given).hyperparameters))
    found = {}
    for name, one in ranges.items():
        section, key = name.split(".", 1)
        value = one.parameter(hyper[section].get(key))
        if value is not None:
            found[name] = value
    return found


def _plain(value: Any) -> Any:
    """As JSON gives it back: tuples are lists."""
    return json.loads(json.dumps(value))
