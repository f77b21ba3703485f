"""Sections that set controllers against each other: where policies lose, differences, profiles."""

from __future__ import annotations

import functools
from collections.abc import Sequence

import numpy as np

from ship_gym.evaluation.report import words
from ship_gym.evaluation.report.benchmark import Benchmark
from ship_gym.evaluation.report.events import NOTHING, Event, slug
from ship_gym.evaluation.report.judgements import SIGNIFICANT, Difference
from ship_gym.evaluation.statistics import ratios_to_best
from ship_gym.plotting.benchmark import plot_polar, plot_profiles
from ship_gym.plotting.figure import for_page
from ship_gym.reports.page import Block, Cell, Grid, Picture, Row, Section, Text

_WIDTH = 45.0  # of a sector [deg], the first is ahead
_FEWEST = 3  # episodes of a sector that is drawn
_EDGE = 4.0  # largest ratio of a picture over the wave heading
SPREAD = 4  # sectors that must be met for a picture over the wave heading
HEADER = ["controller", "against", "difference", "relative", "p (Holm)", "verdict"]


def difference_cells(each: Difference) -> list[str | Cell]:
    """Cells of `HEADER`."""
    verdict = Cell(each.verdict, mark=each.verdict) if each.verdict else "no difference shown"
    middle = words.interval(each.found)
    share = words.signed_share(each.share)
    return [each.controller, each.against, middle, share, words.p_value(each.p), verdict]


def where_policies_lose(found: Benchmark) -> Section:
    """Cells in which a policy is significantly worse than the best classical controller.

    Controllers of one's own count as policies here: whatever is new stands against the classical.
    """
    policies = [name for name, kind in found.controllers.items() if kind != "classical"]
    if not policies:
        text = "These results hold classical controllers only: no policy to compare."
        return Section("Where policies lose", [Text(text)], "losses")
    judged = [each for each in found.differences if each.controller in policies]
    lost = [each for each in judged if each.verdict == "worse"]
    rows = [
        [Cell(each.event.cell, each.event.anchor), each.event.measure, *difference_cells(each)]
        for each in lost
    ]
    blocks: list = [Text(_about_family(found)), _counts(found, policies)]
    if rows:
        caption = (
            "cells where a policy or one's own controller is worse than the best classical one"
        )
        blocks.append(Grid(caption, ["cell", "measure", *HEADER], rows, left=4))
    else:
        blocks.append(Text("No policy is significantly worse in any cell."))
    return Section("Where policies lose", blocks, "losses")


def _about_family(found: Benchmark) -> str:
    return (
        "Mean of the paired differences, seed by seed, of the measure: controller minus the best "
        "classical one of the cell. The opponent was chosen by the same episodes, which is in its "
        "favour. p-values are those of the sign-flip test, corrected by Holm for the "
        f"{len(found.differences)} differences of this report; better and worse mean "
        f"p < {SIGNIFICANT:g}."
    )


def _counts(found: Benchmark, names: Sequence[str]) -> Grid:
    """Cells by verdict, and those that could not be judged."""
    rows = []
    for name in names:
        verdicts = [each.verdict for each in found.differences if each.controller == name]
        sailed = sum(name in event.runs for event in found.events)
        best = sum(event.best_classical == name for event in found.events)
        counts = [verdicts.count(kind) for kind in ("better", "", "worse")]
        rows.append([name, str(best), *map(str, counts), str(sailed - best - sum(counts))])
    header = ["controller", "is it itself", "better", "no difference shown", "worse", "not judged"]
    return Grid("cells, against the best classical controller", header, rows)


def differences(found: Benchmark) -> Section:
    """How often each classical controller is worse than the best one."""
    names = [n for n, kind in found.controllers.items() if kind == "classical" and n != NOTHING]
    text = "The same for the classical controllers; each cell's own table has the differences."
    blocks: list[Block] = [Text(text), _counts(found, names)] if len(names) > 1 else []
    return Section("Classical controllers against the best of them", blocks, "differences")


def profiles(found: Benchmark) -> Section:
    """Performance profiles, one for each suite and ship."""
    text = (
        "For every episode, each controller's measure is divided by the smallest that any of them "
        "reached on that seed. The curve is the share of episodes in which a controller stays "
        "within the factor; its left end is how often it is the best. Only controllers that sailed "
        "all cells of a suite and ship; an episode that broke off is beyond every factor. Without "
        "constant."
    )
    pictures = [each for pair in _groups(found) if (each := _profile(found, *pair))]
    return Section("Performance profiles", [Text(text), Row(pictures)] if pictures else [])


def _groups(found: Benchmark) -> list[tuple[str, str]]:
    """(suite, ship), in the order of the table."""
    return list(dict.fromkeys((event.suite, event.ship) for event in found.events))


def _profile(found: Benchmark, suite: str, ship: str) -> Picture | None:
    among = [e for e in found.events if (e.suite, e.ship) == (suite, ship)]
    among = [e for e in among if e.metric.better == "lower"]
    names = [n for n in found.controllers if among and all(n in e.runs for e in among)]
    names = [name for name in names if name != NOTHING]
    each = (_ratios(event, names) for event in (among if len(names) > 1 else ()))
    ratios = [one for one in each if one is not None]
    if not ratios:
        return None
    joined = dict(zip(names, np.concatenate(ratios, axis=1), strict=True))
    count = len(joined[names[0]])
    caption = f"Suite {suite}, {ship}: {words.plural(len(ratios), 'cell')}, {count} episodes."
    return for_page(
        caption,
        lambda path: plot_profiles(joined, found.look, path, f"{suite}, {ship}"),
        slug(f"profile_{suite}_{ship}"),
    )


def _ratios(event: Event, names: Sequence[str]) -> np.ndarray | None:
    """Measure over the episode's smallest, shape (controllers, episodes); None without any."""
    runs = [event.runs[name] for name in names]
    seeds = functools.reduce(np.intersect1d, [run.seeds for run in runs])
    values = np.array([run.at(seeds) for run in runs])
    kept = ~(values <= 0.0).any(axis=0)  # what is zero says nothing about a ratio
    kept &= np.isfinite(values).any(axis=0)
    return ratios_to_best(values[:, kept]) if kept.any() else None


def wave_headings(found: Benchmark) -> Section:
    """Ratio to the best classical controller over the wave heading, all cells of a suite."""
    text = (
        "Where the waves come from, as seen from the bridge (port taken with starboard), against "
        "how a controller does beside the best classical one of the cell: geometric mean of the "
        f"ratio of the measures on the same seeds in sectors of {_WIDTH:g} degrees with at least "
        f"{_FEWEST} episodes; below 1 is better, beyond {_EDGE:g} is not shown."
    )
    pictures = [each for pair in _groups(found) if (each := _polar(found, *pair))]
    return Section("Over the wave heading", [Text(text), Row(pictures)] if pictures else [])


def coming_from(encounter_deg: np.ndarray) -> np.ndarray:
    """Where waves come from, from 0 ahead to 180 astern [deg], port taken with starboard.

    The table's angle is 0 from astern, 180 from ahead, positive from starboard.
    """
    return 180.0 - np.abs(encounter_deg)


def by_sector(from_deg: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Means of values by where waves come from.

    Parameters
    ----------
    from_deg, values : numpy.ndarray
        Of the episodes, `coming_from` [deg], shape (n,).

    Returns
    -------
    middles, means : numpy.ndarray
        Of the sectors [deg]; NaN where less than `_FEWEST` episodes are. Shape (5,).
    """
    middles = np.arange(0.0, 180.0 + _WIDTH, _WIDTH)
    which = np.floor(from_deg / _WIDTH + 0.5).astype(int)
    means = [
        values[which == k].mean() if np.count_nonzero(which == k) >= _FEWEST else np.nan
        for k in range(len(middles))
    ]
    return middles, np.array(means)


def _polar(found: Benchmark, suite: str, ship: str) -> Picture | None:
    among = [e for e in found.events if (e.suite, e.ship) == (suite, ship) and e.best_classical]
    angles: dict[str, list] = {}
    logs: dict[str, list] = {}
    for event in among:
        for name in event.runs:
            where, ratio = _against_best(event, name)
            angles.setdefault(name, []).append(where)
            logs.setdefault(name, []).append(ratio)
    sectors = {}
    for name in logs:
        if name == NOTHING:
            continue
        middles, means = by_sector(np.concatenate(angles[name]), np.concatenate(logs[name]))
        if np.isfinite(means).sum() >= SPREAD:
            sectors[name] = np.exp(means)
    if len(sectors) < 2:
        return None
    title = f"{suite}, {ship}: measure / best classical"
    return for_page(
        f"Suite {suite}, {ship}; without constant.",
        lambda path: plot_polar(middles, sectors, found.look, path, title, limit=_EDGE),
        slug(f"waves_{suite}_{ship}"),
    )


def _against_best(event: Event, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Wave headings [deg] and logarithms of the ratio to the best classical controller."""
    assert event.best_classical is not None
    seeds = event.finished([name, event.best_classical])
    run = event.runs[event.best_classical]
    own, best = event.runs[name].at(seeds), run.at(seeds)
    encounter, height = run.at(seeds, "wave_encounter_deg"), run.at(seeds, "wave_height")
    kept = (height > 0.0) & np.isfinite(encounter) & (own > 0.0) & (best > 0.0)
    return coming_from(encounter[kept]), np.log(own[kept] / best[kept])
