"""``ship-gym trials``."""

from __future__ import annotations

from pathlib import Path

import click

from ship_gym_agents.cli.options import Several, force, out, verb
from ship_gym_agents.cli.values import Name


@verb(
    "                                   # every trial of every ship",
    "--ship kvlcc2_model --json",
    "--csv runs/today.csv               # then change something, and",
    "--before runs/today.csv --out runs/trials.md --plot runs/trials.png",
)
@click.option(
    "--ship",
    "ships",
    cls=Several,
    type=Name("ships"),
    help="Names or ship files; default: all ships with trials of their own.",
)
@click.option(
    "--before",
    type=click.Path(path_type=Path, dir_okay=False),
    help="A file of --csv, to print beside.",
)
@out(".md", "Also write the table as a page.")
@out(".png", "Also draw all differences with the scatter of the facilities.", "--plot")
@out(".csv", "Also write the computed values, for a later --before.", "--csv")
@force()
def command(as_json, ships, before, out, plot, csv, force) -> None:
    """Sail every trial of every ship and compare, with the scatter of the facilities.

    One table: measured values with their standard deviation, what is computed, and what was when
    a file of --csv was written. Pictures of single trials: ship-gym simulate trials.
    """
    from ship_gym.reports import trials as report
    from ship_gym.reports.case import sail_trial, trials
    from ship_gym.ships.loader import load_ship
    from ship_gym.writing import atomic_path
    from ship_gym_agents.cli import replace
    from ship_gym_agents.cli.output import need, progress, show

    need(*(["matplotlib"] if plot else []))
    values, title = report.read_values(before) if before else ({}, "")
    vessels = [load_ship(name) for name in ships or report.tested_ships()]
    jobs = [(vessel, trial) for vessel in vessels for trial in trials(vessel)]
    replace.check_replaced(out, replace.page("trials"), force)
    sailed = replace.trials(vessel.name for vessel, _ in jobs)
    replace.check_replaced(csv, sailed, force, "--csv")
    found, sources = [], {}
    for vessel, trial in progress(jobs, "sailing"):
        found += report.comparisons(sail_trial(vessel, trial), values)
        sources[f"{vessel.name}, {report.trial_name(vessel, trial)}"] = trial.source
    if plot:
        from ship_gym.plotting.trials import plot_trials

        plot_trials(found, plot, title or "before")
    if csv:
        report.write_values(found, csv)
    if out:
        with atomic_path(out) as temporary:
            text = report.page(found, sources, title, _beside(plot, out))
            temporary.write_text(text, encoding="utf-8")
    files = [str(path) for path in (out, plot, csv) if path]
    text = report.as_text(found, before=title)
    wrote = f"\nwrote {', '.join(files)}" if files else ""
    show(as_json, report.as_dict(found) | {"before": title, "files": files}, text + wrote)


def _beside(picture: Path | None, page: Path) -> str:
    """The picture as the page names it; empty without one."""
    import os

    return "" if picture is None else Path(os.path.relpath(picture, page.parent)).as_posix()
