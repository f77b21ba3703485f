"""``ship-gym evaluate``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from ship_gym_agents.cli.options import Several, environment, force, out, verb
from ship_gym_agents.cli.values import Name, OutFolder, whole


@verb(
    "--policy runs/quickstart ppo_kcs",
    "--controller pid adaptive --record runs/recordings --which worst best",
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
@click.option("--record", type=OutFolder(), help="Folder to record episodes into, see --which.")
@click.option(
    "--which",
    cls=Several,
    type=Name("episodes"),
    help="Episodes of each controller to record, by the headline metric: worst, best, median, "
    "failed, all; several; default: worst.",
)
@force()
def command(
    as_json, policies, controllers, task, episodes, out, markdown, record, which, force, **options
) -> None:
    """Sail controllers on the same evaluation episodes; print their metrics.

    Intervals: 95 % bootstrap over the episodes. Failed episodes are the worst.
    """
    from ship_gym.evaluation import compare, evaluation_seeds
    from ship_gym_agents.cli import evaluate_episodes as shown
    from ship_gym_agents.cli.output import place, show
    from ship_gym_agents.cli.replace import Named
    from ship_gym_agents.cli.review.files import next_review

    shown.check_which(which, record)
    file = Named(out, force)
    out = place(out, _folder(policies) / "evaluation.json")
    seeds = evaluation_seeds(episodes)
    named, rollouts = _sail([*policies], [*controllers], seeds, task, options, file, record)
    sailed = [r.controller for r in rollouts]
    usual = rollouts[0].task.controllers[0]
    found = compare(rollouts, usual if usual in sailed else None)
    found["extremes"] = shown.extremes_of(rollouts, found["episodes"])
    _write(found, out)
    wrote = [str(out)]
    data: dict[str, Any] = {"file": str(out)}
    following = _again(named, sailed, found["extremes"]["of"], policies, task, options)
    if record is not None:
        files = shown.recorded(rollouts, found["episodes"], which or ("worst",), record)
        wrote.append(f"{len(files)} recording{'s' * (len(files) != 1)} in {record}")
        data["recordings"] = [str(file) for file in files]
        if files:
            following = next_review("list", record, *(["--task", task] if task else []))
    text = f"{_tables(found, markdown)}\n\nwrote {', '.join(wrote)}\nnext: {following}"
    show(as_json, {**found, **data, "next": following}, text)


def _tables(found: dict[str, Any], markdown: bool) -> str:
    from ship_gym.evaluation import table
    from ship_gym_agents.cli.evaluate_episodes import extremes_table

    seeds = found["seeds"]
    return (
        f"{found['ship']}, {len(seeds)} episodes (seeds {seeds[0]} to {seeds[-1]}), interquartile "
        f"mean [95 % interval]; success: mean\n{table(found, markdown)}\n\n"
        f"{extremes_table(found, markdown)}"
    )


def _again(
    named: list[str], sailed: list[str], extremes: dict, policies, task: str | None, options: dict
) -> str:
    """The command that records the worst episode of the controller the evaluation is about.

    That is the first one that was trained, for it decides what is sailed where no option does.
    """
    from ship_gym_agents.cli.output import next_command
    from ship_gym_agents.cli.sailing import again, known_to

    subject = known_to(named)[0] or named[0]
    seed = extremes[sailed[named.index(subject)]].get("worst", {}).get("seed")
    who = "policy" if subject in policies else "controller"
    return next_command("record", **{who: subject}, **again(options, task), seed=seed)


def _sail(
    policies: list[str],
    others: list[str],
    seeds: list[int],
    task: str | None,
    options: dict,
    file: Any,
    record: Path | None,
) -> tuple[list[str], list]:
    """The controllers as named and a rollout of each, all refused before the first one sails."""
    from ship_gym.evaluation.recordings import check_told_apart, file_name
    from ship_gym.evaluation.rollout import begin
    from ship_gym_agents.cli.replace import check_recordings, evaluation
    from ship_gym_agents.cli.sailing import check_task, known_to, own_task, ready, wanted
    from ship_gym_agents.entrants import controllers_of

    name = own_task(task)
    env = wanted(options, name, known_to([*policies, *filter(None, others)])[1])
    start = begin(seeds[:1], **env)
    check_task(start.scenario.task, name, options["scenario"])
    named = [*policies, *(one for one in others or start.task.controllers if one)]
    controllers = controllers_of(named)
    names = [controller.name for controller in controllers]
    config = start.scenario.to_dict()
    file.check(evaluation(config, start.ship.name, seeds, names))
    if record is not None:
        check_told_apart(names)
        to = lambda name, seed: record / file_name(name, seed)  # noqa: E731
        check_recordings(to, names, seeds, config, file.force, "--record")
    ready(controllers, start, seeds)
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

    from ship_gym.writing import atomic_path

    with atomic_path(path) as temporary:
        temporary.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
