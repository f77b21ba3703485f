"""Sections on where the numbers come from: controllers, times, errors, versions and machine."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ship_gym.evaluation.report import words
from ship_gym.evaluation.report.benchmark import Benchmark
from ship_gym.reports.page import Block, Cell, Command, Folded, Grid, Section, Text

_ERRORS = 20  # rows of one controller that are shown
_LONG = 300  # letters of a text in a table


def controllers(found: Benchmark) -> Section:
    """What each controller is and was trained or tuned on, and its time per decision."""
    about = found.about.get("controllers", {})
    rows = []
    for name, kind in found.controllers.items():
        said = about.get(name, {})
        rest = {key: value for key, value in said.items() if key != "kind" and value != name}
        rows.append([name, kind, _in_words(rest) or "nothing is said about it"])
    header = ["controller", "kind", "source"]
    blocks: list[Block] = [Grid("what was trained or tuned on what", header, rows, 3)]
    times = _decision_times(found)
    if times.rows:
        text = "Time per decision of one ship, on the machine below; it differs between runs."
        blocks += [Text(text), times]
    return Section("Controllers", blocks, "controllers")


def _in_words(values: Any) -> str:
    """Plain values as ``key: value; key: value``."""
    if isinstance(values, Mapping):
        parts = [f"{k}: {_in_words(v)}" for k, v in values.items() if v not in (None, "", {}, [])]
        return "; ".join(parts)
    if isinstance(values, list | tuple):
        return ", ".join(map(_in_words, values))
    text = f"{values:g}" if isinstance(values, float) else str(values)
    return text if len(text) <= _LONG else f"{text[:_LONG]} ..."


def _decision_times(found: Benchmark) -> Grid:
    rows = []
    for name in found.controllers:
        runs = [e.runs[name].columns.get("decision_ms") for e in found.events if name in e.runs]
        times = np.concatenate([each for each in runs if each is not None] or [np.zeros(0)])
        times = times[np.isfinite(times)]
        if len(times):
            quantiles = np.quantile(times, (0.5, 0.95, 1.0))
            rows.append([name, *(words.number(float(each)) for each in quantiles)])
    header = ["controller", "median [ms]", "95 % [ms]", "largest [ms]"]
    return Grid("time per decision", header, rows)


def errors(found: Benchmark) -> Section:
    """Episodes that a controller broke off, with what it did."""
    blocks: list = []
    for name in found.controllers:
        rows = [
            [Cell(event.cell, event.anchor), str(seed), error]
            for event in found.events
            if name in event.runs
            for run in [event.runs[name]]
            for seed, error in zip(run.seeds, run.columns["error"], strict=True)
            if error
        ]
        if rows:
            total = words.plural(len(rows), "episode")
            first = "" if len(rows) <= _ERRORS else f", the first {_ERRORS} of them"
            caption = f"{name}: {total} broke off{first}"
            blocks.append(Grid(caption, ["cell", "seed", "error"], rows[:_ERRORS], left=3))
    return Section("Errors of controllers", blocks, "errors")


def provenance(found: Benchmark) -> Section:
    """Versions, machine, seeds, suites and how to make the results again."""
    rest = {key: value for key, value in found.about.items() if key != "controllers"}
    rows = [[key, _short(value)] for key, value in _flat(rest) if value not in ("", [], {}, None)]
    if not rows:
        return Section("Provenance", [Text("The results say nothing about how they were made.")])
    whole = json.dumps(found.about, indent=1, sort_keys=True, default=str)
    blocks: list[Block] = [
        Grid("of the results", ["", ""], rows, left=2),
        Folded("All that the results say about themselves", [Command(whole)]),
    ]
    return Section("Provenance", blocks, "provenance")


def _flat(values: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Nested mappings as (``a, b``, value)."""
    for key, value in values.items():
        name = f"{prefix}, {key}" if prefix else str(key)
        if isinstance(value, Mapping) and value:
            yield from _flat(value, name)
        else:
            yield name, value


def _short(value: Any) -> str:
    """A value; a run of whole numbers as its ends."""
    whole = isinstance(value, list | tuple) and all(isinstance(each, int) for each in value)
    if whole and len(value) > 2 and list(value) == list(range(value[0], value[-1] + 1)):
        return f"{value[0]} to {value[-1]} ({len(value)})"
    return _in_words(value)
