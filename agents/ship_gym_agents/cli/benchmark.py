"""``ship-gym benchmark``."""

from __future__ import annotations

import sys
from typing import Any

import click

from ship_gym_agents.cli.options import Several, jobs, verb
from ship_gym_agents.cli.values import Name, Number, OutFolder, whole

_DEFAULTS = {"suite": ("heading",), "seeds": 64, "out": "runs/benchmark", "patience": 1.0}


@verb(
    "--suite heading                       # some minutes; killed, it goes on when called again",
    "--suite track --ships kcs dtc --controllers ilos mine.py:Mine --seeds 32",
    "--suite my_suite.toml --jobs 8 --out runs/mine --fresh",
    "--suite all --engine ray --address auto --jobs 64",
)
@click.option(
    "--suite",
    "suites",
    cls=Several,
    type=Name("suites"),
    default=["heading"],
    help="heading, course, track, expert, all or your own FILE.toml; several.",
)
@click.option(
    "--ships", cls=Several, type=Name("ships"), help="Names or files; default: the suite's."
)
@click.option(
    "--controllers",
    cls=Several,
    type=Name("controllers"),
    help="Names, policies, gains or your own FILE.py:NAME; default: the suite's. "
    "constant always sails.",
)
@click.option("--seeds", type=whole(1, 10**6), default=64, help="Number of evaluation seeds.")
@click.option("--engine", type=Name("engines"), default="local", help="local or ray.")
@click.option("--address", help="Of a Ray cluster, as ray.init takes it; default: this machine.")
@jobs()
@click.option(
    "--patience",
    type=Number(1e-6, 1e6),
    default=1.0,
    help="Control intervals that a decision may take in the mean; beyond, a controller is too slow.",
)
@click.option("--out", type=OutFolder(), default="runs/benchmark", help="Folder of the run.")
@click.option(
    "--resume/--fresh",
    default=True,
    help="Go on where a run in --out was, or remove it and begin anew.",
)
def command(as_json, suites, resume, **options) -> None:
    """Sail suites of scenarios with several ships and controllers; score them.

    Each unit that is finished is kept in --out: killed or interrupted, the same command goes on,
    and gives what an undisturbed run does. --resume refuses a folder with other settings.
    """
    from ship_gym.evaluation import benchmark
    from ship_gym.evaluation.leaderboard import as_text, leaderboard
    from ship_gym_agents.cli.output import progress, show
    from ship_gym_agents.entrants import entrant

    out = options["out"]
    try:
        results = benchmark(
            list(suites), entrant, fresh=not resume, progress=progress, command=_typed(), **options
        )
    except KeyboardInterrupt:
        raise click.ClickException(_interrupted(out)) from None
    board = leaderboard(results)
    files = [str(out / "episodes.parquet")]
    following = _following(results)
    found = {"leaderboard": board, "about": results.about, "files": files, "next": following}
    wrote = "\n".join(f"wrote {file}" for file in files)
    nexts = "\n".join(f"next: {one}" for one in following)
    show(as_json, found, f"{as_text(results, board)}\n\n{wrote}\n{nexts}")
