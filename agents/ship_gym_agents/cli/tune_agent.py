"""``ship-gym tune-agent``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from ship_gym_agents.cli.options import SEEDS, environment, seed, verb
from ship_gym_agents.cli.values import Name, Number, OutFolder, whole

_OUT = "runs/tune_agent"


@verb(
    "--algo ppo --minutes 2 --trials 30 --jobs 2",
    "--recipe track_guidance --ranges mine.toml --seeds 2 --pruner hyperband --out runs/track",
    "--recipe track_guidance --ranges mine.toml --out runs/track --seeds 2 --resume --trials 60",
    notes="A kill loses the trials that were under way, no other; --resume goes on, also with more "
    "trials.\nWith --engine ray every machine needs --out under the same path.",
)
@environment("the recipe's, else heading_keeping, kcs, rudder")
@click.option("--recipe", type=Name("recipes"), help="Name or TOML file: a whole training plan.")
@click.option(
    "--algo", "--algorithm", "algorithm", type=Name("algorithms"), help="As of train; default: ppo."
)
@click.option("--hyperparameters", help="TOML file of those that all trials share, as of train.")
@click.option("--envs", type=whole(1, 100_000), help="Environments; default: of the TOML file.")
@click.option("--ranges", help="TOML file of what is searched; default: the package's own.")
@seed("Of the first training run and of the search; default: 0.", None, SEEDS - 10**6)
@click.option("--trials", type=whole(1, 100_000), default=20, help="In all, pruned ones included.")
@click.option("--minutes", type=Number(1e-3, 1e6, "min"), help="Of each training run; default: 2.")
@click.option("--steps", type=whole(1, 10**12), help="Samples of each, instead of --minutes.")
@click.option("--seeds", type=whole(1, 1000), default=1, help="Training runs of each trial.")
@click.option("--episodes", type=whole(2, 10_000), default=64, help="Tuning seeds that judge.")
@click.option(
    "--confirm",
    type=whole(0, 1000),
    default=3,
    help="Training runs with fresh seeds, of the winner and of the hyperparameters of before.",
)
@click.option("--pruner", default="median", help="median, hyperband or none.")
@click.option("--engine", type=Name("engines"), default="local", help="local or ray.")
@click.option("--address", help="Of a Ray cluster, as ray.init takes it; default: this machine.")
@click.option("--jobs", type=whole(1, 1000), default=1, help="Trials at a time.")
@click.option("--out", type=OutFolder(), default=_OUT, help="Folder of the search.")
@click.option("--resume", is_flag=True, help="Go on with the search in --out.")
def command(as_json, out, resume, jobs, engine, address, task, **options) -> None:
    """Search for hyperparameters of training with Optuna; write best.toml for train.

    Each trial trains a policy and is judged by the mean of the task's headline metric on seas kept
    for tuning, the same for all trials; what an episode that failed counts, the metric says. A run
    whose validations are worse than those of others is pruned. At the end the winner and the
    hyperparameters of before are trained again with fresh seeds, since the best of many trials was
    partly lucky.
    """
    from ship_gym_agents.cli.output import next_command, progress, show
    from ship_gym_agents.tuning.search import need_optuna

    need_optuna()
    plan, trained = _plan(task, options)

    from ship_gym_agents.training.agent_search import search
    from ship_gym_agents.training.search_confirm import confirm
    from ship_gym_agents.training.search_result import ranked, report

    where = {"jobs": jobs, "engine": engine, "address": address}
    bar = iter(progress(range(plan.trials + 2 * plan.confirm), "tune-agent"))

    def told(trial: Any) -> None:
        next(bar, None)
        _tell(trial, trained)

    trials = search(plan, out, resume=resume, told=told, **where)
    report(plan, trials, out)  # what there is, should the rest be broken off
    best, runs = ranked(trials, trained)[0], []
    for run in confirm(plan, out, best.settings, **where):
        runs.append(run)
        next(bar, None)
    found = report(plan, trials, out, runs)
    env = {key: options[key] for key in ("recipe", "scenario", "ship", "control")}
    following = next_command(
        "train",
        **env,
        task=task,
        algo=plan.given.get("algorithm"),
        hyperparameters=found["best_file"],
        set=_overrides(plan.given),
    )
    show(as_json, {**found, "next": following}, f"{found['text']}\nnext: {following}")


def _plan(task: str | None, options: dict[str, Any]):
    """The plan, refused before any work if it cannot be used, and the score of its trials."""
    from ship_gym_agents.cli.sailing import own_task, wanted
    from ship_gym_agents.cli.train import sorted_options
    from ship_gym_agents.sb3.config import run_config
    from ship_gym_agents.training.budget import default_budget
    from ship_gym_agents.training.score import score_of
    from ship_gym_agents.training.search_plan import Plan
    from ship_gym_agents.training.search_space import load_ranges

    kept = ("trials", "seeds", "episodes", "confirm", "pruner")
    own: dict[str, Any] = {key: options[key] for key in kept}
    budget = default_budget(options["minutes"], options["steps"])
    names = ("algorithm", "recipe", "hyperparameters", "envs", "seed", "scenario", "ship")
    shared = {key: options[key] for key in (*names, "control", "overrides")}
    given = wanted(sorted_options(shared), own_task(task))
    given = {key: str(v) if isinstance(v, Path) else v for key, v in given.items()}
    config = run_config(**given)
    ranges = load_ranges(config.algorithm, options["ranges"], given)
    own |= budget
    return Plan(given, ranges, **own), score_of(config.scenario)


def _tell(trial: Any, score: Any) -> None:
    """A line on stderr for each trial that ends."""
    shown = "-" if trial.score is None else f"{trial.score:.4g} {score.unit}"
    values = ", ".join(f"{name} {value}" for name, value in trial.settings.items())
    why = f" ({trial.note})" if trial.note else ""
    print(f"trial {trial.number} {trial.state}{why}: {shown}; {values}", file=sys.stderr)


def _overrides(given: dict[str, Any]) -> list[str]:
    """Keys of the scenario as --set takes them; those of hyperparameters are in best.toml."""
    from ship_gym_agents.training.search_result import toml_value

    return [f"{key}={toml_value(value)}" for key, value in given.get("overrides", {}).items()]
