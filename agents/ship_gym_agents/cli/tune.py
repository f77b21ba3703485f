"""``ship-gym tune``."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import click

from ship_gym_agents.cli.options import Several, environment, out, seed, verb
from ship_gym_agents.cli.values import Name, whole


@verb(
    "--ship kcs --episodes 64 --out runs/pid_kcs.toml",
    "--controllers pid drift_los --ship kcs kvlcc2 --resume   # the package's gains",
)
@click.option(
    "--controllers",
    "--controller",
    "controllers",
    cls=Several,
    type=Name("controllers"),
    help="Names, or your own FILE.py:CLASS, several; default: pid.",
)
@environment("heading_keeping or track_following, all ships, rudder", several_ships=True)
@click.option("--structure", cls=Several, help="Only these structures of the controller.")
@click.option("--episodes", type=whole(2, 10_000), default=24, help="Tuning seeds.")
@click.option("--generations", type=whole(1, 10_000), default=16, help="Of CMA-ES.")
@click.option("--candidates", type=whole(4, 10_000), default=20, help="In a generation.")
@click.option(
    "--polish", type=whole(0, 10_000), default=40, help="Evaluations of Nelder-Mead at the end."
)
@seed("Of the search.")
@click.option("--resume", is_flag=True, help="Leave ships with such gains alone.")
@out(".toml", "Gains; default: see above.")
def command(as_json, controllers, ships, task, resume, out, structure, **options) -> None:
    """Tune controllers by CMA-ES, then Nelder-Mead, on seeds kept for tuning.

    Headings are tuned for J_0.1, tracks for the rms distance to the track; three times as many
    further tuning seeds choose the structure and say what was gained, with its 95 % interval.

    Without --out, a checkout gets the gains in its package; of an installed package, those of your
    own ship file go to your own folder ($XDG_DATA_HOME/ship_gym/gains, or ~/.local/share/...),
    where controllers find them by the ship's name.
    """
    from ship_gym_agents.cli.output import next_command, show
    from ship_gym_agents.gains_files import write_gains
    from ship_gym_agents.tuning import gains_file, is_tuned
    from ship_gym_agents.tuning.search import need_optuna

    need_optuna()
    works = _works(list(controllers) or ["pid"], list(ships), task, list(structure), out, options)
    found, lines = {}, []
    for work in works:
        if resume and is_tuned(work.kind, work.ship, work.how, work.path):
            lines += [f"{work.name} for {work.ship}: tuned already"]
            continue
        tuned = _tune(work, options)
        made = gains_file(tuned, work.how)
        found[f"{work.name}/{work.ship}"] = _plain(made)
        lines += _told(work, tuned, write_gains(made, work.path))
    last = works[-1]
    sailed = {"ship": last.ship, "scenario": last.env["scenario"]}
    following = next_command("evaluate", **sailed, controller=[last.path, last.name])
    show(as_json, {**found, "next": following}, "\n".join([*lines, f"next: {following}"]))


class _Work(NamedTuple):
    """One controller to be tuned for one ship."""

    name: str
    kind: type
    ship: str
    path: Path
    env: dict[str, Any]  # arguments of a rollout but the ship
    how: dict[str, Any]  # what the file of gains tells of the tuning
    structures: list[str]


def _works(controllers, ships, task, structures, out, options) -> list[_Work]:
    """Everything to be done; refused now if a ship is none or a file has no place."""
    from ship_gym.config import ConfigError
    from ship_gym.ships.files import available_ships
    from ship_gym_agents.cli.sailing import own_task
    from ship_gym_agents.controllers import controller_class

    everyone = not ships or "all" in ships
    names = available_ships() if everyone else ships
    if out and len(names) * len(controllers) > 1:
        raise ConfigError("--out is one file: name one controller and one ship too")
    name = own_task(task)
    return [
        _work(key, controller_class(key), ship, name, structures, out, options)
        for key in controllers
        for ship in names
    ]


def _work(name, kind, ship, task, structures, out, options) -> _Work:
    from ship_gym.config import ConfigError, check_known
    from ship_gym.ships.loader import load_ship
    from ship_gym_agents.cli.sailing import resolved, wanted
    from ship_gym_agents.controllers import CONTROLLERS
    from ship_gym_agents.gains_files import place_for_gains
    from ship_gym_agents.tuning import settings
    from ship_gym_agents.tuning.tune import scenario_for, structures_of

    if name not in CONTROLLERS and not out:
        raise ConfigError(f"--controllers {name}: your own needs a file for its gains: --out")
    sailed = {key: options[key] for key in ("scenario", "control", "overrides")}
    env = {"scenario": scenario_for(kind), **wanted(sailed, task)}
    known = structures_of(kind, load_ship(ship))
    chosen = structures or list(known)
    for one in chosen:
        check_known("structure", one, known)
    more = {key: env[key] for key in ("control", "overrides") if key in env}
    about = resolved(env, task).task
    how = settings(_size(options), env["scenario"], about, chosen, **more)
    path = out or place_for_gains(load_ship(ship).name, kind.KIND)
    return _Work(name, kind, ship, path, env, how, chosen)


def _size(options: dict) -> Any:
    from ship_gym_agents.tuning import Size

    keys = ("episodes", "generations", "candidates", "polish", "seed")
    return Size(**{key: options[key] for key in keys})


def _tune(work: _Work, options: dict) -> Any:
    from ship_gym_agents.cli.output import progress
    from ship_gym_agents.tuning import tune

    title = f"{work.name} {work.ship}"
    return tune(
        work.kind,
        work.ship,
        _size(options),
        name=work.name,
        structures=work.structures,
        progress=lambda parts: progress(parts, title),
        **work.env,
    )


def _plain(made: Any) -> dict[str, Any]:
    import dataclasses

    return dataclasses.asdict(made)


def _told(work: _Work, tuned: Any, path: Path) -> list[str]:
    """Lines of what was found, what it gained and what may be better outside the ranges."""
    lines = [f"{work.name} for {tuned.ship}: wrote {path}"]
    name, unit = tuned.objective.name, tuned.objective.unit
    lines += [f"  {name} {one.cost:8.4f} {unit}  {one.structure}" for one in tuned.ranking]
    g = tuned.gained
    sure = "" if g.low <= 0.0 <= g.high else (" better" if g.high < 0.0 else " WORSE")
    lines += [
        f"  gained over {tuned.before} ({tuned.cost_before:.4f}): {g.value:+.4f} "
        f"[{g.low:+.4f}, {g.high:+.4f}] {unit}{sure}, {len(tuned.best.costs)} validation seeds"
    ]
    for gain, bound in tuned.best.at_bounds.items():
        lines += [
            f"  WARNING: {gain} lies at the bound {bound:g} of its range: a wider one may do better"
        ]
    return lines
