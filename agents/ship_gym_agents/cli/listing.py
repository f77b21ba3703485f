"""``ship-gym list``."""

from __future__ import annotations

from typing import Any

import click

from ship_gym_agents.cli.options import ship, verb
from ship_gym_agents.cli.values import Name

KINDS = ("ships", "scenarios", "tasks", "controllers", "recipes", "surrogates", "seas")


@verb(
    "                               # everything",
    "surrogates --ship kvlcc2_model",
    "mylqr.py                       # the controllers in a file of your own",
)
@click.argument("what", nargs=-1, metavar="[WHAT]...")
@ship(default="kcs_model")
@click.option("--task", type=Name("tasks"), help="Your own FILE.py[:NAME], listed with the others.")
def command(as_json, what, ship, task) -> None:
    """List what can be named: ships, scenarios, tasks, controllers, recipes, surrogates.

    WHAT is one or several of these and seas, or a FILE.py with controllers of your own; --ship is
    the ship whose surrogates and hull variants are listed.
    """
    from ship_gym.config import check_known
    from ship_gym_agents.cli.output import show
    from ship_gym_agents.cli.sailing import own_task

    for kind in what:
        if not kind.endswith(".py"):
            check_known("kind of things", kind, KINDS)
    own_task(task)
    found = {kind: _listed(kind, ship) for kind in what or KINDS}
    show(as_json, found, "\n\n".join(_as_text(*item) for item in found.items()))


def _listed(kind: str, ship: str) -> dict[str, str]:
    """Names of a kind, each with a few words."""
    from ship_gym_agents.plugins import controllers_in, load_object

    if kind.endswith(".py"):
        return {name: _first_line(load_object(name)) for name in controllers_in(kind)}
    if kind == "surrogates":
        return _surrogates(ship)
    return {name: _about(kind, name) for name in _names(kind)}


def _names(kind: str) -> list[str]:
    from ship_gym_agents.cli.names import NAMES

    return NAMES[kind]()


def _about(kind: str, name: str) -> str:
    """A few words about what a name means."""
    if kind == "ships":
        from ship_gym.ships.loader import load_ship

        return load_ship(name).title
    if kind == "scenarios":
        from ship_gym.scenarios.scenario import load_scenario

        return load_scenario(name).task
    if kind == "recipes":
        from ship_gym_agents.sb3.config import RECIPES

        return (RECIPES / f"{name}.toml").read_text(encoding="utf-8").partition("\n")[0].strip("# ")
    if kind == "controllers":
        from ship_gym_agents.controllers import CONTROLLERS

        return _first_line(CONTROLLERS[name]) if name in CONTROLLERS else _policy(name)
    return ""


def _policy(name: str) -> str:
    """What the card of a shipped policy says; the numbers of the file are not read."""
    from ship_gym_agents.controllers import shipped_file
    from ship_gym_agents.policies.policy_file import read_card

    file = shipped_file(name)
    assert file is not None  # as it was listed
    card = read_card(file)
    config = card.get("config", {})
    scenario = config.get("scenario", {})
    where = f" for {scenario['ship']} in {scenario['task']}" if scenario else ""
    return f"trained policy, {config.get('algorithm', 'of another program')}{where}"


def _surrogates(ship: str) -> dict[str, str]:
    """Propeller and rudder models of a ship, and its other hull sets."""
    from ship_gym.ships.loader import available_surrogates, available_variants, load_ship

    default = load_ship(ship).surrogate_name
    found = {name: "default" if name == default else "" for name in available_surrogates(ship)}
    return found | dict.fromkeys(available_variants(ship), "hull variant")


def _first_line(thing: Any) -> str:
    return (thing.__doc__ or "").strip().partition("\n")[0]


def _as_text(kind: str, names: dict[str, str]) -> str:
    width = max(map(len, names), default=0)
    rows = [f"  {name:{width}}  {about}".rstrip() for name, about in names.items()]
    return "\n".join([f"{kind}:", *(rows or ["  none"])])
