"""``ship-gym report``."""

from __future__ import annotations

import shlex
from pathlib import Path

import click

from ship_gym_agents.cli.options import force, out, verb
from ship_gym_agents.cli.values import whole


@verb(
    "runs/benchmark",
    "runs/benchmark/episodes.parquet --out report.html --episodes 60",
    "runs/benchmark --markdown docs/results.md    # tables and pictures for the documentation",
)
@click.argument("results", type=click.Path(path_type=Path))
@out(".html", "Page to write; default: report.html beside the results.")
@out(".md", "Write a Markdown page and its pictures instead, for a documentation.", "--markdown")
@click.option(
    "--episodes",
    type=whole(0, 10_000),
    default=24,
    help="Pictures of best, median and worst episodes, sailed again.",
)
@force()
def command(as_json, results, out, markdown, episodes, force) -> None:
    """Write the page of a benchmark from its results, a file or the folder of a run.

    The HTML page holds all pictures and needs no network.
    """
    if out and markdown:
        raise click.UsageError("--out and --markdown: allowed is one of them")
    from ship_gym.evaluation.episodes_table import read_results
    from ship_gym_agents.cli.output import need, place, progress, show

    need("pyarrow", "matplotlib")
    from ship_gym.evaluation.report import write_markdown, write_report
    from ship_gym_agents.cli.replace import check_replaced, page
    from ship_gym_agents.sail_again import sail_again

    check_replaced(out, page("report"), force)
    check_replaced(markdown, page("report"), force, "--markdown")
    if markdown and not force and not markdown.is_file():
        _check_pictures(markdown)
    found = read_results(results)
    if markdown:
        words = ["ship-gym", "report", str(results), "--markdown", str(markdown)]
        files = write_markdown(found, markdown, shlex.join(words))
    else:
        folder = results if results.is_dir() else results.parent
        files = [place(out, folder / "report.html")]
        bar = lambda chosen: progress(chosen, "pictures")  # noqa: E731
        write_report(found, files[0], sail=sail_again, pictures=episodes, progress=bar)
    data = {"episodes": found.table.num_rows, "files": [str(file) for file in files]}
    show(as_json, data, "\n".join(f"wrote {file}" for file in files))


def _check_pictures(page: Path) -> None:
    """Refuse a new page beside a folder of pictures of another one, which would be removed."""
    from ship_gym.config import ConfigError

    folder = page.with_suffix("")
    if other := next(folder.glob("*.png"), None):
        raise ConfigError(
            f"--markdown {page}: its pictures go to {folder}, which holds others such as "
            f"{other.name}; see --force"
        )
