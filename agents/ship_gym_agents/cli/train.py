"""``ship-gym train``."""

from __future__ import annotations

import sys
from typing import Any

import click

from ship_gym_agents.cli.options import environment, seed, verb
from ship_gym_agents.cli.values import Name, Number, OutFolder, whole


@verb(
    "--ship kvlcc2 --steps 5000000 --seed 1 --out runs/kvlcc2",
    "--resume --minutes 10            # 10 minutes in all",
)
@environment()
@click.option("--privileged", is_flag=True, default=None, help="See sea and forces.")
@click.option("--algorithm", type=Name("algorithms"), help="ppo (default), sac or td3.")
@click.option("--hyperparameters", help="TOML file; default: the package's own.")
@click.option("--envs", type=whole(1, 100_000), help="Environments; default: of the TOML file.")
@seed("Of network, exploration and episodes; default: 0.", default=None)
@click.option("--minutes", type=Number(1e-3, 1e6, "min"), help="Wall-clock time; default: 2.")
@click.option("--steps", type=whole(1, 10**12), help="Samples, instead of or beside --minutes.")
@click.option("--out", type=OutFolder(), default="runs/heading", help="Run folder.")
@click.option("--resume", is_flag=True, help="Continue the run in --out.")
def command(as_json, out, resume, minutes, steps, task, **options) -> None:
    """Train a policy: validated on separate seas, best one kept, can be resumed."""
    from ship_gym_agents.cli.output import need, next_command, progress, show

    need("torch", "stable_baselines3")
    config = _config(str(out), resume, task, options)

    from ship_gym_agents.training.budget import default_budget
    from ship_gym_agents.training.summary import plan, summary
    from ship_gym_agents.training.train import train

    budget = default_budget(minutes, steps)
    print(plan(config, out, **budget), file=sys.stderr)
    bar = progress(None, "training", total=1000)
    card = train(config, out, **budget, resume=resume, bar=bar)
    following = next_command("evaluate", policy=out, task=task)
    show(as_json, {**card, "next": following}, f"{summary(card, out)}\nnext: {following}")


def _config(out: str, resume: bool, task: str | None, options: dict[str, Any]):
    """Config of the run, everything in it refused before any work if it cannot be used."""
    from ship_gym_agents.cli.sailing import check_task, own_task, wanted
    from ship_gym_agents.sb3.config import check_free, config_for

    name = own_task(task)
    given = {k: v for k, v in options.items() if v not in (None, {})}
    if resume:
        config = config_for(out, True, given)
    else:
        check_free(out)
        config = config_for(out, False, wanted(given, name))
    check_task(config.scenario.task, name, options["scenario"] or "of the run")
    return config
