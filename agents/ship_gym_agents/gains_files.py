"""Files of tuned gains, one for each kind of controller and ship: ``gains/<kind>_<ship>.toml``.

Beside it there may be one of a task, ``gains/<kind>_<ship>.<task>.toml``, with the key ``task``; a
controller that sails this task takes it, for all others the one without a task is meant.

A controller with gains has a class attribute `KIND`, its name in files, and a class method
``first_gains(ship) -> GainsOfIt``, whose annotation says what its gains are; its first argument is
such gains. A file without the key ``controller`` is of a ``pid``.
"""

from __future__ import annotations

import dataclasses
import os
import typing
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError, build, shown
from ship_gym.keys import Keys
from ship_gym.reading import read_toml
from ship_gym.ships.particulars import Ship
from ship_gym.tasks import TASKS
from ship_gym.writing import atomic_path

GAINS = Path(__file__).parent / "gains"


@dataclasses.dataclass(frozen=True)
class GainsFile:
    """What a file of gains holds: what they are for and how they were found.

    Attributes
    ----------
    ship : str
        Name.
    gains : object
        Dataclass of the controller.
    tuning : dict
        Provenance, see ``ship_gym_agents.tuning.record``.
    versions : dict
    controller : str
        Kind, or ``file.py:Class`` of one's own.
    task : str, optional
        The only task that they are for; None: the gains of the ship in general.
    """

    ship: str
    gains: Any
    tuning: dict[str, Any]
    versions: dict[str, str]
    controller: str = "pid"
    task: str | None = None


@dataclasses.dataclass(frozen=True)
class _Raw:
    """`GainsFile` with its gains as they are written."""

    ship: str
    gains: dict[str, Any]
    tuning: dict[str, Any]
    versions: dict[str, str]
    controller: str = "pid"
    task: str | None = None


def gains_path(ship: str, kind: str = "pid", task: str | None = None) -> Path:
    """File of the tuned gains of a ship of the package, in general or of a task."""
    return GAINS / (f"{kind}_{ship}.toml" if task is None else f"{kind}_{ship}.{task}.toml")


def task_of(path: str | Path) -> str | None:
    """The task in the name of a file of gains; None if it names none."""
    last = Path(path).stem.rpartition(".")[2]
    return last if last in TASKS and last != Path(path).stem else None


def own_gains() -> Path:
    """Folder of a user's gains for ships that the package has none for."""
    data = os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share"
    return Path(data) / "ship_gym" / "gains"


def place_for_gains(ship: str, kind: str = "pid", task: str | None = None) -> Path:
    """Where newly tuned gains of a ship belong: the package of a checkout, else `own_gains`.

    Raises
    ------
    ConfigError
        An installed package has gains of this ship: what `kind` means there stays the same.
    """
    path = gains_path(ship, kind, task)
    if (GAINS.parents[2] / "pyproject.toml").is_file():
        return path
    if path.is_file() or gains_path(ship, kind).is_file():
        raise ConfigError(
            f"ship {ship!r} comes with {kind} gains in the installed package; name a file for "
            f"yours: --out runs/{path.name}"
        )
    return own_gains() / path.name


def find_gains(ship: str, kind: str = "pid", task: str | None = None) -> Path | None:
    """File of the tuned gains of a ship, of the package or a user's own; None if there is none.

    In each folder that of the task comes before the general one.
    """
    names = [gains_path(ship, kind, one).name for one in dict.fromkeys((task, None))]
    files = (folder / name for folder in (GAINS, own_gains()) for name in names)
    return next((path for path in files if path.is_file()), None)


def tuned_files(kind: str = "pid") -> list[Path]:
    """All files of tuned gains of a kind, general ones and those of tasks."""
    return sorted(p for folder in (GAINS, own_gains()) for p in folder.glob(f"{kind}_*.toml"))


def tuned_ships(kind: str = "pid") -> list[str]:
    """Names of the ships with tuned gains in general."""
    general = [path for path in tuned_files(kind) if task_of(path) is None]
    return sorted({path.stem.removeprefix(f"{kind}_") for path in general})


def gains_type(controller: type[Any]) -> type:
    """The dataclass of a controller's gains: what its ``first_gains`` is annotated to return."""
    return typing.get_type_hints(controller.first_gains)["return"]


def kind_of(path: str | Path) -> str:
    """Kind of controller that a file of gains is for."""
    return Keys(read_toml(path), str(path)).text("controller", "pid")


def load_gains(path: str | Path, controller: type[Any]) -> GainsFile:
    """Read a file of gains, strictly; a wrong file is a ConfigError with its path and key.

    Parameters
    ----------
    path : str or path
    controller : type
        The class that takes them.
    """
    raw = build(_Raw, read_toml(path), str(path))
    gains = build(gains_type(controller), raw.gains, f"{path}.gains")
    return GainsFile(raw.ship, gains, raw.tuning, raw.versions, raw.controller, raw.task)


def find_tuned(ship: Ship, controller: type[Any], task: str | None = None) -> GainsFile | None:
    """The tuned gains that `find_gains` finds; None if there are none.

    Raises
    ------
    ConfigError
        A wrong file, or one that is of another task than its name says.
    """
    path = find_gains(ship.name, controller.KIND, task)
    if path is None:
        return None
    found, named = load_gains(path, controller), task_of(path)
    if found.task != named:
        allowed = "no such key" if named is None else repr(named)
        raise ConfigError(
            f"{path}.task = {shown(found.task)}: by the file's name allowed is {allowed}"
        )
    return found


def tuned_file(ship: Ship, controller: type[Any], task: str | None = None) -> GainsFile:
    """File of the tuned gains of a ship, or a ConfigError that says how to tune them."""
    found, kind = find_tuned(ship, controller, task), controller.KIND
    if found is None:
        option = "" if kind == "pid" else f"--controllers {kind} "
        raise ConfigError(
            f"no {kind} gains for ship {shown(ship.name)} (tuned: {', '.join(tuned_ships(kind))}); "
            f"tune them with: ship-gym tune {option}--ship NAME_OR_FILE --out mine.toml, then take "
            "the controller 'mine.toml', in Python make_controller('mine.toml')"
        )
    return found


def write_gains(found: GainsFile, path: str | Path | None = None) -> Path:
    """Write a file of gains, by default to `place_for_gains`, where the controller finds them."""
    place = place_for_gains(found.ship, found.controller, found.task) if path is None else path
    path, data = Path(place), _given(dataclasses.asdict(found))
    first: tuple[str, ...] = ("controller", "ship", "task")
    head = {key: data.pop(key) for key in first if key in data}
    lines = ["# Gains of a controller; written by ship-gym tune", *_toml({**head, **data})]
    with atomic_path(path) as temporary:
        temporary.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def _given(data: Mapping[str, Any]) -> dict[str, Any]:
    """Nested mapping without what is None, for which TOML has no word."""
    nested = {k: _given(v) if isinstance(v, Mapping) else v for k, v in data.items()}
    return {k: v for k, v in nested.items() if v is not None}


def _toml(data: Mapping[str, Any], section: str = "") -> list[str]:
    """Lines of a nested mapping of strings, numbers and lists."""
    lines = [f"{_key(k)} = {_literal(v)}" for k, v in data.items() if not isinstance(v, Mapping)]
    for key, value in data.items():
        if isinstance(value, Mapping):
            name = f"{section}{_key(key)}"
            lines += ["", f"[{name}]", *_toml(value, f"{name}.")]
    return lines


def _key(name: str) -> str:
    return name if name.replace("_", "").replace("-", "").isalnum() else f'"{name}"'


def _literal(value: object) -> str:
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_literal, value)) + "]"
    if isinstance(value, int | float):
        return repr(value)
    raise ConfigError(f"cannot write {shown(value)} to a gains file")
