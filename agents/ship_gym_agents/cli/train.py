"""``ship-gym train``."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Any

import click

from ship_gym_agents.cli.options import TYPED, environment, seed, verb
from ship_gym_agents.cli.values import Name, Number, OutFolder, whole

_OUT = "runs/heading"


@verb(
    "--algo sac --ship kvlcc2 --minutes 10 --set training.gamma=0.995 --out runs/kvlcc2",
    "--recipe track_guidance --seeds 5 --jobs 2",
    "--resume --out runs/kvlcc2 --minutes 20      # 20 minutes in all",
    notes="What is killed goes on with --resume; what was learned since the last checkpoint, a "
    "minute\nat most, is lost. Validations and files are not charged to --minutes.\n"
    "The worst episode of every tenth validation is recorded in OUT/episodes; "
    "--set training.record=0: none.",
)
@environment("the recipe's, else heading_keeping, kcs, rudder")
@click.option("--privileged", is_flag=True, default=None, help="See sea and forces.")
@click.option("--recipe", type=Name("recipes"), help="Name or TOML file: a whole training plan.")
@click.option(
    "--algo",
    "--algorithm",
    "algorithm",
    type=Name("algorithms"),
    help="ppo (default), recurrent_ppo, sac, td3, tqc, dqn or gauss_newton.",
)
@click.option(
    "--hyperparameters",
    help="TOML file of those that differ from the package's own; single ones: --set "
    "training.gamma=0.995.",
)
@click.option("--envs", type=whole(1, 100_000), help="Environments; default: of the TOML file.")
@seed("Of network, exploration and episodes; default: 0.", default=None)
@click.option("--seeds", type=whole(1, 1000), help="Train so many seeds; the median is kept.")
@click.option("--jobs", type=whole(1, 1000), default=1, help="Seeds at a time.")
@click.option("--init", type=Name("controllers"), help="Policy whose weights to begin with.")
@click.option("--minutes", type=Number(1e-3, 1e6, "min"), help="Time of training; default: 2.")
@click.option("--steps", type=whole(1, 10**12), help="Samples, instead of or beside --minutes.")
@click.option("--out", type=OutFolder(), help=f"Run folder; default: {_OUT}, runs/RECIPE.")
@click.option("--resume", is_flag=True, help="Continue the run in --out.")
def command(as_json, out, resume, minutes, steps, seeds, jobs, init, task, **options) -> None:
    """Train a policy: validated on separate seas, best one kept, can be resumed."""
    from ship_gym.writing import check_place
    from ship_gym_agents.cli.output import next_command, progress, show

    out = out or _default_out(options["recipe"])
    check_place(out, "--out", folder=True)
    config, card = _config(out, resume, task, options)
    seeds = seeds or (card or {}).get("seeds", 1)
    budget = _budget(minutes, steps, card)

    from ship_gym_agents.training.seeds import train_seeds
    from ship_gym_agents.training.summary import plan, summary
    from ship_gym_agents.training.train import need_libraries, train

    need_libraries(config.algorithm)
    print(plan(config, out, **budget, seeds=seeds), file=sys.stderr)
    more = {**budget, "resume": resume, "init": init, "command": _typed()}
    more["bar"] = progress(None, "training", total=1000)
    _terminate_as_interrupt()
    if seeds > 1:
        made = train_seeds(config, out, seeds, jobs=jobs, **more)
    else:
        made = train(config, out, **more)
    following = next_command("evaluate", policy=out, task=task)
    show(as_json, {**made, "next": following}, f"{summary(config, made, out)}\nnext: {following}")


def _default_out(recipe: str | None) -> Path:
    return Path(_OUT) if recipe is None else Path("runs") / Path(recipe).stem


def _typed() -> str:
    """The command, to be copied."""
    return shlex.join(["ship-gym", "train", *click.get_current_context().meta[TYPED]])


def _terminate_as_interrupt() -> None:
    """Let a polite kill, as of a batch system, end a run as Ctrl-C does."""
    import signal
    import threading

    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, signal.default_int_handler)


def _budget(minutes: float | None, steps: int | None, card: dict[str, Any] | None):
    """The two limits; of a run that goes on its own, unless others are given."""
    from ship_gym_agents.training.budget import default_budget

    if minutes is None and steps is None and card is not None:
        return card["budget"]
    return default_budget(minutes, steps)


def _config(out: Path, resume: bool, task: str | None, options: dict[str, Any]):
    """Config of the run, and the card of the one that goes on.

    Everything in it is refused before any work if it cannot be used.
    """
    from ship_gym_agents.cli.sailing import check_task, own_task, wanted
    from ship_gym_agents.sb3.config import check_free, config_for, read_card
    from ship_gym_agents.training.run_folder import TrainingFolder

    name = own_task(task)
    given = sorted_options(options)
    card = TrainingFolder(out).card() if resume else None
    if card is not None:
        config = _same(config_for(out, True, {}), given, out)
    elif resume and not given:
        read_card(out)  # says that there is none
    else:  # also a run that was killed before it had a card
        check_free(out)
        config = config_for(out, False, wanted(given, name))
    check_task(config.scenario.task, name, options["scenario"] or "of the run")
    return config, card


def sorted_options(options: dict[str, Any]) -> dict[str, Any]:
    """What was given, keys of hyperparameters apart from those of the scenario."""
    from ship_gym_agents.sb3.sections import SECTIONS

    given = {key: value for key, value in options.items() if value not in (None, {})}
    keys = given.pop("overrides", {})
    settings = {key: value for key, value in keys.items() if key.partition(".")[0] in SECTIONS}
    overrides = {key: value for key, value in keys.items() if key not in settings}
    made = {"settings": settings, "overrides": overrides}
    return given | {key: value for key, value in made.items() if value}


def _same(config: Any, given: dict[str, Any], out: Path) -> Any:
    """The config of the run that goes on, refused where what is given would be another one."""
    from ship_gym.config import ConfigError
    from ship_gym_agents.sb3.config import plain, run_config

    if given and plain(run_config(**given)) != plain(config):
        typed = {"settings": "set", "overrides": "set", "algorithm": "algo"}
        names = dict.fromkeys(f"--{typed.get(key, key)}" for key in given)
        raise ConfigError(f"{out}: a resumed run keeps its config; leave out: {', '.join(names)}")
    return config
