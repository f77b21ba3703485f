"""``ship-gym tune``."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import click

from ship_gym_agents.cli.options import Several, environment, force, out, seed, verb
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
@click.option(
    "--begin", type=click.Path(), help="Gains to begin at, as of another ship; default: its own."
)
@click.option("--episodes", type=whole(2, 10_000), default=24, help="Tuning seeds.")
@click.option("--generations", type=whole(1, 10_000), default=16, help="Of CMA-ES.")
@click.option("--candidates", type=whole(4, 10_000), default=20, help="In a generation.")
@click.option(
    "--polish", type=whole(0, 10_000), default=40, help="Evaluations of Nelder-Mead at the end."
)
@seed("Of the search.")
@click.option("--resume", is_flag=True, help="Leave ships with such gains alone.")
@out(".toml", "Gains; default: see above.")
@force()
def command(as_json, controllers, ships, task, resume, out, structure, begin, force, **options):
    """Tune controllers for ships on seeds kept for tuning; say what it gained.

    The search is CMA-ES, then Nelder-Mead. Headings are tuned for J_0.1, courses for the settling
    time, tracks for the rms distance to the route; three times as many further tuning seeds choose
    the structure and say what was gained, with its 95 % interval.

    Gains of headings, of a guidance those of tracks, are the ship's in general. Those of another
    task, as of --scenario course_changing, go beside them: NAME_SHIP.course_changing.toml, which
    the controller takes where it sails that task.

    Without --out, a checkout gets the gains in its package; of an installed package, those of your
    own ship file go to your own folder ($XDG_DATA_HOME/ship_gym/gains, or ~/.local/share/...),
    where controllers find them by the ship's name.
    """
    import dataclasses

    from ship_gym.locks import held
    from ship_gym_agents.cli.output import next_command, show
    from ship_gym_agents.gains_files import write_gains
    from ship_gym_agents.tuning import gains_file, is_tuned
    from ship_gym_agents.tuning.search import need_optuna

    need_optuna()
    found = {}
    for job in _jobs(list(controllers) or ["pid"], list(ships), out, task, options, force):
        env, how, chosen = _settings(job, task, list(structure), options)
        if resume and is_tuned(job.kind, job.ship, how, job.path):
            lines = [f"{job.name} for {job.ship}: tuned already"]
        else:
            with held(job.path, "tunes into this file"):
                tuned = _tune(job, env, chosen, begin, options)
                made = gains_file(tuned, how)
                lines = _told(job, tuned, write_gains(made, job.path))
            found[f"{job.name}/{job.ship}"] = dataclasses.asdict(made)
        if not as_json:  # at once: the next ship takes minutes
            click.echo("\n".join(lines))
    sailed = {"ship": job.ship, "scenario": env["scenario"]}
    following = next_command("evaluate", **sailed, controller=[job.path, job.name])
    show(as_json, {**found, "next": following}, f"next: {following}")


class _Job(NamedTuple):
    """One controller to be tuned for one ship, and the file for its gains."""

    name: str
    kind: type[Any]
    ship: str
    path: Path


def _jobs(
    controllers: list[str],
    ships: list[str],
    out: Path | None,
    task: str | None,
    options: dict,
    force: bool,
) -> list[_Job]:
    """Everything to be done; refused now if a ship is none or a file has no place."""
    from ship_gym.config import ConfigError
    from ship_gym.ships.files import available_ships
    from ship_gym.ships.loader import load_ship
    from ship_gym_agents.cli.output import place
    from ship_gym_agents.cli.replace import check_replaced, gains
    from ship_gym_agents.controllers import CONTROLLERS, controller_class
    from ship_gym_agents.gains_files import place_for_gains
    from ship_gym_agents.tuning.structures import own_task_of

    names = available_ships() if not ships or "all" in ships else ships
    if out and len(names) * len(controllers) > 1:
        raise ConfigError("--out is one file: name one controller and one ship too")
    made = []
    for name in controllers:
        kind = controller_class(name)
        if name not in CONTROLLERS and not out:
            raise ConfigError(f"--controllers {name}: your own needs a file for its gains: --out")
        of_task = own_task_of(kind, _sailed(kind, task, options)[1])
        for ship in names:
            loaded = load_ship(ship).name
            path = place(out, place_for_gains(loaded, kind.KIND, of_task))
            written = name if name not in CONTROLLERS else kind.KIND
            check_replaced(out, gains(written, loaded, of_task), force)
            made.append(_Job(name, kind, ship, path))
    return made


def _settings(job: _Job, task: str | None, wished: list[str], options: dict):
    """Arguments of a rollout but the ship, what the file tells of the tuning, the structures.

    Not before the jobs before it are done: a guidance begins at the gains of the PID.
    """
    from ship_gym.config import check_known
    from ship_gym.ships.loader import load_ship
    from ship_gym_agents.tuning import settings
    from ship_gym_agents.tuning.structures import structures_of

    env, about = _sailed(job.kind, task, options)
    known = structures_of(job.kind, load_ship(job.ship), about)
    for one in wished:
        check_known("structure", one, known)
    chosen = wished or list(known)
    more = {key: env[key] for key in ("control", "overrides") if key in env}
    return env, settings(_size(options), env["scenario"], about, chosen, **more), chosen


def _sailed(kind: type[Any], task: str | None, options: dict) -> tuple[dict[str, Any], str]:
    """Arguments of a rollout but the ship, and the task they are of."""
    from ship_gym_agents.cli.sailing import own_task, resolved, wanted
    from ship_gym_agents.tuning.structures import scenario_for

    own = own_task(task)
    sailed = {key: options[key] for key in ("scenario", "control", "overrides")}
    env = {"scenario": scenario_for(kind), **wanted(sailed, own)}
    return env, resolved(env, own).task


def _size(options: dict) -> Any:
    from ship_gym_agents.tuning import Size

    keys = ("episodes", "generations", "candidates", "polish", "seed")
    return Size(**{key: options[key] for key in keys})


def _tune(job: _Job, env: dict, structures: list[str], begin: str | None, options: dict) -> Any:
    from ship_gym_agents.cli.output import progress
    from ship_gym_agents.tuning import tune

    return tune(
        job.kind,
        job.ship,
        _size(options),
        name=job.name,
        structures=structures,
        begin_at=begin,
        progress=lambda parts: progress(parts, f"{job.name} {job.ship}"),
        **env,
    )


def _told(job: _Job, tuned: Any, path: Path) -> list[str]:
    """Lines of what was found, what it gained and what may be better outside the ranges."""
    lines = [f"{job.name} for {tuned.ship}: wrote {path}"]
    for one in tuned.ranking:
        means = ", ".join(f"{key} {one.validation[key]:.5g}" for key in tuned.changed)
        lines += [f"  {means}  {one.structure}".rstrip()]
    low, high, seeds = tuned.gained.low, tuned.gained.high, len(next(iter(one.episodes.values())))
    sure = "better" if high < 0.0 else "WORSE" if low > 0.0 else "no clear difference"
    change = ", ".join(
        f"{key} {e.value:+.4g} [{e.low:+.4g}, {e.high:+.4g}]" for key, e in tuned.changed.items()
    )
    lines += [f"  against {tuned.before}: {change}: {sure}, {seeds} validation seeds"]
    lines += [
        f"  WARNING: {gain} lies at the bound {bound:g} of its range: a wider one may do better"
        for gain, bound in tuned.best.at_bounds.items()
    ]
    return lines
