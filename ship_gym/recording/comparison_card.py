"""The card of a comparison: what differs between runs, their metrics, and where they come from."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ship_gym.recording.card import facts, in_degrees, number, scenario_name
from ship_gym.recording.comparison import Run
from ship_gym.recording.library import stored_metrics
from ship_gym.recording.surroundings import section
from ship_gym.recording.turns import is_manoeuvre
from ship_gym.text import table

if TYPE_CHECKING:
    from ship_gym.recording.trajectory import Trajectory

_MOST_KEYS = 8  # of the configuration that are named as different


def notes(runs: Sequence[Run]) -> Iterator[str]:
    """What differs between the runs beside who steers."""
    metas = [run.trajectory.meta for run in runs]
    seeds = [meta.get("seed") for meta in metas]
    if len(set(seeds)) > 1:
        yield "The seeds differ, and with them sea, start and orders."
    if len({section(meta, "ship").get("name") for meta in metas}) > 1:
        yield "The ships differ."
    if keys := _different(metas):
        more = f" and {len(keys) - _MOST_KEYS} more" if len(keys) > _MOST_KEYS else ""
        yield f"The configurations differ in {', '.join(keys[:_MOST_KEYS])}{more}."
    if len({meta.get("git_commit") for meta in metas}) > 1:
        yield "They were made by different commits of Ship Gym."
    steps = {float(np.median(np.diff(run.t))) if len(run.t) > 1 else 0.0 for run in runs}
    if max(steps) > 1.001 * min(steps):
        yield "Their rows are not equally far apart in time; differences are interpolated."
    for run in runs:
        if not run.trajectory.meta.get("complete", True):
            yield f"{run.name} is incomplete: its recording breaks off after {run.t[-1]:.3g} s."


def _different(metas: Sequence[Mapping]) -> list[str]:
    """Dotted keys of the configurations that differ."""
    flat = [dict(_leaves(section(meta, "config"))) for meta in metas]
    keys = dict.fromkeys(key for one in flat for key in one)
    return [key for key in keys if any(one.get(key) != flat[0].get(key) for one in flat)]


def _leaves(values: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in values.items():
        if isinstance(value, Mapping):
            yield from _leaves(value, f"{before}{name}.")
        else:
            yield f"{before}{name}", value


def title(runs: Sequence[Run]) -> str:
    """Scenario, ship and seed, where all have the same, and the runs."""
    metas = [run.trajectory.meta for run in runs]
    told = [
        [scenario_name(meta) for meta in metas],
        [section(meta, "ship").get("name") for meta in metas],
        [None if is_manoeuvre(run.trajectory) else meta.get("seed")
         for run, meta in zip(runs, metas, strict=True)],
    ]  # fmt: skip
    same = [one[0] if len(set(one)) == 1 else None for one in told]
    if same[2] is not None:
        same[2] = f"seed {same[2]}"
    names = " against ".join(run.name for run in runs)
    about = ", ".join(str(one) for one in same if one is not None)
    return f"{about}: {names}" if about else names


def comparison_card(runs: Sequence[Run]) -> str:
    """Markdown card: what differs, the metrics side by side with differences, and the rest."""
    names = [run.name for run in runs]
    same, different = _facts(runs)
    parts = [f"# {title(runs)}", "\n".join(f"- {note}" for note in notes(runs))]
    if different:
        parts.append(table(["", *names], different, markdown=True))
    if rows := [*_metrics(runs)]:
        header = ["Metric", "Unit", names[0]]
        for name in names[1:]:
            header += [name, f"less {names[0]}"]
        parts.append(table(header, rows, markdown=True))
    if same:
        parts.append(table(["The same in all", ""], same, markdown=True))
    return "\n\n".join(part for part in parts if part) + "\n"


def _facts(runs: Sequence[Run]) -> tuple[list[list[str]], list[list[str]]]:
    """Facts of the single cards: those that all share, and the others beside each other."""
    found = []
    for run in runs:
        outcome = run.trajectory.meta.get("outcome")
        ends = {} if outcome is None else {"Outcome": str(outcome)}
        found.append(ends | dict(facts(run.trajectory)))
    keys = dict.fromkeys(key for one in found for key in one)
    rows = [[key, *(one.get(key, "-") for one in found)] for key in keys]
    same = [row[:2] for row in rows if len(set(row[1:])) == 1]
    return same, [row for row in rows if len(set(row[1:])) > 1]


def _metrics(runs: Sequence[Run]) -> Iterator[list[str]]:
    """Rows of name, unit, the first run's value, then each other's with its difference."""
    values = [stored_metrics(run.trajectory.meta) for run in runs]
    units = section(runs[0].trajectory.meta, "units")
    for name in dict.fromkeys(key for one in values for key in one):
        kept = str(units.get(name, ""))
        first, unit = in_degrees(values[0].get(name), kept)
        row = [name, unit, number(first)]
        for one in values[1:]:
            value, _ = in_degrees(one.get(name), kept)
            less = "-" if value is None or first is None else f"{value - first:+.3g}"
            row += [number(value), less]
        yield row


def sources(runs: Sequence[Run]) -> list[dict[str, Any]]:
    """What a comparison keeps of its runs: who, which seed, and a hash of the whole record."""
    return [
        {
            "name": run.name,
            "scenario": run.trajectory.meta.get("scenario"),
            "controller": run.trajectory.meta.get("controller"),
            "seed": run.trajectory.meta.get("seed"),
            "ship": section(run.trajectory.meta, "ship").get("name"),
            "config": run.trajectory.meta.get("config"),
            "content": content_hash(run.trajectory),
        }
        for run in runs
    ]


def content_hash(trajectory: Trajectory) -> str:
    """SHA-256 of a recording's names, values and meta, as hex digits; the same in every file."""
    digest = hashlib.sha256()
    for name, values in trajectory.columns.items():
        digest.update(f"{name}\0".encode() + values.tobytes())
    digest.update(json.dumps(trajectory.meta, sort_keys=True).encode())
    return digest.hexdigest()
