"""Measure the error of the integration step beside the time it takes, ship by ship."""

from __future__ import annotations

import dataclasses
from pathlib import Path

from _cli import parser, progress, run, show

from pages.marks import write_tables
from ship_gym.provenance import git_commit
from ship_gym.reports import accuracy
from ship_gym.reports.speed import machine
from ship_gym.text import paragraph
from ship_gym.writing import check_place

PAGE = Path(__file__).resolve().parents[1] / "docs" / "accuracy.md"
EXAMPLES = (
    "python scripts/measure_accuracy.py kcs        # one ship, a quarter of a minute",
    "python scripts/measure_accuracy.py --write    # all, and docs/accuracy.md: some minutes",
)


def main() -> None:
    p = parser(__doc__, EXAMPLES)
    p.add_argument("ships", nargs="*", metavar="SHIP", help="name or file (default: all)")
    p.add_argument(
        "--write", action="store_true", help="tables and picture of docs/accuracy.md, of all ships"
    )
    args = p.parse_args()
    if args.write and args.ships:
        p.error("--write is for all ships: name none")
    if args.write:
        check_place(PAGE, "--write")
    jobs = list(accuracy.jobs(args.ships))
    points = [point for job in progress(jobs, "sailing") for point in accuracy.measure(*job)]
    written = _write(points) if args.write else []
    host = machine()
    data = {"machine": host, "points": [dataclasses.asdict(p) for p in points], "files": written}
    text = accuracy.as_text(points) + "".join(f"\nwrote {path}" for path in written)
    show(args.json, data, text)


def _write(points: list[accuracy.Point]) -> list[str]:
    """Picture and tables of the page; where each was written."""
    from ship_gym.plotting.accuracy import plot_accuracy

    picture = PAGE.with_suffix(".png")
    plot_accuracy(points, picture)
    host = machine()
    where = f"Measured at commit {git_commit()} on one core of {host['processor']}."
    write_tables(PAGE, accuracy.tables(points, markdown=True) | {"where": paragraph(where, "")})
    return [str(PAGE), str(picture)]


if __name__ == "__main__":
    run(main)
