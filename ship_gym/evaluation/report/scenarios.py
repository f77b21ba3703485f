"""One part for every event: measure, wear, differences, pictures, episodes, all metrics."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

import numpy as np

from ship_gym.evaluation.metrics import all_metrics
from ship_gym.evaluation.report import against, episodes, words
from ship_gym.evaluation.report.benchmark import Benchmark
from ship_gym.evaluation.report.events import NOTHING, Event, Run
from ship_gym.plotting.benchmark import Range, plot_pareto, plot_polar
from ship_gym.plotting.figure import for_page
from ship_gym.reports.page import Block, Folded, Grid, Heading, Picture, Row, Section, Text

_WEAR = ("rudder_travel", "rudder_reversals")
_ERRORS = ("J_0.1", "rms_cross_track")  # shown beside the measure, where a task has them


def scenarios(
    found: Benchmark,
    drawn: Mapping[Event, Row],
    progress: Callable[[Iterable[Event]], Iterable[Event]] = iter,
) -> list[Section]:
    """A section for each suite.

    Parameters
    ----------
    found : Benchmark
    drawn : mapping
        Pictures of episodes, ``episodes.pictures``.
    progress : callable
        Wraps the events, such as a bar.
    """
    blocks: dict[str, list[Block]] = {suite: [] for suite in found.suites}
    for event in progress(found.events):
        blocks[event.suite] += _part(found, event, drawn.get(event))
    return [Section(f"Suite {name}", part, f"suite-{name}") for name, part in blocks.items()]


def _part(found: Benchmark, event: Event, drawn: Row | None) -> list[Block]:
    heading = Heading(f"{event.scenario}, {event.ship} ({event.tier})", event.anchor)
    judged = [d for name in event.runs if (d := found.difference(event, name))]
    blocks: list[Block] = [heading, Text(_about(found, event)), _table(found, event)]
    if judged:
        rows = [against.difference_cells(each) for each in judged]
        caption = f"paired difference of {event.measure} [{event.metric.unit}], n = {judged[0].n}"
        blocks.append(Grid(caption, against.HEADER, rows, left=2))
    wear = _pictures(found, event)
    title = "Error against wear, wave heading" if len(wear) > len(_WEAR) else "Error against wear"
    if wear:
        blocks.append(Folded(title, [Row(wear)]))
    shown = [drawn] if drawn else []
    blocks.append(
        Folded("Best, median and worst episodes", [*shown, *episodes.blocks(found, event)])
    )
    blocks.append(Folded("All metrics", [_all_metrics(event)]))
    return blocks


def _about(found: Benchmark, event: Event) -> str:
    metric, scaled = event.metric, found.scales[event]
    n = max(len(run.seeds) for run in event.runs.values())
    text = f"Measure {event.measure} [{metric.unit}]: {metric.meaning}; {metric.better} is better. "
    text += f"{words.plural(n, 'seed')}. "
    if scaled.why:
        return f"{text}No score: {scaled.why}."
    cell = scaled.cell
    assert cell is not None  # as nothing says why not
    text += f"Score 0 at {words.number(cell.nothing)}, 100 at {words.number(cell.reference)} "
    text += f"({cell.reference_controller}, {scaled.source})"
    if cell.optimum is None:
        return f"{text}."
    text += f"; the optimum ({cell.optimum_kind}, {cell.optimum_seeds} seeds) has "
    text += f"{words.number(cell.optimum)}, a score of {words.score(scaled.optimum)}"
    room = cell.headroom
    return text + (
        "." if room is None else f"; headroom {words.interval(room)} % of the reference."
    )


def _table(found: Benchmark, event: Event) -> Grid:
    """Measure with interval and score, J, wear and success of every controller."""
    units = all_metrics()
    present = set.intersection(*(set(run.columns) for run in event.runs.values()))
    others = [name for name in _ERRORS if name in present and name != event.measure]
    others = [name for name in others if _known(event, name)]
    wear = [name for name in _WEAR if name in present]
    header = ["controller", f"{event.measure} [{event.metric.unit}]", "score"]
    header += [f"{name} [{units[name].unit}]" for name in (*others, *wear)]
    broke = any(run.broken.any() for run in event.runs.values())
    header += ["success", "failed", *(["errors"] if broke else [])]
    rows = []
    for name, run in event.runs.items():
        scored = found.scales[event].estimate(run.values)
        row = [name, words.interval(run.estimate), words.score_interval(scored)]
        row += [words.number(run.middle(each)) for each in others]
        row += [words.interval(run.of(each)) for each in wear]
        success = run.of("success") if "success" in present else None
        row += [_rate(success), str(int(run.columns["failed"].sum()))]
        row += [str(int(run.broken.sum()))] if broke else []
        rows.append(row)
    caption = "interquartile means with 95 % intervals; success: share of the episodes"
    return Grid(caption, header, rows)


def _known(event: Event, name: str) -> bool:
    """Whether any controller has numbers of a metric."""
    return any(run.middle(name) is not None for run in event.runs.values())


def _rate(found) -> str:
    if found is None:
        return words.NONE
    if found.low is None:
        return words.share(found.value)
    low, high = 100.0 * found.low, 100.0 * found.high
    return f"{words.share(found.value)} [{low:.0f}, {high:.0f}]"


def _range(run: Run, name: str | None = None) -> Range | None:
    found = run.of(name)
    if found is None:
        return None
    ends = (found.value if end is None else end for end in (found.low, found.high))
    return Range(found.value, *ends)


def _pictures(found: Benchmark, event: Event) -> list[Picture]:
    pictures = [each for wear in _WEAR if (each := _pareto(found, event, wear))]
    polar = _polar(found, event)
    return [*pictures, polar] if polar else pictures


def _pareto(found: Benchmark, event: Event, wear: str) -> Picture | None:
    points = {}
    for name, run in event.runs.items():
        if (x := _range(run, wear)) is not None and (y := _range(run)) is not None:
            points[name] = x, y
    points.pop(NOTHING, None)  # far off, it would press the others together
    if len(points) < 2:
        return None
    labels = f"{wear} [{all_metrics()[wear].unit}]", f"{event.measure} [{event.metric.unit}]"
    cell = found.scales[event].cell
    optimum = cell.optimum if cell else None
    caption = (
        f"{event.cell}: error against wear with 95 % intervals. The line joins the controllers "
        "that no other one equals or beats in both. Without constant."
    )
    return for_page(
        caption,
        lambda path: plot_pareto(points, found.look, labels, path, event.cell, optimum),
        f"{wear}_{event.anchor}",
    )


def _polar(found: Benchmark, event: Event) -> Picture | None:
    """The measure over the wave heading, where the seeds meet waves from several sectors."""
    sectors = {}
    for name, run in event.runs.items():
        columns = run.columns
        kept = np.isfinite(columns["wave_encounter_deg"]) & (columns["wave_height"] > 0.0)
        kept &= np.isfinite(run.values)
        where = against.coming_from(columns["wave_encounter_deg"][kept])
        middles, means = against.by_sector(where, run.values[kept])
        if np.isfinite(means).sum() >= against.SPREAD:
            sectors[name] = means
    if len(sectors) > 1:
        sectors.pop(NOTHING, None)  # it would hide what the others differ by
    if not sectors:
        return None
    label = f"mean {event.measure} [{event.metric.unit}]"
    return for_page(
        f"{event.cell}: {label} by where the waves come from; without constant.",
        lambda path: plot_polar(middles, sectors, found.look, path, event.cell, label),
        f"waves_{event.anchor}",
    )


def _all_metrics(event: Event) -> Grid:
    """Middle and quartiles of every metric that the event has."""
    units, runs = all_metrics(), event.runs
    rows = []
    for name, metric in units.items():
        if not any(name in run.columns and run.middle(name) is not None for run in runs.values()):
            continue
        rows.append([name, metric.unit, metric.better, *(_spread(r, name) for r in runs.values())])
    caption = "interquartile mean (lower and upper quartile); success: rate"
    return Grid(caption, ["metric", "unit", "better", *runs], rows, left=3)


def _spread(run: Run, name: str) -> str:
    middle = run.middle(name)
    if middle is None or name == "success":
        return words.number(middle)
    low, high = np.quantile(run.columns[name], (0.25, 0.75))
    return f"{words.number(middle)} ({words.number(low)}, {words.number(high)})"
