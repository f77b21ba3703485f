"""``ship-gym review compare``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ship_gym_agents.cli.options import force, out, verb
from ship_gym_agents.cli.review.files import files
from ship_gym_agents.cli.values import Name

if TYPE_CHECKING:
    from ship_gym.recording import Trajectory

_USUAL = "runs/compare.rrd"


@verb(
    "runs/rollout-pid.rrd runs/rollout-lqg.rrd",
    "runs/heading/*.rrd --out runs/all.rrd --picture runs/all.png",
)
@files()
@out(".rrd", f"Recording with all of them; default: {_USUAL}.")
@click.option("--task", type=Name("tasks"), help="Their task, if it is your own FILE.py[:NAME].")
@out(".png", "Draw it, too, by rerun's viewer.", name="--picture")
@click.option("--show", "shown", is_flag=True, help="Show it, too, in a window.")
@force()
def command(as_json, files, out, task, picture, shown, force) -> None:
    """Compare runs: metrics side by side, and one recording with all of them.

    Two or more FILEs of one seed; differences are against the first. The recording has them
    aligned in time, the differences plotted, the others as ghost ships.
    """
    from ship_gym.recording.comparison import labels, runs_of
    from ship_gym.recording.comparison_card import content_hash, notes, sources
    from ship_gym.recording.trajectory import import_rerun_export
    from ship_gym_agents.cli.output import need, place, progress, show
    from ship_gym_agents.cli.replace import Named, comparison
    from ship_gym_agents.cli.review.files import recorded
    from ship_gym_agents.cli.review.metrics import measured
    from ship_gym_agents.cli.review.show import check_screen
    from ship_gym_agents.cli.sailing import own_task

    need("rerun")
    import_rerun_export()
    own_task(task)
    named, out = Named(out, force), place(out, _USUAL)
    _check_files(files, out)
    if shown:
        check_screen(files, "--show: ")
    runs = [recorded(path) for path in progress(files, "reading")]
    values = [measured(run, path).metrics for run, path in zip(runs, files, strict=True)]
    names = labels(runs)
    told = [*notes(runs_of(runs, names))]
    named.check(comparison(sources(runs_of(runs, names))))
    _write(runs, names, out, picture)
    written = [str(path) for path in (out, picture) if path]
    rows = zip(files, names, values, map(content_hash, runs), strict=True)
    compared = [_row(*row, values[0]) for row in rows]
    if len({row["content"] for row in compared}) == 1:
        told = ["the content of all is the same, bit for bit", *told]
    text = "\n".join([*told, *([""] if told else []), _text(runs, names, values, written, out)])
    show(as_json, {"recordings": compared, "notes": told, "files": written}, text)
    if shown:
        _open(out)


def _check_files(files: Sequence[Path], out: Path) -> None:
    """Refuse a single recording, and to write the comparison over one of them."""
    from ship_gym.config import ConfigError

    if len(files) < 2:
        raise ConfigError(f"compare {files[0]}: needs two recordings or more")
    if out.resolve() in [path.resolve() for path in files]:
        raise ConfigError(f"--out {out}: is one of the recordings to compare; give another file")


def _write(runs: Sequence[Trajectory], names: Sequence[str], out: Path, picture: Path | None):
    """The recording of all, and its picture at the worst moment of the first."""
    from ship_gym.recording.marks import worst_moment
    from ship_gym.recording.rerun_export.compare import write_comparison
    from ship_gym.recording.rerun_export.viewer import NoViewer, screenshot

    write_comparison(runs, out, names)
    if picture:
        moment = worst_moment(runs[0]) - float(runs[0]["t"][0])
        try:
            screenshot(out, picture, moment)
        except NoViewer as error:
            raise NoViewer(f"--picture {picture}: {error}; {out} is written") from None


def _open(out: Path) -> None:
    from ship_gym.recording.rerun_export.viewer import show

    show(out)


def _row(path: Path, name: str, found: dict, content: str, first: dict) -> dict[str, Any]:
    kept = {"file": str(path), "name": name, "content": content, "metrics": found}
    return kept | {"differences": _less(found, first)}


def _less(found: dict[str, Any], first: dict[str, Any]) -> dict[str, float]:
    """Metrics less those of the first run, where both have one."""
    return {
        key: value - first[key]
        for key, value in found.items()
        if value is not None and first.get(key) is not None
    }


def _text(runs, names: Sequence[str], values: list[dict], written: list[str], out) -> str:
    """Metrics side by side with their differences, what they have in common, what was written."""
    from ship_gym.text import table
    from ship_gym_agents.cli.review.files import next_review
    from ship_gym_agents.cli.review.metrics import units_of

    header = ["metric", "unit", names[0]]
    for name in names[1:]:
        header += [name, f"less {names[0]}"]
    rows = []
    for key, unit in units_of(values, [run.meta for run in runs]).items():
        cells = [_cell(values[0].get(key), "{:.5g}")]
        for found in values[1:]:
            difference = _less(found, values[0]).get(key)
            cells += [_cell(found.get(key), "{:.5g}"), _cell(difference, "{:+.3g}")]
        rows.append([key, unit, *cells])
    ends = [["outcome", "", *_beside([str(run.meta.get("outcome", "-")) for run in runs])]]
    text = table(header, [*ends, *rows], 2)
    return f"{text}\n\nwrote {', '.join(written)}\nnext: {next_review('show', out)}"


def _beside(cells: list[str]) -> list[str]:
    """Cells of the runs with an empty one behind each but the first, where differences stand."""
    return [cells[0], *(cell for one in cells[1:] for cell in (one, ""))]


def _cell(value: float | None, form: str) -> str:
    return "-" if value is None else form.format(value)
