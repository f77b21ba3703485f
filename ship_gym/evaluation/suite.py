"""Suites: what a benchmark sails, one TOML file each. Those of the package are frozen.

A standard suite is a definition that figures refer to: once released, a change of its file makes it
another version. Its SHA-256 goes into every result.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError, build, check_known
from ship_gym.evaluation.manoeuvres.definition import Manoeuvre
from ship_gym.provenance import sha256
from ship_gym.reading import read_toml

ALL = "all"
KINDS = ("episodes", "manoeuvres")
TIERS = ("basic", "seaway", "expert")
ALWAYS = "constant"  # sails in every suite of episodes: what doing nothing gives
_FOLDER = Path(__file__).parent / "suites"


@dataclasses.dataclass(frozen=True)
class Entry:
    """One scenario of a suite.

    Attributes
    ----------
    name : str
        A scenario, or a file that stands beside the suite's.
    tier : str
        One of `TIERS`, or none.
    measure : str, optional
        The metric that is scored; the task's headline if None.
    control : str, optional
        Instead of the scenario's.
    controllers, ships : tuple of str
        Instead of the suite's.
    """

    name: str
    tier: str = ""
    measure: str | None = None
    control: str | None = None
    controllers: tuple[str, ...] = ()
    ships: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.tier:
            check_known(f"tier of scenario {self.name}:", self.tier, TIERS)


@dataclasses.dataclass(frozen=True)
class Suite:
    """Scenarios with the ships and controllers that sail them if none are asked for.

    Attributes
    ----------
    name, version, title : str
    kind : str
        ``episodes``: controllers in scenarios; ``manoeuvres``: trials of ships, no controllers.
    ships, controllers : tuple of str
    only : dict
        Controller -> list of the ships that it sails, where it was made for some.
    scenario : tuple of Entry
    manoeuvre : tuple of Manoeuvre
    tasks : tuple of str
        Files of tasks of one's own that the scenarios are of.
    sha256 : str
        Of the file.
    """

    name: str
    version: str
    title: str
    ships: tuple[str, ...]
    controllers: tuple[str, ...] = ()
    scenario: tuple[Entry, ...] = ()
    manoeuvre: tuple[Manoeuvre, ...] = ()
    kind: str = "episodes"
    only: dict[str, list[str]] = dataclasses.field(default_factory=dict)
    tasks: tuple[str, ...] = ()
    sha256: str = dataclasses.field(default="", init=False)

    def __post_init__(self) -> None:
        check_known(f"kind of suite {self.name}:", self.kind, KINDS)
        episodes = self.kind == "episodes"
        needed = ("controllers", "scenario") if episodes else ("manoeuvre",)
        for key in ("ships", *needed):
            if not getattr(self, key):
                raise ConfigError(f"suite {self.name}: {key}: at least one is needed")
        for key in ("ships", "controllers"):
            _check_once(f"suite {self.name}: {key}", getattr(self, key))
        named = [f"{entry.name} {entry.control or ''}".strip() for entry in self.scenario]
        _check_once(f"suite {self.name}: scenario", named)
        sailing = dict.fromkeys(self.controllers)
        for entry in self.scenario:
            for key in ("ships", "controllers"):
                _check_once(f"suite {self.name}: {key} of {entry.name}", getattr(entry, key))
            sailing |= dict.fromkeys(entry.controllers)
        for controller in self.only:
            check_known(f"controller in [only] of suite {self.name}:", controller, sailing)

    def sails(self, controller: str, ship: str) -> bool:
        """Whether a controller sails a ship if neither is asked for by name."""
        return ship in self.only.get(controller, (ship,))


def available_suites() -> list[str]:
    """Names of the suites of the package."""
    return sorted(path.stem for path in _FOLDER.glob("*.toml"))


def load_suite(suite: str | Path) -> Suite:
    """A suite by its name or its file.

    Raises
    ------
    ConfigError
        Unknown suite (with the nearest one), or a file with an unknown key or a wrong value.
    """
    own = str(suite).endswith(".toml")
    if not own:
        check_known("suite", str(suite), [*available_suites(), ALL])
    path = Path(suite) if own else _FOLDER / f"{suite}.toml"
    values = read_toml(path)
    made = build(Suite, _beside(path, values) if own else values, str(path) if own else path.name)
    object.__setattr__(made, "sha256", sha256(path))
    return made


def load_suites(suite: str | Path | Sequence[str | Path]) -> list[Suite]:
    """Suites by name or file, one or several; ``all`` means all of the package."""
    asked = [suite] if isinstance(suite, str | Path) else list(suite)
    names = [name for one in asked for name in (available_suites() if one == ALL else [one])]
    suites = [load_suite(name) for name in dict.fromkeys(names)]
    _check_once("suites", [one.name for one in suites])
    return suites


def _check_once(what: str, names: Sequence[str]) -> None:
    if double := sorted({name for name in names if list(names).count(name) > 1}):
        raise ConfigError(f"{what}: {double[0]!r} is there twice")


def _beside(path: Path, values: dict[str, Any]) -> dict[str, Any]:
    """Values with the files that they name as paths from the folder of the suite's file."""

    def there(name: Any) -> Any:
        file = isinstance(name, str) and Path(name.partition(":")[0]).suffix in (".toml", ".py")
        return str(path.parent / name) if file else name

    def each(values: dict[str, Any], *keys: str) -> dict[str, Any]:
        lists = {key: values[key] for key in keys if isinstance(values.get(key), list)}
        return values | {key: [there(name) for name in names] for key, names in lists.items()}

    values = each(values, "ships", "controllers", "tasks")
    if isinstance(values.get("only"), dict):
        only = each(values["only"], *values["only"])
        values["only"] = {there(key): ships for key, ships in only.items()}
    if isinstance(values.get("scenario"), list):
        values["scenario"] = [
            {key: there(value) for key, value in each(entry, "ships", "controllers").items()}
            if isinstance(entry, dict)
            else entry
            for entry in values["scenario"]
        ]
    return values
