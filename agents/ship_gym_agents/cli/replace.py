"""Whether a file that was named may be replaced: only one that holds the same thing, or --force.

A result says what it is: a policy which one, gains their controller and ship, a table its ship,
a recording its controller, seed and scenario; ``replace_read`` reads it from a file. Pictures are
drawn from results and say nothing; they are replaced.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from ship_gym.config import ConfigError


class Result(NamedTuple):
    """What a file holds: in words, and plain values by which two are the same.

    One that is to be written may have only the first of them: the rest is not known yet.
    """

    words: str
    facts: Sequence[Any]


class Named(NamedTuple):
    """A file that was named, None if none was, and whether it may hold anything."""

    file: Path | None
    force: bool

    def check(self, result: Result, option: str = "--out") -> None:
        """As `check_replaced`."""
        check_replaced(self.file, result, self.force, option)


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
    from ship_gym_agents.cli.replace_read import result_in

    there = result_in(path)
    if there is None or _plain(there.facts)[: len(result.facts)] != _plain(result.facts):
        words = "no such result" if there is None else there.words
        if words == result.words:
            words += " with other settings"
        raise ConfigError(f"{option} {path}: holds {words}, not {result.words}; see --force")


def check_recordings(
    file_of: Callable[[str, Any], Path],
    controllers: Iterable[str],
    seeds: Sequence[int | None],
    config: Mapping[str, Any],
    force: bool,
    option: str = "--out",
) -> None:
    """Refuse to replace other recordings in a folder that was named.

    Parameters
    ----------
    file_of : callable
        The file of a controller and a seed.
    controllers : iterable of str
    seeds : sequence of int or None
        Of all episodes that may be recorded; None: any.
    config : mapping
        The scenario.
    force : bool
    option : str
    """
    for name in controllers:
        for seed in seeds:
            check_replaced(file_of(name, seed), recording(name, seed, config), force, option)


def _plain(facts: Any) -> Any:
    return json.loads(json.dumps(facts, default=str))


def policy(card: Mapping[str, Any]) -> Result:
    """A policy, by its card."""
    return Result(f"the policy {card['name']}", ["policy", card["name"], card.get("config")])


def gains(controller: str, ship: str, task: str | None) -> Result:
    """Gains of a controller."""
    return Result(f"gains of {controller} for {ship}", ["gains", controller, ship, task])


def wave_table(ship: str, grid: Mapping[str, Any]) -> Result:
    """A table of drift forces and motions; a coarse one is another than a fine one of hours."""
    return Result(f"a wave table of {ship}", ["wave table", ship, grid])


def surrogate(data: str, ship: str) -> Result:
    """A fitted table of forces."""
    return Result(f"a surrogate of {data} for {ship}", ["surrogate", data, ship])


def recording(controller: str, seed: int | None, config: Mapping[str, Any]) -> Result:
    """An episode, by its scenario; of any seed if None is given."""
    words = f"a recording of {controller}, {config['ship']}"
    facts = ["recording", controller, config]
    return Result(words, facts) if seed is None else Result(f"{words}, seed {seed}", [*facts, seed])


def manoeuvre(ship: str) -> Result:
    """A manoeuvre of a ship that is yet to be sailed."""
    return Result(f"a manoeuvre of {ship}", ["manoeuvre", ship])


def history(meta: Mapping[str, Any]) -> Result:
    """A time history, by its meta: an episode, a manoeuvre with all that was set, or another."""
    config, ship = meta.get("config"), meta.get("ship")
    if isinstance(config, Mapping) and "controller" in meta and "ship" in config:
        return recording(meta["controller"], meta.get("seed"), config)
    if isinstance(ship, Mapping) and {"name", "surrogate", "variant"} <= ship.keys():
        task = meta.get("task")
        facts = ["manoeuvre", ship["name"], task, ship["surrogate"], ship["variant"], config]
        return Result(f"the manoeuvre {task} of {ship['name']}", facts)
    return Result("a time history", ["history", meta.get("task"), ship, config, meta.get("seed")])


def voyage(mark: str) -> Result:
    """A sailed track on the earth, by what ``recording.earth_files`` says of its record."""
    return Result(f"the track of this recording ({mark.split()[-1]})", ["voyage", mark])


def comparison(sources: Sequence[Mapping[str, Any]]) -> Result:
    """A comparison of recordings, by what ``comparison_card.sources`` says of them."""
    names = ", ".join(str(one.get("name")) for one in sources)
    keys = ("name", "controller", "seed", "ship", "config")
    facts = [[one.get(key) for key in keys] for one in sources]
    return Result(f"a comparison of {names}", ["comparison", facts])


def evaluation(
    scenario: Mapping[str, Any], ship: str, seeds: Sequence[int], controllers: Iterable[str]
) -> Result:
    """An evaluation, by what was sailed."""
    return Result(f"an evaluation of {ship}", ["evaluation", scenario, ship, seeds, [*controllers]])


def bound(asked: Mapping[str, Any]) -> Result:
    """An estimate of the bound, by what was asked for."""
    return Result(f"an estimate of the bound of {asked['ship']}", ["bound", asked])


def trials(ships: Iterable[str]) -> Result:
    """Computed values of the trials of ships."""
    ships = sorted(set(ships))
    return Result(f"values of the trials of {', '.join(ships)}", ["trials", ships])


def route(made: Mapping[str, Any], path: Path) -> Result:
    """A route in a file, by all that every format keeps.

    RTZ numbers the way-points of a route that has no numbers and names one without a name after
    the file; its nautical miles and knots come back as metres but for the last bits.
    """
    name = made["name"] or (path.stem if path.suffix.lower() == ".rtz" else "")
    points = [{**point, "id": None} for point in made["waypoints"]]
    kept = [[_rounded(part) for part in parts] for parts in (points, made["legs"])]
    return Result(f"the route {name!r}", ["route", name, *kept])


def _rounded(values: Mapping[str, Any]) -> dict[str, Any]:
    return {key: round(v, 9) if isinstance(v, float) else v for key, v in values.items()}


def fitted_ship(ship: str) -> Result:
    """A ship file whose numbers were fitted, by the ship that it began with."""
    return Result(f"a ship fitted from {ship}", ["fitted ship", ship])


def fmu(ship: str) -> Result:
    """A ship as a unit of co-simulation; what its parameters start with does not matter."""
    return Result(f"an FMU of {ship}", ["fmu", ship])


def page(verb: str) -> Result:
    """A page that a verb writes; it is drawn from results, so that which ones does not matter."""
    return Result(f"a page of ship-gym {verb}", ["page", verb])
