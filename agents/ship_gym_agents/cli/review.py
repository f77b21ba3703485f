"""``ship-gym review``."""

from __future__ import annotations

from pathlib import Path

import click

from ship_gym_agents.cli.options import verb
from ship_gym_agents.cli.values import Name

_KEPT = ("task", "controller", "seed", "outcome")


@verb(
    "runs/rollout.rrd",
    "runs/pid.rrd runs/quickstart/rollout.rrd --csv > runs/metrics.csv",
)
@click.argument(
    "files", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="FILE..."
)
@click.option("--task", type=Name("tasks"), help="Their task, if it is your own FILE.py[:NAME].")
@click.option("--csv", "as_csv", is_flag=True, help="Print comma-separated, with all digits.")
def command(as_json, files, task, as_csv) -> None:
    """Print the metrics of recordings side by side, computed from the files.

    Each FILE is an .rrd of ship-gym record.
    """
    from ship_gym.text import table
    from ship_gym_agents.cli.output import need, progress, show
    from ship_gym_agents.cli.sailing import own_task

    need("rerun")
    own_task(task)
    found = {str(path): _read(path) for path in progress(files, "reading")}
    data = {
        path: {key: meta[key] for key in _KEPT} | {"metrics": metrics}
        for path, (meta, metrics) in found.items()
    }
    rows = _rows(found, repr if as_csv else "{:.5g}".format)
    text = "\n".join(map(",".join, rows)) if as_csv else table(rows[0], rows[1:], None)
    show(as_json, data, text)


def _read(path: Path) -> tuple[dict, dict[str, float | None]]:
    """Meta and metrics of one recording; errors name the file."""
    from ship_gym.config import ConfigError
    from ship_gym.evaluation import metrics
    from ship_gym.recording import Trajectory

    try:
        trajectory = Trajectory.from_rrd(path)
        return trajectory.meta, metrics(trajectory)
    except ValueError as error:
        text = str(error)
        raise ConfigError(text if str(path) in text else f"{path}: {text}") from None


def _rows(found: dict[str, tuple[dict, dict[str, float | None]]], form) -> list[list[str]]:
    """Cells of the table: a column for each recording, a row for each metric that one has."""
    from ship_gym.evaluation import all_metrics

    rows = [["metric", "unit", *found]]
    rows += [[key, "", *(str(meta[key]) for meta, _ in found.values())] for key in _KEPT]
    rows.append(["ship", "", *(meta["ship"]["name"] for meta, _ in found.values())])
    for name, metric in all_metrics().items():
        cells = ["" if v.get(name) is None else form(v[name]) for _, v in found.values()]
        if any(cells):
            rows.append([name, metric.unit, *cells])
    return rows
