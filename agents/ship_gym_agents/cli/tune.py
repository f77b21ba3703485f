"""``ship-gym tune``."""

from __future__ import annotations

from typing import Any

import click

from ship_gym_agents.cli.options import environment, out, seed, verb
from ship_gym_agents.cli.values import whole


@verb(
    "--ship kcs --episodes 64 --out runs/pid_kcs.toml",
    "--ship all --resume   # in a checkout: the package's gains, about 4 min a ship",
)
@environment("heading_keeping, all ships, rudder")
@click.option("--episodes", type=whole(2, 10_000), default=24, help="Tuning seeds.")
@click.option("--generations", type=whole(1, 10_000), default=16, help="Of the search.")
@seed("Of the search.")
@click.option("--resume", is_flag=True, help="Leave ships with such gains alone.")
@out(".toml", "Gains; default: see above.")
def command(as_json, task, resume, out, ship, **options) -> None:
    """Tune the PID by differential evolution on seeds kept for tuning.

    Without --out, a checkout gets the gains in its package; of an installed package, those of your
    own ship file go to your own folder ($XDG_DATA_HOME/ship_gym/gains, or ~/.local/share/...),
    where pid, los_pid and ilos find them by the ship's name.
    """
    import dataclasses

    from ship_gym_agents.cli.output import next_command, progress, show
    from ship_gym_agents.tune import gains_file, is_tuned, tune, write_gains

    ships = _ships(ship, out)
    env, how = _settings(task, options)
    size = {key: options[key] for key in ("episodes", "generations", "seed")}
    found, lines, written = {}, [], []
    for name, path in ships.items():
        written.append(path)
        if resume and is_tuned(name, how, path):
            lines += [f"{name}: tuned already"]
            continue
        ranking = tune(name, progress=lambda names, s=name: progress(names, s), **size, **env)
        found[name] = dataclasses.asdict(made := gains_file(name, ranking, how))
        lines += [f"{name}: wrote {write_gains(made, path)}", *map(str, ranking)]
    following = next_command("evaluate", ship=name, controller=[written[-1], "pid"])
    show(as_json, found, "\n".join([*lines, f"next: {following}"]))


def _ships(ship: str | None, out: Any) -> dict[str, Any]:
    """Ship -> file of its gains; refused now if it is no ship or the file has no place."""
    from ship_gym.config import ConfigError
    from ship_gym.ships.files import available_ships
    from ship_gym.ships.loader import load_ship
    from ship_gym_agents.pid import place_for_gains

    everyone = ship in (None, "all")
    if out and everyone:
        raise ConfigError("--out is one file: name the ship too")
    names = available_ships() if everyone else [ship]
    return {name: out or place_for_gains(load_ship(name).name) for name in names}


def _settings(task: str | None, options: dict) -> tuple[dict[str, Any], dict[str, Any]]:
    """Arguments of a rollout but the ship, and what the file of gains tells of the tuning."""
    from ship_gym_agents.cli.sailing import own_task, resolved, wanted
    from ship_gym_agents.tune import check_tunable, settings

    name = own_task(task)
    sailed = {key: options[key] for key in ("scenario", "control", "overrides")}
    env = {"scenario": "heading_keeping", **wanted(sailed, name)}
    check_tunable(resolved(env, name).task)
    size = {key: options[key] for key in ("episodes", "generations", "seed")}
    more = {key: env[key] for key in ("control", "overrides") if key in env}
    return env, settings(**size, scenario=env["scenario"], **more)
