"""``ship-gym record``."""

from __future__ import annotations

import shlex

import click

from ship_gym_agents.cli.options import environment, out, seed, verb
from ship_gym_agents.cli.values import Name


@verb(
    "--policy runs/quickstart",
    "--controller pid --ship kvlcc2 --seed 2000007 --out runs/pid.rrd",
)
@click.option("--policy", type=Name("controllers"), help="Folder or file of a trained policy.")
@click.option(
    "--controller",
    type=Name("controllers"),
    help="pid (default), another name, a policy, gains or your own FILE.py:NAME.",
)
@environment("the policy's, else heading_keeping, kcs, rudder")
@seed("Of the episode; default: the first of an evaluation.", default=None, largest=2**63 - 1)
@out(".rrd", "File to write.", default="runs/rollout.rrd")
def command(as_json, policy, controller, task, seed, out, **options) -> None:
    """Record one episode as a rerun file, read it back and compute its metrics."""
    if policy and controller:
        raise click.UsageError("--policy and --controller: allowed is one of them")

    from ship_gym.evaluation import metrics, metrics_of
    from ship_gym.evaluation.rollout import EVALUATION_SEED
    from ship_gym.recording import Trajectory
    from ship_gym.text import table
    from ship_gym_agents.cli.output import need, next_command, show

    need("rerun")
    seed = EVALUATION_SEED if seed is None else seed
    sailed = _sail(policy or controller or "pid", task, seed, options)
    sailed.to_rrd(out)
    found = metrics(Trajectory.from_rrd(out))
    if found != metrics(sailed):
        raise OSError(f"{out}: the metrics of the file are not those of the episode")
    name = sailed.meta["controller"]
    units = metrics_of(sailed.meta["task"])
    rows = [
        [key, units[key].unit, "-" if value is None else f"{value:.5g}"]
        for key, value in found.items()
    ]
    following = f"{next_command('review', task=task)} {shlex.quote(str(out))}"
    shown = table(["metric", "unit", name], rows, None)
    text = f"seed {seed}, metrics computed from {out}\n{shown}\n\n"
    text += f"wrote {out}\nnext: rerun {out}\n      {following}"
    data = {"controller": name, "seed": seed, "metrics": found, "file": str(out)}
    show(as_json, {**data, "next": following}, text)


def _sail(named: str, task: str | None, seed: int, options: dict):
    """The episode as a recording."""
    from ship_gym.evaluation import rollout
    from ship_gym_agents.cli.output import progress
    from ship_gym_agents.cli.sailing import own_task, resolved, wanted
    from ship_gym_agents.controllers import make_controller, trained_for

    name = own_task(task)
    controller = make_controller(named)
    env = wanted(options, name, trained_for(controller))
    resolved(env, name)
    return rollout(controller, seeds=[seed], progress=progress, **env).trajectory(0)
