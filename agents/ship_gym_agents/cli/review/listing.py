"""``ship-gym review list``."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from ship_gym_agents.cli.options import Several, verb
from ship_gym_agents.cli.values import Name, whole

if TYPE_CHECKING:
    from ship_gym.recording.library import Run

_NOTES = """
fields of --where, --sort: file, kind, scenario, task, ship, controller, seed, outcome, failed,
duration [s], state (complete, incomplete, unreadable), and every metric; folders stand first.
"""
_LEFT = ("kind", "scenario", "ship", "controller", "outcome", "state")
_RIGHT = ("seed", "duration")
_USUAL = ("rudder_travel", "speed_loss")  # metrics beside the headline


@verb(
    "runs/episodes --worst 1",
    'runs --where "J_1>100" ship==kcs "outcome!=end of time" --sort J_1 --reverse',
    notes=_NOTES,
)
@click.argument("folders", nargs=-1, required=True, metavar="FOLDER...")
@click.option(
    "--where",
    "conditions",
    cls=Several,
    metavar="CONDITION",
    help="Only those that meet it: FIELD, one of < <= > >= == !=, VALUE; several: all of them.",
)
@click.option("--sort", metavar="FIELD", help="By this field, small ones first.")
@click.option("--reverse", is_flag=True, help="Large ones first; alone: by the name of the file.")
@click.option(
    "--worst", type=whole(1, 10**6), help="Only so many, the worst first; failed before others."
)
@click.option("--by", metavar="METRIC", help="Of --worst; default: the headline of the task.")
@click.option("--metrics", "shown", cls=Several, metavar="METRIC", help="Show these, too.")
@click.option("--task", type=Name("tasks"), help="Their task, if it is your own FILE.py[:NAME].")
@click.option("--csv", "as_csv", is_flag=True, help="Print comma-separated, with all digits.")
def command(as_json, folders, conditions, sort, reverse, worst, by, shown, task, as_csv) -> None:
    """List the runs of folders: filter, sort, find the worst.

    Each FOLDER is searched with its subfolders for recordings (.rrd) and journals of runs that are
    on or were broken off (.rrd.partial); every file is verified as a whole. A file that cannot be
    read is a row that says why.
    """
    from ship_gym.recording import selection
    from ship_gym_agents.cli.output import need, show
    from ship_gym_agents.cli.sailing import own_task

    need("rerun")
    _check_together(sort, reverse, worst, by)
    fields = [selection.condition(text).field for text in conditions]
    own_task(task)
    runs = _runs(folders)
    _check_metrics(runs, shown)
    kept = selection.chosen(runs, conditions)
    left_out = ""
    if worst is not None:
        by = by or _headline_of(kept)
        from_worst = _from_worst(kept, by)
        if lacking := len(kept) - len(from_worst):
            left_out = f"; left out, for they have no {by}: {lacking}"
        kept = from_worst[:worst]
    elif sort or reverse:
        kept = selection.ordered(kept, sort or "file", reverse)
    named = [*shown, *fields, *filter(None, [sort, by])]
    following = _next(kept)
    text = _csv(kept) if as_csv else _text(runs, kept, named, following, left_out)
    show(as_json, {"runs": [_row(run) for run in kept], "next": following}, text)


def _check_together(sort, reverse, worst, by) -> None:
    """Refuse options that exclude each other, before any file is read."""
    from ship_gym.config import ConfigError

    if by is not None and worst is None:
        raise ConfigError(f"--by {by}: belongs to --worst; to sort all of them: --sort {by}")
    if worst is not None and (sort or reverse):
        option = "--sort" if sort else "--reverse"
        raise ConfigError(f"{option}: --worst sorts by itself; leave one of them out")


def _runs(folders: Sequence[str]) -> list[Run]:
    from ship_gym.config import ConfigError
    from ship_gym.recording.library import SUFFIXES, read, recordings
    from ship_gym_agents.cli.output import progress

    paths = recordings(folders)
    if not paths:
        raise ConfigError(
            f"{', '.join(folders)}: no recordings ({', '.join(SUFFIXES)}); made by: "
            "ship-gym record --out FILE.rrd"
        )
    return [read(path) for path in progress(paths, "reading")]


def _check_metrics(runs: Sequence[Run], names: Sequence[str]) -> None:
    from ship_gym.config import check_known
    from ship_gym.recording.library import metric_names

    for name in names:
        check_known("metric", name, metric_names(runs))


def _numbers(runs: Sequence[Run], key: str) -> list[Any]:
    """Values of a metric, which is a number."""
    return [run.value(key) for run in runs]


def _headline(run: Run) -> str | None:
    """The metric that an episode is judged by first, if its task is known here."""
    from ship_gym.tasks import TASKS

    task: Any = run.meta.get("task")
    return TASKS[task].headline if task in TASKS and run.metrics else None


def _headline_of(runs: Sequence[Run]) -> str:
    """The headline that all episodes have; of too short ones the return, as for record."""
    from ship_gym.config import ConfigError
    from ship_gym.evaluation.choice import deciding

    found = {str(run.value("task")): name for run in runs if (name := _headline(run))}
    if len(set(found.values())) == 1:
        (name,) = set(found.values())
        return deciding(name, {key: _numbers(runs, key) for key in (name, "return")})
    if not found:
        raise ConfigError(
            "--worst: no episode of a known task is among the runs; of your own task name "
            "--task FILE.py, else give --by METRIC or --sort FIELD"
        )
    several = ", ".join(f"{task} by {name}" for task, name in found.items())
    raise ConfigError(
        f"--worst: the runs are judged differently ({several}); give --by METRIC, or choose with "
        f"--where task=={next(iter(found))}"
    )


def _from_worst(runs: Sequence[Run], by: str) -> list[Run]:
    """The runs that have a metric or failed, the worst one first, as for ``ship-gym record``."""
    from ship_gym.config import ConfigError
    from ship_gym.evaluation.choice import ranked
    from ship_gym.tasks.metrics import all_metrics

    known = all_metrics()
    if by not in known:
        raise ConfigError(f"--by {by}: nothing says whether less of it is better; use --sort {by}")
    values, failed = _numbers(runs, by), [run.value("failed") == "yes" for run in runs]
    found = [runs[i] for i in reversed(ranked(values, known[by].better, failed))]
    if not found:
        raise ConfigError(f"--worst: none of the runs has {by}; give --by METRIC")
    return found


def _row(run: Run) -> dict[str, Any]:
    return run.columns() | {"metrics": dict(run.metrics), "error": run.error or None}


def _next(runs: Sequence[Run]) -> str | None:
    """Show the first of them."""
    from ship_gym_agents.cli.review.files import next_review

    first = next((run for run in runs if not run.error), None)
    return None if first is None else next_review("show", first.path)


def _csv(runs: Sequence[Run]) -> str:
    from ship_gym.recording.library import COLUMNS, metric_names

    metrics = metric_names(runs)
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow([*COLUMNS, "error", *metrics])
    for run in runs:
        cells = [*run.columns().values(), run.error, *(run.value(name) for name in metrics)]
        writer.writerow(["" if cell is None else cell for cell in cells])
    return stream.getvalue().rstrip("\n")


def _text(
    runs: Sequence[Run], kept: Sequence[Run], named: Sequence[str], following, left_out: str
) -> str:
    """How many, what all have in common, the table, what is unreadable, what comes next."""
    bad = [run for run in runs if run.error]
    counts = f"{len(kept)} of " if len(kept) < len(runs) else ""
    counts += f"{len(runs)} run{'s' if len(runs) > 1 else ''}"
    counts += (f", {len(bad)} unreadable" if bad else "") + left_out
    if not kept:
        return f"{counts}: none meets the conditions"
    good = [run for run in kept if not run.error]
    same, lines = _common(good), []
    if same:
        lines.append(f"all: {', '.join(_said(name, value) for name, value in same.items())}")
    lines += ["", *_table(kept, same, _metrics_shown(good, named))]
    lines += ["", f"next: {following}"] if following else []
    return "\n".join([counts, *lines])


def _common(runs: Sequence[Run]) -> dict[str, Any]:
    """Columns in which several runs are the same."""
    if len(runs) < 2:
        return {}
    values = {name: {run.value(name) for run in runs} for name in (*_LEFT, *_RIGHT)}
    same = {name: found.pop() for name, found in values.items() if len(found) == 1}
    return {name: value for name, value in same.items() if _told(runs[0], name)}


def _told(run: Run, name: str) -> bool:
    """Whether a column says something; that a run is complete goes without saying."""
    return run.value(name) not in (None, "complete")


def _metrics_shown(runs: Sequence[Run], named: Sequence[str]) -> list[str]:
    """Headlines, what was asked for, and the usual ones that there are."""
    from ship_gym.recording.library import metric_names

    wanted = [*filter(None, map(_headline, runs)), *named, *_USUAL]
    known = metric_names(runs)
    return [name for name in dict.fromkeys(wanted) if name in known]


def _table(runs: Sequence[Run], same: dict[str, Any], metrics: Sequence[str]) -> list[str]:
    """Rows of text; what is wrong with a file stands behind its row."""
    from ship_gym.text import table

    left = [name for name in _LEFT if name not in same]
    left = [name for name in left if any(_told(run, name) for run in runs)]
    right = [name for name in _RIGHT if name not in same]
    fields = ["file", *left, *right, *metrics]
    empty = [""] * (len(fields) - 1)
    rows = [
        [str(run.path), *empty] if run.error else [_cell(run.value(name)) for name in fields]
        for run in runs
    ]
    header = [f"{name} [{unit}]" if (unit := _unit(name)) else name for name in fields]
    lines = table(header, rows, 1 + len(left)).splitlines()
    notes = ["", *(run.error and f"  {run.error}" for run in runs)]
    return [line + note for line, note in zip(lines, notes, strict=True)]


def _said(name: str, value: Any) -> str:
    """A column and its value."""
    return f"{name} {_cell(value)} {_unit(name)}".rstrip()


def _unit(name: str) -> str:
    """Unit of a column or metric, if it has one."""
    from ship_gym.tasks.metrics import all_metrics

    metric = all_metrics().get(name)
    unit = metric.unit if metric else "s" if name == "duration" else ""
    return unit.strip("-")


def _cell(value: Any) -> str:
    if value is None:
        return "-"
    return f"{value:.5g}" if isinstance(value, float) else str(value)
