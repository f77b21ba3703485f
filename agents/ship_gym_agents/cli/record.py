"""``ship-gym record``."""

from __future__ import annotations

import re
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from ship_gym_agents.cli.options import Several, environment, out, seed, verb
from ship_gym_agents.cli.values import Name


@verb(
    "--policy runs/quickstart",
    "--controller pid adaptive --ship kvlcc2 --seed 2000007 --out runs/heading.rrd",
)
@click.option(
    "--policy",
    "--controller",
    "--controllers",
    "named",
    cls=Several,
    type=Name("controllers"),
    default=["pid"],
    help="Names, policies, gains or your own FILE.py:NAME; several: a file for each.",
)
@environment("those of the first policy, else heading_keeping, kcs, rudder")
@seed("Of the episode; default: the first of an evaluation.", default=None, largest=2**63 - 1)
@out(".rrd", "File to write; of several controllers -NAME is added.", default="runs/rollout.rrd")
def command(as_json, named, task, seed, out, **options) -> None:
    """Record one episode as a rerun file, read it back and compute its metrics."""
    from ship_gym.evaluation.rollout import EVALUATION_SEED
    from ship_gym_agents.cli.output import need, next_command, show

    need("rerun")
    seed = EVALUATION_SEED if seed is None else seed
    sailed = _sail(named, task, seed, options)
    files = [out] if len(sailed) == 1 else [_beside(out, one) for one in sailed]
    found = [_kept(one, file) for one, file in zip(sailed, files, strict=True)]
    paths = " ".join(shlex.quote(str(file)) for file in files)
    following = f"{next_command('review', task=task)} {paths}"
    text = f"seed {seed}, metrics computed from {', '.join(map(str, files))}\n"
    text += f"{_table(sailed[0].meta['task'], found)}\n\nwrote {', '.join(map(str, files))}\n"
    text += f"next: rerun {paths}\n      {following}"
    data = found[0] if len(found) == 1 else {"recordings": found}
    show(as_json, {**data, "next": following}, text)


def _sail(named: Sequence[str], task: str | None, seed: int, options: dict) -> list:
    """The episode as a recording of each controller, all refused before the first one sails."""
    from ship_gym.evaluation import rollout
    from ship_gym.evaluation.guard import Guarded
    from ship_gym.evaluation.rollout import begin
    from ship_gym_agents.cli.output import progress
    from ship_gym_agents.cli.sailing import own_task, resolved, wanted
    from ship_gym_agents.controllers import trained_for
    from ship_gym_agents.entrants import controllers_of

    name = own_task(task)
    controllers = controllers_of(named)
    known = [trained_for(controller) for controller in controllers]
    env = wanted(options, name, next(filter(None, known), {}))
    resolved(env, name)
    start = begin([seed], **env)
    for controller in controllers:
        Guarded(controller, [seed]).reset(1, start.ship, start.scenario)
    how = {"seeds": [seed], "progress": progress, **env}
    return [rollout(controller, **how).trajectory(0) for controller in controllers]


def _beside(out: Path, sailed: Any) -> Path:
    """The file of one of several controllers."""
    name = re.sub(r"[^A-Za-z0-9_.-]+", "-", sailed.meta["controller"])
    return out.with_stem(f"{out.stem}-{name}")


def _kept(sailed: Any, file: Path) -> dict[str, Any]:
    """Write a recording; its metrics, computed from the file."""
    from ship_gym.evaluation import metrics
    from ship_gym.recording import Trajectory

    sailed.to_rrd(file)
    found = metrics(Trajectory.from_rrd(file))
    if found != metrics(sailed):
        raise OSError(f"{file}: the metrics of the file are not those of the episode")
    meta = sailed.meta
    return {
        "controller": meta["controller"], "seed": meta["seed"], "metrics": found, "file": str(file)
    }  # fmt: skip


def _table(task: str, found: list[dict[str, Any]]) -> str:
    """Metrics of the recordings side by side."""
    from ship_gym.evaluation import metrics_of
    from ship_gym.text import table

    rows = []
    for key, metric in metrics_of(task).items():
        values = [one["metrics"][key] for one in found]
        cells = ["-" if value is None else f"{value:.5g}" for value in values]
        rows.append([key, metric.unit, *cells])
    return table(["metric", "unit", *(one["controller"] for one in found)], rows, None)
