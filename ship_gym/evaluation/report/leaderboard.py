"""Sections of scores: the leaderboard, means by tier, every cell, cells without a score."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from ship_gym.evaluation.report import words
from ship_gym.evaluation.report.benchmark import Benchmark
from ship_gym.evaluation.report.events import NOTHING, Event
from ship_gym.evaluation.statistics import Estimate
from ship_gym.plotting.benchmark import Range, plot_scores
from ship_gym.plotting.figure import for_page
from ship_gym.reports.page import Block, Cell, Grid, Picture, Section, Text

_SCORE = (
    "Score of a cell (scenario and ship) = 100 ln(nothing / x) / ln(nothing / reference), where x "
    "is the interquartile mean of the measure over the seeds, nothing that of a rudder held "
    "amidships and reference that of the tuned reference controller. 0: as good as doing nothing; "
    "100: as good as the reference; more is better. Brackets: 95 % interval over the seeds."
)
_SAME_CELLS = (
    "Not every controller sails every cell, and means over different cells do not compare: best "
    "classical and optimum are means over the same cells as the controller's own. Best classical: "
    "the best classical controller of each cell, whichever it is, chosen by these episodes. "
    "Optimum: a plan made with full knowledge of the episode, an estimate of what is possible, "
    "not a bound; no number where a cell has none."
)


@dataclasses.dataclass(frozen=True, eq=False)
class Place:
    """One controller on a leaderboard and the events it has a score in."""

    controller: str
    score: Estimate
    cells: list[Event]


def places(found: Benchmark, among: Sequence[Event]) -> list[Place]:
    """Controllers with a score, best first; before others those scored in every cell.

    Doing nothing comes last: it is where the scale begins, no competitor.
    """
    rows = []
    for name in found.controllers:
        cells = found.scored(name, among)
        if (score := found.mean_score(name, cells)) is not None:
            rows.append(Place(name, score, cells))
    total = _scored_cells(found, among)

    def order(row: Place) -> tuple[bool, bool, float]:
        return row.controller == NOTHING, len(row.cells) < total, -row.score.value

    return sorted(rows, key=order)


def _scored_cells(found: Benchmark, among: Sequence[Event]) -> int:
    return sum(not found.scales[event].why for event in among)


def boards(found: Benchmark) -> dict[str, list[Event]]:
    """Events of every leaderboard by its title: all, and each suite if there are several."""
    suites = {suite: [e for e in found.events if e.suite == suite] for suite in found.suites}
    return suites if len(suites) == 1 else {"all suites": found.events} | suites


def leaderboard(found: Benchmark) -> Section:
    """Mean scores of the controllers, over all cells, by suite and by tier."""
    blocks: list[Block] = [Text(_SCORE), Text(_SAME_CELLS)]
    for k, (title, among) in enumerate(boards(found).items()):
        ranked = places(found, among)
        if not ranked:
            blocks.append(Text(f"{title}: no cell has a score; why stands below."))
            continue
        blocks.append(_board(found, title, ranked, among))
        if k == 0:
            blocks += [_picture(found, title, ranked), _tiers(found, ranked, among)]
    return Section("Leaderboard", blocks, "leaderboard")


def _board(found: Benchmark, title: str, ranked: Sequence[Place], among: Sequence[Event]) -> Grid:
    header = ["", "controller", "kind", "mean score", "cells", "best classical", "optimum"]
    header += ["success"]
    rows = []
    total = _scored_cells(found, among)
    few = any(len(place.cells) < total for place in ranked)
    for k, place in enumerate(ranked):
        best = [found.score(event, event.best_classical) for event in place.cells]
        optimum = [found.scales[event].optimum for event in place.cells]
        success = [event.runs[place.controller].middle("success") for event in place.cells]
        rows.append(
            [
                str(k + 1) if len(place.cells) == total and place.controller != NOTHING else "",
                place.controller,
                found.controllers[place.controller],
                words.score_interval(place.score),
                f"{len(place.cells)} of {total}",
                words.score(_mean(best)),
                words.score(_mean(optimum)),
                words.share(_mean(success)),
            ]
        )
    note = "; without a rank: those that have no score in some cells" if few else ""
    return Grid(f"{title}{note}", header, rows, left=3)


def _mean(values: Sequence[float | None]) -> float | None:
    """Mean; None if a value is missing, because the rest would be other cells."""
    known = [value for value in values if value is not None]
    return float(np.mean(known)) if known and len(known) == len(values) else None


def _range(score: Estimate) -> Range:
    ends = [score.value if end is None else end for end in (score.low, score.high)]
    return Range(score.value, *ends)


def _picture(found: Benchmark, title: str, ranked: Sequence[Place]) -> Picture:
    scores = {row.controller: _range(row.score) for row in ranked}
    few = len({len(row.cells) for row in ranked}) > 1
    note = " Controllers of fewer cells are shown over those alone." if few else ""
    text = f"Mean scores, {title}, with 95 % intervals over the seeds.{note}"
    return for_page(text, lambda path: plot_scores(scores, found.look, path), "scores")


def _tiers(found: Benchmark, ranked: Sequence[Place], among: Sequence[Event]) -> Grid:
    """Mean scores by tier, in the order in which the tiers come."""
    tiers = list(dict.fromkeys(event.tier for event in among))
    tiers.sort(key=lambda tier: ("basic", "seaway", "expert", tier).index(tier))
    rows = []
    for place in ranked:
        row = [place.controller]
        for tier in tiers:
            cells = [event for event in place.cells if event.tier == tier]
            mean = found.mean_score(place.controller, cells) if cells else None
            row.append(f"{words.score_interval(mean)} ({len(cells)})" if cells else words.NONE)
        rows.append(row)
    return Grid("mean score by tier (cells)", ["controller", *tiers], rows)


def cells(found: Benchmark) -> Section:
    """The score of every controller in every cell."""
    blocks: list = [
        Text(
            "Scores of all cells; a cell's name leads to its part of this page. The best of a row "
            "is marked *. Scale: what 0 and 100 were taken from."
        )
    ]
    for suite in found.suites:
        among = [e for e in found.events if e.suite == suite and not found.scales[e].why]
        if among:
            blocks.append(_cell_grid(found, suite, among))
    without = [[e.cell, e.measure, why] for e, s in found.scales.items() if (why := s.why)]
    if without:
        blocks.append(Grid("cells without a score", ["cell", "measure", "why"], without, left=3))
    blocks += _without_number(found)
    return Section("Scores by cell", blocks, "cells")


def _cell_grid(found: Benchmark, suite: str, among: Sequence[Event]) -> Grid:
    names = [name for name in found.controllers if any(name in e.runs for e in among)]
    rows = []
    for event in among:
        scores = {name: found.score(event, name) for name in names}
        best = max((s for s in scores.values() if s is not None), default=None)
        marked = [
            Cell(f"{words.score(s)} *", mark="better") if s is not None and s == best else s
            for s in scores.values()
        ]
        texts = [each if isinstance(each, Cell) else words.score(each) for each in marked]
        scaled = found.scales[event]
        assert scaled.cell is not None  # as the event has a score
        name = Cell(f"{event.scenario}, {event.ship}", event.anchor)
        scale = f"{scaled.cell.reference_controller}, {scaled.source}"
        rows.append([name, event.tier, event.measure, *texts, words.score(scaled.optimum), scale])
    header = ["cell", "tier", "measure", *names, "optimum", "scale"]
    return Grid(f"suite {suite}", header, rows, left=3)


def _without_number(found: Benchmark) -> list[Grid]:
    """Controllers without a score in a cell that has a scale."""
    rows = []
    for event, scaled in found.scales.items():
        for name, run in event.runs.items():
            if scaled.why or found.score(event, name) is not None:
                continue
            lost = int(run.broken.sum())
            why = f"{lost} of {words.plural(len(run.seeds), 'episode')} broke off with an error"
            rows.append([name, event.cell, why if lost else "the measure has no number"])
    header = ["controller", "cell", "why"]
    return [Grid("controllers without a score in a cell", header, rows, left=3)] if rows else []
