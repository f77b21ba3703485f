"""``ship-gym benchmark``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from ship_gym_agents.cli.options import Several, jobs, verb
from ship_gym_agents.cli.values import Name, Number, OutFolder, whole


@verb(
    "--suite heading                       # some minutes; killed, it goes on when called again",
    "--suite track --ships kcs dtc --controllers ilos mine.py:Mine --seeds 32",
    "--suite my_suite.toml --jobs 8 --out runs/mine --fresh",
    "--suite manoeuvres --ships kvlcc2 kcs      # hulls without controllers, half a minute each",
    "--suite all --engine ray --address auto --jobs 64",
)
@click.option(
    "--suite",
    "suites",
    cls=Several,
    type=Name("suites"),
    default=["heading"],
    help="heading, course, track, expert, manoeuvres, all or your own FILE.toml; several.",
)
@click.option(
    "--ships", cls=Several, type=Name("ships"), help="Names or files; default: the suite's."
)
@click.option(
    "--controllers",
    "--controller",
    "--policy",
    "controllers",
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
    help="Control intervals that a decision may take in the mean; one slower fails.",
)
@click.option("--out", type=OutFolder(), default="runs/benchmark", help="Folder of the run.")
@click.option(
    "--resume/--fresh",
    default=True,
    help="Go on where a run in --out was, or remove it and begin anew.",
)
@click.option(
    "--record",
    is_flag=True,
    help="Record the worst episode of each controller in each cell into --out/episodes.",
)
@click.option("--report/--no-report", default=True, help="Write report.html beside the results.")
@click.option(
    "--trials",
    type=click.Path(path_type=Path),
    help="Folder of measured time histories for the suite manoeuvres; default: "
    "../shared/reference beside a checkout, where it has them.",
)
def command(as_json, suites, resume, record, report, trials, **options) -> None:
    """Sail suites of scenarios with several ships and controllers; score them.

    Each unit of 16 episodes that is finished is kept in --out: interrupted or killed, the same
    command goes on there, and gives what an undisturbed run does. Rows do not depend on --engine
    and --jobs. Manoeuvres have no controllers: they are the suite of that name, with a table
    manoeuvres.parquet and a page manoeuvres.html of their own.
    """
    from ship_gym_agents.cli.output import need, next_command, progress, show

    need("pyarrow", "matplotlib", *(["rerun"] if record else []))
    from ship_gym.evaluation import benchmark
    from ship_gym.evaluation.report import judge, write_report
    from ship_gym.evaluation.run_folder import EPISODES, REPORT
    from ship_gym.evaluation.summary import as_text, summary
    from ship_gym_agents.cli.manoeuvres import sail_suites, split
    from ship_gym_agents.entrants import distinct, entrant

    again = _again(suites, options | {"trials": trials}) + (" --record" if record else "")
    suites, hulls = split(suites, trials)
    if not suites:
        if record:
            raise click.UsageError("--record: of episodes; a suite of manoeuvres has none")
        moved = sail_suites(hulls, report=report, command=again, **options)
        show(as_json, moved.data, moved.text)
        return
    shown = distinct(options["controllers"])
    named = lambda text: entrant(text, shown.get(text))  # noqa: E731
    try:
        results = benchmark(
            list(suites),
            named,
            fresh=not resume,
            progress=progress,
            command=again,
            record=record,
            **options,
        )
    except KeyboardInterrupt as stop:
        raise KeyboardInterrupt(f"{stop}: {again}") from None
    files, judged = [options["out"] / EPISODES], judge(results)
    if report:
        from ship_gym_agents.sail_again import sail_again

        files.append(options["out"] / REPORT)
        bar = lambda episodes: progress(episodes, "pictures")  # noqa: E731
        write_report(judged, files[-1], sail=sail_again, progress=bar)
    scores = summary(results, judged)
    following = _next(judged, options["out"] if record else None) or next_command("evaluate")
    text = [as_text(scores, results), "", *(f"wrote {file}" for file in files)]
    text += [*_recorded(results, options["out"]), _how(results)]
    found = {"scores": scores, "about": results.about, "next": following}
    if hulls.suites:
        moved = sail_suites(hulls, report=report, command=again, **options)
        found["manoeuvres"] = moved.data
        text = [moved.text, "", *text]
    found["files"] = [str(file) for file in files]
    show(as_json, found, "\n".join([*text, f"next: {following}"]))


def _again(suites: tuple[str, ...], options: dict[str, Any]) -> str:
    """The command that goes on with this run: what is not as usual, and the folder."""
    from ship_gym_agents.cli.output import next_command

    usual = {param.name: param.default for param in command.params}
    given = {name: options[name] for name in usual if options.get(name) not in (None, ())}
    given = {name: value for name, value in given.items() if value != usual[name]}
    return next_command("benchmark", suite=list(suites), **{**given, "out": options["out"]})


def _how(results: Any) -> str:
    """How much was sailed, and how long it took."""
    about = results.about
    kept = f", {about['units_kept']} of them kept from before" if about["units_kept"] else ""
    return (
        f"{len(results.table)} episodes in {about['units']} units{kept}; "
        f"{about['wall_time'] / 60.0:.1f} min with {about['jobs']} jobs, computing time "
        f"{about['computing_time'] / 60.0:.1f} min"
    )


def _recorded(results: Any, out: Path) -> list[str]:
    """What became of the recordings, a line each; none without them."""
    from ship_gym.evaluation.run_folder import RECORDINGS

    made = results.about.get("recordings")
    if made is None:
        return []
    count = sum(
        len(of) for suite in made["files"].values() for c in suite.values() for of in c.values()
    )
    lines = [f"wrote {count} recordings of worst episodes in {out / RECORDINGS}"]
    lines += [f"not recorded: {text}" for text in made["errors"]]
    return lines + [
        f"{text}: sailed again it was another episode; does it draw at random?"
        for text in made["differing"]
    ]


def _next(judged: Any, recorded: Path | None) -> str | None:
    """The command that shows the recordings, or records the worst episode of the first cell."""
    from ship_gym.evaluation.report.episodes import episode, worst_of
    from ship_gym.evaluation.run_folder import RECORDINGS
    from ship_gym_agents.cli.review.files import next_review

    if recorded is not None:
        return next_review("list", recorded / RECORDINGS)
    for event in judged.events:
        if worst := worst_of(event):
            return episode(judged, event, *worst).command
    return None
