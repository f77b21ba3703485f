"""``ship-gym evaluate``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from ship_gym_agents.cli.options import Several, environment, out, verb
from ship_gym_agents.cli.values import Name, whole


@verb(
    "--policy runs/quickstart ppo_kcs",
    "--controller mylqr.py:LQR pid --ship kvlcc2 --episodes 128 --markdown",
)
@click.option(
    "--policy",
    "policies",
    cls=Several,
    type=Name("controllers"),
    help="Files of trained policies or folders of runs; a run of several seeds: its median one.",
)
@click.option(
    "--controller",
    "--controllers",
    "controllers",
    cls=Several,
    type=Name("controllers"),
    help="Sail these (too): names, policies, gains or your own FILE.py:NAME; "
    "default: the autopilots of the task.",
)
@environment("those of the first policy, else heading_keeping, kcs, rudder")
@click.option("--episodes", type=whole(1, 10**6), default=32, help="Number of seeds.")
@out(".json", "Results; default: evaluation.json, in runs or the folder of the one policy.")
@click.option("--markdown", is_flag=True, help="Print the tables for a README.")
def command(as_json, policies, controllers, task, episodes, out, markdown, **options) -> None:
    """Sail controllers on the same evaluation episodes; print their metrics.

    Intervals: 95 % bootstrap over the episodes.
    """
    from ship_gym.evaluation import compare, evaluation_seeds, table
    from ship_gym_agents.cli.output import next_command, place, show
    from ship_gym_agents.cli.sailing import again

    out = place(out, _folder(policies) / "evaluation.json")
    seeds = evaluation_seeds(episodes)
    named, rollouts = _sail(list(policies), list(controllers), seeds, task, options)
    sailed = [r.controller for r in rollouts]
    usual = rollouts[0].task.controllers[0]
    found = compare(rollouts, usual if usual in sailed else None)
    _write(found, out)
    first = {"policy": policies[0]} if policies else {"controller": named[0]}
    following = next_command("record", **first, **again(options, task))
    text = (
        f"{found['ship']}, {len(seeds)} episodes (seeds {seeds[0]} to {seeds[-1]}), interquartile "
        f"mean [95 % interval]; success: mean\n{table(found, markdown)}\n\n"
        f"wrote {out}\nnext: {following}"
    )
    show(as_json, {**found, "file": str(out), "next": following}, text)


def _sail(
    policies: list[str], others: list[str], seeds: list[int], task: str | None, options: dict
) -> tuple[list[str], list]:
    """The controllers as named and a rollout of each, all refused before the first one sails."""
    from ship_gym.evaluation.guard import Guarded
    from ship_gym.evaluation.rollout import begin
    from ship_gym_agents.cli.sailing import check_task, own_task, wanted
    from ship_gym_agents.controllers import make_controller, trained_for
    from ship_gym_agents.entrants import controllers_of

    name = own_task(task)
    first = [make_controller(policy) for policy in policies[:1]]
    env = wanted(options, name, trained_for(first[0]) if first else None)
    start = begin(seeds[:1], **env)
    check_task(start.scenario.task, name, options["scenario"])
    named = [name for name in others or start.task.controllers if name]
    controllers = controllers_of([*policies, *named])
    for controller in controllers:
        Guarded(controller, seeds[:1]).reset(1, start.ship, start.scenario)
    return named, [_sailed(controller, seeds, env) for controller in controllers]


def _sailed(controller: Any, seeds: list[int], env: dict[str, Any]) -> Any:
    """The rollout of a controller; where it fails, the error says in which episode."""
    from ship_gym.evaluation import rollout
    from ship_gym.evaluation.guard import ControllerFailed
    from ship_gym_agents.cli.output import progress

    try:
        bar = lambda steps: progress(steps, controller.name)  # noqa: E731
        return rollout(controller, seeds=seeds, progress=bar, **env)
    except ControllerFailed as failed:
        for seed in failed.seeds if len(failed.seeds) > 1 else ():
            rollout(controller, seeds=[seed], **env)
        raise


def _folder(policies: tuple[str, ...]) -> Path:
    one = Path(policies[0]) if len(policies) == 1 else Path("runs")
    return one if one.is_dir() else Path("runs")


def _write(found: dict[str, Any], path: Path) -> None:
    import json

    from ship_gym.provenance import atomic_path

    with atomic_path(path) as temporary:
        temporary.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
