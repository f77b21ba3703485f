"""``ship-gym review metrics``."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from ship_gym_agents.cli.options import verb
from ship_gym_agents.cli.review.files import files
from ship_gym_agents.cli.values import Name

if TYPE_CHECKING:
    from ship_gym.recording import Trajectory

_KEPT = ("task", "controller", "seed", "outcome")


class _Found(NamedTuple):
    """Meta of a run, its metrics, where they are from, and in which it differs from its file."""

    meta: Mapping[str, Any]
    metrics: dict[str, float | None]
    source: str
    differences: dict[str, list[float | None]]


@verb(
    "runs/rollout.rrd",
    "runs/pid.rrd runs/quickstart/rollout.rrd --csv > runs/metrics.csv",
)
@files()
@click.option("--task", type=Name("tasks"), help="Their task, if it is your own FILE.py[:NAME].")
@click.option("--csv", "as_csv", is_flag=True, help="Print comma-separated, with all digits.")
def command(as_json, files, task, as_csv) -> None:
    """Print the metrics of recordings side by side, computed from the files.

    Each FILE is an .rrd of ship-gym record. Those of an episode are computed again from its columns
    and must be those of its meta to the last bit; the measures of a manoeuvre are those that were
    stored with it. A run that is on or was broken off has none.
    """
    from ship_gym.config import ConfigError
    from ship_gym_agents.cli.output import need, progress, show
    from ship_gym_agents.cli.review.files import recorded
    from ship_gym_agents.cli.sailing import own_task

    need("rerun")
    own_task(task)
    found = {str(path): measured(recorded(path), path) for path in progress(files, "reading")}
    data = {
        path: {key: one.meta.get(key) for key in _KEPT}
        | {"metrics": one.metrics, "source": one.source, "differences": one.differences}
        for path, one in found.items()
    }
    show(as_json, data, _text(found, as_csv))
    wrong = [f"{path}: {_different(one)}" for path, one in found.items() if one.differences]
    if wrong:
        raise ConfigError("; ".join(wrong))


def measured(run: Trajectory, path: object) -> _Found:
    """Metrics of a run; an error names the file."""
    from ship_gym.config import ConfigError
    from ship_gym.recording.library import stored_metrics
    from ship_gym.recording.turns import is_manoeuvre
    from ship_gym.tasks.metrics import metrics

    kept = stored_metrics(run.meta)
    if is_manoeuvre(run):
        return _Found(run.meta, kept, "stored", {})
    if not run.complete:
        return _Found(run.meta, {}, "incomplete: none", {})
    try:
        found = metrics(run)
    except ValueError as error:
        raise ConfigError(f"{path}: {error}") from None
    pairs = {key: [kept[key], found[key]] for key in kept if key in found}
    differences = {key: pair for key, pair in pairs.items() if pair[0] != pair[1]}
    return _Found(run.meta, found, "computed", differences)


def _different(one: _Found) -> str:
    """What differs, and the likely reason."""
    name, (kept, found) = next(iter(one.differences.items()))
    return (
        f"{len(one.differences)} metrics are not those of the file, such as {name}: stored "
        f"{kept!r}, computed {found!r}; it was recorded by commit {one.meta.get('git_commit')}"
    )


def _text(found: Mapping[str, _Found], as_csv: bool) -> str:
    from ship_gym.text import table

    rows = _rows(found, repr if as_csv else "{:.5g}".format)
    if as_csv:
        stream = io.StringIO()
        csv.writer(stream, lineterminator="\n").writerows(rows)
        return stream.getvalue().rstrip("\n")
    return table(rows[0], rows[1:], None)


def _rows(found: Mapping[str, _Found], form) -> list[list[str]]:
    """Cells of the table: a column for each recording, a row for each metric that one has."""
    every = found.values()
    rows = [["metric", "unit", *found]]
    rows += [[key, "", *(str(one.meta.get(key, "-")) for one in every)] for key in _KEPT]
    rows.append(["ship", "", *(str((one.meta.get("ship") or {}).get("name")) for one in every)])
    rows.append(["source", "", *(one.source for one in every)])
    units = units_of([one.metrics for one in every], [one.meta for one in every])
    for name, unit in units.items():
        values = [one.metrics.get(name) for one in every]
        if any(value is not None for value in values):
            rows.append([name, unit, *("" if value is None else form(value) for value in values)])
    return rows


def units_of(
    found: Sequence[Mapping[str, float | None]], metas: Sequence[Mapping]
) -> dict[str, str]:
    """Units of all metrics that occur, in the order of a table; "" where none is known."""
    from ship_gym.tasks.metrics import all_metrics

    known = {name: metric.unit for name, metric in all_metrics().items()}
    for meta in metas:
        known |= {k: unit for k, unit in (meta.get("units") or {}).items() if k not in known}
    names = dict.fromkeys(name for one in found for name in one)
    ordered = [name for name in known if name in names]
    ordered += [name for name in names if name not in known]
    return {name: known.get(name, "") for name in ordered}
