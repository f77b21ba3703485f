"""What a benchmark prints when it has ended: scores suite by suite, and who went wrong."""

from __future__ import annotations

from typing import Any

from ship_gym.evaluation.episodes_table import Results
from ship_gym.evaluation.report import Benchmark
from ship_gym.evaluation.report.leaderboard import boards, places
from ship_gym.text import table

_NONE = "-"
_WHERE = ["controller", "scenario", "ship", "seed", "error"]
_COUNTED = ["suite", "controller", "failed", "error", "decision_ms"]


def summary(results: Results, judged: Benchmark) -> list[dict[str, Any]]:
    """One row for each board and controller, the best first; those without a score come last.

    Returns
    -------
    list of dict
        ``board`` (a suite, or all of them), ``controller``, ``kind``, ``score`` with ``low`` and
        ``high`` (None without a score), ``cells`` that have one, ``episodes``, ``failed``,
        ``errors`` (episodes that the controller spoilt), ``decision_ms`` (mean).
    """
    rows = []
    for board, among in boards(judged).items():
        ranked = {place.controller: place for place in places(judged, among)}
        sailed = {name for event in among for name in event.runs}
        for name in [*ranked, *sorted(sailed - set(ranked))]:
            score = ranked[name].score if name in ranked else None
            rows.append(
                {
                    "board": board,
                    "controller": name,
                    "kind": judged.controllers[name],
                    "score": score.value if score else None,
                    "low": score.low if score else None,
                    "high": score.high if score else None,
                    "cells": len(ranked[name].cells) if score else 0,
                    **_counted(results, name, {event.suite for event in among}),
                }
            )
    return rows


def _counted(results: Results, controller: str, suites: set[str]) -> dict[str, Any]:
    """Episodes of a controller in some suites: how many, failed, spoilt; time per decision."""
    rows = [
        row
        for row in results.table.select(_COUNTED).to_pylist()
        if row["controller"] == controller and row["suite"] in suites
    ]
    times = [row["decision_ms"] for row in rows if row["decision_ms"] is not None]
    return {
        "episodes": len(rows),
        "failed": sum(row["failed"] for row in rows),
        "errors": sum(row["error"] != "" for row in rows),
        "decision_ms": sum(times) / len(times) if times else None,
    }


def as_text(rows: list[dict[str, Any]], results: Results) -> str:
    """The rows as tables, and the first error of each controller that went wrong."""
    header = ["controller", "kind", "score", "cells", "episodes", "failed", "errors", "ms/decision"]
    parts = []
    for board in dict.fromkeys(row["board"] for row in rows):
        cells = [_cells(row) for row in rows if row["board"] == board]
        parts.append(f"{board}\n{table(header, cells, 2)}")
    return "\n\n".join([*parts, *_errors(results), *_refused(results)])


def _cells(row: dict[str, Any]) -> list[str]:
    score, slow = row["score"], row["decision_ms"]
    interval = "" if row["low"] is None else f" [{row['low']:.0f}, {row['high']:.0f}]"
    return [
        row["controller"],
        row["kind"],
        _NONE if score is None else f"{score:.0f}{interval}",
        *(str(row[name]) for name in ("cells", "episodes", "failed", "errors")),
        _NONE if slow is None else f"{slow:.3g}",
    ]


def _errors(results: Results) -> list[str]:
    found: dict[str, list[dict]] = {}
    for row in results.table.select(_WHERE).to_pylist():
        if row["error"]:
            found.setdefault(row["controller"], []).append(row)
    return [
        f"{name}: {len(lost)} episodes lost, the first {lost[0]['seed']} of {lost[0]['scenario']} "
        f"with {lost[0]['ship']}: {lost[0]['error']}"
        for name, lost in found.items()
    ]


def _refused(results: Results) -> list[str]:
    """Who did not sail where, and why, in the controller's own words."""
    found: dict[tuple[str, str], list[str]] = {}
    for one in results.about.get("refused", []):
        cells = found.setdefault((one["controller"], one["why"]), [])
        cells.append(f"{one['scenario']} with {one['ship']}")
    return [
        f"{name} did not sail {cells[0]}{f' and {len(cells) - 1} more' if cells[1:] else ''}: {why}"
        for (name, why), cells in found.items()
    ]
