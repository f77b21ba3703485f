"""Whether a file that was named may be replaced: only one that holds the same thing, or --force.

A result says what it is: a policy which one, gains their controller and ship, a table its ship,
a recording its controller, seed and scenario. Pictures and pages are drawn from results and say
nothing; they are replaced.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from ship_gym.config import ConfigError


class Result(NamedTuple):
    """What a file holds: in words, and plain values by which two are the same."""

    words: str
    facts: Any


def check_replaced(path: Path | None, result: Result, force: bool, option: str = "--out") -> None:
    """Refuse to replace a file that holds something else than a result.

    Parameters
    ----------
    path : Path or None
        The file that was named; None: none was, and the usual place is written.
    result : Result
        What is to be written.
    force : bool
        It may hold anything.
    option : str
        Who named it.

    Raises
    ------
    ConfigError
        It holds the result of another run, or nothing that Ship Gym has written.
    """
    if path is None or force or not path.is_file() or path.stat().st_size == 0:
        return
    there = result_in(path)
    if there is None or _plain(there.facts) != _plain(result.facts):
        words = "no such result" if there is None else there.words
        if words == result.words:
            words += " with other settings"
        raise ConfigError(f"{option} {path}: holds {words}, not {result.words}; see --force")


def _plain(facts: Any) -> Any:
    return json.loads(json.dumps(facts, default=str))


def result_in(path: Path) -> Result | None:
    """What a file of a result holds; None: nothing that Ship Gym has written."""
    reader = _READERS.get(path.suffix.lower())
    try:
        return reader(path) if reader else None
    except Exception:  # whatever a reader says: it is no such result
        return None


def policy(card: dict[str, Any]) -> Result:
    """A policy, by its card."""
    return Result(f"the policy {card['name']}", ["policy", card["name"], card.get("config")])


def gains(controller: str, ship: str, task: str | None) -> Result:
    """Gains of a controller."""
    return Result(f"gains of {controller} for {ship}", ["gains", controller, ship, task])


def wave_table(ship: str, grid: dict[str, Any]) -> Result:
    """A table of drift forces and motions; a coarse one is another than a fine one of hours."""
    return Result(f"a wave table of {ship}", ["wave table", ship, grid])


def surrogate(data: str, ship: str) -> Result:
    """A fitted table of forces."""
    return Result(f"a surrogate of {data} for {ship}", ["surrogate", data, ship])


def recording(controller: str, seed: int, config: dict[str, Any]) -> Result:
    """An episode, by its scenario."""
    words = f"a recording of {controller}, {config['ship']}, seed {seed}"
    return Result(words, ["recording", controller, seed, config])


def manoeuvre(ship: str) -> Result:
    """A manoeuvre of a ship."""
    return Result(f"a manoeuvre of {ship}", ["manoeuvre", ship])


EVALUATION = Result("an evaluation", "evaluation")
BOUND = Result("an estimate of the bound", "bound")


def _policy_in(path: Path) -> Result:
    from ship_gym_agents.policies.policy_file import read_card

    return policy(read_card(path))


def _onnx_in(path: Path) -> Result:
    from ship_gym_agents.policies.onnx_export import exported_card

    return policy(exported_card(path))


def _gains_in(path: Path) -> Result:
    from ship_gym.reading import read_toml

    found = read_toml(path)
    found["gains"], found["tuning"]
    return gains(found.get("controller", "pid"), found["ship"], found.get("task"))


def _table_in(path: Path) -> Result:
    from ship_gym.sea.wave_table import WaveTable
    from ship_gym.tables import Table

    try:
        card = WaveTable.load(path).card
        return wave_table(card["ship"], card["grid"])
    except ConfigError:
        card = Table.load(path).card
        return surrogate(card["data"], card["made_for"]["ship"])


def _history_in(path: Path) -> Result:
    from ship_gym.recording import Trajectory

    return _history(Trajectory.from_file(path).meta)


def _csv_in(path: Path) -> Result:
    from ship_gym.reading import read_text

    head, lines = [], read_text(path).splitlines()
    if not lines[0].startswith("# Ship Gym trajectory"):
        raise ValueError("not a time history of Ship Gym")
    for line in lines[1:]:
        if not line.startswith("# "):
            break
        head.append(line[2:])
    return _history(json.loads("\n".join(head)))


def _history(meta: dict[str, Any]) -> Result:
    if "controller" in meta:
        return recording(meta["controller"], meta["seed"], meta["config"])
    return manoeuvre(meta["ship"]["name"])


def _json_in(path: Path) -> Result | None:
    from ship_gym.reading import read_json

    found = read_json(path)
    if {"front", "headroom_percent"} & found.keys():
        return BOUND
    return EVALUATION if {"controllers", "differences"} <= found.keys() else None


_READERS: dict[str, Callable[[Path], Result | None]] = {
    ".safetensors": _policy_in,
    ".onnx": _onnx_in,
    ".toml": _gains_in,
    ".npz": _table_in,
    ".rrd": _history_in,
    ".csv": _csv_in,
    ".json": _json_in,
}
