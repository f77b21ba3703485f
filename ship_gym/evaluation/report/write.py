"""The report as a file: one HTML page that needs no network, or Markdown with pictures beside."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Callable, Iterable
from pathlib import Path

from ship_gym.evaluation.report import against, background, episodes, leaderboard, scenarios, words
from ship_gym.evaluation.report.benchmark import Benchmark, Results, judge
from ship_gym.evaluation.run_folder import RECORDINGS
from ship_gym.reports.markdown_page import write_markdown_page
from ship_gym.reports.page import Command, Section, Text, write_page

PICTURES = 24  # episodes that are sailed again and drawn
_MARK = "Written by `{}`; run it again instead of editing."


def write_report(
    results: Results | Benchmark,
    path: str | os.PathLike,
    *,
    sail: episodes.Sail | None = None,
    pictures: int = PICTURES,
    progress: Callable[[Iterable], Iterable] = iter,
) -> None:
    """Write the report of a benchmark as one HTML page, whole or not at all.

    Parameters
    ----------
    results : Results or Benchmark
        Of ``episodes_table.read_results``, or judged already.
    path : path-like
        HTML file.
    sail : callable, optional
        ``sail(episode)`` sails one again and gives its recording, or None where it cannot; without
        it the page has no pictures of episodes.
    pictures : int
        Of episodes, at most.
    progress : callable
        Wraps what takes long, such as a bar.
    """
    found = results if isinstance(results, Benchmark) else judge(results)
    if not (Path(path).parent / RECORDINGS).is_dir():  # no files that links could lead to
        about = {key: told for key, told in found.about.items() if key != "recordings"}
        found = dataclasses.replace(found, about=about)
    drawn = episodes.pictures(found, sail, pictures, progress) if sail else {}
    parts = [
        leaderboard.leaderboard(found),
        leaderboard.cells(found),
        against.where_policies_lose(found),
        against.differences(found),
        against.profiles(found),
        against.wave_headings(found),
        *scenarios.scenarios(found, drawn, progress),
        background.controllers(found),
        background.errors(found),
        background.provenance(found),
    ]
    write_page(path, title(found), under(found), parts)


def write_markdown(
    results: Results | Benchmark, path: str | os.PathLike, command: str = "ship-gym report"
) -> list[Path]:
    """Write the results page of the documentation: tables, and pictures in a folder beside it.

    Parameters
    ----------
    results : Results or Benchmark
    path : path-like
        Markdown file; the pictures go to the folder of its name.
    command : str
        What makes it, for the page.

    Returns
    -------
    list of pathlib.Path
        The files written.
    """
    found = results if isinstance(results, Benchmark) else judge(results)
    commands = dict.fromkeys(filter(None, (str(found.about.get("command", "")), command)))
    parts = [
        Section("", [Text(f"{under(found)}. Made by:"), Command("\n".join(commands))]),
        leaderboard.leaderboard(found),
        against.where_policies_lose(found),
        leaderboard.cells(found),
        against.differences(found),
        against.profiles(found),
        against.wave_headings(found),
        background.controllers(found),
        background.errors(found),
        background.provenance(found),
    ]
    return write_markdown_page(path, title(found), _MARK.format(command), parts)


def title(found: Benchmark) -> str:
    """Headline of the page."""
    return f"Benchmark: {', '.join(found.suites)}"


def under(found: Benchmark) -> str:
    """The line under the headline."""
    versions = dict.fromkeys(
        str(each)
        for event in found.events
        for run in event.runs.values()
        for each in run.columns["version"][:1]
    )
    seeds = {len(run.seeds) for event in found.events for run in event.runs.values()}
    ships = dict.fromkeys(event.ship for event in found.events)
    n = f"{min(seeds)} to {max(seeds)}" if len(seeds) > 1 else str(*seeds)
    return (
        f"{', '.join(versions)}; {words.plural(len(found.events), 'cell')} of scenario and ship "
        f"({', '.join(ships)}); {words.plural(len(found.controllers), 'controller')}; "
        f"{n} seeds each"
    )
